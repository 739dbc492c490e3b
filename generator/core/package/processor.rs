//! Describes the interfaces by which processors call a core as an instruction: CFU and PCPI.
//!
//! Each interface is a row of data: the value of the key `interface.processor`, the ports, and the templates of its Verilog.

use anyhow::Result;
use glint_base::fill;

use super::wrap::CoreStub;
use super::wrap::processor::{ProcessorModule, ProcessorProof};

/// An interface of a processor for instructions that its user defines.
#[derive(Debug)]
pub struct ProcessorInterface {
    /// The value of the key, which is also the suffix of the module's name.
    pub key: &'static str,
    pub title: &'static str,
    /// The level of the reset port while the module is in reset.
    pub reset_level: u8,
    /// The ports of the module as text, clock and reset first, in the form of [`super::bus::Bus::ports`].
    pub ports: &'static str,
    pub module: fn(&ProcessorModule) -> Result<String>,
    pub proof: fn(&ProcessorProof) -> Result<String>,
}

impl PartialEq for ProcessorInterface {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

pub static PROCESSORS: [ProcessorInterface; 2] = [
    ProcessorInterface {
        key: "cfu",
        title: "the CFU interface of CFU Playground and VexRiscv",
        reset_level: 1,
        ports: "in clk, in reset, in cmd_valid, out cmd_ready, in cmd_payload_function_id 10, \
                in cmd_payload_inputs_0 32, in cmd_payload_inputs_1 32, out rsp_valid, in rsp_ready, \
                out rsp_payload_outputs_0 32",
        module: |module| fill!("cfu.v" { module: &'a ProcessorModule }),
        proof: |proof| fill!("cfu_formal.sv" { proof: &'a ProcessorProof, stub: &'a CoreStub = &proof.stub }),
    },
    ProcessorInterface {
        key: "pcpi",
        title: "the PCPI of PicoRV32",
        reset_level: 0,
        ports: "in clk, in resetn, in pcpi_valid, in pcpi_insn 32, in pcpi_rs1 32, in pcpi_rs2 32, out pcpi_wr, \
                out pcpi_rd 32, out pcpi_wait, out pcpi_ready",
        module: |module| fill!("pcpi.v" { module: &'a ProcessorModule }),
        proof: |proof| fill!("pcpi_formal.sv" { proof: &'a ProcessorProof, stub: &'a CoreStub = &proof.stub }),
    },
];
