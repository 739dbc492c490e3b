//! Computes with intervals of raw values.

use super::fixed::Format;

/// The smallest and the largest raw value of a set, both included.
pub type Interval = (i128, i128);

/// Returns the smallest interval that contains all `intervals`, or `None` without intervals. For example, (0, 3) and (8, 9) give
/// (0, 9).
pub fn hull(intervals: impl IntoIterator<Item = Interval>) -> Option<Interval> {
    intervals.into_iter().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Returns the smallest interval that contains all `raws`, or `None` without values. For example, 5, 2 and 7 give (2, 7).
pub fn of_values(raws: impl IntoIterator<Item = i128>) -> Option<Interval> {
    hull(raws.into_iter().map(|raw| (raw, raw)))
}

/// Returns the intersection, or `None` if it is empty. For example, (0, 5) and (3, 9) give (3, 5).
pub fn common(a: Interval, b: Interval) -> Option<Interval> {
    let both = (a.0.max(b.0), a.1.min(b.1));
    (both.0 <= both.1).then_some(both)
}

/// Returns the smallest interval that contains all products of a value of `a` and a value of `b`. For example, (−1, 2) and (3, 4)
/// give (−4, 8). A product beyond `i128` saturates; no net can have such a value.
pub fn product(a: Interval, b: Interval) -> Interval {
    let corners = [(a.0, b.0), (a.0, b.1), (a.1, b.0), (a.1, b.1)];
    let [first, rest @ ..] = corners.map(|(a, b)| a.saturating_mul(b));
    rest.into_iter().fold((first, first), |all, raw| (all.0.min(raw), all.1.max(raw)))
}

/// Returns whether a format can represent all values of the interval.
pub fn fits(interval: Interval, format: Format) -> bool {
    format.holds(interval.0) && format.holds(interval.1)
}

/// Returns the multiple of 2^width that moves every number of the interval into the format when it is added. Hardware adds this
/// multiple by dropping the bits above the format. Returns `None` if no single multiple works. For example, `(256, 260)` in
/// `u8.0` gives −256, and `(250, 260)` gives `None`.
pub fn wrap((low, high): Interval, format: Format) -> Option<i128> {
    let (least, most) = format.range();
    let modulus = most - least + 1;
    let wrap =
        (least - low).div_euclid(modulus) + i128::from((least - low).rem_euclid(modulus) != 0);
    let wrap = wrap * modulus;
    (low + wrap >= least && high + wrap <= most).then_some(wrap)
}

/// Returns the number of combinations of values from `ranges`, each with its first and its last value. For example, 0 to 3 and −1
/// to 1 have 12 combinations. The number is at most the largest `u128`.
pub fn combinations(ranges: impl IntoIterator<Item = (i64, i64)>) -> u128 {
    let mut count: u128 = 1;
    for (first, last) in ranges {
        count = count.saturating_mul(u128::from(last.abs_diff(first)) + 1);
    }
    count
}
