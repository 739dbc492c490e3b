//! Writes, for Gappa, the statements of one case of a device that computes points: each output differs from the formula
//! by at most the bound.

use std::collections::{BTreeMap, HashMap};

use super::cases::Case;
use super::exact::{self, Branch, FormulaContext};
use super::hardware::{self, Hardware, NodeValue, Variables};
use super::premises;
use super::script::GappaScript;
use super::statement::Statements;
use super::task::Task;
use super::terms::{RealTerm, RealTermId, RealTerms};
use glint_base::fixed::exp2;
use glint_formula::Expression;
use glint_rtl::pipeline::{Cell, NodeId, NodeOp};

impl Task<'_> {
    /// Returns the variable and the divisor of each operand. If the formula divides an operand by a power of two
    /// throughout, the variable is the quotient. For example, a formula that has `exponent` only in `exponent / 8` has
    /// the variable `exponent_over_8` and the divisor 3.
    fn variables(&self) -> HashMap<String, (String, i32)> {
        let mut divisors = HashMap::new();
        self.formulas.iter().for_each(|formula| exact::divisors(formula, &mut divisors));
        let operands = self.contract.operands().iter().map(|operand| {
            let divisor = divisors.get(&operand.name).copied().flatten().unwrap_or(0);
            let name = match divisor {
                0 => operand.name.clone(),
                _ => format!("{}_over_{}", operand.name, 1 << divisor),
            };
            (operand.name.clone(), (name, divisor))
        });
        operands.collect()
    }

    /// Adds the statements of one case.
    pub(super) fn state(&self, case: &Case, statements: &mut Statements) -> Result<(), String> {
        let variables = self.variables();
        let mut ranges = HashMap::new();
        let mut placed = Variables::new();
        let mut operands = Vec::new();
        for port in &self.unrolled.operands {
            let name = &self.design.net(*port).name;
            let operand = self.contract.operands().iter().find(|operand| operand.name == *name);
            let operand = operand.ok_or_else(|| format!("the contract has no operand `{name}`"))?;
            let (variable, divisor) = &variables[name];
            placed.push((variable.clone(), operand.format.frac + divisor));
            let domain = (operand.domain.0.into(), operand.domain.1.into());
            let known = self.operand(name).and_then(|node| case.known.get(&node).copied());
            let (low, high): (i128, i128) = known.unwrap_or(domain);
            let value = |raw: i128| raw as f64 * exp2(-operand.format.frac);
            ranges.insert(name.clone(), (value(low), value(high)));
            let quotient = |raw: i128| value(raw) * exp2(-divisor);
            operands.push((variable.clone(), (quotient(low), quotient(high))));
        }
        let words: HashMap<String, Vec<f64>> = self
            .design
            .roms
            .iter()
            .map(|rom| {
                let format = self.design.net(rom.data).format;
                let words = rom.words.iter().map(|&word| format.to_f64(format.raw(word)));
                (rom.name.clone(), words.collect())
            })
            .collect();
        let setting = FormulaContext {
            variables: &variables,
            ranges: &ranges,
            words: &words,
            operands: self.contract.operands(),
        };
        let hardware = Hardware::new(self.view, case, placed, self.tables);
        for premise in premises::of(self.view, case, &hardware, &operands)? {
            statements.push(&premise.about, vec![premise.script]);
        }
        let colours: Vec<_> =
            self.contract.operands().iter().filter(|operand| operand.colour).collect();
        for (at, (output, node)) in self.outputs()?.into_iter().enumerate() {
            let mut terms = RealTerms::default();
            let mut hardware = hardware.clone();
            let out = hardware.value(&mut terms, node)?;
            let presupposed = self.presupposed(case, &mut hardware, &mut terms, &operands);
            let (out, scale) = hardware::placed(&mut terms, out, 0);
            let out = hardware::scaled(&mut terms, out, scale, "out");
            // The formula is multiplied by this factor: the colour, or the number of output units in 1.0.
            let (factor, formulas) = match self.contract.highlight() {
                Some(_) => (real_operand(&colours[at].name, &setting, &mut terms)?, self.formulas),
                None => {
                    let unit = exp2(self.contract.outputs()[at].format.frac);
                    (terms.number(unit), std::slice::from_ref(&self.formulas[at]))
                }
            };
            let hardware_terms = terms.count();
            let mut ways: Vec<Vec<Branch>> = Vec::new();
            for formula in formulas {
                ways.push(exact::branches(formula, &setting, &mut terms)?);
            }
            for chosen in together(&ways) {
                if chosen.iter().any(|way| way.is_never(&terms)) {
                    continue;
                }
                let script = GappaScript {
                    terms: &terms,
                    hardware_terms,
                    placed: &hardware.variables,
                    presupposed: &presupposed,
                    ways: &chosen,
                };
                let text = |way: &Branch| script.text(out, factor, way.term, self.bound);
                let mut scripts: Vec<String> = chosen.iter().map(text).collect();
                scripts.dedup();
                statements.push(&output, scripts);
            }
        }
        Ok(())
    }

    /// Returns the case's hypotheses on values that have a translation. It may leave out the others, because fewer
    /// hypotheses only leave more to prove.
    fn presupposed(
        &self,
        case: &Case,
        hardware: &mut Hardware,
        terms: &mut RealTerms,
        operands: &[(String, (f64, f64))],
    ) -> BTreeMap<RealTermId, (f64, f64)> {
        let mut presupposed = BTreeMap::new();
        // The formula may read words that nothing in the hardware depends on any more.
        for (at, node) in self.graph().nodes.iter().enumerate() {
            if let Cell::Read { address, .. } = node.cell
                && matches!(self.graph().node(address).cell, Cell::Operand(_))
            {
                let _ = hardware.value(terms, NodeId(at as u32));
            }
        }
        for (&node, &(low, high)) in &case.known {
            if let Some(NodeValue::Term { id, scale }) = hardware.expression(terms, node) {
                let value = |raw: i128| raw as f64 * exp2(-scale);
                presupposed.insert(id, (value(low), value(high)));
            }
            if let (Cell::Op(NodeOp::Less(a, b)), true) =
                (&self.graph().node(node).cell, low == high)
            {
                presupposed.extend(hardware.compared(terms, (*a, *b), low == 1));
            }
        }
        for (name, range) in operands {
            let id = terms.insert(RealTerm::Variable(name.clone()), name);
            presupposed.insert(id, *range);
        }
        presupposed.extend(hardware.facts.iter().map(|(&id, &range)| (id, range)));
        presupposed
    }
}

fn real_operand(
    name: &str,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<RealTermId, String> {
    let branches = exact::branches(&Expression::operand(name), setting, terms)?;
    Ok(branches[0].term)
}

/// Returns every way that the expressions can go together. For example, two expressions of two branches each have four
/// ways, without the ways whose choices contradict each other.
fn together(ways: &[Vec<Branch>]) -> Vec<Vec<Branch>> {
    let all = ways.iter().fold(vec![(Branch::default(), Vec::new())], |chosen, ways| {
        let longer = chosen.iter().flat_map(|(all, before)| {
            ways.iter().filter_map(|way| {
                let chosen: Vec<Branch> = before.iter().chain([way]).cloned().collect();
                Some((all.and(way)?, chosen))
            })
        });
        longer.collect()
    });
    all.into_iter().map(|(_, chosen)| chosen).collect()
}
