//! A first look at a design, so that nothing later can index what is not there.

use anyhow::{Result, ensure};

use crate::base::fixed::MAX_WIDTH;
use crate::hdl::netlist::{Design, Driver, NetId};

/// Checks that everything that is referred to exists and that widths are possible.
///
/// # Errors
/// What does not, or the net whose width is not.
pub(super) fn check(design: &Design) -> Result<()> {
    let nets = design.nets.len();
    let exists = |net: NetId| ensure_index(net.index(), nets, "net");
    for net in &design.nets {
        let format = net.format;
        let width =
            i64::from(format.int) + i64::from(format.frac) + i64::from(u8::from(format.signed));
        ensure!(
            (1..=i64::from(MAX_WIDTH)).contains(&width),
            "net `{}` is {width} bits wide; 1 to {MAX_WIDTH} are possible",
            net.name
        );
        match &net.driver {
            Driver::Register(id) => ensure_index(id.index(), design.registers.len(), "register")?,
            Driver::Rom(id) => ensure_index(id.index(), design.roms.len(), "ROM")?,
            Driver::Field(id) => {
                ensure_index(id.index(), design.control.fields.len(), "field")?;
            }
            Driver::Op(op) => op.operands().into_iter().try_for_each(exists)?,
            Driver::Undriven | Driver::Input | Driver::Constant(_) => {}
        }
    }
    for register in &design.registers {
        [Some(register.q), register.data, register.enable]
            .into_iter()
            .flatten()
            .try_for_each(exists)?;
    }
    for rom in &design.roms {
        [Some(rom.address), Some(rom.data), rom.enable]
            .into_iter()
            .flatten()
            .try_for_each(exists)?;
    }
    for port in &design.ports {
        exists(port.net)?;
    }
    if !design.control.fields.is_empty() {
        ensure_index(design.control.rom.index(), design.roms.len(), "ROM")?;
    }
    for field in &design.control.fields {
        exists(field.net)?;
    }
    Ok(())
}

fn ensure_index(index: usize, len: usize, what: &str) -> Result<()> {
    ensure!(index < len, "{what} {index} is referred to, but there are {len}");
    Ok(())
}
