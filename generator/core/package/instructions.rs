//! Lays out the instructions by which a processor calls a core: their function ids, and the bits of the two source registers that
//! the operands take.
//!
//! An instruction of RISC-V has ten bits for its user, funct7 and funct3, here together the *function id*. The lowest four bits
//! of the function id are the opcode of a unit, and 0 for a core without functions. The six bits above are the number of the
//! result that the instruction returns.

use anyhow::{Result, bail};

use super::inputs::EmitInputs;
use super::wrap::started::{colliding_port, started};
use glint_base::config_error::ConfigError;
use glint_base::fixed::Format;
use glint_rtl::netlist::{CoreFunction, Design, FunctionPort, OPCODE, Port, Role};

/// The key that asks for instructions.
pub const KEY: &str = "interface.processor";

/// The number of bits of the function id for the opcode.
pub const OPCODE_BITS: u32 = 4;

/// The number of bits of a source register or of the answer.
const WORD: u32 = 32;

/// The most results of a core, as six bits can number them.
const MOST_RESULTS: usize = 64;

/// The position of an operand of the core in the two source registers.
pub struct OperandBits {
    pub port: String,
    /// The port that writes the operand.
    pub strobe: String,
    pub format: Format,
    /// The source register, 0 or 1.
    pub word: u32,
    /// The operand's lowest bit in the source register.
    pub low: u32,
}

pub struct ResultPort {
    pub port: String,
    pub format: Format,
}

/// An operand of an instruction: a number in the low bits of a port of the core.
pub struct InstructionOperand {
    pub name: String,
    pub format: Format,
    /// The index in [`Instructions::operands`].
    pub place: usize,
}

/// An instruction: one result of one function.
pub struct CoreInstruction {
    /// The function id, funct7 above funct3.
    pub id: u32,
    /// The name of the function of a unit; empty for another core.
    pub function: String,
    /// The result, without `_out` at the end of its name.
    pub result: String,
    /// Whether the function has further results.
    pub is_one_of_several: bool,
    /// The formula and its error on one line; may be empty.
    pub doc: String,
    pub operands: Vec<InstructionOperand>,
    /// The format of the result in the low bits of the answer.
    pub format: Format,
    /// Whether the answer is already extended by the sign of the result.
    pub is_extended: bool,
}

impl CoreInstruction {
    pub fn funct3(&self) -> u32 {
        self.id & 7
    }

    pub fn funct7(&self) -> u32 {
        self.id >> 3
    }

    /// Returns the function and, if it has several results, the result: `sincos_sine`. For a core without functions it is the result.
    pub fn name(&self) -> String {
        match (self.function.as_str(), self.is_one_of_several) {
            ("", _) => self.result.clone(),
            (function, false) => function.to_owned(),
            (function, true) => format!("{function}_{}", self.result),
        }
    }
}

/// All instructions of a core.
pub struct Instructions {
    /// The operands but for the opcode, in the order of the ports.
    pub operands: Vec<OperandBits>,
    /// The strobe of the opcode and its number of bits, for a unit.
    pub opcode: Option<(String, u32)>,
    pub results: Vec<ResultPort>,
    /// The instructions in the order of their function ids.
    pub list: Vec<CoreInstruction>,
}

impl Instructions {
    /// # Errors
    /// Fails if the core computes several results after one `start`, lacks the handshake or a result, if a result has more than 32
    /// bits, or if the operands do not fit into two registers of 32 bits.
    pub fn new(core: &Design, inputs: &EmitInputs) -> Result<Self> {
        let name = core.name.as_str();
        if let Some(message) = colliding_port(core, None) {
            bail!(refused(message, "rename the operand or the result with this name"));
        }
        let length = inputs.accuracy.as_ref().and_then(|accuracy| accuracy.length.as_ref());
        if let Some(length) = length {
            let message = format!(
                "`{name}` computes a line of `{length}` results, and an instruction returns one"
            );
            bail!(refused(message, "remove the key; for such a core, set interface.stream = true"));
        }
        let started = started(core, None);
        let design = started.as_ref();
        design.handshake()?;
        let opcode_bits = core.opcode_bits();
        let mut opcode = None;
        let mut ports = Vec::new();
        for port in design.inputs() {
            let Role::Operand { strobe } = port.role else { continue };
            let strobe = design.net(strobe).name.clone();
            match opcode_bits {
                Some(bits) if design.net(port.net).name == OPCODE => opcode = Some((strobe, bits)),
                _ => ports.push((port, strobe)),
            }
        }
        let operands = placed(design, ports)?;
        let results = results(design)?;
        let list = match core.functions.as_slice() {
            [] => of_core(&operands, &results),
            _ => of_functions(core, &operands, &results)?,
        };
        Ok(Self { operands, opcode, results, list })
    }
}

