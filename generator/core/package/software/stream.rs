//! Generates `<name>_stream.h` and `<name>_stream.py`: functions that pack operands into the bytes of an AXI4-Stream, and
//! unpack results.
//!
//! A program uses these functions on the memory of a DMA engine that feeds the core's stream wrapper.

use anyhow::Result;
use glint_base::fill;

use super::model::CField;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use crate::package::wrap::fields::Transfer;
use glint_rtl::verilog::text::constant_name;

/// An operand or a result, with its position in the bytes of a transfer.
struct TransferNumber {
    field: CField,
    port: String,
    first: u32,
    /// The size in bytes.
    size: u32,
}

impl TransferNumber {
    fn bytes(&self) -> std::ops::Range<u32> {
        0..self.size
    }

    fn unsigned(&self) -> &'static str {
        if self.size <= 4 { "uint32_t" } else { "uint64_t" }
    }

    /// Returns the C expression that joins the bytes in `transfer` to a bit pattern.
    fn joined(&self) -> String {
        let kind = self.unsigned();
        let mut bytes = Vec::new();
        for at in self.bytes() {
            bytes.push(match (at, self.size) {
                (0, 1) => format!("transfer[{}]", self.first),
                (0, _) => format!("({kind})transfer[{}]", self.first),
                _ => format!("({kind})transfer[{}] << {}", self.first + at, 8 * at),
            });
        }
        bytes.join("\n        | ")
    }

    /// Returns the C expression that converts the bit pattern `raw` to a signed number, if the number has a sign.
    fn value(&self) -> Option<String> {
        let kind = self.field.kind;
        let (sign, suffix) =
            (1u64 << (8 * self.size - 1), if self.size <= 4 { "u" } else { "ull" });
        match (self.field.format.signed, self.size) {
            (false, _) => None,
            (true, 4 | 8) => Some(format!("({kind})raw")),
            (true, _) => {
                Some(format!("({kind})(raw ^ {sign:#x}{suffix}) - ({kind}){sign:#x}{suffix}"))
            }
        }
    }

    fn python_sign(&self) -> &'static str {
        if self.field.format.signed { "True" } else { "False" }
    }
}

/// The layout of the transfers in one direction, in bytes.
struct Bytes {
    bytes: u32,
    filled: u32,
    numbers: Vec<TransferNumber>,
}

impl Bytes {
    fn new(job: &EmitJob, transfer: &Transfer) -> Self {
        let design = job.design;
        let mut numbers = Vec::new();
        for field in &transfer.fields {
            let mut ports = design.ports.iter();
            if let Some(port) = ports.find(|port| design.net(port.net).name == field.name) {
                numbers.push(TransferNumber {
                    field: CField::new(design, port),
                    port: field.name.clone(),
                    first: field.low / 8,
                    size: field.padded() / 8,
                });
            }
        }
        Self { bytes: transfer.bits / 8, filled: transfer.filled() / 8, numbers }
    }

    fn above(&self) -> std::ops::Range<u32> {
        self.filled..self.bytes
    }
}

/// Fails if the core has no operands or no results, or if a template fails.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let (name, regenerate) = (job.name(), job.regenerate());
    let (sent, received) = (Transfer::sent(job)?, Transfer::received(job)?);
    let (sent, received) = (Bytes::new(job, &sent), Bytes::new(job, &received));
    let header = fill!("stream.h" {
        name: &'a str, regenerate: &'a str,
        prefix: String = constant_name(name),
        sent: &'a Bytes = &sent,
        received: &'a Bytes = &received,
    })?;
    let python = fill!("stream.py" {
        name: &'a str, regenerate: &'a str,
        sent: &'a Bytes = &sent,
        received: &'a Bytes = &received,
    })?;
    files.add(FileKind::Software, format!("{name}_stream.h"), header);
    files.add(FileKind::Software, format!("{name}_stream.py"), python);
    Ok(())
}
