//! Measures everything that the report shows: the claims and the plots of the sources, and the error curves of the devices.
//!
//! `report.json` has the fields of [`Evidence`].

pub mod benchmark;
pub mod claims;
mod measure;
mod overview;
pub mod page;
mod rivals;
mod seed_plots;

use anyhow::{Result, bail};
use rayon::prelude::*;
use serde::Serialize;

use claims::{Claim, Verdict};
use glint::evidence::chart::Chart;
use glint::evidence::curves::{self, DeviceCurves};
use glint::evidence::hardware::Synthesis;
use glint::registry::Registry;
use rivals::Hardware;
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
    pub overview: Vec<Chart>,
    /// Error curves of every device.
    pub devices: Vec<DeviceCurves>,
    /// W and Schlick's function synthesised, if that was asked for and possible.
    pub hardware: Option<Hardware>,
    /// ROM 9's map.
    pub rom_9: Vec<Rom9Word>,
    /// Measurements that failed.
    pub notes: Vec<String>,
}

/// Measures everything, on all processors.
///
/// # Errors
/// Synthesis fails.
pub fn gather(registry: &Registry, synthesis: Option<&dyn Synthesis>) -> Result<Evidence> {
    let hardware = synthesis.map(|it| rivals::synthesised(registry, it)).transpose()?;
    let devices = registry.devices().par_iter();
    let devices: Vec<DeviceCurves> = devices.map(|it| curves::device(it, &|| ())).collect();
    let mut claims = claims::ledger();
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
        plots: seed_plots::plots()?,
        power_table: seed_plots::power_table(),
        overview,
        devices,
        hardware,
        rom_9: seed_plots::rom_9(),
        notes,
    })
}

/// Returns the claim of simplicity, with what synthesis says.
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

/// Returns the claim of speed, whose figures stand apart.
fn faster() -> Claim {
    claims::claim("faster", Vec::new(), Verdict::Elsewhere, &[])
}
