//! Makes two charts with all devices that have error curves: the error against the exponent, and the error against the size of
//! the hardware.

use anyhow::{Result, bail};

use glint::evidence::chart::{Chart, ChartAxis, Series};
use glint::evidence::comparison;
use glint::evidence::curves::{AtExponent, DeviceCurves, EXPONENTS};
use glint::registry::Registry;

/// Smaller errors are shown at the bottom of the axis.
const FLOOR: f64 = 1e-5;

/// The least exponent of a highlight: below it every approximation of the catalogue but two is coarse.
const HIGHLIGHTS: u32 = 8;

/// Bits of a ROM that take about the area of one bit of a register.
const ROM_BITS: u64 = 8;

/// Returns the charts of all devices that have curves.
///
/// # Errors
/// The description of a device is refused with its default keys.
pub fn charts(registry: &Registry, devices: &[DeviceCurves]) -> Result<Vec<Chart>> {
    let shown = || devices.iter().filter(|device| !device.exponents.is_empty());
    let mut sizes = Vec::new();
    for curves in shown() {
        sizes.push((curves, largest(curves), size(registry, &curves.device)?));
    }
    Ok(vec![over_exponents(shown()), size_against_error(&sizes)])
}

fn over_exponents<'a>(devices: impl Iterator<Item = &'a DeviceCurves>) -> Chart {
    let series = devices
        .map(|device| {
            let at = |n| device.exponents.iter().find(|at| at.n == n);
            let value = |at: &AtExponent| at.whole.max(FLOOR);
            let values = EXPONENTS.iter().map(|&n| at(n).map_or(f64::NAN, value));
            Series { name: device.device.clone(), values: values.collect() }
        })
        .collect();
    Chart {
        id: "all-over-n".to_owned(),
        title: "Largest error of f against n, all devices".to_owned(),
        caption: "The word f against cos\u{207f}\u{3b3}, over all angles: what the formula, the fixed point and the \
                  operands' widths give together. f is 1 at the peak."
            .to_owned(),
        x: ChartAxis::logarithmic("n", 1.0, 1000.0),
        y: ChartAxis::logarithmic("absolute error of f", FLOOR, 1.0),
        places: EXPONENTS.iter().map(|&n| f64::from(n)).collect(),
        series,
        marks: Vec::new(),
    }
}

/// Returns the largest error over the exponents of highlights.
fn largest(device: &DeviceCurves) -> f64 {
    let highlights = device.exponents.iter().filter(|at| at.n >= HIGHLIGHTS);
    highlights.map(|at| at.whole).fold(FLOOR, f64::max)
}

/// One-bit cells: bits of registers, of the arrays of products, and of ROMs by [`ROM_BITS`].
fn size(registry: &Registry, device: &str) -> Result<f64> {
    let Some(device) = registry.device(device) else { bail!("no device `{device}`") };
    let config = device.defaults();
    let design = device.design(&config)?;
    let registers: u32 = design.registers.iter().map(|register| design.width(register.q)).sum();
    let products: u32 =
        comparison::multipliers(&design).iter().map(|it| it.first * it.second).sum();
    Ok(f64::from(registers + products) + (design.rom_bits() / ROM_BITS) as f64)
}

fn size_against_error(sizes: &[(&DeviceCurves, f64, f64)]) -> Chart {
    let mut places: Vec<f64> = sizes.iter().map(|(_, error, _)| *error).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let series = sizes
        .iter()
        .map(|(device, error, size)| {
            let own = |place: &f64| if place == error { *size } else { f64::NAN };
            Series { name: device.device.clone(), values: places.iter().map(own).collect() }
        })
        .collect();
    Chart {
        id: "all-size-over-error".to_owned(),
        title: "Size against error, all devices".to_owned(),
        caption: format!(
            "The largest error of f over n = {HIGHLIGHTS}\u{2026}1000 and all angles. The size counts a bit of a register, a bit of a \
             product's array and {ROM_BITS} bits of ROM as one cell each: it is of the netlist, before any synthesis."
        ),
        x: ChartAxis::logarithmic("largest absolute error of f", 1e-4, 1.0),
        y: ChartAxis::logarithmic("one-bit cells", 500.0, 20_000.0),
        places,
        series,
        marks: Vec::new(),
    }
}
