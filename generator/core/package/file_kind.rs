//! Lists the kinds of files that Glint emits for a core, for example Verilog, memory contents, benches and constraints.
//!
//! The kind of a file decides its folder, and its position in the list of files.

use FileKind::{
    Bench, BenchPackage, BenchVectors, BusWrapper, CocotbBench, CocotbDriver, Constraint,
    CorePackage, CoreProof, CoreProofScript, CoreVerilog, Manifest, Memory, Recomputation,
    Software, StreamWrapper, SystemVerilogPackage, TargetVerilog, VendorScript, Vhdl, WrapperProof,
    WrapperProofScript,
};

/// The purpose of an emitted file, such as Verilog of the core. Lists of a core's files follow the order of the kinds here;
/// a few kinds are listed among the files of another kind (`listed_with`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileKind {
    /// Verilog of the core, the top module first. For example, `rough.v`, `rough_control.v` and `rough_datapath.v`.
    CoreVerilog,
    /// Verilog of the core for one target, in place of the file of the same name for all targets. For example,
    /// `ecp5/blinn_pipelined_multiplier.v`.
    TargetVerilog,
    /// Verilog that puts the core between two AXI4-Streams, the top module first. For example, `rough_axis.v`.
    StreamWrapper,
    /// Verilog that puts the core behind registers on a bus, the top module first. For example, `rough_axil.v` and
    /// `rough_registers.v`.
    BusWrapper,
    /// ROM contents. For example, `rough_sine.mem`.
    Memory,
    /// The FuseSoC core of the device. For example, `rough.core`.
    CorePackage,
    /// Timing constraints. For example, `rough.sdc`.
    Constraint,
    /// Scripts and descriptions for vendors' tools. For example, `rough_vivado.tcl`.
    VendorScript,
    /// Components and an entity for designs in VHDL. For example, `rough.vhd`.
    Vhdl,
    /// Formats and functions for designs in SystemVerilog. For example, `rough_pkg.sv`.
    SystemVerilogPackage,
    /// Benches in Python. The bench of the core comes first. For example, `test_rough.py`.
    CocotbBench,
    /// Properties of a wrapper in SystemVerilog. For example, `rough_axis_formal.sv`.
    WrapperProof,
    /// The Yosys commands that make a [`FileKind::WrapperProof`] a problem for a solver. For example, `rough_axis_formal.ys`.
    WrapperProofScript,
    /// Properties of the core in SystemVerilog. For example, `rough_formal.sv`.
    CoreProof,
    /// The Yosys commands that make a [`FileKind::CoreProof`] a problem for a solver, and the task of SymbiYosys. For example,
    /// `rough_formal.ys` and `rough_formal.sby`.
    CoreProofScript,
    /// Benches in Verilog. The bench of the core comes first. For example, `rough_tb.v`.
    Bench,
    /// Stimulus and expected outputs of benches in Verilog. For example, `rough_stimulus.mem` and `rough_expected.mem`.
    BenchVectors,
    /// The FuseSoC core of the benches. For example, `rough_tb.core`.
    BenchPackage,
    /// The model in C, and the other files for software. For example, `rough_model.c`.
    Software,
    /// The program in C that recomputes the results of every combination of operands. For example, `rough_recompute.c`.
    Recomputation,
    /// The manifest, which has the digests of all files above. For example, `rough.json`.
    Manifest,
    /// The driver that the benches in Python of all configurations share, `glint_cocotb.py`.
    CocotbDriver,
}

impl FileKind {
    /// The files of the core that synthesis tools and simulators read.
    pub const CORE_SOURCES: &[Self] = &[CoreVerilog, Memory];

    /// The files of the core and of its wrappers that synthesis tools and simulators read.
    pub const DESIGN_SOURCES: &[Self] = &[CoreVerilog, StreamWrapper, BusWrapper, Memory];

    /// The files of the benches in Verilog.
    pub const BENCH_SOURCES: &[Self] = &[Bench, BenchVectors];

    /// The files that a simulator of Verilog reads: the core, its wrappers and the benches.
    pub const SIMULATED: &[Self] =
        &[CoreVerilog, StreamWrapper, BusWrapper, Memory, Bench, BenchVectors];

    /// Returns the folder in the output directory that contains the files of this kind, in a folder for each configuration. For
    /// example, [`FileKind::Memory`] gives `rtl_out`, and the memories of `rough` are in `rtl_out/rough/`. Only the driver that
    /// all configurations share, [`FileKind::CocotbDriver`], is in the folder itself.
    pub fn folder(self) -> &'static str {
        match self {
            CoreVerilog | TargetVerilog | StreamWrapper | BusWrapper | Memory | CorePackage
            | Constraint | VendorScript | Vhdl | SystemVerilogPackage | Manifest => "rtl_out",
            CocotbBench | WrapperProof | WrapperProofScript | CoreProof | CoreProofScript
            | Bench | BenchVectors | BenchPackage | CocotbDriver => "testbench",
            Software | Recomputation => "software",
        }
    }

    /// Returns whether the files of this kind are Verilog that simulators, linters and synthesis tools compile. Files in
    /// SystemVerilog are not among them.
    pub fn is_verilog(self) -> bool {
        matches!(self, CoreVerilog | TargetVerilog | StreamWrapper | BusWrapper | Bench)
    }

    /// Returns the kind that decides the position of a file of this kind in the list of a core's files. For example,
    /// [`FileKind::BenchVectors`] gives [`FileKind::Bench`], so that the vectors of a bench follow the bench directly:
    /// `rough_tb.v`, `rough_stimulus.mem`, `rough_expected.mem`, `rough_axis_tb.v`.
    pub(super) fn listed_with(self) -> Self {
        match self {
            WrapperProofScript => WrapperProof,
            CoreProofScript => CoreProof,
            BenchVectors => Bench,
            Recomputation => Software,
            other => other,
        }
    }
}
