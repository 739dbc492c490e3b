//! What stands between a core and a system: wrappers in Verilog, and what is proved of them.

mod fields;
mod pipeline;
mod stream;

use anyhow::Result;

use super::EmitInputs;
use crate::hdl::netlist::Design;

/// The wrappers that a configuration asks for: pairs of a plain name and its text.
#[derive(Default)]
pub struct Wrappers {
    /// Verilog.
    pub rtl: Vec<(String, String)>,
    /// What is proved of it, for formal tools alone.
    pub formal: Vec<(String, String)>,
}

/// The wrappers that the configuration asks for.
///
/// # Errors
/// A core that they do not fit.
pub fn wrappers(design: &Design, inputs: &EmitInputs) -> Result<Wrappers> {
    let mut made = Wrappers::default();
    if inputs.around.stream {
        let one = match &design.pipeline {
            Some(pipeline) => pipeline::wrapper(design, pipeline, inputs)?,
            None => stream::wrapper(design, inputs)?,
        };
        made.rtl.extend(one.rtl);
        made.formal.extend(one.formal);
    }
    Ok(made)
}
