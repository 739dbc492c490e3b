//! The claims of seed 000, the patent of `quad-cosine`.

use super::{
    Claim, EPICENTRE, Verdict, exceeding, found, key, largest, quad, runs, stretched, to_inflection,
};
use crate::evidence::measure;

const SOURCE: &str = "seed 000, the patent of quad-cosine";

/// The claims, in the order of the patent.
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
    Claim {
        id: "quad-large",
        source: SOURCE,
        claim: "cos\u{1d4f}(\u{221a}(n/k)\u{b7}\u{3b4}) with k = 16 is within 0.6 % for all n > 6"
            .to_owned(),
        seed: "< 0.6 %".to_owned(),
        verdict: if failing.is_empty() { Verdict::Holds } else { Verdict::Fails },
        words: format!(
            "It fails for n = {}, and holds at the inflection point from n = {after} to 1000.",
            runs(&failing)
        ),
        ours,
    }
}

fn quad_small() -> Claim {
    let failing = exceeding(&quad, 2..=5, 0.01);
    let ours = found([
        to_inflection(&quad, 3..=3, "n-3", "k = 4"),
        to_inflection(&quad, 4..=5, "n-4-5", "k = 4"),
        to_inflection(&quad, 6..=6, "n-6", "k = 4"),
    ]);
    Claim {
        id: "quad-small",
        source: SOURCE,
        claim: "cos\u{1d4f}(\u{221a}(n/k)\u{b7}\u{3b4}) with k = 1, 2, 4 is within 1 % for n < 6"
            .to_owned(),
        seed: "\u{2264} 1 %".to_owned(),
        verdict: if failing.is_empty() { Verdict::Holds } else { Verdict::Fails },
        words: format!(
            "It fails for n = {}. n = 1, 2 and 4 are exact, for k = n; the patent does not speak of n = 6.",
            runs(&failing)
        ),
        ours,
    }
}

fn four_powers() -> Claim {
    let (three, nine) = (stretched(3), stretched(9));
    let ours = found([
        to_inflection(&nine, 4..=4, "k-9-n-4", "k = 9"),
        to_inflection(&three, 3..=4, "k-3-n-3-4", "k = 3"),
        to_inflection(&nine, 5..=1000, "k-9-from-5", "k = 9"),
    ]);
    let served = ours[1..].iter().all(|one| one.value <= 0.01);
    Claim {
        id: "four-powers",
        source: SOURCE,
        claim: "Four functions, with k = 1, 2, 3 and 9, give 1 % for all n".to_owned(),
        seed: "1 %".to_owned(),
        verdict: if served { Verdict::Depends } else { Verdict::Fails },
        words: "It holds if k = 3 serves n = 4 as well as n = 3, just so, and k = 9 serves n = 5…1000. With k = 9 from \
                n = 4 on it does not. n = 1 and 2 are exact."
            .to_owned(),
        ours,
    }
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
    Claim {
        id: "prototype",
        source: SOURCE,
        claim: "The prototype's cos\u{b2}(a\u{b7}\u{3b4}) is off by more than 10 % for all n"
            .to_owned(),
        seed: "> 10 %".to_owned(),
        verdict: Verdict::Fails,
        words: format!(
            "Not at the inflection point for any n, and at n = 2 it is exact. Where cos\u{207f}\u{3b3} \u{2265} 0.46 it is so for n = {}.",
            runs(&wide)
        ),
        ours,
    }
}
