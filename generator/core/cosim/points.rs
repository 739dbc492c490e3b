//! Draws the operands of computations at random, and prefers operands at which an error would show.
//!
//! For a highlight, `f` is often 0 in most of the domain, so evenly drawn operands test little. Three of four points are
//! therefore drawn by the value of the formula for `f`:
//!
//! 1. [`PointSource`] draws operands in the domain, and a target value for `f`. Half of the targets are drawn evenly, and half
//!    with an evenly drawn logarithm.
//! 2. [`PointSource`] moves the operands along a straight line toward the operands with the largest `f`, until the formula has
//!    about the target value.
//! 3. For one in eight of these points, [`PointSource`] continues to the two neighbouring operand values between which the
//!    formula crosses the target, or leaves 0. One of the two values becomes the operand.
//!
//! The operands of the other points are often at an end of the domain or near it, or are drawn evenly, or have arbitrary bit
//! patterns.
//!
//! If a device is no highlight, half of the points come from [`Contract::hint`], if the contract has hints: operands at which
//! the formula is steep, bends or ends.

use std::sync::LazyLock;

use glint_base::fixed::exp2;
use glint_golden::{Contract, Highlight, Operand};

use super::random::Random;

/// Kind 0 has many arbitrary bit patterns, kinds 1 and 2 are often at or near the ends of the domain, and kind 3 is drawn
/// evenly. For a highlight, the other kinds are drawn by the value of the formula.
const KINDS: i64 = 16;

/// If the device is no highlight, kinds above `HINTED` take the operands that [`Contract::hint`] suggests.
const HINTED: i64 = 7;

/// The length operand of a line that is not drawn by the value of the formula is at most `SHORT` above its lowest value. One
/// such line in `LONG` may be longer. With many long lines, few points of other kinds would be tested.
const SHORT: i64 = 12;
const LONG: u64 = 64;

/// This number of halvings of the way from the peak finds a value of the formula within some hundredths.
const HALVINGS: u32 = 10;
const _: () = assert!(HALVINGS.is_multiple_of(2), "they come in pairs");

/// The number of parts of an octave that the halvings can distinguish, and 2 to the power of −part/`PARTS` for each part.
const PARTS: usize = 1 << HALVINGS;
static POWERS: LazyLock<[f64; PARTS]> =
    LazyLock::new(|| std::array::from_fn(|part| libm::exp2(-(part as f64) / PARTS as f64)));

/// A value of the formula between its ends 0 and 1, at which errors show.
const MIDDLE: f64 = 0.6;

/// The largest number of times that the search halves the distance of operands from the peak, until the formula is below its
/// peak.
const OCTAVES: u32 = 32;

/// The number of random values of the other operands with which the peak is searched.
const SETTINGS: u32 = 8;
const MOVED: usize = 6;

/// Draws the operands of random points for a contract, as raw values in the order of `Contract::operands`.
pub struct PointSource<'a> {
    contract: &'a dyn Contract,
    highlight: Option<&'a Highlight>,
    /// The operands with the domains from which they are drawn, which are smaller than the contract's for fixed operands.
    operands: Vec<Operand>,
    /// The number of control operands, which determine `f` and come first.
    control: usize,
    /// The index of the length operand, if the device computes lines.
    length: Option<usize>,
    /// For each control operand, its value at the largest `f`, or `None` if the operand need not move. Used if the contract
    /// does not state the peak.
    peak: Vec<Option<i64>>,
}

impl<'a> PointSource<'a> {
    /// Makes a source of random points for `contract`. For a highlight it first searches for the operands with the largest `f`,
    /// toward which the draws later move operands.
    pub fn new(contract: &'a dyn Contract) -> Self {
        let highlight = contract.highlight();
        let operands = contract.operands().to_vec();
        let length = length(contract);
        let control = operands.iter().filter(|operand| !operand.colour).count();
        let mut points =
            Self { contract, highlight, control, length, peak: vec![None; control], operands };
        if let Some(highlight) = highlight {
            points.peak = points.search(highlight);
        }
        points
    }

