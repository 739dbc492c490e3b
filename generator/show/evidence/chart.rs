//! Defines charts as data: axes, curves and reference lines. Pages plot them as SVG and print their values as tables.

use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AxisScale {
    Linear,
    /// Powers of ten are spaced evenly. Such an axis cannot show 0 or a negative value.
    Logarithmic,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChartAxis {
    /// The quantity with its unit, for example `γ (degrees)`.
    pub label: String,
    pub scale: AxisScale,
    /// The ends of the plotted range. The plot clips values outside the range; the table of values shows them.
    pub range: (f64, f64),
}

impl ChartAxis {
    pub fn linear(label: &str, low: f64, high: f64) -> Self {
        Self { label: label.to_owned(), scale: AxisScale::Linear, range: (low, high) }
    }

    pub fn logarithmic(label: &str, low: f64, high: f64) -> Self {
        Self { scale: AxisScale::Logarithmic, ..Self::linear(label, low, high) }
    }

    /// Returns the position of `value` on the axis: on a logarithmic axis, its logarithm to base 10. For example, 100 is at 2
    /// there. Returns `None` if there is no position, such as for 0.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = match self.scale {
            AxisScale::Linear => value,
            AxisScale::Logarithmic if value > 0.0 => libm::log10(value),
            AxisScale::Logarithmic => return None,
        };
        place.is_finite().then_some(place)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// The name for the legend and the table's head.
    pub name: String,
    /// One value for each position in [`Chart::places`]. A position without a value has NaN, which is `null` in JSON.
    pub values: Vec<f64>,
}

/// A horizontal reference line, for example the proved bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mark {
    pub label: String,
    /// The value on the vertical axis.
    pub at: f64,
}

/// Several curves over the same horizontal axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// The identifier in HTML, which must be unique on the page.
    pub id: String,
    pub title: String,
    /// One or two sentences, which a screen reader also reads.
    pub caption: String,
    pub x: ChartAxis,
    pub y: ChartAxis,
    /// The positions on the horizontal axis at which the curves have values, in ascending order.
    pub places: Vec<f64>,
    /// The curves, at most [`crate::pages::plots::STYLES`], so a reader can tell them apart.
    pub series: Vec<Series>,
    pub marks: Vec<Mark>,
}

impl Chart {
    /// Returns about `rows` evenly spread indices into [`Chart::places`], the first and the last among them. For example, 5 rows
    /// of 101 positions are 0, 25, 50, 75 and 100.
    pub fn rows(&self, rows: usize) -> Vec<usize> {
        let last = self.places.len().saturating_sub(1);
        let mut chosen: Vec<usize> =
            (0..rows).map(|row| row * last / rows.saturating_sub(1).max(1)).collect();
        chosen.dedup();
        chosen
    }
}

/// Returns `steps + 1` evenly spaced values. For example, 4 steps from 0 to 2 are 0, 0.5, 1, 1.5 and 2. `steps` must be at
/// least 1.
pub fn even(low: f64, high: f64, steps: u32) -> Vec<f64> {
    (0..=steps).map(|step| low + (high - low) * f64::from(step) / f64::from(steps)).collect()
}

/// Returns about `per_decade` integers for each power of ten, evenly spaced on a logarithmic axis, with both ends. For example, 1
/// to 1000 with 4 for each power of ten begins with 1, 2, 3, 6 and 10. `low` must be at least 1, and less than `high`.
pub fn exponents(low: u32, high: u32, per_decade: u32) -> Vec<u32> {
    let value = |step: u32| {
        let value = f64::from(low) * libm::pow(10.0, f64::from(step) / f64::from(per_decade));
        libm::round(value) as u32
    };
    let mut found: Vec<u32> = (0..).map(value).take_while(|value| *value < high).collect();
    found.dedup();
    found.push(high);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_values() {
        let linear = ChartAxis::linear("x", 0.0, 1.0);
        assert_eq!(linear.place(-2.0), Some(-2.0));
        assert_eq!(linear.place(f64::NAN), None);
        let logarithmic = ChartAxis::logarithmic("x", 0.1, 1000.0);
        assert_eq!(logarithmic.place(100.0), Some(2.0));
        assert_eq!([0.0, -1.0].map(|x| logarithmic.place(x)), [None, None]);
    }

    #[test]
    fn grids() {
        assert_eq!(even(0.0, 2.0, 4), [0.0, 0.5, 1.0, 1.5, 2.0]);
        let n = exponents(1, 1000, 4);
        assert_eq!(n, [1, 2, 3, 6, 10, 18, 32, 56, 100, 178, 316, 562, 1000]);
    }

    #[test]
    fn rows_of_a_table() {
        let chart = |count: u32| Chart {
            id: String::new(),
            title: String::new(),
            caption: String::new(),
            x: ChartAxis::linear("", 0.0, 1.0),
            y: ChartAxis::linear("", 0.0, 1.0),
            places: even(0.0, 1.0, count - 1),
            series: Vec::new(),
            marks: Vec::new(),
        };
        assert_eq!(chart(101).rows(5), [0, 25, 50, 75, 100]);
        assert_eq!(chart(2).rows(5), [0, 1]);
    }
}
