//! `<name>_multiplier.v`: a product with a register at its output, for all tools and for those of a target.
//!
//! The portable form stands among the Verilog of the core. A target's own stands in a directory of the target,
//! under the same name, and takes the place of the portable one in its flow alone.

use anyhow::Result;
use askama::Template;

use super::EmitInputs;
use crate::hdl::netlist::Design;
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::rows::separated;

/// Bits of a factor of the block.
const WIDTH: usize = 18;

#[derive(Template)]
#[template(path = "multiplier.v")]
struct Portable<'a> {
    name: String,
    regenerate: &'a str,
}

#[derive(Template)]
#[template(path = "multiplier_ecp5.v")]
struct Ecp5<'a> {
    name: String,
    regenerate: &'a str,
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
    let (name, regenerate) = (naming.multiplier(), inputs.config.as_str());
    let file = format!("{name}.v");
    let portable = super::render(&Portable { name: name.clone(), regenerate })?;
    let own = super::render(&Ecp5 { name, regenerate, pins: pins() })?;
    Ok(Some(Multiplier {
        primitives: vec![(format!("{}/{file}", pipeline.target), own)],
        portable: (file, portable),
    }))
}

/// Every pin of factors, the unused one between them, and product, six a line.
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
    pins.chunks(6).map(|line| line.join(" ")).collect()
}
