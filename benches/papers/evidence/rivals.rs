//! Measures the claim "simpler in hardware": synthesises W and Schlick's function, as the devices `cosine-power` and `schlick`
//! with default keys.

use anyhow::{Context, Result};
use serde::Serialize;

use super::claims::Measured;
use glint::core::Core;
use glint::evidence::comparison;
use glint::evidence::hardware::{FamilyUsage, Synthesis, usage};
use glint::registry::Registry;
use glint::target::FAMILIES;

/// W, whose default power is 16, and its rival.
const RIVALS: [&str; 2] = ["cosine-power", "schlick"];

/// The exponent at which clocks are counted.
const EXPONENT: f64 = 35.0;

/// The area of both devices.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hardware {
    /// The tool that synthesised.
    pub tool: String,
    /// In the order W, Schlick.
    pub devices: Vec<Rival>,
    /// Whether W takes no more of anything.
    pub simpler: bool,
    /// The outcome in a sentence.
    pub words: String,
}

/// One of the two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rival {
    /// The device.
    pub device: String,
    /// From one `start` to the next.
    pub clocks_per_point: f64,
    /// The multipliers of the design.
    pub multipliers: Vec<String>,
    /// By family of FPGAs.
    pub usage: Vec<FamilyUsage>,
}

impl Hardware {
    /// Returns the figures for the ledger.
    pub fn measured(&self) -> Vec<Measured> {
        let pair = |key: String, definition: String, value: &dyn Fn(&Rival) -> f64| {
            let values: Vec<f64> = self.devices.iter().map(value).collect();
            let texts: Vec<String> = values.iter().map(f64::to_string).collect();
            Measured {
                key,
                definition,
                value: values[0] / values[1],
                text: texts.join(" for "),
                n: None,
            }
        };
        let mut found =
            vec![pair("clocks".to_owned(), "clocks a point, W for Schlick".to_owned(), &|rival| {
                rival.clocks_per_point
            })];
        for (at, family) in FAMILIES.iter().enumerate() {
            found.push(pair(
                format!("luts-{}", family.name()),
                format!("LUTs in {}, W for Schlick", family.title),
                &|rival| rival.usage[at].luts as f64,
            ));
        }
        found
    }
}

/// Synthesises both devices for every family.
///
/// # Errors
/// Synthesis fails.
pub fn synthesised(registry: &Registry, synthesis: &dyn Synthesis) -> Result<Hardware> {
    let rival = |name: &str| {
        let device = registry.device(name).context("a device of the catalogue")?;
        let core = Core::new(*device, device.defaults())?;
        let contract = core.contract.as_ref();
        let multipliers = comparison::multipliers(&core.design);
        Ok(Rival {
            device: device.name.to_owned(),
            clocks_per_point: comparison::clocks_per_point(&core.design, contract, EXPONENT)?,
            multipliers: multipliers.iter().map(ToString::to_string).collect(),
            usage: usage(&core, synthesis, &|| ())?,
        })
    };
    let devices = RIVALS.into_iter().map(rival).collect::<Result<Vec<Rival>>>()?;
    let (simpler, words) = outcome(&devices[0], &devices[1]);
    Ok(Hardware { tool: synthesis.version()?, devices, simpler, words })
}

/// Returns whether W takes no more of anything, and that in words.
fn outcome(w: &Rival, schlick: &Rival) -> (bool, String) {
    let pairs = || w.usage.iter().zip(&schlick.usage);
    let more: Vec<String> = pairs()
        .flat_map(|(w, schlick)| {
            [
                ("LUTs", w.luts, schlick.luts),
                ("DSP blocks", w.dsps, schlick.dsps),
                ("block RAMs", w.block_rams, schlick.block_rams),
            ]
            .into_iter()
            .filter(|(_, w, schlick)| w > schlick)
            .map(|(what, ours, theirs)| format!("{ours} {what} for {theirs} in {}", w.family))
        })
        .collect();
    let clocks = format!(
        "W takes {} clocks a point, Schlick's function {}",
        w.clocks_per_point, schlick.clocks_per_point
    );
    let simpler = more.is_empty() && w.clocks_per_point <= schlick.clocks_per_point;
    let words = if more.is_empty() {
        format!("{clocks}, and W takes no more of any resource of any family.")
    } else {
        format!(
            "{clocks}. A divider of one bit a clock costs no multiplier and few LUTs: W takes more of some \
             ({}), and no more of the others.",
            more.join(", ")
        )
    };
    (simpler, words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rival(clocks_per_point: f64, luts: u64) -> Rival {
        Rival {
            device: String::new(),
            clocks_per_point,
            multipliers: Vec::new(),
            usage: vec![FamilyUsage { family: "iCE40", luts, dsps: 4, block_rams: 0 }],
        }
    }

    #[test]
    fn simpler_is_no_more_of_anything() {
        assert!(outcome(&rival(8.0, 100), &rival(14.0, 100)).0);
        assert!(!outcome(&rival(8.0, 100), &rival(7.0, 200)).0);
        let (simpler, words) = outcome(&rival(8.0, 101), &rival(14.0, 100));
        assert!(!simpler && words.contains("101 LUTs for 100 in iCE40"), "{words}");
    }
}
