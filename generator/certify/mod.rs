//! The bound of a contract as statements that Gappa proves.
//!
//! A computation is unrolled into its graph of values (the same that pipelines are made of), which goes different
//! ways with saturations, clamps and tables ([`cases`]). On each way the hardware is a real expression with
//! roundings ([`hardware`]), and the contract's formula ([`formula`]) one without ([`exact`]). What Gappa has to
//! prove of each way and each output: the two differ by the contract's bound at most. The ways together cover the
//! domain, so that the statements together are the contract.
//!
//! A formula that reads a table reads the words that the hardware has: that they are the right ones is not part of
//! the statement.

pub mod cases;
pub mod exact;
pub mod formula;
pub mod hardware;
mod proof;
pub mod terms;

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::time::{Duration, Instant};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use crate::base::fixed::exp2;
use crate::golden::Contract;
use crate::hdl::netlist::{Design, NetId, RomId};
use crate::hdl::pipeline::{Cell, Graph, Unrolled, unroll};
use cases::{Case, Known};
use exact::{Branch, Setting};
use formula::Real;
use hardware::{Hardware, Value, Variables};
pub use proof::{Outcome, prove};
use terms::{Id, Term, Terms, number};

/// An operand of at most this number of values is gone through value by value where a table is read by it, or where it is
/// an exponent of the formula.
const SPLIT: i64 = 1024;

/// Points by which terms are compared, and how often one is looked for.
const SAMPLES: usize = 24;
const TRIES: usize = 20_000;

/// What Gappa is to prove.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The output that it speaks of.
    pub output: String,
    /// Its number among those of the output, from 1.
    pub number: usize,
    /// Scripts of which one has to be accepted: where the formula jumps there are two that are right.
    pub scripts: Vec<String>,
}

/// The statements whose conjunction is the contract of a sequential design.
///
/// # Errors
/// The step that has no translation, in words; or that it takes longer than `limit` to say them all.
pub fn statements(
    design: &Design,
    contract: &dyn Contract,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    let begin = Instant::now();
    let formulas = formulas(contract)?;
    let unrolled = unroll(design).map_err(|error| error.to_string())?;
    let task = Task { design, contract, unrolled: &unrolled, formulas: &formulas };
    let known = task.domain()?;
    let results: Vec<NetId> = task.outputs()?.into_iter().map(|(_, node)| node).collect();
    let words = |rom: RomId, address: u64| {
        let rom = design.rom(rom);
        let word = rom.words.get(address as usize).copied().unwrap_or(0);
        design.net(rom.data).format.raw(word)
    };
    let mut statements = Vec::new();
    for known in task.split(&known) {
        for case in cases::cases(&unrolled.graph, &words, &results, &known)? {
            if begin.elapsed() > limit {
                let so_far = statements.len();
                let limit = limit.as_secs();
                return Err(format!(
                    "to write its statements takes more than {limit} s, with {so_far} written"
                ));
            }
            task.state(&case, &mut statements)?;
        }
    }
    Ok(statements)
}

fn formulas(contract: &dyn Contract) -> Result<Vec<Real>, String> {
    let highlight = contract.highlight().ok_or("its contract is of no highlight")?;
    if contract.length().is_some() {
        return Err("a computation of several results is not unrolled".to_owned());
    }
    let expressions = highlight.expressions();
    if expressions.is_empty() {
        return Err("its contract has no formula in words".to_owned());
    }
    let parsed = expressions.iter().map(|text| formula::parse(text));
    parsed.collect::<anyhow::Result<_>>().map_err(|error| error.to_string())
}

struct Task<'a> {
    design: &'a Design,
    contract: &'a dyn Contract,
    unrolled: &'a Unrolled,
    formulas: &'a [Real],
}

