// Elements of the page.

export const $ = (id) => document.getElementById(id);

export const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// Returns a text as nodes. A name between backquotes becomes a code element.
export function prose(text) {
  return text.split("`").map((part, at) => (at % 2 === 1 ? element("code", { textContent: part }) : part));
}
