//! FuseSoC cores (CAPI2): the device, and the bench in a core of its own, because a core may only
//! list files beside it.

use anyhow::Result;
use askama::Template;

use super::EmitInputs;
use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::ascii;

/// The core of the device.
#[derive(Template)]
#[template(path = "device.core")]
struct DeviceCore<'a> {
    name: &'a str,
    description: String,
    sources: Sources<'a>,
    /// The benches beside the core's own, without `_tb`; none without it.
    benches: Option<&'a [String]>,
    /// That of `<name>.xdc` and `<name>.sdc`, if there are any.
    clock_mhz: Option<f64>,
    version: &'a str,
    licence: &'a str,
}

/// The files of a device beside its core; all but Verilog may be none.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// Verilog, the top module first.
    pub rtl: &'a [String],
    /// Verilog of a target, `<target>/<file>`, in place of the file of that name in `rtl`.
    pub primitives: &'a [String],
    /// Verilog around it.
    pub wrappers: &'a [String],
    /// ROM contents.
    pub memories: &'a [String],
}

impl Sources<'_> {
    /// The Verilog of the core for all targets: none that a target has its own of.
    fn common(&self) -> impl Iterator<Item = &String> {
        self.rtl.iter().filter(|file| !self.replaced().any(|it| it == *file))
    }

    /// The portable files that a target has its own of.
    fn replaced(&self) -> impl Iterator<Item = &str> {
        self.primitives.iter().filter_map(|file| Some(file.split_once('/')?.1))
    }
}

/// The core of the bench.
#[derive(Template)]
#[template(path = "testbench.core")]
struct BenchCore<'a> {
    name: &'a str,
    version: &'a str,
    licence: &'a str,
    bench: &'a str,
    /// Its vectors, and the benches of wrappers with theirs.
    others: &'a [String],
}

/// `<name>.core`; with a simulation target if there is a bench. File names are relative to it.
///
/// # Errors
/// A template that fails to print.
pub fn device(
    design: &Design,
    inputs: &EmitInputs,
    sources: Sources,
    benches: Option<&[String]>,
) -> Result<String> {
    // A YAML string in single quotes; a quote in it is doubled.
    let description = ascii(&design.about.title).replace('\'', "''");
    super::render(&DeviceCore {
        name: &design.name,
        description,
        sources,
        benches,
        clock_mhz: inputs.around.clock_mhz,
        version: &inputs.around.version,
        licence: &inputs.around.licence,
    })
}

/// `<name>_tb.core`. File names are relative to it.
///
/// # Errors
/// A template that fails to print.
pub fn bench(
    design: &Design,
    inputs: &EmitInputs,
    bench: &str,
    others: &[String],
) -> Result<String> {
    let (version, licence) = (&inputs.around.version, &inputs.around.licence);
    super::render(&BenchCore { name: &design.name, version, licence, bench, others })
}
