//! The hardware description of the device `quadratic`, which computes f = max(0, c + a(n)·(c² − c)), with c = cos γ and the
//! specular exponent n ([symbols](crate#symbols)).
//!
//! A table, ROM(n), has the coefficients a(n), which are 0 for n = 0 and n = 1. The source is the patent UA 20998, which seed
//! 001 cites. UA 20998 connects its blocks without a control block. This description adds the registers `difference` and
//! `intensity`, so that a path between registers, or from a register to an output, has at most one multiplier. Each kind of block
//! is numbered from 1, as in seed 001.

mod coefficient;

use glint_base::fixed::{Format, Overflow};
use glint_config::Config;
use glint_keys::quadratic::{Keys, Scheme};
use glint_rtl::blocks::colour::ChannelBlocks;
use glint_rtl::dsl::{Designer, Rom, Signal, step};
use glint_rtl::netlist::About;

use super::common::{self, ColourProducts};

const CHANNELS: [ChannelBlocks; 3] = [channel(1), channel(2), channel(3)];

const fn channel(output: u16) -> ChannelBlocks {
    ChannelBlocks {
        inputs: (output + 2, output + 2),
        register: output + 2,
        multiplier: output + 1,
        output,
    }
}

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    d.about(about(&keys));

    let exponent = common::exponent(d, keys.operands.exponent_bits).block(1).inputs(1, 1).q();
    let cos_gamma = common::cosine(d, &keys.operands.cosine)
        .block(2)
        .inputs(2, 2)
        .doc("c, the cosine of the angle between normal and half vector")
        .q();
    let colours = ColourProducts::new(d, &keys.operands.colours, Some(CHANNELS));

    let difference = d
        .register("difference", Format::signed(-2, keys.difference_fraction as i32))
        .doc("c^2 - c, from -0.25 to 0");
    let intensity = d.register("intensity", keys.f.format()).doc("the reflectance f");

    let adder1 = adder1(d, cos_gamma);
    // The interval of the sum is wider than its values, which are from −0.25 to 0, so no bit is lost.
    let (rounding, overflow) = (keys.difference_rounding, Overflow::Wrap);
    difference.takes(d.narrow("adder1_rounded", adder1, difference.format(), rounding, overflow));
    let coefficient = coefficient_rom(d, &keys, exponent).out();
    let multiplier1 = d.mul("multiplier1", difference.q(), coefficient).block(1);
    let adder2 = d.add("adder2", multiplier1, cos_gamma).block(2).doc("c + a(n)*(c^2 - c)");
    let (rounding, overflow) = (keys.f.rounding, Overflow::Saturate);
    intensity.takes(d.narrow("clamped", adder2, intensity.format(), rounding, overflow));
    let outputs = colours.results(intensity.q(), keys.f.output_rounding);

    let steps = vec![
        step("operands are written; ROM address <- n", []),
        step("difference <- c^2 - c", [difference.load()]),
        step("intensity <- c + a(n) * difference, not below 0", [intensity.load()]),
    ];
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Builds adder 1: c² from multiplier 5, plus the inverted c, plus the carry-in.
fn adder1<'d>(d: &'d Designer, cos_gamma: Signal<'d>) -> Signal<'d> {
    let square = d.mul("multiplier5", cos_gamma, cos_gamma).block(5).doc("c^2");
    let wide = cos_gamma.with_fraction(square.format().frac).as_signed();
    let inverters = d.not("inverters", wide).doc("-c - 1 ulp of the square");
    let carry = d.raw_constant("carry", 1, Format::BIT).doc("carry-in of adder 1");
    d.add_carry("adder1", square, inverters, carry).block(1).doc("c^2 - c")
}

fn coefficient_rom<'d>(d: &'d Designer, keys: &Keys, exponent: Signal<'d>) -> Rom<'d> {
    let bits = keys.operands.exponent_bits;
    let frac = keys.coefficient_fraction() as i32;
    let widest = Format::unsigned(bits as i32, frac);
    let values: Vec<f64> = (0..1 << bits).map(|n| value(keys.scheme, n)).collect();
    let words: Vec<i128> = values.iter().map(|&a| widest.quantise(a)).collect();
    let comments = values.iter().map(|a| format!("{a:.6}")).collect();
    let most = words.iter().copied().max().unwrap_or(0);
    let kind = if keys.scheme == Scheme::Minimax { "minimax" } else { "n - 1" };
    d.rom("coefficient", exponent, Format::holding(0, most, frac), &words, true)
        .doc(&format!("a(n), {kind}, for an exponent n (the address)"))
        .comments(comments)
}

/// Returns the coefficient a(n) before it is rounded.
fn value(scheme: Scheme, n: u32) -> f64 {
    match scheme {
        Scheme::Minimax => coefficient::minimax(n),
        Scheme::Taylor => coefficient::taylor(n),
    }
}

fn about(keys: &Keys) -> About {
    let (first, last) = (keys.domain.least.max(1) as u32, keys.domain.most as u32);
    let worst = |a: fn(u32) -> f64| {
        (first..=last)
            .map(|n| (coefficient::error(a(n), n), n))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or((0.0, first))
    };
    let (taylor, minimax) = (worst(coefficient::taylor), worst(coefficient::minimax));
    let scheme = if keys.scheme == Scheme::Minimax { "minimax" } else { "taylor" };
    About {
        device: "quadratic".to_owned(),
        title: format!("Specular intensity by a parabola in cos(gamma), {scheme} coefficients"),
        formula: "out = colour * max(0, c + a(n) * (c^2 - c)), c = cos(gamma)".to_owned(),
        source: "UA 20998, the analogue in seed 001".to_owned(),
        notes: vec![
            "Below its zero at c = 1 - 1/a(n), the parabola is clamped to 0. The source has no clamp, but it \
             has no negative numbers either."
                .into(),
            format!(
                "The source does not state the contents of ROM(n). For n = {first} ... {last}, the formula \
                 differs from cos^n by up to {:.4} with a(n) = n - 1 (at n = {}), and by up to {:.4} with the \
                 minimax a(n) (at n = {}).",
                taylor.0, taylor.1, minimax.0, minimax.1
            ).into(),
            "For n = 0 the ROM has the a(n) of n = 1, which is 0, so f = c.".into(),
            "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0.".into(),
            common::outputs_note(&keys.operands.colours, "register intensity", "has its result"),
        ],
    }
}
