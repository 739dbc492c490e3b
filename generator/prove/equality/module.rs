//! Parses the JSON netlist of a Verilog module that Yosys has flattened, and executes it clock by clock on symbolic terms.
//!
//! Every undetermined bit (`x` or `z`) becomes a new unknown at each read. A read beyond a memory's contents gives an unknown
//! word, the same for equal addresses. The module accepts only registers and memories that change at the rising edge of `clk`.

use std::collections::HashMap;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use super::cells::{Bit, Connection, WireValues};
use super::term::{VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// The computation of a combinational cell: an operation, or a read from a memory.
enum What {
    Cell {
        kind: String,
        signed: [bool; 2],
    },
    /// A word of a memory that is never written.
    Word(Vec<u64>),
    /// A word of a memory that is written.
    Read(Read),
}

/// A read port: the index of the memory in [`Module::memories`], and the number of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Read {
    pub memory: usize,
    pub port: usize,
}

struct ModuleCell {
    what: What,
    inputs: [Connection; 3],
    output: Connection,
}

struct ModuleRegister {
    data: Connection,
    output: Connection,
}

/// A memory that the module writes, such as a delay line's memory.
pub struct Memory {
    pub reads: Vec<Read>,
    width: usize,
    addresses: Vec<Connection>,
    write: Write,
}

struct Write {
    address: Connection,
    data: Connection,
    enable: Connection,
}

pub struct Module {
    inputs: Vec<(String, Connection)>,
    outputs: Vec<(String, Connection)>,
    /// The cells, each after the cells that it reads.
    cells: Vec<ModuleCell>,
    registers: Vec<ModuleRegister>,
    pub memories: Vec<Memory>,
    wires: usize,
}

/// The symbolic values of all registers: terms of at most 64 bits, the lowest bits first.
pub type RegisterContents = Vec<Vec<VectorTermId>>;

fn bits(value: &Value) -> Result<Connection> {
    let listed = value.as_array().context("a connection of the netlist has no bits")?;
    let mut bits = Connection::new();
    for bit in listed {
        bits.push(match (bit.as_u64(), bit.as_str()) {
            (Some(wire), _) => Bit::Wire(wire as usize),
            (_, Some("0")) => Bit::Known(false),
            (_, Some("1")) => Bit::Known(true),
            (_, Some("x" | "z")) => Bit::Any,
            _ => bail!("a bit of the netlist has the unknown value `{bit}`"),
        });
    }
    Ok(bits)
}

/// Reads a parameter of a cell, which Yosys writes in binary. For example, `00000101` is 5.
fn parameter(cell: &Value, name: &str) -> Result<usize> {
    let value = &cell["parameters"][name];
    if let Some(text) = value.as_str()
        && let Ok(number) = usize::from_str_radix(text, 2)
    {
        return Ok(number);
    }
    let number = value.as_u64().context("a parameter of the netlist is not a number")?;
    Ok(number as usize)
}

fn connection(cell: &Value, port: &str) -> Result<Connection> {
    bits(&cell["connections"][port])
}

/// Returns the bits at a port of a cell, or no bits if the cell lacks the port.
fn optional_connection(cell: &Value, port: &str) -> Result<Connection> {
    match &cell["connections"][port] {
        Value::Null => Ok(Connection::new()),
        connected => bits(connected),
    }
}

/// Returns the bits of port number `port` of a memory. `side_by_side` has the bits of all ports, `width` bits for each.
fn port_bits(side_by_side: &Connection, port: usize, width: usize) -> Connection {
    side_by_side[port * width..(port + 1) * width].to_vec()
}

