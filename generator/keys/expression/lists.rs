//! Reads operands and results of the device `expression` that are lists of numbers.
//!
//! An entry with the field `size` or `axes` is a list. Each of its numbers is a port: `n = { axes = "xyz", … }` has the ports `nx`, `ny`
//! and `nz`, and `v = { size = 2, … }` has the ports `v_0` and `v_1`.

use std::sync::Arc;

use glint_base::config_error::ConfigError;
use glint_config::TableEntry;
use glint_formula::{Expression, LONGEST_LIST, NumberList, NumberOrList};

use super::Keys;

/// The most numbers that all operands, or all results, have together.
pub(super) const MOST_NUMBERS: usize = 32;

/// Returns the names of the ports of a list: one for each axis, or numbers from 0 on.
fn element_names(name: &str, count: usize, axes: Option<&str>) -> Vec<String> {
    match axes {
        Some(axes) => axes.chars().map(|axis| format!("{name}{axis}")).collect(),
        None => (0..count).map(|number| format!("{name}_{number}")).collect(),
    }
}

/// The ports of an operand.
pub(super) struct OperandPorts {
    /// The operand's own name, or a name for each number of a list.
    pub(super) names: Vec<String>,
    axes: Option<String>,
    is_list: bool,
}

impl OperandPorts {
    /// Returns the ports of the operand that `record` states.
    ///
    /// # Errors
    /// Fails if the axes are no different letters, or if their number is not `size`.
    pub(super) fn of(record: &TableEntry) -> Result<Self, ConfigError> {
        let key = |field: &str| format!("operands.{}.{field}", record.name);
        let name = &record.name;
        let axes = axes_of(record, &key("axes"))?;
        let size = record.bits("size").map(|size| size as usize);
        let Some(count) = axes.as_ref().map(String::len).or(size) else {
            return Ok(Self { names: vec![name.clone()], axes: None, is_list: false });
        };
        if let Some(size) = size.filter(|size| *size != count) {
            let message = format!("`{name}` has {size} numbers and {count} axes");
            return Err(ConfigError::new(key("size"), message, "give as many axes as numbers"));
        }
        Ok(Self { names: element_names(name, count, axes.as_deref()), axes, is_list: true })
    }

    /// Returns the names in formulas of the operand `name`, or of each number of a list: `n.x` or `v[0]`.
    fn written_names(&self, name: &str) -> Vec<String> {
        let number = |at: usize| match &self.axes {
            Some(axes) => format!("{name}.{}", &axes[at..=at]),
            None if self.is_list => format!("{name}[{at}]"),
            None => name.to_owned(),
        };
        (0..self.names.len()).map(number).collect()
    }

    /// Returns the documentation of each number of the operand `name`, whose own documentation is `doc`.
    pub(super) fn docs(&self, name: &str, doc: &str) -> Vec<String> {
        let numbers = self.written_names(name);
        numbers.iter().map(|number| doc_of_number(doc, number, self.is_list)).collect()
    }

    /// Returns the list that a formula means by the operand's name; `None` for a number.
    pub(super) fn list(&self) -> Option<NumberList> {
        let elements = self.names.iter().map(|name| Arc::new(Expression::operand(name))).collect();
        let span = (0..0).into();
        self.is_list.then(|| NumberList { elements, axes: self.axes.clone(), span })
    }
}

/// Returns the axes that an entry states. Fails unless they are 2 to 16 different letters.
fn axes_of(record: &TableEntry, key: &str) -> Result<Option<String>, ConfigError> {
    let Some(axes) = record.text("axes") else { return Ok(None) };
    let is_repeated =
        |(at, axis): (usize, char)| axes.chars().take(at).any(|before| before == axis);
    let refusal = if let Some(other) = axes.chars().find(|axis| !axis.is_ascii_lowercase()) {
        format!("an axis is a small letter from a to z, and `{other}` is none")
    } else if let Some((_, axis)) = axes.chars().enumerate().find(|axis| is_repeated(*axis)) {
        format!("the axis `{axis}` is given twice")
    } else if !(2..=LONGEST_LIST).contains(&axes.len()) {
        format!("a list has 2 to {LONGEST_LIST} axes")
    } else {
        return Ok(Some(axes.to_owned()));
    };
    let remedy = "give a different small letter for each number of the list, such as \"xyz\"";
    Err(ConfigError::new(key, refusal, remedy))
}

