//! Tests the devices that compute the points of a scan line. `quad-cosine` runs in the built-in simulator: lines of 1, 2 and
//! 4096 points, the exponents at which the power changes, angles that wrap, and resets within a line.
//!
//! Other tests check, for `quad-cosine` and `cosine-squared`, the words of the tables, and that the same results come later
//! with more `line.stages`. They also bound how far the contract's results of the longest line drift from the unquantised
//! formula.

use std::f64::consts::FRAC_PI_2;

use glint::core::Core;
use glint::golden::formulas;
use glint::package::Computation;
use glint::render::setup::{Arc, LineParameters};
use glint::render::{Feed, Vector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use crate::common::cores::{assert_agrees, computations, parsed};
use crate::common::host::Host;

/// A right angle of the default of `quad-cosine`, s1.26.
const RIGHT: i64 = 1 << 26;

fn core(name: &str) -> Core {
    parsed("line.toml", &format!("device = \"{name}\"\n"))
}

/// A core in the simulator.
struct Bench<'a> {
    core: &'a Core,
    host: Host<'a>,
}

impl<'a> Bench<'a> {
    fn new(core: &'a Core) -> Self {
        Self { core, host: Host::new(&core.design) }
    }

    /// Returns the outputs of a line, which must come one a clock from the fourth clock on, the last with `done`.
    fn line(&mut self, operands: &[(&str, i64)]) -> Vec<i64> {
        self.host.start(operands);
        let mut points = Vec::new();
        for clock in 1..5000 {
            if self.host.value("valid") == 1 {
                assert_eq!(clock, 4 + points.len(), "one point a clock");
                points.push(self.host.value("intensity_out") as i64);
            }
            if self.host.value("busy") == 0 {
                assert_eq!(clock, 4 + points.len(), "done with the last point");
                return points;
            }
            let last = self.core.design.control.microprogram.len() as u64 - 1;
            let in_last_word = self.host.value("word_address") == last;
            assert_eq!(self.host.value("done"), u64::from(in_last_word));
            self.host.clock();
        }
        panic!("the line does not end");
    }

    /// Returns the contract's results of a line of `quad-cosine`.
    fn quad_expected(&self, [delta, start, n, length, amplitude]: [i64; 5]) -> Vec<i64> {
        let highlight = self.core.contract.highlight().expect("a highlight");
        (0..=length as u64)
            .map(|index| {
                let f = highlight.f(&highlight.point(&[delta, start, n, length], index));
                highlight.colour(f, amplitude)
            })
            .collect()
    }
}

