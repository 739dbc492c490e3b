//! Generates declarations of a core's modules for designs in other languages: `<name>.vhd` for VHDL, and `<name>_pkg.sv` for
//! SystemVerilog.
//!
//! The VHDL file has a component for each module, and an entity around the core with fixed-point types at its ports. The
//! SystemVerilog package has a type, limits and conversion functions for each operand and result. The hardware itself stays
//! in Verilog.

use anyhow::Result;
use glint_base::fill;
use glint_base::fixed::{Format, exp2};

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use super::tops::{Face, Top, TopPort};
use super::wrap::fields::Transfer;
use glint_rtl::netlist::Role;
use glint_rtl::verilog::rows::separated;
use glint_rtl::verilog::text::{Names, ascii, comment, constant_name, literal};

/// Adds the files that the configuration asks for.
///
/// # Errors
/// Fails if a template fails, or if the configuration asks for streams and a package of SystemVerilog, and the core has no
/// operands or no results.
pub fn files(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    if job.inputs.around.vhdl {
        let text = vhdl(job, tops)?;
        files.add(FileKind::Vhdl, format!("{}.vhd", job.name()), text);
    }
    if job.inputs.around.systemverilog {
        let text = systemverilog(job)?;
        files.add(FileKind::SystemVerilogPackage, format!("{}_pkg.sv", job.name()), text);
    }
    Ok(())
}

fn is_number(role: Role) -> bool {
    matches!(role, Role::Operand { .. } | Role::Point | Role::Result)
}

struct VhdlComponent<'a> {
    name: String,
    what: &'a str,
    generics: Vec<String>,
    ports: Vec<String>,
}

/// `of_core` are the generics of the core; wrappers have none.
fn component<'a>(top: &'a Top, of_core: &[String]) -> VhdlComponent<'a> {
    VhdlComponent {
        name: module_name(&top.module),
        what: &top.what,
        generics: if top.face == Face::Core { of_core.to_vec() } else { Vec::new() },
        ports: listed(top.ports.iter().map(plain).collect()),
    }
}

/// Writes components of all modules, and an entity around the core whose ports have fixed-point types.
fn vhdl(job: &EmitJob, tops: &[Top]) -> Result<String> {
    let (name, design, naming) = (job.name(), job.design, job.naming);
    let (mut generics, mut passed) = (Vec::new(), Vec::new());
    for (at, rom) in design.roms.iter().enumerate() {
        if rom.shares.is_none() && !naming.style.inline {
            let (name, file) = (vhdl_name(&naming.parameters[at]), &naming.files[at]);
            generics.push(format!("{name} : string := \"{file}\""));
            passed.push(format!("{name} => {name}"));
        }
    }
    let generics = listed(generics);
    // For each result: the wire to the component, its type, and the assignment.
    let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
    let mut outputs = Vec::new();
    let (mut ports, mut connections) = (vec!["clk : in std_logic".to_owned()], Vec::new());
    connections.push("clk => clk".to_owned());
    for port in &design.ports {
        let net = design.net(port.net);
        let (own, format) = (vhdl_name(&net.name), net.format);
        let direction = if port.role.is_input() { "in" } else { "out" };
        let plain = std_logic(format.width(), format.width() > 1);
        let number = is_number(port.role);
        let kind = if number { fixed(format) } else { plain.clone() };
        ports.push(format!("{own} : {direction} {kind}"));
        let one_bit = format.width() == 1;
        connections.push(match (number, port.role.is_input()) {
            (false, _) => format!("{own} => {own}"),
            (true, _) if one_bit => format!("{own} => {own}({own}'low)"),
            (true, true) => format!("{own} => to_slv({own})"),
            (true, false) => {
                let wire = vhdl_name(&names.fresh(&format!("{}_bits", net.name)));
                let conversion = if format.signed { "to_sfixed" } else { "to_ufixed" };
                let bounds = format!("{own}'high, {own}'low");
                let assignment = format!("{own} <= {conversion}({wire}, {bounds})");
                outputs.push((wire.clone(), plain, assignment));
                format!("{own} => {wire}")
            }
        });
    }
    fill!("vhdl.vhd" {
        name: &'a str,
        component: String = module_name(name),
        package: String = vhdl_name(&format!("{name}_components")),
        entity: String = vhdl_name(&format!("{name}_fixed")),
        label: String = vhdl_name(&names.fresh("core")),
        regenerate: &'a str = job.regenerate(),
        components: Vec<VhdlComponent<'a>> = tops.iter().map(|top| component(top, &generics)).collect(),
        generics: Vec<String>,
        // The generics of the entity. The component has the same generics.
        passed: Vec<String> = separated(passed),
        ports: Vec<String> = listed(ports),
        outputs: Vec<(String, String, String)>,
        connections: Vec<String> = separated(connections),
    })
}

