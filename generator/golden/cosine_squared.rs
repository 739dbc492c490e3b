//! The golden model and the accuracy contract of the device `cosine-squared`, which computes f = cos²(a·δ) for a scan line's
//! points.
//!
//! δ is the angle at a point of the line, and a = √(n/2) with the specular exponent n. The host multiplies its angles by a, so
//! the device's operands are products a·δ. f is 0 if |a·δ| is a right angle or more. The golden model reads cos² from its own
//! copy of the device's table, ROM 12. The source is a prototype (Abbas, Szirmay-Kalos, Horváth 2000), which [seed
//! 000](crate#symbols) cites.

use std::f64::consts::FRAC_PI_2;

use super::contract::ErrorShare;
use super::frame::Frame;
use super::highlight::{Highlight, Products, Reflectance};
use super::line::{self, CosineTable, magnitude};
use super::{Contract, Model, Operand, Sweep};
use crate::formulas;
use glint_base::fixed::exp2;
use glint_config::Config;
use glint_keys::cosine_squared::Keys;

struct SquaredArithmetic {
    keys: Keys,
    /// ROM 12 by the numbers of blocks in seed 000.
    table: CosineTable,
}

impl SquaredArithmetic {
    fn new(keys: Keys) -> Self {
        Self { table: CosineTable::new(2, keys.table_address, keys.fraction), keys }
    }

    /// Returns the address of ROM 12 for an angle a·δ. A right angle or more gives the last address, whose word is 0.
    #[inline]
    fn step_of(&self, angle: i64) -> i64 {
        magnitude(angle, self.keys.angle_fraction, self.keys.table_address)
            .unwrap_or(self.table.words.len() as i64 - 1)
    }

    /// Returns the word of ROM 12 for an angle a·δ.
    #[inline]
    fn cosine_of(&self, angle: i64) -> i64 {
        self.table.words[self.step_of(angle) as usize]
    }
}

fn products(keys: &Keys) -> Products {
    Products::amplitude(keys.f_format(), keys.colour_bits, keys.output_rounding)
        .at_edges(keys.stages > 2)
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let keys = Keys::of(config);
    let mut frame = Frame::default();
    let Keys { length_bits, stages, .. } = keys;
    let (angle, program) = line::walker(&mut frame, keys.angle_format(), length_bits, stages);
    // The word that ROM 12 read at the latest edge.
    let cosine = frame.hidden();
    let products = products(&keys);
    let it = SquaredArithmetic::new(keys);
    if stages == 2 {
        products.slots(&mut frame, cosine);
        frame.every_edge(move |s| s[cosine] = it.cosine_of(s[angle]));
    } else {
        // The address of ROM 12, and the word that ROM 12 read one edge before the latest.
        let (address, held) = (frame.hidden(), frame.hidden());
        products.slots(&mut frame, held);
        // From the output back to the angle: each slot takes the value that the slot before it in the pipeline held.
        frame.every_edge(move |s| {
            s[held] = s[cosine];
            s[cosine] = it.table.words[s[address] as usize];
            s[address] = it.step_of(s[angle]);
        });
    }
    Box::new(frame.model(program))
}

/// Returns the accuracy contract. The control operands are `delta_zeta` (the angle from a point to the next), `zeta_start` (the
/// first angle) and `length` (the number of intervals). To state a single point of a line, the contract sets `zeta_start` to the
/// angle of that point.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let mut operands = line::angle_operands(keys.angle_format()).to_vec();
    operands.push(line::length_operand(keys.length_bits));
    let products = products(&keys);
    Box::new(Highlight::new(SquaredArithmetic::new(keys), operands, products))
}

impl Reflectance for SquaredArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        self.cosine_of(control[1])
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let right = exp2(self.keys.angle_fraction as i32);
        formulas::cosine_squared(control[1] as f64 / right * FRAC_PI_2)
    }

    fn expressions(&self) -> Vec<String> {
        let angle = line::angle_expression(self.keys.angle_format());
        vec![format!("cos(pi / 2 * min(abs({angle}), 1)) ** 2")]
    }

    fn point(&self, control: &mut [i64], index: u64) {
        control[1] = line::angle_at(self.keys.angle_format(), control[1], control[0], index);
    }

    fn line(&self, first: &[i64], last: &[i64]) -> Vec<i64> {
        let (angle, length) = (first[1], first[2]);
        vec![line::interval(angle, last[1], length, first[0]), angle, length]
    }

    /// Returns the operands of a line with a single point, at the angle `gamma`·√(n/2): the host multiplies angles by this root.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        let stretched = (n / 2.0).sqrt() * gamma;
        Some(vec![0, line::raw_angle(&operands[1], stretched), 0])
    }

    /// Returns `None`: the operand is γ·√(n/2), and γ cannot be computed from it without n.
    fn cosine(&self, _: &[Operand], _: &[i64]) -> Option<f64> {
        None
    }

    fn length(&self) -> Option<&str> {
        Some("length")
    }

    /// Visits every step of ROM 12, an interval of angles with one word. The steps cover every angle that a line can reach: for a
    /// right angle and beyond, the table's last word and the formula are both 0.
    fn sweep(&self) -> Option<Sweep> {
        let last = (1 << self.keys.table_address) - 1;
        Some(Sweep::ranges([("step of the table", (0, last))]))
    }

    /// Returns the largest error, positive or negative, over all angles of the step `place`.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let step = place[0];
        let word = self.table.words[step as usize];
        let f = word as f64 * exp2(-(self.keys.fraction as i32));
        let ulp = exp2(-(self.keys.table_address as i32));
        let end = |step: i64| formulas::cosine_squared(step as f64 * ulp * FRAC_PI_2);
        Some((end(step) - f).max(f - end(step + 1)))
    }

    /// Returns the error of the steps and the error of the rounded words of ROM 12. In a step, the word is the middle of the
    /// formula's values; in the last step it is 0.
    fn shares(&self) -> Vec<ErrorShare> {
        let table = &self.table;
        vec![
            ("table.address", "the steps of ROM 12", table.step),
            ("intensity.fraction", "rounding of ROM 12", table.total - table.step),
        ]
    }
}
