//! Builds a table of polynomials that several operands of a sequential core read in turn.
//!
//! A mux selects the operand that addresses the table. Memory, adders and the registers of the partial sums serve all operands, and
//! each value has a register of its own. For example, a unit computes the reciprocal and then the arctangent of `atan2` with one table.

use glint_approximate::Piecewise;
use glint_plan::NodeId;
use glint_rtl::dsl::{Designer, Mux, Register, Signal, StepSetting};

use crate::piecewise::{PolynomialDatapath, StepMultiplier, Tables, number};

/// A polynomial of the plan that reads the table.
struct TableReader<'d> {
    node: NodeId,
    operand: Signal<'d>,
    value: Register<'d>,
}

/// The polynomials of a plan that share a table, before their operands are known.
pub(super) struct TableReaders<'d> {
    readers: Vec<TableReader<'d>>,
}

impl<'d> TableReaders<'d> {
    pub(super) fn new() -> Self {
        Self { readers: Vec::new() }
    }

    /// Adds the polynomial of a node. The register `value` will have the polynomial's value.
    pub(super) fn add(&mut self, node: NodeId, operand: Signal<'d>, value: Register<'d>) {
        self.readers.push(TableReader { node, operand, value });
    }

    /// Builds the mux in front of the table, the table, and the registers of the partial sums with the names `sums`. All other names
    /// begin with `prefix`.
    pub(super) fn build<'p>(
        self,
        d: &'d Designer,
        prefix: &str,
        sums: [&str; 2],
        it: &'p Piecewise,
        tables: Tables,
    ) -> SharedTable<'d, 'p> {
        let mut operands: Vec<Signal<'d>> = Vec::new();
        for TableReader { operand, .. } in &self.readers {
            // Two polynomials can read the same net.
            if operands.iter().all(|other| other.name() != operand.name()) {
                operands.push(*operand);
            }
        }
        let first = operands[0];
        let mux = (operands.len() > 1).then(|| d.mux(&format!("{prefix}operand"), operands));
        let operand = mux.map_or(first, Mux::out);
        let number = number(d, &format!("{prefix}number"), operand, it);
        let names = [None, Some(sums[0]), Some(sums[1])];
        let datapath = PolynomialDatapath::new(d, prefix, names, number, it, tables);
        SharedTable { readers: self.readers, mux, datapath }
    }
}

/// A table with the polynomials that read it.
pub(super) struct SharedTable<'d, 'p> {
    readers: Vec<TableReader<'d>>,
    /// The mux of the operands; `None` if all polynomials read the same net.
    mux: Option<Mux<'d>>,
    datapath: PolynomialDatapath<'d, 'p>,
}

impl<'d, 'p> SharedTable<'d, 'p> {
    pub(super) fn datapath(&self) -> &PolynomialDatapath<'d, 'p> {
        &self.datapath
    }

    /// Returns the setting that lets the operand of a polynomial address the table; `None` if there is only one operand.
    pub(super) fn address_by(&self, node: NodeId) -> Option<StepSetting> {
        Some(self.mux?.pick(self.reader(node).operand))
    }

    /// Connects the registers of all values, and returns the settings of Horner's steps.
    pub(super) fn steps(&self, multiplier: &StepMultiplier<'d>) -> SharedSteps<'d> {
        let (of_steps, value) = multiplier.steps_to_value(&self.datapath);
        let mut values = Vec::new();
        for reader in &self.readers {
            reader.value.takes(value);
            values.push((reader.node, reader.value));
        }
        SharedSteps { of_steps, values }
    }

    fn reader(&self, node: NodeId) -> &TableReader<'d> {
        let found = self.readers.iter().find(|reader| reader.node == node);
        found.expect("a polynomial of the table")
    }
}

/// The settings of Horner's steps for the polynomials that share a table.
pub(super) struct SharedSteps<'d> {
    /// The settings of each step, the last step first, without the one that loads the value.
    of_steps: Vec<Vec<StepSetting>>,
    /// The node of each polynomial, with the register of its value.
    values: Vec<(NodeId, Register<'d>)>,
}

impl SharedSteps<'_> {
    /// Returns the settings of step `coefficient` of the polynomial of `node`.
    pub(super) fn step(&self, node: NodeId, coefficient: usize) -> Vec<StepSetting> {
        let mut settings = self.of_steps[coefficient].clone();
        if coefficient == 0 {
            let (_, value) = self.values.iter().find(|(other, _)| *other == node).expect("a value");
            settings.push(value.load());
        }
        settings
    }
}
