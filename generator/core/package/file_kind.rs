//! Lists the kinds of files that Glint emits for a core. The kind of a file decides its folder, and its position in the list
//! of files.

use FileKind::{
    Bench, BenchPackage, BenchVectors, BusWrapper, CocotbBench, CocotbDriver, Constraint,
    CorePackage, CoreProof, CoreProofScript, CoreVerilog, Manifest, Memory, ProcessorWrapper,
    QueueWrapper, Recomputation, SingleWrapper, Software, StreamWrapper, SystemVerilogPackage,
    TargetVerilog, VendorScript, Vhdl, WrapperProof, WrapperProofScript,
};

/// Lists of a core's files follow the order of the kinds here, except for the kinds that `FileKind::listed_with` moves. The
/// file names are examples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileKind {
    /// Verilog of the core, the top module first: `rough.v`, `rough_control.v` and `rough_datapath.v`.
    CoreVerilog,
    /// Verilog of the core for one target, in place of the file of the same name for all targets:
    /// `ecp5/blinn_pipelined_multiplier.v`.
    TargetVerilog,
    /// Verilog that puts the core between two AXI4-Streams, the top module first: `rough_axis.v`.
    StreamWrapper,
    /// Verilog that puts the core behind registers on a bus, the top module first: `rough_axil.v` and
    /// `rough_registers.v`.
    BusWrapper,
    /// Verilog by which a processor calls the core: `rough_cfu.v`.
    ProcessorWrapper,
    /// Verilog that computes one point at a time with a pipeline, for bus registers and processors:
    /// `rough_single.v`.
    SingleWrapper,
    /// Verilog that computes several points at a time with a pipeline, for bus registers: `rough_queue.v`.
    QueueWrapper,
    /// ROM contents: `rough_sine.mem`.
    Memory,
    /// The FuseSoC core of the device: `rough.core`.
    CorePackage,
    /// Timing constraints: `rough.sdc`.
    Constraint,
    /// Scripts and descriptions for vendors' tools: `rough_vivado.tcl`.
    VendorScript,
    /// Components and an entity for designs in VHDL: `rough.vhd`.
    Vhdl,
    /// Formats and functions for designs in SystemVerilog: `rough_pkg.sv`.
    SystemVerilogPackage,
    /// Benches in Python. The bench of the core comes first: `test_rough.py`.
    CocotbBench,
    /// Properties of a wrapper in SystemVerilog: `rough_axis_formal.sv`.
    WrapperProof,
    /// The Yosys commands that make a [`FileKind::WrapperProof`] a problem for a solver: `rough_axis_formal.ys`.
    WrapperProofScript,
    /// Properties of the core in SystemVerilog: `rough_formal.sv`.
    CoreProof,
    /// The Yosys commands that make a [`FileKind::CoreProof`] a problem for a solver, and the task of SymbiYosys:
    /// `rough_formal.ys` and `rough_formal.sby`.
    CoreProofScript,
    /// Benches in Verilog. The bench of the core comes first: `rough_tb.v`.
    Bench,
    /// Stimulus and expected outputs of benches in Verilog: `rough_stimulus.mem` and `rough_expected.mem`.
    BenchVectors,
    /// The FuseSoC core of the benches: `rough_tb.core`.
    BenchPackage,
    /// The model in C, and the other files for software: `rough_model.c`.
    Software,
    /// The program in C that recomputes the results of every combination of operands: `rough_recompute.c`.
    Recomputation,
    /// The manifest, which has the digests of all files above: `rough.json`.
    Manifest,
    /// The driver that the benches in Python of all configurations share, `glint_cocotb.py`.
    CocotbDriver,
}

impl FileKind {
    pub const CORE_SOURCES: &[Self] = &[CoreVerilog, Memory];

    /// The files of the core and of its wrappers that synthesis tools and simulators read.
    pub const DESIGN_SOURCES: &[Self] = &[
        CoreVerilog,
        StreamWrapper,
        BusWrapper,
        ProcessorWrapper,
        SingleWrapper,
        QueueWrapper,
        Memory,
    ];

    /// The modules that connect the core to a system.
    pub const WRAPPERS: &[Self] =
        &[StreamWrapper, BusWrapper, ProcessorWrapper, SingleWrapper, QueueWrapper];

    pub const BENCH_SOURCES: &[Self] = &[Bench, BenchVectors];

    /// The files that a simulator of Verilog reads: the core, its wrappers and the benches.
    pub const SIMULATED: &[Self] = &[
        CoreVerilog,
        StreamWrapper,
        BusWrapper,
        ProcessorWrapper,
        SingleWrapper,
        QueueWrapper,
        Memory,
        Bench,
        BenchVectors,
    ];

    /// Returns the folder in the output directory for files of this kind. In it, each configuration has a folder of its own:
    /// the memories of `rough` are in `rtl_out/rough/`. Only the driver that all configurations share,
    /// [`FileKind::CocotbDriver`], is in the folder itself.
    pub fn folder(self) -> &'static str {
        match self {
            CoreVerilog | TargetVerilog | StreamWrapper | BusWrapper | ProcessorWrapper
            | SingleWrapper | QueueWrapper | Memory | CorePackage | Constraint | VendorScript
            | Vhdl | SystemVerilogPackage | Manifest => "rtl_out",
            CocotbBench | WrapperProof | WrapperProofScript | CoreProof | CoreProofScript
            | Bench | BenchVectors | BenchPackage | CocotbDriver => "testbench",
            Software | Recomputation => "software",
        }
    }

    /// Returns whether simulators, linters and synthesis tools compile the files of this kind as Verilog. SystemVerilog is not
    /// among them.
    pub fn is_verilog(self) -> bool {
        matches!(
            self,
            CoreVerilog
                | TargetVerilog
                | StreamWrapper
                | BusWrapper
                | ProcessorWrapper
                | SingleWrapper
                | QueueWrapper
                | Bench
        )
    }

    /// Returns the kind that decides the position of a file of this kind in the list of a core's files. For example,
    /// [`FileKind::BenchVectors`] gives [`FileKind::Bench`], so that the vectors of a bench follow the bench directly.
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
