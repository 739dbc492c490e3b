//! The golden model and the contract, from the formula.

use glint::config::Config;
use glint::fixed::{Format, Rounding, exp2};
use glint::golden::contract::control;
use glint::golden::frame::{Datapath, Frame, Slot, State, idle, step};
use glint::golden::narrow::{Narrow, rounding_error};
use glint::golden::{Axis, Bound, Contract, Model, Operand, Output, Sweep, Term, Values, keys};

#[derive(Clone)]
struct DotProduct {
    fraction: u32,
    kept: u32,
    rounding: Rounding,
    /// To a cosine, from the fraction bits of a product.
    rounded: Narrow,
}

impl DotProduct {
    fn new(config: &Config) -> Self {
        let fraction = keys::bits(config, "vector.fraction");
        let kept = keys::bits(config, "output.fraction");
        let rounding = keys::rounding(config, "output.rounding");
        let wide = Format::unsigned(2, kept as i32);
        let rounded = Narrow::new(2 * fraction, wide, rounding);
        Self { fraction, kept, rounding, rounded }
    }

    fn vector(&self) -> Format {
        Format::signed(1, self.fraction as i32)
    }

    fn clamped(&self, raw: i64) -> i64 {
        raw.clamp(-1 << self.fraction, 1 << self.fraction)
    }

    fn cosine(&self, sum: i64) -> i64 {
        self.rounded.apply(sum).min(1 << self.kept)
    }
}

const OPERANDS: [&str; 6] = ["nx", "ny", "nz", "hx", "hy", "hz"];

struct Device {
    it: DotProduct,
    operands: [Slot; 6],
    sum: Slot,
    cosine: Slot,
    output: Slot,
}

impl Device {
    /// The product of the components of one axis.
    fn product(&self, s: &State, axis: usize) -> i64 {
        s[self.operands[axis]] * s[self.operands[3 + axis]]
    }
}

impl Datapath for Device {
    fn outputs(&self, s: &mut State) {
        s[self.output] = s[self.cosine];
    }
}

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    let it = DotProduct::new(config);
    let one = 1 << it.fraction;
    let cosine = Format::unsigned(1, it.kept as i32);
    let mut frame = Frame::default();
    let device = Device {
        operands: OPERANDS.map(|name| frame.clamped(name, it.vector(), -one, one)),
        sum: frame.register("sum", Format::signed(2, 2 * it.fraction as i32)),
        cosine: frame.register("cosine", cosine),
        output: frame.output("cosine_out", cosine),
        it,
    };
    let program = [
        idle(),
        step(|d: &Device, s| s[d.sum] = d.product(s, 0)),
        step(|d: &Device, s| s[d.sum] += d.product(s, 1)),
        step(|d: &Device, s| s[d.sum] += d.product(s, 2)),
        step(|d: &Device, s| s[d.cosine] = d.it.cosine(s[d.sum])),
        idle().valid().end(),
    ];
    Box::new(frame.model(device, program))
}

struct Cosine {
    it: DotProduct,
    operands: Vec<Operand>,
    outputs: Vec<Output>,
}

/// Which function the device computes, and how far off it may be.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let it = DotProduct::new(config);
    let one = 1 << it.fraction;
    let operand = |name: &str| {
        let vector = if name.starts_with('n') { "normal" } else { "half vector" };
        control(name, it.vector(), (-one, one), &format!("{} of the {vector}", &name[1..]))
    };
    let format = Format::unsigned(1, it.kept as i32);
    Box::new(Cosine {
        operands: OPERANDS.map(operand).into(),
        outputs: vec![Output { name: "cosine_out".to_owned(), format }],
        it,
    })
}

impl Cosine {
    /// The sum of products, raw: exact.
    fn sum(&self, operands: &[i64]) -> i64 {
        let at = |place: usize| self.it.clamped(operands[place]);
        (0..3).map(|axis| at(axis) * at(3 + axis)).sum()
    }
}

/// The unit vector of a direction; the zero vector stays.
fn unit_vector(vector: [f64; 3]) -> [f64; 3] {
    let now = vector.map(|it| it * it).iter().sum::<f64>().sqrt();
    vector.map(|it| if now == 0.0 { 0.0 } else { it / now })
}

impl Contract for Cosine {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    fn results(&self, operands: &[i64], _: u64, raw: &mut Vec<i64>) {
        raw.push(self.it.cosine(self.sum(operands)));
    }

    fn exact(&self, operands: &[i64], _: u64, values: &mut Vec<[f64; 2]>) {
        let sum = self.sum(operands) as f64 * exp2(-2 * self.it.fraction as i32);
        values.push([sum.clamp(0.0, 1.0); 2]);
    }

    /// A unit vector, and another close to it, or close to a right angle with it: highlights are near a product of 1,
    /// and at 0 the result begins to be clamped.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let mut centred = || [(); 3].map(|()| 2.0 * unit() - 1.0);
        let normal = unit_vector(centred());
        let off = centred();
        let along: f64 = (0..3).map(|axis| normal[axis] * off[axis]).sum();
        let across = unit_vector([0, 1, 2].map(|axis| off[axis] - along * normal[axis]));
        // The smaller of the two angles between them and what they are close to, by octaves.
        let (near, small) = (unit() < 0.5, exp2(-(unit() * f64::from(self.it.fraction)) as i32));
        let half = [0, 1, 2].map(|axis| match near {
            true => normal[axis] + small * across[axis],
            false => across[axis] + small * off[axis],
        });
        let one = exp2(self.it.fraction as i32);
        let raw = [normal, unit_vector(half)].concat().into_iter();
        Some(raw.map(|component| (component * one).round() as i64).collect())
    }

    /// The products and their sum are exact, and rounded once. To clamp to 0 … 1 brings two values no further
    /// apart, and both ends are values of the output, so that the rest of the way changes nothing.
    fn bound(&self) -> Bound {
        let error = rounding_error(2 * self.it.fraction, self.it.kept, self.it.rounding);
        let units = match self.it.rounding {
            // What is cut has at least the last place of a product, which it keeps below a whole unit.
            Rounding::Truncate => {
                error * exp2(self.it.kept as i32)
                    - exp2(self.it.kept as i32 - 2 * self.it.fraction as i32)
            }
            Rounding::Nearest => error * exp2(self.it.kept as i32),
        };
        let what = "rounding of the cosine";
        Bound::of(vec![Term { key: "output.rounding", what, units: units.max(0.0) }])
    }

    /// The sum determines the result.
    fn sweep(&self) -> Sweep {
        let most = 3 << (2 * self.it.fraction);
        Sweep {
            axes: vec![Axis {
                name: "sum of the products".to_owned(),
                values: Values::Range(-most, most),
            }],
            omits: String::new(),
        }
    }

    fn sweep_error(&self, place: &[i64]) -> f64 {
        let exact = place[0] as f64 * exp2(self.it.kept as i32 - 2 * self.it.fraction as i32);
        let one = exp2(self.it.kept as i32);
        (self.it.cosine(place[0]) as f64 - exact.clamp(0.0, one)).abs()
    }
}
