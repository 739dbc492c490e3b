//! `function` — a formula of one operand: a table of coefficients, and Horner's rule on one multiplier.

mod reduction;

use std::ops::Range;

use glint_approximate::{Layout, Outside, Piecewise};
use glint_base::fixed::{Format, MAX_WIDTH, Overflow, Rounding};
use glint_base::text;
use glint_config::{Config, Shared};
use glint_keys::function::{Keys, found};
use glint_rtl::dsl::{Designer, Signal, end, step, valid};
use glint_rtl::netlist::About;

/// The device.
///
/// # Panics
/// If the check of the schema has not accepted the configuration.
pub fn describe(d: &Designer, config: &Config) {
    let (function, it) = found(config).expect("a configuration that is checked");
    d.about(about(&Keys::of(config), function.proof(), &it));
    let (first, last) = it.domain;
    let operand = match it.outside {
        Outside::Clamp => {
            let [first, last] = [first, last].map(|raw| it.operand.to_f64(raw.into()));
            d.operand_clamped("x", it.operand, first, last)
        }
        Outside::Wrap | Outside::Anything => d.operand("x", it.operand),
    };
    let x = operand.doc("the operand").q();
    let (number, restoring) = match &it.reduction {
        None => (number(d, x, &it), None),
        Some(reduction) => {
            let (number, restoring) = reduction::reduced(d, x, &it, reduction);
            (number, Some(restoring))
        }
    };
    let (address, offset) = place(d, number, &it);
    let coefficients = table(d, address, &it, is_split(config, &it));
    let degree = it.degree();

    // The offsets that each step multiplies, and the sums that it leaves.
    let offsets: Vec<Signal> = (it.steps.iter())
        .map(|step| {
            let offset = offset.expect("a polynomial has an offset");
            let width = step.offset as i32;
            offset.bits(it.segments.rest() - step.offset, Format::signed(-1, width))
        })
        .collect();
    let registers: Vec<_> = it
        .registers()
        .iter()
        .zip(&it.sums)
        .take(degree.max(1))
        .map(|(name, format)| d.register(name, *format))
        .collect();
    let factor =
        |k: usize| if k + 1 == degree { coefficients[degree] } else { registers[k + 1].q() };
    let select = (degree > 1).then(|| {
        let choices: Vec<String> = (0..degree).rev().map(|k| format!("x{}", k + 1)).collect();
        let choices: Vec<&str> = choices.iter().map(String::as_str).collect();
        d.select("factors_select", &choices)
    });
    let shared = select.map(|select| {
        let factors = d.bus("factor", select, (0..degree).rev().map(factor));
        let places = d.bus("offset_of_step", select, (0..degree).rev().map(|k| offsets[k]));
        let product = d.shared_mul("product", &factors, &places);
        (factors, product)
    });
    let mut steps = vec![step("operand; table addressed", [])];
    for k in (0..degree.max(1)).rev() {
        let sum = match it.steps.get(k) {
            None => coefficients[0],
            Some(step) => {
                let product = match &shared {
                    Some((_, product)) => product.of(factor(k), offsets[k]),
                    None => d.mul("product", factor(k), offsets[k]),
                };
                let fraction = it.coefficients[k].frac;
                let (low, high) = product.range();
                let kept = Format::holding(low >> step.dropped, high >> step.dropped, fraction);
                let cut = d.narrow(
                    &format!("product{k}"),
                    product,
                    kept,
                    Rounding::Truncate,
                    Overflow::Wrap,
                );
                d.add(&format!("added{k}"), coefficients[k], cut)
            }
        };
        let format = it.sums[k];
        let kept = d.narrow(&format!("kept{k}"), sum, format, Rounding::Truncate, Overflow::Wrap);
        registers[k].takes(kept);
        let load = registers[k].load();
        let name = match k {
            0 if it.reduction.is_some() => "polynomial <- all coefficients".to_owned(),
            0 => "result <- the polynomial".to_owned(),
            _ => format!("sum{k} <- coefficients from {k} on"),
        };
        let pick = shared.as_ref().map(|(factors, _)| factors.pick(factor(k)));
        steps.push(step(&name, pick.into_iter().chain([load])));
    }
    let mut result = registers[0];
    if let Some(restoring) = restoring {
        result = d.register("result", it.result);
        result.takes(restoring.result(d, registers[0].q(), it.result));
        steps.push(step("result <- the polynomial", [result.load()]));
    }
    steps.push(step("result", [valid(), end()]));
    d.output("result_out", result.q());
    d.microprogram(steps);
}

/// An operand's raw value.
fn whole(x: Signal) -> Signal {
    let Format { signed, .. } = x.format();
    let int = x.format().width() as i32 - i32::from(signed);
    x.read_as(Format { int, frac: 0, ..x.format() })
}

/// The operand's number within the domain, without a sign.
fn number<'d>(d: &'d Designer, x: Signal<'d>, it: &Piecewise) -> Signal<'d> {
    let width = x.format().width() as i32;
    let integer = |bits: i32| Format::unsigned(bits, 0);
    let bits = it.segments.bits as i32;
    if i128::from(it.origin) == it.operand.min_raw() {
        return if it.operand.signed {
            flipped(d, "number", x, integer(width))
        } else {
            x.read_as(integer(width))
        };
    }
    let first = d.raw_constant(
        "first",
        it.origin.into(),
        Format::holding(it.origin.into(), it.origin.into(), 0),
    );
    let number = d.sub("number", whole(x), first);
    if number.format() == integer(bits) { number } else { number.bits(0, integer(bits)) }
}

