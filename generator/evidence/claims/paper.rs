//! What seed 002, the paper on W, says.

use super::{
    Claim, EPICENTRE, Measured, Verdict, error, exceeding, found, key, runs, schlick,
    to_inflection, upper, w,
};
use crate::evidence::measure::{self, Function, Region};

const SOURCE: &str = "seed 002, the paper on W";

/// The exponents over which the paper's figures come out.
const PAPER: std::ops::RangeInclusive<u32> = 16..=250;

/// All exponents of the paper's Figs. 8 and 9 at which `cosⁿγ` has an inflection point.
const FROM_TWO: std::ops::RangeInclusive<u32> = 2..=250;

/// The level at which the paper's errors "in the blooming zone" come out.
const BLOOMING: Region = Region::Level(0.20);

/// The same, for Schlick's function.
const SCHLICK_BLOOMING: Region = Region::Level(0.19);

/// The claims, in the order of the paper.
pub fn claims() -> Vec<Claim> {
    vec![
        before_inflection("w4-epicentre", 4, 0.08, "8.0 %"),
        before_inflection("w8-epicentre", 8, 0.038, "3.8 %"),
        before_inflection("w16-epicentre", 16, 0.01, "1.0 %"),
        one_per_cent(),
        schlick_epicentre(),
        schlick_under_ten(),
        blooming("w4-blooming", 4, 0.352, "35.2 %"),
        blooming("w8-blooming", 8, 0.162, "16.2 %"),
        blooming("w16-blooming", 16, 0.076, "7.6 %"),
        schlick_blooming(),
        ratio(
            "ratio-epicentre",
            "W with m = 16 is more than 22 times as accurate as Schlick's function before the inflection point",
            "22 (its own table gives 22.4)",
            22.0,
            [Region::Inflection, EPICENTRE],
        ),
        ratio(
            "ratio-blooming",
            "W with m = 16 is more than 14 times as accurate as Schlick's function in the blooming zone",
            "14 (its own table gives 12.9)",
            14.0,
            [BLOOMING, SCHLICK_BLOOMING],
        ),
        multiplications(),
    ]
}

/// The largest relative error of a function over the paper's exponents.
fn papers(function: Function, region: Region) -> Option<Measured> {
    let worst = measure::over(function, PAPER, region)?;
    let definition = format!("{}, n = 16…250", region.name());
    Some(error(worst, key(region), definition))
}

/// A figure that is not an error.
fn plain(key: &str, definition: &str, value: f64, text: String) -> Measured {
    Measured { key: key.to_owned(), definition: definition.to_owned(), value, text, n: None }
}

/// W and the paper's error before the inflection point.
fn before_inflection(id: &'static str, m: u32, limit: f64, seed: &str) -> Claim {
    let function = w(m);
    let mut ours = found([Region::Inflection, EPICENTRE].map(|region| papers(&function, region)));
    // The paper says n = 1…250; its figures come out where n is well above m.
    if let Some(worst) = measure::over(&function, FROM_TWO, Region::Inflection) {
        let definition = "to the inflection point, n = 2…250".to_owned();
        ours.push(error(worst, "inflection-from-2".to_owned(), definition));
    }
    let verdict = upper(&ours, limit);
    let level = measure::level_of(&function, PAPER, limit);
    let level = level.map_or_else(String::new, |level| {
        format!(" The paper's figure is what cos\u{207f}\u{3b3} \u{2265} {level:.2} gives.")
    });
    let small = match ours.last() {
        Some(one) if one.value > limit => format!(
            " Below n = 16 it does not hold: {} at n = {}.",
            one.text,
            one.n.unwrap_or_default()
        ),
        _ => String::new(),
    };
    let figures: Vec<&str> = ours.iter().map(|one| one.text.as_str()).collect();
    Claim {
        id,
        source: SOURCE,
        claim: format!(
            "W with m = {m}: largest relative error before the inflection point, n = 1…250"
        ),
        seed: seed.to_owned(),
        verdict,
        words: format!(
            "For n \u{2265} 16 it holds at the inflection point ({}); down to level 0.46 the error is {}.{level}{small}",
            figures.first().unwrap_or(&""),
            figures.get(1).unwrap_or(&""),
        ),
        ours,
    }
}

fn schlick_epicentre() -> Claim {
    let ours = found([Region::Inflection, EPICENTRE].map(|region| papers(&schlick, region)));
    let level = measure::level_of(&schlick, PAPER, 0.224).unwrap_or(f64::NAN);
    Claim {
        id: "schlick-epicentre",
        source: SOURCE,
        claim: "Schlick's function: largest relative error before the inflection point".to_owned(),
        seed: "22.4 %".to_owned(),
        // The larger the rival's error the better for the paper: at the true inflection point it is no such figure.
        verdict: Verdict::Depends,
        words: format!(
            "It is the error where cos\u{207f}\u{3b3} \u{2265} {level:.2}, as for m = 4 and 8. At the inflection point \
             itself Schlick's function is less than half as far off."
        ),
        ours,
    }
}