impl Module {
    /// Parses `json`.
    ///
    /// # Errors
    ///
    /// Fails if the netlist is malformed or has no input `clk`. Fails if a register or memory does not change at the rising edge
    /// of `clk` only. Fails if a memory has clocked read ports, several write ports or a first address other than 0. A memory
    /// that is never written must have known words of at most 64 bits. The cells must not form a combinational loop.
    pub fn new(json: &Value) -> Result<Self> {
        let mut module = Self {
            inputs: Vec::new(),
            outputs: Vec::new(),
            cells: Vec::new(),
            registers: Vec::new(),
            memories: Vec::new(),
            wires: 0,
        };
        let ports =
            json["ports"].as_object().context("the netlist of the emitted Verilog has no ports")?;
        for (name, port) in ports {
            let port_bits = bits(&port["bits"])?;
            match port["direction"].as_str() {
                Some("input") => module.inputs.push((name.clone(), port_bits)),
                Some("output") => module.outputs.push((name.clone(), port_bits)),
                _ => bail!(
                    "the port `{name}` of the emitted Verilog is neither an input nor an output"
                ),
            }
        }
        let clock_at = module.inputs.iter().position(|(name, _)| name == "clk");
        let (_, clock) =
            module.inputs.remove(clock_at.context("the emitted Verilog has no `clk`")?);
        let cells =
            json["cells"].as_object().context("the netlist of the emitted Verilog has no cells")?;
        for (name, cell) in cells {
            module
                .add(cell, &clock)
                .with_context(|| format!("the cell `{name}` of the emitted Verilog"))?;
        }
        module.order()?;
        Ok(module)
    }

    fn add(&mut self, cell: &Value, clock: &Connection) -> Result<()> {
        let kind = cell["type"].as_str().unwrap_or_default();
        match kind {
            "$dff" => {
                let at_clock = optional_connection(cell, "CLK")? == *clock;
                ensure!(
                    at_clock && parameter(cell, "CLK_POLARITY")? == 1,
                    "the register does not change at the rising edge of `clk`"
                );
                self.registers.push(ModuleRegister {
                    data: optional_connection(cell, "D")?,
                    output: optional_connection(cell, "Q")?,
                });
            }
            "$mem_v2" => self.add_memory(cell, clock)?,
            _ => self.cells.push(ModuleCell {
                what: What::Cell {
                    kind: kind.to_owned(),
                    signed: [
                        matches!(parameter(cell, "A_SIGNED"), Ok(1)),
                        matches!(parameter(cell, "B_SIGNED"), Ok(1)),
                    ],
                },
                inputs: [
                    optional_connection(cell, "A")?,
                    optional_connection(cell, "B")?,
                    optional_connection(cell, "S")?,
                ],
                output: optional_connection(cell, "Y")?,
            }),
        }
        Ok(())
    }

    fn add_memory(&mut self, cell: &Value, clock: &Connection) -> Result<()> {
        let width = parameter(cell, "WIDTH")?;
        let places = parameter(cell, "ABITS")?;
        let reads = parameter(cell, "RD_PORTS")?;
        // A port that is never enabled writes nothing.
        let is_enabled = connection(cell, "WR_EN")?.iter().any(|bit| *bit != Bit::Known(false));
        let writes = if is_enabled { parameter(cell, "WR_PORTS")? } else { 0 };
        let read_data = connection(cell, "RD_DATA")?;
        let read_addresses = connection(cell, "RD_ADDR")?;
        let clocked = cell["parameters"]["RD_CLK_ENABLE"].as_str().unwrap_or("1");
        ensure!(!clocked.contains('1'), "the memory has a clocked read port");
        ensure!(parameter(cell, "OFFSET")? == 0, "the memory does not begin at address 0");
        let contents = if writes == 0 { words(cell, width)? } else { Vec::new() };
        let memory = self.memories.len();
        let mut ports = Vec::new();
        let mut addresses = Vec::new();
        for port in 0..reads {
            let what = match writes {
                0 => What::Word(contents.clone()),
                _ => What::Read(Read { memory, port }),
            };
            let address = port_bits(&read_addresses, port, places);
            ports.push(Read { memory, port });
            addresses.push(address.clone());
            self.cells.push(ModuleCell {
                what,
                inputs: [address, Connection::new(), Connection::new()],
                output: port_bits(&read_data, port, width),
            });
        }
        if writes > 0 {
            ensure!(writes == 1, "the memory has {writes} write ports");
            let at_clock = connection(cell, "WR_CLK")? == *clock;
            ensure!(
                at_clock && parameter(cell, "WR_CLK_POLARITY")? == 1,
                "the memory is not written at the rising edge of `clk`"
            );
            self.memories.push(Memory {
                addresses,
                reads: ports,
                width,
                write: Write {
                    address: connection(cell, "WR_ADDR")?,
                    data: connection(cell, "WR_DATA")?,
                    enable: connection(cell, "WR_EN")?,
                },
            });
        }
        Ok(())
    }

