//! Generates `<name>_single.v`, which computes one point at a time with a pipeline, and its formal properties.
//!
//! The module has the ports of a sequential core: `start`, `busy`, `done`, a write strobe for each operand, and results that
//! stay until the next computation ends. Instructions of a processor can therefore start a pipeline as they start any other core.

use anyhow::Result;
use glint_base::fill;

use super::started::{
    PipelinePort, has_port, observed_nets, pipeline_connections, pipeline_ports, started,
};
use super::{WrapperProof, add_proof, seen_inside, stub_ports, table_ports};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_rtl::netlist::{Pipeline, Role};
use glint_rtl::verilog::text::range;

/// Adds the module around the pipeline of the job, and with test vectors its proof.
///
/// # Errors
/// Fails if a template fails.
pub fn modules(job: &EmitJob, pipeline: &Pipeline, files: &mut OutputFiles) -> Result<()> {
    let design = job.design;
    let accepts = has_port(design, Role::InReady);
    let single = started(design, None);
    let verilog = fill!("single.v" {
        name: &'a str = job.name(),
        regenerate: &'a str = job.regenerate(),
        accepts: bool,
        side: bool = has_port(design, Role::SideOut),
        side_range: String = range(pipeline.side),
        operands: Vec<PipelinePort> = pipeline_ports(design, Role::Point),
        results: Vec<PipelinePort> = pipeline_ports(design, Role::Result),
        connections: Vec<String> = pipeline_connections(design, pipeline),
        table_ports: Vec<String> = table_ports::declared(design),
    })?;
    files.add_verilog(FileKind::SingleWrapper, vec![single.name.clone()], verilog);
    let proof = fill!("single_formal.sv" {
        name: &'a str = job.name(),
        accepts: bool,
        operands: Vec<PipelinePort> = pipeline_ports(design, Role::Point),
        results: Vec<PipelinePort> = pipeline_ports(design, Role::Result),
        stub_ports: Vec<String> = stub_ports(design),
        side: bool = has_port(design, Role::SideOut),
        inside: Vec<String> = observed_nets(design).into_iter().map(seen_inside).collect(),
    })?;
    add_proof(job, &single.name, WrapperProof::new(proof, vec![job.name().to_owned()]), files)
}
