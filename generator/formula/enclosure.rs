//! Computes with intervals of `f64`, the limits between which the exact value of a real number lies. Every rounding goes
//! outwards. For the functions of `libm`, the limits rely on a relative error of at most 2^−50.

/// The largest assumed relative error of results of `libm`. The functions come from musl, which states errors below 1.5 units in
/// the last place, and this margin is at least four units.
const MARGIN: f64 = 1.0 / (1u64 << 50) as f64;

/// The absolute value below which a product loses low bits that its computed error cannot show.
const SMALL: f64 = 1e-280;

/// The largest `f64` that is not above π.
const HALF_TURN: f64 = std::f64::consts::PI;

/// An interval that contains a real number. For example, π lies between two neighbouring `f64` numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// The lower limit.
    pub low: f64,
    /// The upper limit.
    pub high: f64,
}

impl Enclosure {
    /// Returns the interval with only `value`, for a number that is known exactly.
    pub const fn exactly(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// Returns the interval from `low` to `high`, both included. `low` must not be above `high`.
    pub const fn between(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Returns the middle of both limits, which must be finite.
    pub fn middle(self) -> f64 {
        self.low + (self.high - self.low) / 2.0
    }

    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Returns whether the interval contains `value`, limits included.
    pub fn holds(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Returns the smallest interval that contains both intervals. For example, the hull of 0 to 1 and 3 to 4 is 0 to 4.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Returns the interval of a number between `low` and `high`, which were computed with a relative error of at most
    /// [`MARGIN`].
    fn near(low: f64, high: f64) -> Self {
        let margin = |value: f64| value.abs() * MARGIN + f64::MIN_POSITIVE;
        // A value beyond the range of `f64` is above the largest `f64`, or below the smallest.
        let (low, high) = (low.min(f64::MAX), high.max(f64::MIN));
        Self { low: low - margin(low), high: high + margin(high) }
    }

    /// Returns the hull of the results of `of` at the four combinations of the intervals' limits. The hull contains all results
    /// if the function is monotone in each operand.
    fn corners(self, other: Self, of: impl Fn(f64, f64) -> Self) -> Self {
        let first = of(self.low, other.low);
        if self.low == self.high && other.low == other.high {
            return first;
        }
        let [a, b, c, d] =
            [first, of(self.low, other.high), of(self.high, other.low), of(self.high, other.high)];
        a.hull(b).hull(c.hull(d))
    }

    /// Limits the interval to the range from `least` to `most`, in which a function has all its values.
    fn within(self, least: f64, most: f64) -> Self {
        Self { low: self.low.clamp(least, most), high: self.high.clamp(least, most) }
    }

    /// Returns the interval of a function of `libm` that never falls.
    pub(super) fn rising(self, function: fn(f64) -> f64) -> Self {
        let low = function(self.low);
        Self::near(low, if self.low == self.high { low } else { function(self.high) })
    }

    /// Returns the interval of an exponential function, never below 0.
    pub(super) fn exponential(self, function: fn(f64) -> f64) -> Self {
        let Self { low, high } = self.rising(function);
        Self { low: low.clamp(0.0, f64::MAX), high }
    }

    /// Returns a logarithm's interval, which is not negative for numbers of 1 or more, and not positive for numbers up to 1.
    pub(super) fn logarithm(self, function: fn(f64) -> f64) -> Self {
        let least = if self.low >= 1.0 { 0.0 } else { f64::NEG_INFINITY };
        let most = if self.high <= 1.0 { 0.0 } else { f64::INFINITY };
        self.rising(function).within(least, most)
    }

    /// Returns the interval of an odd function that never falls and is never beyond ±`largest`. Its values have the argument's
    /// sign.
    pub(super) fn odd_and_rising(self, function: fn(f64) -> f64, largest: f64) -> Self {
        let least = if self.low >= 0.0 { 0.0 } else { -largest };
        let most = if self.high <= 0.0 { 0.0 } else { largest };
        self.rising(function).within(least, most)
    }

    /// Returns a sine's interval. If the angle is certainly from 0 to π, or from −π to 0, the sine has the angle's sign.
    pub(super) fn sine(self) -> Self {
        let least = if self.low >= 0.0 && self.high <= HALF_TURN { 0.0 } else { -1.0 };
        let most = if self.high <= 0.0 && self.low >= -HALF_TURN { 0.0 } else { 1.0 };
        self.wave(libm::sin).within(least, most)
    }

    /// Returns the interval of a sine or a cosine from its value in the middle, because the slope is never steeper than 1.
    pub(super) fn wave(self, function: fn(f64) -> f64) -> Self {
        let middle = self.middle();
        let reach = ((self.high - middle).max(middle - self.low)).next_up();
        let value = function(middle);
        let Self { low, high } = Self::near(value, value);
        Self { low: (low - reach).next_down().max(-1.0), high: (high + reach).next_up().min(1.0) }
    }

    /// Returns the root's interval. The numbers must not be negative.
    pub(super) fn sqrt(self) -> Self {
        let root = |value: f64| {
            let root = value.sqrt();
            directed(root, (-root).mul_add(root, value))
        };
        Self { low: root(self.low).low, high: root(self.high).high }
    }

    pub(super) fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            -self
        } else {
            Self { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    /// Returns the interval of a power with an integer exponent, which must be above 0.
    pub(super) fn repeated_product(self, exponent: u32) -> Self {
        let base = if exponent.is_multiple_of(2) { self.abs() } else { self };
        let power = |value: f64| {
            let value = Self::exactly(value);
            (1..exponent).fold(value, |power, _| power * value)
        };
        // For numbers of one sign, and for an odd exponent, a power rises with the absolute value of its base.
        Self { low: power(base.low).low, high: power(base.high).high }
    }

    /// Returns a power's interval, computed by `libm`. The base must not be negative.
    pub(super) fn power(self, exponent: Self) -> Self {
        self.corners(exponent, |base, exponent| {
            let power = libm::pow(base, exponent);
            let Self { low, high } = Self::near(power, power);
            // Beyond the range of `f64`, the power is above the largest `f64`.
            let least = if base == 0.0 { power } else { low.clamp(0.0, f64::MAX) };
            Self { low: least, high: if base == 0.0 { power } else { high } }
        })
    }
}

/// Returns the smallest interval of a number, if `value` is the nearest `f64`. `error` must have the sign of the number minus
/// `value`.
fn directed(value: f64, error: f64) -> Enclosure {
    if value.abs() < SMALL && (value != 0.0 || error != 0.0) || !error.is_finite() {
        return Enclosure { low: value.next_down(), high: value.next_up() };
    }
    Enclosure {
        low: if error < 0.0 { value.next_down() } else { value },
        high: if error > 0.0 { value.next_up() } else { value },
    }
}

impl std::ops::Neg for Enclosure {
    type Output = Self;

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl std::ops::Add for Enclosure {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: f64, b: f64| {
            let sum = a + b;
            let part = sum - a;
            directed(sum, (a - (sum - part)) + (b - part))
        };
        Self { low: sum(self.low, other.low).low, high: sum(self.high, other.high).high }
    }
}

impl std::ops::Sub for Enclosure {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// Returns the smallest interval of a product. A product with 0 is 0, even if the other factor is infinite.
fn product(a: f64, b: f64) -> Enclosure {
    if a == 0.0 || b == 0.0 {
        return Enclosure::exactly(0.0);
    }
    let product = a * b;
    directed(product, a.mul_add(b, -product))
}

impl std::ops::Mul for Enclosure {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        if a.low == a.high && b.low == b.high {
            return product(a.low, b.low);
        }
        // If the signs are known, two of the four products at the ends are the smallest and the largest.
        let ends = if a.low >= 0.0 && b.low >= 0.0 {
            [(a.low, b.low), (a.high, b.high)]
        } else if a.low >= 0.0 && b.high <= 0.0 {
            [(a.high, b.low), (a.low, b.high)]
        } else if a.high <= 0.0 && b.low >= 0.0 {
            [(a.low, b.high), (a.high, b.low)]
        } else if a.high <= 0.0 && b.high <= 0.0 {
            [(a.high, b.high), (a.low, b.low)]
        } else if a.low >= 0.0 {
            [(a.high, b.low), (a.high, b.high)]
        } else if b.low >= 0.0 {
            [(a.low, b.high), (a.high, b.high)]
        } else {
            return self.corners(other, product);
        };
        let [smallest, largest] = ends.map(|(a, b)| product(a, b));
        Self { low: smallest.low, high: largest.high }
    }
}

impl std::ops::Div for Enclosure {
    type Output = Self;

    /// Returns the quotient. The divisor's interval must not contain 0.
    fn div(self, other: Self) -> Self {
        self.corners(other, |a, b| {
            if b.is_infinite() {
                // The divisor is beyond the largest `f64`, so the quotient of a finite number is near 0.
                let tiny = f64::MIN_POSITIVE.copysign(a) * b.signum();
                return match a.is_infinite() {
                    true => Self { low: f64::NAN, high: f64::NAN },
                    false => Self { low: tiny.min(0.0), high: tiny.max(0.0) },
                };
            }
            let quotient = a / b;
            let rest = (-quotient).mul_add(b, a);
            directed(quotient, if b < 0.0 { -rest } else { rest })
        })
    }
}
