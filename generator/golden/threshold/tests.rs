//! Compares the golden model and the contract of `threshold` with values worked out by hand.

use super::*;
use glint_keys::common::{Domain, Intensity, Operands};

/// Cosines and f have 4 fraction bits and colours 4 bits, so results can be worked out by hand.
fn small(levels: &[u32]) -> ThresholdArithmetic {
    let (operands, f, domain) = (Operands::small(), Intensity::small(), Domain::small());
    ThresholdArithmetic::new(Keys { operands, f, levels: levels.to_vec(), domain })
}

#[test]
fn either_side_of_the_level_is_right_and_no_other() {
    // The square is exactly the level.
    let contract = highlight(small(&[843]));
    assert_eq!(contract.references(&[14, 4]), [0.5625, 0.0]);
    // Margin: 2 ulps for the base, one for the square.
    assert_eq!(contract.bounds().f, 3.0 / 16.0);
    // n = 4, c = 15/16: (14/16)² is 52/256 above the level.
    assert_eq!(contract.references(&[15, 4]), [0.765625; 2]);
    assert_eq!(contract.references(&[13, 4]), [0.390625, 0.0]);
    // n = 8, c = 14/16: a quarter, 80/256 below.
    assert_eq!(contract.references(&[14, 8]), [0.0; 2]);
}

/// A level of half a unit hides only outputs that round to 0. A level of 3.2 units hides visible outputs.
#[test]
fn levels_that_are_seen_are_remarked_on() {
    let remarks = |levels: &[u32]| {
        let schema = glint_keys::threshold::schema();
        let defaults = Keys::of(&Config::defaults(&schema, "defaults"));
        ThresholdArithmetic::new(Keys { levels: levels.to_vec(), ..defaults }).remarks()
    };
    assert!(remarks(&[50]).is_empty());
    let seen = remarks(&[50, 50, 320]);
    assert!(seen.len() == 1 && seen[0].contains("n = 4, outputs of up to 3"), "{seen:?}");
}
