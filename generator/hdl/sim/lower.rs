//! Translates the cells of a netlist to instructions of the simulator.

use crate::netlist::{NetId, Op};
use crate::sim::compiler::Compiler;
use crate::sim::program::{Instruction, Slot, drop_of};
use glint_base::fixed::{MAX_WIDTH, mask};

impl Compiler<'_> {
    /// Compiles the cell `op`, which drives the net `id`. The operands must already have slots.
    pub(super) fn op(&mut self, op: &Op, id: NetId) -> Slot {
        let design = self.design;
        let width = design.width(id);
        let slot = |net: NetId| self.of_net[net.index()];
        let signed = |net: NetId| design.net(net).format.signed;
        let drop = drop_of(width);
        match op {
            Op::Relabel(a) => slot(*a),
            Op::Extend(of) => {
                let narrow = design.width(*of);
                let (a, from) = (slot(*of), drop_of(narrow));
                // The bits above the width of a value are 0 in its slot, so that a zero extension takes no instruction.
                if narrow == width || !signed(*of) {
                    a
                } else {
                    self.emit(&[a], |to| Instruction::SignExtend { to, a, from, drop })
                }
            }
            Op::Slice { of, low } => self.slice(*of, *low, width),
            Op::Concat(parts) => self.concat(parts),
            Op::Not(of) => {
                let (a, b) = (slot(*of), self.constant(mask(width)));
                self.emit(&[a, b], |to| Instruction::Xor { to, a, b })
            }
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) | Op::Sub(a, b) => {
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| match op {
                    Op::And(..) => Instruction::And { to, a, b },
                    Op::Or(..) => Instruction::Or { to, a, b },
                    Op::Xor(..) => Instruction::Xor { to, a, b },
                    _ => Instruction::Sub { to, a, b, drop },
                })
            }
            Op::Add { a, b, carry } => {
                let (a, b) = (slot(*a), slot(*b));
                match carry {
                    None => self.add(a, b, drop),
                    Some(carry) => {
                        let carry = slot(*carry);
                        self.add_carry([a, b, carry], drop)
                    }
                }
            }
            Op::Mul(a, b) => {
                let signed = signed(*a);
                let (drop_a, drop_b) = (drop_of(design.width(*a)), drop_of(design.width(*b)));
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| {
                    if signed {
                        Instruction::MulSigned { to, a, b, drop_a, drop_b, drop }
                    } else {
                        Instruction::MulUnsigned { to, a, b }
                    }
                })
            }
            Op::Equal(a, b) | Op::Less(a, b) => {
                let drop = drop_of(design.width(*a));
                let less = matches!(op, Op::Less(..));
                let signed = less && signed(*a);
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| match (less, signed) {
                    (false, _) => Instruction::Equal { to, a, b },
                    (true, false) => Instruction::LessUnsigned { to, a, b },
                    (true, true) => Instruction::LessSigned { to, a, b, drop },
                })
            }
            Op::Any(of) | Op::All(of) => {
                let a = slot(*of);
                if design.width(*of) == 1 {
                    a
                } else if let Op::Any(_) = op {
                    let (a, low, drop) = self.sliced(a);
                    self.emit(&[a], |to| Instruction::Any { to, a, low, drop })
                } else {
                    let b = self.constant(mask(design.width(*of)));
                    self.emit(&[a, b], |to| Instruction::Equal { to, a, b })
                }
            }
            Op::Mux { select, inputs } => {
                let inputs: Vec<_> = inputs.iter().map(|net| slot(*net)).collect();
                self.mux(slot(*select), &inputs)
            }
        }
    }

    /// Returns `width` bits of the net `of`, from bit `low` up.
    pub(super) fn slice(&mut self, of: NetId, low: u32, width: u32) -> Slot {
        let whole = self.design.width(of);
        if width == whole {
            return self.of_net[of.index()];
        }
        let (a, inner_low, inner_drop) = self.sliced(self.of_net[of.index()]);
        // If the operand is itself a slice, the new slice may reach into the zeros above it.
        let left = (64 - inner_drop).saturating_sub(low as u8);
        if left == 0 {
            return self.constant(0);
        }
        let (low, drop) = (inner_low + low as u8, drop_of(width).max(64 - left));
        // The slot has only zeros above the bits of its value.
        if u32::from(low) >= self.held(a) {
            return self.constant(0);
        }
        self.emit(&[a], |to| Instruction::Slice { to, a, low, drop })
    }

    /// Returns the width of the narrowest net in a slot, which the slot's other nets extend by zeros; 64 without a net.
    fn held(&self, slot: Slot) -> u32 {
        let nets = self.of_net.iter().zip(&self.design.nets);
        let widths = nets.filter(|(own, _)| **own == slot).map(|(_, net)| net.format.width());
        widths.min().unwrap_or(MAX_WIDTH)
    }

    /// Joins the bits of all parts, at most 64, the first part in the top bits.
    fn concat(&mut self, parts: &[NetId]) -> Slot {
        let mut known = 0;
        let mut others = Vec::new();
        let mut shift = 0;
        for part in parts.iter().rev() {
            let slot = self.of_net[part.index()];
            match self.known_value(slot) {
                Some(bits) => known |= bits << shift,
                None => others.push((slot, shift)),
            }
            shift += self.design.width(*part) as u8;
        }
        let mut all = self.constant(known);
        for (slot, shift) in others {
            let (base, (a, low, drop)) = (all, self.sliced(slot));
            all = if shift == 0 && known == 0 && self.known_value(base).is_some() {
                slot
            } else {
                self.emit(&[base, a], |to| Instruction::Place { to, base, a, low, drop, shift })
            };
        }
        all
    }

    fn add_carry(&mut self, [a, b, carry]: [Slot; 3], drop: u8) -> Slot {
        self.emit(&[a, b, carry], |to| Instruction::AddCarry { to, a, b, carry, drop })
    }

    fn add(&mut self, a: Slot, b: Slot, drop: u8) -> Slot {
        let (of_a, low_a, drop_a) = self.sliced(a);
        let (of_b, low_b, drop_b) = self.sliced(b);
        if of_a == a || of_b == b {
            return self.emit(&[a, b], |to| Instruction::Add { to, a, b, drop });
        }
        self.emit(&[of_a, of_b], |to| {
            let (a, b) = (of_a, of_b);
            Instruction::AddSlices { to, a, b, low_a, drop_a, low_b, drop_b, drop }
        })
    }

    /// Returns `a` if `select` is 0, and `b` otherwise. If `select` tests bits of a slot for any 1, the same instruction makes
    /// this test. If `b` places bits of the same slot, this instruction also places them. Chains of such muxes find the range
    /// of a value.
    fn choose(&mut self, select: Slot, a: Slot, b: Slot) -> Slot {
        let Some((of, low, drop)) = self.any(select) else {
            return self.emit(&[select, a, b], |to| Instruction::Choose { to, select, a, b });
        };
        let zero = self.constant(0);
        match self.placed(b, zero) {
            Some((base, place_of, place_low, place_drop, shift)) if place_of == of => {
                self.emit(&[of, a, base], |to| Instruction::ChoosePlace {
                    to,
                    of,
                    low,
                    drop,
                    a,
                    base,
                    place_low,
                    place_drop,
                    shift,
                })
            }
            _ => self.emit(&[of, a, b], |to| Instruction::ChooseAny { to, of, low, drop, a, b }),
        }
    }

    fn mux(&mut self, select: Slot, inputs: &[Slot]) -> Slot {
        let last = inputs.last().unwrap_or(&select);
        if let Some(value) = self.known_value(select) {
            let chosen = usize::try_from(value).ok().and_then(|at| inputs.get(at));
            return *chosen.unwrap_or(last);
        }
        if inputs.iter().all(|input| input == last) {
            return *last;
        }
        let mut operands = vec![select];
        operands.extend(inputs);
        if let [a, b] = *inputs {
            return self.choose(select, a, b);
        }
        let first = self.choices.len() as u32;
        let last = first + (inputs.len() - 1) as u32;
        self.choices.extend(inputs);
        self.emit(&operands, |to| Instruction::Mux { to, select, first, last })
    }
}