fn quad_operands([delta, start, n, length, amplitude]: [i64; 5]) -> [(&'static str, i64); 5] {
    [
        ("delta_zeta", delta),
        ("zeta_start", start),
        ("exponent", n),
        ("length", length),
        ("amplitude", amplitude),
    ]
}

#[test]
fn lines_have_1_to_4096_points() {
    let quad = core("quad-cosine");
    let mut bench = Bench::new(&quad);
    // One point; two; the longest, over the highlight from −90° to 90° and around the circle four times.
    for operands in [
        [12345, RIGHT / 8, 40, 0, 255],
        [-RIGHT / 10, RIGHT / 8, 40, 1, 255],
        [RIGHT / 2048, -RIGHT, 1000, 4095, 255],
        [RIGHT / 256, 0, 3, 4095, 200],
        [-RIGHT / 256, 2 * RIGHT - 1, 7, 4095, 200],
    ] {
        let points = bench.line(&quad_operands(operands));
        assert_eq!(points, bench.quad_expected(operands), "{operands:?}");
        // And once more with the same operands.
        assert_eq!(bench.line(&[]), points);
    }
}

/// f at ζ = ±30° by the seed's formula, for every edge of decoder 10; by hand: cos¹⁶ 0, cos, cos², cos⁴ of √(3/4)
/// and √(6/4), cos¹⁶ of √(7/16), √(1000/16) and √(1023/16) times 30°.
#[test]
fn decoder_edges_choose_the_power() {
    let quad = core("quad-cosine");
    let mut bench = Bench::new(&quad);
    let expected = [
        (0, 255.0),
        (1, 220.84),
        (2, 191.25),
        (3, 166.52),
        (6, 105.15),
        (7, 95.77),
        (1000, 0.0),
        (1023, 0.0),
    ];
    for (n, exact) in expected {
        for sign in [-1, 1] {
            let points = bench.line(&quad_operands([0, sign * RIGHT / 3, n, 0, 255]));
            assert!((points[0] as f64 - exact).abs() < 1.0, "n = {n}: {points:?}");
        }
    }
    // The surface faces away: nothing, whatever n.
    for n in [0, 1, 2, 3, 6, 7, 1000, 1023] {
        for angle in [RIGHT, -RIGHT - 1, 2 * RIGHT - 1, -2 * RIGHT] {
            let points = bench.line(&quad_operands([0, angle, n, 0, 255]));
            assert_eq!(points, [0], "n = {n}");
        }
    }
    // Near the peak, where n = 1000 and 1023 differ from nothing.
    let near = RIGHT / 60;
    let point = |bench: &mut Bench, n| bench.line(&quad_operands([0, near, n, 0, 255]))[0];
    assert!(point(&mut bench, 1000) > point(&mut bench, 1023));
}

#[test]
fn a_reset_in_mid_line_drops_what_is_on_its_way() {
    let quad = core("quad-cosine");
    let mut bench = Bench::new(&quad);
    let operands = [RIGHT / 100, -RIGHT / 2, 20, 90, 255];
    // Before the first result, with results on their way, and in the last words.
    for clocks in [0, 1, 2, 3, 4, 50, 90, 91, 92, 93] {
        bench.host.start(&quad_operands(operands));
        for _ in 0..clocks {
            bench.host.clock();
        }
        assert_eq!(bench.host.value("busy"), 1);
        bench.host.set("rst_n", 0);
        bench.host.clock();
        bench.host.set("rst_n", 1);
        for _ in 0..4 {
            let still = ["busy", "valid", "done", "write_angle"].map(|name| bench.host.value(name));
            assert_eq!(still, [0; 4], "{clocks} clocks after the start");
            bench.host.clock();
        }
        let points = bench.line(&quad_operands(operands));
        assert_eq!(points, bench.quad_expected(operands));
    }
}

/// Every word of ROM 9 and of ROM 12, which a run does not come to see: √(n/k) is rounded to nearest, and the
/// middle of each step of a power is within half an ulp of its word.
#[test]
fn every_word_of_the_tables_is_rounded_right() {
    let powers = |n: u64| match n {
        1 => 1,
        2 => 2,
        3..=6 => 4,
        _ => 16,
    };
    for (device, tables) in [("quad-cosine", &[1, 2, 4, 16][..]), ("cosine-squared", &[2])] {
        let core = core(device);
        let rom = |name: &str| core.design.roms.iter().find(|rom| rom.name == name);
        if let Some(rom) = rom("root") {
            for (n, &word) in (0u64..).zip(&rom.words) {
                // (2r − 1)² ≤ 4·n·2²⁸/k < (2r + 1)².
                let (k, square) = (powers(n), n << 30);
                let below = (2 * word).saturating_sub(1).pow(2) * k;
                assert!(below <= square && square < (2 * word + 1).pow(2) * k, "n = {n}");
            }
        }
        let words = &rom("cosine").expect("a table").words;
        let steps = words.len() / tables.len();
        for (at, &word) in words.iter().enumerate() {
            let (power, step) = (tables[at / steps], at % steps);
            let value = |step: usize| {
                let cosine = (step as f64 / steps as f64 * FRAC_PI_2).cos();
                cosine.powi(power) * 1024.0
            };
            let middle = (value(step) + value(step + 1)) / 2.0;
            if step + 1 == steps {
                assert_eq!(word, 0);
            } else {
                let off = word as f64 - middle.min(1023.0);
                assert!(off.abs() <= 0.5 + 1e-9, "cos^{power}, step {step}: {word}");
            }
        }
    }
}

/// Random set-ups of lines whose highlight is on them, of the longest length.
fn set_ups(count: usize) -> impl Iterator<Item = LineParameters> {
    let mut source = ChaCha8Rng::seed_from_u64(3);
    let mut real = move || f64::from(source.next_u32()) / f64::from(u32::MAX) - 0.5;
    std::iter::repeat_with(move || {
        let mut near = |at: Vector, by: f64| Vector(at.0.map(|x| x + by * real()));
        let normal = Vector::new(0.0, 0.0, 1.0);
        let (n1, n2) = (near(normal, 1.0), near(normal, 1.0));
        let (h1, h2) = (near(n1, 1.5), near(n2, 1.5));
        let arc = Arc::new(n1, h1, n2, h2).expect("a set-up");
        let exponent = (1.0 + 999.0 * (real() + 0.5)) as u32;
        arc.line(255.0 / arc.peak.powi(exponent as i32).max(1e-9), exponent, 4095)
    })
    .filter(|line| (1.0..=255.0 + 1e-9).contains(&line.amplitude))
    .take(count)
}

/// Returns the largest difference over a line between the outputs that the contract gives for its operands and the
/// unquantised formula.
fn drift(core: &Core, line: &LineParameters, f: impl Fn(f64) -> f64) -> f64 {
    let highlight = core.contract.highlight().expect("a highlight");
    let feed = Feed::new(core.device().name, core.contract.as_ref()).expect("operands of a line");
    let operands = feed.line(line).expect("operands");
    let (amplitude, control) = operands.split_last().expect("an amplitude at the end");
    (0..=line.length)
        .map(|index| {
            let word = highlight.f(&highlight.point(control, u64::from(index)));
            let out = highlight.colour(word, *amplitude) as f64;
            (out - line.amplitude * f(line.zeta(index))).abs()
        })
        .fold(0.0, f64::max)
}

/// From unquantised set-up, within two units over the longest line.
///
/// By argument: the contract (0.93 and 0.82), half a unit for the amplitude's rounding, and the drift of the
/// angle, 4095 half ulps of Δζ and one of ζ: 2^(11−F) right angles. f falls by at most 30.6 a right angle
/// for n = 1000 (√(n/k)·k·cos^(k−1)·sin·π/2), 1.57 for cos² of a stretched angle, so that F = 26 gives 0.24 units and
/// F = 22 of the stretched angle 0.20.
#[test]
fn the_longest_lines_stay_within_two_units_of_the_unquantised_set_up() {
    let quad = core("quad-cosine");
    let squared = core("cosine-squared");
    let mut worst = [0.0f64; 2];
    for line in set_ups(400) {
        let n = i64::from(line.exponent);
        let error = drift(&quad, &line, |zeta| formulas::quad_cosine(zeta, n));
        worst[0] = worst[0].max(error);
        let a = (n as f64 / 2.0).sqrt();
        let error = drift(&squared, &line, |zeta| formulas::cosine_squared(a * zeta));
        worst[1] = worst[1].max(error);
    }
    println!("quad-cosine {}, cosine-squared {} units", worst[0], worst[1]);
    assert!(worst.iter().all(|&worst| worst <= 2.0), "{worst:?}");
    // A set-up that hardly shows anything would prove nothing.
    assert!(worst.iter().all(|&worst| worst > 0.7), "{worst:?}");
}

/// The worst that the operands' rounding can do: half an ulp of Δζ on every one of 4095 steps, at n = 1000 where
/// the formula is steepest, with an amplitude rounded by half a unit.
#[test]
fn the_worst_rounding_of_the_longest_line_stays_within_two_units() {
    let quad = core("quad-cosine");
    let ulp = FRAC_PI_2 / RIGHT as f64;
    let mut worst = 0.0f64;
    for (end, half) in (1..200).flat_map(|end| [(end, 0.499_999), (end, -0.499_999)]) {
        let end = FRAC_PI_2 * f64::from(end) / 1600.0;
        // Δζ of about half a degree a point, so that the line ends where the formula is steep.
        let delta = ((end / ulp + RIGHT as f64) / 4095.0).round() + half;
        let line = LineParameters {
            amplitude: 254.5,
            exponent: 1000,
            length: 4095,
            delta_zeta: delta * ulp,
            zeta_start: end - 4095.0 * delta * ulp,
        };
        let error = drift(&quad, &line, |zeta| formulas::quad_cosine(zeta, 1000));
        worst = worst.max(error);
    }
    println!("{worst} units");
    assert!(worst > 1.0 && worst <= 2.0, "{worst}");
}

/// A register behind every memory and multiplier changes no result, only when it comes.
#[test]
fn a_staged_line_shows_the_same_results_later() {
    for (name, stages, later) in [("quad-cosine", 7, 5), ("cosine-squared", 5, 3)] {
        let text = format!("device = \"{name}\"\n[line]\nstages = {stages}\n");
        let (staged, short) = (parsed("staged.toml", &text), core(name));
        let outputs = |it: &Computation| -> Vec<Vec<i64>> {
            it.results.iter().map(|result| result.outputs.clone()).collect()
        };
        for (staged, short) in computations(&staged).iter().zip(computations(&short)) {
            assert_eq!(staged.operands, short.operands);
            assert_eq!(outputs(staged), outputs(&short), "{name}: {:?}", short.operands);
            assert_eq!(staged.done, short.done + later, "{name}");
        }
        assert_agrees(&staged, 5000, 1, name);
    }
}