    fn connections(&self) -> Vec<&Connection> {
        let mut connections = Vec::new();
        for register in &self.registers {
            connections.extend([&register.output, &register.data]);
        }
        for (_, port) in self.inputs.iter().chain(&self.outputs) {
            connections.push(port);
        }
        for cell in &self.cells {
            connections.extend(&cell.inputs);
            connections.push(&cell.output);
        }
        for memory in &self.memories {
            let Write { address, data, enable } = &memory.write;
            connections.extend([address, data, enable]);
        }
        connections
    }

    /// Sorts the cells so that each comes after the cells that drive its inputs. Fails for a combinational loop.
    fn order(&mut self) -> Result<()> {
        let mut wires = 0;
        for bit in self.connections().into_iter().flatten() {
            if let Bit::Wire(wire) = *bit {
                wires = wires.max(wire + 1);
            }
        }
        self.wires = wires;
        let mut driver = vec![None; wires];
        for (at, cell) in self.cells.iter().enumerate() {
            for bit in &cell.output {
                if let Bit::Wire(wire) = *bit {
                    driver[wire] = Some(at);
                }
            }
        }
        let mut place = vec![0; self.cells.len()];
        // An open cell waits for a cell whose output it reads.
        let (mut open, mut done) = (vec![false; self.cells.len()], 0);
        for root in 0..self.cells.len() {
            let mut pending = vec![root];
            while let Some(&at) = pending.last() {
                if place[at] > 0 {
                    pending.pop();
                    continue;
                }
                match unplaced_driver(&self.cells[at], &driver, &place) {
                    Some(before) => {
                        ensure!(
                            !open[at] || !open[before],
                            "the emitted Verilog has a combinational loop"
                        );
                        open[at] = true;
                        pending.push(before);
                    }
                    None => {
                        done += 1;
                        place[at] = done;
                        open[at] = false;
                        pending.pop();
                    }
                }
            }
        }
        let mut placed: Vec<_> = place.into_iter().zip(self.cells.drain(..)).collect();
        placed.sort_by_key(|&(place, _)| place);
        self.cells = placed.into_iter().map(|(_, cell)| cell).collect();
        Ok(())
    }

    /// Returns the registers at power-up, all unknown, so a proof holds for every initial state.
    pub fn power_up(&self, terms: &mut VectorTerms) -> RegisterContents {
        self.registers.iter().map(|it| unknown(terms, it.output.len())).collect()
    }

    /// Returns the value of every wire in one clock, given the inputs, the registers and the words at the read ports of
    /// memories.
    ///
    /// # Errors
    /// Fails if an input port is wider than 64 bits, or if a cell is unknown or too wide.
    pub fn settle(
        &self,
        terms: &mut VectorTerms,
        held: &RegisterContents,
        mut input: impl FnMut(&mut VectorTerms, &str, u32) -> VectorTermId,
        mut read: impl FnMut(&mut VectorTerms, Read) -> Vec<VectorTermId>,
    ) -> Result<WireValues> {
        let mut values = WireValues::new(self.wires);
        for (name, bits) in &self.inputs {
            ensure!(bits.len() <= MAX_WIDTH as usize, "the port `{name}` has more than 64 bits");
            let id = input(terms, name, bits.len() as u32);
            values.set(bits, &[id]);
        }
        for (register, held) in self.registers.iter().zip(held) {
            values.set(&register.output, held);
        }
        for cell in &self.cells {
            let result = match &cell.what {
                What::Read(port) => read(terms, *port),
                What::Word(words) => {
                    let width = cell.output.len() as u32;
                    vec![values.rom(terms, &cell.inputs[0], words, width)]
                }
                What::Cell { kind, signed } => values
                    .cell(terms, kind, *signed, &cell.inputs, cell.output.len())
                    .with_context(|| format!("a cell `{kind}` of the emitted Verilog"))?,
            };
            values.set(&cell.output, &result);
        }
        Ok(values)
    }

