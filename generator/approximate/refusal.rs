//! Defines the reason why no polynomials with a proved bound were found.

use std::ops::Range;

/// The reason why no polynomials with a proved bound were found. It knows no configuration keys: a device that states the
/// function tells its user which of its keys to change.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The kind, by which a device chooses the key and the remedy.
    pub kind: RefusalKind,
    /// The range of bytes in the formula's text to which the reason applies, if it applies to a particular part.
    pub place: Option<Range<usize>>,
    /// The reason, for the user.
    pub message: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RefusalKind {
    /// The formula has no value at an operand.
    NoValue,
    /// The raw operands of the domain have too many bits.
    OperandBits {
        /// The largest number of fraction bits of the operand that the search can work with. It can be negative.
        most: i32,
    },
    /// The function is a curve through samples, and its domain has too many operands to compute each of them.
    ManyOperandsOfSamples,
    /// A result or a partial sum has too many bits.
    ResultBits,
    /// No polynomials keep the allowed error. [`crate::reachable_error`] looks for an error that can be kept.
    Error,
    /// At an operand, the error of the polynomials is not below the allowed error.
    ErrorExceeded,
    /// The domain has so many operands that the bound cannot be proved.
    Unproved,
    /// The range reduction does not suit the function.
    Reduction(UnsuitedReduction),
}

/// Why a range reduction does not suit a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsuitedReduction {
    /// A curve through samples has no range reduction at all.
    NoReduction,
    /// The identity does not hold for the formula.
    NoIdentity,
    /// The domain is on one side of 0, and the identity concerns both sides.
    OneSide,
    /// The domain begins at 0, which belongs to no octave.
    FromZero,
    /// The domain is not one period with a power of two as the number of operands.
    NoPeriod,
    /// A number of the reduction would have too few or too many bits.
    Bits,
    /// The domain has too many operands to compute each of them.
    ManyOperands,
}

impl Refusal {
    /// Makes a refusal that concerns no particular part of the formula.
    pub(super) fn new(kind: RefusalKind, message: impl Into<String>) -> Self {
        Self { kind, place: None, message: message.into() }
    }

    pub(super) fn of_reduction(why: UnsuitedReduction, message: impl Into<String>) -> Self {
        Self::new(RefusalKind::Reduction(why), message)
    }
}
