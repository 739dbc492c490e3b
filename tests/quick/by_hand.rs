//! Compares values that were worked out by hand with the design in the built-in simulator and with the golden model.
//!
//! The values are in the files of `tests/quick/by_hand/`; the `README.md` there describes their format.

use glint::config::{Config, KeyKind, Schema, parse};
use glint::golden::Model;
use glint::hdl::netlist::Design;
use glint::registry::{Device, Registry};
use rayon::prelude::*;

use crate::common::Sure;
use crate::common::cores::device;
use crate::common::files::{paths, read};
use crate::common::host::Host;

/// More clocks than any computation there takes.
const LIMIT: u32 = 1000;

/// Returns the schema without lower limits and conditions, so that words can be small enough to follow by hand.
fn widened(mut schema: Schema) -> Schema {
    schema.check = |_, _| ();
    for key in &mut schema.keys {
        if let KeyKind::Integer { min, .. } | KeyKind::Integers { min, .. } = &mut key.kind {
            *min = 0;
        }
    }
    schema
}

fn configuration(path: &str, text: &str) -> (Device, Config) {
    let catalogue = Registry::catalogue();
    let schemas: Vec<Schema> =
        catalogue.devices().iter().map(|device| widened((device.schema)())).collect();
    let config = parse("by_hand.toml", text, &schemas).sure_of(path);
    (device(&config.device), config)
}

/// The design in the simulator and the golden model, which get the same inputs.
struct Pair<'a> {
    design: &'a Design,
    host: Host<'a>,
    model: Box<dyn Model>,
    operands: Vec<(&'a str, Option<i64>)>,
    signals: Vec<&'a str>,
}

impl<'a> Pair<'a> {
    /// At power-up, with the operands and signals that the head of a group names.
    fn new(design: &'a Design, model: Box<dyn Model>, head: &'a str) -> Self {
        let (operands, signals) = head.split_once("=>").expect("operands => signals");
        let operand = |text: &'a str| match text.split_once('=') {
            Some((name, value)) => (name, Some(value.parse().expect("a value"))),
            None => (text, None),
        };
        Self {
            design,
            host: Host::new(design),
            model,
            operands: operands.split_whitespace().map(operand).collect(),
            signals: signals.split_whitespace().collect(),
        }
    }

    /// A clock with these inputs, and 0 at all others.
    fn clock(&mut self, inputs: &[(String, u64)]) {
        let of =
            |input: &String| inputs.iter().find(|(name, _)| name == input).map_or(0, |it| it.1);
        let bits: Vec<u64> = self.model.inputs().iter().map(of).collect();
        for (input, &bits) in self.model.inputs().iter().zip(&bits) {
            self.host.set(input, bits);
        }
        self.host.clock();
        self.model.clock(&bits);
    }

    /// A clock in which operands are written, each with the next of these values unless it has its own.
    fn write(&mut self, start: bool, mut values: impl Iterator<Item = i64>) {
        let mut inputs = vec![("rst_n".to_owned(), 1), ("start".to_owned(), u64::from(start))];
        for &(name, constant) in &self.operands {
            let raw = constant.or_else(|| values.next()).expect("a value for each operand");
            let net = self.design.find(name).unwrap_or_else(|| panic!("no operand {name}"));
            inputs.push((name.to_owned(), self.design.net(net).format.bits(raw.into())));
            inputs.push((format!("{name}_write"), 1));
        }
        self.clock(&inputs);
    }

    /// Goes on without a write until a signal of one bit is this, and returns the clocks.
    fn until(&mut self, signal: &str, bit: u64) -> u32 {
        let idle = [("rst_n".to_owned(), 1)];
        for clock in 0..LIMIT {
            if self.host.value(signal) == bit {
                return clock;
            }
            self.clock(&idle);
        }
        panic!("{signal} is never {bit}");
    }

    fn assert_shows(&self, expected: &str, clock: u32, place: &str) {
        let expected: Vec<&str> = expected.split_whitespace().collect();
        assert_eq!(expected.len(), self.signals.len(), "{place}");
        for (&signal, expected) in self.signals.iter().zip(expected) {
            let shown = match signal {
                "clock" => [clock.into(); 2],
                _ => [Some(self.host.value(signal)), self.model.value(signal)]
                    .map(|value| value.unwrap_or_else(|| panic!("no {signal}: {place}"))),
            };
            if expected != "-" {
                assert_eq!(shown.map(|it| it.to_string()), [expected; 2], "{signal}: {place}");
            }
        }
    }

    fn play(&mut self, row: &str, place: &str, is_first: &mut bool) {
        if let Some((operands, expected)) = row.split_once("=>") {
            self.until("busy", 0);
            let values = operands.split_whitespace().map(|it| it.parse().expect("a value"));
            let named = self.operands.iter().filter(|operand| operand.1.is_none());
            assert_eq!(values.clone().count(), named.count(), "{place}");
            self.write(true, values);
            if !expected.is_empty() {
                let clock = 1 + self.until("valid", 1);
                self.assert_shows(expected, clock, place);
            }
            *is_first = true;
        } else if row == "reset" {
            self.clock(&[("start".to_owned(), 1)]);
            *is_first = true;
        } else {
            if !std::mem::take(is_first) {
                self.write(false, std::iter::repeat(1));
            }
            self.assert_shows(row, 0, place);
        }
    }
}

#[test]
fn designs_and_golden_models_show_what_was_worked_out() {
    paths("tests/quick/by_hand", ".txt").into_par_iter().for_each(|path| {
        let text = read(&path);
        let (common, cores) = text.split_once("\n## ").expect("a core");
        for core in cores.split("\n## ") {
            let title = core.lines().next().unwrap_or_default();
            let place = format!("{path}: {title}");
            let mut groups = core[title.len()..].split("\n-- ");
            let keys = groups.next().unwrap_or_default();
            let (device, config) = configuration(&place, &format!("{common}\n{keys}\n"));
            let opened = device.open(config).sure_of(&place);
            let design = opened.sequential().sure_of(&place);
            for group in groups {
                let (head, rows) = group.split_once('\n').expect("rows");
                let mut pair = Pair::new(&design, opened.golden(), head);
                let mut is_first = false;
                for row in rows.lines().map(|row| row.split('#').next().unwrap_or("").trim()) {
                    if !row.is_empty() {
                        pair.play(row, &format!("{place}: {row}"), &mut is_first);
                    }
                }
            }
        }
    });
}
