//! The claims of seed 002, the paper on W.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{
    Claim, EPICENTRE, Measured, Verdict, error, exceeding, found, key, plain, runs, schlick,
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

/// The level at which the errors of Schlick's function come out.
const SCHLICK_BLOOMING: Region = Region::Level(0.19);

/// The claims, in the order of the paper.
pub fn claims() -> Vec<Claim> {
    vec![
        not_negative(),
        zero(),
        falling(),
        better_with_power(),
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
        ahead_of_schlick(),
    ]
}

/// The powers of the paper.
const POWERS: [u32; 4] = [2, 4, 8, 16];

/// The powers of its three functions W1, W2 and W3.
const THREE: [u32; 3] = [4, 8, 16];

/// All exponents of the paper's study: "n \u{2208} [1, 1000]".
const ALL: std::ops::RangeInclusive<u32> = 1..=1000;

/// Angles at which a sign is looked at.
const ANGLES: u32 = 512;

/// Angles from 0 to an end.
fn angles(end: f64) -> impl DoubleEndedIterator<Item = f64> + Clone {
    (0..=ANGLES).map(move |step| end * f64::from(step) / f64::from(ANGLES))
}

/// (n/m\u{b7}(cos \u{3b3} \u{2212} 1) + 1)\u{1d50} as the paper writes it, without a clamp: what the devices have is 0 behind its zero.
fn unclamped(gamma: f64, n: u32, m: u32) -> f64 {
    let base = f64::from(n) / f64::from(m) * (libm::cos(gamma) - 1.0) + 1.0;
    (0..m.ilog2()).fold(base, |power, _| power * power)
}

fn not_negative() -> Claim {
    let least = |powers: &[u32], end: f64| {
        let powers = powers.iter().flat_map(|&m| ALL.map(move |n| (m, n)));
        let values = powers.flat_map(|(m, n)| angles(end).map(move |gamma| unclamped(gamma, n, m)));
        values.fold(f64::INFINITY, f64::min)
    };
    let of = |key: &str, definition: &str, value: f64| {
        plain(key, definition, value, format!("{value:.1e}"))
    };
    let ours = vec![
        of(
            "m-2",
            "the least W, m = 2, \u{3b3} = 0\u{2026}180\u{b0}, n = 1\u{2026}1000",
            least(&[2], PI),
        ),
        of("all-m", "the same, m = 2, 4, 8, 16", least(&POWERS, PI)),
    ];
    let holds = ours.iter().all(|one| one.value >= 0.0);
    Claim {
        id: "not-negative",
        source: "seed 002, the paper on W, before the derivative of W",
        claim: "W, a square, is never below 0".to_owned(),
        seed: "«є квадратом дійсного числа, то її значення завжди не менше 0»".to_owned(),
        ours,
        verdict: if holds { Verdict::Holds } else { Verdict::Fails },
        words: "It holds for every even power. The paper's list of properties calls W positive, which it is not at its \
                zero; behind the zero it rises again, so that the devices clamp it there."
            .to_owned(),
    }
}

fn zero() -> Claim {
    let place = |n: u32| libm::acos((f64::from(n) - 2.0) / f64::from(n));
    let largest = |m: u32| ALL.map(|n| unclamped(place(n), n, m)).fold(0.0, f64::max);
    let ours = vec![
        plain(
            "m-2",
            "the largest W there, m = 2, n = 1\u{2026}1000",
            largest(2),
            format!("{:.0e}", largest(2)),
        ),
        plain("m-16", "the largest W there, m = 16", largest(16), format!("{:.3}", largest(16))),
    ];
    let holds = ours[0].value < 1e-20;
    Claim {
        id: "zero",
        source: "seed 002, the paper on W, before the derivative of W",
        claim: "W is 0 at cos \u{3b3} = (n \u{2212} 2)/n, and least there".to_owned(),
        seed: "«приймає нульове значення при cos(\u{3b3}) = (n \u{2212} 2)/n»".to_owned(),
        ours,
        verdict: if holds { Verdict::Depends } else { Verdict::Fails },
        words: "It holds for m = 2, of which the paper speaks there, up to rounding; at n = 1 the zero is at 180\u{b0}, beyond the \
                90\u{b0} to which the paper limits \u{3b3}. With another power it is at (n \u{2212} m)/n, and W is not 0 at (n \u{2212} 2)/n."
            .to_owned(),
    }
}

