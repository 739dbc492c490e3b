//! Tests that approximations are proved, that a wrong coefficient is refused, and that a refusal has the right kind.

use super::{
    Curve, Identity, Layout, Outside, RefusalKind, Samples, TargetFunction, Wish, find,
    reachable_error,
};
use glint_base::fixed::{Format, exp2};
use glint_formula::{Enclosure, parse};

/// The domain is from `from` to below `to`. Operand and result both have `fraction` fraction bits.
fn function(text: &str, (from, to): (f64, f64), fraction: i32, error: f64) -> TargetFunction {
    let raw = |value: f64| (value * exp2(fraction)) as i64;
    let domain = (raw(from), raw(to) - 1);
    TargetFunction {
        curve: Curve::Formula(parse(text).unwrap()),
        domain,
        operand: Format::holding(domain.0.into(), domain.1.into(), fraction),
        outside: Outside::Clamp,
        fraction: fraction as u32,
        error,
    }
}

/// Returns whether a result of the polynomials is wrong, or a sum does not fit its format.
fn is_wrong_result(kind: RefusalKind) -> bool {
    use RefusalKind::{ErrorExceeded, ResultBits, Unproved};
    matches!(kind, ErrorExceeded | ResultBits | Unproved)
}

#[test]
fn a_planted_wrong_coefficient_is_refused_at_every_degree() {
    for degree in 0..=3 {
        let it = function("exp(-x)", (0.0, 1.0), 10, 1.0);
        let wish = Wish { degree: Some(degree), ..Wish::default() };
        let found = find(&it, wish).unwrap();
        assert_eq!(found.degree(), degree as usize);
        assert!(found.bound < 1.0 && found.bound == found.prove(&it).unwrap());
        for k in 0..=degree as usize {
            // Adds enough to move the results at the end of a segment by two units.
            let unit = 1i64 << (found.coefficients[k].frac - 10).max(0);
            let mut wrong = (*found).clone();
            wrong.words[1][k] += (2 * unit) << k;
            let refusal = wrong.prove(&it).unwrap_err();
            assert!(is_wrong_result(refusal.kind), "{refusal:?}");
        }
    }
}

