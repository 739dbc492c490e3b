//! `<name>_multiplier.v`: a product with a register at its output, for all tools and for those of a target.
//!
//! The portable form stands among the Verilog of the core. A target's own stands in a directory of the target,
//! under the same name, and takes the place of the portable one in its flow alone.

use anyhow::Result;
use askama::Template;

use super::EmitInputs;
use crate::hdl::netlist::Design;
use crate::hdl::verilog::header;
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::rows::separated;
use crate::hdl::verilog::text::comment;

/// Bits of a factor of the block.
const WIDTH: usize = 18;

const PORTABLE: &str = "The portable form, for simulators and synthesis alike. On ECP5 the file of the same name in \
                        ecp5/ takes its place: there the register is that of the DSP block.";

const ECP5: &str = "For ECP5: a DSP block with its output register and no other. nextpnr-ecp5 times the ways into the \
                    block, which end in that register, and those from it. The portable form is in the directory above.";

#[derive(Template)]
#[template(path = "multiplier.v")]
struct Portable {
    /// Comment lines.
    header: Vec<String>,
    name: String,
}

#[derive(Template)]
#[template(path = "multiplier_ecp5.v")]
struct Ecp5 {
    /// Comment lines.
    header: Vec<String>,
    name: String,
    /// Connections of factors and product, some a line.
    pins: Vec<String>,
}

/// The module in its forms.
pub struct Multiplier {
    /// For all tools: a plain name and its text.
    pub portable: (String, String),
    /// In the directory of a target: `ecp5/<name>_multiplier.v`.
    pub primitives: Vec<(String, String)>,
}

/// The module of a design's products, if any of its registers is inside a multiplier.
///
/// # Errors
/// A template that fails to print.
pub fn multiplier(
    design: &Design,
    naming: &Naming,
    inputs: &EmitInputs,
) -> Result<Option<Multiplier>> {
    let Some(pipeline) = design.pipeline.as_ref().filter(|it| !it.registered.is_empty()) else {
        return Ok(None);
    };
    let name = naming.multiplier();
    let file = format!("{name}.v");
    let title = format!("{name}: a product, and the register that takes it while `enable` is high");
    let header = |form: &str| {
        let separate = || ["//".to_owned()];
        let lines = comment(0, &title).into_iter().chain(separate()).chain(comment(0, form));
        lines.chain(header::regenerated(&inputs.origin())).collect()
    };
    let portable = super::render(&Portable { header: header(PORTABLE), name: name.clone() })?;
    let own = super::render(&Ecp5 { header: header(ECP5), name, pins: pins() })?;
    Ok(Some(Multiplier {
        primitives: vec![(format!("{}/{file}", pipeline.target), own)],
        portable: (file, portable),
    }))
}

/// Every pin of factors, the unused one between them, and product, five a line.
fn pins() -> Vec<String> {
    let bus = |pin: char, width: usize, net: &'static str| {
        (0..width).map(move |bit| match net {
            "" => format!(".{pin}{bit}(1'b0)"),
            net => format!(".{pin}{bit}({net}[{bit}])"),
        })
    };
    let pins = bus('A', WIDTH, "a_wide")
        .chain(bus('B', WIDTH, "b_wide"))
        .chain(bus('C', WIDTH, ""))
        .chain(bus('P', 2 * WIDTH, "whole"));
    let pins = separated(pins.collect());
    pins.chunks(5).map(|line| line.join(" ")).collect()
}
