//! Holds the design, the contract and the unrolled computation of a proof. It cuts the domain where the formula or a
//! table requires it.

use super::cases::{self, NodeIntervals, UnrolledComputation};
use glint_formula::{Expression, Kind, Operator};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::pipeline::{Cell, Graph, NodeId, Unrolled};

/// The most values of an operand that is split value by value, because it is an exponent of the formula or addresses
/// several tables.
const SPLIT: i64 = 1024;

/// A table of at most this number of different words, one after the other, is gone through word by word.
const RUNS: usize = 16;

/// The task of a proof: a design, its contract, and the computation as a graph.
pub(super) struct Task<'a> {
    pub(super) design: &'a Design,
    pub(super) contract: &'a dyn Contract,
    /// The bound in units of the outputs; `None` if the statements ask for it.
    pub(super) bound: Option<f64>,
    pub(super) unrolled: &'a Unrolled,
    pub(super) view: UnrolledComputation<'a>,
    pub(super) tables: &'a [String],
    /// The formulas of a highlight's f, or else of the outputs.
    pub(super) formulas: &'a [Expression],
}

impl Task<'_> {
    /// Returns the graph of the computation.
    pub(super) fn graph(&self) -> &Graph {
        &self.unrolled.graph
    }

    /// Calls [`cases::learn`] with the ranges that nodes have before any way is followed.
    pub(super) fn learn(
        &self,
        known: &mut NodeIntervals,
        node: NodeId,
        range: (i128, i128),
    ) -> bool {
        let ranges: Vec<_> = self.graph().nodes.iter().map(|node| node.range).collect();
        cases::learn(self.graph(), known, &ranges, node, range)
    }

    /// Returns the node of the operand, if anything depends on it, by its name.
    pub(super) fn operand(&self, name: &str) -> Option<NodeId> {
        let at =
            self.unrolled.operands.iter().position(|&port| self.design.net(port).name == name)?;
        let nodes = self.graph().nodes.iter();
        let found = nodes.enumerate().find(|(_, node)| node.cell == Cell::Operand(at));
        found.map(|(id, _)| NodeId(id as u32))
    }

    /// Returns the values that operands have in the contract's domain.
    pub(super) fn domain(&self) -> Result<NodeIntervals, String> {
        let mut known = NodeIntervals::new();
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
    pub(super) fn outputs(&self) -> Result<Vec<(String, NodeId)>, String> {
        let outputs = self.contract.outputs().iter().map(|output| {
            let mut results = self.unrolled.results.iter();
            let found = results.find(|(port, _)| self.design.net(*port).name == output.name);
            let (_, node) = found.ok_or_else(|| format!("no port is `{}`", output.name))?;
            Ok((output.name.clone(), *node))
        });
        outputs.collect()
    }

    /// Returns the domain in parts. An operand in an exponent makes a part for each of its values. An operand that
    /// addresses tables makes a part for each run of values with the same words. If there is one table with many words,
    /// and the formula reads it too, its word is a variable. This cannot be done for several tables, because their
    /// words depend on each other. For example, `x ** exponent` with exponents from 1 to 64 has 64 parts.
    pub(super) fn split(&self, known: &NodeIntervals) -> Vec<NodeIntervals> {
        let mut split = vec![known.clone()];
        for operand in self.contract.operands() {
            let (low, high) = operand.domain;
            let Some(node) = self.operand(&operand.name).filter(|_| high - low < SPLIT) else {
                continue;
            };
            let tables: Vec<RomId> = self.tables_read_at(node);
            let is_exponent = |part: &Kind| matches!(part, Kind::Binary(Operator::Power, _, exponent) if **exponent == Expression::operand(&operand.name));
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
            let learnt = |known: &NodeIntervals, (from, to): (i64, i64)| {
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
}
