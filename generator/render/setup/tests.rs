use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::*;
use crate::config::{self, Config};
use crate::devices;

const X: Vector = [1.0, 0.0, 0.0];
const Y: Vector = [0.0, 1.0, 0.0];
const Z: Vector = [0.0, 0.0, 1.0];

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// In the plane of x and z, `degrees` from z toward x.
fn tilted(degrees: f64) -> Vector {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [sin, 0.0, cos]
}

fn random(random: &mut ChaCha8Rng) -> Vector {
    [(); 3].map(|()| f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5)
}

/// The spherical interpolation between unit vectors.
fn slerp(a: Vector, b: Vector, t: f64) -> Vector {
    let gamma = angle(a, b);
    let weight = |part: f64| (part * gamma).sin() / gamma.sin();
    sum(scaled(a, weight(1.0 - t)), scaled(b, weight(t)))
}

#[test]
fn the_half_vector_turns_as_the_normal_does() {
    // Turning x into z turns z into −x, and leaves y.
    let turned = |half| turned(Z, X, half);
    for (half, expected) in [(X, Z), (Z, [-1.0, 0.0, 0.0]), (Y, Y)] {
        let got = turned(half);
        assert!((0..3).all(|at| close(got[at], expected[at])), "{got:?}");
    }
}

#[test]
fn angles_to_the_normal_are_kept_and_the_cosine_is_that_of_the_interpolation() {
    let mut source = ChaCha8Rng::seed_from_u64(1);
    let mut backs = 0;
    for _ in 0..2000 {
        let [n1, h1, n2, h2] = [(); 4].map(|()| unit(random(&mut source)).unwrap());
        let arc = Arc::new(n1, h1, n2, h2).unwrap();
        assert!(close(dot(n1, arc.turned_half), dot(n2, h2)));
        assert!(close(arc.theta_2, angle(n2, h2)));
        assert!(close(arc.gamma, angle(h1, arc.turned_half)));
        assert!(arc.peak >= 0.0);
        backs += usize::from(dot(n1, h1) <= 0.0);
        for step in 0..=16 {
            let t = f64::from(step) / 16.0;
            let direct = dot(n1, slerp(h1, arc.turned_half, t));
            assert!((arc.cosine(t) - direct).abs() < 1e-9, "{arc:?} at {t}");
            // ζ itself: within three right angles, and the lit part of the way within one.
            let zeta = arc.zeta_start() + t * arc.gamma;
            assert!(zeta.abs() <= 3.0 * FRAC_PI_2 + 1e-12);
            assert!(direct.abs() < 1e-9 || (direct > 0.0) == (zeta.abs() < FRAC_PI_2));
        }
        if dot(n1, h1) > 0.0 {
            // The seed's own formulas.
            let (c1, c2) = (arc.theta_1.cos(), arc.theta_2.cos());
            let p = (c2 - c1 * arc.gamma.cos()) / (c1 * arc.gamma.sin());
            assert!((arc.p() - p).abs() < 1e-9 * p.abs().max(1.0));
            assert!((arc.lambda - p.atan()).abs() < 1e-9);
            assert!((arc.peak - c1 / arc.lambda.cos()).abs() < 1e-9);
        }
    }
    assert!(backs > 500, "{backs} of the first points face away");
}

#[test]
fn a_line_by_hand() {
    // H from 30° on one side of N to 60° on the other, through N: λ = 30°, A = 1.
    let arc = Arc::new(Z, tilted(-30.0), Z, tilted(60.0)).unwrap();
    assert!(close(arc.theta_1, FRAC_PI_6) && close(arc.theta_2, FRAC_PI_3));
    assert!(close(arc.gamma, FRAC_PI_2) && close(arc.lambda, FRAC_PI_6));
    assert!(close(arc.peak, 1.0));
    let line = arc.line(200.0, 8, 90);
    assert!(close(line.amplitude, 200.0));
    assert!(close(line.delta_zeta, PI / 180.0) && close(line.zeta_start, -FRAC_PI_6));
    assert!(close(line.zeta(90), FRAC_PI_3));

    // s1.26: a right angle is 2²⁶; 60° of 90 intervals.
    let config = Config::defaults(&devices::quad_cosine::schema(), "line");
    let operands = line.quad_cosine(&config).unwrap();
    let expected = Operands {
        amplitude: 200,
        delta_zeta: 745_654,     // 2²⁶/90 = 745654.04
        zeta_start: -22_369_621, // −2²⁶/3
        length: 90,
        exponent: Some(8),
    };
    assert_eq!(operands, expected);

    // s7.22: both times √(8/2) = 2.
    let config = Config::defaults(&devices::cosine_squared::schema(), "line");
    let operands = line.cosine_squared(&config).unwrap();
    let expected = Operands {
        delta_zeta: 93_207,     // 2²³/90 = 93206.76
        zeta_start: -2_796_203, // −2²³/3 = −2796202.67
        exponent: None,
        ..expected
    };
    assert_eq!(operands, expected);
}