impl Task<'_> {
    fn graph(&self) -> &Graph {
        &self.unrolled.graph
    }

    /// The node of the operand, if anything depends on it, by its name.
    fn operand(&self, name: &str) -> Option<NetId> {
        let at =
            self.unrolled.operands.iter().position(|&port| self.design.net(port).name == name)?;
        let nodes = self.graph().nodes.iter();
        let found = nodes.enumerate().find(|(_, node)| node.cell == Cell::Operand(at));
        found.map(|(id, _)| NetId(id as u32))
    }

    /// The values that operands have in the contract's domain.
    fn domain(&self) -> Result<Known, String> {
        let mut known = Known::new();
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            if let Some(node) = self.operand(&operand.name)
                && !cases::learn(self.graph(), &mut known, node, (low.into(), high.into()))
            {
                return Err(format!("the domain of `{}` is not in its format", operand.name));
            }
        }
        Ok(known)
    }

    /// What each output takes from the last clock.
    fn outputs(&self) -> Result<Vec<(String, NetId)>, String> {
        let outputs = self.contract.outputs().iter().map(|output| {
            let mut results = self.unrolled.results.iter();
            let found = results.find(|(port, _)| self.design.net(*port).name == output.name);
            let (_, node) = found.ok_or_else(|| format!("no port is `{}`", output.name))?;
            Ok((output.name.clone(), *node))
        });
        outputs.collect()
    }

    /// The domain, by the values of operands that number the words of tables or stand in exponents.
    fn split(&self, known: &Known) -> Vec<Known> {
        let mut split = vec![known.clone()];
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            let numbers = self.formulas.iter().any(|formula| is_number_of(formula, &operand.name));
            let Some(node) = self.operand(&operand.name).filter(|_| numbers && high - low < SPLIT)
            else {
                continue;
            };
            split = split
                .iter()
                .flat_map(|known| {
                    (low..=high).filter_map(move |value| {
                        let mut known = known.clone();
                        let value = (value.into(), value.into());
                        cases::learn(self.graph(), &mut known, node, value).then_some(known)
                    })
                })
                .collect();
        }
        split
    }

    /// Variable and divisor of each operand: where the formula divides it by a power of two throughout, the variable
    /// is the quotient.
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

    /// The statements of one case.
    fn state(&self, case: &Case, statements: &mut Vec<Statement>) -> Result<(), String> {
        let variables = self.variables();
        let mut ranges = HashMap::new();
        let mut placed = Variables::new();
        let mut operands: BTreeMap<String, (f64, f64)> = BTreeMap::new();
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
            operands.insert(variable.clone(), (quotient(low), quotient(high)));
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
        let setting = Setting { variables: &variables, ranges: &ranges, words: &words };
        let colours: Vec<_> =
            self.contract.operands().iter().filter(|operand| operand.colour).collect();
        for ((output, node), colour) in self.outputs()?.into_iter().zip(colours) {
            let mut terms = Terms::default();
            let mut hardware = Hardware::new(self.graph(), case, &placed);
            let out = hardware.value(&mut terms, node)?;
            // What the case presupposes of values that have a translation; others are left out, which leaves
            // more to prove.
            let mut presupposed: BTreeMap<Id, (f64, f64)> = BTreeMap::new();
            for (&node, &(low, high)) in &case.known {
                if let Ok(Value::Term { id, scale }) = hardware.value(&mut terms, node) {
                    let value = |raw: i128| raw as f64 * exp2(-scale);
                    presupposed.insert(id, (value(low), value(high)));
                }
            }
            for (name, &range) in &operands {
                let id = terms.insert(Term::Variable(name.clone()), name);
                presupposed.insert(id, range);
            }
            let (out, scale) = hardware::placed(&mut terms, out);
            let out = hardware::scaled(&mut terms, out, scale, "out");
            let colour = real_operand(&colour.name, &setting, &mut terms)?;
            let hardware_terms = terms.count();
            let mut ways: Vec<Vec<Branch>> = Vec::new();
            for formula in self.formulas {
                ways.push(exact::branches(formula, &setting, &mut terms)?);
            }
            for chosen in product(&ways) {
                if chosen.iter().any(|way| way.is_never(&terms)) {
                    continue;
                }
                let script = Script {
                    terms: &terms,
                    hardware_terms,
                    placed: &placed,
                    presupposed: &presupposed,
                    ways: &chosen,
                };
                let scripts = chosen
                    .iter()
                    .map(|way| script.text(out, colour, way.term, self.contract.bound().units));
                let before = statements.iter().filter(|other| other.output == output).count();
                statements.push(Statement {
                    output: output.clone(),
                    number: before + 1,
                    scripts: scripts.collect(),
                });
            }
        }
        Ok(())
    }
}