    /// Restricts the operand `name` to the value `raw`. A point of arbitrary bit patterns may still have another value.
    pub fn hold(&mut self, name: &str, raw: i64) {
        let held = self.operands.iter_mut().filter(|operand| operand.name == name);
        held.for_each(|operand| operand.domain = (raw, raw));
    }

    /// Limits the length operand of randomly drawn lines to `most`, or to the smallest length if `most` is less.
    pub fn shorten(&mut self, most: i64) {
        if let Some(at) = self.length {
            let (low, high) = self.operands[at].domain;
            self.operands[at].domain.1 = high.min(most).max(low);
        }
    }

    pub fn clamped(&self, mut values: Vec<i64>) -> Vec<i64> {
        values.truncate(self.operands.len());
        for (raw, operand) in values.iter_mut().zip(&self.operands) {
            *raw = (*raw).clamp(operand.domain.0, operand.domain.1);
        }
        values
    }

    pub fn operands(&self) -> &[Operand] {
        &self.operands
    }

    /// Draws new raw values for the operands whose bit is set in `free`; bit i belongs to operand i. The search toward the
    /// largest `f` can move other operands as well.
    pub fn draw(&self, random: &mut Random, values: &mut [i64], free: u64) {
        let kind = random.within(0, KINDS - 1);
        self.draw_kind(random, values, free, kind);
    }

    /// Draws raw values for all operands as [`PointSource::draw`] does, but always within the domain.
    pub fn of_domain(&self, random: &mut Random) -> Vec<i64> {
        let mut values = vec![0; self.operands.len()];
        let kind = random.within(1, KINDS - 1);
        self.draw_kind(random, &mut values, u64::MAX, kind);
        values
    }

    pub fn evenly(&self, random: &mut Random) -> Vec<i64> {
        self.operands.iter().map(|it| random.within(it.domain.0, it.domain.1)).collect()
    }

    /// Returns operands that [`Contract::hint`] suggests, clamped to their domains.
    pub fn hint(&self, random: &mut Random) -> Option<Vec<i64>> {
        self.contract.hint(&mut || random.unit()).map(|hint| self.clamped(hint))
    }

    /// Returns the index of the operand that gives the number of results of a computation, if a computation can have several.
    pub fn length(&self) -> Option<usize> {
        self.length
    }

    fn draw_kind(&self, random: &mut Random, values: &mut [i64], free: u64, kind: i64) {
        for at in (0..values.len()).filter(|at| free >> at & 1 == 1) {
            let domain = self.operands[at].domain;
            values[at] = match kind {
                0 => self.any(random, at),
                1 | 2 => self.one(random, at),
                3 => random.within(domain.0, domain.1),
                // A large colour shows errors of `f` best.
                _ if at >= self.control && random.once_in(2) => {
                    domain.1 - random.within(0, (domain.1 - domain.0) / 8)
                }
                _ if self.length == Some(at) || random.once_in(2) => self.one(random, at),
                _ => random.within(domain.0, domain.1),
            };
        }
        if kind > HINTED && self.highlight.is_none() {
            if let Some(hint) = self.hint(random) {
                values.copy_from_slice(&hint);
            }
        } else if kind > 3 {
            self.spread(random, &mut values[..self.control]);
        } else if let Some(length) = self.length
            && !random.once_in(LONG)
        {
            let (low, high) = self.operands[length].domain;
            values[length] = random.within(low, high.min(low.saturating_add(SHORT)));
        }
    }

    /// Returns a random raw value for operand number `at`, within its domain. The value is often an end of the domain, near an
    /// end, or near 0 in a domain with both signs. A length is usually short, so that long computations do not take most of
    /// the time.
    pub fn one(&self, random: &mut Random, at: usize) -> i64 {
        let (low, high) = self.operands[at].domain;
        if self.length != Some(at) || random.once_in(16) {
            return random.of_domain((low, high));
        }
        let reach = high.abs_diff(low);
        let lengths = [random.magnitude(reach), random.magnitude(reach)];
        low.wrapping_add(lengths[0].min(lengths[1]) as i64)
    }

