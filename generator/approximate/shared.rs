//! Finds tables with given bit widths, so that the tables of several functions can be pages of one memory with one datapath.
//!
//! A search of a single table chooses the narrowest widths for its function. For a set of functions, the widths are the largest
//! that any of them needs. Each table is then fitted again with these widths, and proved at every operand.

use super::seen::AllowedResults;
use super::segments::{Layout, Segments};
use super::table::{Table, Widths};
use super::{Piecewise, Refusal, RefusalKind, TargetFunction, Wish, search};

/// The bit widths of tables whose segments are all equally long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedWidths {
    /// The number of leading bits of an operand's number that select a segment: 4 bits for 16 segments.
    pub prefix: u32,
    /// The fraction bits of each coefficient beyond the fraction bits of the result, the constant first.
    pub guard: Vec<i32>,
    /// The number of leading bits of the offset that each step of Horner's rule multiplies.
    pub offset: Vec<u32>,
}

impl SharedWidths {
    /// Returns the widths of a table. Returns `None` if its segments differ in length, if it has a range reduction, if its last
    /// segment is longer than the others, or if it can be written.
    pub fn of(found: &Piecewise) -> Option<Self> {
        let cut = found.segments;
        let is_plain = cut.layout == Layout::Uniform && cut.overhang == 0 && cut.octaves == 0;
        if !is_plain || found.reduction.is_some() || found.is_writable {
            return None;
        }
        let fraction = found.result.frac;
        Some(Self {
            prefix: cut.prefix,
            guard: found.coefficients.iter().map(|format| format.frac - fraction).collect(),
            offset: found.steps.iter().map(|step| step.offset).collect(),
        })
    }

    /// Returns the widths with `bits` more fraction bits of each coefficient.
    #[must_use]
    pub fn with_guard(&self, bits: i32) -> Self {
        Self { guard: self.guard.iter().map(|guard| guard + bits).collect(), ..self.clone() }
    }

    /// Returns the widths with the same offset in each step of Horner's rule, so that the multiplier of a sequential core needs no choice
    /// between offsets.
    #[must_use]
    pub fn with_equal_offsets(&self) -> Self {
        let most = self.offset.iter().copied().max().unwrap_or(0);
        Self { offset: vec![most; self.offset.len()], ..self.clone() }
    }

    /// Returns widths that are enough for both of two tables of the same degree.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        let guards = self.guard.iter().zip(&other.guard);
        let offsets = self.offset.iter().zip(&other.offset);
        Self {
            prefix: self.prefix.max(other.prefix),
            guard: guards.map(|(a, b)| *a.max(b)).collect(),
            offset: offsets.map(|(a, b)| *a.max(b)).collect(),
        }
    }
}

/// Returns the narrowest widths of polynomials of degree 2 for each of several functions, with 2^`prefix` segments. An entry is
/// `None` if the function has no such polynomials.
pub fn widths_with_prefix(functions: &[&TargetFunction], prefix: u32) -> Vec<Option<SharedWidths>> {
    let wish = Wish {
        degree: Some(2),
        layout: Some(Layout::Uniform),
        prefix: Some(prefix),
        ..Wish::default()
    };
    let mut widths = Vec::new();
    for function in functions {
        let numbering = function.numbering_without_overhang();
        let found = match function.is_wide() {
            true => None,
            false => search::attempt_numbered(function, wish, numbering).ok().flatten(),
        };
        widths.push(found.and_then(|found| SharedWidths::of(&found)));
    }
    widths
}

/// Finds the polynomials of `function` with these widths, and proves their error at every operand. An offset has at most the bits
/// that the segments of the function leave for it.
///
/// # Errors
/// Fails if the domain has more than 2^26 operands, if the segments would have no bits for offsets, if no coefficients of these
/// widths keep the error, or if the function has no value at an operand.
pub fn find_with_widths(
    function: &TargetFunction,
    widths: &SharedWidths,
) -> Result<Piecewise, Refusal> {
    let unkept = || {
        let message = "no coefficients of the widths that the functions share keep the error";
        Refusal::new(RefusalKind::Error, message.to_owned())
    };
    if function.is_wide() {
        return Err(unkept());
    }
    let numbering = function.numbering_without_overhang();
    let seen = AllowedResults::new(function, 0.0, numbering)?.ok_or_else(unkept)?;
    let prefix = widths.prefix;
    if prefix >= seen.bits {
        return Err(unkept());
    }
    let cut =
        Segments { bits: seen.bits, layout: Layout::Uniform, octaves: 0, prefix, overhang: 0 };
    let offset = widths.offset.iter().map(|bits| (*bits).min(cut.rest())).collect();
    let widths = Widths { guard: widths.guard.clone(), offset };
    let table = Table::new(&seen, cut);
    let words = table.fitted(&widths).ok_or_else(unkept)?;
    let found = table.finished(&widths, words).ok_or_else(unkept)?;
    let bound = found.prove(function)?;
    Ok(Piecewise { bound, ..found })
}
