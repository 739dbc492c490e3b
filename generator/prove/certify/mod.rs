//! Writes the bound of a contract as statements that Gappa proves.
//!
//! The computation is unrolled into a graph of values and split into [`cases`] at saturations, clamps and tables, which together cover the
//! domain. In each the [`hardware`] is an expression with roundings and the formula one without ([`exact`]), and a statement says that
//! they differ by the bound at most; a formula that reads a table reads the words that the hardware has.

pub mod cases;
pub mod exact;
mod find;
pub mod hardware;
pub mod polynomial;
mod premises;
mod proof;
pub mod quotient;
mod script;
mod segments;
pub mod terms;
mod witness;

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use cases::{Case, Known, View};
use exact::{Branch, Setting};
pub use find::bound;
use glint_base::fixed::exp2;
use glint_formula::{Formula, Function, Kind, Operator, parse};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::pipeline::{Cell, Graph, NodeId, Op, Unrolled, unroll, unroll_line};
use hardware::{Hardware, Value, Variables};
pub use proof::{Outcome, Subject, prove};
use script::Script;
use terms::{Id, Term, Terms};

/// An operand of at most this number of values is gone through value by value where it is an exponent of the formula, or
/// numbers the words of several tables.
const SPLIT: i64 = 1024;

/// A table of at most this number of different words, one after the other, is gone through word by word.
const RUNS: usize = 16;

/// A statement for Gappa to prove.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The output that it speaks of, or the value on the way to the outputs.
    pub output: String,
    /// Its number among those of the output, from 1.
    pub number: usize,
    /// Other outputs of which it is the statement too, by another name.
    pub also: Vec<String>,
    /// Scripts of which one has to be accepted: where the formula jumps there are two that are right.
    pub scripts: Vec<String>,
}

/// Statements, each once.
#[derive(Default)]
struct Statements {
    list: Vec<Statement>,
    /// Where each is, by its scripts with all names replaced.
    known: HashMap<Vec<String>, usize>,
}

impl Statements {
    fn push(&mut self, output: &str, scripts: Vec<String>) {
        let nameless = scripts.iter().map(|script| script::nameless(script)).collect();
        if let Some(&at) = self.known.get(&nameless) {
            let Statement { output: own, also, .. } = &mut self.list[at];
            if own != output && !also.iter().any(|other| other == output) {
                also.push(output.to_owned());
            }
            return;
        }
        self.known.insert(nameless, self.list.len());
        let before = self.list.iter().filter(|other| other.output == output).count();
        let (output, number) = (output.to_owned(), before + 1);
        self.list.push(Statement { output, number, also: Vec::new(), scripts });
    }
}

/// Returns the statements whose conjunction is the contract of a sequential design.
///
/// # Errors
/// The step that has no translation, in words; that the contract states no bound; or that it takes longer than `limit` to
/// say them all.
pub fn statements(
    design: &Design,
    contract: &dyn Contract,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    let bound = contract.bound();
    if bound.is_stated() {
        within(design, contract, Some(bound.units), limit)
    } else {
        Err("its contract states no bound".to_owned())
    }
}

/// Returns the statements without a bound: each asks how far an output is from the formula, in its units. [`bound`] answers,
/// and [`Statement::within`] states the answer.
///
/// # Errors
/// As of [`statements`].
pub fn questions(
    design: &Design,
    contract: &dyn Contract,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    within(design, contract, None, limit)
}

