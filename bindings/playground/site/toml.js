// The form's values as TOML.

const bare = /^\d+$/;

function literal(key, value) {
  if (typeof value === "string") {
    const asNumber = key.kind.is === "choice" ? key.kind.options.every((it) => bare.test(it)) : key.name === "pipeline.interval" && bare.test(value);
    return asNumber ? value : JSON.stringify(value);
  }
  // An empty field for a number. Glint's message then names the field.
  if (Number.isNaN(value)) return "nan";
  return Array.isArray(value) ? `[${value.join(", ")}]` : String(value);
}

// The entries of a table as pairs of a name and the entry's fields. Glint's answer has them as an object, and the form as pairs, since
// two entries may have the same name while they are edited.
export function pairs(entries) {
  return Array.isArray(entries) ? entries : Object.entries(entries);
}

// An entry in TOML. The value of the shorthand stands for an entry without other fields, as in `s = "x^2"`.
function entryLiteral({ kind }, entry) {
  const given = Object.entries(entry);
  const text = ([name, value]) => literal(fieldNamed({ kind }, name), value);
  if (given.length === 1 && given[0][0] === kind.shorthand) return text(given[0]);
  return `{ ${given.map((it) => `${it[0]} = ${text(it)}`).join(", ")} }`;
}

// The lines of an entry: one line, or a line for each entry of its own tables.
function entryLines(key, name, [entryName, entry]) {
  const own = `${name}.${entryName}`;
  const tables = Object.entries(entry).filter(([field]) => isTable(key, field));
  if (tables.length === 0) return [`${own} = ${entryLiteral(key, entry)}`];
  const inner = ([field, value]) => pairs(value).flatMap((it) => entryLines(fieldNamed(key, field), `${own}.${field}`, it));
  const plain = Object.entries(entry).filter(([field]) => !isTable(key, field));
  const text = ([field, value]) => `${own}.${field} = ${literal(fieldNamed(key, field), value)}`;
  return [...plain.map(text), ...tables.flatMap(inner)];
}

const fieldNamed = ({ kind }, name) => kind.fields.find((it) => it.name === name) ?? { kind: {} };
const isTable = (key, field) => fieldNamed(key, field).kind.is === "entries";

// Tables as pairs at every depth, so that values can be compared.
function asPairs(key, value) {
  if (key.kind.is !== "entries") return value;
  return pairs(value).map(([name, entry]) => [name, Object.entries(entry).map(([field, it]) => [field, asPairs(fieldNamed(key, field), it)])]);
}

function isDefault(key, value) {
  const comparable = (it) => JSON.stringify(asPairs(key, it));
  return comparable(value) === comparable(key.default);
}

// The keys that are not at their defaults, by table. `name` is the name of the module, or null if the text states none.
export function toml(device, name, keys, values) {
  const given = keys.filter((key) => key.name in values && !isDefault(key, values[key.name]));
  const tables = new Map([["", []]]);
  // TOML refuses a table such as [operands] after the line of an entry such as operands.x.
  const dotted = given.filter((key) => key.kind.is === "entries").map((key) => key.name);
  for (const key of given) {
    if (key.kind.is === "entries") {
      for (const entry of pairs(values[key.name])) tables.get("").push(...entryLines(key, key.name, entry));
      continue;
    }
    const at = key.name.lastIndexOf(".");
    const own = at < 0 ? "" : key.name.slice(0, at);
    const table = dotted.includes(own) ? "" : own;
    if (!tables.has(table)) tables.set(table, []);
    tables.get(table).push(`${table === own ? key.name.slice(at + 1) : key.name} = ${literal(key, values[key.name])}`);
  }
  const head = name === null ? `device = "${device}"\n` : `device = "${device}"\nname = "${name}"\n`;
  const text = [...tables].map(([table, lines]) => (table ? `\n[${table}]\n` : head) + lines.map((it) => `${it}\n`).join(""));
  return text.join("");
}
