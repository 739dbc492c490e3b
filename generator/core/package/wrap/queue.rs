//! Generates `<name>_queue.v`, which computes several points at a time with a pipeline, and its formal properties.
//!
//! Bus registers start points in turn, and the results wait in a queue until software has read them. For example, with
//! room for four results, software starts four points, and then reads and starts in turn, so that it seldom waits for the pipeline.

use anyhow::Result;
use glint_base::fill;

use super::started::{
    PipelinePort, count_width, has_port, observed_nets, pipeline_connections, pipeline_ports,
    started,
};
use super::{WrapperProof, add_proof, seen_inside, stub_ports, table_ports};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_rtl::netlist::{Pipeline, Role};
use glint_rtl::verilog::text::{literal, range, statement, together};

/// The widths and constants of a queue, as Verilog.
struct QueueText {
    /// The largest number of results that wait, a power of two.
    depth: u32,
    /// The depth as a literal with the bits of a count.
    full: String,
    /// The range of a count from 0 to the depth.
    count: String,
    /// The ranges of a place in the queue and of a word with all results, each with a blank behind it, or empty for one bit.
    place: String,
    word: String,
    /// The literal 0 as a count, and the literal 1 as a place and as a count.
    no_count: String,
    next: String,
    one: String,
    /// The places of the first and the last word.
    first_place: String,
    last_place: String,
    /// The number of bits of a place and of a word.
    place_bits: u32,
    word_bits: u32,
}

impl QueueText {
    fn new(depth: u32, results: &[PipelinePort]) -> Self {
        let (place_bits, count_bits) = (depth.ilog2(), count_width(depth));
        let word_bits = results.iter().map(|result| result.width).sum();
        Self {
            depth,
            full: literal(depth.into(), count_bits),
            count: range(count_bits),
            place: spaced(range(place_bits)),
            word: spaced(range(word_bits)),
            no_count: literal(0, count_bits),
            next: literal(1, place_bits),
            one: literal(1, count_bits),
            first_place: literal(0, place_bits),
            last_place: literal((depth - 1).into(), place_bits),
            place_bits,
            word_bits,
        }
    }
}

fn spaced(range: String) -> String {
    if range.is_empty() { range } else { format!("{range} ") }
}

/// Returns the Verilog of a word with all results, the first in the lowest bits. `prefix` is put before the name of each.
fn word_of(results: &[PipelinePort], prefix: &str) -> String {
    let nets = results.iter().rev().map(|result| format!("{prefix}{}", result.name));
    together(nets.collect())
}

/// Adds `<name>_queue.v`, the module around the pipeline, to `files`. The module's queue holds up to `depth` results, a power
/// of two, until software reads them. With test vectors in the job, also adds the formal properties of the module.
///
/// # Errors
/// Fails if a template fails.
pub fn modules(
    job: &EmitJob,
    pipeline: &Pipeline,
    depth: u32,
    files: &mut OutputFiles,
) -> Result<()> {
    let design = job.design;
    let accepts = has_port(design, Role::InReady);
    let results = pipeline_ports(design, Role::Result);
    let queue = &QueueText::new(depth, &results);
    let module = started(design, Some(depth));
    let verilog = fill!("queue.v" {
        name: &'a str = job.name(),
        regenerate: &'a str = job.regenerate(),
        queue: &'a QueueText,
        accepts: bool,
        side: bool = has_port(design, Role::SideOut),
        side_range: String = range(pipeline.side),
        operands: Vec<PipelinePort> = pipeline_ports(design, Role::Point),
        results: &'a [PipelinePort] = &results,
        store: Vec<String> = statement(
            8,
            &format!("if (arrives) results[tail] <= {};", word_of(&results, "new_")),
        ),
        connections: Vec<String> = pipeline_connections(design, pipeline),
        table_ports: Vec<String> = table_ports::declared(design),
    })?;
    files.add_verilog(FileKind::QueueWrapper, vec![module.name.clone()], verilog);
    let mut inside = observed_nets(design);
    if !accepts {
        inside.push(("accepted".to_owned(), 1));
    }
    inside.push(("claimed".to_owned(), count_width(depth)));
    inside.push(("head".to_owned(), queue.place_bits));
    inside.push(("tail".to_owned(), queue.place_bits));
    for word in 0..depth {
        inside.push((format!("results[{word}]"), queue.word_bits));
    }
    let proof = fill!("queue_formal.sv" {
        name: &'a str = job.name(),
        queue: &'a QueueText,
        accepts: bool,
        operands: Vec<PipelinePort> = pipeline_ports(design, Role::Point),
        results: &'a [PipelinePort] = &results,
        shown: Vec<String> = statement(
            4,
            &format!("wire {}shown = {};", queue.word, word_of(&results, "")),
        ),
        picked: Vec<String> =
            statement(12, &format!("value <= {};", word_of(&results, "dut.new_"))),
        words: Vec<String> = (0..depth).map(|word| format!("\\dut.results[{word}] ")).collect(),
        stub_ports: Vec<String> = stub_ports(design),
        side: bool = has_port(design, Role::SideOut),
        inside: Vec<String> = inside.into_iter().map(seen_inside).collect(),
    })?;
    let proof =
        WrapperProof { text: proof, stubs: vec![job.name().to_owned()], reads_memory: true };
    add_proof(job, &module.name, proof, files)
}
