//! Tests random formulas of up to three operands.
//!
//! Glint proves a bound for a formula and makes a core. No result of any combination of operands exceeds the bound that interval
//! arithmetic proves, and the core agrees with its golden model. Every fourth core passes its bench in Icarus Verilog, and for as
//! many others a program in C confirms the bound with MPFR. If Glint refuses the formula, this test finds a reason by an evaluation
//! of its own. At most a tenth of the formulas may be refused without such a reason, because of the planner's limits.

use crate::common::bench::Bench;
use crate::common::cores::{Emitted, assert_agrees, assert_results_as_stated};
use crate::common::netlist::POINTS;
use crate::common::sample::sampled_by_name;
use crate::common::tools::{EFFORT, finding};
use glint::core::Core;
use glint::cosim::Random;
use glint::cosim::batch::{Engine, Golden, Points};
use glint::keys;
use glint::registry::Registry;
use glint::tools::VerilogSimulator;
use glint::verify::CheckVerdict;

/// The random configurations.
const CONFIGURATIONS: u64 = 400;

/// Every so many configurations run in Icarus, too, and as many are recomputed by the program in C.
const EVERY: u64 = 4;

/// The most refusals, in percent of the formulas. Many random formulas have a pole, or values of very different sizes.
const MOST_REFUSED: usize = 50;

/// The most refusals whose only reason is a limit of the planner, in percent of the formulas.
const MOST_UNPROVED: usize = 10;

/// The names of the operands.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// A way to make a formula of one formula or two.
struct Composition {
    /// The text, with `A` and `B` for the parts.
    text: &'static str,
    /// The value, computed from the values of the parts.
    value: fn(f64, f64) -> f64,
}

const COMPOSITIONS: [Composition; 32] = [
    Composition { text: "(A) + (B)", value: |a, b| a + b },
    Composition { text: "(A) - (B)", value: |a, b| a - b },
    Composition { text: "(A) * (B)", value: |a, b| a * b },
    Composition { text: "(A) / (2 + abs(B))", value: |a, b| a / (2.0 + b.abs()) },
    Composition { text: "(A) / (B)", value: |a, b| a / b },
    Composition { text: "(A) / 3", value: |a, _| a / 3.0 },
    Composition { text: "-(A)", value: |a, _| -a },
    Composition { text: "abs(A)", value: |a, _| a.abs() },
    Composition { text: "min(A, B)", value: f64::min },
    Composition { text: "max(A, B)", value: f64::max },
    Composition { text: "if(A < B, A, B)", value: f64::min },
    Composition { text: "if(A < B, 1, A)", value: |a, b| if a < b { 1.0 } else { a } },
    Composition { text: "(A)^2", value: |a, _| a * a },
    Composition { text: "sqrt(abs(A))", value: |a, _| a.abs().sqrt() },
    Composition { text: "-2 / sqrt(0.3 + abs(A))", value: |a, _| -2.0 / (0.3 + a.abs()).sqrt() },
    Composition { text: "hypot(A, B)", value: f64::hypot },
    Composition { text: "atan2(A, 3 + (B))", value: |a, b| a.atan2(3.0 + b) },
    Composition { text: "1 / (1 + (A)^2)", value: |a, _| 1.0 / (1.0 + a * a) },
    Composition { text: "sin(A)", value: |a, _| a.sin() },
    Composition { text: "cos(2 * pi * (A))", value: |a, _| (std::f64::consts::TAU * a).cos() },
    Composition { text: "exp(-abs(A))", value: |a, _| (-a.abs()).exp() },
    Composition { text: "exp2(3 * (A))", value: |a, _| (3.0 * a).exp2() },
    Composition { text: "ln(0.1 + abs(A))", value: |a, _| (0.1 + a.abs()).ln() },
    Composition { text: "log2(1 + abs(A))", value: |a, _| (1.0 + a.abs()).log2() },
    Composition { text: "tanh(A) * (B)", value: |a, b| a.tanh() * b },
    Composition { text: "(0.2 + abs(A)) ^ (B)", value: |a, b| (0.2 + a.abs()).powf(b) },
    Composition { text: "abs(A) ^ abs(B)", value: |a, b| a.abs().powf(b.abs()) },
    Composition { text: "floor((A) * 4)", value: |a, _| (a * 4.0).floor() },
    Composition { text: "(A) % 0.25", value: |a, _| a.rem_euclid(0.25) },
    Composition { text: "round(3 * (A)) / 4", value: |a, _| (3.0 * a + 0.5).floor() / 4.0 },
    Composition { text: "if(B > 0, (A) / (B), A)", value: |a, b| if b > 0.0 { a / b } else { a } },
    Composition {
        text: "sign(A) + clamp(B, -0.5, A)",
        value: |a, b| {
            f64::from(u8::from(a > 0.0)) - f64::from(u8::from(a < 0.0)) + b.max(-0.5).min(a)
        },
    },
];

