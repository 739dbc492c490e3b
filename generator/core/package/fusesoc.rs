//! Generates the FuseSoC core files (CAPI2): `<name>.core` for the device, and `<name>_tb.core` for its bench.
//!
//! FuseSoC lets a core file list only files in its own directory or below, and the bench is in another directory.

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use super::tops::{Face, Top};
use glint_rtl::verilog::text::ascii;

/// Adds `<name>.core` and, if there is a bench, `<name>_tb.core`. With a bench, `<name>.core` has a target for simulation. The
/// file names in a core file are relative to the file's directory.
pub fn files(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let (name, around) = (job.name(), &job.inputs.around);
    let (version, licence) = (around.version.as_str(), around.licence.as_str());
    let rtl = files.local_paths(&[FileKind::CoreVerilog]);
    let primitives = files.local_paths(&[FileKind::TargetVerilog]);
    let forms = files.of(&[FileKind::TargetVerilog]);
    let replaced: Vec<String> = forms.iter().map(|file| file.name().to_owned()).collect();
    let benches = files.local_paths(FileKind::BENCH_SOURCES);
    let core = fill!("device.core" {
        name: &'a str,
        // A YAML string in single quotes; a quote in it is doubled.
        description: String = ascii(&job.design.about.title).replace('\'', "''"),
        // The Verilog files of the core that are the same for all targets.
        common: Vec<&'a String> = rtl.iter().filter(|file| !replaced.contains(file)).collect(),
        // The portable Verilog files that a target replaces by its own version.
        replaced: &'a [String] = &replaced,
        primitives: &'a [String] = &primitives,
        wrappers: Vec<String> = files.local_paths(FileKind::WRAPPERS),
        memories: Vec<String> = files.local_paths(&[FileKind::Memory]),
        // The suffixes of the wrappers that have a bench.
        benches: Option<Vec<&'static str>> = wrapper_benches(tops, files),
        // The clock of `<name>.xdc` and `<name>.sdc`, if these files exist.
        clock_mhz: Option<f64> = around.clock_mhz,
        vendor: &'a str = &around.vendor,
        version: &'a str,
        licence: &'a str,
    })?;
    files.add(FileKind::CorePackage, format!("{name}.core"), core);
    if let Some((bench, others)) = benches.split_first() {
        let text = fill!("testbench.core" {
            name: &'a str, vendor: &'a str = &around.vendor, version: &'a str, licence: &'a str, bench: &'a str,
            // The vectors of the core's bench, and the benches of the wrappers with their vectors.
            others: &'a [String],
        })?;
        files.add(FileKind::BenchPackage, format!("{name}_tb.core"), text);
    }
    Ok(())
}

/// Returns the suffixes of the wrappers that have a bench, for example `axis` and `axil`. Returns `None` if neither the core
/// nor a wrapper has a bench.
fn wrapper_benches(tops: &[Top], files: &OutputFiles) -> Option<Vec<&'static str>> {
    let benches = files.modules(&[FileKind::Bench]);
    if benches.is_empty() {
        return None;
    }
    let mut wrappers = Vec::new();
    for top in tops {
        let bench = format!("{}_tb", top.module);
        if top.face != Face::Core && benches.contains(&bench.as_str()) {
            wrappers.push(top.suffix);
        }
    }
    Some(wrappers)
}
