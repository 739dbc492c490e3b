//! Synthesises a design for an FPGA family with Yosys, and counts the cells: LUTs, flip-flops, DSP blocks and block RAMs.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use super::Tool;
use super::sources::YosysSources;
pub use glint_base::target::Usage;
use glint_base::target::{Family, Kinds};

/// The smallest of the netlists that a family's commands produce.
pub struct SmallestNetlist {
    /// The numbers of cells.
    pub usage: Usage,
    /// The command that produced the netlist, without the top module's name.
    pub command: &'static str,
}

/// Synthesises the module `top` with each of the family's commands, and returns the flat netlist with the fewest look-up tables.
///
/// # Errors
/// Fails if the files cannot be written, if Yosys fails or takes longer than `limit`, or if Yosys's statistics lack the cells of
/// `top`.
pub fn synthesise(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    family: &Family,
    limit: Duration,
) -> Result<SmallestNetlist> {
    let mut smallest: Option<SmallestNetlist> = None;
    for command in family.commands {
        let sources = YosysSources::new(yosys, files, limit)?;
        let script = family.script_with(command, top);
        sources.run(&format!("{script}; {}", statistics_commands(family)))?;
        let usage = usage(&sources, top, family)
            .with_context(|| format!("`{command}` for {}", family.title))?;
        if smallest.as_ref().is_none_or(|smallest| usage.luts < smallest.usage.luts) {
            smallest = Some(SmallestNetlist { usage, command });
        }
    }
    smallest.with_context(|| format!("Glint has no commands for {}", family.title))
}

/// Returns the commands of Yosys that write the files for [`usage`]. A script must have these commands after the synthesis.
pub fn statistics_commands(family: &Family) -> &'static str {
    match cell_of_products(family) {
        None => "tee -q -o statistics.json stat -json",
        // The statistics do not contain the widths of products.
        Some(_) => "tee -q -o statistics.json stat -json; write_json cells.json",
    }
}

/// Returns the numbers of cells of the module `top`. Fails if a file does not exist, is no JSON, or does not list the cells of
/// `top`.
pub fn usage(sources: &YosysSources, top: &str, family: &Family) -> Result<Usage> {
    let text = sources.text("statistics.json").context("`yosys` wrote no statistics")?;
    let statistics: Value =
        serde_json::from_str(&text).context("the statistics of `yosys` are not JSON")?;
    // The netlist is flat, so the top module has all cells.
    let cells =
        statistics["modules"][format!("\\{top}")]["num_cells_by_type"].as_object().with_context(
            || format!("the statistics of `yosys` do not contain the cells of `{top}`"),
        )?;
    let count = |kinds: Kinds| {
        let number = |kind: &str| cells.get(kind).and_then(Value::as_u64).unwrap_or(0);
        kinds.iter().map(|(kind, weight)| number(kind) * weight).sum()
    };
    let in_products = match cell_of_products(family) {
        Some((kind, luts)) => luts_of_products(sources, top, kind, luts)?,
        None => 0,
    };
    let luts: u64 = count(family.luts);
    Ok(Usage {
        luts: luts + in_products,
        dsps: count(family.dsps),
        block_rams: count(family.block_rams),
        flip_flops: count(family.flip_flops),
    })
}

/// The number of look-up tables of a product, from the widths of its operands in bits.
type LutsOfProduct = fn(u64, u64) -> u64;

/// Returns the cell of a netlist of the family that multiplies in look-up tables. Returns `None` if the family has no such cell.
fn cell_of_products(family: &Family) -> Option<(&'static str, LutsOfProduct)> {
    let product = family.fabric_product?;
    Some((product.cell?, product.luts))
}

/// Counts the look-up tables of all products in the netlist of `top`. The products are cells of this `kind`, and `luts` gives
/// the look-up tables of one cell from its two operand widths. Fails if the netlist has no cells, or if a cell does not state
/// its widths.
fn luts_of_products(
    sources: &YosysSources,
    top: &str,
    kind: &str,
    luts: LutsOfProduct,
) -> Result<u64> {
    let netlist = sources.json("cells.json")?;
    let cells = netlist["modules"][top]["cells"].as_object();
    let cells = cells.with_context(|| format!("the netlist of `yosys` has no cells of `{top}`"))?;
    let mut sum = 0;
    for cell in cells.values() {
        if cell["type"] == kind {
            sum += luts(number(cell, "A_WIDTH")?, number(cell, "B_WIDTH")?);
        }
    }
    Ok(sum)
}

/// Returns a numeric parameter of a cell. Yosys writes the parameter in binary, such as `00001001` for 9.
fn number(cell: &Value, parameter: &str) -> Result<u64> {
    let digits = cell["parameters"][parameter].as_str();
    let value = digits.and_then(|digits| u64::from_str_radix(digits, 2).ok());
    value.with_context(|| {
        format!("the netlist of `yosys` does not contain the {parameter} of a cell")
    })
}

/// Returns the major and the minor number of a version. For example, `Yosys 0.70 (git sha1 …)` gives 0 and 70.
pub fn yosys_version(text: &str) -> Option<(u32, u32)> {
    let numbers = text.strip_prefix("Yosys ")?;
    let (major, rest) = numbers.split_once('.')?;
    let minor: String = rest.chars().take_while(char::is_ascii_digit).collect();
    Some((major.parse().ok()?, minor.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::yosys_version;

    #[test]
    fn versions_are_read() {
        assert_eq!(yosys_version("Yosys 0.70 (git sha1 28ba3cb92)"), Some((0, 70)));
        assert_eq!(yosys_version("Yosys 0.23+14 (git sha1 1)"), Some((0, 23)));
        assert_eq!(yosys_version("Yosys"), None);
    }
}
