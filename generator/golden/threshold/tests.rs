//! Values worked out by hand.

use super::*;
use crate::golden::watch;
use crate::keys::common::{Domain, Intensity, Operands};

/// C = 4, F = 4, K = 4, small enough to follow by hand.
fn small(levels: &[u32]) -> Arithmetic {
    let (operands, f, domain) = (Operands::small(), Intensity::small(), Domain::small());
    Arithmetic::new(Keys { operands, f, levels: levels.to_vec(), domain })
}

#[test]
fn points_by_hand() {
    let f = |levels: &[u32], cosine, n| small(levels).f(&[cosine, n]);
    // n = 4, c = 14/16: 2·(−2/16) = −4/16; base 12/16; 144/256 = 9/16.
    assert_eq!(f(&[0], 14, 4), 9);
    // n = 3: −3/16; 13² = 169 → 10.
    assert_eq!(f(&[0], 14, 3), 10);
    // n = 1, c = 13/16: −3/32 rounds down to −2/16; 14² = 196 → 12.
    assert_eq!(f(&[0], 13, 1), 12);
    // The base would be −1/16 · 15 + … : n = 15, c = 13/16: −45/32 → −1.0; 0.
    assert_eq!(f(&[0], 13, 15), 0);
    // c = 0 and n = 1 would be 1/4.
    assert_eq!(f(&[0], 0, 1), 0);
    assert_eq!(f(&[0], 1, 1), 4);
    // 1.0 is the largest word, and so is everything above 1.0 at the port.
    assert_eq!(f(&[0], 16, 15), 15);
    assert_eq!(f(&[0], 31, 15), 15);
    // 9 words of 16 of 15 units are 8.4375 units: 843 hundredths keep the word 9, 844 hide it.
    assert_eq!(f(&[843], 14, 4), 9);
    assert_eq!(f(&[844], 14, 4), 0);
    // By octaves: n = 4 is in the third.
    assert_eq!(f(&[844, 844, 0], 14, 4), 9);
    assert_eq!(f(&[0, 0, 844], 14, 4), 0);
    assert_eq!(f(&[0, 844], 14, 4), 0);
    assert_eq!(f(&[0, 844], 14, 1), 14);
}

#[test]
fn either_side_of_the_level_is_right_and_no_other() {
    // The square is exactly the level.
    let contract = highlight(small(&[843]));
    assert_eq!(contract.references(&[14, 4]), [0.5625, 0.0]);
    // Margin: 2 ulps for the base, one for the square.
    assert_eq!(contract.bound().f, 3.0 / 16.0);
    // n = 4, c = 15/16: (14/16)² is 52/256 above the level.
    assert_eq!(contract.references(&[15, 4]), [0.765625; 2]);
    assert_eq!(contract.references(&[13, 4]), [0.390625, 0.0]);
    // n = 8, c = 14/16: a quarter, 80/256 below.
    assert_eq!(contract.references(&[14, 8]), [0.0; 2]);
}

/// One point followed clock by clock: words 0, 1, 2, 3 and idle.
#[test]
fn a_point_clock_by_clock() {
    let mut model = clocked(small(&[50]));
    // c = 14/16, n = 4, red 15, written together with start.
    let first = [1, 1, 14, 1, 4, 1, 15, 1, 0, 0, 0, 0];
    // Writes while busy change nothing.
    let then = [1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0];
    let names = ["run", "word_address", "scaled", "intensity", "valid", "done"];
    let expected = [
        [1, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        // −4/16 in five bits.
        [1, 2, 28, 0, 0, 0],
        [1, 3, 28, 9, 1, 1],
        [0, 0, 28, 9, 0, 0],
    ];
    assert_eq!(watch(&mut model, names, &first, &then), expected);
    // The clock before was idle again: its write of red counts. 9/16 of 1 unit.
    assert_eq!(model.value("red_out").unwrap(), 1);
}

/// Half a unit hides nothing that could be seen; a whole unit does.
#[test]
fn levels_that_are_seen_are_remarked_on() {
    let remarks = |levels: &[u32]| {
        let schema = crate::keys::threshold::schema();
        let defaults = Keys::of(&Config::defaults(&schema, "defaults"));
        Arithmetic::new(Keys { levels: levels.to_vec(), ..defaults }).remarks()
    };
    assert!(remarks(&[50]).is_empty());
    let seen = remarks(&[50, 50, 320]);
    assert!(seen.len() == 1 && seen[0].contains("n = 4 outputs up to 3"), "{seen:?}");
}