fn real_operand(name: &str, setting: &Setting, terms: &mut Terms) -> Result<Id, String> {
    let real = Real::Operand(name.to_owned());
    let branches = exact::branches(&real, setting, terms)?;
    Ok(branches[0].term)
}

/// Whether the operand numbers a word, or is an exponent.
fn is_number_of(real: &Real, name: &str) -> bool {
    let is = |real: &Real| *real == Real::Operand(name.to_owned());
    match real {
        Real::Word(_, place) => is(place),
        Real::Power(a, b) => is(b) || is_number_of(a, name),
        Real::Number(_) | Real::Operand(_) => false,
        Real::Add(a, b) | Real::Sub(a, b) | Real::Mul(a, b) | Real::Div(a, b) | Real::Max(a, b) => {
            is_number_of(a, name) || is_number_of(b, name)
        }
        Real::If(comparison, a, b) => {
            let sides = [&comparison.left, &comparison.right, a, b];
            sides.into_iter().any(|side| is_number_of(side, name))
        }
    }
}

/// One of each.
fn product(ways: &[Vec<Branch>]) -> Vec<Vec<Branch>> {
    ways.iter().fold(vec![Vec::new()], |chosen, ways| {
        let longer = chosen.iter().flat_map(|before| {
            ways.iter().map(|way| {
                let mut longer = before.clone();
                longer.push(way.clone());
                longer
            })
        });
        longer.collect()
    })
}

struct Script<'a> {
    terms: &'a Terms,
    /// Terms below this number are the hardware's.
    hardware_terms: usize,
    placed: &'a Variables,
    presupposed: &'a BTreeMap<Id, (f64, f64)>,
    ways: &'a [Branch],
}

