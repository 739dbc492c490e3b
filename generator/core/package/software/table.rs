//! Generates `<name>_table.h`, with which a program writes images into the table of a core, and a header for each image.

use anyhow::Result;
use glint_base::{fill, text};

use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::map::Map;
use crate::package::output_files::OutputFiles;
use crate::package::table_image::{TableImage, TableLayout};
use glint_rtl::netlist::TABLE_ADDRESS;
use glint_rtl::verilog::text::{ascii, constant_name};

/// The first eight bytes of an image as a file, as a little-endian number in hexadecimal.
const MAGIC: &str = "424154544e494c47";

/// Adds the headers. A core without a writable table has none.
///
/// # Errors
/// Fails if a template fails.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let Some(layout) = TableLayout::of(job.design) else { return Ok(()) };
    let name = job.name();
    let parts = layout.parts.iter().map(|(port, format)| format!("{port}, {format}")).collect();
    let (kind, unsigned) = match layout.is_narrow() {
        true => ("int32_t", "uint32_t"),
        false => ("int64_t", "uint64_t"),
    };
    let registers = job.registers.as_ref().map_or_else(Vec::new, |(_, map)| part_registers(map));
    let header = fill!("table.h" {
        name: &'a str,
        title: String = plain(&job.design.about.title),
        regenerate: &'a str = job.regenerate(),
        prefix: String = constant_name(name),
        layout: String = format!("{:016x}", layout.digest),
        magic: &'a str = MAGIC,
        words: usize = layout.words,
        parts: Vec<String>,
        kind: &'a str,
        unsigned: &'a str,
        // The constants of the registers, each with the number of its part and the lowest of its bits in this part.
        registers: Vec<(String, usize, u32)>,
    })?;
    files.add(FileKind::Software, format!("{name}_table.h"), header);
    for image in &job.inputs.images {
        let contents = image_header(name, job.regenerate(), &layout, image)?;
        files.add(FileKind::Software, image_file(name, &image.name), contents);
    }
    Ok(())
}

/// Returns the constant of each register that takes bits of a part, the number of the part, and the lowest of these bits in the
/// part.
fn part_registers(map: &Map) -> Vec<(String, usize, u32)> {
    let mut registers = Vec::new();
    for (number, port) in map.table.iter().enumerate() {
        for part in port.parts.iter().filter(|_| port.name != TABLE_ADDRESS) {
            let register = map.registers.iter().find(|register| register.place == part.place);
            let name = register.map_or("", |register| &register.name);
            registers.push((constant_name(name), number, part.low));
        }
    }
    registers
}

/// Returns the name of the header of an image, such as `fog_table_exp2.h`.
pub fn image_file(core: &str, image: &str) -> String {
    format!("{core}_table_{image}.h")
}

/// Returns the header with the words of an image for the core `name`. `regenerate` is the command that makes the header again.
///
/// # Errors
/// Fails if the template fails.
pub fn image_header(
    name: &str,
    regenerate: &str,
    layout: &TableLayout,
    image: &TableImage,
) -> Result<String> {
    let mut words = Vec::new();
    for word in &image.words {
        let parts: Vec<String> = word.iter().map(i64::to_string).collect();
        words.push(parts.join(", "));
    }
    fill!("table_image.h" {
        name: &'a str,
        image: &'a str = &image.name,
        formula: String = plain(&image.formula),
        bound: String = text::rounded_up(image.bound, 4),
        regenerate: &'a str,
        prefix: String = constant_name(name),
        constant: String = constant_name(&image.name),
        layout: String = format!("{:016x}", layout.digest),
        checksum: String = format!("{:08x}", layout.checksum(image)),
        words: Vec<String>,
    })
}

/// Returns `text` for a comment in C.
fn plain(text: &str) -> String {
    ascii(text).replace("*/", "* /")
}
