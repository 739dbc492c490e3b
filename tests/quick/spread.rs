//! Tests the random points of highlight devices: at 60 % of the points or more, the reflectance f is neither 0 nor just below
//! 1.

use crate::common::cores::{configurations, run};
use glint::cosim::{PointSource, Random};
use rayon::prelude::*;

/// Results of each configuration; those of lines, of which some are thousands of points long, vary most.
const POINTS: u64 = 30_000;

/// Draws of a list of computations.
const DRAWN: u64 = 4000;

/// The least share of co-simulated results that are neither 0 nor just below 1.
const SHARE: f64 = 0.6;

#[test]
fn most_points_have_f_between_0_and_1() {
    let highlights = configurations().into_par_iter();
    let highlights = highlights.filter(|(_, unit)| unit.contract.highlight().is_some());
    let looked_at = highlights.map(|(path, unit)| {
        let outcome = run(&unit, POINTS, 3, &path);
        let histogram = outcome.histogram;
        assert_eq!(histogram.counts().iter().sum::<u64>(), outcome.points, "{path}");
        assert!(histogram.share_inside() >= SHARE, "{path}: {histogram:?}");
    });
    assert!(looked_at.count() > 8, "a highlight is missing");
}

/// By the formula, and not by the device's word; so too for what is drawn for the manifest.
#[test]
fn most_operands_that_are_drawn_have_a_formula_between_0_and_1() {
    let mut looked_at = 0;
    for (path, unit) in configurations() {
        let contract = unit.contract.as_ref();
        let points = PointSource::new(contract);
        let mut random = Random::new(5);
        let Some(highlight) = contract.highlight() else { continue };
        let inside = (0..DRAWN).filter(|_| {
            let drawn = points.of_domain(&mut random);
            let f = highlight.reference(&highlight.point(&drawn[..highlight.control()], 0));
            f > 0.0 && f < 1.0
        });
        let share = inside.count() as f64 / DRAWN as f64;
        assert!(share >= SHARE, "{path}: {share}");
        looked_at += 1;
    }
    assert!(looked_at > 8, "{looked_at} highlights");
}
