//! The accuracy contract: no measured error exceeds its bound, and the defaults' bounds are below one
//! unit.
//!
//! The proof is factored as the hardware is: the word f over the control operands, and the colour
//! multiplier over every word and colour. Covered for f are: `cosine-power`, every cosine and every n
//! of its domain; `rough`, every cosine and every n for five settings of dγ, and random points
//! for the rest; `threshold`, every cosine for every 25th n, and every 64th cosine for every n;
//! `quadratic` likewise, with both tables; `lyon`, every 64th word of D² for every n, with the worst
//! over what rounds to a word, and every 16th word for every shift. What is left out here is in the tests that are
//! ignored, which take minutes. Random configurations of all devices follow.

use std::sync::Mutex;
use std::thread;

use glint::config::{self, Schema};
use glint::devices;
use glint::fixed::{Rounding, exp2};
use glint::golden::cosine_power::{self, CosinePowerContract};
use glint::golden::lyon::{self, LyonContract, Scale};
use glint::golden::quadratic::{self, QuadraticContract};
use glint::golden::rough::{self, RoughContract};
use glint::golden::sine::Scheme;
use glint::golden::threshold::{self, ThresholdContract};
use glint::golden::{Bound, Contract, nearer};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

/// What f64 itself may add to an error in units.
const F64: f64 = 1e-6;

/// The largest error seen, and where.
#[derive(Clone, Debug, Default)]
struct Worst {
    error: f64,
    control: Vec<i64>,
}

impl Worst {
    fn take(&mut self, error: f64, control: &[i64]) {
        if error > self.error {
            *self = Worst {
                error,
                control: control.to_vec(),
            };
        }
    }

    fn merge(&mut self, other: Worst) {
        self.take(other.error, &other.control);
    }
}

/// The largest error of f over `range`, each value of which `control` makes into a point; on two threads.
fn sweep<C: Contract, const N: usize>(
    contract: &C,
    outer: std::ops::RangeInclusive<i64>,
    inner: &[i64],
    control: impl Fn(i64, i64) -> [i64; N] + Sync,
) -> Worst {
    const THREADS: i64 = 2;
    let ulp = exp2(-contract.f_format().frac);
    let worst = Mutex::new(Worst::default());
    thread::scope(|scope| {
        for thread in 0..THREADS {
            let (outer, control, worst) = (outer.clone(), &control, &worst);
            scope.spawn(move || {
                let mut own = Worst::default();
                for x in outer.skip(thread as usize).step_by(THREADS as usize) {
                    for &n in inner {
                        let point = control(x, n);
                        let error = contract.f(&point) as f64 * ulp - contract.reference(&point);
                        own.take(error.abs(), &point);
                    }
                }
                worst.lock().unwrap().merge(own);
            });
        }
    });
    worst.into_inner().unwrap()
}

/// The largest error of f over the sweep of a contract with two axes, of which every so manyth value is
/// taken, and the last.
fn sweep_part(contract: &impl Contract, strides: [u64; 2]) -> Worst {
    let sweep = contract.sweep();
    assert!(sweep.omits.is_empty() && sweep.axes.len() == 2);
    let taken = |axis: usize| -> Vec<i64> {
        let values = &sweep.axes[axis].values;
        let last = values.count() - 1;
        let steps = (0..last).step_by(strides[axis] as usize);
        steps.chain([last]).map(|at| values.value(at)).collect()
    };
    let inner = taken(1);
    taken(0)
        .into_par_iter()
        .map(|outer| {
            let mut own = Worst::default();
            for &value in &inner {
                let place = [outer, value];
                own.take(contract.sweep_error(&place), &place);
            }
            own
        })
        .reduce(Worst::default, |mut worst, other| {
            worst.merge(other);
            worst
        })
}

/// The largest error that the colour multiplier adds, in units, over every word and colour.
fn colour_error(contract: &impl Contract) -> f64 {
    let (f_format, colour) = (contract.f_format(), contract.operands().last().unwrap());
    let mut worst = 0.0f64;
    for f in 0..=f_format.max_raw() as i64 {
        for k in colour.domain.0..=colour.domain.1 {
            let exact = (f * k) as f64 * exp2(-f_format.frac);
            worst = worst.max((contract.colour(f, k) as f64 - exact).abs());
        }
    }
    worst
}

