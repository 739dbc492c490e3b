// The entries of a table in the form, such as the operands of an expression: a card for each entry, with an input for each field that
// the entry has. The cards change at once, so that an entry which Glint refuses can be edited further.

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
      if (input === document.activeElement) continue;
      if (input.type === "checkbox") input.checked = entry[input.name];
      else input.value = entry[input.name];
    }
  }
  limit(list);
}

const cardsOf = (list) => [...list.querySelectorAll(".entry")];
const nameInput = (card) => card.querySelector(".name input");
const fieldInputs = (card) => [...card.querySelectorAll(".field > input, .field > select")];

function readEntries(list) {
  return cardsOf(list).map((card) => [nameInput(card).value, Object.fromEntries(fieldInputs(card).map((it) => [it.name, valueOf(it)]))]);
}

function valueOf(input) {
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
  let number = entries.length + 1;
  while (names.includes(`${name[0]}${number}`)) number += 1;
  const made = card(list, `${name[0]}${number}`, fields);
  list.lastElementChild.before(made);
  nameInput(made).focus();
  limit(list);
  list.edited();
}

// Lets entries be added and removed while their number is in the range of the key.
function limit(list) {
  const cards = cardsOf(list);
  list.lastElementChild.disabled = cards.length >= list.key.kind.most;
  for (const card of cards) card.querySelector(".remove").disabled = cards.length <= list.key.kind.least;
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
    card.querySelector(".fields").append(fieldOf(list, card, field.name, field.default));
    label(list, card);
    fieldInputs(card).at(-1).focus();
    list.edited();
  };
  return element("div", { className: "adder" }, choice, button);
}

function fieldOf(list, card, name, value) {
  const field = list.key.kind.fields.find((it) => it.name === name);
  const input = inputOf(field, value);
  Object.assign(input, { name, title: field.doc, onchange: list.edited });
  const drop = element("button", { type: "button", className: "drop", textContent: "×" });
  const made = element("div", { className: WIDE.includes(name) ? "field wide" : "field" }, element("label", { textContent: name, title: field.doc }), input, drop);
  drop.onclick = () => {
    made.remove();
    label(list, card);
    card.querySelector(".adder select").focus();
    list.edited();
  };
  return made;
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
    input.id = `${id}.${input.name}`;
    input.previousElementSibling.htmlFor = input.id;
    input.nextElementSibling.ariaLabel = `remove ${input.name} of ${name}`;
  }
  const given = fieldInputs(card).map((it) => it.name);
  const others = list.key.kind.fields.filter((it) => !given.includes(it.name));
  const adder = card.querySelector(".adder");
  adder.hidden = others.length === 0;
  const choice = adder.querySelector("select");
  choice.ariaLabel = `a field to add to ${name}`;
  choice.replaceChildren(...others.map((it) => element("option", { value: it.name, textContent: `${it.name}: ${it.doc}` })));
}