#[test]
fn a_half_vector_that_stands_still() {
    let arc = Arc::new(Z, tilted(20.0), Z, tilted(20.0)).unwrap();
    assert_eq!((arc.gamma, arc.lambda, arc.rise), (0.0, 0.0, 0.0));
    assert!(close(arc.cosine(0.7), 20f64.to_radians().cos()));
    let line = arc.line(100.0, 2, 10);
    assert_eq!((line.delta_zeta, line.zeta_start), (0.0, 0.0));
    assert!(close(line.amplitude, 100.0 * 20f64.to_radians().cos().powi(2)));
    // Facing away.
    let arc = Arc::new(Z, tilted(120.0), Z, tilted(120.0)).unwrap();
    assert_eq!((arc.peak, arc.line(100.0, 2, 10).amplitude), (0.0, 0.0));
}

#[test]
fn a_line_of_one_point() {
    let line = Arc::new(Z, tilted(-30.0), Z, tilted(60.0)).unwrap().line(100.0, 4, 0);
    assert_eq!(line.delta_zeta, 0.0);
    assert!(close(line.zeta(0), -FRAC_PI_6));
}

#[test]
fn a_first_point_that_faces_away() {
    // From 120° through 90° to 20°, H stays in the plane of N: ζ is its angle to N.
    let arc = Arc::new(Z, tilted(120.0), Z, tilted(20.0)).unwrap();
    assert!(close(arc.peak, 1.0));
    assert!(close(arc.zeta_start(), -120f64.to_radians()));
    // At 90° the seed's P is infinite.
    let arc = Arc::new(Z, X, Z, tilted(20.0)).unwrap();
    assert!(close(arc.zeta_start(), -FRAC_PI_2));
    assert!(close(arc.peak, 1.0));
    // From 170° the other way round, 170° far: λ = −170°, so ζ would run from 170° to 340°.
    let arc = Arc::new(Z, tilted(170.0), Z, tilted(340.0)).unwrap();
    assert!(close(arc.zeta_start(), -190f64.to_radians()));
}

#[test]
fn opposite_normals_and_half_vectors() {
    let arc = Arc::new(Z, X, [0.0, 0.0, -1.0], tilted(150.0)).unwrap();
    assert!(close(arc.theta_2, FRAC_PI_6));
    assert!(close(dot(arc.turned_half, tilted(-30.0)), 1.0));
    assert_eq!(Arc::new(Z, X, Z, [-1.0, 0.0, 0.0]), Err(Error::OppositeHalves));
    assert_eq!(Arc::new(Z, X, [0.0; 3], X), Err(Error::NoDirection("the second normal")));
    assert!(Arc::new(Z, [f64::NAN, 0.0, 1.0], Z, X).is_err());
}

#[test]
fn what_a_configuration_has_no_room_for() {
    let key = |error: Error| match error {
        Error::Beyond { key, .. } => key,
        other => panic!("{other}"),
    };
    let arc = Arc::new(Z, tilted(-30.0), Z, tilted(60.0)).unwrap();
    let quad = Config::defaults(&devices::quad_cosine::schema(), "line");
    assert_eq!(key(arc.line(1.0, 1024, 5).quad_cosine(&quad).unwrap_err()), "exponent.bits");
    assert_eq!(key(arc.line(1.0, 5, 4096).quad_cosine(&quad).unwrap_err()), "length.bits");
    // Brighter than the operand holds: it saturates.
    assert_eq!(arc.line(300.0, 5, 5).quad_cosine(&quad).unwrap().amplitude, 255);
    let squared = Config::defaults(&devices::cosine_squared::schema(), "line");
    assert!(arc.line(1.0, 1000, 5).cosine_squared(&squared).is_ok());
    let text = "device = \"cosine-squared\"\nangle.integer = 3";
    let schemas = [devices::cosine_squared::schema()];
    let squared = config::parse("line.toml", text, &schemas).unwrap();
    // 60° times √500 is 14.9 right angles.
    assert_eq!(key(arc.line(1.0, 1000, 5).cosine_squared(&squared).unwrap_err()), "angle.integer");
}
