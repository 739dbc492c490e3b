use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::*;
use crate::render::Feed;
use glint_config::{self as config, Config};
use glint_golden as golden;
use glint_golden::Contract;
use glint_keys as keys;

const X: Vector = Vector([1.0, 0.0, 0.0]);
const Y: Vector = Vector([0.0, 1.0, 0.0]);
const Z: Vector = Vector([0.0, 0.0, 1.0]);

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// Returns the unit vector in the plane of x and z that is `degrees` away from z toward x.
fn tilted(degrees: f64) -> Vector {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vector([sin, 0.0, cos])
}

fn random(random: &mut ChaCha8Rng) -> Vector {
    Vector([(); 3].map(|()| f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5))
}

/// Interpolates on the sphere between two unit vectors, at the part `t` of the way from `a` to `b`.
fn slerp(a: Vector, b: Vector, t: f64) -> Vector {
    let gamma = angle(a, b);
    let weight = |part: f64| (part * gamma).sin() / gamma.sin();
    a * weight(1.0 - t) + b * weight(t)
}

#[test]
fn the_half_vector_turns_as_the_normal_does() {
    // Turning x into z turns z into −x, and leaves y.
    let turned = |half| turned(Z, X, half);
    for (half, expected) in [(X, Z), (Z, -X), (Y, Y)] {
        let got = turned(half);
        assert!((0..3).all(|at| close(got.0[at], expected.0[at])), "{got:?}");
    }
}

