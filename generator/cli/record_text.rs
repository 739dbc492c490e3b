//! Formats JSON for the records in the repository. A value stays on one line if the line then has at most 150 characters.
//! Otherwise each of its entries begins an indented line of its own. The outermost object always has a line for each entry.
//!
//! For example, a kind of fault with short counts is one line: `"rounding": { "planted": 4, "caught": { "cosim": 4 }, … }`.

use serde_json::Value;

/// The longest line in characters.
const WIDTH: usize = 150;

pub fn record_text(value: &Value) -> String {
    let mut text = String::new();
    broken(value, 0, &mut text);
    text.push('\n');
    text
}

fn append(value: &Value, depth: usize, text: &mut String) {
    let line = one_line(value);
    let start = text.rfind('\n').map_or(0, |newline| newline + 1);
    if text.len() - start + line.len() <= WIDTH {
        text.push_str(&line);
    } else {
        broken(value, depth, text);
    }
}

fn broken(value: &Value, depth: usize, text: &mut String) {
    let indent = "  ".repeat(depth + 1);
    let (open, close, count) = match value {
        Value::Array(entries) => ('[', ']', entries.len()),
        Value::Object(entries) => ('{', '}', entries.len()),
        plain => return text.push_str(&plain.to_string()),
    };
    text.push(open);
    let begin = |at: usize, text: &mut String| {
        text.push_str(if at == 0 { "\n" } else { ",\n" });
        text.push_str(&indent);
    };
    match value {
        Value::Array(entries) => {
            for (at, entry) in entries.iter().enumerate() {
                begin(at, text);
                append(entry, depth + 1, text);
            }
        }
        Value::Object(entries) => {
            for (at, (key, entry)) in entries.iter().enumerate() {
                begin(at, text);
                text.push_str(&format!("{}: ", Value::from(key.as_str())));
                append(entry, depth + 1, text);
            }
        }
        _ => {}
    }
    if count > 0 {
        text.push('\n');
        text.push_str(&"  ".repeat(depth));
    }
    text.push(close);
}

fn one_line(value: &Value) -> String {
    match value {
        Value::Array(entries) => {
            let entries: Vec<String> = entries.iter().map(one_line).collect();
            format!("[{}]", entries.join(", "))
        }
        Value::Object(entries) if entries.is_empty() => "{}".to_owned(),
        Value::Object(entries) => {
            let entry = |(key, value): (&String, &Value)| {
                format!("{}: {}", Value::from(key.as_str()), one_line(value))
            };
            let entries: Vec<String> = entries.iter().map(entry).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        plain => plain.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_fits_is_in_one_line() {
        let long: Vec<String> = (0..30).map(|at| format!("fault {at}")).collect();
        let value = json!({ "a": { "b": [1, 2.5], "c": {} }, "long": long, "none": [] });
        let text = record_text(&value);
        assert!(text.starts_with(
            "{\n  \"a\": { \"b\": [1, 2.5], \"c\": {} },\n  \"long\": [\n    \"fault 0\",\n"
        ));
        assert!(text.ends_with("    \"fault 29\"\n  ],\n  \"none\": []\n}\n"), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
