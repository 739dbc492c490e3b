//! Writes the configuration keys of devices as JSON Schema, with which editors complete and check configuration files.

use serde_json::{Map, Value as Json, json};

use super::schema::{Key, KeyKind, Schema};
use super::values::Value;

/// Returns a JSON Schema (draft 7) for configurations of the devices in `schemas`, with the type, range, default and description
/// of each key. A description mentions the condition under which the key applies. Only Glint checks conditions between keys.
pub fn json_schema(schemas: &[Schema]) -> Json {
    let names: Vec<&str> = schemas.iter().map(|schema| schema.device).collect();
    // Not `oneOf`: if a file is wrong, editors then say only that no alternative fits. With `if` and `then` they name the wrong
    // key.
    let by_device = schemas.iter().map(|schema| {
        let is_it = json!({
            "required": ["device"],
            "properties": { "device": { "const": schema.device } },
        });
        json!({ "if": is_it, "then": of_device(schema) })
    });
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Glint configuration",
        "type": "object",
        "required": ["device"],
        "properties": { "device": { "enum": names } },
        "allOf": by_device.collect::<Vec<_>>(),
    })
}

fn of_device(schema: &Schema) -> Json {
    let mut device = table();
    let root = properties(&mut device);
    for (name, doc) in super::COMMON {
        let mut entry = match name {
            "device" => json!({ "const": schema.device }),
            "strict" => json!({ "type": "boolean", "default": false }),
            _ => json!({ "type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]{0,59}$" }),
        };
        entry["description"] = json!(doc);
        root.insert(name.to_owned(), entry);
    }
    for key in schema.all_keys() {
        if let KeyKind::Table { fields, shorthand, .. } = &key.kind {
            // A shared key can be in the same table, for example `operands.buffered` in the table `operands`.
            let entries = properties(&mut device).entry(key.name).or_insert_with(table);
            entries["additionalProperties"] = record(fields, *shorthand);
            entries["description"] = json!(key.doc);
            continue;
        }
        let (tables, leaf) = key.table_and_leaf();
        let mut level = properties(&mut device);
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            level = properties(level.entry(name).or_insert_with(table));
        }
        level.insert(leaf.to_owned(), of_key(key));
    }
    device["title"] = json!(schema.device);
    device
}

/// Returns a table schema without keys. The table allows only the keys that the caller adds.
fn table() -> Json {
    json!({ "type": "object", "additionalProperties": false, "properties": {} })
}

fn properties(table: &mut Json) -> &mut Map<String, Json> {
    table["properties"].as_object_mut().expect("a table has properties")
}

fn of_key(key: &Key) -> Json {
    let mut entry = match &key.kind {
        KeyKind::Integer { min, max } => {
            json!({ "type": "integer", "minimum": min, "maximum": max })
        }
        KeyKind::Number { min, max, or_zero: false } => {
            json!({ "type": "number", "minimum": min, "maximum": max })
        }
        KeyKind::Number { min, max, or_zero: true } => json!({
            "type": "number",
            "anyOf": [{ "minimum": 0, "maximum": 0 }, { "minimum": min, "maximum": max }],
        }),
        KeyKind::Choice(options) => {
            json!({ "enum": options.iter().map(|option| choice(key, option)).collect::<Vec<_>>() })
        }
        KeyKind::Flag => json!({ "type": "boolean" }),
        KeyKind::Text(pattern) => {
            let types = if key.kind.takes_integers() {
                json!(["string", "number"])
            } else {
                json!("string")
            };
            json!({ "type": types, "pattern": pattern.regex() })
        }
        KeyKind::Integers { min, max, len_min, len_max } => json!({
            "type": "array",
            "items": { "type": "integer", "minimum": min, "maximum": max },
            "minItems": len_min,
            "maxItems": len_max,
        }),
        KeyKind::Table { .. } => unreachable!("`{}` is a table of entries", key.name),
    };
    entry["default"] = match &key.default {
        Value::Text(value) => choice(key, value),
        other => json!(other),
    };
    let condition = key.condition.map(|condition| {
        let relation = if condition.is_equal { "=" } else { "other than" };
        format!(" Only with {} {relation} {}.", condition.key, condition.value)
    });
    entry["description"] = json!(format!("{}{}", key.doc, condition.unwrap_or_default()));
    entry
}

/// Returns the schema of a table of entries within an entry, such as `functions.rcp.operands`. An entry is a table with `fields`,
/// or only the value of the field `shorthand`.
fn entries_of(key: &Key, fields: &[Key], shorthand: Option<&str>) -> Json {
    json!({
        "type": "object",
        "description": key.doc,
        "additionalProperties": record(fields, shorthand),
    })
}

fn record(fields: &[Key], shorthand: Option<&str>) -> Json {
    let mut entry = table();
    let of_fields = properties(&mut entry);
    for field in fields {
        let mut schema = match &field.kind {
            KeyKind::Table { fields, shorthand, .. } => entries_of(field, fields, *shorthand),
            _ => of_key(field),
        };
        // A field that the user does not give has no value, so the schema states no default.
        if let Some(schema) = schema.as_object_mut() {
            schema.remove("default");
        }
        of_fields.insert(field.name.to_owned(), schema);
    }
    if fields.iter().all(|field| matches!(field.kind, KeyKind::Table { .. })) {
        let doc = "A configuration of the device expression, whose tables the entry has.";
        let file = json!({ "type": "string", "description": doc });
        properties(&mut entry).insert("file".to_owned(), file);
    }
    match fields.iter().find(|field| Some(field.name) == shorthand) {
        Some(field) => json!({ "anyOf": [of_key(field), entry] }),
        None => entry,
    }
}

/// Returns `option` as a configuration file writes it: an integer without quotes if the key takes integers, and otherwise a text.
fn choice(key: &Key, option: &str) -> Json {
    match option.parse::<i64>() {
        Ok(number) if key.kind.takes_integers() => json!(number),
        _ => json!(option),
    }
}
