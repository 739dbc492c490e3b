//! Tests keys such as `colour.multipliers = 1`: one multiplier in place of three gives the same results in more clocks.

use glint::core::Core;
use glint::evidence::comparison::multipliers;
use glint::registry::{Device, Registry};

use crate::common::cores::{assert_agrees, computations, device, with_keys};

/// Results that golden model and simulation are compared on.
const POINTS: u64 = 2000;

/// The device with one multiplier for what has three: two multipliers fewer, so many clocks more, and the same results.
#[track_caller]
fn assert_one_for_three(device: &Device, table: &str, clocks: u32) {
    let one = format!("[{table}]\nmultipliers = 1\n");
    let [three, one] = ["", &one].map(|more| with_keys(*device, more).expect("a design"));
    let count = |core: &Core| multipliers(&core.design).len();
    assert_eq!(count(&one), count(&three) - 2, "{}", device.name);
    for (one, three) in computations(&one).iter().zip(computations(&three)) {
        assert_eq!(one.operands, three.operands);
        let outputs = |it: &glint::package::Computation| it.results[0].outputs.clone();
        assert_eq!(outputs(one), outputs(&three), "{}: {:?}", device.name, one.operands);
        assert_eq!(one.done, three.done + clocks, "{}", device.name);
    }
    assert_agrees(&one, POINTS, 1, device.name);
}

#[test]
fn one_multiplier_serves_three_colours() {
    let mut seen = 0;
    for device in Registry::catalogue().devices() {
        if (device.schema)().key("colour.multipliers").is_some() {
            assert_one_for_three(device, "colour", 3);
            seen += 1;
        }
    }
    assert_eq!(seen, 8);
}

#[test]
fn one_multiplier_serves_the_components_of_lyon() {
    assert_one_for_three(&device("lyon"), "distance", 2);
}
