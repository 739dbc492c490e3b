//! Everything that the report shows, measured when it is made; `report.json` is this.

pub mod advice;
pub mod benchmark;
pub mod chart;
pub mod claims;
pub mod comparison;
pub mod curves;
pub mod domain;
pub mod hardware;
pub mod measure;
pub mod overview;
pub mod seed_plots;

use anyhow::{Result, bail};
use rayon::prelude::*;
use serde::Serialize;

use claims::{Claim, Verdict};
use curves::DeviceCurves;
use glint_core::registry::Registry;
use hardware::{Hardware, Synthesis};
use seed_plots::{RequiredPowers, Rom9Word, SeedPlot};

/// The report's contents. The same program and tools give the same; no timing is in it.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// The version of Glint.
    pub glint: &'static str,
    /// The ledger.
    pub claims: Vec<Claim>,
    /// The seeds' plots.
    pub plots: Vec<SeedPlot>,
    /// Powers for a required accuracy.
    pub power_table: Vec<RequiredPowers>,
    /// All devices in one chart each.
    pub overview: Vec<chart::Chart>,
    /// Error curves of every device.
    pub devices: Vec<DeviceCurves>,
    /// W and Schlick's function synthesised, if that was asked for and possible.
    pub hardware: Option<Hardware>,
    /// ROM 9's map.
    pub rom_9: Vec<Rom9Word>,
    /// Measurements that failed.
    pub notes: Vec<String>,
}

/// The steps of work that [`gather`] reports as done.
pub fn steps(registry: &Registry, synthesis: bool) -> usize {
    let hardware = if synthesis { hardware::STEPS } else { 0 };
    2 + registry.devices().len() * curves::STEPS + hardware
}

/// Measures everything, on all processors.
///
/// # Errors
/// Synthesis fails.
pub fn gather(
    registry: &Registry,
    synthesis: Option<&dyn Synthesis>,
    done: &(dyn Fn() + Sync),
) -> Result<Evidence> {
    let (hardware, (devices, (mut claims, (plots, power_table)))) = rayon::join(
        || match synthesis {
            Some(synthesis) => hardware::synthesised(registry, synthesis, done),
            None => Ok(None),
        },
        || {
            let devices = registry.devices().par_iter();
            rayon::join(
                || -> Vec<DeviceCurves> {
                    devices.map(|device| curves::device(device, done)).collect()
                },
                || {
                    let ledger = claims::ledger();
                    done();
                    let plots = (seed_plots::plots(), seed_plots::power_table());
                    done();
                    (ledger, plots)
                },
            )
        },
    );
    let hardware = hardware?;
    claims.push(simpler(hardware.as_ref()));
    claims.push(faster());
    if let Some(claim) = claims.iter().find(|claim| claim.claim.is_empty()) {
        bail!("claims.toml has no text of the claim `{}`", claim.id);
    }
    let notes = devices
        .iter()
        .filter(|device| device.exponents.is_empty())
        .map(|device| {
            format!(
                "{}: its contract does not say which operands stand for an angle and an exponent, so that it has no \
                 curves.",
                device.device
            )
        })
        .collect();
    let overview = overview::charts(registry, &devices)?;
    Ok(Evidence {
        glint: env!("CARGO_PKG_VERSION"),
        claims,
        plots: plots?,
        power_table,
        overview,
        devices,
        hardware,
        rom_9: seed_plots::rom_9(),
        notes,
    })
}

/// The claim of simplicity, with what synthesis says.
fn simpler(hardware: Option<&Hardware>) -> Claim {
    let (verdict, words) = match hardware {
        Some(hardware) if hardware.simpler => (Verdict::Holds, hardware.words.clone()),
        Some(hardware) => (Verdict::Depends, hardware.words.clone()),
        None => (
            Verdict::Elsewhere,
            "Not measured in this report: it needs Yosys, and both devices.".to_owned(),
        ),
    };
    let ours = hardware.map_or_else(Vec::new, Hardware::measured);
    claims::claim("simpler", ours, verdict, &[("words", words)])
}

/// The claim of speed, whose figures stand apart.
fn faster() -> Claim {
    claims::claim("faster", Vec::new(), Verdict::Elsewhere, &[])
}
