//! Tests the key `operands.buffered`: the host may write operands at any time, and the next computation starts one clock
//! earlier.

use glint::core::Core;
use glint::cosim::trial;
use glint::dsl::{Designer, end, step, valid, wait_for_start};
use glint::fixed::Format;
use glint::package::Computation;
use glint::registry::Registry;

use crate::common::cores::{assert_agrees, computations, device, with_keys as core};
use crate::common::host::Host;

/// Results that golden model and simulation are compared on.
const POINTS: u64 = 4000;

const BUFFERED: &str = "[operands]\nbuffered = true\n";

#[test]
fn every_device_computes_the_same_in_a_clock_less() {
    for device in Registry::catalogue().devices() {
        let [plain, buffered] = ["", BUFFERED].map(|more| core(*device, more).expect("a design"));
        let timing =
            |core: &Core| trial::timing(&core.design, core.contract.as_ref()).expect("the clocks");
        let (before, after) = (timing(&plain), timing(&buffered));
        assert_eq!(after.start_to_valid, before.start_to_valid, "{}", device.name);
        assert_eq!(after.start_to_done, before.start_to_done, "{}", device.name);
        let less = before.start_to_start.map(|clocks| clocks - 1);
        assert_eq!(after.start_to_start, less, "{}", device.name);
        assert_eq!(computations(&buffered), computations(&plain), "{}", device.name);
        assert_agrees(&buffered, POINTS, 1, device.name);
    }
}

#[test]
fn other_keys_go_with_it() {
    for (name, more) in [
        ("cosine-power", "[output]\nregistered = true\n"),
        ("lyon", "[colour]\nmultipliers = 1\n"),
        ("quad-cosine", "[line]\nstages = 7\n"),
        ("cosine-squared", "[line]\nstages = 5\n[output]\nregistered = true\n"),
    ] {
        let core = core(device(name), &format!("{more}{BUFFERED}")).expect("a design");
        assert_agrees(&core, POINTS, 1, name);
    }
}

/// A host that writes an operand a clock while a point is computed, and raises `start` with `done`: the results are
/// those of the core without buffers, one after another without a pause.
#[test]
fn a_host_that_writes_ahead_loses_no_clock() {
    for name in ["cosine-power", "schlick", "rough"] {
        let wanted = computations(&core(device(name), "").expect("a design"));
        let buffered = core(device(name), BUFFERED).expect("a design");
        let (design, contract) = (&buffered.design, buffered.contract.as_ref());
        let mut host = Host::new(design);
        let write = |host: &mut Host, of: &Computation, at: usize| {
            host.write(&contract.operands()[at].name, of.operands[at]);
        };
        let count = contract.operands().len();
        (0..count).for_each(|at| write(&mut host, &wanted[0], at));
        host.set("start", 1);
        host.clock();
        for (number, this) in wanted.iter().enumerate() {
            let next = wanted.get(number + 1);
            let mut shown = Vec::new();
            for clock in 1..=this.done {
                contract.operands().iter().for_each(|operand| host.release(&operand.name));
                let at = clock as usize - 1;
                let is_last = clock == this.done;
                assert_eq!(host.value("busy"), 1);
                assert_eq!(host.value("done"), u64::from(is_last), "{name}");
                if host.value("valid") == 1 {
                    let outputs = contract.outputs().iter();
                    shown.extend(outputs.map(|output| host.raw(&output.name)));
                }
                if let Some(next) = next {
                    let now = if is_last {
                        at.min(count)..count
                    } else {
                        at.min(count)..(at + 1).min(count)
                    };
                    now.for_each(|at| write(&mut host, next, at));
                }
                // Before the last clock it is not heard.
                let ignored = clock % 2 == 0;
                let start = if is_last { next.is_some() } else { ignored };
                host.set("start", u64::from(start));
                host.clock();
            }
            let results: Vec<i64> = this.results.iter().flat_map(|it| it.outputs.clone()).collect();
            assert_eq!(shown, results, "{name}, {:?}", this.operands);
        }
        assert_eq!(host.value("busy"), 0);
    }
}

/// Why a register's description with this second microinstruction is refused.
fn refused(buffer_first: bool, wait: bool) -> String {
    let d = Designer::new("copy");
    if buffer_first {
        d.buffer_operands();
    }
    let x = d.operand("x", Format::unsigned(0, 8));
    if !buffer_first {
        d.buffer_operands();
    }
    let y = d.register("y", Format::unsigned(0, 8));
    y.takes(x.q());
    d.output("y_out", y.q());
    let second = if wait { step("wait", [wait_for_start()]) } else { step("pause", []) };
    d.microprogram([
        step("idle", []),
        second,
        step("copy", [y.load()]),
        step("show", [valid(), end()]),
    ]);
    d.finish().err().map_or_else(String::new, |diagnostics| diagnostics.to_string())
}

#[test]
fn buffers_that_cannot_be_are_refused_with_their_place() {
    assert_eq!(refused(true, false), "");
    let late = refused(false, false);
    assert!(late.contains("declared before its buffer"), "{late}");
    let waits = refused(true, true);
    assert!(
        waits.contains("`wait` waits for `start`") && waits.contains("operand_buffers.rs"),
        "{waits}"
    );
}
