//! What a design must be before anything is derived from it.
//!
//! rust_hdl's own `check_all` finds open pins and writes to inputs. This check finds the rest: missing
//! drivers, combinational loops, widths that do not match, duplicate or illegal names, words that
//! cannot be reached, and registers loaded with a product under a selection that means another one.

use std::collections::{HashMap, HashSet};
use std::fmt;

use crate::base::fixed::{MAX_WIDTH, mask};
use crate::base::identifier;
use crate::hdl::dsl::{Place, View};
use crate::hdl::netlist::{Design, Driver, FieldKind, NetId, Op, Sequence, Word};

/// A mistake in a description.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// What is wrong, with the names of the signals.
    pub message: String,
    /// Where in the Rust source.
    pub location: Place,
    /// Other places that take part.
    pub notes: Vec<(String, Place)>,
}

impl Diagnostic {
    pub(crate) fn new(message: String, location: Place) -> Self {
        Self { message, location, notes: Vec::new() }
    }

    pub(crate) fn note(mut self, note: String, location: Place) -> Self {
        self.notes.push((note, location));
        self
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "error: {}\n  --> {}", self.message, self.location)?;
        for (note, location) in &self.notes {
            write!(f, "\n  note: {note}: {location}")?;
        }
        Ok(())
    }
}

/// All mistakes of a description.
#[derive(Clone, Debug)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (at, diagnostic) in self.0.iter().enumerate() {
            if at > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{diagnostic}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Every mistake of `design`; `views` are the products that a selection gives their meaning.
pub(crate) fn check(design: &Design, views: &HashMap<NetId, View>) -> Vec<Diagnostic> {
    let mut checker = Checker { design, views, found: Vec::new() };
    checker.names();
    checker.drivers();
    checker.widths();
    checker.roms();
    if checker.found.is_empty() {
        checker.loops();
    }
    if checker.found.is_empty() {
        checker.words();
    }
    checker.found
}

struct Checker<'a> {
    design: &'a Design,
    views: &'a HashMap<NetId, View>,
    found: Vec<Diagnostic>,
}

