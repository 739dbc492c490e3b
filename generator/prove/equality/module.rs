//! Executes a flat module, as Yosys reads it from Verilog, clock by clock on terms.
//!
//! A bit that is not determined is any bit, a new one wherever it is read; a word beyond the contents of a memory is any word.

use std::collections::HashMap;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use super::cells::{Bit, Connection, WireValues};
use super::term::{VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// The driver of wires in the same clock.
enum What {
    Cell {
        kind: String,
        signed: [bool; 2],
    },
    /// A word of a memory that is never written.
    Word(Vec<u64>),
    /// A word of one that is.
    Read(Read),
}

/// A port by which a memory is read.
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

/// A memory that is written.
pub struct Memory {
    /// Read ports.
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

/// A module.
pub struct Module {
    inputs: Vec<(String, Connection)>,
    outputs: Vec<(String, Connection)>,
    /// Each cell comes after the cells that it reads.
    cells: Vec<ModuleCell>,
    registers: Vec<ModuleRegister>,
    pub memories: Vec<Memory>,
    wires: usize,
}

/// The contents of the registers, each in terms of at most 64 bits, the lowest first.
pub type RegisterContents = Vec<Vec<VectorTermId>>;

fn bits(value: &Value) -> Result<Connection> {
    let bits = value.as_array().context("a connection of the netlist has no bits")?;
    let bit = |bit: &Value| {
        Ok(match (bit.as_u64(), bit.as_str()) {
            (Some(wire), _) => Bit::Wire(wire as usize),
            (_, Some("0")) => Bit::Known(false),
            (_, Some("1")) => Bit::Known(true),
            (_, Some("x" | "z")) => Bit::Any,
            _ => bail!("a bit of the netlist is `{bit}`"),
        })
    };
    bits.iter().map(bit).collect()
}

/// Returns a parameter, which Yosys writes in binary. For example, `00000101` is 5.
fn number(value: &Value) -> Result<usize> {
    let text = value.as_str().and_then(|text| usize::from_str_radix(text, 2).ok());
    text.or(value.as_u64().map(|it| it as usize)).context("a parameter of the netlist is no number")
}

impl Module {
    /// Reads a module of Yosys's JSON.
    ///
    /// # Errors
    /// Fails if a cell is not known here, or if the module is no clocked circuit with the one clock `clk`.
    pub fn new(json: &Value) -> Result<Self> {
        let mut module = Self {
            inputs: Vec::new(),
            outputs: Vec::new(),
            cells: Vec::new(),
            registers: Vec::new(),
            memories: Vec::new(),
            wires: 0,
        };
        let ports = json["ports"].as_object().context("the netlist of the text has no ports")?;
        for (name, port) in ports {
            let port_bits = bits(&port["bits"])?;
            match port["direction"].as_str() {
                Some("input") => module.inputs.push((name.clone(), port_bits)),
                Some("output") => module.outputs.push((name.clone(), port_bits)),
                _ => bail!("the port `{name}` of the text has another direction than in or out"),
            }
        }
        let clock = module.inputs.iter().position(|(name, _)| name == "clk");
        let clock = clock.map(|at| module.inputs.remove(at).1).context("the text has no `clk`")?;
        let cells = json["cells"].as_object().context("the netlist of the text has no cells")?;
        for (name, cell) in cells {
            module.add(cell, &clock).with_context(|| format!("the cell `{name}` of the text"))?;
        }
        module.order()?;
        Ok(module)
    }

    fn add(&mut self, cell: &Value, clock: &Connection) -> Result<()> {
        let kind = cell["type"].as_str().unwrap_or_default();
        let parameter = |name: &str| &cell["parameters"][name];
        let optional = |name: &str| match &cell["connections"][name] {
            Value::Null => Ok(Connection::new()),
            connection => bits(connection),
        };
        match kind {
            "$dff" => {
                ensure!(
                    optional("CLK")? == *clock && number(parameter("CLK_POLARITY"))? == 1,
                    "it does not change at the rising edge of `clk`"
                );
                self.registers
                    .push(ModuleRegister { data: optional("D")?, output: optional("Q")? });
            }
            "$mem_v2" => self.add_memory(cell, clock)?,
            _ => {
                let signed = |name| number(parameter(name)).is_ok_and(|signed| signed == 1);
                self.cells.push(ModuleCell {
                    what: What::Cell {
                        kind: kind.to_owned(),
                        signed: [signed("A_SIGNED"), signed("B_SIGNED")],
                    },
                    inputs: [optional("A")?, optional("B")?, optional("S")?],
                    output: optional("Y")?,
                });
            }
        }
        Ok(())
    }

    fn add_memory(&mut self, cell: &Value, clock: &Connection) -> Result<()> {
        let parameter = |name: &str| number(&cell["parameters"][name]);
        let connection = |name: &str| bits(&cell["connections"][name]);
        let (width, places) = (parameter("WIDTH")?, parameter("ABITS")?);
        let [reads, writes] = [parameter("RD_PORTS")?, parameter("WR_PORTS")?];
        let [read, addresses] = [connection("RD_DATA")?, connection("RD_ADDR")?];
        let clocked = cell["parameters"]["RD_CLK_ENABLE"].as_str().unwrap_or("1");
        ensure!(!clocked.contains('1'), "it is read by a clocked port");
        ensure!(parameter("OFFSET")? == 0, "it does not begin at address 0");
        let part =
            |all: &Connection, at: usize, width: usize| all[at * width..(at + 1) * width].to_vec();
        let contents = if writes == 0 { words(cell, width)? } else { Vec::new() };
        let memory = self.memories.len();
        let mut ports = Vec::new();
        for port in 0..reads {
            let what = match writes {
                0 => What::Word(contents.clone()),
                _ => What::Read(Read { memory, port }),
            };
            ports.push(Read { memory, port });
            self.cells.push(ModuleCell {
                what,
                inputs: [part(&addresses, port, places), Connection::new(), Connection::new()],
                output: part(&read, port, width),
            });
        }
        if writes > 0 {
            ensure!(writes == 1, "it is written by {writes} ports");
            ensure!(
                connection("WR_CLK")? == *clock && parameter("WR_CLK_POLARITY")? == 1,
                "it is not written at the rising edge of `clk`"
            );
            self.memories.push(Memory {
                addresses: (0..reads).map(|port| part(&addresses, port, places)).collect(),
                reads: ports,
                width,
                write: Write {
                    address: connection("WR_ADDR")?,
                    data: connection("WR_DATA")?,
                    enable: connection("WR_EN")?,
                },
            });
        }
        Ok(())
    }

    /// Puts each cell after the cells whose output it reads.
    fn order(&mut self) -> Result<()> {
        let all = |cell: &ModuleCell| cell.inputs.iter().flatten().copied().collect::<Connection>();
        let registers = self.registers.iter().map(|it| (&it.output, &it.data));
        let ports = self.inputs.iter().chain(&self.outputs).map(|(_, bits)| (bits, bits));
        let used = registers.chain(ports).flat_map(|(a, b)| a.iter().chain(b)).copied();
        let of_cells =
            self.cells.iter().flat_map(|cell| all(cell).into_iter().chain(cell.output.clone()));
        let of_memories = self.memories.iter().map(|it| &it.write);
        let of_memories =
            of_memories.flat_map(|it| it.address.iter().chain(&it.data).chain(&it.enable)).copied();
        let wire = |bit| if let Bit::Wire(wire) = bit { Some(wire) } else { None };
        self.wires = used
            .chain(of_cells)
            .chain(of_memories)
            .filter_map(wire)
            .max()
            .map_or(0, |most| most + 1);
        let mut driver = vec![None; self.wires];
        for (at, cell) in self.cells.iter().enumerate() {
            cell.output.iter().copied().filter_map(wire).for_each(|it| driver[it] = Some(at));
        }
        let mut place = vec![0; self.cells.len()];
        // A cell that is open waits for one that it reads.
        let (mut open, mut done) = (vec![false; self.cells.len()], 0);
        for root in 0..self.cells.len() {
            let mut pending = vec![root];
            while let Some(&at) = pending.last() {
                if place[at] > 0 {
                    pending.pop();
                    continue;
                }
                let before = all(&self.cells[at]).into_iter().filter_map(wire);
                let before = before.filter_map(|it| driver[it]).find(|&it| place[it] == 0);
                match before {
                    Some(before) => {
                        ensure!(!open[at] || !open[before], "the text has a combinational loop");
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
        let mut cells: Vec<_> = place.into_iter().zip(self.cells.drain(..)).collect();
        cells.sort_by_key(|&(place, _)| place);
        self.cells = cells.into_iter().map(|(_, cell)| cell).collect();
        Ok(())
    }

    /// Returns the contents of registers at power-up, which are unknown.
    pub fn power_up(&self, terms: &mut VectorTerms) -> RegisterContents {
        self.registers.iter().map(|it| unknown(terms, it.output.len())).collect()
    }

    /// Returns the value of every wire, from the inputs and the read ports of memories that are written.
    ///
    /// # Errors
    /// Fails if a cell is not known here, or wider than terms are.
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
                    .with_context(|| format!("a cell `{kind}` of the text"))?,
            };
            values.set(&cell.output, &result);
        }
        Ok(values)
    }

    /// Returns the rising edge.
    pub fn edge(&self, terms: &mut VectorTerms, values: &WireValues) -> RegisterContents {
        self.registers.iter().map(|it| values.columns(terms, &it.data)).collect()
    }

    /// Returns the outputs by name.
    pub fn shown(
        &self,
        terms: &mut VectorTerms,
        values: &WireValues,
    ) -> HashMap<String, VectorTermId> {
        let outputs = self.outputs.iter();
        outputs.map(|(name, bits)| (name.clone(), values.word(terms, bits))).collect()
    }
}

impl Memory {
    /// Returns any word: a new unknown.
    pub fn any(&self, terms: &mut VectorTerms) -> Vec<VectorTermId> {
        unknown(terms, self.width)
    }

    /// Returns the values that are written.
    pub fn written(&self, terms: &mut VectorTerms, values: &WireValues) -> Vec<VectorTermId> {
        values.columns(terms, &self.write.data)
    }

    /// Returns the addresses of the write port and of each read port, and the enable of the write port.
    pub fn control(&self, terms: &mut VectorTerms, values: &WireValues) -> Vec<VectorTermId> {
        let write = values.columns(terms, &self.write.enable);
        let addresses = [&self.write.address].into_iter().chain(&self.addresses);
        let addresses: Vec<VectorTermId> = addresses.map(|bits| values.word(terms, bits)).collect();
        addresses.into_iter().chain(write).collect()
    }
}

fn unknown(terms: &mut VectorTerms, width: usize) -> Vec<VectorTermId> {
    let columns = (0..width).step_by(MAX_WIDTH as usize);
    columns.map(|at| terms.unknown((width - at).min(MAX_WIDTH as usize) as u32)).collect()
}

/// Returns the contents of a memory that is never written. The last digits of `INIT` are word 0. For example, `1101`
/// with words of 2 bits has word 0 = 1 and word 1 = 3.
fn words(cell: &Value, width: usize) -> Result<Vec<u64>> {
    let contents = cell["parameters"]["INIT"].as_str().unwrap_or_default();
    ensure!(width <= MAX_WIDTH as usize, "its words have more than 64 bits");
    let words = contents.as_bytes().rchunks(width).map(|word| {
        let word = std::str::from_utf8(word).ok().and_then(|it| u64::from_str_radix(it, 2).ok());
        word.context("it is never written, and has words without contents")
    });
    let words = words.collect::<Result<Vec<u64>>>()?;
    ensure!(words.len() == number(&cell["parameters"]["SIZE"])?, "its contents have another size");
    Ok(words)
}
