//! Writes the Gappa statements of one case (one combination of outcomes of the hardware's conditions, such as a saturation), for
//! a device that computes a single point after each start. A statement says that an output differs from the formula by at most
//! the bound.
//!
//! If the formula has branches, such as `max`, each combination of branches without contradictory conditions is a statement. The
//! module `segments` writes the statements for devices that compute a line of points.

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
    /// Returns, for each operand's name, the variable in the script, and the power of two by which the variable divides the
    /// operand. The power is above 0 if the formula always divides the operand by the same power of two. For example, a formula
    /// that has `exponent` only in `exponent / 8` gives the variable `exponent_over_8` and the power 3.
    fn variables(&self) -> HashMap<String, (String, i32)> {
        let mut divisors = HashMap::new();
        for formula in self.formulas {
            exact::divisors(formula, &mut divisors);
        }
        let mut variables = HashMap::new();
        for operand in self.contract.operands() {
            let variable = match divisors.get(&operand.name) {
                Some(Some(divisor)) if *divisor != 0 => {
                    (format!("{}_over_{}", operand.name, 1 << divisor), *divisor)
                }
                _ => (operand.name.clone(), 0),
            };
            variables.insert(operand.name.clone(), variable);
        }
        variables
    }

    fn word_values(&self) -> HashMap<String, Vec<f64>> {
        let mut words = HashMap::new();
        for rom in &self.design.roms {
            let format = self.design.net(rom.data).format;
            let values = rom.words.iter().map(|&word| format.to_f64(format.raw(word)));
            words.insert(rom.name.clone(), values.collect());
        }
        words
    }

    /// Adds the Gappa statements of `case`: the premises, and for each output that it differs from the formula by at most the
    /// bound.
    pub(super) fn state(&self, case: &Case, statements: &mut Statements) -> Result<(), String> {
        let variables = self.variables();
        let mut ranges = HashMap::new();
        let mut placed = Variables::new();
        let mut operands = Vec::new();
        for port in &self.unrolled.operands {
            let name = &self.design.net(*port).name;
            let mut known_operands = self.contract.operands().iter();
            let Some(operand) = known_operands.find(|operand| operand.name == *name) else {
                return Err(format!("the contract has no operand `{name}`"));
            };
            let (variable, divisor) = &variables[name];
            placed.push((variable.clone(), operand.format.frac + divisor));
            let known = self.operand(name).and_then(|node| case.known.get(&node));
            let (low, high) = match known {
                Some(range) => *range,
                None => (i128::from(operand.domain.0), i128::from(operand.domain.1)),
            };
            let unit = exp2(-operand.format.frac);
            let (low, high) = (low as f64 * unit, high as f64 * unit);
            ranges.insert(name.clone(), (low, high));
            let factor = exp2(-divisor);
            operands.push((variable.clone(), (low * factor, high * factor)));
        }
        let words = self.word_values();
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
            let out_value = hardware.value(&mut terms, node)?;
            let presupposed = self.presupposed(case, &mut hardware, &mut terms, &operands);
            let (unscaled, scale) = hardware::placed(&mut terms, out_value, 0);
            let out = hardware::scaled(&mut terms, unscaled, scale, "out");
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
                let mut scripts: Vec<String> = Vec::new();
                for way in &chosen {
                    scripts.push(script.text(out, factor, way.term, self.bound));
                }
                scripts.dedup();
                statements.push(&output, scripts);
            }
        }
        Ok(())
    }

    /// Returns the interval of values of each known term: the hypotheses. The function leaves out values that cannot be written
    /// as a term.
    fn presupposed(
        &self,
        case: &Case,
        hardware: &mut Hardware,
        terms: &mut RealTerms,
        operands: &[(String, (f64, f64))],
    ) -> BTreeMap<RealTermId, (f64, f64)> {
        let mut presupposed = BTreeMap::new();
        // The formula may read words on which no result of the hardware depends in this case.
        for (at, node) in self.graph().nodes.iter().enumerate() {
            if let Cell::Read { address, .. } = node.cell
                && matches!(self.graph().node(address).cell, Cell::Operand(_))
            {
                let _ = hardware.value(terms, NodeId(at as u32));
            }
        }
        for (&node, &(low, high)) in &case.known {
            if let Some(NodeValue::Term { id, scale }) = hardware.expression(terms, node) {
                let unit = exp2(-scale);
                presupposed.insert(id, (low as f64 * unit, high as f64 * unit));
            }
            if low == high
                && let Cell::Op(NodeOp::Less(a, b)) = &self.graph().node(node).cell
            {
                presupposed.extend(hardware.compared(terms, (*a, *b), low == 1));
            }
        }
        for (name, range) in operands {
            let id = terms.insert(RealTerm::Variable(name.clone()), name);
            presupposed.insert(id, *range);
        }
        presupposed.extend(&hardware.facts);
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

/// Returns every combination of one branch of each expression, without combinations that decide a condition differently.
fn together(ways: &[Vec<Branch>]) -> Vec<Vec<Branch>> {
    // The choices of all branches together, and each expression's branch.
    let mut combinations: Vec<(Branch, Vec<Branch>)> = vec![(Branch::default(), Vec::new())];
    for ways_of_expression in ways {
        let mut longer = Vec::new();
        for (together, before) in &combinations {
            for way in ways_of_expression {
                if let Some(together) = together.and(way) {
                    let mut chosen = before.clone();
                    chosen.push(way.clone());
                    longer.push((together, chosen));
                }
            }
        }
        combinations = longer;
    }
    combinations.into_iter().map(|(_, chosen)| chosen).collect()
}
