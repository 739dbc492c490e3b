//! How nextpnr-himbaechel measures a core on the FPGA family GateMate. It times every cell: products are arrays of logic cells, and
//! it knows the delays of block RAMs.

use super::nextpnr::Recipe;
use glint_show::figures::Target;

pub const RECIPE: Recipe =
    Recipe { target: Target::Gatemate, speed: "", options: "", goal: 150, prepare: |_, _| Ok(()) };