/// The bits of a word with the top one inverted, in a format of the same width: a sign added or taken away.
fn flipped<'d>(d: &'d Designer, name: &str, word: Signal<'d>, format: Format) -> Signal<'d> {
    let low = word.format().width() - 1;
    let top = d.not(&format!("{name}_top"), word.bit(low));
    if low == 0 {
        return top.read_as(format);
    }
    d.join(name, &[top, word.bits(0, Format::unsigned(low as i32, 0))], format)
}

/// The word of the table, and the offset from the middle of the segment, on which a polynomial depends.
fn place<'d>(
    d: &'d Designer,
    number: Signal<'d>,
    it: &Piecewise,
) -> (Signal<'d>, Option<Signal<'d>>) {
    let cut = it.segments;
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let number = match cut.layout {
        Layout::Halving => d.not("mirrored", number),
        _ => number,
    };
    let words = usize::BITS - (cut.words() - 1).leading_zeros();
    // Word and rest of the operands of a block, the rest beginning with the bits that every block has.
    let arm = |block: u32| {
        let rest = cut.rest_of(block);
        let base = d.raw_constant("block", i128::from(block) << cut.prefix, integer(words));
        let word = if cut.prefix == 0 {
            base
        } else {
            d.beside(base, number.bits(rest, integer(cut.prefix)), integer(words))
        };
        let way = (it.degree() > 0).then(|| {
            if rest == 0 {
                return d.raw_constant("no_rest", 0, integer(cut.rest()));
            }
            let places = (cut.rest() - rest) as i32;
            number.bits(0, integer(rest)).with_fraction(places).shift_left(places)
        });
        (word, way)
    };
    let (mut word, mut way) = arm(0);
    for block in 1..=cut.octaves {
        let low = cut.bits - cut.octaves + block - 1;
        let above = number.bits(low, integer(cut.bits - low));
        let here = d.any(&format!("octave{block}"), above);
        let (own, own_way) = arm(block);
        word = d.choose(&format!("word{block}"), here, [word, own]);
        way = way
            .zip(own_way)
            .map(|(below, own)| d.choose(&format!("way{block}"), here, [below, own]));
    }
    let offset = way.map(|way| flipped(d, "offset", way, Format::signed(-1, cut.rest() as i32)));
    (word, offset)
}

/// The fewest bits of a table that a family of FPGAs has a block memory for.
const BLOCK: u64 = 2048;

/// Whether each coefficient has a table of its own: in a pipeline the address then waits in place of the coefficient, which
/// is wider. A block memory has all.
fn is_split(config: &Config, it: &Piecewise) -> bool {
    Shared::of(config).architecture == "pipelined" && it.rom_bits() < BLOCK
}

/// The coefficients of the segment, the constant first, which come a clock after the address. They are in tables of their own
/// where these are `split`, or stand side by side in words of as many bits as a net may have.
fn table<'d>(d: &'d Designer, address: Signal<'d>, it: &Piecewise, split: bool) -> Vec<Signal<'d>> {
    let mut parts: Vec<Range<usize>> = Vec::new();
    let width = |part: &Range<usize>| -> u32 {
        it.coefficients[part.clone()].iter().map(|format| format.width()).sum()
    };
    for k in 0..it.coefficients.len() {
        match parts.last_mut() {
            Some(part) if !split && width(&(part.start..k + 1)) <= MAX_WIDTH => part.end = k + 1,
            _ => parts.push(k..k + 1),
        }
    }
    let last = it.words.len() - 1;
    let reached = usize::try_from(address.range().1).unwrap_or(last);
    let mut signals = Vec::new();
    for part in &parts {
        let formats = &it.coefficients[part.clone()];
        let packed = |word: usize| {
            let words = it.words[word.min(last)][part.clone()].iter().zip(formats);
            words.fold(0i128, |all, (&word, format)| {
                all << format.width() | i128::from(format.bits(word.into()))
            })
        };
        let words: Vec<i128> = (0..=reached).map(packed).collect();
        let mut below = width(part);
        let format = Format::unsigned(below as i32, 0);
        let name = if part.start == 0 {
            "coefficients".to_owned()
        } else {
            format!("coefficients{}", part.start)
        };
        let doc = match part.len() {
            1 => "coefficient of the segment's polynomial",
            _ => {
                "coefficients of the segment's polynomial, that of the lowest power in the top bits"
            }
        };
        let rom = d.rom(&name, address, format, &words, true).doc(doc);
        for (k, format) in part.clone().zip(formats) {
            below -= format.width();
            signals.push(rom.out().bits(below, *format).named(&format!("c{k}")));
        }
    }
    signals
}

fn about(keys: &Keys, proof: &str, it: &Piecewise) -> About {
    let Keys { from, to, .. } = keys;
    let formula = if keys.samples.is_empty() { &keys.formula } else { "samples(x)" };
    let ends = if keys.to_included { "both ends included" } else { "the end not included" };
    let reduced = it.reduction.as_ref().map_or_else(String::new, |it| {
        format!("Operands are reduced ({}) to {} bits. ", keys.reduction.word(), it.bits)
    });
    let shape = match it.degree() {
        0 => format!("A table of {} results", it.words.len()),
        degree => format!(
            "{} segments ({}) with polynomials of degree {degree}, {} bits of coefficients",
            it.words.len(),
            it.segments.layout.name(),
            it.rom_bits()
        ),
    };
    About {
        device: "function".to_owned(),
        title: format!("{formula}, by piecewise polynomials"),
        formula: format!("result = {formula}"),
        source: "The configuration".to_owned(),
        notes: vec![
            format!("The domain is x from {from} to {to}, {ends}.").into(),
            format!(
                "{reduced}{shape}. {proof}: no result is further off than {} units of the last place.",
                text::rounded_up(it.bound, 4)
            )
            .into(),
        ],
    }
}
