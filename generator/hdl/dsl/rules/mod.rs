//! What a description must be beyond a sound netlist.

mod operands;
mod products;
mod program;

use std::collections::HashMap;

use super::SelectedProduct;
use crate::base::diagnostic::Diagnostic;
use crate::hdl::netlist::{Design, NetId};

/// Every rule that `design` breaks; `views` are the products that a selection gives their meaning.
pub(super) fn check(design: &Design, views: &HashMap<NetId, SelectedProduct>) -> Vec<Diagnostic> {
    let mut found = products::check(design, views);
    found.extend(program::check(design));
    found.extend(operands::check(design));
    found
}
