//! Checks that a register loads a product of a shared multiplier only in microinstructions that select the operands of this
//! product.

use std::collections::{HashMap, HashSet};

use super::SelectedProduct;
use crate::netlist::{Design, Driver, FieldKind, NetId, passed_on};
use glint_base::codes;
use glint_base::diagnostic::Diagnostic;

pub(super) fn check(design: &Design, views: &HashMap<NetId, SelectedProduct>) -> Vec<Diagnostic> {
    let mut checker = Checker { design, views, found: Vec::new() };
    for at in 0..design.control.microprogram.len() {
        checker.selections(at);
    }
    checker.found
}

struct Checker<'a> {
    design: &'a Design,
    views: &'a HashMap<NetId, SelectedProduct>,
    found: Vec<Diagnostic>,
}

impl Checker<'_> {
    /// Checks every register that microinstruction `at` loads. If the register's data depends on a shared product,
    /// microinstruction `at` must select the product's operands. With n registers behind the selecting mux, the
    /// microinstructions n clocks earlier must do so.
    fn selections(&mut self, at: usize) {
        let design = self.design;
        let microprogram = &design.control.microprogram;
        for register in &design.registers {
            let Some(Driver::Field(enable)) = register.enable.map(|id| &design.net(id).driver)
            else {
                continue;
            };
            let loaded = microprogram[at].values[enable.index()] == 1;
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
                        design.control.predecessors(now, view.delay).into_iter().find(|&from| {
                            !view.values.contains(&microprogram[from].values[view.field.index()])
                        })
                {
                    let diagnostic = self.wrong_product(at, wrong, register.q, view);
                    let location = design.net(id).location;
                    self.found.push(diagnostic.note("the product".to_owned(), location));
                    break;
                }
                match &design.net(id).driver {
                    Driver::Register(of) if design.register(*of).enable.is_none() => {
                        let data = design.register(*of).data;
                        let before = design.control.predecessors(now, 1).into_iter();
                        pending.extend(before.filter_map(|from| Some((from, data?))));
                    }
                    _ => {
                        let inputs = passed_on(design, &microprogram[now], id).into_iter();
                        pending.extend(inputs.map(|input| (now, input)));
                    }
                }
            }
        }
    }

    /// Returns the mistake: microinstruction `at` loads `register` with the product `view`, but `under` selects the operands of
    /// another product.
    fn wrong_product(
        &self,
        at: usize,
        under: usize,
        register: NetId,
        view: &SelectedProduct,
    ) -> Diagnostic {
        let field = &self.design.control.fields[view.field.index()];
        let choice = |value: u64| match &field.kind {
            FieldKind::Select(choices) => {
                choices.get(value as usize).map_or("nothing", String::as_str)
            }
            _ => "nothing",
        };
        let wanted: Vec<&str> = view.values.iter().map(|&value| choice(value)).collect();
        let microprogram = &self.design.control.microprogram;
        let (microinstruction, under) = (&microprogram[at], &microprogram[under]);
        let selector = match view.delay {
            0 => String::new(),
            _ => format!("the preceding microinstruction `{}` ", under.name),
        };
        let message = format!(
            "microinstruction `{}` loads `{}` with the product of ({}), but {selector}selects ({})",
            microinstruction.name,
            self.design.net(register).name,
            wanted.join(") or ("),
            choice(under.values[view.field.index()]),
        );
        Diagnostic::new(codes::PRODUCT, message, under.location)
    }
}
