//! Tests `benches/baseline/rough_hand.v`, a hand-written core with which benchmarks compare the device `rough`: it computes
//! what the definition of `rough` states, at 20 000 points in Icarus Verilog.
//!
//! A core that computed something else would be no fair comparison. The definition is written out in integers in this file.

use std::fmt::Write;
use std::path::Path;

use crate::common::files::read;
use crate::common::tools;
use glint::cosim::Random;
use glint::tools::VerilogSimulator;

const COSINE: u32 = 17;
const ONE: u64 = 1 << COSINE;
const INTENSITY: u32 = 16;
const POINTS: usize = 20_000;

struct Point {
    cos_gamma: u64,
    cos_dgamma: u64,
    exponent: u64,
    dgamma_negative: bool,
    colours: [u64; 3],
}

/// √(1 − x²) in the middle of the bucket of x, to the nearest 2⁻¹⁷, in integers throughout.
fn sine_of_bucket(bucket: u64) -> i64 {
    // x = (2·bucket + 1)·2⁻¹¹, so (2·2¹⁷·sine)² = 4·2³⁴·(2²² − (2·bucket + 1)²)·2⁻²².
    let square = ((4u128 << 34) * ((1 << 22) - u128::from(2 * bucket + 1).pow(2))) >> 22;
    (square.isqrt() as i64 + 1) / 2
}

fn sine(x: u64) -> i64 {
    sine_of_bucket(if x == ONE { 1023 } else { x >> 7 }).min(ONE as i64 - 1)
}

/// Returns the definition of `rough`, step by step in integers.
fn expected(point: &Point) -> [u64; 3] {
    let (c, d) = (point.cos_gamma.min(ONE), point.cos_dgamma.min(ONE));
    let cos_cos = (c * d) as i64 >> COSINE;
    let sin_sin = (sine(d) * sine(c)) >> COSINE;
    let cosine = if point.dgamma_negative { cos_cos + sin_sin } else { cos_cos - sin_sin };
    let gate = |value: i64| {
        let limit = 1 << INTENSITY;
        if c == 0 { -limit } else { value.clamp(-limit, limit - 1) }
    };
    // n/2 has one fraction bit, so the product has 18.
    let line = gate(((cosine - ONE as i64) * point.exponent as i64) >> (COSINE + 1 - INTENSITY));
    let base = line + (1 << INTENSITY);
    let f = (gate((base * base) >> INTENSITY) & ((1 << INTENSITY) - 1)) as u64;
    point.colours.map(|colour| (f * colour + (1 << (INTENSITY - 1))) >> INTENSITY)
}

fn points() -> Vec<Point> {
    let corners = [0, 1, 127, 128, ONE / 2, ONE - 129, ONE - 1, ONE, ONE + 1, 2 * ONE - 1];
    let mut random = Random::new(1);
    let mut points = Vec::new();
    for cos_gamma in corners {
        for cos_dgamma in corners {
            for exponent in [0, 1, 2, 3, 511, 512, 1000, 1023] {
                for dgamma_negative in [false, true] {
                    let colours = [255, 1, 128];
                    points.push(Point {
                        cos_gamma,
                        cos_dgamma,
                        exponent,
                        dgamma_negative,
                        colours,
                    });
                }
            }
        }
    }
    while points.len() < POINTS {
        // Highlights live near 1.0: half of the points have an angle of a few degrees there.
        let mut near_one = |bits: u32| ONE - random.below(1 << bits).min(ONE);
        let (cos_gamma, cos_dgamma) = match points.len() % 4 {
            0 => (near_one(18), near_one(18)),
            1 => (near_one(13), near_one(14)),
            2 => (near_one(9), near_one(9)),
            _ => (near_one(17), ONE),
        };
        let exponent_bits = 1 + random.below(10);
        let exponent = random.below(1 << exponent_bits);
        let dgamma_negative = random.once_in(2);
        let colours = [0; 3].map(|_| random.below(256));
        points.push(Point { cos_gamma, cos_dgamma, exponent, dgamma_negative, colours });
    }
    points
}

fn baseline(name: &str) -> (String, String) {
    (name.to_owned(), read(Path::new("benches/baseline").join(name)))
}

#[test]
fn the_hand_written_core_computes_what_rough_does() {
    let points = points();
    let mut lines = String::new();
    for point in &points {
        let mut word = u128::from(point.cos_gamma);
        let mut append = |value: u64, bits: u32| word = word << bits | u128::from(value);
        append(point.cos_dgamma, 18);
        append(point.exponent, 10);
        append(point.dgamma_negative.into(), 1);
        point.colours.iter().chain(&expected(point)).for_each(|colour| append(*colour, 8));
        writeln!(lines, "{word:024x}").expect("a string");
    }
    let (name, bench) = baseline("rough_hand_tb.v");
    let bench = bench.replace("POINTS = 1;", &format!("POINTS = {};", points.len()));
    let (_, core) = baseline("rough_hand.v");
    let held = core.replace("HELD_OPERANDS = 0", "HELD_OPERANDS = 1");
    assert_ne!(core, held);
    for core in [core, held] {
        let files = [
            ("rough_hand.v".to_owned(), core),
            baseline("rough_hand_sine.mem"),
            (name.clone(), bench.clone()),
            ("rough_hand_points.mem".to_owned(), lines.clone()),
        ];
        let outcome = tools::assert_bench_passes(VerilogSimulator::Icarus, &files, "rough_hand_tb");
        let verdict = format!("PASS: {POINTS} points");
        assert!(outcome.transcript.contains(&verdict), "{}", outcome.transcript);
    }
    // The comparison is worth something only if the points are neither all dark nor all bright.
    let lit = points.iter().filter(|point| (1..=254).contains(&expected(point)[0])).count();
    assert!(lit > POINTS / 10, "{lit} of {POINTS} points are neither dark nor full");
}

#[test]
fn its_sine_table_is_the_sine() {
    let (_, text) = baseline("rough_hand_sine.mem");
    let lines = text.lines().filter(|line| !line.starts_with("//"));
    let words: Vec<i64> = lines.map(|line| i64::from_str_radix(line, 16).unwrap()).collect();
    let wanted: Vec<i64> = (0..1024).map(|at| sine_of_bucket(at).min(ONE as i64 - 1)).collect();
    assert_eq!(words, wanted);
}

#[test]
fn it_is_clean() {
    let files = ["rough_hand.v", "rough_hand_sine.mem"].map(baseline);
    tools::assert_files_are_clean(&files.to_vec(), "rough_hand");
}
