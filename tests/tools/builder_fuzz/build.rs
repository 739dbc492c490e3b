//! Draws random descriptions: lists of calls of the DSL, without mistakes or with some.

use glint::base::diagnostic::Diagnostics;
use glint::dsl::{Designer, Register, Signal, StepSetting, end, jump_if, loop_while, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::netlist::Design;
use proptest::collection::vec;
use proptest::prelude::*;

/// A call of the builder.
#[derive(Clone, Debug)]
pub struct Call {
    what: u8,
    /// The places of its operands among the signals.
    of: [u16; 3],
    /// The seed of a width, a number of places or a name.
    number: i32,
    /// Operands and formats as they come, fitting or not.
    wild: bool,
}

/// Descriptions of which no call is wrong, or with some that may be.
pub fn calls(wild: bool) -> impl Strategy<Value = Vec<Call>> {
    let extremes = prop::sample::select(vec![0, 1, -1, 63, 64, 65, 128, i32::MAX, i32::MIN]);
    let number = prop_oneof![8 => 0..40, 2 => -70..140, 1 => extremes];
    let odd = if wild { prop::bool::weighted(0.15).boxed() } else { Just(false).boxed() };
    let call = (any::<u8>(), any::<[u16; 3]>(), number, odd);
    let call = call.prop_map(|(what, of, number, wild)| Call { what, of, number, wild });
    vec(call, 1..24)
}

impl Call {
    /// Returns whether it makes a constant or compares: linters refuse, rightly, to compare with what is known.
    /// The random netlists have comparisons of what is not.
    pub fn may_be_known(&self) -> bool {
        matches!(self.what % 30, 3 | 4 | 16 | 17)
    }
}

/// Names that a description must not use, and some that it may.
const NAMES: [&str; 14] = [
    "",
    " ",
    "a b",
    "module",
    "1st",
    "é",
    "a__b",
    "_",
    "clk",
    "start",
    "word_address",
    "x\n",
    "\\x ",
    "an_identifier_that_is_very_much_longer_than_what_any_tool_would_show_in_a_column_of_a_table",
];

struct Builder<'d> {
    d: &'d Designer,
    signals: Vec<Signal<'d>>,
    operands: Vec<Signal<'d>>,
    registers: Vec<Register<'d>>,
    /// Wires that are not driven yet.
    wires: Vec<Signal<'d>>,
    settings: Vec<StepSetting>,
    /// The settings of counters, which do not count where they load.
    counting: Vec<StepSetting>,
    count: usize,
}

/// Builds a design by calls of the builder.
///
/// # Errors
/// The calls make a wrong description.
pub fn build(calls: &[Call]) -> Result<Design, Diagnostics> {
    let d = Designer::new("fuzz");
    let x = d.operand("x", Format::signed(2, 5)).q();
    let mut builder = Builder {
        d: &d,
        signals: vec![x],
        operands: vec![x],
        registers: Vec::new(),
        wires: Vec::new(),
        settings: Vec::new(),
        counting: Vec::new(),
        count: 0,
    };
    for call in calls {
        builder.call(call);
    }
    let wrong_program = calls.iter().any(|call| call.wild && call.what % 8 == 0);
    builder.finish(wrong_program);
    d.finish()
}

impl<'d> Builder<'d> {
    fn name(&mut self, call: &Call) -> String {
        self.count += 1;
        if call.wild && call.of[2].is_multiple_of(4) {
            return NAMES[usize::from(call.of[2]) / 4 % NAMES.len()].to_owned();
        }
        format!("s{}", self.count)
    }

    fn format(call: &Call) -> Format {
        let (int, signed) = (call.number, call.of[2] % 2 == 1);
        let frac = i32::from(call.of[1] % 30) - 8;
        if call.wild {
            Format {
                signed,
                int,
                frac: if call.of[1].is_multiple_of(7) { call.number } else { frac },
            }
        } else {
            Format { signed, int: call.number.rem_euclid(14) + 1 - frac, frac }
        }
    }

