//! Adds the shifts of a merged plan. One shifter to the right serves all functions of a slot.
//!
//! - x shifted to the left by k bits, without the lowest n bits, is x shifted to the right by n − k bits. For example, a reciprocal shifts a
//!   value from its table to the left, and rounds it.
//! - A function that needs all bits of a shift to the left reverses the bits of its word before and behind the shifter.
//! - A function whose result follows from a table without a shift passes through the shifter too, by 0 bits. The adder of the results then
//!   reads the same bits for all these functions.

use glint_base::fixed::{Format, Rounding};

use super::align::{MergedOperation, SharedKind};
use super::merge::Merger;
use super::sums::ResultSum;
use super::tables::wide_enough;
use super::unread::unread_bits;
use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;
use crate::refusal::PlanRefusal;

/// How a function uses the shifter.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ShiftUse {
    Right,
    /// A shift to the left by at most this many places. No operation reads this many low bits of its value.
    LeftWithoutLowBits(i32),
    /// A shift to the left whose low bits are read, too.
    Left,
    /// The function has no such shift: the node is the value of a table.
    NoShift,
}

impl ShiftUse {
    fn of(plan: &ExpressionPlan, node: NodeId) -> Self {
        match plan.node(node).operation {
            Operation::ShiftRight(..) => Self::Right,
            Operation::ShiftLeft(_, places) => {
                let all_ones = (1i32 << plan.node(places).format.width().min(16)) - 1;
                match unread_bits(plan, node) >= all_ones {
                    true => Self::LeftWithoutLowBits(all_ones),
                    false => Self::Left,
                }
            }
            _ => Self::NoShift,
        }
    }
}

impl Merger<'_> {
    /// Gives a slot of shifts to each function whose first result follows from a table without a shift.
    pub(super) fn route_results(&self, slots: &mut [MergedOperation]) {
        for function in 0..self.functions.len() {
            let Some(table) = self.table_before_result(function) else { continue };
            let of_table = slots.iter().position(|slot| slot.members[function] == Some(table));
            let Some(of_table) = of_table else { continue };
            let is_free = |slot: &&mut MergedOperation| {
                slot.kind == SharedKind::Shift && slot.members[function].is_none()
            };
            if let Some(slot) = slots[of_table..].iter_mut().find(is_free) {
                slot.members[function] = Some(table);
            }
        }
    }

    /// Returns the node of a function that reads a table, if its first result follows from it by a sum alone.
    fn table_before_result(&self, function: usize) -> Option<NodeId> {
        let own = self.own(function);
        let mut node = ResultSum::of(own, *own.results().first()?).value;
        while self.table_read(function, node).is_none() {
            node = match own.node(node).operation {
                Operation::Scale(before) | Operation::Narrow(before, Rounding::Truncate) => before,
                _ => return None,
            };
        }
        Some(node)
    }

    /// Adds the shift of a slot, and gives its value to the functions.
    pub(super) fn add_shift(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let use_of = |(function, node): &(usize, NodeId)| ShiftUse::of(self.own(*function), *node);
        if members.iter().map(use_of).all(|it| it == ShiftUse::Left) {
            return self.add_left_shift(members);
        }
        let mut values = vec![None; self.functions.len()];
        let mut places = vec![None; self.functions.len()];
        for (function, node) in members.iter().copied() {
            let [value, by] = self.shift_inputs(function, node)?;
            values[function] = Some(value);
            places[function] = Some(by);
        }
        let value = self.selected("to_shift", &values)?;
        let places = self.selected("shift_places", &places)?;
        let shifted = self.plan.shift_right("shifted", value, places)?;
        for (function, node) in members.iter().copied() {
            self.give_shifted(function, node, shifted)?;
        }
        Ok(())
    }

    /// Adds a shift to the left that all functions need with all of its bits.
    fn add_left_shift(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let value = self.selected_input("to_shift", members, 0)?;
        let places = self.selected_input("shift_places", members, 1)?;
        let mut format = Format::BIT;
        for (function, node) in members {
            let own = self.own(*function).node(*node).format;
            let raw = Format { int: own.int + own.frac, frac: 0, ..own };
            format = wide_enough(format, raw);
        }
        let shifted = self.plan.shift_left("shifted", value, places, format)?;
        for (function, node) in members {
            self.give(*function, *node, shifted)?;
        }
        Ok(())
    }

    /// Returns the integers that a function gives to the shifter to the right: the value, and the places.
    fn shift_inputs(&mut self, function: usize, node: NodeId) -> Result<[NodeId; 2], PlanRefusal> {
        let own = self.own(function);
        let name = self.functions[function].name.clone();
        let shift_use = ShiftUse::of(own, node);
        if shift_use == ShiftUse::NoShift {
            let value = self.raw(self.nodes[function][node.0])?;
            return Ok([value, self.plan.constant("zero", 0, 0)?]);
        }
        let format = own.node(node).format;
        let inputs = own.node(node).operation.inputs();
        let [value, places] = [inputs[0], inputs[1]].map(|input| self.nodes[function][input.0]);
        let [value, places] = [self.raw(value)?, self.raw(places)?];
        match shift_use {
            ShiftUse::Left => {
                let word = Format::unsigned(format.width() as i32, 0);
                let word = self.narrow(&format!("{name}_word_to_shift"), value, word)?;
                let reversed = self.plan.reverse(&format!("{name}_reversed"), word)?;
                Ok([reversed, places])
            }
            ShiftUse::LeftWithoutLowBits(most) => {
                let most = self.plan.constant("most_places", most.into(), 0)?;
                let to_right = format!("{name}_places_to_right");
                Ok([value, self.plan.subtract(&to_right, most, places)?])
            }
            ShiftUse::Right | ShiftUse::NoShift => Ok([value, places]),
        }
    }

    fn give_shifted(
        &mut self,
        function: usize,
        node: NodeId,
        shifted: NodeId,
    ) -> Result<(), PlanRefusal> {
        let own = self.own(function);
        let Format { signed, int, frac } = own.node(node).format;
        let name = format!("{}_shifted", self.functions[function].name);
        match ShiftUse::of(own, node) {
            ShiftUse::Right => self.give(function, node, shifted),
            ShiftUse::LeftWithoutLowBits(dropped) => {
                let whole = self.plan.scale(&name, shifted, dropped)?;
                let zeros_below = Format { frac: 0, ..self.plan.node(whole).format };
                let whole = self.narrow(&name, whole, zeros_below)?;
                self.give(function, node, whole)
            }
            ShiftUse::Left => {
                let width = int + frac + i32::from(signed);
                let word = self.narrow(&name, shifted, Format::unsigned(width, 0))?;
                let word = self.plan.reverse(&name, word)?;
                self.give(function, node, word)
            }
            ShiftUse::NoShift => {
                self.routed[function] = Some(self.plan.scale(&name, shifted, -frac)?);
                Ok(())
            }
        }
    }
}
