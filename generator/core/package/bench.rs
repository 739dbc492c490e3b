//! Generates the self-checking test bench of a core in Verilog, with its stimulus and the expected outputs of every clock.
//!
//! For example, `rough` has `rough_tb.v`, and the two files that it reads: `rough_stimulus.mem` and `rough_expected.mem`.

use anyhow::{Result, ensure};
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use crate::observation::Vectors;
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::rows::{connections, variables};
use glint_rtl::verilog::text::{Names, ascii, comment, literal, statement};

fresh_names!(Variables {
    stimulus,
    expected,
    want,
    clock,
    errors,
    was_reset,
    dut,
    write_microinstruction
});

/// An output, with the Verilog expression that selects its bits from the expected outputs of a clock. For example,
/// `want[7:0]`.
struct ExpectedOutput {
    name: String,
    select: String,
}

/// A microinstruction: its name, and its address as a Verilog literal and as a number.
struct StepLabel {
    label: String,
    address: usize,
    name: String,
}

/// Adds the bench and its two vector files. Fails if the design has no inputs or no outputs, or if the vectors are empty or do
/// not fit the ports.
pub fn files(job: &EmitJob, vectors: &Vectors, files: &mut OutputFiles) -> Result<()> {
    let design = job.design;
    let inputs: Vec<_> = design.inputs().collect();
    let outputs: Vec<_> = design.outputs().collect();
    ensure!(!inputs.is_empty() && !outputs.is_empty(), "a bench needs inputs and outputs");
    ensure!(!vectors.inputs.is_empty(), "a bench needs at least one clock of stimulus");
    ensure!(
        vectors.inputs.len() == vectors.expected.len(),
        "the stimulus has {} clocks, but the expected outputs have {}",
        vectors.inputs.len(),
        vectors.expected.len()
    );
    ensure!(
        vectors.known_from <= vectors.inputs.len(),
        "the outputs are compared from clock {} on, but there are only {} clocks",
        vectors.known_from,
        vectors.inputs.len()
    );
    let stimulus = vector_file(design, "stimulus", &inputs, &vectors.inputs)?;
    let expected = vector_file(design, "expected outputs", &outputs, &vectors.expected)?;
    let name = job.name();
    files.add_verilog(FileKind::Bench, vec![format!("{name}_tb")], bench(job, vectors)?);
    files.add(FileKind::BenchVectors, format!("{name}_stimulus.mem"), stimulus);
    files.add(FileKind::BenchVectors, format!("{name}_expected.mem"), expected);
    Ok(())
}

fn bench(job: &EmitJob, vectors: &Vectors) -> Result<String> {
    let design = job.design;
    let port_name = |port: &Port| design.net(port.net).name.clone();
    let mut names = Names::of_ports(design);
    let own = Variables::new(&mut names);
    let total = |ports: &[&Port]| ports.iter().map(|port| design.width(port.net)).sum::<u32>();
    let inputs: Vec<_> = design.inputs().collect();
    let outputs: Vec<_> = design.outputs().collect();
    let mut low = total(&outputs);
    let (mut handshake, mut results, mut shown) = (Vec::new(), Vec::new(), None);
    for port in &outputs {
        let width = design.width(port.net);
        low -= width;
        let select = match width {
            1 => format!("{}[{low}]", own.want),
            _ => format!("{}[{}:{low}]", own.want, low + width - 1),
        };
        if design.pipeline.is_some() && port.role == Role::Valid {
            shown = Some(select.clone());
        }
        let output = ExpectedOutput { name: port_name(port), select };
        match port.role {
            role if role.is_status() => handshake.push(output),
            _ => results.push(output),
        }
    }
    let address = design.registers.get(design.control.address.index()).map(|register| register.q);
    let address_width = address.map_or(1, |address| design.width(address));
    let mut microprogram = Vec::new();
    for (address, microinstruction) in design.control.microprogram.iter().enumerate() {
        let label = literal(address as u64, address_width);
        // Within a string literal of Verilog.
        let text = ascii(&microinstruction.name);
        let name = text.replace('\\', "/").replace('"', "'").replace('%', "%%");
        microprogram.push(StepLabel { label, address, name });
    }
    let reset = design.port(|role| role == Role::Reset).map(port_name);
    let stimulus: Vec<_> = inputs.iter().map(|port| port_name(port)).collect();
    let stimulus = format!("{{{}}} = {}[{}];", stimulus.join(", "), own.stimulus, own.clock);
    fill!("bench.v" {
        name: String = format!("{}_tb", design.name),
        module: &'a str = job.name(),
        stimulus_file: String = format!("{}_stimulus.mem", design.name),
        expected_file: String = format!("{}_expected.mem", design.name),
        stimulus_last: u32 = total(&inputs) - 1,
        expected_last: u32 = total(&outputs) - 1,
        clocks: usize = vectors.inputs.len(),
        known_from: usize = vectors.known_from,
        word_stride: usize = vectors.word_stride,
        declarations: Vec<String> = variables(design, true),
        stimulus: Vec<String> = statement(12, &stimulus),
        connections: Vec<String> = connections(design),
        // The initial value of `was_reset`: without a reset there is nothing to wait for.
        reset_seen: &'a str = if reset.is_some() { "1'b0" } else { "1'b1" },
        reset: Option<String>,
        handshake: Vec<ExpectedOutput>,
        results: Vec<ExpectedOutput>,
        // Only in a pipeline: whether the expected word says that a point's results are shown. In a bubble the results mean
        // nothing.
        shown: Option<String>,
        // The path of the address register below the bench.
        address: Option<String> = address.map(|address| {
            let address = &design.net(address).name;
            format!("{}.{}.{address}", own.dut, job.naming.control_instance)
        }),
        microprogram: Vec<StepLabel>,
        names: Variables = own,
    })
}

