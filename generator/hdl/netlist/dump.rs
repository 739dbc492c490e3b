//! Prints a netlist as text, one line for each net. For example, a register may have the line `y: u0.8 [0, 255] <= y_rounded when
//! y_load`.

use std::fmt::{self, Write as _};

use super::{Design, Driver, NetId, Op};

/// Prints the name of the design, then one line for each port, net and microinstruction, each list in its order in the design.
/// Tests compare this text with stored texts.
impl fmt::Display for Design {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let name = |id: NetId| self.net(id).name.as_str();
        writeln!(f, "design {}", self.name)?;
        for port in &self.ports {
            let direction = if port.role.is_input() { "input" } else { "output" };
            writeln!(f, "{direction} {} {:?}", name(port.net), port.role)?;
        }
        for net in &self.nets {
            let (low, high) = net.range;
            write!(f, "{}: {} [{low}, {high}]", net.name, net.format)?;
            if let Some(block) = net.block {
                write!(f, " #{block}")?;
            }
            match &net.driver {
                Driver::Undriven => f.write_str(" undriven")?,
                Driver::Input => f.write_str(" input")?,
                Driver::Constant(bits) => write!(f, " = {bits}")?,
                Driver::Rom(rom) => {
                    let rom = self.rom(*rom);
                    let edge = if rom.synchronous { " on the clock" } else { "" };
                    write!(
                        f,
                        " = rom {}[{}]{edge}, {} words",
                        rom.name,
                        name(rom.address),
                        rom.words.len()
                    )?;
                }
                Driver::Field(field) => {
                    write!(f, " = field {}", self.control.fields[field.index()].name)?
                }
                Driver::Register(id) => {
                    let register = self.register(*id);
                    write!(f, " <= {}", register.data.map_or("nothing", name))?;
                    if let Some(enable) = register.enable {
                        write!(f, " when {}", name(enable))?;
                    }
                    if let Some(reset) = register.reset {
                        write!(f, " reset {reset}")?;
                    }
                }
                Driver::Op(op) => {
                    write!(f, " = {}", op.mnemonic())?;
                    for operand in op.operands() {
                        write!(f, " {}", name(operand))?;
                    }
                    if let Op::Slice { low, .. } = op {
                        write!(f, " from {low}")?;
                    }
                }
            }
            f.write_char('\n')?;
        }
        for (at, it) in self.control.microprogram.iter().enumerate() {
            writeln!(f, "microinstruction {at} {:?} {:?} {:?}", it.name, it.values, it.sequence)?;
        }
        Ok(())
    }
}
