//! Measures the claims of seed 002, the paper about the function W.

use std::f64::consts::{FRAC_PI_2, PI};

use super::super::measure::{self, Function, Region};
use super::{
    Claim, EPICENTRE, Measured, Verdict, claim, error, exceeding, found, holds_if, instance, key,
    plain, runs, schlick, to_inflection, upper, w,
};

/// The exponents over which the paper's figures come out.
const PAPER: std::ops::RangeInclusive<u32> = 16..=250;

/// All exponents of the paper's Figs. 8 and 9 at which `cosⁿγ` has an inflection point.
const FROM_TWO: std::ops::RangeInclusive<u32> = 2..=250;

/// The level at which the paper's errors "in the blooming zone" come out.
const BLOOMING: Region = Region::Level(0.20);

/// The level at which the errors of Schlick's function come out.
const SCHLICK_BLOOMING: Region = Region::Level(0.19);

/// Returns the claims, in the order of the paper.
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
        ratio("ratio-epicentre", 22.0, [Region::Inflection, EPICENTRE]),
        ratio("ratio-blooming", 14.0, [BLOOMING, SCHLICK_BLOOMING]),
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

/// Returns a figure that may be next to nothing.
fn tiny(key: &str, definition: &str, value: f64) -> Measured {
    plain(key, definition, value, format!("{value:.1e}"))
}

fn not_negative() -> Claim {
    let least = |powers: &[u32], end: f64| {
        let powers = powers.iter().flat_map(|&m| ALL.map(move |n| (m, n)));
        let values = powers.flat_map(|(m, n)| angles(end).map(move |gamma| unclamped(gamma, n, m)));
        values.fold(f64::INFINITY, f64::min)
    };
    let ours = vec![
        tiny(
            "m-2",
            "the least W, m = 2, \u{3b3} = 0\u{2026}180\u{b0}, n = 1\u{2026}1000",
            least(&[2], PI),
        ),
        tiny("all-m", "the same, m = 2, 4, 8, 16", least(&POWERS, PI)),
    ];
    let verdict = holds_if(ours.iter().all(|one| one.value >= 0.0));
    claim("not-negative", ours, verdict, &[])
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
    let verdict = if holds { Verdict::Depends } else { Verdict::Fails };
    claim("zero", ours, verdict, &[])
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
    let behind = unclamped(FRAC_PI_2, 100, 2);
    let ours = vec![
        tiny(
            "m-2",
            "the largest rise from an angle to the next up to the zero, m = 2, n = 1\u{2026}1000",
            steepest(&[2]),
        ),
        tiny("all-m", "the same, m = 2, 4, 8, 16, each up to its own zero", steepest(&POWERS)),
        plain(
            "behind",
            "W at 90\u{b0}, n = 100, m = 2, without a clamp",
            behind,
            format!("{behind:.0}"),
        ),
    ];
    let verdict = holds_if(ours[..2].iter().all(|one| one.value <= 0.0));
    claim("falling", ours, verdict, &[])
}

/// Returns the exponents at which some property of errors in a region fails.
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

/// Returns a claim about all exponents: how many fail in each region.
fn of_all(id: &str, holds: &Holds) -> Claim {
    let regions = [Region::Inflection, EPICENTRE, BLOOMING];
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
    let verdict = if most.is_none() { Verdict::Holds } else { Verdict::Depends };
    claim(id, ours, verdict, &[("words", words)])
}

fn better_with_power() -> Claim {
    let [first, second, third] = THREE.map(w);
    of_all("better-with-power", &|error| {
        error(&first) > error(&second) && error(&second) > error(&third)
    })
}

fn ahead_of_schlick() -> Claim {
    let three = THREE.map(w);
    of_all("ahead-of-schlick", &|error| three.iter().all(|w| error(w) < error(&schlick)))
}

/// Returns the largest relative error of a function over the paper's exponents.
fn papers(function: Function, region: Region) -> Option<Measured> {
    let worst = measure::over(function, PAPER, region)?;
    let definition = format!("{}, n = 16…250", region.name());
    Some(error(worst, key(region), definition))
}

/// W and the paper's error before the inflection point.
fn before_inflection(id: &str, m: u32, limit: f64, seed: &str) -> Claim {
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
    let figure = |at: usize| ours.get(at).map_or_else(String::new, |one| one.text.clone());
    let values = [
        ("m", m.to_string()),
        ("seed", seed.to_owned()),
        ("first", figure(0)),
        ("second", figure(1)),
        ("level", level),
        ("small", small),
    ];
    instance("epicentre", id, ours, verdict, &values)
}

fn schlick_epicentre() -> Claim {
    let ours = found([Region::Inflection, EPICENTRE].map(|region| papers(&schlick, region)));
    let level = measure::level_of(&schlick, PAPER, 0.224).unwrap_or(f64::NAN);
    // The larger the rival's error the better for the paper: at the true inflection point it is no such figure.
    claim("schlick-epicentre", ours, Verdict::Depends, &[("level", format!("{level:.2}"))])
}

fn schlick_under_ten() -> Claim {
    let ours: Vec<Measured> = papers(&schlick, Region::Inflection).into_iter().collect();
    let verdict = upper(&ours, 0.10);
    claim("schlick-under-ten", ours, verdict, &[])
}

/// W and the paper's error in the blooming zone.
fn blooming(id: &str, m: u32, limit: f64, seed: &str) -> Claim {
    let function = w(m);
    let ours: Vec<Measured> = papers(&function, BLOOMING).into_iter().collect();
    let level = measure::level_of(&function, PAPER, limit).unwrap_or(f64::NAN);
    let verdict = upper(&ours, limit);
    let values =
        [("m", m.to_string()), ("seed", seed.to_owned()), ("level", format!("{level:.3}"))];
    instance("blooming", id, ours, verdict, &values)
}

fn schlick_blooming() -> Claim {
    let ours = found([BLOOMING, SCHLICK_BLOOMING].map(|region| papers(&schlick, region)));
    let level = measure::level_of(&schlick, PAPER, 0.982).unwrap_or(f64::NAN);
    let verdict = upper(&ours, 0.982);
    claim("schlick-blooming", ours, verdict, &[("level", format!("{level:.3}"))])
}

/// The error of Schlick's function over that of W, both in the same region.
fn ratio(id: &str, least: f64, regions: [Region; 2]) -> Claim {
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
    let figures = figures.join(" or ");
    claim(id, ours, verdict, &[("figures", figures)])
}

fn one_per_cent() -> Claim {
    let function = w(16);
    let failing = exceeding(&function, FROM_TWO, 0.01);
    let after = failing.last().map_or(2, |last| last + 1);
    let ours = found([
        to_inflection(&function, FROM_TWO, "from-2", "m = 16"),
        to_inflection(&function, after..=250, "holding", "m = 16"),
    ]);
    let values = [("failing", runs(&failing)), ("after", after.to_string())];
    claim("w16-one-per-cent", ours, holds_if(failing.is_empty()), &values)
}

fn multiplications() -> Claim {
    let squarings = 16u32.ilog2();
    let count = 1 + squarings;
    let definition = "one by n (the division by m is a shift) and the squarings";
    let ours = vec![plain("count", definition, f64::from(count), count.to_string())];
    claim("multiplications", ours, Verdict::Fails, &[("squarings", squarings.to_string())])
}