/// Asserts that what was measured of f and of the colours together is within the bound, below a unit.
fn assert_contract(contract: &impl Contract, bound: &Bound, f: &Worst) {
    let largest = contract.operands().last().unwrap().domain.1 as f64;
    let colour = colour_error(contract);
    let together = f.error * largest + colour;
    println!(
        "f off by {} units at {:?}; colours by {colour}; bound {bound:#?}",
        f.error * largest,
        f.control
    );
    assert!(
        f.error <= bound.f + F64 / largest,
        "{f:?} exceeds {bound:?}"
    );
    assert!(
        together <= bound.units + F64,
        "{f:?} and {colour} exceed {bound:?}"
    );
    assert!(bound.units < 1.0, "{bound:?}");
    // A bound far above what occurs would refuse configurations that are good.
    assert!(bound.f <= 2.0 * f.error, "{bound:?} is idle: {f:?}");
}

#[test]
fn cosine_power_over_all_operands() {
    let contract = CosinePowerContract::from_params(&cosine_power::Params::default()).unwrap();
    let exponents: Vec<i64> = (1..=1000).collect();
    let worst = sweep(&contract, 0..=1 << 20, &exponents, |cosine, n| [cosine, n]);
    assert_contract(&contract, &contract.bound(), &worst);
}

fn threshold_over(strides: &[[u64; 2]]) {
    for levels in [vec![50], vec![50, 100, 200, 400, 800]] {
        let params = threshold::Params {
            levels,
            ..threshold::Params::default()
        };
        let contract = ThresholdContract::from_params(&params).unwrap();
        assert_sweeps(&contract, strides);
    }
}

fn quadratic_over(strides: &[[u64; 2]]) {
    let default = quadratic::Params::default();
    for scheme in [quadratic::Scheme::Taylor, default.scheme] {
        let params = quadratic::Params {
            scheme,
            ..default.clone()
        };
        let contract = QuadraticContract::from_params(&params).unwrap();
        assert_sweeps(&contract, strides);
    }
}

fn lyon_over(scale: Scale, strides: [u64; 2]) {
    let params = lyon::Params {
        scale,
        ..lyon::Params::default()
    };
    assert_sweeps(&LyonContract::from_params(&params).unwrap(), &[strides]);
}

fn assert_sweeps(contract: &impl Contract, strides: &[[u64; 2]]) {
    let mut worst = Worst::default();
    for &strides in strides {
        worst.merge(sweep_part(contract, strides));
    }
    assert_contract(contract, &contract.bound(), &worst);
}

#[test]
fn threshold_over_a_part() {
    threshold_over(&[[1, 25], [64, 1]]);
}

#[test]
fn quadratic_over_a_part() {
    quadratic_over(&[[1, 25], [64, 1]]);
}

#[test]
fn lyon_over_a_part() {
    lyon_over(Scale::Multiplier, [1, 64]);
    lyon_over(Scale::Shift, [1, 16]);
}

#[test]
#[ignore = "takes a minute"]
fn threshold_over_all_operands() {
    threshold_over(&[[1, 1]]);
}

#[test]
#[ignore = "takes a minute"]
fn quadratic_over_all_operands() {
    quadratic_over(&[[1, 1]]);
}

#[test]
#[ignore = "takes minutes"]
fn lyon_over_all_words() {
    lyon_over(Scale::Multiplier, [1, 1]);
    lyon_over(Scale::Shift, [1, 1]);
}

/// dγ in degrees, and whether it is taken from γ (1) or added, which dims the highlight and its error.
const DEVIATIONS: [(f64, i64); 5] = [(0.0, 1), (1.0, 1), (5.0, 1), (5.0, 0), (30.0, 1)];

#[test]
fn rough_over_cosines_and_exponents() {
    let contract = RoughContract::from_params(&rough::Params::default()).unwrap();
    let exponents: Vec<i64> = (1..=1000).collect();
    let mut worst = Worst::default();
    for (degrees, negative) in DEVIATIONS {
        let deviation = (libm::cos(degrees.to_radians()) * exp2(20)).ceil() as i64;
        let point = |cosine, n| [cosine, deviation, n, negative];
        worst.merge(sweep(&contract, 0..=1 << 20, &exponents, point));
    }
    assert_contract(&contract, &contract.bound(), &worst);
}