fn refused(message: String, remedy: &str) -> ConfigError {
    ConfigError::new(KEY, message, remedy)
}

/// Gives each of two operands a register. More operands follow each other in the two registers without gaps.
fn placed(design: &Design, ports: Vec<(&Port, String)>) -> Result<Vec<OperandBits>> {
    let has_own = ports.len() <= 2;
    let (mut word, mut low) = (0, 0);
    let mut operands = Vec::new();
    for (port, strobe) in ports {
        let net = design.net(port.net);
        let width = net.format.width();
        if low > 0 && (has_own || low + width > WORD) {
            (word, low) = (word + 1, 0);
        }
        if width > WORD || word > 1 {
            let message = match width > WORD {
                true => format!(
                    "the operand `{}` has {width} bits, and a register of the processor has {WORD}",
                    net.name
                ),
                false => format!(
                    "the operands of `{}` do not fit into the two source registers of an instruction",
                    design.name
                ),
            };
            bail!(refused(message, "use fewer bits, or set interface.registers = \"wishbone\""));
        }
        let (port, format) = (net.name.clone(), net.format);
        operands.push(OperandBits { port, strobe, format, word, low });
        low += width;
    }
    Ok(operands)
}

fn results(design: &Design) -> Result<Vec<ResultPort>> {
    let mut results = Vec::new();
    for port in design.outputs().filter(|port| port.role == Role::Result) {
        let net = design.net(port.net);
        let width = net.format.width();
        if width > WORD {
            let message = format!(
                "the result `{}` has {width} bits, and a register of the processor has {WORD}",
                net.name
            );
            bail!(refused(message, "use fewer bits, or set interface.registers = \"wishbone\""));
        }
        results.push(ResultPort { port: net.name.clone(), format: net.format });
    }
    if !(1..=MOST_RESULTS).contains(&results.len()) {
        let message = format!(
            "`{}` has {} results; a core with instructions has 1 to {MOST_RESULTS}",
            design.name,
            results.len()
        );
        bail!(refused(message, "remove the key"));
    }
    Ok(results)
}

/// Returns an instruction for each result of a core without functions.
fn of_core(operands: &[OperandBits], results: &[ResultPort]) -> Vec<CoreInstruction> {
    let mut list = Vec::new();
    for (number, result) in results.iter().enumerate() {
        let operand = |(place, it): (usize, &OperandBits)| InstructionOperand {
            name: it.port.clone(),
            format: it.format,
            place,
        };
        list.push(CoreInstruction {
            id: (number as u32) << OPCODE_BITS,
            function: String::new(),
            result: without_suffix(&result.port),
            is_one_of_several: results.len() > 1,
            doc: String::new(),
            operands: operands.iter().enumerate().map(operand).collect(),
            format: result.format,
            is_extended: true,
        });
    }
    list
}

/// Returns an instruction for each result of each function of a unit. Fails if a function names a port that the core lacks.
fn of_functions(
    core: &Design,
    operands: &[OperandBits],
    results: &[ResultPort],
) -> Result<Vec<CoreInstruction>> {
    let no_port = |function: &CoreFunction, port: &str| {
        let message =
            format!("the function `{}` names a port `{port}`, which the core lacks", function.name);
        refused(message, "name ports of the core in the functions of the description")
    };
    let mut list = Vec::new();
    for (opcode, function) in core.functions.iter().enumerate() {
        for result in &function.results {
            let number = results.iter().position(|it| it.port == result.port);
            let number = number.ok_or_else(|| no_port(function, &result.port))?;
            let mut own_operands = Vec::new();
            for FunctionPort { port, name, format, .. } in &function.operands {
                let place = operands.iter().position(|operand| operand.port == *port);
                let place = place.ok_or_else(|| no_port(function, port))?;
                own_operands.push(InstructionOperand {
                    name: name.clone(),
                    format: *format,
                    place,
                });
            }
            list.push(CoreInstruction {
                id: (number as u32) << OPCODE_BITS | opcode as u32,
                function: function.name.clone(),
                result: result.name.clone(),
                is_one_of_several: function.results.len() > 1,
                doc: result.doc.clone(),
                operands: own_operands,
                format: result.format,
                is_extended: results[number].format.signed,
            });
        }
    }
    list.sort_by_key(|instruction| instruction.id);
    Ok(list)
}

fn without_suffix(port: &str) -> String {
    port.strip_suffix("_out").unwrap_or(port).to_owned()
}