fn within(
    design: &Design,
    contract: &dyn Contract,
    bound: Option<f64>,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    let begin = Instant::now();
    let formulas = formulas(contract)?;
    let (unrolled, walk) = if contract.length().is_some() {
        let line = unroll_line(design).map_err(|error| error.to_string())?;
        (line.unrolled, Some(line.walk))
    } else {
        (unroll(design).map_err(|error| error.to_string())?, None)
    };
    let results: Vec<NodeId> = unrolled.results.iter().map(|(_, node)| *node).collect();
    let words = |rom: RomId, address: u64| {
        let rom = design.rom(rom);
        let word = rom.words.get(address as usize).copied().unwrap_or(0);
        design.net(rom.data).format.raw(word)
    };
    let quotients = quotient::quotients(&unrolled.graph, &results);
    let view = View { graph: &unrolled.graph, words: &words, quotients: &quotients };
    let tables: Vec<String> = design.roms.iter().map(|rom| rom.name.clone()).collect();
    let task = Task {
        design,
        contract,
        bound,
        unrolled: &unrolled,
        view,
        tables: &tables,
        formulas: &formulas,
    };
    if let Some(walk) = walk {
        return segments::statements(&task, &walk);
    }
    let known = task.domain()?;
    let results: Vec<NodeId> = task.outputs()?.into_iter().map(|(_, node)| node).collect();
    let mut statements = Statements::default();
    for known in task.split(&known) {
        for case in cases::cases(view, &results, &known)? {
            if begin.elapsed() > limit {
                let so_far = statements.list.len();
                let limit = limit.as_secs();
                return Err(format!(
                    "to write its statements takes more than {limit} s, with {so_far} written"
                ));
            }
            task.state(&case, &mut statements)?;
        }
    }
    Ok(statements.list)
}

fn formulas(contract: &dyn Contract) -> Result<Vec<Formula>, String> {
    let (expressions, wanted) = match contract.highlight() {
        Some(highlight) => (highlight.expressions(), 1),
        None => (contract.expressions(), contract.outputs().len()),
    };
    if expressions.len() < wanted {
        return Err("its contract has no formula in words".to_owned());
    }
    let parsed = expressions.iter().map(|text| {
        let formula = parse(text).map_err(|fault| {
            let rest: String = text.chars().skip(fault.span.start).take(40).collect();
            format!("{fault}, `{rest}`")
        })?;
        // Before the ways through the hardware, which may be many. Of a line the cosine and the size have one.
        let mut refused = None;
        formula.walk(&mut |part| match part.kind {
            Kind::Unary(Function::Negate | Function::Abs | Function::Cos, _) => {}
            Kind::Unary(function, _) => refused = Some(exact::untranslated(function)),
            _ => {}
        });
        refused.map_or(Ok(formula), Err)
    });
    parsed.collect()
}

struct Task<'a> {
    design: &'a Design,
    contract: &'a dyn Contract,
    /// None: it is asked for.
    bound: Option<f64>,
    unrolled: &'a Unrolled,
    view: View<'a>,
    tables: &'a [String],
    /// The formulas of a highlight's f, or else of the outputs.
    formulas: &'a [Formula],
}