fn falling() -> Claim {
    let steepest = |powers: &[u32]| {
        let all = powers.iter().flat_map(|&m| ALL.map(move |n| (m, n)));
        let rises = all.flat_map(|(m, n)| {
            let zero = libm::acos(((f64::from(n) - f64::from(m)) / f64::from(n)).max(-1.0));
            let before = angles(zero).map(move |gamma| unclamped(gamma, n, m));
            before.clone().skip(1).zip(before).map(|(next, before)| next - before)
        });
        rises.fold(f64::NEG_INFINITY, f64::max)
    };
    let of = |key: &str, definition: &str, value: f64| {
        plain(key, definition, value, format!("{value:.1e}"))
    };
    let behind = unclamped(FRAC_PI_2, 100, 2);
    let ours = vec![
        of(
            "m-2",
            "the largest rise from an angle to the next up to the zero, m = 2, n = 1\u{2026}1000",
            steepest(&[2]),
        ),
        of("all-m", "the same, m = 2, 4, 8, 16, each up to its own zero", steepest(&POWERS)),
        plain(
            "behind",
            "W at 90\u{b0}, n = 100, m = 2, without a clamp",
            behind,
            format!("{behind:.0}"),
        ),
    ];
    let holds = ours[..2].iter().all(|one| one.value <= 0.0);
    Claim {
        id: "falling",
        source: "seed 002, the paper on W, the derivative of W",
        claim: "W falls monotonically from \u{3b3} = 0 to arccos((n \u{2212} 2)/n)".to_owned(),
        seed: "«на проміжку [0, arccos((n \u{2212} 2)/n)] монотонно спадає»".to_owned(),
        ours,
        verdict: if holds { Verdict::Holds } else { Verdict::Fails },
        words: "It holds up to the zero. Behind it the parabola rises again, which the paper does not say: at 90\u{b0} it is \
                (n/2 \u{2212} 1)\u{b2}, and would be a bright ring."
            .to_owned(),
    }
}

/// The exponents at which some property of errors in a region fails.
fn failing(region: Region, holds: impl Fn(&dyn Fn(Function) -> f64) -> bool) -> Vec<u32> {
    let fails = |n: &u32| {
        let error = |function: Function| measure::at(function, *n, region).map(|it| it.error);
        measure::at(&schlick, *n, region).is_some()
            && !holds(&|function| error(function).unwrap_or(f64::NAN))
    };
    ALL.filter(fails).collect()
}

/// Whether a claim holds of the functions' errors.
type Holds<'a> = dyn Fn(&dyn Fn(Function) -> f64) -> bool + 'a;

/// A line of the ledger about all exponents: how many fail in each region.
fn failures(regions: [Region; 3], holds: &Holds) -> (Vec<Measured>, String) {
    let failing = regions.map(|region| (region, failing(region, holds)));
    let ours = failing.iter().map(|(region, failing)| {
        let text =
            if failing.is_empty() { "never".to_owned() } else { format!("n = {}", runs(failing)) };
        let definition = format!("where it fails of n = 1\u{2026}1000, {}", region.name());
        plain(&key(*region), &definition, failing.len() as f64, text)
    });
    let ours: Vec<Measured> = ours.collect();
    let most = failing.iter().flat_map(|(_, failing)| failing.last()).max();
    let words = match most {
        None => "It holds for every n, in every region.".to_owned(),
        Some(last) => {
            format!("It holds from n = {} to 1000 in every region, and fails below", last + 1)
        }
    };
    (ours, words)
}

fn better_with_power() -> Claim {
    let [first, second, third] = THREE.map(w);
    let (ours, words) = failures([Region::Inflection, EPICENTRE, BLOOMING], &|error| {
        error(&first) > error(&second) && error(&second) > error(&third)
    });
    Claim {
        id: "better-with-power",
        source: "seed 002, the paper on W, before its figure 5 (n = 35)",
        claim: "The accuracy of W grows with its power, m = 4, 8, 16".to_owned(),
        seed: "«зі зростанням степені m \u{2026} точність наближення до ДФВЗ \u{2026} зростає»"
            .to_owned(),
        verdict: if ours.iter().all(|one| one.value == 0.0) {
            Verdict::Holds
        } else {
            Verdict::Depends
        },
        ours,
        words: format!(
            "{words}: near n = m a smaller power is exact or nearly so. At n = 35 of its figures it holds."
        ),
    }
}

fn ahead_of_schlick() -> Claim {
    let three = THREE.map(w);
    let (ours, words) = failures([Region::Inflection, EPICENTRE, BLOOMING], &|error| {
        three.iter().all(|w| error(w) < error(&schlick))
    });
    Claim {
        id: "ahead-of-schlick",
        source: "seed 002, the paper on W, before its conclusions",
        claim: "All three W approximate better than Schlick's function".to_owned(),
        seed: "«усі три запропоновані функції забезпечують кращу апроксимацію, ніж функція Шліка»"
            .to_owned(),
        verdict: if ours.iter().all(|one| one.value == 0.0) {
            Verdict::Holds
        } else {
            Verdict::Depends
        },
        ours,
        words: format!("{words}: Schlick's function is exact at n = 1."),
    }
}

/// The largest relative error of a function over the paper's exponents.
fn papers(function: Function, region: Region) -> Option<Measured> {
    let worst = measure::over(function, PAPER, region)?;
    let definition = format!("{}, n = 16…250", region.name());
    Some(error(worst, key(region), definition))
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
