//! Defines the subject of a proof by Gappa, which the modules that write statements share.
//!
//! The module also splits the domain of the contract into parts, at operands that are exponents in the formula or addresses of
//! ROMs. For example, `x ** exponent` becomes one part for each exponent.

use super::cases::{self, NodeIntervals, UnrolledComputation};
use glint_formula::{Expression, Kind, Operator};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::pipeline::{Cell, Graph, NodeId, Unrolled};

/// An operand with more values than this number is not split.
const SPLIT: i64 = 1024;

/// A single table with at most this number of runs of equal words always splits the domain. For example, the words 5, 5, 7 are
/// two runs.
const RUNS: usize = 16;

/// The subject of a proof by Gappa: a design, its contract with the error bound, and the unrolled computation as a graph.
pub(super) struct Task<'a> {
    pub(super) design: &'a Design,
    pub(super) contract: &'a dyn Contract,
    /// The bound in units of the outputs; `None` if the statements ask for a bound.
    pub(super) bound: Option<f64>,
    pub(super) unrolled: &'a Unrolled,
    pub(super) view: UnrolledComputation<'a>,
    pub(super) tables: &'a [String],
    /// The formula of f for a highlight, otherwise one formula for each output.
    pub(super) formulas: &'a [Expression],
}

impl Task<'_> {
    pub(super) fn graph(&self) -> &Graph {
        &self.unrolled.graph
    }

    /// Narrows the interval of `node` in `known` to `range` by [`cases::learn`], from the graph's intervals. Returns false if no
    /// value is left.
    pub(super) fn learn(
        &self,
        known: &mut NodeIntervals,
        node: NodeId,
        range: (i128, i128),
    ) -> bool {
        let ranges: Vec<_> = self.graph().nodes.iter().map(|node| node.range).collect();
        cases::learn(self.graph(), known, &ranges, node, range)
    }

    /// Returns the node of the operand `name`, or `None` if no result depends on it.
    pub(super) fn operand(&self, name: &str) -> Option<NodeId> {
        let mut ports = self.unrolled.operands.iter();
        let at = ports.position(|&port| self.design.net(port).name == name)?;
        let mut nodes = self.graph().nodes.iter();
        let id = nodes.position(|node| node.cell == Cell::Operand(at))?;
        Some(NodeId(id as u32))
    }

    /// Returns the intervals of raw values in the contract's domain. Fails if an interval exceeds the format of its operand.
    pub(super) fn domain(&self) -> Result<NodeIntervals, String> {
        let mut known = NodeIntervals::new();
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            if let Some(node) = self.operand(&operand.name)
                && !self.learn(&mut known, node, (low.into(), high.into()))
            {
                return Err(format!("the domain of `{}` exceeds its format", operand.name));
            }
        }
        Ok(known)
    }

    pub(super) fn outputs(&self) -> Result<Vec<(String, NodeId)>, String> {
        let mut outputs = Vec::new();
        for output in self.contract.outputs() {
            let mut results = self.unrolled.results.iter();
            let found = results.find(|(port, _)| self.design.net(*port).name == output.name);
            let Some((_, node)) = found else {
                return Err(format!("there is no port `{}`", output.name));
            };
            outputs.push((output.name.clone(), *node));
        }
        Ok(outputs)
    }

    /// Splits the domain `known`. An operand that is an exponent makes a part for each of its values. An operand that addresses
    /// tables makes a part for each run of values with the same words. There is one exception: a single table with more than 16
    /// runs is not split if the formula also reads it, because its word can be a variable.
    pub(super) fn split(&self, known: &NodeIntervals) -> Vec<NodeIntervals> {
        let mut split = vec![known.clone()];
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            let Some(node) = self.operand(&operand.name) else { continue };
            if high - low >= SPLIT {
                continue;
            }
            let tables: Vec<RomId> = self.tables_read_at(node);
            let single = self.is_exponent(&operand.name);
            let mut runs: Vec<(i64, i64)> = Vec::new();
            for value in low..=high {
                match runs.last_mut() {
                    Some(run) if !single && self.have_same_words(&tables, run.1, value) => {
                        run.1 = value;
                    }
                    _ => runs.push((value, value)),
                }
            }
            if !single {
                match tables[..] {
                    [] => continue,
                    [table] if runs.len() > RUNS && self.formulas_read(table) => continue,
                    _ => {}
                }
            }
            let mut parts = Vec::new();
            for before in &split {
                for &(from, to) in &runs {
                    let mut known = before.clone();
                    if self.learn(&mut known, node, (from.into(), to.into())) {
                        parts.push(known);
                    }
                }
            }
            split = parts;
        }
        split
    }

    fn is_exponent(&self, operand: &str) -> bool {
        let exponent = Expression::operand(operand);
        let is_power = |part: &Kind| matches!(part, Kind::Binary(Operator::Power, _, other) if **other == exponent);
        self.formulas.iter().any(|formula| formula.has(&is_power))
    }

    fn formulas_read(&self, table: RomId) -> bool {
        let name = &self.tables[table.index()];
        let reads = |part: &Kind| matches!(part, Kind::Word(rom, _) if rom == name);
        self.formulas.iter().any(|formula| formula.has(&reads))
    }

    fn have_same_words(&self, tables: &[RomId], one: i64, other: i64) -> bool {
        let words = self.view.words;
        tables.iter().all(|&rom| words(rom, one as u64) == words(rom, other as u64))
    }

    fn tables_read_at(&self, node: NodeId) -> Vec<RomId> {
        let mut tables: Vec<RomId> = Vec::new();
        for reader in &self.graph().nodes {
            match reader.cell {
                Cell::Read { rom, address } if address == node => tables.push(rom),
                _ => {}
            }
        }
        tables.sort_by_key(|rom| rom.index());
        tables.dedup();
        tables
    }
}