    /// Returns a random raw value for operand number `at`. Half of the values are arbitrary bit patterns, and the rest come
    /// from [`PointSource::one`]. For a device that is no highlight, a quarter of the values are instead outside the domain,
    /// mostly just outside, where a core may saturate.
    pub fn any(&self, random: &mut Random, at: usize) -> i64 {
        let Operand { format, domain: (low, high), .. } = self.operands[at];
        let (least, most) = (format.min_raw() as i64, format.max_raw() as i64);
        if random.once_in(2) {
            random.within(least, most)
        } else if self.highlight.is_none() && (least, most) != (low, high) && random.once_in(2) {
            let is_below = low > least && (high == most || random.once_in(2));
            let room = if is_below { low.abs_diff(least) } else { most.abs_diff(high) };
            let away = random.magnitude(room - 1) as i64 + 1;
            if is_below { low - away } else { high + away }
        } else {
            self.one(random, at)
        }
    }

    /// Moves control operands to where the formula has a random value. A line is moved at both ends.
    fn spread(&self, random: &mut Random, control: &mut [i64]) {
        let Some((length, highlight)) = self.length.zip(self.highlight) else {
            self.aim(random, control);
            return;
        };
        let mut last = control.to_vec();
        for (at, value) in last.iter_mut().enumerate() {
            if at != length && self.peak[at].is_some() {
                *value = self.one(random, at);
            }
        }
        self.aim(random, &mut last);
        self.aim(random, control);
        let line = highlight.line(control, &last);
        for ((value, end), operand) in control.iter_mut().zip(line).zip(&self.operands) {
            *value = end.clamp(operand.domain.0, operand.domain.1);
        }
    }

    /// Moves control operands toward the peak, to where the formula has a random value, if the formula falls on the way.
    fn aim(&self, random: &mut Random, far: &mut [i64]) {
        let Some((way, highlight)) = self.way(far).zip(self.highlight) else { return };
        let (top, bottom) = (way.top, way.bottom);
        let exact = random.once_in(8);
        let target = match random.below(4) {
            0 if exact => bottom + f64::MIN_POSITIVE,
            0 | 1 => bottom + (top - bottom) * random.unit(),
            _ => {
                let least = bottom.max(exp2(-highlight.f_format().frac)).min(top);
                least * libm::pow(top / least, random.unit())
            }
        };
        let [inner, outer] = way.crossing(highlight, target, exact, far);
        let scale = if exact && random.once_in(2) { outer } else { inner };
        way.go(scale, far);
    }

    /// Finds the edge of the highlight on the straight line from the control operands with the largest `f` to `control`. At
    /// the edge, the formula falls to its value at the far end, for example 0. Returns the last operands before the edge, and
    /// the first operands beyond it.
    pub fn edge(&self, control: &[i64]) -> Option<[Vec<i64>; 2]> {
        let (way, highlight) = self.way(control).zip(self.highlight)?;
        let target = way.bottom + f64::MIN_POSITIVE;
        let mut at = control.to_vec();
        Some(way.crossing(highlight, target, true, &mut at).map(|scale| {
            way.go(scale, &mut at);
            at.clone()
        }))
    }

    /// Moves control operands on a straight line toward the largest `f`, until the formula has about the given `value`. The
    /// operands stay if the formula does not fall on the line.
    pub fn to_value(&self, control: &mut [i64], value: f64) {
        if let Some((way, highlight)) = self.way(control).zip(self.highlight) {
            let [inner, _] = way.crossing(highlight, value, false, control);
            way.go(inner, control);
        }
    }

    /// Moves control operands so that errors show. Each goes to an end of its domain if the formula is then nearer to the
    /// middle of its range. The operands that lead to the largest `f`, such as `cos_gamma`, and the length of a line stay.
    pub fn show(&self, control: &mut [i64]) {
        let Some(highlight) = self.highlight else { return };
        for at in 0..self.control {
            if self.peak[at].is_some() || self.length == Some(at) {
                continue;
            }
            let (low, high) = self.operands[at].domain;
            let mut there = control.to_vec();
            let mut nearest = f64::INFINITY;
            for raw in [control[at], low, high] {
                there[at] = raw;
                let distance = (value(highlight, &there) - MIDDLE).abs();
                if distance < nearest {
                    (nearest, control[at]) = (distance, raw);
                }
            }
        }
    }

