//! Reads JSON values of the type that a test expects. A value of another type panics, and the message shows the value.

use serde_json::{Map, Value};

/// A value of a kind that is known; of another it is shown.
pub trait Json {
    /// Returns the elements of a list.
    fn list(&self) -> &Vec<Value>;

    /// Returns the members of an object.
    fn object(&self) -> &Map<String, Value>;

    /// Returns a text.
    fn text(&self) -> &str;

    /// Returns a number.
    fn number(&self) -> f64;

    /// Returns an integer.
    fn integer(&self) -> i64;

    /// Returns an integer that is not negative.
    fn count(&self) -> u64;

    /// Returns the text that each element of a list has as this member.
    fn each(&self, key: &str) -> Vec<&str>;

    /// Returns the element of a list whose member of this name is this text.
    fn of(&self, key: &str, text: &str) -> &Value;
}

impl Json for Value {
    #[track_caller]
    fn list(&self) -> &Vec<Value> {
        self.as_array().unwrap_or_else(|| panic!("no list: {self}"))
    }

    #[track_caller]
    fn object(&self) -> &Map<String, Value> {
        self.as_object().unwrap_or_else(|| panic!("no object: {self}"))
    }

    #[track_caller]
    fn text(&self) -> &str {
        self.as_str().unwrap_or_else(|| panic!("no text: {self}"))
    }

    #[track_caller]
    fn number(&self) -> f64 {
        self.as_f64().unwrap_or_else(|| panic!("no number: {self}"))
    }

    #[track_caller]
    fn integer(&self) -> i64 {
        self.as_i64().unwrap_or_else(|| panic!("no integer: {self}"))
    }

    #[track_caller]
    fn count(&self) -> u64 {
        self.as_u64().unwrap_or_else(|| panic!("no count: {self}"))
    }

    #[track_caller]
    fn each(&self, key: &str) -> Vec<&str> {
        self.list().iter().map(|it| it[key].text()).collect()
    }

    #[track_caller]
    fn of(&self, key: &str, text: &str) -> &Value {
        let found = self.list().iter().find(|it| it[key] == text);
        found.unwrap_or_else(|| panic!("no {key} {text} in {self}"))
    }
}