/// Adds a semicolon behind each declaration but the last, as VHDL requires for ports and generics.
fn listed(mut declarations: Vec<String>) -> Vec<String> {
    let last = declarations.len().saturating_sub(1);
    declarations.iter_mut().take(last).for_each(|line| line.push(';'));
    declarations
}

fn plain(port: &TopPort) -> String {
    let direction = if port.input { "in" } else { "out" };
    format!("{} : {direction} {}", vhdl_name(&port.name), std_logic(port.width, port.vector))
}

/// Returns for example `std_logic_vector(7 downto 0)` if `vector` is true, and otherwise `std_logic`.
fn std_logic(width: u32, vector: bool) -> String {
    match vector {
        false => "std_logic".to_owned(),
        true => format!("std_logic_vector({} downto 0)", width - 1),
    }
}

/// Returns a fixed-point type whose bits are numbered by their weights: `u1.20` becomes `ufixed(0 downto -20)`.
fn fixed(format: Format) -> String {
    let kind = if format.signed { "sfixed" } else { "ufixed" };
    let low = -format.frac;
    format!("{kind}({} downto {low})", low + format.width() as i32 - 1)
}

/// Returns a name for VHDL. A name that VHDL does not accept, or that has an upper-case letter, becomes an extended identifier
/// between backslashes: the reserved word `signal` becomes `\signal\`.
fn vhdl_name(name: &str) -> String {
    let reserved = VHDL_2008.split_ascii_whitespace().any(|word| word == name.to_ascii_lowercase());
    let plain = !name.starts_with('_') && !name.ends_with('_') && !name.contains("__");
    let small = !name.chars().any(|sign| sign.is_ascii_uppercase());
    // The generics, all of them upper case, are the only names for which case does not matter.
    let generic = name.contains("_FILE") && name.to_ascii_uppercase() == name;
    if plain && !reserved && (small || generic) { name.to_owned() } else { format!("\\{name}\\") }
}

/// A module name that the emitted package uses itself, such as `ieee`, also becomes an extended identifier.
fn module_name(name: &str) -> String {
    let used = ["ieee", "work", "std", "std_logic", "std_logic_vector", "std_ulogic", "string"];
    if used.contains(&name) { format!("\\{name}\\") } else { vhdl_name(name) }
}

/// The reserved words of IEEE 1076-2008.
const VHDL_2008: &str = "
    abs access after alias all and architecture array assert assume assume_guarantee attribute
    begin block body buffer bus case component configuration constant context cover default
    disconnect downto else elsif end entity exit fairness file for force function generate generic
    group guarded if impure in inertial inout is label library linkage literal loop map mod nand
    new next nor not null of on open or others out package parameter port postponed procedure
    process property protected pure range record register reject release rem report restrict
    restrict_guarantee return rol ror select sequence severity shared signal sla sll sra srl
    strong subtype then to transport type unaffected units until use variable vmode vprop vunit
    wait when while with xnor xor
";