    /// Returns the straight line from the peak to the control operands `far`. If the formula is as large at `far` as at the
    /// peak, the line ends at nearer operands, where the formula is smaller. Returns `None` if no such end is found.
    fn way(&self, far: &[i64]) -> Option<Way> {
        let highlight = self.highlight?;
        let peak = self.peak(highlight, far);
        let top = value(highlight, &peak);
        let mut end = far.to_vec();
        for _ in 0..OCTAVES {
            let bottom = value(highlight, &end);
            if bottom < top {
                return Some(Way { peak, far: end, top, bottom });
            }
            // The formula is as large here as at the peak. If it falls at all, it falls nearer to the peak.
            for (far, &peak) in end.iter_mut().zip(&peak) {
                *far = between(peak, *far, 0.5);
            }
        }
        None
    }

    /// Returns the peak as the contract states it, or as the search found it. An operand that the caller fixed keeps its
    /// value.
    fn peak(&self, highlight: &Highlight, control: &[i64]) -> Vec<i64> {
        let said = highlight.peak(control).unwrap_or_else(|| {
            let found = self.peak.iter().zip(control);
            found.map(|(peak, &value)| peak.unwrap_or(value)).collect()
        });
        self.clamped(said)
    }

    /// Searches for the control operands with the largest `f`, and returns the value of each operand that leads there. The
    /// function tries the ends of the domain and 0. Only the first operands with fraction bits vary (a cosine, an angle, the
    /// components of a vector), or the first operands if none has fraction bits.
    fn search(&self, highlight: &Highlight) -> Vec<Option<i64>> {
        let control = &self.operands[..self.control];
        let mut moved: Vec<usize> =
            (0..control.len()).filter(|&at| self.length != Some(at)).collect();
        if moved.iter().any(|&at| control[at].format.frac > 0) {
            moved.retain(|&at| control[at].format.frac > 0);
        }
        moved.truncate(MOVED);
        let mut random = Random::new(1);
        let mut settings: Vec<Vec<i64>> = Vec::new();
        for _ in 0..SETTINGS {
            settings.push((0..control.len()).map(|at| self.one(&mut random, at)).collect());
        }
        let mut best = (f64::NEG_INFINITY, Vec::new());
        for combination in 0..3usize.pow(moved.len() as u32) {
            let mut peak: Vec<i64> = Vec::new();
            let mut rest = combination;
            for &at in &moved {
                let (low, high) = control[at].domain;
                peak.push([0.clamp(low, high), high, low][rest % 3]);
                rest /= 3;
            }
            let mut sum = 0.0;
            for setting in &settings {
                let mut operands = setting.clone();
                for (&at, &raw) in moved.iter().zip(&peak) {
                    operands[at] = raw;
                }
                sum += highlight.reference(&operands);
            }
            if sum > best.0 {
                best = (sum, peak);
            }
        }
        let mut found = vec![None; control.len()];
        for (at, raw) in moved.into_iter().zip(best.1) {
            found[at] = Some(raw);
        }
        found
    }
}

pub(super) fn length(contract: &dyn Contract) -> Option<usize> {
    let length = contract.length();
    contract.operands().iter().position(|operand| Some(operand.name.as_str()) == length)
}

/// A straight line in the space of control operands, from the peak to a point where the formula is smaller.
struct Way {
    peak: Vec<i64>,
    far: Vec<i64>,
    /// The values of the formula at both ends.
    top: f64,
    bottom: f64,
}

impl Way {
    /// Sets `operands` to the operands at `scale`: the peak at 0, the far end at 1.
    #[inline]
    fn go(&self, scale: f64, operands: &mut [i64]) {
        let ends = self.peak.iter().zip(&self.far);
        for (operand, (&peak, &far)) in operands.iter_mut().zip(ends) {
            *operand = between(peak, far, scale);
        }
    }