impl Task<'_> {
    fn graph(&self) -> &Graph {
        &self.unrolled.graph
    }

    /// Notes what [`cases::learn`] notes, with what is known before any way is followed.
    fn learn(&self, known: &mut Known, node: NodeId, range: (i128, i128)) -> bool {
        let ranges: Vec<_> = self.graph().nodes.iter().map(|node| node.range).collect();
        cases::learn(self.graph(), known, &ranges, node, range)
    }

    /// Returns the node of the operand, if anything depends on it, by its name.
    fn operand(&self, name: &str) -> Option<NodeId> {
        let at =
            self.unrolled.operands.iter().position(|&port| self.design.net(port).name == name)?;
        let nodes = self.graph().nodes.iter();
        let found = nodes.enumerate().find(|(_, node)| node.cell == Cell::Operand(at));
        found.map(|(id, _)| NodeId(id as u32))
    }

    /// Returns the values that operands have in the contract's domain.
    fn domain(&self) -> Result<Known, String> {
        let mut known = Known::new();
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            if let Some(node) = self.operand(&operand.name)
                && !self.learn(&mut known, node, (low.into(), high.into()))
            {
                return Err(format!("the domain of `{}` is not in its format", operand.name));
            }
        }
        Ok(known)
    }

    /// Returns each output with the net that it takes from the last clock.
    fn outputs(&self) -> Result<Vec<(String, NodeId)>, String> {
        let outputs = self.contract.outputs().iter().map(|output| {
            let mut results = self.unrolled.results.iter();
            let found = results.find(|(port, _)| self.design.net(*port).name == output.name);
            let (_, node) = found.ok_or_else(|| format!("no port is `{}`", output.name))?;
            Ok((output.name.clone(), *node))
        });
        outputs.collect()
    }

    /// Returns the domain, by the values of operands that stand in exponents, and by the runs of operands over which tables have the
    /// same words. Of one table with many words, which the formula reads too, a word is a variable; those of several depend on
    /// each other.
    fn split(&self, known: &Known) -> Vec<Known> {
        let mut split = vec![known.clone()];
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            let Some(node) = self.operand(&operand.name).filter(|_| high - low < SPLIT) else {
                continue;
            };
            let tables: Vec<RomId> = self.tables_read_at(node);
            let is_exponent = |part: &Kind| matches!(part, Kind::Binary(Operator::Power, _, exponent) if **exponent == Formula::operand(&operand.name));
            let single = self.formulas.iter().any(|formula| formula.has(&is_exponent));
            let words = |at: i64| -> Vec<i128> {
                tables.iter().map(|&rom| (self.view.words)(rom, at as u64)).collect()
            };
            let mut runs: Vec<(i64, i64)> = Vec::new();
            for value in low..=high {
                match runs.last_mut() {
                    Some(run) if !single && words(run.1) == words(value) => run.1 = value,
                    _ => runs.push((value, value)),
                }
            }
            let is_variable = |rom: &RomId| {
                let name = &self.tables[rom.index()];
                let reads = |part: &Kind| matches!(part, Kind::Word(rom, _) if rom == name);
                runs.len() > RUNS && self.formulas.iter().any(|formula| formula.has(&reads))
            };
            if !single && (tables.is_empty() || tables.len() == 1 && tables.iter().all(is_variable))
            {
                continue;
            }
            let learnt = |known: &Known, (from, to): (i64, i64)| {
                let mut known = known.clone();
                self.learn(&mut known, node, (from.into(), to.into())).then_some(known)
            };
            split = split
                .iter()
                .flat_map(|known| runs.iter().filter_map(|&run| learnt(known, run)))
                .collect();
        }
        split
    }

    /// Returns the tables that this node numbers the words of.
    fn tables_read_at(&self, node: NodeId) -> Vec<RomId> {
        let reads = self.graph().nodes.iter().filter_map(|it| match it.cell {
            Cell::Read { rom, address } if address == node => Some(rom),
            _ => None,
        });
        let mut tables: Vec<RomId> = reads.collect();
        tables.sort_by_key(|rom| rom.index());
        tables.dedup();
        tables
    }

    /// Returns variable and divisor of each operand: where the formula divides it by a power of two throughout, the
    /// variable is the quotient.
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
    fn state(&self, case: &Case, statements: &mut Statements) -> Result<(), String> {
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
        let setting = Setting {
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
            let mut terms = Terms::default();
            let mut hardware = hardware.clone();
            let out = hardware.value(&mut terms, node)?;
            let presupposed = self.presupposed(case, &mut hardware, &mut terms, &operands);
            let (out, scale) = hardware::placed(&mut terms, out, 0);
            let out = hardware::scaled(&mut terms, out, scale, "out");
            // What the formula is multiplied by: the colour, or what makes units of values.
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
                let script = Script {
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

    /// Returns the case's hypotheses on values that have a translation; others are left out, which leaves more to prove.
    fn presupposed(
        &self,
        case: &Case,
        hardware: &mut Hardware,
        terms: &mut Terms,
        operands: &[(String, (f64, f64))],
    ) -> BTreeMap<Id, (f64, f64)> {
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
            if let Some(Value::Term { id, scale }) = hardware.expression(terms, node) {
                let value = |raw: i128| raw as f64 * exp2(-scale);
                presupposed.insert(id, (value(low), value(high)));
            }
            if let (Cell::Op(Op::Less(a, b)), true) = (&self.graph().node(node).cell, low == high) {
                presupposed.extend(hardware.compared(terms, (*a, *b), low == 1));
            }
        }
        for (name, range) in operands {
            let id = terms.insert(Term::Variable(name.clone()), name);
            presupposed.insert(id, *range);
        }
        presupposed.extend(hardware.facts.iter().map(|(&id, &range)| (id, range)));
        presupposed
    }
}

fn real_operand(name: &str, setting: &Setting, terms: &mut Terms) -> Result<Id, String> {
    let branches = exact::branches(&Formula::operand(name), setting, terms)?;
    Ok(branches[0].term)
}

/// Returns every way that the expressions can go together.
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