impl Script<'_> {
    fn text(&self, out: Id, colour: Id, f: Id, bound: f64) -> String {
        let mut terms = self.terms.clone();
        let exact = exact::folded(&mut terms, Term::Mul(f, colour));
        let difference = terms.insert(Term::Sub(out, exact), "difference");
        let mut roots = vec![difference];
        for way in self.ways {
            roots.extend(way.at_least.iter().chain(&way.at_most));
        }
        let mut hypotheses = Vec::new();
        let values = self.presupposed.keys().copied();
        let values = values.filter(|&id| !matches!(self.terms.get(id), Term::Variable(_)));
        roots.extend(values);
        let defined = terms.definitions(&roots);
        let needed = |name: &str| {
            let mut words = defined.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            words.any(|word| word == name)
        };
        for (name, scale) in self.placed.iter().filter(|(name, _)| needed(name)) {
            hypotheses.push(format!("@FIX({name},{})", -scale));
        }
        for (&id, &(low, high)) in self.presupposed {
            let name = self.terms.name(id);
            if !matches!(self.terms.get(id), Term::Number(_)) && needed(&name) {
                hypotheses.push(format!("{name} in [{},{}]", number(low), number(high)));
            }
        }
        for way in self.ways {
            let sides = way.at_least.iter().map(|&id| (id, ">="));
            for (id, sign) in sides.chain(way.at_most.iter().map(|&id| (id, "<="))) {
                if !matches!(self.terms.get(id), Term::Number(_)) {
                    hypotheses.push(format!("{} {sign} 0", self.terms.name(id)));
                }
            }
        }
        hypotheses.dedup();
        let (equal, near) = self.hints(&terms, exact, &needed);
        let mut text = defined.clone();
        let goal = terms.name(difference);
        let _ = write!(
            text,
            "\n{{ {}\n  -> |{goal}| <= {} }}\n\n",
            hypotheses.join("\n  /\\ "),
            number(bound)
        );
        for line in equal.into_iter().chain(near) {
            let _ = writeln!(text, "{line}");
        }
        text
    }

    /// Which terms of the formula are sums of terms of the hardware, and which terms of the hardware stand for which
    /// of the formula. Gappa proves what it uses of it.
    fn hints(
        &self,
        terms: &Terms,
        exact: Id,
        needed: &dyn Fn(&str) -> bool,
    ) -> (Vec<String>, Vec<String>) {
        let samples = self.samples(terms);
        let (mut equal, mut near) = (Vec::new(), Vec::new());
        if samples.len() < 2 {
            return (equal, near);
        }
        let column = |id: Id| samples.iter().map(|values| values[id]).collect::<Vec<f64>>();
        let varies = |values: &[f64]| values.iter().any(|value| *value != values[0]);
        let formula: Vec<(Id, Vec<f64>)> = (self.hardware_terms..terms.count())
            .filter(|&id| {
                id <= exact && !matches!(terms.get(id), Term::Number(_) | Term::Variable(_))
            })
            .map(|id| (id, column(id)))
            .filter(|(_, values)| varies(values))
            .collect();
        for id in 0..self.hardware_terms {
            let own = column(id);
            if !varies(&own) || matches!(terms.get(id), Term::Number(_)) || !needed(&terms.name(id))
            {
                continue;
            }
            for (other, values) in &formula {
                if terms.is_exact(id) && !matches!(terms.get(id), Term::Variable(_)) {
                    if let Some((factor, offset)) = line_through(&own, values) {
                        let own = terms.name(id);
                        // Gappa sees through a plain difference, and not through a product by -1.
                        let right = match (offset, factor) {
                            (0.0, 1.0) => own,
                            (_, 1.0) => format!("{} + {own}", number(offset)),
                            (_, -1.0) => format!("{} - {own}", number(offset)),
                            (0.0, _) => format!("({}) * {own}", number(factor)),
                            _ => format!("{} + ({}) * {own}", number(offset), number(factor)),
                        };
                        equal.push(format!("{} -> {right};", terms.name(*other)));
                    }
                    continue;
                }
                let largest = own.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                let apart = own.iter().zip(values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                if apart <= largest / 64.0 && !matches!(terms.get(id), Term::Variable(_)) {
                    near.push(format!("{} ~ {};", terms.name(id), terms.name(*other)));
                }
            }
        }
        (equal, near)
    }

    /// The values of all terms at operands of this case.
    fn samples(&self, terms: &Terms) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut samples = Vec::new();
        for _ in 0..TRIES {
            let mut variables = HashMap::new();
            for (&id, &(low, high)) in self.presupposed {
                if let Term::Variable(name) = self.terms.get(id) {
                    let scale = self.placed.iter().find(|(other, _)| other == name);
                    let unit = exp2(scale.map_or(0, |(_, scale)| *scale));
                    let unit_share = (random.next_u32() as f64) / f64::from(u32::MAX);
                    // More near the lower end, and near the upper, than between.
                    let share = match random.next_u32() % 3 {
                        0 => unit_share,
                        1 => unit_share.powi(8),
                        _ => 1.0 - unit_share.powi(8),
                    };
                    let raw = (low + (high - low) * share) * unit;
                    variables.insert(name.clone(), libm::floor(raw).max(low * unit) / unit);
                }
            }
            let values = terms.evaluate(&variables);
            let within =
                |(&id, &(low, high)): (&Id, &(f64, f64))| (low..=high).contains(&values[id]);
            let ways = self.ways.iter().all(|way| {
                way.at_least.iter().all(|&id| values[id] >= 0.0)
                    && way.at_most.iter().all(|&id| values[id] <= 0.0)
            });
            if ways && self.presupposed.iter().all(within) {
                samples.push(values);
                if samples.len() == SAMPLES {
                    break;
                }
            }
        }
        samples
    }
}

/// Factor and offset, both short numbers, with which the second is the first's line.
fn line_through(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let other = x.iter().position(|value| *value != x[0])?;
    let factor = (y[other] - y[0]) / (x[other] - x[0]);
    let short = |value: f64| libm::round(value * 65536.0) / 65536.0;
    let factor = short(factor);
    let offset = short(y[0] - factor * x[0]);
    let fits = |(x, y): (&f64, &f64)| (factor * x + offset - y).abs() <= 1e-9 * y.abs().max(1e-3);
    (factor != 0.0 && x.iter().zip(y).all(fits)).then_some((factor, offset))
}
