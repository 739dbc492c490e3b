// The form's values as TOML.

const bare = /^\d+$/;

function literal(key, value) {
  if (typeof value === "string") {
    const asNumber = key.kind.is === "choice" ? key.kind.options.every((it) => bare.test(it)) : key.name === "pipeline.interval" && bare.test(value);
    return asNumber ? value : JSON.stringify(value);
  }
  return Array.isArray(value) ? `[${value.join(", ")}]` : String(value);
}

// The fields of an entry as TOML without braces: of the core they are an object, in the form text.
export function fields(entry) {
  if (typeof entry === "string") return entry;
  return Object.entries(entry).map(([name, value]) => `${name} = ${typeof value === "string" ? JSON.stringify(value) : value}`).join(", ");
}

// The keys that are not at their defaults, by table.
export function toml(device, keys, values) {
  const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  const given = keys.filter((key) => key.name in values && !same(values[key.name], key.default));
  const tables = new Map([["", []]]);
  for (const key of given) {
    if (key.kind.is === "entries") {
      for (const [name, entry] of Object.entries(values[key.name])) tables.get("").push(`${key.name}.${name} = { ${fields(entry)} }`);
      continue;
    }
    const at = key.name.lastIndexOf(".");
    const table = at < 0 ? "" : key.name.slice(0, at);
    if (!tables.has(table)) tables.set(table, []);
    tables.get(table).push(`${key.name.slice(at + 1)} = ${literal(key, values[key.name])}`);
  }
  const text = [...tables].map(([table, lines]) => (table ? `\n[${table}]\n` : `device = "${device}"\n`) + lines.map((it) => `${it}\n`).join(""));
  return text.join("");
}