    pub fn edge(&self, terms: &mut VectorTerms, values: &WireValues) -> RegisterContents {
        self.registers.iter().map(|it| values.columns(terms, &it.data)).collect()
    }

    /// Returns the outputs by the names of the ports.
    pub fn shown(
        &self,
        terms: &mut VectorTerms,
        values: &WireValues,
    ) -> HashMap<String, VectorTermId> {
        let mut shown = HashMap::new();
        for (name, bits) in &self.outputs {
            shown.insert(name.clone(), values.word(terms, bits));
        }
        shown
    }
}

/// Returns the index of the first cell that drives an input of `cell` and has position 0, which means that it has no position
/// yet.
fn unplaced_driver(cell: &ModuleCell, driver: &[Option<usize>], place: &[usize]) -> Option<usize> {
    for bit in cell.inputs.iter().flatten() {
        if let Bit::Wire(wire) = *bit
            && let Some(before) = driver[wire]
            && place[before] == 0
        {
            return Some(before);
        }
    }
    None
}

impl Memory {
    /// Returns a new unknown word, for a read with an unknown result.
    pub fn any(&self, terms: &mut VectorTerms) -> Vec<VectorTermId> {
        unknown(terms, self.width)
    }

    /// Returns the data at the write port, as terms of at most 64 bits, the lowest bits first.
    pub fn written(&self, terms: &mut VectorTerms, values: &WireValues) -> Vec<VectorTermId> {
        values.columns(terms, &self.write.data)
    }

    /// Returns the address at the write port, then the address at each read port, then the enables of the written bits. They are
    /// terms of at most 64 bits, the lowest first.
    pub fn control(&self, terms: &mut VectorTerms, values: &WireValues) -> Vec<VectorTermId> {
        let enable = values.columns(terms, &self.write.enable);
        let mut control = vec![values.word(terms, &self.write.address)];
        for address in &self.addresses {
            control.push(values.word(terms, address));
        }
        control.extend(enable);
        control
    }
}

/// Returns unknowns with `width` bits in total, the lowest bits first, each of at most 64 bits.
fn unknown(terms: &mut VectorTerms, width: usize) -> Vec<VectorTermId> {
    let mut columns = Vec::new();
    for lowest in (0..width).step_by(MAX_WIDTH as usize) {
        let column_width = (width - lowest).min(MAX_WIDTH as usize);
        columns.push(terms.unknown(column_width as u32));
    }
    columns
}

/// Returns the contents of a memory that is never written. The last digits of the parameter `INIT` are word 0. For example,
/// `1101` with words of 2 bits has word 0 = 1 and word 1 = 3.
fn words(cell: &Value, width: usize) -> Result<Vec<u64>> {
    let contents = cell["parameters"]["INIT"].as_str().unwrap_or_default();
    ensure!(width <= MAX_WIDTH as usize, "the memory words have more than 64 bits");
    let mut words = Vec::new();
    for digits in contents.as_bytes().rchunks(width) {
        let Ok(word) = u64::from_str_radix(&String::from_utf8_lossy(digits), 2) else {
            bail!("the memory is never written, but has words without contents")
        };
        words.push(word);
    }
    ensure!(
        words.len() == parameter(cell, "SIZE")?,
        "the contents of the memory have another number of words"
    );
    Ok(words)
}
