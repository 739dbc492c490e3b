// The entries of a table in the form, such as the operands of an expression: a card for each entry, with an input for each field that
// the entry has. A field that is itself a table, such as the operands of a function of a unit, has cards within the card. The cards change
// at once, so that an entry which Glint refuses can be edited further.

import { element } from "./dom.js";
import { pairs } from "./toml.js";

// The fields that take the whole width of a card.
const WIDE = ["formula", "where"];

// Makes the cards of a table. `change` is called with the pairs of names and fields after each edit.
export function entriesOf(key, value, change) {
  const list = element("div", { id: `key-${key.name}`, className: "entries", role: "group", ariaLabel: key.name });
  const add = element("button", { type: "button", className: "add", textContent: `Add to ${key.name}` });
  Object.assign(list, { key, edited: () => change(readEntries(list)) });
  add.onclick = () => addEntry(list);
  list.append(add);
  showEntries(list, value);
  return list;
}

// Shows values in the cards. Cards are made anew only if there are other entries or fields, so that an input in use stays.
export function showEntries(list, value) {
  const structure = (entries) => JSON.stringify(entries.map(([name, entry]) => [name, Object.keys(entry)]));
  const entries = pairs(value);
  if (structure(entries) !== structure(readEntries(list))) {
    for (const card of cardsOf(list)) card.remove();
    list.lastElementChild.before(...entries.map((it) => card(list, ...it)));
  }
  for (const [at, [, entry]] of entries.entries()) {
    for (const input of fieldInputs(cardsOf(list)[at])) {
      if (input.className === "entries") {
        showEntries(input, entry[fieldName(input)]);
        continue;
      }
      if (input === document.activeElement) continue;
      if (input.type === "checkbox") input.checked = entry[input.name];
      else input.value = entry[input.name];
    }
  }
  limit(list);
}

// A card contains the cards of its own tables, so that its parts are found among its children.
const cardsOf = (list) => [...list.querySelectorAll(":scope > .entry")];
const nameInput = (card) => card.querySelector(":scope > .name input");
const fieldInputs = (card) => [...card.querySelectorAll(":scope > .fields > .field > :is(input, select, .entries)")];
const fieldName = (input) => input.name ?? input.key.name.split(".").at(-1);

function readEntries(list) {
  return cardsOf(list).map((card) => [nameInput(card).value, Object.fromEntries(fieldInputs(card).map((it) => [fieldName(it), valueOf(it)]))]);
}

function valueOf(input) {
  if (input.className === "entries") return readEntries(input);
  if (input.type === "checkbox") return input.checked;
  return input.type === "number" ? input.valueAsNumber : input.value;
}

// Adds an entry that is like the last, with a name of its own, such as `r2`.
function addEntry(list) {
  const { name, kind } = list.key;
  const entries = readEntries(list);
  const first = kind.fields.find((it) => it.name === kind.shorthand);
  const [, fields] = entries.at(-1) ?? ["", first ? { [first.name]: first.default } : {}];
  const names = entries.map(([it]) => it);
  const letter = name.split(".").at(-1)[0];
  let number = entries.length + 1;
  while (names.includes(`${letter}${number}`)) number += 1;
  const made = card(list, `${letter}${number}`, fields);
  list.lastElementChild.before(made);
  nameInput(made).focus();
  limit(list);
  list.edited();
}

// Lets entries be added and removed while their number is in the range of the key.
function limit(list) {
  const cards = cardsOf(list);
  list.lastElementChild.disabled = cards.length >= list.key.kind.most;
  for (const card of cards) card.querySelector(":scope > .name .remove").disabled = cards.length <= list.key.kind.least;
}