    /// Some signal.
    fn any(&self, call: &Call, at: usize) -> Signal<'d> {
        self.signals[usize::from(call.of[at]) % self.signals.len()]
    }

    /// Some signal, in this format unless the call is wild.
    fn fitted(&mut self, call: &Call, at: usize, format: Format) -> Signal<'d> {
        let signal = self.any(call, at);
        if call.wild || signal.format() == format {
            return signal;
        }
        self.count += 1;
        let name = format!("fitted{}", self.count);
        self.d.narrow(&name, signal, format, Rounding::Truncate, Overflow::Saturate)
    }

    fn call(&mut self, call: &Call) {
        let (d, name) = (self.d, self.name(call));
        let format = Self::format(call);
        let number = Format::unsigned(5, 0);
        let small = Format::signed(3, 4);
        let new = match call.what % 30 {
            0 => {
                let operand = d.operand(&name, format).q();
                self.operands.push(operand);
                operand
            }
            1 => {
                let register = d.register(&name, format);
                let from = self.fitted(call, 0, format);
                register.takes(from);
                if call.wild && call.of[1].is_multiple_of(5) {
                    register.takes(from);
                }
                self.settings.push(register.load());
                register.q()
            }
            2 => {
                let register = d.register(&name, format);
                self.registers.push(register);
                self.settings.push(register.load());
                register.q()
            }
            3 => {
                if call.wild {
                    d.constant(&name, f64::from(call.number) / 3.0, format)
                } else {
                    d.constant(&name, 0.0, format)
                }
            }
            4 => d.raw_constant(&name, if call.wild { i128::MAX } else { 1 }, number),
            5 => {
                let wire = d.wire(&name, format);
                self.wires.push(wire);
                wire
            }
            6 => d.add(&name, self.fitted(call, 0, small), self.any(call, 0)),
            7 => {
                let carry = self.fitted(call, 2, Format::BIT);
                let a = self.fitted(call, 0, small);
                d.add_carry(&name, a, self.fitted(call, 1, format), carry)
            }
            8 => {
                d.add_modulo(&name, self.fitted(call, 0, small), self.fitted(call, 1, small), None)
            }
            9 => d.sub(&name, self.fitted(call, 0, small), self.fitted(call, 1, number)),
            10 => d.mul(&name, self.fitted(call, 0, small), self.fitted(call, 1, number)),
            11 => d.not(&name, self.any(call, 0)),
            12 => d.concat(&name, self.fitted(call, 0, number), self.fitted(call, 1, number)),
            13 => {
                let parts = [self.fitted(call, 0, small), self.fitted(call, 1, number)];
                d.join(&name, &parts, if call.wild { format } else { Format::signed(12, 0) })
            }
            14 => {
                d.and(&name, self.fitted(call, 0, Format::BIT), self.fitted(call, 1, Format::BIT))
            }
            15 => d.or(&name, self.fitted(call, 0, Format::BIT), self.fitted(call, 1, Format::BIT)),
            16 => d.less(&name, self.fitted(call, 0, small), self.fitted(call, 1, small)),
            17 => d.equal(&name, self.fitted(call, 0, small), self.fitted(call, 1, number)),
            18 => d.any(&name, self.any(call, 0)),
            19 => d.all(&name, self.any(call, 0)),
            20 => {
                let select = self.fitted(call, 0, Format::BIT);
                let inputs = [self.fitted(call, 1, small), self.fitted(call, 2, small)];
                d.choose(&name, select, inputs)
            }
            21 => {
                let inputs = [self.fitted(call, 1, small), self.fitted(call, 2, small)];
                // An input twice is a mistake.
                let inputs = if call.wild {
                    inputs
                } else {
                    [inputs[0], d.not(&format!("{name}_other"), inputs[1])]
                };
                let mux = d.mux(
                    &name,
                    inputs[..usize::from(call.of[0] % 3).max(usize::from(!call.wild) * 2)].to_vec(),
                );
                self.settings.push(mux.pick(inputs[0]));
                mux.out()
            }
            22 => {
                let words: Vec<i128> = (0..32).collect();
                let address = self.fitted(call, 0, number);
                let held = if call.wild { format } else { Format::unsigned(5, 0) };
                d.rom(&name, address, held, &words, call.of[1].is_multiple_of(2)).out()
            }
            23 => d.narrow(
                &name,
                self.any(call, 0),
                format,
                [Rounding::Truncate, Rounding::Nearest][usize::from(call.of[1] % 2)],
                [Overflow::Saturate, Overflow::Wrap][usize::from(call.of[2] % 2)],
            ),
            24 => {
                let positions = if call.wild { call.number } else { call.number.rem_euclid(4) };
                match call.of[1] % 2 {
                    0 => self.any(call, 0).shift_right(positions),
                    _ => self.any(call, 0).shift_left(positions),
                }
            }
            25 => {
                let a = self.fitted(call, 0, small);
                a.with_fraction(if call.wild { call.number } else { 6 })
            }
            26 => {
                if call.wild {
                    self.any(call, 0).bits(call.number as u32, format)
                } else {
                    self.fitted(call, 0, small).bits(2, Format::unsigned(4, 0))
                }
            }
            27 => {
                if call.wild {
                    self.any(call, 0).above(self.any(call, 1), format)
                } else {
                    self.fitted(call, 0, number).read_as(Format::signed(2, 2))
                }
            }
            28 => d.pipeline(&name, self.any(call, 0)).as_signed(),
            _ => {
                let counter = d.down_counter(&name, self.fitted(call, 0, number));
                self.settings.push(counter.load());
                self.counting.push(counter.count());
                counter.q()
            }
        };
        // Sums and products of sums and products grow without end.
        let wide = new.format().width() > 24;
        self.signals.push(if wide && !call.wild {
            let narrow = format!("narrow{}", self.count);
            d.narrow(&narrow, new, small, Rounding::Truncate, Overflow::Saturate)
        } else {
            new
        });
    }

    /// Connects the inputs that are still open, and adds a program.
    fn finish(mut self, wrong: bool) {
        let d = self.d;
        let last = Call { what: 0, of: [u16::MAX; 3], number: 0, wild: false };
        for register in std::mem::take(&mut self.registers) {
            let from = self.fitted(&last, 0, register.format());
            register.takes(from);
        }
        // A wire that reads what it drives is a loop: the first signal depends on no wire.
        let first = self.signals[0];
        for wire in std::mem::take(&mut self.wires) {
            let name = format!("{}_source", wire.name());
            let source = if wrong { self.signals[self.signals.len() - 1] } else { first };
            d.drive(
                wire,
                d.narrow(&name, source, wire.format(), Rounding::Truncate, Overflow::Saturate),
            );
        }
        d.output("out", self.signals[self.signals.len() - 1]);
        // Every operand is used.
        for operand in std::mem::take(&mut self.operands) {
            d.output(&format!("{}_shown", operand.name()), operand);
        }
        let steps = vec![
            step("idle", []),
            step("work", std::mem::take(&mut self.settings)),
            step("count", std::mem::take(&mut self.counting)),
            step("result", [valid(), end()]),
        ];
        let condition = self.signals[self.signals.len() / 2];
        if wrong {
            d.microprogram([
                step("idle", [loop_while(condition, "nowhere")]),
                step("idle", [jump_if(condition, "idle"), end()]),
            ])
        } else {
            d.microprogram(steps)
        }
    }
}