fn schlick_under_ten() -> Claim {
    let ours: Vec<Measured> = papers(&schlick, Region::Inflection).into_iter().collect();
    Claim {
        id: "schlick-under-ten",
        source: SOURCE,
        claim: "Schlick's function reproduces the epicentre with an error of at most 10 %"
            .to_owned(),
        seed: "10 %".to_owned(),
        verdict: upper(&ours, 0.10),
        words: "It holds at the inflection point, and contradicts the 22.4 % that the same paper gives for it."
            .to_owned(),
        ours,
    }
}

/// W and the paper's error in the blooming zone.
fn blooming(id: &'static str, m: u32, limit: f64, seed: &str) -> Claim {
    let function = w(m);
    let ours: Vec<Measured> = papers(&function, BLOOMING).into_iter().collect();
    let level = measure::level_of(&function, PAPER, limit).unwrap_or(f64::NAN);
    Claim {
        id,
        source: SOURCE,
        claim: format!("W with m = {m}: largest relative error in the blooming zone"),
        seed: seed.to_owned(),
        verdict: upper(&ours, limit),
        words: format!(
            "The paper does not say where the zone ends; its figure is reached at cos\u{207f}\u{3b3} = {level:.3}. \
             Without an end the error is 100 %, for W becomes 0 where cos\u{207f}\u{3b3} does not."
        ),
        ours,
    }
}

fn schlick_blooming() -> Claim {
    let ours = found([BLOOMING, SCHLICK_BLOOMING].map(|region| papers(&schlick, region)));
    let level = measure::level_of(&schlick, PAPER, 0.982).unwrap_or(f64::NAN);
    Claim {
        id: "schlick-blooming",
        source: SOURCE,
        claim: "Schlick's function: largest relative error in the blooming zone".to_owned(),
        seed: "98.2 %".to_owned(),
        verdict: upper(&ours, 0.982),
        words: format!(
            "The paper's figure is reached at cos\u{207f}\u{3b3} = {level:.3}, a little farther out than for W. \
             Farther still the error grows without limit."
        ),
        ours,
    }
}

/// The error of Schlick's function over that of W, both in the same region.
fn ratio(id: &'static str, claim: &str, seed: &str, least: f64, regions: [Region; 2]) -> Claim {
    let best = w(16);
    let over = |region| {
        let (of_schlick, of_w) = (papers(&schlick, region)?, papers(&best, region)?);
        let value = of_schlick.value / of_w.value;
        Some(plain(
            &key(region),
            &format!("both {}, n = 16…250", region.name()),
            value,
            format!("{value:.1} times"),
        ))
    };
    let ours = found(regions.map(over));
    let reached = ours.iter().filter(|one| one.value >= least).count();
    let figures: Vec<&str> = ours.iter().map(|one| one.text.as_str()).collect();
    let verdict = match reached {
        0 => Verdict::Fails,
        count if count == ours.len() => Verdict::Holds,
        _ => Verdict::Depends,
    };
    let why = match id {
        "ratio-epicentre" => {
            " The paper divides Schlick's error at level 0.46 by that of W at the inflection point."
        }
        _ => " Its own table, 98.2 over 7.6, does not give 14 either.",
    };
    Claim {
        id,
        source: SOURCE,
        claim: claim.to_owned(),
        seed: seed.to_owned(),
        verdict,
        words: format!("It is {} with one definition for both.{why}", figures.join(" or ")),
        ours,
    }
}

fn one_per_cent() -> Claim {
    let function = w(16);
    let failing = exceeding(&function, FROM_TWO, 0.01);
    let after = failing.last().map_or(2, |last| last + 1);
    let ours = found([
        to_inflection(&function, FROM_TWO, "from-2", "m = 16"),
        to_inflection(&function, after..=250, "holding", "m = 16"),
    ]);
    Claim {
        id: "w16-one-per-cent",
        source: SOURCE,
        claim: "W with m = 16 is within 1 % before the inflection point for all n = 1…250"
            .to_owned(),
        seed: "1 %".to_owned(),
        verdict: if failing.is_empty() { Verdict::Holds } else { Verdict::Fails },
        words: format!(
            "It fails for n = {}, and holds from n = {after} on. n = 1 has no inflection point: W is beside the \
             cosine there.",
            runs(&failing)
        ),
        ours,
    }
}

fn multiplications() -> Claim {
    let squarings = 16u32.ilog2();
    let count = 1 + squarings;
    Claim {
        id: "multiplications",
        source: SOURCE,
        claim: "W with m = 16 needs four multiplications".to_owned(),
        seed: "4".to_owned(),
        ours: vec![plain(
            "count",
            "one by n (the division by m is a shift) and the squarings",
            f64::from(count),
            format!("{count}"),
        )],
        verdict: Verdict::Fails,
        words: format!(
            "The {squarings} squarings are four; n\u{b7}(cos \u{3b3} \u{2212} 1) is the fifth. It is saved only \
             where n/m \u{b7} (cos \u{3b3} \u{2212} 1) comes from outside."
        ),
    }
}
