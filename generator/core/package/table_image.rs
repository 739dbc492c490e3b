//! Defines the words that a writable table gets for one function, its *image*, and the *layout* of the table that decides whether an
//! image suits it.

use std::collections::HashSet;

use super::output_file::digest;
use glint_base::fixed::Format;
use glint_rtl::netlist::{Design, NetId, Role};

/// The beginning of an image in a binary file.
const MAGIC: &[u8; 8] = b"GLINTTAB";

/// The properties of a core that an image must match: the parts of a word, the number of words, and the datapath that reads them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableLayout {
    /// The inputs for the parts of a word, such as `table_c0`, with their formats.
    pub parts: Vec<(String, Format)>,
    pub words: usize,
    /// The first 64 bits of the SHA-256 of the netlist and of the words of all other ROMs. Two cores with the same digest
    /// compute the same results from the same words.
    pub digest: u64,
}

/// The words of a writable table for one function.
#[derive(Clone, Debug)]
pub struct TableImage {
    /// An identifier, such as `fog2`.
    pub name: String,
    pub formula: String,
    /// The proved bound of the error, in units of the last place of the result.
    pub bound: f64,
    /// For each address the raw values of the parts, in the order of [`TableLayout::parts`].
    pub words: Vec<Vec<i64>>,
}

impl TableLayout {
    /// Returns the layout of the writable table of a design, or `None` if it has none.
    pub fn of(design: &Design) -> Option<Self> {
        let mut parts = Vec::new();
        for port in design.ports.iter().filter(|port| port.role == Role::TableWord) {
            let net = design.net(port.net);
            parts.push((net.name.clone(), net.format));
        }
        if parts.is_empty() {
            return None;
        }
        Some(Self { parts, words: words_of(design).len(), digest: datapath_digest(design) })
    }

    pub fn word_bits(&self) -> u32 {
        self.parts.iter().map(|(_, format)| format.width()).sum()
    }

    /// Returns whether each part fits into 32 bits, the size in which software then stores it.
    pub fn is_narrow(&self) -> bool {
        self.parts.iter().all(|(_, format)| format.width() <= i32::BITS)
    }

    /// Returns the bytes of an image in a file, with all numbers in little endian. The bytes are the magic number `GLINTTAB`,
    /// the digest of the layout, the numbers of words and of parts (32 bits each), the raw values of all parts (32 or 64 bits
    /// each), and the CRC-32 of the bytes before.
    pub fn binary(&self, image: &TableImage) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.digest.to_le_bytes());
        bytes.extend((image.words.len() as u32).to_le_bytes());
        bytes.extend((self.parts.len() as u32).to_le_bytes());
        for &raw in image.words.iter().flatten() {
            match self.is_narrow() {
                true => bytes.extend((raw as i32).to_le_bytes()),
                false => bytes.extend(raw.to_le_bytes()),
            }
        }
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }

    /// Returns the CRC-32 of an image, which is at the end of its bytes.
    pub fn checksum(&self, image: &TableImage) -> u32 {
        let bytes = self.binary(image);
        let (_, last) = bytes.split_last_chunk::<4>().expect("the checksum");
        u32::from_le_bytes(*last)
    }
}

/// Returns the digest of [`TableLayout`].
fn datapath_digest(design: &Design) -> u64 {
    let mut text = design.to_string();
    for rom in design.roms.iter().filter(|rom| rom.write.is_none()) {
        text += &format!("{}: {:?}\n", rom.name, rom.words);
    }
    let digits = digest(text.as_bytes());
    u64::from_str_radix(&digits[..16], 16).expect("hexadecimal digits")
}

/// Returns the words of the writable table of a design: for each address the raw values of the parts, in the order of the ports.
pub fn words_of(design: &Design) -> Vec<Vec<i64>> {
    let mut words: Vec<Vec<i64>> = Vec::new();
    let mut seen: HashSet<NetId> = HashSet::new();
    for rom in &design.roms {
        let Some(write) = &rom.write else { continue };
        words.resize(words.len().max(rom.words.len()), Vec::new());
        let mut below = design.width(rom.data);
        for &part in &write.parts {
            let format = design.net(part).format;
            below -= format.width();
            if seen.insert(part) {
                for (word, &stored) in words.iter_mut().zip(&rom.words) {
                    word.push(format.raw(stored >> below) as i64);
                }
            }
        }
    }
    words
}