/// Returns the names of the results of an entry. Without axes of its own, a list has the axes of the lists in its formula. Fails
/// if the axes or the size of the entry do not suit the formula.
pub(super) fn result_names(
    record: &TableEntry,
    formula: &NumberOrList,
) -> Result<Vec<String>, ConfigError> {
    let name = &record.name;
    let key = format!("results.{name}.axes");
    let own = axes_of(record, &key)?;
    let count = formula.elements().len();
    if let Some(size) = record.bits("size").filter(|size| *size as usize != count) {
        let given = match formula {
            NumberOrList::Number(_) => "a single number".to_owned(),
            NumberOrList::List(_) => format!("{count} numbers"),
        };
        let message = format!("`{name}` has size {size}, and its formula gives {given}");
        let key = format!("results.{name}.size");
        return Err(ConfigError::new(key, message, "remove `size`, or change the formula"));
    }
    let list = match formula {
        NumberOrList::List(list) => list,
        NumberOrList::Number(_) if own.is_some() => {
            let message = format!("`{name}` has axes, and its formula gives a single number");
            return Err(ConfigError::new(key, message, "remove `axes`"));
        }
        NumberOrList::Number(_) => return Ok(vec![name.clone()]),
    };
    if let Some(axes) = own.as_ref().filter(|axes| axes.len() != count) {
        let message =
            format!("`{name}` has {} axes, and its formula gives {count} numbers", axes.len());
        return Err(ConfigError::new(key, message, "give as many axes as numbers"));
    }
    let axes = own.or_else(|| list.axes.clone()).filter(|axes| {
        // `n.xx` repeats an axis, so that its letters are no names.
        axes.chars().enumerate().all(|(at, axis)| axes.find(axis) == Some(at))
    });
    Ok(element_names(name, count, axes.as_deref()))
}

/// Returns the documentation of a number of a list, such as `n.x: the normal`. `doc` is the documentation of the whole list, and
/// `number` the name in formulas. If the entry is no list, its documentation stays.
fn doc_of_number(doc: &str, number: &str, is_list: bool) -> String {
    match (is_list, doc) {
        (false, _) => doc.to_owned(),
        (true, "") => number.to_owned(),
        (true, _) => format!("{number}: {doc}"),
    }
}

/// Returns the documentation of the result with the name `port`.
///
/// # Panics
/// Panics if no entry has such a result.
pub fn result_doc(keys: &Keys, port: &str) -> String {
    let entry = result_entry(keys, port);
    let doc = entry.text("doc").unwrap_or_default();
    let name = &entry.name;
    let element = port.strip_prefix(name.as_str()).unwrap_or_default();
    let number = match element.strip_prefix('_') {
        Some(place) => format!("{name}[{place}]"),
        None => format!("{name}.{element}"),
    };
    doc_of_number(doc, &number, !element.is_empty())
}

/// Returns a message of the planner with the numbers of lists as formulas write them: `nx` becomes `n.x`, and `v_0` becomes `v[0]`.
pub(super) fn as_written(keys: &Keys, message: &str) -> String {
    let mut written: Vec<(String, String)> = Vec::new();
    for record in &keys.operands.0 {
        let Ok(ports) = OperandPorts::of(record) else { continue };
        written.extend(ports.names.iter().cloned().zip(ports.written_names(&record.name)));
    }
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut text = String::new();
    let mut rest = message;
    while let Some(start) = rest.find(is_of_name) {
        text += &rest[..start];
        rest = &rest[start..];
        let (word, after) = rest.split_at(rest.find(|c| !is_of_name(c)).unwrap_or(rest.len()));
        let number = written.iter().find(|(port, _)| port == word);
        text += number.map_or(word, |(_, number)| number);
        rest = after;
    }
    text + rest
}

/// Returns the entry of the table `results` that states the result with the name `port`.
///
/// # Panics
/// Panics if no entry has such a result.
pub fn result_entry<'k>(keys: &'k Keys, port: &str) -> &'k TableEntry {
    entry(&keys.results.0, port)
}

/// Returns the entry of the table `operands` that states the operand with the name `port`. Panics if no entry has such an operand.
pub(super) fn operand_entry<'k>(keys: &'k Keys, port: &str) -> &'k TableEntry {
    entry(&keys.operands.0, port)
}

fn entry<'k>(records: &'k [TableEntry], port: &str) -> &'k TableEntry {
    let is_element = |record: &TableEntry| {
        let end = port.strip_prefix(record.name.as_str());
        end.is_some_and(|end| match end.strip_prefix('_') {
            Some(number) => number.bytes().all(|digit| digit.is_ascii_digit()),
            None => end.len() == 1,
        })
    };
    let own = records.iter().find(|record| record.name == port);
    own.or_else(|| records.iter().find(|record| is_element(record))).expect("a stated port")
}