    /// Returns two scales between which the formula crosses `target`: it is not below `target` at the first scale, and below at
    /// the second. If `exact` is true, the scales give neighbouring operands. `at` is overwritten.
    fn crossing(
        &self,
        highlight: &Highlight,
        target: f64,
        exact: bool,
        at: &mut [i64],
    ) -> [f64; 2] {
        let mut reaches = |scale: f64| {
            self.go(scale, at);
            value(highlight, at) >= target
        };
        // The formula often falls within a small part of the way, so the way is divided by octaves from the peak.
        let spans = self.peak.iter().zip(&self.far).map(|(peak, far)| peak.abs_diff(*far));
        let span = spans.max().unwrap_or(1);
        let octaves = (64 - span.leading_zeros()) as usize + 1;
        let (mut inner, mut outer) = (PARTS, 0);
        // Two halvings at once: the three points are independent, so none waits for the result of another.
        while inner - outer > 1 {
            let middle = usize::midpoint(inner, outer);
            let [near, far] = [inner, outer].map(|end| usize::midpoint(end, middle));
            let [at_near, at_middle, at_far] =
                [near, middle, far].map(|parts| reaches(power(octaves * parts)));
            (inner, outer) = match (at_middle, at_near, at_far) {
                (true, _, true) => (far, outer),
                (true, _, false) => (middle, far),
                (false, true, _) => (near, middle),
                (false, false, _) => (inner, near),
            };
        }
        let [mut inner, mut outer] = [inner, outer].map(|parts| power(octaves * parts));
        while exact && (outer - inner) * span as f64 > 0.5 {
            let middle = f64::midpoint(inner, outer);
            if reaches(middle) { inner = middle } else { outer = middle }
        }
        [inner, outer]
    }
}

/// Returns 2 to the power of −`parts`/1024, exactly as [`libm::exp2`] computes it.
#[inline]
fn power(parts: usize) -> f64 {
    POWERS[parts % PARTS] * exp2(-((parts / PARTS) as i32))
}

/// Returns the formula's value for the first result of a computation.
#[inline]
fn value(highlight: &Highlight, control: &[i64]) -> f64 {
    highlight.reference(&highlight.point(control, 0))
}

