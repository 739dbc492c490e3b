//! Generates FuseSoC cores (CAPI2): one for the device, and one for the bench. A core may only list files beside it, so the
//! bench has a core of its own.

use anyhow::Result;
use glint_base::fill;

use super::artifact::{ArtifactKind, Artifacts, EmitJob};
use glint_rtl::verilog::text::ascii;

/// Adds `<name>.core`, with a simulation target if there is a bench, and then `<name>_tb.core`. File names are relative to them.
///
/// # Errors
/// Fails if a template fails to print.
pub fn files(job: &EmitJob, files: &mut Artifacts) -> Result<()> {
    let (name, around) = (job.name(), &job.inputs.around);
    let (version, licence) = (around.version.as_str(), around.licence.as_str());
    let of = |kind: ArtifactKind| files.names(&[kind]);
    let (rtl, primitives, benches) =
        (of(ArtifactKind::Rtl), of(ArtifactKind::Primitive), of(ArtifactKind::Bench));
    let named = primitives.iter().filter_map(|file| Some(file.split_once('/')?.1.to_owned()));
    let replaced: Vec<String> = named.collect();
    let wrapper = |file: &String| {
        let bench = file.strip_prefix(name)?.strip_prefix('_')?.strip_suffix("_tb.v")?;
        Some(bench.to_owned())
    };
    let core = fill!("device.core" {
        name: &'a str,
        // A YAML string in single quotes; a quote in it is doubled.
        description: String = ascii(&job.design.about.title).replace('\'', "''"),
        // The Verilog of the core for all targets: none that a target has its own of.
        common: Vec<&'a String> = rtl.iter().filter(|file| !replaced.contains(file)).collect(),
        // The portable files that a target has its own of.
        replaced: &'a [String] = &replaced,
        primitives: &'a [String] = &primitives,
        wrappers: Vec<String> = of(ArtifactKind::Wrapper),
        memories: Vec<String> = of(ArtifactKind::Memory),
        // The benches beside the core's own, without `_tb`; none without it.
        benches: Option<Vec<String>> =
            (!benches.is_empty()).then(|| benches.iter().filter_map(wrapper).collect()),
        // The clock of `<name>.xdc` and `<name>.sdc`, if these files exist.
        clock_mhz: Option<f64> = around.clock_mhz,
        vendor: &'a str = &around.vendor,
        version: &'a str,
        licence: &'a str,
    })?;
    files.add(ArtifactKind::Core, format!("{name}.core"), core);
    if let Some((bench, others)) = benches.split_first() {
        let text = fill!("testbench.core" {
            name: &'a str, vendor: &'a str = &around.vendor, version: &'a str, licence: &'a str, bench: &'a str,
            // Its vectors, and the benches of wrappers with theirs.
            others: &'a [String],
        })?;
        files.add(ArtifactKind::BenchCore, format!("{name}_tb.core"), text);
    }
    Ok(())
}