/// An operand or a result as the SystemVerilog package declares it, with a type and conversion functions.
struct VerilogConstant {
    name: String,
    constant: String,
    /// The type in SystemVerilog, for example `cos_gamma_t`.
    kind: String,
    doc: Vec<String>,
    format: Format,
}

impl VerilogConstant {
    /// Returns 2^−F for F fraction bits as a SystemVerilog real.
    fn unit(&self) -> String {
        format!("{:?}", exp2(-self.format.frac))
    }

    /// Returns 2^F for F fraction bits as a SystemVerilog real.
    fn scale(&self) -> String {
        format!("{:?}", exp2(self.format.frac))
    }

    /// Returns the smallest and the largest raw value as SystemVerilog reals.
    fn limits(&self) -> (String, String) {
        let (low, high) = self.format.range();
        (format!("{:?}", low as f64), format!("{:?}", high as f64))
    }

    /// Returns the smallest value as a bit pattern: `{1'b1, 7'd0}` for 8 bits with a sign.
    fn least(&self) -> String {
        let width = self.format.width();
        match self.format.signed {
            true if width == 1 => "1'b1".to_owned(),
            true => format!("{{1'b1, {}}}", literal(0, width - 1)),
            false => literal(0, width),
        }
    }

    /// Returns the expression that converts the real `scaled`, which must be within the limits, to the raw integer. Verilator
    /// cannot convert a real above 2^63 to an integer.
    fn whole(&self) -> String {
        let plain = format!("{}'(longint'(scaled))", self.kind);
        match (self.format.signed, self.format.width()) {
            (false, 64) => format!(
                "scaled < 9223372036854775808.0 ? {plain} :\n            \
                 {{1'b1, 63'(longint'(scaled - 9223372036854775808.0))}}"
            ),
            _ => plain,
        }
    }

    fn most(&self) -> String {
        literal(self.format.max_raw() as u64, self.format.width())
    }
}

/// A transfer of a stream as a packed structure, with the members from the top bits down.
struct Structure {
    net: &'static str,
    members: Vec<String>,
}

/// Writes types, limits and conversions of all operands and results, and the layout of stream transfers.
fn systemverilog(job: &EmitJob) -> Result<String> {
    let (name, design) = (job.name(), job.design);
    let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
    let mut numbers: Vec<VerilogConstant> = Vec::new();
    for port in design.ports.iter().filter(|port| is_number(port.role)) {
        let net = design.net(port.net);
        let colon = if net.doc.is_empty() { "" } else { ": " };
        let doc = format!("{}, {}{colon}{}", net.name, net.format, ascii(&net.doc));
        numbers.push(VerilogConstant {
            name: net.name.clone(),
            constant: constant_name(&net.name),
            kind: names.fresh(&format!("{}_t", net.name)),
            doc: comment(4, &doc),
            format: net.format,
        });
    }
    let mut transfers = Vec::new();
    if job.inputs.around.stream {
        for (net, transfer) in
            [("s_axis_tdata", Transfer::sent(job)?), ("m_axis_tdata", Transfer::received(job)?)]
        {
            let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
            let mut filling = |name: &str, bits: u32| {
                (bits > 0).then(|| format!("logic [{}:0] {};", bits - 1, names.fresh(name)))
            };
            let mut members = Vec::new();
            members.extend(filling("above", transfer.bits - transfer.filled()));
            for field in transfer.fields.iter().rev() {
                let above = format!("above_{}", field.name);
                members.extend(filling(&above, field.padded() - field.width));
                let of = numbers.iter().find(|number| number.name == field.name);
                members.extend(of.map(|number| format!("{} {};", number.kind, number.name)));
            }
            transfers.push(Structure { net, members });
        }
    }
    fill!("formats.sv" {
        name: &'a str,
        package: String = format!("{name}_pkg"),
        regenerate: &'a str = job.regenerate(),
        numbers: Vec<VerilogConstant>,
        transfers: Vec<Structure>,
    })
}
