//! Defines the subject of a proof by Gappa: the design, its contract and the unrolled computation. The modules that write
//! statements share it.
//!
//! The module also splits the domain of the contract into parts, at operands that are exponents of the formula or that address
//! ROMs. It does not split an operand with more than 1024 values. For example, `x ** exponent` becomes one part for each
//! exponent.

use super::cases::{self, NodeIntervals, UnrolledComputation};
use glint_formula::{Expression, Kind, Operator};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::pipeline::{Cell, Graph, NodeId, Unrolled};

/// The largest number of values of an operand whose domain is split. A larger domain is not split.
const SPLIT: i64 = 1024;

/// The largest number of runs of equal words for which the domain is always split at a single table, one part for each run. For
/// example, the words 5, 5, 7 are two runs.
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
    /// The formulas: for a highlight the formulas of f, otherwise one for each output.
    pub(super) formulas: &'a [Expression],
}

impl Task<'_> {
    /// Returns the graph of the computation.
    pub(super) fn graph(&self) -> &Graph {
        &self.unrolled.graph
    }

    /// Narrows the interval of a node to `range`, and stores the result in `known`, as [`cases::learn`] does. All other nodes
    /// have the intervals of the graph, before any case is distinguished. Returns false if no value is left.
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

    /// Returns the interval of raw values of each operand in the contract's domain. Fails if a domain is not in the operand's
    /// format.
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

    /// Returns each output of the contract, with the node that computes it. Fails if the design has no port of this name.
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

    /// Splits the domain `known` into parts. An operand that is an exponent makes a part for each of its values, and an operand
    /// that addresses tables a part for each run of values with the same words. An operand with more than 1024 values is not
    /// split. A single table with more than 16 runs that the formula reads too is not split, because its word can be a
    /// variable. For example, `x ** exponent` with exponents from 1 to 64 has 64 parts.
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

    /// Returns whether an operand is the exponent of a power in a formula.
    fn is_exponent(&self, operand: &str) -> bool {
        let exponent = Expression::operand(operand);
        let is_power = |part: &Kind| matches!(part, Kind::Binary(Operator::Power, _, other) if **other == exponent);
        self.formulas.iter().any(|formula| formula.has(&is_power))
    }

    /// Returns whether a formula reads the table.
    fn formulas_read(&self, table: RomId) -> bool {
        let name = &self.tables[table.index()];
        let reads = |part: &Kind| matches!(part, Kind::Word(rom, _) if rom == name);
        self.formulas.iter().any(|formula| formula.has(&reads))
    }

    /// Returns whether every table in `tables` has the same word at the addresses `one` and `other`.
    fn have_same_words(&self, tables: &[RomId], one: i64, other: i64) -> bool {
        let words = self.view.words;
        tables.iter().all(|&rom| words(rom, one as u64) == words(rom, other as u64))
    }

    /// Returns the tables whose address is this node.
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
