//! The prototype and the analogues of the seeds, `threshold`, `quadratic` and `lyon`, at the edges of
//! their operands: the simulated hardware against values worked out by hand.

use crate::common::cores::configuration;
use crate::common::host::Host;
use glint::core::Core;

/// 1.0 as a cosine of the default configurations, and as a component of a vector.
const COSINE_ONE: i64 = 1 << 20;
const COMPONENT_ONE: i64 = 1 << 16;

/// The red output for the largest red, and the clocks from start to valid.
fn red(core: &Core, operands: &[(&str, i64)]) -> (u64, u32) {
    let mut host = Host::new(&core.design);
    host.start(&[operands, &[("red", 255)]].concat());
    let clocks = host.until_valid();
    (host.value("red_out"), clocks)
}

fn of_cosine(core: &Core, cosine: i64, n: i64) -> u64 {
    let (red, clocks) = red(core, &[("cos_gamma", cosine), ("exponent", n)]);
    assert_eq!(clocks, 4);
    red
}

#[test]
fn threshold_agrees_by_hand() {
    let core = configuration("configs/threshold.toml");
    let at = |cosine, n| of_cosine(&core, cosine, n);
    // The peak, and what lies above it at the port.
    assert_eq!([at(COSINE_ONE, 1000), at(COSINE_ONE + 5, 1000)], [255, 255]);
    // n = 0 is 1.0 everywhere but where the surface faces away.
    assert_eq!([at(1, 0), at(0, 0)], [255, 0]);
    // n = 1 at c = 0 would be a quarter.
    assert_eq!([at(1, 1), at(0, 1)], [64, 0]);
    // n = 1000: the base is −0.0004 at 2098 ulps from the peak; far beyond, the square would be 499².
    assert_eq!([at(COSINE_ONE - 2098, 1000), at(1, 1000)], [0, 0]);
}

/// At n = 16 the level is 8 units, 2056.03 words of f.
#[test]
fn threshold_agrees_by_hand_at_its_level() {
    let core = configuration("configs/threshold_levels.toml");
    // Bases of 11611 and 11610 words, whose squares are 2057 and 2056 words.
    let at = |base: i64| of_cosine(&core, COSINE_ONE - 2 * (65536 - base), 16);
    assert_eq!([at(11611), at(11610)], [8, 0]);
}

#[test]
fn quadratic_agrees_by_hand() {
    let core = configuration("configs/quadratic.toml");
    let at = |cosine, n| of_cosine(&core, cosine, n);
    let half = COSINE_ONE / 2;
    assert_eq!([at(COSINE_ONE, 1023), at(COSINE_ONE + 1, 0)], [255, 255]);
    // n = 0 and n = 1: c itself, 127.5 units. n = 2: its square.
    assert_eq!([at(half, 0), at(half, 1), at(half, 2)], [128, 128, 64]);
    // n = 3: 1/2 − 393/256/4 is 0.1162, 29.6 units. n = 4 and more: below the zero.
    assert_eq!([at(half, 3), at(half, 4), at(half, 1023)], [30, 0, 0]);
    assert_eq!([at(0, 0), at(0, 1000)], [0, 0]);
}

#[test]
fn lyon_agrees_by_hand_with_the_shift_register() {
    let core = configuration("configs/lyon.toml");
    let at = |[dx, dy, dz]: [i64; 3], shift| {
        let (red, clocks) = red(&core, &[("dx", dx), ("dy", dy), ("dz", dz), ("shift", shift)]);
        assert_eq!(clocks, 8 + shift as u32);
        red
    };
    assert_eq!([at([0; 3], 0), at([0; 3], 15)], [255, 255]);
    // D² = 2.0 at n = 1: (1 − 2/32)^16 is 90.8 units.
    assert_eq!(at([COMPONENT_ONE, -COMPONENT_ONE, 0], 0), 91);
    // The farthest, D² = 12.0: (5/8)^16 at n = 1, and 0 from n = 4 on.
    assert_eq!(at([-2 * COMPONENT_ONE; 3], 0), 0);
    assert_eq!(at([-2 * COMPONENT_ONE; 3], 15), 0);
    // Shifts outside the domain: D² = 2^-16 with β = 2^10 is (63/64)^16, 198.2 units; D² = 2^-10 is the zero.
    assert_eq!([at([256, 0, 0], 15), at([0, 2048, 0], 15)], [198, 0]);
}

#[test]
fn lyon_agrees_by_hand_with_the_multiplier() {
    let core = configuration("configs/studies/lyon_multiplier.toml");
    let at = |[dx, dy, dz]: [i64; 3], n| {
        let operands = [("dx", dx), ("dy", dy), ("dz", dz), ("exponent", n)];
        let (red, clocks) = red(&core, &operands);
        assert_eq!(clocks, 8);
        red
    };
    assert_eq!([at([0; 3], 1000), at([-2 * COMPONENT_ONE; 3], 0)], [255, 255]);
    assert_eq!(at([COMPONENT_ONE, 0, -COMPONENT_ONE], 1), 91);
    // D² = 1/16: the zero is at n = 512; at n = 100 it is (1 − 100/512)^16, 7.9 units.
    let quarter = COMPONENT_ONE / 4;
    assert_eq!([100, 511, 512, 1023].map(|n| at([0, 0, quarter], n)), [8, 0, 0, 0]);
}
