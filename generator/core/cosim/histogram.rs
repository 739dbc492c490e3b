//! Counts the results of a co-simulation by the value of their reflectance `f`, in nine classes.
//!
//! The counts show whether the random operands reached every class. For a device that is no highlight, only the results outside
//! the domain are counted. For example, the class `<0.1` has the results with `f` from 0.01 to below 0.1.

use glint_base::fixed::Format;

/// The names of the classes into which [`Histogram`] sorts results by `f`, in the order of [`Histogram::counts`]. The class `1`
/// has the results with `f` equal to the largest word below 1.0, or above. The class `outside` has the results whose operands
/// are outside the domain.
pub const CLASSES: [&str; 9] =
    ["0", "<0.001", "<0.01", "<0.1", "<0.5", "<0.9", "<1", "1", "outside"];

/// The upper ends of the classes `<0.001` to `<0.9`.
const ENDS: [f64; 5] = [0.001, 0.01, 0.1, 0.5, 0.9];

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Histogram {
    counts: [u64; CLASSES.len()],
}

impl Histogram {
    /// Counts a result with the reflectance `f`, a raw value in the format `format`. A negative value counts as 0.
    pub(super) fn add(&mut self, format: Format, f: i64) {
        // The largest word below 1.0 is as much as a fraction without integer bits can be.
        let class = if f <= 0 {
            0
        } else if i128::from(f) + 1 >= 1 << format.frac {
            CLASSES.len() - 2
        } else {
            let value = format.to_f64(i128::from(f));
            1 + ENDS.iter().take_while(|&&end| value >= end).count()
        };
        self.counts[class] += 1;
    }

    pub(super) fn add_outside(&mut self) {
        self.counts[CLASSES.len() - 1] += 1;
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
    }

    pub fn counts(&self) -> [u64; CLASSES.len()] {
        self.counts
    }

    /// Returns the share of results whose `f` is neither 0 nor in the class `1`, from 0 to 1. Results outside the domain count
    /// in the total.
    pub fn share_inside(&self) -> f64 {
        let inside: u64 = self.counts[1..CLASSES.len() - 2].iter().sum();
        inside as f64 / self.counts.iter().sum::<u64>().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted_by_decade() {
        let mut histogram = Histogram::default();
        // u0.10: 0, 1/1024, 0.0098, 0.0107, 0.499, 0.5, 1 − 2 ulp, 1 − ulp.
        for word in [0, 1, 10, 11, 511, 512, 1022, 1023] {
            histogram.add(Format::unsigned(0, 10), word);
        }
        histogram.add_outside();
        assert_eq!(histogram.counts(), [1, 1, 1, 1, 1, 1, 1, 1, 1]);
        assert_eq!(histogram.share_inside(), 6.0 / 9.0);
        let twice = histogram.clone();
        histogram.merge(&twice);
        assert_eq!(histogram.counts(), [2; 9]);
    }
}
