//! Reads the output of a child process to its end, so the process never blocks on a full pipe. If the output is long, only its
//! beginning and its end are kept in memory.

use std::collections::VecDeque;
use std::io::Read;
use std::sync::{Arc, Mutex, PoisonError};

/// The number of bytes that are kept at the beginning of a long output.
const KEEP_FIRST: usize = 64 << 10;
/// The number of bytes that are kept at the end of a long output, where verdicts and errors are.
const KEEP_LAST: usize = 1 << 20;
const QUOTED_LINES: usize = 12;
/// The largest number of characters of a line that an error quotes.
const QUOTED_CHARACTERS: usize = 200;

/// The output of a child process so far. Clones share the text, so one thread can read output while another quotes it.
#[derive(Clone, Default)]
pub(super) struct Capture(Arc<Mutex<CaptureBuffer>>);

#[derive(Default)]
struct CaptureBuffer {
    first: Vec<u8>,
    last: VecDeque<u8>,
    left_out: u64,
}

impl Capture {
    /// Reads output until it ends or a read fails.
    pub(super) fn drain(&self, reader: &mut impl Read) {
        let mut buffer = vec![0; 64 << 10];
        while let Ok(count @ 1..) = reader.read(&mut buffer) {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            kept.push(&buffer[..count]);
        }
    }

    /// Returns the output, with a replacement for bytes that are not UTF-8. If the middle of the output was dropped, a line such
    /// as `... 4096 bytes left out ...` takes its place.
    pub(super) fn text(&self) -> String {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut bytes = kept.first.clone();
        if kept.left_out > 0 {
            let note = format!("\n... {} bytes left out ...\n", kept.left_out);
            bytes.extend_from_slice(note.as_bytes());
        }
        bytes.extend(&kept.last);
        String::from_utf8_lossy(&bytes).into_owned()
    }

    pub(super) fn quote(&self) -> String {
        quote(&self.text())
    }
}

impl CaptureBuffer {
    fn push(&mut self, bytes: &[u8]) {
        let (first, rest) = bytes.split_at(bytes.len().min(KEEP_FIRST - self.first.len()));
        self.first.extend_from_slice(first);
        self.last.extend(rest);
        let excess = self.last.len().saturating_sub(KEEP_LAST);
        self.last.drain(..excess);
        self.left_out += excess as u64;
    }
}

/// Returns the end of an error message: the last 12 non-empty lines of `output`, indented, without control characters, and cut
/// after [`QUOTED_CHARACTERS`] characters. For example, `no module` gives `; its last lines:`, followed by `no module` on a line
/// of its own. An output without text gives `; it printed nothing`.
pub(super) fn quote(output: &str) -> String {
    let lines: Vec<&str> = output.lines().filter(|line| !line.trim().is_empty()).collect();
    if lines.is_empty() {
        return "; it printed nothing".to_owned();
    }
    let from = lines.len().saturating_sub(QUOTED_LINES);
    let mut text = String::from("; its last lines:");
    for line in &lines[from..] {
        text.push_str("\n    ");
        let printable = |c: char| {
            if c.is_control() && c != '\t' { '\u{fffd}' } else { c }
        };
        text.extend(line.chars().take(QUOTED_CHARACTERS).map(printable));
        if line.chars().nth(QUOTED_CHARACTERS).is_some() {
            text.push_str(" ...");
        }
    }
    text
}