/// Returns the file that the test bench reads with `$readmemh`: a comment with `title` and the columns, and a line for each
/// clock. `rows` has for each clock a value for each of `ports`, and each value must fit the bits of its port.
fn vector_file(design: &Design, title: &str, ports: &[&Port], rows: &[Vec<u64>]) -> Result<String> {
    let widths: Vec<_> = ports.iter().map(|port| design.width(port.net)).collect();
    let mut words = Vec::with_capacity(rows.len());
    for (clock, row) in rows.iter().enumerate() {
        ensure!(
            row.len() == ports.len(),
            "clock {clock} of the {title} has {} values for {} ports",
            row.len(),
            ports.len()
        );
        for ((value, width), port) in row.iter().zip(&widths).zip(ports) {
            ensure!(
                value & !mask(*width) == 0,
                "clock {clock} of the {title}: {value:#x} does not fit the {width} bits of `{}`",
                design.net(port.net).name
            );
        }
        words.push(packed(row, &widths));
    }
    let mut columns = Vec::new();
    for port in ports {
        let net = design.net(port.net);
        columns.push(format!("{} [{}]", net.name, net.format.width()));
    }
    let columns_line = format!("From the top bit, with widths: {}", columns.join(", "));
    let mut lines = vec![format!("// {}: {title}, a word a clock", design.name)];
    lines.extend(comment(0, &columns_line));
    lines.extend(words);
    Ok(lines.join("\n") + "\n")
}

/// Concatenates the port values of a clock in hexadecimal, the first value in the highest bits. `widths` are the widths in
/// bits. For example, 1 in one bit and 5 in three bits give `d`.
pub(super) fn packed(row: &[u64], widths: &[u32]) -> String {
    let total: u32 = widths.iter().sum();
    let mut digits = vec![0u8; total.div_ceil(4) as usize];
    let last = digits.len() - 1;
    let mut bit = 0usize;
    for (value, width) in row.iter().zip(widths).rev() {
        for at in 0..*width {
            if value >> at & 1 == 1 {
                digits[last - bit / 4] |= 1 << (bit % 4);
            }
            bit += 1;
        }
    }
    digits.into_iter().filter_map(|digit| char::from_digit(u32::from(digit), 16)).collect()
}

#[cfg(test)]
mod tests {
    use super::packed;

    #[test]
    fn rows_are_packed_first_port_on_top() {
        assert_eq!(packed(&[1, 0xab, 0x3], &[1, 8, 2]), "6af");
        assert_eq!(packed(&[u64::MAX, 1], &[64, 1]), "1ffffffffffffffff");
    }
}