impl Checker<'_> {
    fn report(&mut self, message: String, location: Place) {
        self.found.push(Diagnostic::new(message, location));
    }

    fn name(&self, id: NetId) -> &str {
        &self.design.net(id).name
    }

    fn names(&mut self) {
        let design = self.design;
        let mut seen: HashMap<&str, Place> = HashMap::new();
        let nets = design.nets.iter().map(|net| (net.name.as_str(), net.location));
        let roms = design.roms.iter().map(|rom| (rom.name.as_str(), rom.location));
        for (name, location) in nets.chain(roms) {
            if name == "clk" {
                self.report(
                    "`clk` is the clock of every design; choose another name".to_owned(),
                    location,
                );
            } else if let Err(why) = identifier::check(name) {
                self.report(format!("`{name}` cannot be a Verilog name: {why}"), location);
            }
            if let Some(first) = seen.insert(name, location) {
                let diagnostic =
                    Diagnostic::new(format!("the name `{name}` is used twice"), location);
                self.found.push(diagnostic.note("the first".to_owned(), first));
            }
        }
        if let Err(why) = identifier::check(&design.name) {
            let location = design.nets.first().map(|net| net.location);
            if let Some(location) = location {
                self.report(
                    format!("`{}` cannot be the name of a Verilog module: {why}", design.name),
                    location,
                );
            }
        }
    }

    fn drivers(&mut self) {
        for net in &self.design.nets {
            if net.driver == Driver::Undriven {
                self.report(format!("nothing drives `{}`", net.name), net.location);
            }
        }
        for register in &self.design.registers {
            let net = self.design.net(register.q);
            if register.data.is_none() {
                self.report(
                    format!("nothing drives the data input of register `{}`", net.name),
                    net.location,
                );
            }
        }
    }

    fn loops(&mut self) {
        if let Err(path) = self.design.levelise() {
            let mut names: Vec<&str> = path.iter().rev().map(|&id| self.name(id)).collect();
            names.extend(names.first().copied());
            let names = names.join("` -> `");
            let location = self.design.net(path[0]).location;
            self.report(format!("combinational loop: `{names}`"), location);
        }
    }

    fn widths(&mut self) {
        let design = self.design;
        for (id, net) in design.iter() {
            let width = net.format.width();
            if width > MAX_WIDTH {
                self.report(
                    format!("`{}` is {width} bits wide; {MAX_WIDTH} is the most", net.name),
                    net.location,
                );
            }
            let (low, high) = net.range;
            if low > high || !net.format.holds(low) || !net.format.holds(high) {
                self.report(
                    format!(
                        "`{}` is {}, but takes values from {low} to {high} ulp",
                        net.name, net.format
                    ),
                    net.location,
                );
            }
            if let Driver::Op(op) = &net.driver
                && let Err(why) = self.cell(id, op)
            {
                let operands: Vec<String> = op
                    .operands()
                    .iter()
                    .map(|&operand| {
                        format!("`{}` ({})", self.name(operand), design.net(operand).format)
                    })
                    .collect();
                self.report(
                    format!(
                        "`{}` ({}) = {} of {}: {why}",
                        net.name,
                        net.format,
                        op.mnemonic(),
                        operands.join(", ")
                    ),
                    net.location,
                );
            }
        }
        for register in &design.registers {
            let net = design.net(register.q);
            let width = |id: NetId| design.width(id);
            if register.data.is_some_and(|data| width(data) != width(register.q)) {
                self.report(
                    format!("register `{}` and its data differ in width", net.name),
                    net.location,
                );
            }
            if register.enable.is_some_and(|enable| width(enable) != 1) {
                self.report(
                    format!("the enable of register `{}` is not one bit", net.name),
                    net.location,
                );
            }
        }
    }

    /// The widths that an [`Op`] asks for.
    fn cell(&self, id: NetId, op: &Op) -> Result<(), &'static str> {
        let width = |id: NetId| self.design.width(id);
        let signed = |id: NetId| self.design.net(id).format.signed;
        let own = width(id);
        let same = |operands: &[NetId]| operands.iter().all(|&operand| width(operand) == own);
        let ok = |holds: bool, why: &'static str| if holds { Ok(()) } else { Err(why) };
        const EQUAL: &str = "the widths must be equal";
        const BIT: &str = "the result is one bit";
        match op {
            Op::Relabel(a) | Op::Not(a) => ok(same(&[*a]), EQUAL),
            Op::Extend(a) => ok(width(*a) < own, "the result must be wider"),
            Op::Slice { of, low } => ok(low + own <= width(*of), "the bits are not all there"),
            Op::Concat(parts) => ok(
                parts.iter().map(|&part| width(part)).sum::<u32>() == own,
                "the widths must add up",
            ),
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) | Op::Sub(a, b) => {
                ok(same(&[*a, *b]), EQUAL)
            }
            Op::Add { a, b, carry } => {
                ok(carry.is_none_or(|carry| width(carry) == 1), "the carry is one bit")?;
                ok(same(&[*a, *b]), EQUAL)
            }
            Op::Mul(a, b) => {
                ok(signed(*a) == signed(*b), "one operand is signed, the other is not")?;
                ok(width(*a) + width(*b) == own, "the product is as wide as both together")
            }
            Op::Equal(a, b) => {
                ok(width(*a) == width(*b), EQUAL)?;
                ok(own == 1, BIT)
            }
            Op::Less(a, b) => {
                ok(width(*a) == width(*b), EQUAL)?;
                ok(signed(*a) == signed(*b), "one operand is signed, the other is not")?;
                ok(own == 1, BIT)
            }
            Op::Any(_) | Op::All(_) => ok(own == 1, BIT),
            Op::Mux { select, inputs } => {
                ok(inputs.len() >= 2, "a mux has two inputs or more")?;
                let needed = usize::BITS - (inputs.len() - 1).leading_zeros();
                ok(width(*select) >= needed, "the select lines are too few")?;
                ok(same(inputs), EQUAL)
            }
        }
    }

    fn roms(&mut self) {
        for rom in &self.design.roms {
            let width = self.design.width(rom.data);
            if let Some(at) = rom.words.iter().position(|&word| word & !mask(width) != 0) {
                self.report(
                    format!("ROM `{}`: word {at} does not fit {width} bits", rom.name),
                    rom.location,
                );
            }
            if !rom.comments.is_empty() && rom.comments.len() != rom.words.len() {
                self.report(
                    format!(
                        "ROM `{}`: {} comments for {} words",
                        rom.name,
                        rom.comments.len(),
                        rom.words.len()
                    ),
                    rom.location,
                );
            }
        }
    }

    fn words(&mut self) {
        let control = &self.design.control;
        let words = &control.words;
        let mut reached = vec![false; words.len()];
        let mut pending = vec![0];
        while let Some(at) = pending.pop() {
            let Some(word) = words.get(at) else {
                if let Some(last) = words.last() {
                    self.report(
                        format!("the last word, `{}`, does not end", last.name),
                        last.location,
                    );
                }
                continue;
            };
            if std::mem::replace(&mut reached[at], true) {
                continue;
            }
            match word.sequence {
                Sequence::Next | Sequence::WaitStart => pending.push(at + 1),
                Sequence::LoopWhile { to, .. } => pending.extend([at + 1, to]),
                Sequence::End => {}
            }
        }
        for (word, reached) in words.iter().zip(reached) {
            if !reached {
                self.report(format!("word `{}` cannot be reached", word.name), word.location);
            }
        }
        if let Some(idle) = words.first() {
            if idle.sequence != Sequence::Next {
                self.report(
                    format!(
                        "word `{}` is where the device waits for start; it goes on to the next",
                        idle.name
                    ),
                    idle.location,
                );
            }
            for (field, value) in control.fields.iter().zip(&idle.values) {
                if *value != 0 && matches!(field.kind, FieldKind::Enable | FieldKind::Flag) {
                    self.report(
                        format!(
                            "word `{}` turns `{}`, but the device also waits for start in it",
                            idle.name, field.name
                        ),
                        idle.location,
                    );
                }
            }
        }
        for (at, field) in control.fields.iter().enumerate() {
            let net = self.design.net(field.net);
            if matches!(field.kind, FieldKind::Enable)
                && words.iter().all(|word| word.values[at] == 0)
            {
                self.report(format!("no word turns `{}`", field.name), net.location);
            }
        }
        for at in 0..words.len() {
            self.selections(at);
        }
    }

    /// Every register that word `at` loads takes a product that the selection of the word gives; behind
    /// pipeline registers, that the selections of the words before it give.
    fn selections(&mut self, at: usize) {
        let design = self.design;
        let words = &design.control.words;
        for register in &design.registers {
            let Some(Driver::Field(enable)) = register.enable.map(|id| &design.net(id).driver)
            else {
                continue;
            };
            let loaded = words[at].values[enable.index()] == 1;
            let Some(data) = register.data.filter(|_| loaded) else {
                continue;
            };
            let mut seen = HashSet::new();
            let mut pending = vec![(at, data)];
            while let Some((now, id)) = pending.pop() {
                if !seen.insert((now, id)) {
                    continue;
                }
                if let Some(view) = self.views.get(&id)
                    && let Some(wrong) =
                        earlier(design, now, view.delay).into_iter().find(|&word| {
                            !view.values.contains(&words[word].values[view.field.index()])
                        })
                {
                    let diagnostic = self.wrong_product(at, wrong, register.q, view);
                    let place = design.net(id).location;
                    self.found.push(diagnostic.note("the product".to_owned(), place));
                    break;
                }
                if let Driver::Op(Op::Mux { select, inputs }) = &design.net(id).driver
                    && let Some(chosen) = self.selected(&words[now], *select)
                {
                    // Of a mux that the word turns, only the chosen input matters.
                    let chosen = inputs.get(chosen as usize).or(inputs.last());
                    pending.extend(chosen.map(|&input| (now, input)));
                    continue;
                }
                match &design.net(id).driver {
                    Driver::Register(of) if design.register(*of).enable.is_none() => {
                        let data = design.register(*of).data;
                        let before = earlier(design, now, 1).into_iter();
                        pending.extend(before.filter_map(|word| Some((word, data?))));
                    }
                    _ => {
                        let inputs = design.combinational_inputs(id).into_iter();
                        pending.extend(inputs.map(|input| (now, input)));
                    }
                }
            }
        }
    }

    /// What `word` puts on a select line: a field, or bits of one.
    fn selected(&self, word: &Word, select: NetId) -> Option<u64> {
        let net = self.design.net(select);
        match net.driver {
            Driver::Field(field) => Some(word.values[field.index()]),
            Driver::Op(Op::Relabel(of)) => self.selected(word, of),
            Driver::Op(Op::Slice { of, low }) => {
                let bits = self.selected(word, of)? >> low;
                Some(bits & mask(net.format.width()))
            }
            _ => None,
        }
    }

    /// Word `at` loads `register`, but the selection of word `under` is wrong for that.
    fn wrong_product(&self, at: usize, under: usize, register: NetId, view: &View) -> Diagnostic {
        let field = &self.design.control.fields[view.field.index()];
        let choice = |value: u64| match &field.kind {
            FieldKind::Select(choices) => {
                choices.get(value as usize).map_or("nothing", String::as_str)
            }
            _ => "nothing",
        };
        let wanted: Vec<&str> = view.values.iter().map(|&value| choice(value)).collect();
        let words = &self.design.control.words;
        let (word, under) = (&words[at], &words[under]);
        let selector = match view.delay {
            0 => String::new(),
            _ => format!("word `{}` before it ", under.name),
        };
        let message = format!(
            "word `{}` loads `{}` with the product of ({}), but {selector}selects ({})",
            word.name,
            self.name(register),
            wanted.join(") or ("),
            choice(under.values[view.field.index()]),
        );
        Diagnostic::new(message, under.location)
    }
}

/// The words from which control comes to word `at` in `clocks` clocks. Idle, the device stays in word 0.
fn earlier(design: &Design, at: usize, clocks: u32) -> Vec<usize> {
    let words = &design.control.words;
    let leads = |from: usize, to: usize| match words[from].sequence {
        Sequence::Next => to == from + 1 || (from == 0 && to == 0),
        Sequence::WaitStart => to == from || to == from + 1,
        Sequence::LoopWhile { to: back, .. } => to == back || to == from + 1,
        Sequence::End => to == 0,
    };
    (0..clocks).fold(vec![at], |after, _| {
        (0..words.len()).filter(|&from| after.iter().any(|&to| leads(from, to))).collect()
    })
}