function card(list, name, entry) {
  const own = element("input", { type: "text", value: name, spellcheck: false, autocapitalize: "off" });
  const remove = element("button", { type: "button", className: "remove", textContent: "Remove" });
  const fields = element("div", { className: "fields" });
  const card = element("div", { className: "entry", role: "group" }, element("div", { className: "name" }, element("label", { textContent: "name" }), own, remove), fields);
  own.onchange = () => {
    label(list, card);
    list.edited();
  };
  remove.onclick = () => {
    card.remove();
    list.lastElementChild.focus();
    limit(list);
    list.edited();
  };
  card.append(fieldAdder(list, card));
  for (const [field, value] of Object.entries(entry)) fields.append(fieldOf(list, card, field, value));
  label(list, card);
  return card;
}

// A choice among the fields that an entry does not have, with a button that adds the chosen one.
function fieldAdder(list, card) {
  const choice = element("select", {});
  const button = element("button", { type: "button", textContent: "Add field" });
  button.onclick = () => {
    const field = list.key.kind.fields.find((it) => it.name === choice.value);
    card.querySelector(":scope > .fields").append(fieldOf(list, card, field.name, field.default));
    label(list, card);
    fieldInputs(card).at(-1).focus();
    list.edited();
  };
  return element("div", { className: "adder" }, choice, button);
}

function fieldOf(list, card, name, value) {
  const field = list.key.kind.fields.find((it) => it.name === name);
  const isTable = field.kind.is === "entries";
  const input = isTable ? tableOf(list, card, field, value) : inputOf(field, value);
  if (!isTable) Object.assign(input, { name, title: field.doc, onchange: list.edited });
  const drop = element("button", { type: "button", className: "drop", textContent: "×" });
  const made = element("div", { className: isTable || WIDE.includes(name) ? "field wide" : "field" }, element("label", { textContent: name, title: field.doc }), input, drop);
  drop.onclick = () => {
    made.remove();
    label(list, card);
    card.querySelector(":scope > .adder select").focus();
    list.edited();
  };
  return made;
}

// The cards of a table within an entry.
function tableOf(list, card, field, value) {
  const name = `${list.key.name}.${nameInput(card).value}.${field.name}`;
  return entriesOf({ ...field, name }, value, () => list.edited());
}

function inputOf({ kind: { is, min, max, options } }, value) {
  if (is === "flag") return element("input", { type: "checkbox", checked: value });
  if (is === "choice") return element("select", { value }, ...options.map((it) => element("option", { value: it, textContent: it, selected: it === value })));
  if (is === "text") return element("input", { type: "text", value, spellcheck: false, autocapitalize: "off" });
  return element("input", { type: "number", min, max, step: is === "integer" ? 1 : "any", value });
}

// Gives a card and its inputs the identifiers and labels of the entry's name, and offers the fields that it does not have.
function label(list, card) {
  const name = nameInput(card).value;
  const id = `key-${list.key.name}.${name}`;
  Object.assign(card, { id, ariaLabel: `${name} of ${list.key.name}` });
  nameInput(card).id = `name-${list.key.name}.${name}`;
  card.querySelector(".name label").htmlFor = nameInput(card).id;
  card.querySelector(".remove").ariaLabel = `remove ${name}`;
  for (const input of fieldInputs(card)) {
    const field = fieldName(input);
    input.id = `${id}.${field}`;
    input.previousElementSibling.htmlFor = input.id;
    input.nextElementSibling.ariaLabel = `remove ${field} of ${name}`;
    if (input.className === "entries") {
      input.key.name = `${list.key.name}.${name}.${field}`;
      input.ariaLabel = input.key.name;
      input.lastElementChild.textContent = `Add to ${input.key.name}`;
      for (const inner of cardsOf(input)) label(input, inner);
    }
  }
  const given = fieldInputs(card).map(fieldName);
  const others = list.key.kind.fields.filter((it) => !given.includes(it.name));
  const adder = card.querySelector(":scope > .adder");
  adder.hidden = others.length === 0;
  const choice = adder.querySelector("select");
  choice.ariaLabel = `a field to add to ${name}`;
  choice.replaceChildren(...others.map((it) => element("option", { value: it.name, textContent: `${it.name}: ${it.doc}` })));
}
