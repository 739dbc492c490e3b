//! Compares the hardware of the device with its golden model, and with numbers that were worked out by hand.

use anyhow::Result;
use glint::core::Core;
use parabola_device::DEVICE;

fn core() -> Result<Core> {
    Core::new(DEVICE, DEVICE.defaults())
}

/// Compares every register and every output with the golden model on every clock, and checks that no error exceeds the bound of
/// the contract.
#[test]
fn golden_model_and_hardware_agree() -> Result<()> {
    let core = core()?;
    let outcome = core.lockstep(1)?.run(10_000, &|_| {})?;
    assert_eq!(outcome.failures(&core.contract.bounds()), Vec::<String>::new());
    Ok(())
}

/// Checks one result: 0.5² is 0.25. With 12 fraction bits, the raw values are 2048 and 1024.
#[test]
fn half_of_a_half_is_a_quarter() -> Result<()> {
    let mut outputs = Vec::new();
    core()?.contract.results(&[2048], 0, &mut outputs);
    assert_eq!(outputs, [1024]);
    Ok(())
}