/// A random formula.
enum Tree {
    /// An operand, by its number.
    Operand(usize),
    Number(&'static str),
    Composed(&'static Composition, Box<[Tree; 2]>),
}

impl Tree {
    /// Draws a formula whose parts are nested at most `depth` times.
    fn drawn(random: &mut Draw, depth: u64) -> Self {
        if depth == 0 {
            return match random.below(8) {
                0 => Self::Number("0.3"),
                1 => Self::Number("2"),
                2 => Self::Number("1.7"),
                number => Self::Operand(number as usize % NAMES.len()),
            };
        }
        let composition = &COMPOSITIONS[random.below(COMPOSITIONS.len() as u64) as usize];
        let first = Self::drawn(random, depth - 1);
        let other_depth = random.below(depth);
        let second = Self::drawn(random, other_depth);
        Self::Composed(composition, Box::new([first, second]))
    }

    fn text(&self) -> String {
        match self {
            Self::Operand(number) => NAMES[*number].to_owned(),
            Self::Number(text) => (*text).to_owned(),
            Self::Composed(composition, parts) => {
                let [a, b] = [parts[0].text(), parts[1].text()];
                let mut text = String::new();
                for character in composition.text.chars() {
                    match character {
                        'A' => text += &a,
                        'B' => text += &b,
                        _ => text.push(character),
                    }
                }
                text
            }
        }
    }

    /// Returns whether the formula depends on an operand.
    fn reads(&self, operand: usize) -> bool {
        match self {
            Self::Operand(number) => *number == operand,
            Self::Number(_) => false,
            Self::Composed(composition, parts) => {
                let reads_second = composition.text.contains('B') && parts[1].reads(operand);
                parts[0].reads(operand) || reads_second
            }
        }
    }

    /// Returns the value, and shows `visit` the value of each part. `visit` returns the value with which the evaluation goes on.
    fn value(&self, operands: &[f64; 3], visit: &mut dyn FnMut(f64) -> f64) -> f64 {
        match self {
            Self::Operand(number) => operands[*number],
            Self::Number(text) => text.parse().expect("a number"),
            Self::Composed(composition, parts) => {
                let a = parts[0].value(operands, visit);
                let b = parts[1].value(operands, visit);
                visit((composition.value)(a, b))
            }
        }
    }
}

/// Numbers at random.
struct Draw(Random);

impl Draw {
    fn below(&mut self, count: u64) -> u64 {
        self.0.bits() % count
    }
}

/// The format of an operand of a random configuration.
struct Operand {
    bits: u64,
    fraction: u64,
    is_signed: bool,
    /// The domain in raw values, both ends included, and whether other operands are limited to it. `None` for the whole format.
    domain: Option<(i64, i64, bool)>,
}

impl Operand {
    /// Returns the smallest and the largest raw value of the format.
    fn limits(&self) -> (i64, i64) {
        let count = 1i64 << self.bits;
        let first = if self.is_signed { -count / 2 } else { 0 };
        (first, first + count - 1)
    }

    /// Returns all values of the operand in its domain.
    fn values(&self) -> Vec<f64> {
        let (first, last) =
            self.domain.map_or_else(|| self.limits(), |(first, last, _)| (first, last));
        let scale = (self.fraction as f64).exp2();
        (first..=last).map(|raw| raw as f64 / scale).collect()
    }

    /// Returns the entry of the operand in a configuration.
    fn toml(&self) -> String {
        let Self { bits, fraction, is_signed, domain } = self;
        let Some((first, last, is_clamped)) = domain else {
            return format!("{{ bits = {bits}, fraction = {fraction}, signed = {is_signed} }}");
        };
        let [from, to] = [first, last].map(|raw| format!("{raw} / 2^{fraction}"));
        let outside = if *is_clamped { "clamp" } else { "anything" };
        format!(
            "{{ from = \"{from}\", to = \"{to}\", to_included = true, fraction = {fraction}, outside = \"{outside}\" }}"
        )
    }
}

/// A random configuration: one formula or two, of operands with few bits.
struct Configuration {
    operands: Vec<(usize, Operand)>,
    results: Vec<Tree>,
    fraction: u64,
    /// Whether results are promised only where the first operand is above 1/10.
    is_limited: bool,
    /// The fields that state the width of each result, if one is stated.
    width: String,
    architecture: String,
}

impl Configuration {
    fn drawn(seed: u64) -> Self {
        let mut random = Draw(Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let mut results = Vec::new();
        for _ in 0..1 + random.below(2) {
            let depth = 1 + random.below(6);
            results.push(Tree::drawn(&mut random, depth));
        }
        let mut operands = Vec::new();
        for number in 0..NAMES.len() {
            if !results.iter().any(|result| result.reads(number)) {
                continue;
            }
            let bits = 3 + random.below(4);
            let (fraction, is_signed) = (2 + random.below(4), random.below(2) == 0);
            let mut operand = Operand { bits, fraction, is_signed, domain: None };
            if random.below(3) == 0 {
                let (first, last) = operand.limits();
                let low = first + random.below(1 << (bits - 1)) as i64;
                let high = low + 1 + random.below((last - low) as u64) as i64;
                operand.domain = Some((low, high, random.below(2) == 0));
            }
            operands.push((number, operand));
        }
        let architecture = match random.below(3) {
            0 => String::new(),
            _ => format!(
                "architecture = \"pipelined\"\npipeline.clock_mhz = 60\npipeline.interval = {}\n",
                1 + random.below(3)
            ),
        };
        let fraction = 2 + random.below(9);
        let width = match random.below(4) {
            0 => {
                let bits = fraction + 1 + random.below(3);
                let overflow = ["saturate", "wrap"][random.below(2) as usize];
                format!(", bits = {bits}, signed = true, overflow = \"{overflow}\"")
            }
            _ => String::new(),
        };
        let is_limited = random.below(4) == 0;
        Self { operands, results, fraction, is_limited, width, architecture }
    }

    fn toml(&self) -> String {
        let mut text = format!("device = \"expression\"\nname = \"core\"\n{}", self.architecture);
        for (number, operand) in &self.operands {
            text += &format!("operands.{} = {}\n", NAMES[*number], operand.toml());
        }
        let promise = match self.is_limited {
            true => format!(", where = \"{} > 0.1\"", NAMES[self.operands[0].0]),
            false => String::new(),
        };
        for (number, result) in self.results.iter().enumerate() {
            let formula = result.text();
            let (fraction, width) = (self.fraction, &self.width);
            text += &format!(
                "results.r{number} = {{ formula = \"{formula}\", fraction = {fraction}{width}{promise} }}\n"
            );
        }
        text
    }

    /// Calls `visit` with the combinations of operands for which the results are promised, until it returns a reason.
    fn find(&self, visit: &mut dyn FnMut(&[f64; 3]) -> Option<String>) -> Option<String> {
        let mut values = [vec![0.0], vec![0.0], vec![0.0]];
        for (number, operand) in &self.operands {
            values[*number] = operand.values();
        }
        let limited = self.operands[0].0;
        for &x in &values[0] {
            for &y in &values[1] {
                for &z in &values[2] {
                    let operands = [x, y, z];
                    if self.is_limited && operands[limited] <= 0.1 {
                        continue;
                    }
                    let found = visit(&operands);
                    if found.is_some() {
                        return found;
                    }
                }
            }
        }
        None
    }

    /// Checks that no error of the results, by an evaluation of the formulas for every combination of operands, exceeds the bound
    /// that interval arithmetic proves.
    ///
    /// # Panics
    /// An error exceeds its bound.
    fn assert_enclosed(&self, core: &Core, what: &str) {
        /// The most that the evaluation errs by, in units of the last place.
        const EVALUATION: f64 = 1e-6;
        let plan = keys::expression::plan(core.config()).expect("a plan");
        let mut points = Points::new(self.operands.len());
        let mut exact = Vec::new();
        let scale = (self.fraction as f64).exp2();
        let _ = self.find(&mut |values| {
            let raw = |(number, operand): &(usize, Operand)| {
                (values[*number] * (operand.fraction as f64).exp2()) as i64
            };
            points.push(self.operands.iter().map(raw), 1);
            exact.extend(self.results.iter().map(|it| it.value(values, &mut |part| part) * scale));
            None
        });
        let results = Golden(&*core.contract).compute(&points).expect("results");
        assert_eq!(results.len(), exact.len(), "{what}");
        for (at, (result, exact)) in results.iter().zip(&exact).enumerate() {
            let bound = plan.enclosed[at % self.results.len()];
            let error = (*result as f64 - exact).abs();
            let point = points.operands(at / self.results.len());
            assert!(error <= bound + EVALUATION, "{error} > {bound} for {point:?}: {what}");
        }
    }

    /// Returns why no core keeps the error, found by evaluation; `None` if no reason is found.
    fn difficulty(&self) -> Option<String> {
        /// A value that is this small, or as large as its inverse, needs too many bits.
        const SMALL: f64 = 1.0 / 1024.0;
        /// A part that is off by this moves the result.
        const NUDGE: f64 = 1.0 / (1u64 << 24) as f64;
        let unit = (-(self.fraction as f64)).exp2();
        let mut combinations = 0;
        let found = self.find(&mut |operands| {
            combinations += 1;
            for result in &self.results {
                let (mut parts, mut extreme) = (0, None);
                let right = result.value(operands, &mut |part| {
                    parts += 1;
                    let size = part.abs();
                    if !part.is_finite() || size > 1.0 / SMALL || size != 0.0 && size < SMALL {
                        extreme = Some(part);
                    }
                    part
                });
                if let Some(part) = extreme {
                    return Some(format!("a part is {part} for {operands:?}"));
                }
                for nudged in 0..parts {
                    for nudge in [-NUDGE, NUDGE] {
                        let mut number = 0;
                        let moved = result.value(operands, &mut |part| {
                            let is_nudged = number == nudged;
                            number += 1;
                            if is_nudged { part + nudge } else { part }
                        });
                        let distance = (moved - right).abs();
                        if distance.is_nan() || distance > unit / 4.0 {
                            return Some(format!("a part decides the result for {operands:?}"));
                        }
                    }
                }
            }
            None
        });
        if combinations == 0 {
            return Some("no operands satisfy the condition".to_owned());
        }
        found
    }
}

#[test]
fn random_formulas_agree_or_are_refused_with_reason() {
    let seeds = sampled_by_name("random expressions", 0..CONFIGURATIONS, u64::to_string);
    let (mut agreed, mut refused, mut unproved) = (0, 0, 0);
    for seed in seeds {
        let configuration = Configuration::drawn(seed);
        if configuration.operands.is_empty() {
            continue;
        }
        let text = configuration.toml();
        let what = format!("seed {seed}\n{text}");
        let opened = match Registry::shipped().parse("core.toml", &text) {
            Ok((opened, _)) => opened,
            Err(problems) => {
                refused += 1;
                let message = format!("{problems}");
                let reason = configuration.difficulty();
                if reason.is_none() {
                    let limits = [
                        "cannot be proved below",
                        "has no limit",
                        "would have",
                        "only of a value that is not rounded",
                        "no result changes with",
                    ];
                    let is_limit = limits.iter().any(|limit| message.contains(limit));
                    assert!(is_limit, "no reason is found for this refusal: {message}\n{what}");
                    unproved += 1;
                }
                println!("{what}{message}\n{}\n", reason.as_deref().unwrap_or("UNPROVED"));
                continue;
            }
        };
        let core = Core::build(opened).unwrap_or_else(|error| panic!("{error:#}\n{what}"));
        agreed += 1;
        assert_agrees(&core, 1000, seed, &what);
        assert_results_as_stated(&core, &what);
        if configuration.width.is_empty() {
            configuration.assert_enclosed(&core, &what);
        }
        if seed % EVERY == 0 {
            println!("{what}");
            let emitted = Emitted::new(&core, POINTS, seed);
            Bench::build(VerilogSimulator::Icarus, &emitted.simulated(), &emitted.bench())
                .assert_passes();
        }
        if seed % EVERY == 1 {
            let found = finding(&core, "recomputation", EFFORT);
            // The program does not follow results that wrap.
            let verdict = match configuration.width.contains("wrap") {
                true => CheckVerdict::NotApplicable,
                false => CheckVerdict::Proved,
            };
            assert_eq!(found.verdict, verdict, "{found:?}\n{what}");
        }
    }
    println!("{agreed} agree, {refused} are refused, {unproved} of them by limits of the planner");
    let all = agreed + refused;
    assert!(100 * refused <= MOST_REFUSED * all, "{refused} of {all} are refused");
    assert!(100 * unproved <= MOST_UNPROVED * all, "{unproved} of {all} are not proved");
}
