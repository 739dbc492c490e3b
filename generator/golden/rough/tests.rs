//! Compares the error bound of `rough` with the largest error of all operands, in words of a few bits.

use super::*;
use crate::highlight::Reflectance;
use glint_base::fixed::Rounding;
use glint_keys::common::{Domain, Intensity, Operands};

/// Returns keys with few bits: cosines and f have 4 fraction bits, sines and products 6. A test in `sine.rs` works out the sine
/// table by hand.
fn small() -> Keys {
    Keys {
        arithmetic: Kind::Exact,
        clamp: true,
        operands: Operands::small(),
        product_fraction: 6,
        product_rounding: Rounding::Truncate,
        f: Intensity::small(),
        scheme: RomLayout::Segmented,
        sine_fraction: 6,
        synchronous: true,
        address: 4,
        segments: vec![2],
        slope_fraction: 5,
        domain: Domain::small(),
        deviation: 30.0,
    }
}

/// The bound is never below the largest error of all operands, and equals it if the search has found it.
#[test]
fn the_bound_is_the_largest_error_of_all_operands() {
    let mut wide = Keys {
        product_fraction: 12,
        segments: vec![4, 3],
        slope_fraction: 10,
        sine_fraction: 12,
        domain: Domain { least: 1, most: 30 },
        ..small()
    };
    wide.operands.cosine.fraction = 8;
    wide.f.fraction = 10;
    let rounding = Rounding::Nearest;
    let f = Intensity { rounding, ..wide.f.clone() };
    let all = [
        Keys { product_rounding: rounding, f, ..wide.clone() },
        Keys { scheme: RomLayout::Direct, address: 7, ..wide.clone() },
        Keys { deviation: 90.0, domain: Domain { least: 3, most: 9 }, ..wide.clone() },
        Keys { sine_fraction: 9, product_fraction: 16, ..wide.clone() },
        Keys { clamp: false, ..wide.clone() },
        wide,
    ];
    let mut met = 0;
    for keys in all {
        let it = RoughArithmetic::new(keys.clone());
        let (lowest, one) = (keys.cos_dgamma_domain().0, keys.largest_cosine());
        let mut largest = 0.0_f64;
        for (x, y) in (0..=one).flat_map(|x| (lowest..=one).map(move |y| (x, y))) {
            for n in keys.domain.least..=keys.domain.most {
                for negative in [0, 1] {
                    let control = [x, y, n, negative];
                    let f = it.f(&control) as f64 / 1024.0;
                    largest = largest.max((f - it.reference(&control)).abs());
                }
            }
        }
        let bound: f64 = it.shares().iter().map(|share| share.2).sum();
        assert!(bound >= largest, "{bound} is below {largest}");
        met += usize::from(bound < largest + 2e-9);
    }
    assert!(met >= 3, "{met}");
}
