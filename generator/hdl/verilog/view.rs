//! The views that the Verilog templates print: strings and lists of strings, every decision taken.

use askama::Template;

/// A titled block of declarations.
pub struct Section {
    /// Its comment.
    pub title: &'static str,
    /// Its lines, indented.
    pub lines: Vec<String>,
}

/// The control unit or the datapath.
#[derive(Template)]
#[template(path = "module.v")]
pub struct Module {
    /// Comment lines.
    pub header: Vec<String>,
    /// Its name.
    pub name: String,
    /// Parameters with default and comma.
    pub parameters: Vec<String>,
    /// Ports with comma and comment.
    pub ports: Vec<String>,
    /// Localparams, registers.
    pub declarations: Vec<Section>,
    /// The values of registers before the first clock: statements.
    pub initial: Vec<String>,
    /// Combinational cells and ROMs, operands first.
    pub items: Vec<Spaced>,
    /// The bodies of the clocked blocks.
    pub groups: Vec<Vec<String>>,
    /// The net that takes the bits that nobody reads, or nothing.
    pub unused: Vec<String>,
    /// Invariants, for formal tools alone.
    pub formal: Vec<String>,
}

/// A net with what drives it, and the space above it.
pub struct Spaced {
    /// An empty line comes first.
    pub gap: bool,
    /// The net.
    pub item: Item,
}

/// A net with what drives it.
pub enum Item {
    /// A continuous assignment.
    Assign(Vec<String>),
    /// A mux of more than two inputs.
    Case {
        /// Comment lines.
        comment: Vec<String>,
        /// The `reg`, unless it is a port.
        declaration: Vec<String>,
        /// The select expression.
        select: String,
        /// One a value.
        arms: Vec<String>,
        /// The last arm.
        default: Vec<String>,
    },
    /// A memory and its read port.
    Rom(RomItem),
    /// An instance, and what it drives.
    Instance {
        /// The nets that it drives.
        declaration: Vec<String>,
        /// The instance.
        instance: Instance,
    },
}

/// A memory and its read port.
pub struct RomItem {
    /// Comment lines.
    pub comment: Vec<String>,
    /// It is the second read port of a memory that is there.
    pub second: bool,
    /// Before the declaration, with a space behind it.
    pub attribute: String,
    /// `[7:0]`.
    pub range: String,
    /// The range of the number of a word, of a memory that is a function.
    pub number: String,
    /// The name of that number there.
    pub at: String,
    /// The name of the memory, or of the function.
    pub memory: String,
    /// The number of the last word.
    pub last: usize,
    /// Where its words are.
    pub contents: Contents,
    /// The statement that reads a word.
    pub read: Vec<String>,
}

/// Where the words of a memory are.
pub enum Contents {
    /// In a file.
    File {
        /// `b` or `h`.
        radix: char,
        /// The parameter with the file name.
        parameter: String,
    },
    /// Here: statements.
    Inline(Vec<String>),
    /// Here: the choices of a case.
    Case(Vec<String>),
}

/// The top module.
#[derive(Template)]
#[template(path = "top.v")]
pub struct Top {
    /// Comment lines.
    pub header: Vec<String>,
    /// Its name.
    pub name: String,
    /// Parameters with default and comma.
    pub parameters: Vec<String>,
    /// Ports with comma and comment.
    pub ports: Vec<String>,
    /// The wires between the two units.
    pub declarations: Vec<Section>,
    /// The two units.
    pub instances: Vec<Instance>,
}

/// An instance of a unit.
pub struct Instance {
    /// The module.
    pub module: String,
    /// The instance.
    pub name: String,
    /// Parameters with comma.
    pub parameters: Vec<String>,
    /// Ports with comma.
    pub connections: Vec<String>,
}

/// A pipeline: one module, stage by stage.
#[derive(Template)]
#[template(path = "pipeline.v")]
pub struct PipelineModule {
    /// Comment lines.
    pub header: Vec<String>,
    /// Its name.
    pub name: String,
    /// Parameters with default and comma.
    pub parameters: Vec<String>,
    /// Ports with comma and comment.
    pub ports: Vec<String>,
    /// Localparams.
    pub constants: Vec<String>,
    /// The handshake, the stages, the outputs.
    pub stages: Vec<StageSection>,
    /// The net that takes the bits that nobody reads, or nothing.
    pub unused: Vec<String>,
    /// The name of the module of delay lines, if there are any.
    pub delay: Option<String>,
}

/// A part of a pipeline.
pub struct StageSection {
    /// Comment lines.
    pub title: Vec<String>,
    /// Declarations of what ROMs are read into on the clock.
    pub words: Vec<String>,
    /// Combinational cells and ROMs, operands first.
    pub items: Vec<Spaced>,
    /// The registers that end it: declarations, and the block in which they take their values.
    pub registers: Vec<String>,
}
