//! Tests the error bounds of accuracy contracts: no error at random points exceeds the bound, in random configurations of the
//! devices of `Registry::catalogue`, which are the ten highlights and `function`.
//!
//! `tests/kinds.toml` says how many configurations a run takes. Proofs over all control operands are recorded in `records/proofs/`, and
//! `tests/quick/proofs.rs` checks these records.

use std::path::Path;

use glint::config;
use glint::fixed::exp2;
use glint::golden::{Contract, blinn, nearer};
use glint::keys::presets::FUNCTION;
use glint::registry::Registry;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

use crate::common::Sure;
use crate::common::cores::{parsed, sample};
use crate::common::sample::sampled_for;

/// The number of random configurations of each device.
const CONFIGURATIONS: u64 = 300;

/// The number of random configurations of the device `function`, each of which takes a search.
const FUNCTIONS: u64 = 8;

/// Points of each, and places.
const POINTS: usize = 2000;

/// The rounding of f64 itself, in units.
const F64: f64 = 1e-6;

/// Returns the contract of a device with these settings, lines of TOML, and defaults elsewhere.
fn of(device: &str, settings: &str) -> Box<dyn Contract> {
    parsed("settings.toml", &format!("device = \"{device}\"\n{settings}\n")).contract
}

/// Returns a point of the domain, more often than not within the highlight: cosines anywhere, small, or such
/// that γ is near dγ, as near as n makes the highlight narrow.
fn random_point(contract: &dyn Contract, rng: &mut ChaCha8Rng) -> Vec<i64> {
    let mut unit = || rng.next_u32() as f64 / exp2(32);
    let operands = contract.operands();
    let mut point: Vec<i64> = operands
        .iter()
        .filter(|operand| !operand.colour)
        .map(|operand| {
            let (low, high) = operand.domain;
            let part = if unit() < 0.5 { unit() } else { unit() * unit() * unit() };
            // Cosines crowd at their upper end, exponents at their lower, what has a sign at 0.
            let offset = (part * (high - low + 1) as f64) as i64;
            if low < 0 && high > 0 {
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
    contract: &dyn Contract,
    points: usize,
    rng: &mut ChaCha8Rng,
    what: &str,
) {
    let (bound, highlight) = (contract.bounds(), contract.highlight().expect("a highlight"));
    let largest = contract.operands().last().unwrap().domain.1;
    for _ in 0..points {
        let point = random_point(contract, rng);
        let (f, exact) = (highlight.f(&point), highlight.references(&point));
        for colour in [largest, rng.next_u32() as i64 & largest] {
            let out = highlight.colour(f, colour) as f64;
            let error = nearer(out, exact.map(|exact| colour as f64 * exact));
            assert!(
                error <= bound.governing_units() + F64,
                "{error} at {point:?} × {colour} of {what}: {bound:#?}"
            );
        }
    }
}

/// No random configuration's measured error exceeds its bound, good or bad as it may be: of the outputs at
/// random points, and of f at random places of its sweep, which for a point of a line say all that matters.
#[test]
fn random_configurations_of_every_device() {
    for device in Registry::catalogue().devices() {
        let schema = (device.schema)();
        let is_function = schema.device == FUNCTION;
        let (kind, all) = match is_function {
            true => ("random functions within their bounds", FUNCTIONS),
            false => ("random configurations within their bounds", CONFIGURATIONS),
        };
        sampled_for(device.name, kind, 0..all).into_par_iter().for_each(|seed| {
            let opened = sample(*device, seed);
            let (contract, config) = (opened.contract(), opened.config);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let what = config.to_toml(&schema);
            // Of a function the places are all there is.
            if !is_function {
                assert_outputs_within_bound(contract.as_ref(), POINTS, &mut rng, &what);
            }
            assert_places_within_bound(contract.as_ref(), POINTS, &mut rng, &what);
        });
    }
}

/// Asserts that f is no further from the formula than the bound says, at random places of the sweep.
fn assert_places_within_bound(
    contract: &dyn Contract,
    places: usize,
    rng: &mut ChaCha8Rng,
    what: &str,
) {
    let (axes, bound) = (contract.sweep().axes, contract.bounds());
    for _ in 0..places {
        let place: Vec<i64> = axes
            .iter()
            .map(|axis| axis.values.value(rng.next_u64() % axis.values.count()))
            .collect();
        let error = contract.sweep_error(&place);
        assert!(error <= bound.f + F64, "{error} at {place:?} of {what}: {bound:#?}");
    }
}

/// The two configurations of `blinn` keep f within 1.0e-4 and 7e-4, by their bound or, for the small one, by this measure
/// and the record of its proof.
#[test]
fn blinn_is_as_close_as_it_promises() {
    let read = |path: &str| config::read(Path::new(path), &Registry::catalogue().schemas()).sure();
    let best = blinn::contract(&read("configs/blinn.toml"));
    assert!(best.bounds().f <= 1.0e-4, "{:?}", best.bounds());
    assert!(best.highlight().expect("a highlight").f_format().frac >= 14);
    let small = blinn::contract(&read("configs/blinn_small.toml"));
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..2_000_000 {
        let point = random_point(small.as_ref(), &mut rng);
        let error = small.sweep_error(&point);
        assert!(error <= 7e-4, "{error} at {point:?}");
    }
}

/// Bounds as their proofs add them up by hand: of the defaults, and of a setting beside them.
#[test]
fn bounds_by_hand() {
    let units = |device, settings| of(device, settings).bounds().governing().units;
    let (ulp, largest) = (1.0 / 65536.0, 255.0);
    for (device, settings, expected) in [
        ("schlick", "", largest / 1024.0 + 0.5),
        ("schlick", "intensity.fraction = 9", largest / 512.0 + 0.5),
        // 16 ulps for the base, 15 for the squarings.
        ("cosine-power", "", 31.0 * ulp * largest + 0.5),
        // Two for the base, one for the square.
        ("threshold", "", 3.0 * ulp * largest + 0.5),
        // 2⁹ ulps of 2⁻²⁰ upward; downward 16 + 15 of 2⁻¹⁶ are less.
        ("lyon", "", 512.0 / 1048576.0 * largest + 0.5),
        ("lyon", "intensity.fraction = 15", 31.0 * 2.0 * ulp * largest + 0.5),
        (
            "lyon",
            "distance.rounding = \"nearest\"",
            (256.0 / 1048576.0 + 31.0 * ulp) * largest + 0.5,
        ),
        // 999 ulps of 2⁻¹⁹ and one of 2⁻¹⁶.
        ("quadratic", "coefficient.scheme = \"taylor\"", (999.0 / 524288.0 + ulp) * largest + 0.5),
    ] {
        let bound = units(device, settings);
        assert!((bound - expected).abs() < 1e-12, "{device}, {settings}: {bound} {expected}");
    }
    // 8 bits of the quotient are not enough.
    assert!(units("schlick", "intensity.fraction = 8") > 1.0);
    for device in Registry::catalogue().devices() {
        assert!(units(device.name, "") < 1.0, "{}", device.name);
    }
}
