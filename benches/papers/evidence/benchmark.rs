//! Measures the claim "2.3 times faster in software": times the function W and Schlick's function in pairs.
//!
//! Timings differ from run to run and from machine to machine. The timings are therefore only in `benchmark.json` and in a
//! section of the page that exists only with `--benchmark`.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;

use glint::evidence::chart::even;

/// Cosines in the array that a kernel goes over; it stays in the first-level cache.
const COSINES: u32 = 1023;

/// Pairs of timings of which the median counts.
const ROUNDS: usize = 41;

/// Passes over the array in one timing.
const PASSES: usize = 64;

/// The exponent.
const EXPONENT: f64 = 35.0;

/// How much faster W is, by the paper.
const CLAIMED: f64 = 2.3;

/// The timings of this run.
#[derive(Clone, Debug, Serialize)]
pub struct Benchmark {
    /// The version of Glint.
    pub glint: &'static str,
    /// The processor's architecture.
    pub architecture: &'static str,
    /// The paper's figure.
    pub claimed: f64,
    /// Each kernel.
    pub pairs: Vec<Pair>,
    /// The outcome in a sentence.
    pub words: String,
}

/// W and Schlick's function in the same precision and the same use.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// The power of W.
    pub m: u32,
    /// `f32` or `f64`.
    pub precision: &'static str,
    /// Whether each argument waits for the result before it.
    pub dependent: bool,
    /// Nanoseconds for a value of W, the median.
    pub w_ns: f64,
    /// Nanoseconds for a value of Schlick's function, the median.
    pub schlick_ns: f64,
    /// Schlick's time over W's: quartile, median, quartile, over pairs taken one after the other.
    pub ratio: [f64; 3],
}

macro_rules! kernels {
    ($module:ident, $float:ty) => {
        mod $module {
            /// W: one product by n, a scale by a power of two, and SQUARINGS squarings.
            #[inline(always)]
            pub fn w<const SQUARINGS: usize>(c: $float, n: $float) -> $float {
                let scale = 1.0 / (1u32 << SQUARINGS) as $float;
                let base = (n * scale) * (c - 1.0) + 1.0;
                let mut power = if base > 0.0 { base } else { 0.0 };
                for _ in 0..SQUARINGS {
                    power *= power;
                }
                power
            }

            /// Schlick's function: a product, a difference, a sum, a division.
            #[inline(always)]
            pub fn schlick(c: $float, n: $float) -> $float {
                c / (n - n * c + c)
            }

            /// Many values at once; the compiler may use vectors.
            #[inline(never)]
            pub fn independent(
                f: impl Fn($float, $float) -> $float,
                cosines: &[$float],
                results: &mut [$float],
                n: $float,
            ) {
                for (result, c) in results.iter_mut().zip(cosines) {
                    *result = f(*c, n);
                }
            }

            /// Returns each argument has bits of the result before it; the mask is 0, which the compiler does not know.
            #[inline(never)]
            pub fn dependent(
                f: impl Fn($float, $float) -> $float,
                cosines: &[$float],
                results: &mut [$float],
                n: $float,
            ) {
                let mask = super::black_box(0);
                let mut last: $float = 0.0;
                for (result, c) in results.iter_mut().zip(cosines) {
                    let c = <$float>::from_bits(c.to_bits() | (last.to_bits() & mask));
                    last = f(c, n);
                    *result = last;
                }
            }
        }
    };
}

kernels!(single, f32);
kernels!(double, f64);

/// Nanoseconds for one value: `run` makes one pass over the array.
fn time(run: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..PASSES {
        run();
    }
    start.elapsed().as_nanos() as f64 / (PASSES as f64 * f64::from(COSINES + 1))
}

/// Returns the quartiles of values, which are not empty.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[(values.len() - 1) * quarter / 4])
}

/// Times two runs in turn, now the one first and now the other.
fn pair(
    m: u32,
    precision: &'static str,
    dependent: bool,
    w: &mut dyn FnMut(),
    schlick: &mut dyn FnMut(),
) -> Pair {
    let (mut of_w, mut of_schlick) = (Vec::new(), Vec::new());
    time(w);
    time(schlick);
    for round in 0..ROUNDS {
        if round % 2 == 0 {
            of_w.push(time(w));
            of_schlick.push(time(schlick));
        } else {
            of_schlick.push(time(schlick));
            of_w.push(time(w));
        }
    }
    let ratios = of_schlick.iter().zip(&of_w).map(|(s, w)| s / w).collect();
    Pair {
        m,
        precision,
        dependent,
        w_ns: quartiles(of_w)[1],
        schlick_ns: quartiles(of_schlick)[1],
        ratio: quartiles(ratios),
    }
}

