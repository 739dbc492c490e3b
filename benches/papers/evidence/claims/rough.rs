//! Measures the claims of seed 001, the patent of the device `rough`.

use super::{Claim, Measured, Verdict, claim, found, holds_if, plain};
use glint::core::Core;
use glint::registry::Registry;
use glint_config::Config;

/// Words of eight bits, of which all pairs are tried.
const WORDS: u32 = 256;

/// The largest exponent of the patent: "[1; 1000]".
const LARGEST_EXPONENT: u32 = 1000;

/// Returns the claims, in the order of the patent's description.
pub fn claims() -> Vec<Claim> {
    vec![inverse_code(), second_input(), ten_clocks()]
}

/// Returns how many of `all` words or pairs satisfy what is said of them.
fn share(key: &str, definition: &str, all: impl Iterator<Item = bool>) -> Measured {
    let (mut holding, mut count) = (0, 0);
    all.for_each(|holds| {
        holding += u32::from(holds);
        count += 1;
    });
    let text = format!("{holding} of {count}");
    plain(key, definition, f64::from(holding) / f64::from(count), text)
}

fn inverse_code() -> Claim {
    let pairs = (0..WORDS).flat_map(|a| (0..WORDS).map(move |b| (a, b)));
    let sum = |(a, b): (u32, u32)| (a + (WORDS - 1 - b)) % WORDS;
    // The 1 of the formula is the integer position, which words modulo 1.0 do not have.
    let of_formula = |(a, b): (u32, u32)| (WORDS + a - b) % WORDS;
    let off = pairs.clone().map(|pair| (of_formula(pair) + WORDS - sum(pair)) % WORDS);
    let off = f64::from(off.max().unwrap_or(0));
    let after = off * f64::from(LARGEST_EXPONENT) / 2.0;
    let ours = vec![
        share(
            "codes",
            "pairs of words of 8 bits whose sum of codes is A - B - 1, an ulp for the 1",
            pairs.map(|(a, b)| sum((a, b)) == (2 * WORDS + a - b - 1) % WORDS),
        ),
        plain(
            "ulps",
            "the largest distance from A - B - 1.0 of formula (3), modulo 1.0",
            off,
            format!("{off} ulp"),
        ),
        plain(
            "ulps-after-n",
            "the same behind the product by n/2, n = 1000",
            after,
            format!("{after} ulps"),
        ),
    ];
    claim("inverse-code", ours, Verdict::Depends, &[])
}

fn second_input() -> Claim {
    let minus_one = |key: &str, input: u32, place: &str| {
        let words = (0..WORDS).map(|b| (b + input) % WORDS == (b + WORDS - 1) % WORDS);
        let definition =
            format!("words of 8 bits from which adder 31 takes one with {key} there: {place}");
        share(key, &definition, words)
    };
    let ours = vec![
        minus_one("ones", WORDS - 1, "claim and description"),
        minus_one("zeros", 0, "summary"),
    ];
    claim("adder-31", ours, Verdict::Contradictory, &[])
}

fn ten_clocks() -> Claim {
    let registry = Registry::catalogue();
    let core = registry
        .device("rough")
        .and_then(|device| Core::new(*device, Config::defaults(&(device.schema)(), "rough")).ok());
    let timing = core.as_ref().and_then(|core| core.timing().ok());
    let clocks = |key: &str, definition: &str, clocks: Option<u32>| {
        clocks.map(|clocks| plain(key, definition, f64::from(clocks), format!("{clocks} clocks")))
    };
    let words = core.map(|core| core.design.control.microprogram.len() as u32);
    let ours = found([
        clocks("words", "the words of control ROM 30, one a clock", words),
        clocks(
            "to-done",
            "from the clock that takes «Пуск» to the one with «Кінець»",
            timing.as_ref().and_then(|it| it.start_to_done),
        ),
        clocks(
            "to-start",
            "from a start to the next, back to back",
            timing.as_ref().and_then(|it| it.start_to_start),
        ),
    ]);
    let ten = ours.iter().take(2).filter(|one| one.value == 10.0).count();
    claim("ten-clocks", ours, holds_if(ten == 2), &[])
}
