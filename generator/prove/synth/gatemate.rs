//! Defines how nextpnr-himbaechel measures a core on the FPGA family GateMate.
//!
//! Products are arrays of logic cells. nextpnr-himbaechel knows the delays of logic cells and of block RAMs, so the module
//! checks no cell.

use super::nextpnr::Recipe;
use glint_show::figures::Target;

pub const RECIPE: Recipe =
    Recipe { target: Target::Gatemate, speed: "", options: "", goal: 150, prepare: |_, _| Ok(()) };