/// Returns the value at the fraction `scale` of the way from `peak` to `far`.
fn between(peak: i64, far: i64, scale: f64) -> i64 {
    peak.saturating_add(((far as f64 - peak as f64) * scale) as i64)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use glint_base::fixed::Format;
    use glint_golden::contract::{ErrorShare, control};
    use glint_golden::highlight::{Products, Reflectance};

    /// A highlight without an angle or an exponent, for tests: `f` is 1 if `x` equals `at`, falls linearly, and is 0 if `x` is
    /// 4 or more away from `at`.
    pub struct Pulse {
        /// Whether the contract states where `f` is largest.
        says: bool,
        length: Option<&'static str>,
    }

    impl Pulse {
        const HALF: f64 = 4.0;

        /// Makes a contract with operands of these names, widths in bits and largest values.
        fn contract(self, operands: &[(&str, i32, i64)]) -> Highlight {
            let mut controls = Vec::new();
            for &(name, bits, high) in operands {
                controls.push(control(name, Format::unsigned(bits, 0), (0, high), ""));
            }
            Highlight::new(self, controls, Products::none(Format::unsigned(0, 10)))
        }

        fn pair(says: bool) -> Highlight {
            Self { says, length: None }.contract(&[("x", 20, 1 << 20), ("at", 20, 1000)])
        }

        /// Makes a contract with one operand `x` of 12 bits. If `length` is true, `x` gives the number of results of a
        /// computation.
        pub fn single(length: bool) -> Highlight {
            Self { says: false, length: length.then_some("x") }.contract(&[("x", 12, 4095)])
        }
    }

    impl Reflectance for Pulse {
        fn f(&self, control: &[i64]) -> i64 {
            (self.reference(control) * 1023.0) as i64
        }

        fn reference(&self, control: &[i64]) -> f64 {
            let at = control.get(1).copied().unwrap_or_default();
            (1.0 - (control[0] as f64 - at as f64).abs() / Self::HALF).max(0.0)
        }

        fn peak(&self, control: &[i64]) -> Option<Vec<i64>> {
            self.says.then(|| vec![control[1], control[1]])
        }

        fn length(&self) -> Option<&str> {
            self.length
        }

        fn shares(&self) -> Vec<ErrorShare> {
            Vec::new()
        }
    }

    /// Returns the share of random points with `f` between 0 and 1, ends excluded.
    fn share(pulse: &Highlight) -> f64 {
        let points = PointSource::new(pulse);
        let mut random = Random::new(7);
        let mut values = vec![0; 2];
        let inside = (0..4000).filter(|_| {
            points.draw(&mut random, &mut values, 0b11);
            let f = pulse.reference(&values);
            0.0 < f && f < 1.0
        });
        inside.count() as f64 / 4000.0
    }

    #[test]
    fn powers_are_those_of_the_library_bit_for_bit() {
        for octaves in 1..=65 {
            for parts in 0..=PARTS {
                let exponent = octaves as f64 * parts as f64 / PARTS as f64;
                assert_eq!(power(octaves * parts), libm::exp2(-exponent), "2^-{exponent}");
            }
        }
    }

    /// Compares `crossing` with a search that evaluates the formula in the middle, one halving at a time.
    #[test]
    fn a_crossing_is_where_single_halvings_lead() {
        let pulse = Pulse::pair(true);
        let way = Way { peak: vec![700, 700], far: vec![1 << 20, 700], top: 1.0, bottom: 0.0 };
        let octaves = 21.0;
        for step in 1..100 {
            let target = f64::from(step) / 100.0;
            let (mut inner, mut outer) = (octaves, 0.0);
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(inner, outer);
                let x = between(700, 1 << 20, libm::exp2(-middle));
                if pulse.reference(&[x, 700]) >= target { inner = middle } else { outer = middle }
            }
            let crossing = way.crossing(&pulse, target, false, &mut [0; 2]);
            assert_eq!(crossing, [inner, outer].map(|it| libm::exp2(-it)), "{target}");
        }
    }

    #[test]
    fn a_device_of_any_formula_says_where_it_is_largest() {
        // If the operands were drawn independently, one point in 130 000 would be within the pulse, except for operands near 0.
        assert!(share(&Pulse::pair(true)) > 0.6);
        // The operands move to where both are 0. On the way, `x` passes through the pulse.
        assert!(share(&Pulse::pair(false)) > 0.4);
    }

    #[test]
    fn operands_that_are_not_free_stay_where_they_are() {
        let pulse = Pulse::pair(true);
        let points = PointSource::new(&pulse);
        let mut random = Random::new(3);
        for _ in 0..200 {
            let mut values = vec![123, 456];
            points.draw(&mut random, &mut values, 0b01);
            assert_eq!(values[1], 456);
        }
    }

    #[test]
    fn what_is_held_is_seldom_moved() {
        let pulse = Pulse::pair(true);
        let mut points = PointSource::new(&pulse);
        points.hold("x", 500);
        let mut random = Random::new(3);
        let mut values = vec![0; 2];
        let moved = (0..1600).filter(|_| {
            points.draw(&mut random, &mut values, 0b11);
            values[0] != 500
        });
        assert!(moved.count() < 100);
    }

    #[test]
    fn lengths_are_small_and_at_times_the_largest() {
        let pulse = Pulse::single(true);
        let points = PointSource::new(&pulse);
        let mut random = Random::new(1);
        let drawn: Vec<i64> = (0..10_000).map(|_| points.one(&mut random, 0)).collect();
        let count = |wanted: fn(i64) -> bool| drawn.iter().filter(|&&x| wanted(x)).count();
        assert!(count(|x| x == 0) > 1_000);
        assert!(count(|x| x < 64) > 6_000);
        assert!(count(|x| x > 2_000) > 200);
        assert!(count(|x| x == 4095) > 20);
    }
}