#[test]
fn angles_to_the_normal_are_kept_and_the_cosine_is_that_of_the_interpolation() {
    let mut source = ChaCha8Rng::seed_from_u64(1);
    let mut backs = 0;
    for _ in 0..2000 {
        let [n1, h1, n2, h2] = [(); 4].map(|()| random(&mut source).unit().unwrap());
        let arc = Arc::new(n1, h1, n2, h2).unwrap();
        let turned_half = turned(n1, n2, h2);
        assert!(close(n1.dot(turned_half), n2.dot(h2)));
        assert!(close(arc.theta_2, angle(n2, h2)));
        assert!(close(arc.gamma, angle(h1, turned_half)));
        assert!(arc.peak >= 0.0);
        backs += usize::from(n1.dot(h1) <= 0.0);
        for step in 0..=16 {
            let t = f64::from(step) / 16.0;
            let direct = n1.dot(slerp(h1, turned_half, t));
            assert!((arc.cosine(t) - direct).abs() < 1e-9, "{arc:?} at {t}");
            // ζ is always within three right angles of 0. It is within one right angle if and only if the point is lit.
            let zeta = arc.zeta_start() + t * arc.gamma;
            assert!(zeta.abs() <= 3.0 * FRAC_PI_2 + 1e-12);
            assert!(direct.abs() < 1e-9 || (direct > 0.0) == (zeta.abs() < FRAC_PI_2));
        }
        if n1.dot(h1) > 0.0 {
            // The formulas of document 000, the source of these devices.
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

    // In s1.26 a right angle is 2²⁶: 2²⁶/90 = 745654.04 and −2²⁶/3. Then follow n, l and C.
    assert_eq!(quad(&line), [745_654, -22_369_621, 8, 90, 200]);

    // In s7.22 both angles are multiplied by √(8/2) = 2: 2²³/90 = 93206.76 and −2²³/3 = −2796202.67.
    assert_eq!(squared("", &line).unwrap(), [93_207, -2_796_203, 90, 200]);
    // The same line, set up from its angles instead of vectors.
    let [thirty, sixty, right] = [FRAC_PI_6, FRAC_PI_3, FRAC_PI_2];
    let same = Arc::of_angles(thirty, sixty, right).unwrap().line(200.0, 8, 90);
    assert_eq!(quad(&same), quad(&line));
    assert_eq!(Arc::of_angles(thirty, sixty, 2.0), Err(Error::NoSuchAngles));
    assert_eq!(Arc::of_angles(thirty, sixty, 0.1), Err(Error::NoSuchAngles));
    assert_eq!(Arc::of_angles(thirty, sixty, 0.0), Err(Error::NoSuchAngles));
}

#[test]
fn a_half_vector_that_stands_still() {
    let arc = Arc::new(Z, tilted(20.0), Z, tilted(20.0)).unwrap();
    assert_eq!((arc.gamma, arc.lambda, arc.rise), (0.0, 0.0, 0.0));
    assert!(close(arc.cosine(0.7), 20f64.to_radians().cos()));
    let line = arc.line(100.0, 2, 10);
    assert_eq!((line.delta_zeta, line.zeta_start), (0.0, 0.0));
    assert!(close(line.amplitude, 100.0 * 20f64.to_radians().cos().powi(2)));
    // Only rounding moves the half vector. The formulas of the document would divide some ulps by each other.
    for by in [1e-16, 3e-16, 1e-12, 1e-9] {
        let arc = Arc::new(Z, tilted(20.0), Z, tilted(20.0) + X * by).unwrap();
        assert!((arc.peak - 20f64.to_radians().cos()).abs() < 1e-7, "{arc:?}");
    }
    // The surface faces away from the light.
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
    // From 120° through 90° to 20°, H stays in one plane with N, so ζ is the angle between H and N.
    let arc = Arc::new(Z, tilted(120.0), Z, tilted(20.0)).unwrap();
    assert!(close(arc.peak, 1.0));
    assert!(close(arc.zeta_start(), -120f64.to_radians()));
    // At 90° the quantity P of the document is infinite.
    let arc = Arc::new(Z, X, Z, tilted(20.0)).unwrap();
    assert!(close(arc.zeta_start(), -FRAC_PI_2));
    assert!(close(arc.peak, 1.0));
    // From 170° the other way round, H turns by 170°: λ = −170°, so ζ would run from 170° to 340°.
    let arc = Arc::new(Z, tilted(170.0), Z, tilted(340.0)).unwrap();
    assert!(close(arc.zeta_start(), -190f64.to_radians()));
}

#[test]
fn opposite_normals_and_half_vectors() {
    let arc = Arc::new(Z, X, -Z, tilted(150.0)).unwrap();
    assert!(close(arc.theta_2, FRAC_PI_6));
    assert!(close(turned(Z, -Z, tilted(150.0)).dot(tilted(-30.0)), 1.0));
    assert_eq!(Arc::new(Z, X, Z, -X), Err(Error::OppositeHalves));
    assert_eq!(Arc::new(Z, X, Vector::default(), X), Err(Error::NoDirection("normal_2")));
    assert!(Arc::new(Z, Vector([f64::NAN, 0.0, 1.0]), Z, X).is_err());
}

fn quad(line: &LineParameters) -> Vec<i64> {
    let config = Config::defaults(&keys::quad_cosine::schema(), "line");
    operands(golden::quad_cosine::contract(&config).as_ref(), line).unwrap()
}

/// `keys` are lines of TOML.
fn squared(keys: &str, line: &LineParameters) -> anyhow::Result<Vec<i64>> {
    let text = format!("device = \"cosine-squared\"\n{keys}");
    let config = config::parse("line.toml", &text, &[keys::cosine_squared::schema()]).unwrap();
    operands(golden::cosine_squared::contract(&config).as_ref(), line)
}

fn operands(contract: &dyn Contract, line: &LineParameters) -> anyhow::Result<Vec<i64>> {
    Feed::new("line", contract).unwrap().line(line)
}

#[test]
fn what_a_configuration_has_no_room_for() {
    let arc = Arc::new(Z, tilted(-30.0), Z, tilted(60.0)).unwrap();
    // The light is brighter than the largest value of the operand, so the operand saturates.
    assert_eq!(quad(&arc.line(300.0, 5, 5))[4], 255);
    assert!(squared("", &arc.line(1.0, 1000, 5)).is_ok());
    // −30° times √500 is −7.45 right angles.
    let error = squared("angle.integer = 3", &arc.line(1.0, 1000, 5)).unwrap_err();
    assert!(error.to_string().contains("is -7.5 right angles"), "{error}");
}
