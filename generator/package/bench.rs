//! The self-checking test bench and its vectors.

use anyhow::{Result, ensure};
use askama::Template;

use super::Vectors;
use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, Port, Role};
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::rows::{connections, variables};
use crate::hdl::verilog::text::{Names, ascii, literal, statement};

#[derive(Template)]
#[template(path = "bench.v")]
struct Bench {
    name: String,
    module: String,
    names: Variables,
    stimulus_file: String,
    expected_file: String,
    stimulus_last: u32,
    expected_last: u32,
    clocks: usize,
    known_from: usize,
    declarations: Vec<String>,
    /// The assignment of a word of stimulus to the inputs.
    stimulus: Vec<String>,
    connections: Vec<String>,
    reset: Option<String>,
    /// The initial value of `was_reset`.
    reset_seen: &'static str,
    handshake: Vec<Output>,
    results: Vec<Output>,
    /// The signal of a pipeline by which the expected word says that results are those of a point: in a bubble they mean nothing.
    shown: Option<String>,
    /// None without a microprogram.
    address: Option<String>,
    microprogram: Vec<Microinstruction>,
}

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

/// An output and its place in the expected word.
struct Output {
    name: String,
    select: String,
}

/// A microinstruction.
struct Microinstruction {
    label: String,
    address: usize,
    name: String,
}

#[derive(Template)]
#[template(path = "vectors.mem")]
struct VectorFile {
    title: String,
    columns: Vec<String>,
    words: Vec<String>,
}

/// The bench, the stimulus and the expected outputs, as names and texts.
///
/// # Errors
/// Vectors that do not fit the ports.
pub fn files(design: &Design, naming: &Naming, vectors: &Vectors) -> Result<Vec<(String, String)>> {
    let inputs: Vec<_> = design.inputs().collect();
    let outputs: Vec<_> = design.outputs().collect();
    ensure!(!inputs.is_empty() && !outputs.is_empty(), "a bench needs inputs and outputs");
    ensure!(!vectors.inputs.is_empty(), "a bench needs at least one clock of stimulus");
    ensure!(
        vectors.inputs.len() == vectors.expected.len(),
        "{} clocks of stimulus, {} of expected outputs",
        vectors.inputs.len(),
        vectors.expected.len()
    );
    ensure!(
        vectors.known_from <= vectors.inputs.len(),
        "results are compared from clock {} on, but there are {} clocks",
        vectors.known_from,
        vectors.inputs.len()
    );
    let name = &design.name;
    let stimulus = vector_file(design, "stimulus", &inputs, &vectors.inputs)?;
    let expected = vector_file(design, "expected outputs", &outputs, &vectors.expected)?;
    let bench = super::render(&view(design, naming, vectors))?;
    Ok(vec![
        (format!("{name}_tb.v"), bench),
        (format!("{name}_stimulus.mem"), stimulus),
        (format!("{name}_expected.mem"), expected),
    ])
}

fn view(design: &Design, naming: &Naming, vectors: &Vectors) -> Bench {
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
        let output = Output { name: port_name(port), select };
        match port.role {
            role if role.is_status() => handshake.push(output),
            _ => results.push(output),
        }
    }
    let address = design.registers.get(design.control.address.index()).map(|register| register.q);
    let address_width = address.map_or(1, |address| design.width(address));
    let microprogram: Vec<_> = design
        .control
        .microprogram
        .iter()
        .enumerate()
        .map(|(at, it)| Microinstruction {
            label: literal(at as u64, address_width),
            address: at,
            // Within a string literal of Verilog.
            name: ascii(&it.name).replace('\\', "/").replace('"', "'").replace('%', "%%"),
        })
        .collect();
    let reset = design.port(|role| role == Role::Reset).map(port_name);
    let stimulus: Vec<_> = inputs.iter().map(|port| port_name(port)).collect();
    Bench {
        name: format!("{}_tb", design.name),
        module: design.name.clone(),
        stimulus_file: format!("{}_stimulus.mem", design.name),
        expected_file: format!("{}_expected.mem", design.name),
        stimulus_last: total(&inputs) - 1,
        expected_last: total(&outputs) - 1,
        clocks: vectors.inputs.len(),
        known_from: vectors.known_from,
        declarations: variables(design, true),
        stimulus: statement(
            12,
            &format!("{{{}}} = {}[{}];", stimulus.join(", "), own.stimulus, own.clock),
        ),
        connections: connections(design),
        // Without a reset there is nothing to wait for.
        reset_seen: if reset.is_some() { "1'b0" } else { "1'b1" },
        reset,
        handshake,
        results,
        shown,
        address: address.map(|address| {
            let address = &design.net(address).name;
            format!("{}.{}.{address}", own.dut, naming.control_instance)
        }),
        microprogram,
        names: own,
    }
}

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
    let columns = ports.iter().map(|port| {
        let net = design.net(port.net);
        format!("{} [{}]", net.name, net.format.width())
    });
    let columns = crate::hdl::verilog::text::comment(
        0,
        &format!("From the top bit, with widths: {}", columns.collect::<Vec<_>>().join(", ")),
    );
    let title = format!("{}: {title}, a word a clock", design.name);
    super::render(&VectorFile { title, columns, words })
}

/// The values side by side, the first on top, in hexadecimal digits.
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
