//! "Simpler in hardware": W and Schlick's function, each as the device of the catalogue with its defaults.

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::Serialize;

use super::claims::Measured;
use super::comparison;
use glint_base::target::{FAMILIES, Family, Usage};
use glint_core::core::Core;
use glint_core::registry::Registry;

/// W, whose default power is 16, and its rival.
const RIVALS: [&str; 2] = ["cosine-power", "schlick"];

/// The exponent at which clocks are counted.
const EXPONENT: f64 = 35.0;

/// A synthesis tool.
pub trait Synthesis: Sync {
    /// Returns its version, for people.
    ///
    /// # Errors
    /// It does not say.
    fn version(&self) -> Result<String>;

    /// Returns what the module `top` of these files, pairs of a plain name and contents, takes of a family.
    ///
    /// # Errors
    /// It fails, or takes too long.
    fn usage(&self, files: &[(String, String)], top: &str, family: &Family) -> Result<Usage>;
}

/// The steps of work that [`synthesised`] reports as done.
pub const STEPS: usize = RIVALS.len() * FAMILIES.len();

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

/// The cells of a family that a device takes, before placement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyUsage {
    /// The family.
    pub family: &'static str,
    /// Look-up tables.
    pub luts: u64,
    /// DSP blocks.
    pub dsps: u64,
    /// Block RAMs.
    pub block_rams: u64,
}

impl Hardware {
    /// The figures for the ledger.
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

/// Synthesises both devices for every family; `None` when the registry lacks one of them.
///
/// # Errors
/// Synthesis fails.
pub fn synthesised(
    registry: &Registry,
    synthesis: &dyn Synthesis,
    done: &(dyn Fn() + Sync),
) -> Result<Option<Hardware>> {
    let Some(rivals) =
        RIVALS.map(|name| registry.device(name)).into_iter().collect::<Option<Vec<_>>>()
    else {
        return Ok(None);
    };
    let cores: Vec<Core> = rivals
        .into_iter()
        .map(|device| Core::new(*device, device.defaults()))
        .collect::<Result<_>>()?;
    let files: Vec<_> = cores.iter().map(Core::verilog).collect::<Result<_>>()?;
    let usage: Vec<FamilyUsage> = (0..STEPS)
        .into_par_iter()
        .map(|step| {
            let (one, family) = (step / FAMILIES.len(), &FAMILIES[step % FAMILIES.len()]);
            let usage = take(synthesis, &files[one], &cores[one].config.name, family);
            done();
            usage
        })
        .collect::<Result<_>>()?;
    let devices: Vec<Rival> = cores
        .iter()
        .zip(usage.chunks(FAMILIES.len()))
        .map(|(core, usage)| {
            let contract = core.contract.as_ref();
            let clocks = comparison::clocks_per_point(&core.design, contract, EXPONENT)?;
            let multipliers = comparison::multipliers(&core.design);
            Ok(Rival {
                device: core.device.name.to_owned(),
                clocks_per_point: clocks,
                multipliers: multipliers.iter().map(ToString::to_string).collect(),
                usage: usage.to_vec(),
            })
        })
        .collect::<Result<_>>()?;
    let (simpler, words) = outcome(&devices[0], &devices[1]);
    Ok(Some(Hardware { tool: synthesis.version()?, devices, simpler, words }))
}

/// Returns the cells of a family that the design `top` takes.
fn take(
    synthesis: &dyn Synthesis,
    files: &[(String, String)],
    top: &str,
    family: &Family,
) -> Result<FamilyUsage> {
    let usage = synthesis
        .usage(files, top, family)
        .with_context(|| format!("{top} for {}", family.title))?;
    Ok(FamilyUsage {
        family: family.title,
        luts: usage.luts,
        dsps: usage.dsps,
        block_rams: usage.block_rams,
    })
}

/// Returns the cells that one configuration takes of every family; `done` is called after each.
///
/// # Errors
/// Synthesis fails.
pub fn usage(
    core: &Core,
    synthesis: &dyn Synthesis,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<FamilyUsage>> {
    let files = core.verilog()?;
    let families = FAMILIES.par_iter();
    families
        .map(|family| {
            let usage = take(synthesis, &files, &core.config.name, family);
            done();
            usage
        })
        .collect()
}

/// Whether W takes no more of anything, and that in words.
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