/// A point of the domain, more often than not within the highlight: cosines anywhere, small, or such
/// that γ is near dγ, as near as n makes the highlight narrow.
fn random_point(contract: &impl Contract, rng: &mut ChaCha8Rng) -> Vec<i64> {
    let mut unit = || rng.next_u32() as f64 / exp2(32);
    let operands = contract.operands();
    let mut point: Vec<i64> = operands
        .iter()
        .filter(|operand| !operand.colour)
        .map(|operand| {
            let (low, high) = operand.domain;
            let part = if unit() < 0.5 {
                unit()
            } else {
                unit() * unit() * unit()
            };
            // Cosines crowd at their upper end, exponents at their lower, components of vectors at 0.
            let offset = (part * (high - low + 1) as f64) as i64;
            if operand.name.starts_with('d') && low < 0 {
                (offset / 2 - (offset % 2) * offset).clamp(low, high)
            } else if operand.name.starts_with("cos") {
                high - offset
            } else {
                low + offset
            }
        })
        .collect();
    let place = |name: &str| operands.iter().position(|operand| operand.name == name);
    if let (Some(gamma), Some(exponent)) = (place("cos_gamma"), place("exponent"))
        && unit() < 0.75
    {
        let format = operands[gamma].format;
        let centre =
            place("cos_dgamma").map_or(0.0, |at| format.to_f64(point[at].into()).min(1.0).acos());
        let half_width = (1.0 - 2.0 / point[exponent].max(1) as f64).max(-1.0).acos();
        let angle = centre + 1.2 * (2.0 * unit() - 1.0) * half_width;
        let (low, high) = operands[gamma].domain;
        point[gamma] = (format.quantise(angle.cos()) as i64).clamp(low, high);
    }
    point
}

/// Asserts that no output is further from the formula than the bound says, at random points.
fn assert_outputs_within_bound(
    contract: &impl Contract,
    points: usize,
    rng: &mut ChaCha8Rng,
    what: &str,
) {
    let bound = contract.bound();
    let largest = contract.operands().last().unwrap().domain.1;
    for _ in 0..points {
        let point = random_point(contract, rng);
        let (f, exact) = (contract.f(&point), contract.references(&point));
        for colour in [largest, rng.next_u32() as i64 & largest] {
            let out = contract.colour(f, colour) as f64;
            let error = nearer(out, exact.map(|exact| colour as f64 * exact));
            assert!(
                error <= bound.units + F64,
                "{error} at {point:?} × {colour} of {what}: {bound:#?}"
            );
        }
    }
}

#[test]
fn rough_at_random_points() {
    let contract = RoughContract::from_params(&rough::Params::default()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    assert_outputs_within_bound(&contract, 5_000_000, &mut rng, "the default");
}

/// No random configuration's measured error exceeds its bound, good or bad as it may be.
fn assert_random_configurations<C: Contract>(
    schema: &Schema,
    contract: impl Fn(&config::Config) -> C,
) {
    for seed in 0..300 {
        let config = config::sample(schema, seed);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        assert_outputs_within_bound(&contract(&config), 3000, &mut rng, &config.to_toml(schema));
    }
}

#[test]
fn random_configurations_of_rough() {
    assert_random_configurations(&devices::rough::schema(), RoughContract::new);
}

#[test]
fn random_configurations_of_cosine_power() {
    assert_random_configurations(&devices::cosine_power::schema(), CosinePowerContract::new);
}

#[test]
fn random_configurations_of_threshold() {
    assert_random_configurations(&devices::threshold::schema(), ThresholdContract::new);
}

#[test]
fn random_configurations_of_quadratic() {
    assert_random_configurations(&devices::quadratic::schema(), QuadraticContract::new);
}

#[test]
fn random_configurations_of_lyon() {
    assert_random_configurations(&devices::lyon::schema(), LyonContract::new);
}

/// Configurations of which each widens one thing that the defaults leave alone.
#[test]
fn bounds_of_unusual_configurations() {
    let segmented = rough::Params::default();
    let params = [
        rough::Params {
            clamp: false,
            ..segmented.clone()
        },
        rough::Params {
            deviation: 90.0,
            ..segmented.clone()
        },
        rough::Params {
            product_rounding: Rounding::Nearest,
            intensity_rounding: Rounding::Nearest,
            ..segmented.clone()
        },
        rough::Params {
            output_rounding: Rounding::Truncate,
            ..segmented.clone()
        },
        rough::Params {
            cosine_signed: true,
            ..segmented.clone()
        },
        rough::Params {
            sine_scheme: Scheme::Direct { address: 10 },
            exponents: (1, 4),
            ..segmented.clone()
        },
        rough::Params {
            arithmetic: rough::Kind::Patent,
            ..segmented
        },
    ];
    for params in params {
        let contract = RoughContract::from_params(&params).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        assert_outputs_within_bound(&contract, 300_000, &mut rng, &format!("{params:?}"));
    }
}