macro_rules! pairs {
    ($found:ident, $module:ident, $float:ty, $precision:literal, $($squarings:literal)+) => {{
        let cosines: Vec<$float> = even(0.5, 1.0, COSINES).into_iter().map(|c| c as $float).collect();
        let mut of_w = cosines.clone();
        let mut of_schlick = cosines.clone();
        let n = black_box(EXPONENT as $float);
        $(
            let w = $module::w::<$squarings>;
            for dependent in [false, true] {
                let kernel = |f: &dyn Fn(&mut [$float]), results: &mut [$float]| {
                    f(results);
                    black_box(results);
                };
                $found.push(match dependent {
                    false => pair(
                        1 << $squarings, $precision, dependent,
                        &mut || kernel(&|results| $module::independent(w, black_box(&cosines), results, n), &mut of_w),
                        &mut || kernel(&|results| $module::independent($module::schlick, black_box(&cosines), results, n), &mut of_schlick),
                    ),
                    true => pair(
                        1 << $squarings, $precision, dependent,
                        &mut || kernel(&|results| $module::dependent(w, black_box(&cosines), results, n), &mut of_w),
                        &mut || kernel(&|results| $module::dependent($module::schlick, black_box(&cosines), results, n), &mut of_schlick),
                    ),
                });
            }
        )+
    }};
}

/// Takes the timings: about a second, in which nothing else should run.
pub fn run() -> Benchmark {
    let mut found: Vec<Pair> = Vec::new();
    pairs!(found, double, f64, "f64", 1 2 3 4);
    pairs!(found, single, f32, "f32", 1 2 3 4);
    let words = words(&found);
    Benchmark {
        glint: env!("CARGO_PKG_VERSION"),
        architecture: std::env::consts::ARCH,
        claimed: CLAIMED,
        pairs: found,
        words,
    }
}

fn words(pairs: &[Pair]) -> String {
    let of = |m: u32| {
        let ratios: Vec<f64> =
            pairs.iter().filter(|pair| pair.m == m).map(|pair| pair.ratio[1]).collect();
        let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        (low, ratios.iter().copied().fold(0.0, f64::max))
    };
    let (low, high) = of(16);
    let verdict = match (low >= CLAIMED, high >= CLAIMED) {
        (true, _) => "The claim holds in every use that was timed",
        (false, true) => "The claim holds in some uses, not in all",
        (false, false) => "The claim does not hold on this machine",
    };
    let (low_2, high_2) = of(2);
    format!(
        "{verdict}: W with m = 16 is {low:.2} to {high:.2} times as fast as Schlick's function, where the paper says \
         {CLAIMED}; with m = 2 it is {low_2:.2} to {high_2:.2} times."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint::golden::formulas;

    #[test]
    fn kernels_compute_the_formulas() {
        for c in [0.5, 0.9, 0.99, 1.0] {
            let w = double::w::<4>(c, 35.0);
            assert!((w - formulas::cosine_power(c, 35.0, 16)).abs() < 1e-14);
            let schlick = double::schlick(c, 35.0);
            assert!((schlick - 1.0 / (35.0 / c - 34.0)).abs() < 1e-14);
            assert!((f64::from(single::w::<4>(c as f32, 35.0)) - w).abs() < 1e-5);
        }
        let (cosines, mut results) = ([0.9, 0.95], [0.0; 2]);
        double::dependent(double::schlick, &cosines, &mut results, 2.0);
        assert_eq!(results, cosines.map(|c| double::schlick(c, 2.0)));
    }

    #[test]
    fn words_follow_the_ratios() {
        let pair = |m, ratio| Pair {
            m,
            precision: "f64",
            dependent: false,
            w_ns: 1.0,
            schlick_ns: ratio,
            ratio: [ratio; 3],
        };
        assert!(words(&[pair(16, 2.5)]).starts_with("The claim holds in every use"));
        assert!(words(&[pair(16, 2.5), pair(16, 1.1)]).contains("1.10 to 2.50 times as fast"));
        assert!(words(&[pair(16, 1.1)]).contains("does not hold"));
        assert_eq!(quartiles(vec![5.0, 1.0, 3.0, 2.0, 4.0]), [2.0, 3.0, 4.0]);
    }
}