/// A formula, the ends of its domain, and the formula in `f64`.
type Case = (&'static str, (f64, f64), fn(f64) -> f64);

#[test]
fn results_are_right_against_libm() {
    let cases: [Case; 5] = [
        ("1 / sqrt(x)", (1.0, 4.0), |x| 1.0 / x.sqrt()),
        ("sigmoid(x)", (-8.0, 8.0), |x| 1.0 / (1.0 + libm::exp(-x))),
        ("log2(1 + x)", (0.0, 1.0), |x| libm::log2(1.0 + x)),
        ("sqrt(x)", (0.0, 2.0), f64::sqrt),
        ("sqrt(1 - x)", (0.0, 1.0), |x| (1.0 - x).sqrt()),
    ];
    for (text, domain, exact) in cases {
        for error in [1.0, 0.55] {
            let it = function(text, domain, 12, error);
            let found = find(&it, Wish::default()).unwrap();
            let mut largest: f64 = 0.0;
            for raw in it.domain.0..=it.domain.1 {
                let value = exact(raw as f64 / 4096.0) * 4096.0;
                largest = largest.max((found.result(raw) as f64 - value).abs());
            }
            assert!(largest <= found.bound && found.bound < error, "{text}: {largest}");
            assert!(largest > found.bound - 1e-6, "{text}: the bound is that of an operand");
        }
    }
}

#[test]
fn steep_ends_are_cut_into_octaves() {
    for (text, layout) in [("sqrt(x)", Layout::Octaves), ("sqrt(1 - x)", Layout::Halving)] {
        let it = function(text, (0.0, 1.0), 12, 1.0);
        let uniform = Wish { degree: Some(2), layout: Some(Layout::Uniform), ..Wish::default() };
        let found = find(&it, Wish { degree: Some(2), ..Wish::default() }).unwrap();
        assert_eq!(found.segments.layout, layout, "{text}");
        let bits = find(&it, uniform).map_or(u64::MAX, |found| found.rom_bits());
        assert!(found.rom_bits() * 2 < bits, "{text}: {} of {bits}", found.rom_bits());
    }
}

#[test]
fn what_cannot_be_had_is_refused_with_what_can() {
    let refused = |it: &TargetFunction, wish| find(it, wish).unwrap_err();
    let pole = refused(&function("2 + 1 / x", (-1.0, 1.0), 8, 1.0), Wish::default());
    assert_eq!((pole.kind, pole.place), (RefusalKind::NoValue, Some(4..9)));
    let near = refused(
        &function("exp(-x)", (0.0, 1.0), 10, 0.5),
        Wish { degree: Some(1), ..Wish::default() },
    );
    assert_eq!(near.kind, RefusalKind::Error);
    let wish = Wish { degree: Some(1), ..Wish::default() };
    assert_eq!(reachable_error(&function("exp(-x)", (0.0, 1.0), 10, 0.5), wish), Some(0.51));
    assert!(near.message.starts_with("degree 1 does not keep an error of 0.5 units"), "{near:?}");
    let wide = TargetFunction { domain: (0, 1 << 48), ..function("x", (0.0, 4.0), 26, 1.0) };
    let wide = refused(&wide, Wish::default());
    assert_eq!(wide.kind, RefusalKind::OperandBits { most: 23 });
}

/// The bound over intervals is equal to or a little larger than the bound over every operand.
#[test]
fn a_bound_over_intervals_holds_at_every_operand() {
    for (text, degree) in [
        ("exp(-x)", 0),
        ("exp(-x)", 1),
        ("sin(2 * x) / (1 + x ^ 2)", 2),
        ("log2(1 + x) * tanh(x) + atan(x) - erf(x) / 3", 3),
        ("max(abs(x - 0.3), x ^ 1.5 / 2) + (x + 0.5) % 2", 1),
        ("cos(x) - sqrt(x + 0.01) + ln(x + 2) / tan(x + 0.1)", 2),
        ("if(x < 0.5, x, 1 - x) + 2 ^ -x", 1),
    ] {
        let it = TargetFunction { fraction: 8, ..function(text, (0.0, 1.0), 13, 1.0) };
        let found = find(&it, Wish { degree: Some(degree), ..Wish::default() }).unwrap();
        let bound = found.prove_by_segments(&it).unwrap();
        assert!((found.bound..=1.0).contains(&bound), "{text}: {bound} for {}", found.bound);
        for k in 0..=degree as usize {
            let unit = 1i64 << (found.coefficients[k].frac - 8).max(0);
            let mut wrong = (*found).clone();
            wrong.words[1][k] += (2 * unit) << k;
            let refusal = wrong.prove_by_segments(&it).unwrap_err();
            assert!(is_wrong_result(refusal.kind), "{refusal:?}");
        }
    }
}

#[test]
fn more_operands_than_can_be_computed_have_a_bound() {
    let it = TargetFunction { fraction: 14, ..function("exp(-x)", (0.0, 1.0), 28, 1.0) };
    let found =
        find(&it, Wish { degree: Some(2), layout: Some(Layout::Uniform), ..Wish::default() })
            .unwrap();
    assert!(it.is_wide() && found.bound <= 1.0);
    let mut largest: f64 = 0.0;
    for raw in (0..1i64 << 28).step_by(4099) {
        let value = libm::exp(-(raw as f64) / exp2(28)) * exp2(14);
        largest = largest.max((found.result(raw) as f64 - value).abs());
    }
    assert!(largest <= found.bound && largest > 0.6, "{largest} of {}", found.bound);
}

/// The samples are the square function at every third operand. Steffen's slopes are exact for squares, so the curve is the
/// square itself.
#[test]
fn the_curve_of_samples_is_met_and_a_wrong_coefficient_is_refused() {
    let square = |k: i32| Enclosure::exactly(f64::from(9 * k * k) / 65536.0);
    let points: Vec<(i64, Enclosure)> = (0..=85).map(|k| (3 * i64::from(k), square(k))).collect();
    let samples = |error| TargetFunction {
        curve: Curve::Samples(Samples::through(points.clone())),
        fraction: 10,
        error,
        ..function("x", (0.0, 256.0), 0, 1.0)
    };
    for degree in 0..=3 {
        let it = samples(1.0);
        let found = find(&it, Wish { degree: Some(degree), ..Wish::default() }).unwrap();
        let off = |raw: i64| (found.result(raw) as f64 - (raw * raw) as f64 / 64.0).abs();
        let largest = (0..=255).map(off).fold(0.0, f64::max);
        assert!(largest < 1.0 && (found.bound - largest).abs() < 1e-9, "degree {degree}");
        let mut wrong = (*found).clone();
        wrong.words[0][0] += 3i64 << (found.coefficients[0].frac - 10);
        assert_eq!(wrong.prove(&it).unwrap_err().kind, RefusalKind::ErrorExceeded);
    }
}

/// Every operand of the large domain is right against `libm`, and a wrong coefficient is refused.
#[test]
fn reduced_operands_serve_the_whole_domain() {
    type Whole = (&'static str, (f64, f64), Identity, fn(f64) -> f64);
    let cases: [Whole; 10] = [
        ("sigmoid(x)", (-4.0, 4.0), Identity::Odd, |x| 1.0 / (1.0 + libm::exp(-x))),
        ("x^3", (-1.0, 1.0), Identity::Odd, |x| x * x * x),
        ("exp(-x * x)", (-2.0, 2.0), Identity::Even, |x| libm::exp(-x * x)),
        ("cos(pi * x)", (-1.0, 1.0), Identity::Quadrants, |x| libm::cos(x * std::f64::consts::PI)),
        ("sqrt(x)", (0.0, 64.0), Identity::Octaves, f64::sqrt),
        ("1 / x", (0.125, 64.0), Identity::Octaves, |x| 1.0 / x),
        ("ln(x)", (0.125, 64.0), Identity::Octaves, libm::log),
        ("2^(x / 2)", (-4.0, 4.0), Identity::Exponent, |x| libm::exp2(x / 2.0)),
        ("exp(-x)", (-2.0, 4.0), Identity::Exponent, |x| libm::exp(-x)),
        ("2^(99 * x)", (-4.0, 0.0), Identity::Exponent, |x| libm::exp2(99.0 * x)),
    ];
    for (text, domain, identity, exact) in cases {
        for error in [1.0, 0.55] {
            let it = function(text, domain, 7, error);
            let found = find(&it, Wish { identity, ..Wish::default() }).unwrap();
            let reduction = found.reduction.as_ref().unwrap();
            for raw in it.domain.0..=it.domain.1 {
                let off = found.result(raw) as f64 - exact(raw as f64 / 128.0) * 128.0;
                assert!(off.abs() <= found.bound && found.bound < error, "{text}: {raw} is {off}");
            }
            let mut wrong = (*found).clone();
            wrong.words[0][0] += 8i64 << (found.guard() + reduction.guard);
            let refusal = wrong.prove(&it).unwrap_err();
            assert_eq!(refusal.kind, RefusalKind::ErrorExceeded, "{text}");
        }
    }
    for (text, domain, identity) in [
        ("x^2 + x", (-1.0, 1.0), Identity::Even),
        ("exp(x)", (-1.0, 1.0), Identity::Odd),
        ("sin(x)", (0.0, 4.0), Identity::Quadrants),
        ("sin(x)", (0.0, 6.0), Identity::Quadrants),
        ("1 + sqrt(x)", (1.0, 64.0), Identity::Octaves),
        ("exp(x) - exp(-x)", (1.0, 2.0), Identity::Exponent),
        ("1 + exp(x)", (0.0, 2.0), Identity::Exponent),
    ] {
        let it = function(text, domain, 8, 1.0);
        let refusal = find(&it, Wish { identity, ..Wish::default() }).unwrap_err();
        assert!(matches!(refusal.kind, RefusalKind::Reduction(_)), "{text}: {refusal:?}");
    }
}

/// The last operand of a domain with both ends is one beyond a power of two.
#[test]
fn a_domain_with_both_ends_may_have_every_layout() {
    let mut it = function("sqrt(2 - x)", (0.0, 1.0), 10, 1.0);
    let operand = Format::unsigned(1, 10);
    it = TargetFunction { domain: (0, 1 << 10), operand, outside: Outside::Anything, ..it };
    for (layout, overhang) in [(Layout::Uniform, 1), (Layout::Octaves, 1), (Layout::Halving, 0)] {
        let found = find(&it, Wish { layout: Some(layout), ..Wish::default() }).unwrap();
        assert_eq!(found.segments.overhang, overhang, "{layout:?}");
        assert!(found.bound < 1.0);
    }
}

/// The wave is so short that each operand needs its own segment, so the last segment cannot contain further operands.
#[test]
fn a_steep_function_does_without_an_overhang() {
    let it = TargetFunction {
        curve: Curve::Formula(parse("cos(2 * pi * sqrt(0.01 + x))").unwrap()),
        domain: (1, 4194),
        operand: Format::unsigned(9, 4),
        outside: Outside::Anything,
        fraction: 5,
        error: 1.0,
    };
    let found = find(&it, Wish::default()).unwrap();
    assert_eq!(found.segments.overhang, 0);
    assert!(found.bound < 1.0);
}
