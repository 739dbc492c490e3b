//! Checks the names of the operands, parts and results of the device `expression`.
//!
//! An operand is a port of the core, and has a register and a write strobe with names of their own. A result `r` is a port
//! `r_out`. The emitted files contain further names, for example of the bus registers and of constants in the test bench. If a
//! name collides with another, the check refuses it and proposes a similar name that is free.

use glint_base::identifier;
use glint_formula::{EULER, Kind, parse};

/// Names that a core or its files use themselves, and for what.
struct TakenNames {
    names: &'static [&'static str],
    what: &'static str,
}

/// No operand can have these names, in any mix of upper and lower case: VHDL and C macros do not distinguish case.
const TAKEN: [TakenNames; 6] = [
    TakenNames {
        names: &[
            "clk",
            "rst_n",
            "start",
            "busy",
            "valid",
            "done",
            "in_valid",
            "in_ready",
            "out_valid",
            "out_ready",
            "side_in",
            "side_out",
        ],
        what: "every core has a port of this name",
    },
    TakenNames {
        names: &[
            "control",
            "control_word",
            "following_word",
            "go_on",
            "idle",
            "last_word",
            "next_run",
            "next_word",
            "not_busy",
            "run",
            "valid_word",
            "word_address",
        ],
        what: "the sequencer of every core has a signal of this name",
    },
    TakenNames { names: &["advance"], what: "every pipeline has a signal of this name" },
    TakenNames {
        names: &["configuration", "interrupt_enable", "interrupt_pending", "results", "status"],
        what: "the bus registers of a core have a register of this name",
    },
    TakenNames {
        names: &["clocks", "expected_file", "known_from", "reported", "stimulus_file", "transfer"],
        what: "the test bench or the C header uses this name",
    },
    TakenNames {
        names: &[
            "and", "as", "assert", "async", "await", "bool", "break", "class", "continue", "def",
            "del", "elif", "else", "except", "false", "finally", "for", "from", "global", "if",
            "import", "in", "is", "lambda", "none", "nonlocal", "not", "or", "pass", "raise",
            "return", "true", "try", "while", "with", "yield",
        ],
        what: "this is a keyword of Python or of Verilog simulators, and the benches contain the name",
    },
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamedTable {
    Operands,
    Parts,
    Results,
}

impl NamedTable {
    pub(super) fn key(self) -> &'static str {
        match self {
            Self::Operands => "operands",
            Self::Parts => "let",
            Self::Results => "results",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NameFault {
    /// The entry's number in the list that was checked.
    pub(super) entry: usize,
    /// The reason.
    pub(super) message: String,
    pub(super) remedy: String,
}

/// Checks the names of all entries, and fails at the first one that cannot be used. The remedy proposes another name, if the name
/// has only legal characters.
pub(super) fn check(entries: &[(NamedTable, &str)]) -> Result<(), NameFault> {
    for (entry, (table, name)) in entries.iter().enumerate() {
        let others: Vec<(NamedTable, &str)> =
            entries.iter().enumerate().filter(|(at, _)| *at != entry).map(|(_, it)| *it).collect();
        // The second of two entries with the same name is refused.
        let found = obstacle(*table, name, &entries[..entry]);
        let Some(message) = found.or_else(|| owned_name(name, &others)) else { continue };
        let remedy = match free_name(*table, name, &others) {
            Some(free) => format!("give the entry another name, for example `{free}`"),
            None => "give a name of lower-case letters, digits and _".to_owned(),
        };
        return Err(NameFault { entry, message, remedy });
    }
    Ok(())
}

/// Returns the reason why an entry of `table` cannot have the name `name` beside `others`, apart from names that other entries
/// own ([`owned_name`]).
fn obstacle(table: NamedTable, name: &str, others: &[(NamedTable, &str)]) -> Option<String> {
    if let Err(fault) = identifier::check(name) {
        return Some(fault.to_owned());
    }
    if name != EULER && parse(name).ok().is_none_or(|it| !matches!(it.kind, Kind::Operand(_))) {
        return Some(format!("`{name}` is a constant of formulas"));
    }
    let in_lower_case = name.to_ascii_lowercase();
    for group in TAKEN {
        if table == NamedTable::Operands && group.names.contains(&in_lower_case.as_str()) {
            return Some(format!("`{name}` cannot be an operand: {}", group.what));
        }
    }
    for (other_table, other) in others {
        if other == &name {
            return Some(format!("[{}] has the name `{name}` already", other_table.key()));
        }
        let differs_in_case = other.to_ascii_lowercase() == in_lower_case;
        if differs_in_case && table != NamedTable::Parts && *other_table != NamedTable::Parts {
            return Some(format!(
                "`{name}` and `{other}` differ only in upper and lower case, which VHDL and C macros do not distinguish"
            ));
        }
    }
    None
}

/// Returns a message if one of `others` gives the name to its own signal, such as a register.
fn owned_name(name: &str, others: &[(NamedTable, &str)]) -> Option<String> {
    let mut owners = others.iter();
    owners.find_map(|owner| {
        let what = owned_as(*owner, name)?;
        Some(format!("`{name}` is the name of the {what} `{}`", owner.1))
    })
}

/// Further signals of an operand: the enable and the data of its register, its buffer, and the comparisons that limit it to its
/// domain.
const ENDINGS: [&str; 7] =
    ["_load", "_next", "_buffer", "_under", "_over", "_at_least", "_at_most"];

/// Returns the role of `name` if the entry `owner` gives it to something of its own: the operand `x` has a register `x_reg`.
fn owned_as((table, owner): (NamedTable, &str), name: &str) -> Option<&'static str> {
    let end = name.strip_prefix(owner)?;
    match (table, end) {
        (NamedTable::Operands, "_reg") => Some("register of the operand"),
        (NamedTable::Operands, "_write") => Some("write strobe of the operand"),
        (NamedTable::Operands, end) if ENDINGS.contains(&end) => Some("signal of the operand"),
        (NamedTable::Results, "_out") => Some("port of the result"),
        _ => None,
    }
}

/// Returns a similar name that an entry of `table` can have beside `others`, if one is found.
fn free_name(table: NamedTable, name: &str, others: &[(NamedTable, &str)]) -> Option<String> {
    let mut candidates = vec![format!("{name}_value")];
    candidates.extend((1..10).map(|number| format!("{name}{number}")));
    candidates.into_iter().find(|candidate| {
        obstacle(table, candidate, others).or_else(|| owned_name(candidate, others)).is_none()
    })
}

#[cfg(test)]
mod tests {
    use super::NamedTable::{Operands, Parts, Results};
    use super::*;

    fn fault(entries: &[(NamedTable, &str)]) -> NameFault {
        check(entries).expect_err("a fault")
    }

    #[test]
    fn names_that_collide_are_refused_with_a_free_name() {
        let taken = fault(&[(Operands, "y"), (Operands, "lambda")]);
        assert_eq!((taken.entry, taken.remedy.contains("`lambda_value`")), (1, true));
        assert!(
            fault(&[(Operands, "T"), (Operands, "t")]).message.contains("upper and lower case")
        );
        assert!(fault(&[(Results, "R"), (Results, "r")]).message.contains("upper and lower case"));
        assert!(fault(&[(Operands, "x"), (Operands, "x_reg")]).message.contains("register"));
        assert!(fault(&[(Operands, "x_write"), (Operands, "x")]).message.contains("write strobe"));
        assert!(
            fault(&[(Operands, "r_out"), (Results, "r")]).message.contains("port of the result")
        );
        assert!(fault(&[(Operands, "CLOCKS")]).message.contains("test bench"));
        assert!(fault(&[(Operands, "pi")]).message.contains("constant of formulas"));
        assert!(fault(&[(Operands, "x"), (Parts, "x")]).message.contains("already"));
        assert!(fault(&[(Operands, "1x")]).remedy.contains("lower-case letters"));
    }

    #[test]
    fn other_names_are_accepted() {
        let names = [
            (Operands, "T"),
            (Operands, "sum_next"),
            (Operands, "product_of_factors"),
            (Parts, "t"),
            (Parts, "run"),
            (Results, "lambda"),
            (Results, "t_value"),
        ];
        assert_eq!(check(&names), Ok(()));
    }
}
