//! Converts a signal to a narrower format, for example a product to its register's format, with stated rounding and overflow.

use std::panic::Location;

use super::{Designer, Signal};
use crate::netlist::{Driver, NetId, Op};
use glint_base::fixed::{Format, Overflow, Rounding};
use glint_base::interval;

impl Designer {
    /// Converts `a` to `format`: `rounding` treats the dropped fraction bits, `overflow` the values outside `format`. For
    /// example, a product in `u0.16` is rounded to `u0.8`.
    ///
    /// Only necessary logic is made. Truncation is wiring, and rounding to nearest an incrementer. Saturation tests only those
    /// upper bits that can differ within the range of `a`, and [`Overflow::Wrap`] drops the upper bits. Missing fraction bits are
    /// zeros.
    #[track_caller]
    pub fn narrow<'d>(
        &'d self,
        name: &str,
        a: Signal<'d>,
        format: Format,
        rounding: Rounding,
        overflow: Overflow,
    ) -> Signal<'d> {
        let (a, format) = (self.own(a), self.sound(name, format));
        let rounded = self.rounded(name, a, format.frac, rounding);
        let (low, high) = rounded.range();
        let limited = |raw: i128| raw.clamp(format.min_raw(), format.max_raw());
        let (op, range) = match (interval::fits((low, high), format), overflow) {
            (true, _) => (Op::Relabel(self.resized(rounded, format)), (low, high)),
            (false, Overflow::Wrap) => (self.low_bits(rounded, format), format.range()),
            (false, Overflow::Saturate) => (
                self.located(Location::caller(), || self.saturated(name, rounded, format)),
                (limited(low), limited(high)),
            ),
        };
        self.signal(self.add_net(name, format, range, Driver::Op(op), true))
    }

    /// Rounds `a` to `frac` fraction bits. The integer part grows if rounding up requires it.
    #[track_caller]
    fn rounded<'d>(
        &'d self,
        name: &str,
        a: Signal<'d>,
        frac: i32,
        rounding: Rounding,
    ) -> Signal<'d> {
        let have = a.format();
        let places = have.frac - frac;
        if places <= 0 {
            return a.with_fraction(frac);
        }
        // With more dropped bits than the value has, the result depends on the sign alone. Then as few are dropped as give the
        // same result, so that the value need not be extended to the weight of the result.
        let most_places = have.width() + 1;
        let (a, places) = if places as u32 > most_places {
            let frac_of_value = frac + most_places as i32;
            let int = have.width() as i32 - i32::from(have.signed) - frac_of_value;
            (a.read_as(Format { int, frac: frac_of_value, ..have }), most_places)
        } else {
            (a, places as u32)
        };
        let have = a.format();
        // If no bit of the value lies above the dropped bits, the value is extended by one bit, so that a bit remains.
        let a = if have.width() > places {
            a
        } else {
            let int = places as i32 + 1 - have.frac - i32::from(have.signed);
            self.signal(self.resized(a, Format { int, ..have }))
        };
        let have = a.format();
        let (low, high) = a.range();
        let floor = |raw: i128| Rounding::Truncate.shift(raw, places as i32);
        let kept = Format { signed: have.signed, int: have.int, frac };
        let bits = Op::Slice { of: a.id(), low: places };
        let truncated = a.wiring("kept", kept, (floor(low), floor(high)), bits);
        match rounding {
            Rounding::Truncate => truncated,
            Rounding::Nearest => {
                let half = a.bit(places - 1).shift_right(frac);
                let nearest = |raw: i128| Rounding::Nearest.shift(raw, places as i32);
                let range = (nearest(low), nearest(high));
                let format = Format::holding(range.0.min(floor(low)), range.1, frac);
                let op = Op::Add {
                    a: self.resized(truncated, format),
                    b: self.resized(half, with_sign(format, false)),
                    carry: None,
                };
                let id = self.add_wiring(&format!("{name}_nearest"), format, range, Driver::Op(op));
                self.signal(id)
            }
        }
    }

    #[track_caller]
    fn low_bits(&self, a: Signal<'_>, format: Format) -> Op {
        if a.format().width() > format.width() {
            return Op::Slice { of: a.id(), low: 0 };
        }
        // The width is at most the width of `format`, so that only the meaning of the top bit changes.
        let same = with_sign(format, a.format().signed);
        Op::Relabel(a.resized_as("wide", same, a.range()).id())
    }

    /// Saturates `v`, whose range exceeds `format`.
    #[track_caller]
    fn saturated<'d>(&'d self, name: &str, v: Signal<'d>, format: Format) -> Op {
        let (low, high) = v.range();
        let (below, above) = (low < format.min_raw(), high > format.max_raw());
        let have = v.format();
        let (width, kept) = (have.width(), format.width());
        let constant = |suffix: &str, raw: i128| {
            let driver = Driver::Constant(format.bits(raw));
            self.add_wiring(&format!("{name}_{suffix}"), format, (raw, raw), driver)
        };
        let flag = |suffix: &str, op: Op| {
            let id =
                self.add_wiring(&format!("{name}_{suffix}"), Format::BIT, (0, 1), Driver::Op(op));
            self.signal(id)
        };
        // A value that is shorter than `format` is extended first.
        let wide = if width < kept {
            self.resized(v, Format { int: have.int + (kept - width) as i32, ..have })
        } else {
            v.id()
        };
        let inside = self
            .signal(wide)
            .wiring("inside", format, format.range(), Op::Slice { of: wide, low: 0 })
            .id();
        let mux = |select: NetId, normal: NetId, limit: NetId| {
            let inputs = vec![normal, limit];
            Op::Mux { select, inputs }
        };
        let limited = |op: Op| {
            let name = format!("{name}_limited");
            self.add_wiring(&name, format, format.range(), Driver::Op(op))
        };
        let upper = |from: u32, to: u32| {
            (from < to).then(|| v.bits(from, Format::unsigned((to - from) as i32, 0)))
        };
        match (format.signed, have.signed) {
            // `v` is never negative. It is too large if any bit above the format is 1.
            (_, false) => {
                let magnitude = kept - u32::from(format.signed);
                let over = upper(magnitude, width)
                    .map_or(inside, |top| flag("over", Op::Any(top.id())).id());
                mux(over, inside, constant("most", format.max_raw()))
            }
            (false, true) => {
                let sign = v.bit(width - 1);
                let top = upper(kept, width - 1).filter(|_| above);
                let limited = top.map_or(inside, |top| {
                    let over = flag("over", Op::Any(top.id()));
                    limited(mux(over.id(), inside, constant("most", format.max_raw())))
                });
                mux(sign.id(), limited, constant("least", 0))
            }
            // The value lies inside the format if all bits from the format's sign up are equal to the sign of `v`. Such a test of
            // bits is faster than a comparison of magnitudes.
            (true, true) => {
                let sign = v.bit(width - 1);
                let Some(top) = upper(kept - 1, width - 1) else {
                    return Op::Relabel(inside);
                };
                let not = |signal: Signal<'_>, suffix: &str| flag(suffix, Op::Not(signal.id()));
                let over = || {
                    let any = flag("high", Op::Any(top.id()));
                    let positive = not(sign, "positive");
                    let over = flag("over", Op::And(positive.id(), any.id()));
                    mux(over.id(), inside, constant("most", format.max_raw()))
                };
                if !below {
                    return over();
                }
                // One mux follows the other, instead of one mux with both limits. The second mux becomes the synchronous reset of
                // the register that loads the result.
                let limited = if above { limited(over()) } else { inside };
                let ones = flag("low", Op::All(top.id()));
                let off = not(ones, "mixed");
                let under = flag("under", Op::And(sign.id(), off.id()));
                mux(under.id(), limited, constant("least", format.min_raw()))
            }
        }
    }
}

/// Changes the signedness and keeps width and fraction bits: `u8.0` becomes `s7.0`.
fn with_sign(format: Format, signed: bool) -> Format {
    let int = format.int + i32::from(format.signed) - i32::from(signed);
    Format { signed, int, frac: format.frac }
}
