//! Generates `<name>_multiplier.v`: a multiplier with an output register, for pipelines whose key `pipeline.multipliers` is
//! "registered".
//!
//! There are two files with the same module name. The portable file is ordinary Verilog. The file for a target, which is always
//! ECP5, instantiates the target's DSP block and is in a directory with the target's name. A build for ECP5 uses this file in
//! place of the portable file.

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use glint_rtl::verilog::header;
use glint_rtl::verilog::rows::separated;
use glint_rtl::verilog::text::comment;

/// The number of bits of each factor of the DSP block.
const WIDTH: usize = 18;

const PORTABLE: &str = "This is the portable form, for simulation and synthesis. For ECP5, use the file of the \
                        same name in ecp5/ instead: there the register is the output register of the DSP \
                        block.";

const ECP5: &str = "This is the form for ECP5: a DSP block in which only the output register is used. \
                    nextpnr-ecp5 times the paths into the block, which end in that register, and the paths \
                    from the register. The portable form is in the directory above.";

/// Adds both files if the pipeline has registered multipliers, and otherwise nothing.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let Some(pipeline) = job.design.pipeline.as_ref().filter(|it| !it.registered.is_empty()) else {
        return Ok(());
    };
    let name = job.naming.multiplier();
    let title =
        format!("{name}: a multiplier with an output register, which loads while `enable` is high");
    let header = |form: &str| -> Vec<String> {
        let mut lines = comment(0, &title);
        lines.push("//".to_owned());
        lines.extend(comment(0, form));
        lines.extend(header::regenerated(&job.inputs.origin()));
        lines
    };
    let portable =
        fill!("multiplier.v" { header: Vec<String> = header(PORTABLE), name: &'a str = &name })?;
    let own = fill!("multiplier_ecp5.v" {
        header: Vec<String> = header(ECP5), name: &'a str = &name, pins: Vec<String> = pins(),
    })?;
    files.add_verilog(FileKind::CoreVerilog, vec![name.clone()], portable);
    files.add_for_target(&pipeline.target, &name, own);
    Ok(())
}

/// Returns the connections of all data pins of the DSP block, five on a line. The pins are the factors A and B, the unused
/// input C, and the product P.
fn pins() -> Vec<String> {
    let mut pins = Vec::new();
    for (pin, width, net) in [
        ('A', WIDTH, "a_wide"),
        ('B', WIDTH, "b_wide"),
        ('C', WIDTH, ""),
        ('P', 2 * WIDTH, "whole"),
    ] {
        for bit in 0..width {
            pins.push(match net {
                "" => format!(".{pin}{bit}(1'b0)"),
                net => format!(".{pin}{bit}({net}[{bit}])"),
            });
        }
    }
    separated(pins).chunks(5).map(|line| line.join(" ")).collect()
}
