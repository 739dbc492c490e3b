//! Measures the claims of seed 000, the patent of the device `quad-cosine`.

use super::super::measure;
use super::{
    Claim, EPICENTRE, Verdict, claim, exceeding, found, holds_if, key, largest, quad, runs,
    stretched, to_inflection,
};

/// Returns the claims, in the order of the patent.
pub fn claims() -> Vec<Claim> {
    vec![prototype(), four_powers(), quad_large(), quad_small()]
}

fn quad_large() -> Claim {
    let failing = exceeding(&quad, 7..=1000, 0.006);
    let after = failing.last().map_or(7, |last| last + 1);
    let ours = found([
        to_inflection(&quad, 7..=7, "n-7", "k = 16"),
        to_inflection(&quad, after..=1000, "holding", "k = 16"),
        largest(&quad, 7..=1000, EPICENTRE, &key(EPICENTRE), "k = 16"),
    ]);
    let values = [("failing", runs(&failing)), ("after", after.to_string())];
    claim("quad-large", ours, holds_if(failing.is_empty()), &values)
}

fn quad_small() -> Claim {
    let failing = exceeding(&quad, 2..=5, 0.01);
    let ours = found([
        to_inflection(&quad, 3..=3, "n-3", "k = 4"),
        to_inflection(&quad, 4..=5, "n-4-5", "k = 4"),
        to_inflection(&quad, 6..=6, "n-6", "k = 4"),
    ]);
    claim("quad-small", ours, holds_if(failing.is_empty()), &[("failing", runs(&failing))])
}

fn four_powers() -> Claim {
    let (three, nine) = (stretched(3), stretched(9));
    let ours = found([
        to_inflection(&nine, 4..=4, "k-9-n-4", "k = 9"),
        to_inflection(&three, 3..=4, "k-3-n-3-4", "k = 3"),
        to_inflection(&nine, 5..=1000, "k-9-from-5", "k = 9"),
    ]);
    let served = ours[1..].iter().all(|one| one.value <= 0.01);
    let verdict = if served { Verdict::Depends } else { Verdict::Fails };
    claim("four-powers", ours, verdict, &[])
}

fn prototype() -> Claim {
    let function = stretched(2);
    let wide: Vec<u32> = (1..=1000)
        .filter(|&n| measure::at(&function, n, EPICENTRE).is_some_and(|worst| worst.error > 0.10))
        .collect();
    let ours = found([
        to_inflection(&function, 2..=1000, "inflection", "at most"),
        largest(&function, 2..=1000, EPICENTRE, &key(EPICENTRE), "at most"),
    ]);
    claim("prototype", ours, Verdict::Fails, &[("wide", runs(&wide))])
}
