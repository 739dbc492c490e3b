//! Writes the premises of statements about outputs as separate Gappa statements, so Gappa proves each premise.
//!
//! A premise is a fact about an intermediate value that a statement uses as a hypothesis. One kind says that a value lies in a
//! quadratic polynomial's range. The other kinds are about a divider: the divisor is positive, the dividend is from 0 to the
//! divisor, and a step keeps these limits. A divider has no premises if the intervals of its operands imply them.

use super::cases::{Case, UnrolledComputation};
use super::hardware::{Hardware, NodeValue};
use super::polynomial::RawPolynomial;
use super::quotient::Quotient;
use super::script::GappaScript;
use super::terms::{RealTerm, RealTermId, RealTerms, number};
use glint_base::fixed::exp2;
use glint_rtl::pipeline::NodeId;

/// A premise: a statement about an intermediate value that other statements use as a hypothesis.
pub struct Premise {
    pub about: String,
    pub script: String,
}

/// Returns one premise for each parabola of the case, and three for each divider whose operands' intervals do not already
/// imply the conditions. `operands` has each variable of the script with its interval of values.
///
/// # Errors
/// Fails if a value has no translation.
pub fn of(
    view: UnrolledComputation,
    case: &Case,
    hardware: &Hardware,
    operands: &[(String, (f64, f64))],
) -> Result<Vec<Premise>, String> {
    let mut premises = Vec::new();
    let name = |node: NodeId| view.graph.node(node).label.name.clone();
    for (&node, polynomial) in &case.parabolas {
        let mut task =
            PremiseTask { hardware: hardware.clone(), terms: RealTerms::default(), operands };
        let script = task.parabola(node, *polynomial, case.ranges[node.index()])?;
        premises.extend(script.map(|script| Premise { about: name(node), script }));
    }
    for (&node, &quotient) in view.quotients {
        let [dividend, divisor] =
            [quotient.dividend, quotient.divisor].map(|id| case.ranges[id.index()]);
        if dividend.0 >= 0 && divisor.0 > 0 && dividend.1 <= divisor.0 {
            continue;
        }
        let mut task =
            PremiseTask { hardware: hardware.clone(), terms: RealTerms::default(), operands };
        let mut scripts = vec![task.dividend(quotient)?];
        scripts.extend([true, false].map(step));
        premises.extend(scripts.into_iter().map(|script| Premise { about: name(node), script }));
    }
    Ok(premises)
}

struct PremiseTask<'a> {
    hardware: Hardware<'a>,
    terms: RealTerms,
    operands: &'a [(String, (f64, f64))],
}

impl PremiseTask<'_> {
    /// Writes the statement that the value of `node`, a quadratic polynomial, lies from `low` to `high`, both raw. A hint
    /// completes the square of the polynomial. Returns `None` if the node or the polynomial's variable is a constant.
    fn parabola(
        &mut self,
        node: NodeId,
        polynomial: RawPolynomial,
        (low, high): (i128, i128),
    ) -> Result<Option<String>, String> {
        let Some(x) = polynomial.of else { return Ok(None) };
        let (x, y) =
            (self.hardware.value(&mut self.terms, x)?, self.hardware.value(&mut self.terms, node)?);
        let (NodeValue::Term { id: x, scale: of_x }, NodeValue::Term { id, scale }) = (x, y) else {
            return Ok(None);
        };
        let [a, b, c] = polynomial.factors.map(|factor| factor as f64 * exp2(-scale));
        let (b, c) = (b * exp2(of_x), c * exp2(2 * of_x));
        let vertex = -b / (2.0 * c);
        let rest = a - c * vertex * vertex;
        let x = self.terms.name(x);
        let from_vertex = format!("({x} - ({}))", number(vertex));
        let square = format!("({}) * ({from_vertex} * {from_vertex})", number(c));
        let hint = format!("{} -> {square} + ({});", self.terms.name(id), number(rest));
        let value = |raw: i128| number(raw as f64 * exp2(-scale));
        let goal = format!("{} in [{},{}]", self.terms.name(id), value(low), value(high));
        Ok(Some(self.script(id, &goal, &[hint])))
    }

    /// Writes the statement that the divisor is positive, and that the dividend is from 0 to the divisor.
    fn dividend(&mut self, quotient: Quotient) -> Result<String, String> {
        let (dividend, divisor) = self.hardware.fraction(&mut self.terms, quotient)?;
        let rest = self.terms.insert(RealTerm::Sub(divisor, dividend), "rest");
        let [dividend_name, divisor_name, rest_name] =
            [dividend, divisor, rest].map(|id| self.terms.name(id));
        // If the divisor is a sum with the dividend, `beside` is the other summand.
        let beside = match *self.terms.get(divisor) {
            RealTerm::Add(a, b) if a == dividend => Some(b),
            RealTerm::Add(a, b) if b == dividend => Some(a),
            _ => None,
        };
        let hint = beside.map(|id| format!("{rest_name} -> {};", self.terms.name(id)));
        let goal = format!(
            "{rest_name} >= 0 /\\ {dividend_name} >= 0 /\\ {divisor_name} >= {}",
            number(exp2(-64))
        );
        Ok(self.script(rest, &goal, hint.as_slice()))
    }

    fn script(&self, about: RealTermId, goal: &str, hints: &[String]) -> String {
        let mut terms = self.terms.clone();
        let mut presupposed = self.hardware.facts.clone();
        for (name, range) in self.operands {
            presupposed.insert(terms.insert(RealTerm::Variable(name.clone()), name), *range);
        }
        let script = GappaScript {
            terms: &terms,
            hardware_terms: terms.count(),
            placed: &self.hardware.variables,
            presupposed: &presupposed,
            ways: &[],
        };
        script.statement(terms.clone(), about, goal, hints)
    }
}

/// Writes the statement that a step of a divider leaves a remainder from 0 to the divisor. `fits` says whether the divisor fits
/// into twice the remainder. All numbers are divided by the divisor. For example, a remainder of 0.75 is doubled to 1.5, and
/// leaves 0.5.
fn step(fits: bool) -> String {
    let (condition, left) =
        if fits { ("doubled - 1 >= 0", "doubled - 1") } else { ("doubled - 1 <= 0", "doubled") };
    format!(
        "doubled = 2 * remainder;\nleft = {left};\n\n{{ remainder in [0,1]\n  /\\ {condition}\n  -> left in [0,1] }}\n\n"
    )
}
