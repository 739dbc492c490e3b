use super::contract::highlight;
use super::*;
use crate::base::fixed::Rounding;
use crate::keys::common::Domain;

/// The default with 4 + 4 bits of angle and root, and tables of 8 steps.
fn small() -> Keys {
    Keys {
        angle_fraction: 6,
        angle_multiplied: 4,
        root_fraction: 4,
        table_address: 3,
        length_bits: 12,
        stages: 2,
        exponent_bits: 10,
        colour_bits: 8,
        fraction: 6,
        output_rounding: Rounding::Nearest,
        domain: Domain { least: 1, most: 1000 },
    }
}

#[test]
fn roots_are_nearest() {
    // √2 = 1.41421, √(7/16) = 0.66144, √(1000/16) = 7.90569, √(1023/16) = 7.99609.
    assert_eq!(root(0, 16, 14), 0);
    assert_eq!(root(1, 1, 14), 16384);
    assert_eq!(root(2, 2, 14), 16384);
    assert_eq!(root(7, 16, 14), 10837);
    assert_eq!(root(1000, 16, 14), 129527);
    assert_eq!(root(1023, 16, 14), 131008);
    assert_eq!(root(3, 4, 4), 14);
}

#[test]
fn the_decoder_at_its_edges() {
    let ranges = [0, 1, 2, 3, 6, 7, 1000, 1023].map(|n| POWERS[range_of(n)]);
    assert_eq!(ranges, [16, 1, 2, 4, 4, 16, 16, 16]);
}

#[test]
fn f_by_hand() {
    let contract = highlight(small());
    let f = |angle, n| contract.f(&[0, angle, n, 0]);
    // n = 1: cos in 8 steps of 11.25°. 20/64 of 90° is magnitude 5/16, step 2: (cos 22.5° + cos 33.75°)/2 = 0.8777.
    assert_eq!(f(20, 1), 56);
    // −20/64: complement 19/64, magnitude 4/16, step 2 too.
    assert_eq!(f(-20, 1), 56);
    // n = 64: the root is 2.0; 5/16 doubled is step 5: cos¹⁶ of 56.25° … 67.5° is below half an ulp.
    assert_eq!(f(20, 64), 0);
    // 6/64 is 1/16, doubled step 1: (cos¹⁶ 11.25° + cos¹⁶ 22.5°)/2 = (0.7330 + 0.2817)/2 = 0.5073.
    assert_eq!(f(6, 64), 32);
    // The peak saturates: (1 + 0.7330)/2 = 0.8665 with 16, (1 + cos 11.25°)/2 = 0.9904 with 1.
    assert_eq!(f(0, 64), 55);
    assert_eq!(f(0, 1), 63);
    // The last step, a right angle, beyond, and −90° itself.
    assert_eq!(f(63, 1), 0);
    assert_eq!(f(64, 1), 0);
    assert_eq!(f(-128, 1), 0);
    assert_eq!(f(-64, 0), 55);
    assert_eq!(f(-65, 0), 0);
    assert_eq!(contract.colour(32, 255), 128);
}

#[test]
fn points_follow_the_line() {
    let contract = highlight(small());
    // From −10/64 by 3/64; and around: 120 + 2·5 is 130 − 256.
    assert_eq!(*contract.point(&[3, -10, 20, 7], 0), [3, -10, 20, 7]);
    assert_eq!(*contract.point(&[3, -10, 20, 7], 4), [3, 2, 20, 7]);
    assert_eq!(*contract.point(&[5, 120, 20, 7], 2), [5, -126, 20, 7]);
}
