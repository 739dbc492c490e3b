//! Checks rules of the description language that a netlist alone does not express: on operands, shared products and the
//! microprogram. For example, an operand on which no output depends is a mistake.

mod operands;
mod products;
mod program;
mod unused;

use std::collections::{HashMap, HashSet};

use super::SelectedProduct;
use crate::netlist::{Design, FieldId, NetId};
use glint_base::diagnostic::Diagnostic;
pub(super) use operands::read_by;
pub(super) use unused::warnings;

/// `views` has the nets that carry a product of a shared multiplier, each with the selection under which it is this product.
/// `picked` has the fields to which some microinstruction gives a value.
pub(super) fn check(
    design: &Design,
    views: &HashMap<NetId, SelectedProduct>,
    picked: &HashSet<FieldId>,
) -> Vec<Diagnostic> {
    let mut found = products::check(design, views);
    found.extend(program::check(design, picked));
    found.extend(operands::check(design));
    found
}
