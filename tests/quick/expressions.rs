//! Tests expressions as people write them: results that other results read, parts that several formulas share, constants that
//! disappear, and operands outside `where`.
//!
//! For every combination of raw operands, also outside the domain and outside `where`, the simulation gives the results that the
//! contract states. A user gets these results from `glint eval`, and the C model computes them.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::cores::{Emitted, assert_agrees, assert_results_as_stated, device, parsed};
use crate::common::files::read;
use glint::config::{Config, Value, parse};
use glint::core::Core;
use glint::registry::{Device, PartsResult, Registry};
use regex::Regex;

/// The operands x and y with four fraction bits, from 0 to 15/16.
const UNSIGNED: &str =
    "operands.x = { bits = 4, fraction = 4 }\noperands.y = { bits = 4, fraction = 4 }";

/// The operands x and y with a sign and three fraction bits, from −1 to 7/8.
const SIGNED: &str = "operands.x = { bits = 4, fraction = 3, signed = true }
operands.y = { bits = 4, fraction = 3, signed = true }";

/// Four operands of three bits whose weights are from 2^−40 on.
const TINY: &str =
    "operands.a = { bits = 3, fraction = 40 }\noperands.b = { bits = 3, fraction = 40 }
operands.c = { bits = 3, fraction = 40 }\noperands.d = { bits = 3, fraction = 40 }";

/// Operands, and results that other results read or that need no operation.
const CASES: [(&str, &str); 59] = [
    (
        // Highlights of a cosine that is never below 0 need no choice.
        "operands.n = { axes = \"xy\", bits = 4, fraction = 3, signed = true }\noperands.e = { from = 2, to = 7, fraction = 0 }",
        "results.shine = { formula = \"cosine_power(clamp(n.x / length(n), 0, 1), e, 2)\", fraction = 5, where = \"dot(n, n) > 0\" }
results.other = { formula = \"schlick(max(0, n.y / length(n)), e)\", fraction = 5, where = \"dot(n, n) > 0\" }
results.below = { formula = \"if(n.x < 1/2, 3 * max(1/2, n.x), 1.5)\", fraction = 5 }",
    ),
    (
        // A unit vector of any length but 0, and a projection to it.
        "operands.n = { axes = \"xy\", bits = 6, fraction = 4, signed = true }\noperands.h = { bits = 4, fraction = 3, signed = true }",
        "results.u = { formula = \"if(length(n) == 0, 0, n / length(n))\", fraction = 5 }
results.c = { formula = \"(n.x * h + n.y / 2) / length(n)\", fraction = 5, where = \"dot(n, n) > 0\" }
results.lit = { formula = \"clamp((n.x * h + n.y) / length(n), 0, 1)\", fraction = 6, where = \"dot(n, n) > 0\" }
results.low = { formula = \"max(0, min(0.3, (n.y - n.x) / length(n))) + max(0, n.y / length(n))\", fraction = 4, where = \"dot(n, n) > 0\" }",
    ),
    (
        // The cosine of the angle between two vectors of any length, and a root of a product.
        "operands.a = { axes = \"xy\", bits = 4, fraction = 3, signed = true }\noperands.b = { axes = \"xy\", bits = 4, fraction = 1, signed = true }",
        "results.c = { formula = \"dot(a, b) / (length(a) * length(b))\", fraction = 6, where = \"length(a) > 0 and length(b) > 0\" }
results.d = { formula = \"(a.x * b.y - a.y * b.x) / sqrt(dot(a, a) * dot(b, b))\", fraction = 5, where = \"length(a) > 0 and length(b) > 0\" }",
    ),
    (
        // A vector without its part along another one, and its mirror image, in three spellings.
        "operands.a = { axes = \"xy\", bits = 4, fraction = 3, signed = true }\noperands.b = { axes = \"xy\", bits = 4, fraction = 3, signed = true }",
        "results.rest = { formula = \"a - dot(a, b) / dot(b, b) * b\", fraction = 5, where = \"length(b) > 0\" }
results.mirror = { formula = \"a - 2 * (dot(a, b) / dot(b, b)) * b\", fraction = 4, where = \"length(b) > 0\" }
results.other = { formula = \"2 * b * dot(a, b) / dot(b, b) - a\", fraction = 4, where = \"length(b) > 0\" }",
    ),
    (
        // A choice with a hole, divided by a constant; the root of a sum of integers; digits of a number of seconds.
        "operands.x = { bits = 6, fraction = 3, signed = true }\noperands.y = { bits = 5, fraction = 0 }",
        "results.part = { formula = \"if(x > 0, ln(x), -8) / 6 + y\", fraction = 5 }
results.length = { formula = \"sqrt((8 * x)^2 + y^2)\", fraction = 0, error = 0.5 }
results.digit = { formula = \"floor(((8 * x + 40) % 36) / 6)\", fraction = 0, error = 0.5 }",
    ),
    (
        // Conditions about lengths, and about the number in a maximum.
        "operands.a = { size = 2, bits = 4, fraction = 3, signed = true }\noperands.n = { bits = 2, fraction = 0 }
operands.r = { bits = 6, fraction = 6 }",
        "results.cosine = { formula = \"a[0] / length(a)\", fraction = 5, where = \"length(a) > 0.5 and n > 0\" }
results.shine = { formula = \"max(0, 2 * a[0] * a[1])^n\", fraction = 5, where = \"n >= 1 and 2 * a[0] * a[1] <= 1\" }
results.value = { formula = \"n / (1 + r) + n / (1 + r)^2\", fraction = 4 }",
    ),
    (
        // Directions of rounded coordinates: the choices of octant and quadrant are continuous, apart from the negative x axis.
        "operands.x = { bits = 5, fraction = 4, signed = true }\noperands.y = { bits = 5, fraction = 4, signed = true }
operands.z = { bits = 5, fraction = 4, signed = true }",
        "results.pitch = { formula = \"atan2(-x, sqrt(y^2 + z^2))\", fraction = 5, where = \"x^2 + y^2 + z^2 > 0.25\" }
results.tilt = { formula = \"atan2(sqrt(x^2 + y^2), z) / pi\", fraction = 6, where = \"x^2 + y^2 + z^2 > 0.25\" }
results.sum = { formula = \"atan2(0.3 * x - y, z + 1.1)\", fraction = 5 }",
    ),
    (
        "operands.x = { bits = 9, fraction = 8, signed = true }\noperands.y = { bits = 7, fraction = 7 }",
        "results.angle = { formula = \"atan2(sin(3 * x), cos(3 * x) + y / 4) / pi\", fraction = 6, bits = 7, signed = true, overflow = \"wrap\", \
         where = \"y < 0.7\" }",
    ),
    (
        // Divisions by constants are exact.
        "operands.x = { bits = 7, fraction = 0 }\noperands.y = { bits = 6, fraction = 2, signed = true }",
        "results.tens = { formula = \"floor(x / 10)\", fraction = 0, error = 0.5 }
results.ones = { formula = \"x % 10\", fraction = 0, error = 0.5 }
results.mean = { formula = \"(x + y + 1) / 3\", fraction = 2, error = 0.5 }
results.thirds = { formula = \"round(y / 3 - 0.1)\", fraction = 0, error = 0.5 }
results.turn = { formula = \"mod(0.3 * x + y, 1.5)\", fraction = 4, error = 0.6 }",
    ),
    (
        // A mean with weights that may all be 0, and a blend of pixels.
        "operands.a = { bits = 4, fraction = 0 }\noperands.b = { bits = 4, fraction = 0 }
operands.u = { bits = 3, fraction = 0 }\noperands.v = { bits = 3, fraction = 0 }",
        "results.mean = { formula = \"if(u + v == 0, 0, (a * u + b * v) / (u + v))\", fraction = 0, error = 0.5 }
results.blend = { formula = \"15 - (15 - a) * (15 - b) / 15\", fraction = 0, error = 0.5 }
results.stretch = { formula = \"if(b > a, int(15 * (u - a) / (b - a)), 0)\", fraction = 0, error = 0.5, where = \"u >= a and b >= u\" }",
    ),
    (
        // Integer roots are exact, and the nearest value of a root whose operand has constants that are not exact in binary.
        "operands.a = { bits = 6, fraction = 1, signed = true }\noperands.b = { bits = 5, fraction = 0 }",
        "results.down = { formula = \"floor(hypot(a, b))\", fraction = 0, error = 0.5 }
results.up = { formula = \"ceil(2 * sqrt(abs(a * b)))\", fraction = 0, error = 0.5 }
results.nearest = { formula = \"round(sqrt(a^2 + b))\", fraction = 0, error = 0.5 }
results.outer = { formula = \"ln(1 + floor(hypot(a, b)))\", fraction = 5 }
results.root = { formula = \"sqrt(a^2 / 3 + 0.1 * b)\", fraction = 2, error = 0.5 }",
    ),
    (
        // The number of turns in an angle is exact, and so an angle is never a turn off.
        "operands.a = { bits = 12, fraction = 7, signed = true }",
        "results.turns = { formula = \"floor(a / (2 * pi))\", fraction = 0, error = 0.5 }
results.rest = { formula = \"a % (2 * pi)\", fraction = 7 }
results.below = { formula = \"a % (-2 * pi)\", fraction = 7 }
results.wrapped = { formula = \"a - 2 * pi * floor((a + pi) / (2 * pi))\", fraction = 7 }
results.nearest = { formula = \"a - round(a / (pi / 2)) * (pi / 2)\", fraction = 9 }
results.sine = { formula = \"sin(mod(1 - 3 * a, 2 * pi))\", fraction = 8 }",
    ),
    (
        // A mean of five pixels; the wrong integer part of a number with an irrational constant would be a whole unit off.
        "operands.a = { bits = 5, fraction = 0 }\noperands.b = { bits = 5, fraction = 0 }",
        "results.mean = { formula = \"round((a + 4 * b + 6 * a + 4 * b + a) / 16)\", fraction = 0, error = 0.5 }
results.scaled = { formula = \"floor(3 - (a - b) * sqrt(2) / 7)\", fraction = 0, error = 0.5 }
results.curve = { formula = \"((0.8 + 18 * (a / 32)^0.16) / (1 + 17.8 * (a / 32)^0.16))^78\", fraction = 6 }",
    ),
    (
        // A mixture of numbers that are not negative is not negative, and nor is a discriminant where `where` says so.
        "operands.a = { bits = 4, fraction = 4 }\noperands.b = { bits = 4, fraction = 4 }\noperands.t = { bits = 4, fraction = 4 }",
        "results.mixed = { formula = \"sqrt(mix(a^2, b^2, t))\", fraction = 5 }
results.solved = { formula = \"(-b + sqrt(b^2 - 4 * a * t)) / (2 * (a + 1/16))\", fraction = 4, where = \"b^2 - 4 * a * t >= 0\" }
results.powers = { formula = \"sqrt(a^2.2 + b^2.2)\", fraction = 5 }",
    ),
    (
        // Where the exponential function is 0, so is the dividend.
        "operands.x = { bits = 7, fraction = 4, signed = true }\noperands.s = { from = 0.25, to = 1, fraction = 5 }",
        "results.density = { formula = \"exp(-x^2 / (2 * s^2)) / s\", fraction = 6 }",
    ),
    (
        // The hue of a colour: quotients by the difference of a maximum and a minimum, where it is not 0.
        "operands.r = { bits = 4, fraction = 0 }\noperands.g = { bits = 4, fraction = 0 }
operands.b = { bits = 4, fraction = 0 }\nlet.m = \"max(r, g, b)\"\nlet.c = \"m - min(r, g, b)\"",
        "results.hue = { formula = \"if(c == 0, 0, if(m == r, mod((g - b) / c, 6), if(m == g, (b - r) / c + 2, (r - g) / c + 4)))\", fraction = 4 }
results.saturation = { formula = \"if(m == 0, 0, c / m)\", fraction = 5, error = 0.5 }",
    ),
    (
        // A comparison with a constant that is not exact in binary guards its cases, and a division by a constant is no product with it.
        "operands.x = { bits = 10, fraction = 9, signed = true }\nlet.size = \"87.6 * abs(x)\"\nlet.full = \"1 + ln(87.6)\"",
        "results.y = { formula = \"if(size < 1, 87.6 * x / full, sign(x) * (1 + ln(size)) / full)\", fraction = 9 }
results.dead = { formula = \"if(abs(x) < 0.1, 0, x - 0.1 * sign(x))\", fraction = 9 }",
    ),
    (
        // Results need not depend on the same operands, and an operand can have the name of a constant.
        "operands.e = { bits = 5, fraction = 4, signed = true }\noperands.y = { bits = 5, fraction = 4, signed = true }
operands.z = { bits = 5, fraction = 4, signed = true }",
        "results.angle = { formula = \"atan2(y, z)\", fraction = 6, where = \"y^2 + z^2 > 0\" }
results.sum = { formula = \"2 * e + sign(z) * y - sign(y) * z\", fraction = 3, error = 0.5 }",
    ),
    (
        // Rounding can make the hardware take a root where the formula takes 0.
        "operands.x = { bits = 7, fraction = 5 }\noperands.y = { bits = 6, fraction = 6 }\nlet.k = \"1 - 0.3 * x^2 * (1 - 0.7 * y^2)\"",
        "results.root = { formula = \"if(k < 0, 0, sqrt(k))\", fraction = 5, error = 2 }",
    ),
    (
        // Each exponential function has integer parts of its own, and the sum is at least 1.
        "operands.v = { size = 3, bits = 4, fraction = 1, signed = true }",
        "results.p = { formula = \"softmax(v)\", fraction = 5, error = 2 }
results.m = { formula = \"max(v) - min(v)\", fraction = 2, error = 0.5 }",
    ),
    (
        "operands.a = { axes = \"xyz\", bits = 3, fraction = 2, signed = true }
operands.b = { axes = \"xyz\", bits = 2, fraction = 1, signed = true }",
        "results.c = { formula = \"cross(a, b)\", fraction = 3, error = 0.5 }
results.f = { formula = \"if(dot(a, b) > 0, a, b - 2 * a).yx\", fraction = 2, error = 0.5 }",
    ),
    (
        "operands.n = { axes = \"xyz\", bits = 4, fraction = 3, signed = true }\nlet.s = \"dot(n, n)\"
let.w = \"n / sqrt(s)\"",
        "results.u = { formula = \"normalize(n)\", fraction = 5, where = \"s > 1/16\" }
results.d = { formula = \"max(0, w.x + w[2])\", fraction = 5, where = \"s > 1/16\" }",
    ),
    (
        // The divisor has both signs.
        SIGNED,
        "results.whole = { formula = \"int(x / y)\", fraction = 0, error = 0.5, where = \"y != 0\" }
results.rest = { formula = \"x % y\", fraction = 4, error = 0.5, where = \"y != 0\" }
results.near = { formula = \"x / abs(y) / 2\", fraction = 3, error = 0.5, where = \"y != 0\" }",
    ),
    (
        // The nearest value in the cases of a choice, which a quotient decides.
        SIGNED,
        "results.q = { formula = \"if(y == 0, 0, x / y)\", fraction = 3, error = 0.5 }
results.c = { formula = \"if(y != 0 and x / y > 1, x / y, y)\", fraction = 4, error = 0.5 }
results.root = { formula = \"if(x < y, x, sqrt(x - y))\", fraction = 4, error = 0.5 }",
    ),
    (
        // The exponential function has a table over an octave, and its results need no shift.
        "operands.y = { from = \"-9 / 4\", to = \"15 / 4\", to_included = true, fraction = 2, outside = \"anything\" }",
        "results.r = { formula = \"max(0.97, exp(-abs(y)))\", fraction = 7, where = \"y > 0.1\" }",
    ),
    (
        SIGNED,
        "results.l = { formula = \"if(x > 0, ln(x), -8) + y\", fraction = 5 }
results.q = { formula = \"if(y == 0, 0, x / y)\", fraction = 3 }",
    ),
    (
        UNSIGNED,
        "results.s = { formula = \"if(max(x, y) > 0, (max(x, y) - min(x, y)) / max(x, y), 0)\", fraction = 6 }
results.h = { formula = \"x + y > 0 ? 2 * x * y / (x + y) : 0\", fraction = 6 }",
    ),
    (
        UNSIGNED,
        "results.q = { formula = \"x / y\", fraction = 3, where = \"y > 0\" }
results.g = { formula = \"if(y > 0, x / y, round(3 * x))\", fraction = 3 }",
    ),
    (
        UNSIGNED,
        "results.m = { formula = \"mix(x, y, saturate(2 * x)) + clamp(y, 0.25, 0.5)\", fraction = 6 }
results.t = { formula = \"smoothstep(0.25, 0.75, x) * sign(y)\", fraction = 6 }",
    ),
    (
        SIGNED,
        "results.p = { formula = \"x^2 + y^2\", fraction = 6 }
results.r = { formula = \"sqrt(x^2 + y^2)\", fraction = 6 }",
    ),
    (
        UNSIGNED,
        "results.p = { formula = \"x + y\", fraction = 4 }
results.q = { formula = \"x + y + 1\", fraction = 4 }",
    ),
    (
        UNSIGNED,
        "results.low = { formula = \"min(x, y)\", fraction = 5 }
results.high = { formula = \"max(x, y)\", fraction = 5 }
results.mean = { formula = \"(min(x, y) + max(x, y)) / 2\", fraction = 5 }",
    ),
    (
        UNSIGNED,
        "results.value = { formula = \"max(x, y)\", fraction = 4 }
results.saturation = { formula = \"(max(x, y) - min(x, y)) / max(x, y)\", fraction = 6, where = \"max(x, y) > 0\" }",
    ),
    (
        UNSIGNED,
        "results.p = { formula = \"x * y\", fraction = 8 }\nresults.q = { formula = \"x * y\", fraction = 8 }",
    ),
    (
        "operands.t = { bits = 7, fraction = 5, signed = true }\noperands.x = { bits = 3, fraction = 3 }",
        "results.c = { formula = \"cos(pi*t)\", fraction = 8 }
results.s = { formula = \"x*sin(pi*t)\", fraction = 8 }",
    ),
    (UNSIGNED, "results.r = { formula = \"0 + x\", fraction = 4 }\nresults.q = { formula = \"y\", fraction = 4 }"),
    (UNSIGNED, "results.r = { formula = \"ln(1) + x + y\", fraction = 4 }"),
    (
        UNSIGNED,
        "let.offset = \"0\"\nresults.r = { formula = \"offset + x - offset\", fraction = 4 }
results.q = { formula = \"0 * x - y\", fraction = 4 }\nresults.half = { formula = \"0.5\", fraction = 4 }",
    ),
    (
        "operands.x = { bits = 6, fraction = 6 }\noperands.y = { bits = 6, fraction = 5 }",
        "results.a = { formula = \"x^y\", fraction = 6, where = \"x > 0.1\" }
results.b = { formula = \"y * log2(x)\", fraction = 6, where = \"x > 0.9\" }",
    ),
    (TINY, "results.r = { formula = \"(a*b)*(c*d)\", fraction = 20 }"),
    (TINY, "results.r = { formula = \"-(a*b)*(c*d)\", fraction = 20 }"),
    (
        "operands.x = { bits = 12, fraction = 12 }",
        "results.t = { formula = \"1/(1/298.15 + ln(x/(1 - x))/3950)\", fraction = 4, where = \"x >= 0.05\" }",
    ),
    (
        // The condition of a result or of a choice limits a difference of operands.
        SIGNED,
        "results.r = { formula = \"if(x > y, sqrt(x - y), 0)\", fraction = 5 }
results.s = { formula = \"(x - y) * x\", fraction = 5 }
results.t = { formula = \"ln(x - y)\", fraction = 5, where = \"x - y >= 1/2\" }",
    ),
    (
        SIGNED,
        "results.q = { formula = \"x / (y - x)\", fraction = 4, where = \"y > x\" }
results.c = { formula = \"if(x > y, (x - y) / (x - y + 1), if(y > x, x / (y - x), 0))\", fraction = 4 }",
    ),
    (
        UNSIGNED,
        "results.leg = { formula = \"sqrt(x^2 - y^2)\", fraction = 5, where = \"x >= y\" }
results.part = { formula = \"x / y\", fraction = 5, where = \"0 < x < y\" }",
    ),
    (
        "operands.a = { bits = 4, fraction = 4 }\noperands.b = { bits = 4, fraction = 4 }
operands.x = { bits = 4, fraction = 4 }",
        "results.t = { formula = \"smoothstep(a, b, x)\", fraction = 4, where = \"b - a >= 1/8\" }",
    ),
    (
        SIGNED,
        "results.w = { formula = \"if(x != y and x != 0, y / (x * (x - y)), if(y == 0 or x > 0, 1, 1 / y))\", fraction = 3 }
results.c = { formula = \"(x > y && !(y < 0.5)) || x == -1 ? x : y\", fraction = 3 }",
    ),
    (
        SIGNED,
        "results.a = { formula = \"atan2(x - y, x + y)\", fraction = 5, where = \"not (x == 0 and y == 0)\" }
results.l = { formula = \"ln(x - y)\", fraction = 4, where = \"x > y and (y >= 0 or x < 0.5)\" }",
    ),
    (
        // Integer quotients and remainders are exact.
        SIGNED,
        "results.q = { formula = \"floor(x / y)\", fraction = 0, where = \"y > 0\" }
results.r = { formula = \"x % y\", fraction = 3, where = \"y > 0\" }
results.g = { formula = \"if(y > 0, x % y, x)\", fraction = 3 }",
    ),
    (
        SIGNED,
        "results.t = { formula = \"int(x / y)\", fraction = 0, where = \"y > 0\" }
results.c = { formula = \"ceil(x / y)\", fraction = 0, where = \"y > 0\" }
results.n = { formula = \"round(x / y)\", fraction = 0, where = \"y > 0\" }",
    ),
    (
        "operands.a = { bits = 6, fraction = 0 }\noperands.b = { bits = 4, fraction = 0 }",
        "results.q = { formula = \"floor(2 * a / (a - b))\", fraction = 0, where = \"a > b\" }
results.m = { formula = \"(a + b) % 3\", fraction = 0 }
results.v = { formula = \"if(b > 1, if(a / b > 0.5, a % b, b % (a + 10)), 2)\", fraction = 0 }",
    ),
    (
        // The remainder has more fraction bits than the divisor.
        "operands.a = { bits = 5, fraction = 2, signed = true }\noperands.b = { bits = 4, fraction = 1, signed = true }
operands.c = { bits = 3, fraction = 0 }",
        "results.r = { formula = \"(a - 3*c) % (3*b - c + 1) + b\", fraction = 4, where = \"3*b - c + 1 >= 0.5 && c < a + 3*b\" }",
    ),
    (
        // Powers far below the last bit of the result are 0.
        "operands.x = { bits = 6, fraction = 5, signed = true }\noperands.n = { bits = 7, fraction = 0 }",
        "results.h = { formula = \"if(x > 0, x^n, 0)\", fraction = 6 }
results.d = { formula = \"20 * exp(-(x + 1) * n)\", fraction = 4 }",
    ),
    (
        "operands.x = { from = -0.3, to = 0.4, fraction = 6 }\noperands.y = { from = 0.25, to = 0.5, fraction = 6 }",
        "results.q = { formula = \"sin(3 * x) / y\", fraction = 5 }\nresults.r = { formula = \"exp(x) * y\", fraction = 7 }",
    ),
    (
        // The nearest value, by an exact residual.
        "operands.x = { bits = 5, fraction = 3, signed = true }\noperands.y = { bits = 5, fraction = 4 }",
        "results.q = { formula = \"x / y\", fraction = 4, error = 0.5, where = \"y > 0\" }
results.h = { formula = \"hypot(x, y)\", fraction = 5, error = 0.5 }
results.s = { formula = \"sqrt(y - x)\", fraction = 2, error = 0.5, where = \"y >= x\" }",
    ),
    (
        // A quotient of 26 bits is computed digit by digit.
        "operands.x = { bits = 5, fraction = 0, signed = true }\noperands.y = { bits = 4, fraction = 20 }",
        "results.q = { formula = \"floor(x / y)\", fraction = 0, where = \"y > 0\" }
results.r = { formula = \"x % y\", fraction = 20, where = \"y > 0\" }
results.n = { formula = \"x / y\", fraction = 6, where = \"y > 0\" }",
    ),
    (
        // A root or a logarithm is a part of another function, and a part is limited or has no sign.
        SIGNED,
        "results.d = { formula = \"20 * log10(abs(x)) - 3\", fraction = 4, where = \"abs(x) > 0.1\" }
results.z = { formula = \"sqrt(max(0, 1 - x^2 - y^2))\", fraction = 5 }
results.r = { formula = \"1 / (1 + sqrt(x^2 + y^2))\", fraction = 6 }",
    ),
    (UNSIGNED, "results.p = { formula = \"x^y\", fraction = 6 }"),
    (
        // Three resistors in parallel: one division in place of four.
        "operands.a = { bits = 3, fraction = 0 }\noperands.b = { bits = 3, fraction = 0 }\noperands.c = { bits = 3, fraction = 1 }",
        "results.r = { formula = \"1 / (1/a + 1/b + 1/c)\", fraction = 4, where = \"a > 0 and b > 0 and c > 0\" }
results.d = { formula = \"2 / (1/a - 1/(b + 8))\", fraction = 2, where = \"a > 0\" }",
    ),
];

#[test]
fn results_are_simulated_as_stated_for_every_operand() {
    for (operands, results) in CASES {
        for architecture in ["", "architecture = \"pipelined\"\n"] {
            let text = format!(
                "device = \"expression\"\nname = \"core\"\n{architecture}{operands}\n{results}\n"
            );
            let core = parsed("core.toml", &text);
            assert!(core.design.warnings.is_empty(), "{text}{:?}", core.design.warnings);
            assert_agrees(&core, 2000, 1, &text);
            assert_results_as_stated(&core, &text);
        }
    }
}

/// A table that may be in a block memory has many segments of a small degree, and the error that the configuration allows.
#[test]
fn tables_in_block_memories_take_fewer_products() {
    let core_with = |tables: &str| {
        let text = format!(
            "device = \"expression\"\nname = \"core\"\narchitecture = \"pipelined\"\ntables = \"{tables}\"\n\
             operands.x = {{ bits = 14, fraction = 14 }}\nresults.r = {{ formula = \"1 / sqrt(1 + x)\", fraction = 15 }}\n"
        );
        let core = parsed("core.toml", &text);
        assert_agrees(&core, 2000, 1, &text);
        assert_results_as_stated(&core, &text);
        core
    };
    let words = |core: &Core| core.design.roms.iter().map(|rom| rom.words.len()).max();
    let [logic, block] = ["logic", "block-memory"].map(core_with);
    assert!(words(&block) >= Some(128), "{:?} words", words(&block));
    assert!(words(&logic) <= Some(64), "{:?} words", words(&logic));
}

/// The configurations in `docs/expressions.md` are proved, and the page states the bound of the lit point.
#[test]
fn configurations_of_the_page_are_proved() {
    let page = read("docs/expressions.md");
    let blocks = page.split("```toml\n").skip(1);
    let blocks = blocks.map(|block| block.split("```").next().unwrap_or_default());
    let mut names = Vec::new();
    for block in blocks.filter(|block| block.starts_with("device = ")) {
        let core = parsed("page.toml", block);
        if core.design.name == "lighting" {
            let units = core.contract.bounds().governing_units();
            assert!(page.contains(&format!("below {units:.3} units")), "{units}");
        }
        names.push(core.design.name.clone());
    }
    assert_eq!(names, ["polar", "unit_vector", "lighting"]);
}

/// The table of names in `docs/expressions.md` is right: the names are refused as operands, and as results they are not, unless
/// they are keywords.
#[test]
fn names_on_the_page_cannot_be_operands() {
    let page = read("docs/expressions.md");
    let table = page.split("| names | why |\n").nth(1).expect("a table");
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let names: Vec<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    assert!(names.len() > 30, "{names:?}");
    let schemas = Registry::shipped().schemas();
    let refusal = |operand: &str, result: &str| {
        let text = format!(
            "device = \"expression\"\noperands.{operand} = {{ bits = 8, fraction = 7 }}\n\
             results.{result} = {{ formula = \"{operand} / 2\", fraction = 7 }}\n"
        );
        parse("core.toml", &text, &schemas).err().map(|problems| problems.to_string())
    };
    for name in names {
        let refused = refusal(name, "r").unwrap_or_else(|| panic!("`{name}` is accepted"));
        assert!(
            refused.contains("cannot be an operand") || refused.contains("keyword"),
            "{refused}"
        );
        let is_keyword = refusal("x", name).is_some_and(|text| text.contains("keyword"));
        assert!(is_keyword || refusal("x", name).is_none(), "{name}");
    }
}

/// Returns the configuration of a core with two operands, the first one named `operand`.
fn with_operand(operand: &str, architecture: &str) -> String {
    format!(
        "device = \"expression\"\nname = \"unit\"\n{architecture}\npackage.software = true\n\
         operands.{operand} = {{ bits = 8, fraction = 4 }}\noperands.other = {{ bits = 6, fraction = 2 }}\n\
         results.r = {{ formula = \"{operand} * other + other\", fraction = 4 }}\n\
         results.s = {{ formula = \"{operand} + other\", fraction = 4 }}\n"
    )
}

/// An operand may have any name that the files of a core contain, or the name is refused at its place with another name that is
/// accepted.
#[test]
fn names_in_the_files_are_operands_or_are_refused() {
    let schemas = Registry::shipped().schemas();
    let word = Regex::new("[A-Za-z_][A-Za-z0-9_]*").expect("an expression");
    let named = Regex::new("for example `([A-Za-z0-9_]+)`").expect("an expression");
    for architecture in ["interface.registers = \"axi-lite\"", "architecture = \"pipelined\""] {
        let core = parsed("unit.toml", &with_operand("x", architecture));
        let mut names = BTreeSet::new();
        for file in Emitted::new(&core, 1, 1).files.iter() {
            let is_read =
                [".v", ".sv", ".h", ".c", ".py"].iter().any(|end| file.path.ends_with(end));
            if is_read {
                names.extend(word.find_iter(&file.contents).map(|it| it.as_str().to_owned()));
            }
        }
        assert!(names.len() > 300, "{names:?}");
        for name in names.iter().filter(|name| !["other", "r", "s"].contains(&name.as_str())) {
            let text = with_operand(name, architecture);
            let config = match parse("unit.toml", &text, &schemas) {
                Ok(config) => config,
                Err(problems) => {
                    let problems = problems.to_string();
                    let is_at_name = problems.contains(&format!("operands.{name} ="));
                    let Some(free) = named.captures(&problems).filter(|_| is_at_name) else {
                        panic!("{name}: {problems}");
                    };
                    let free = with_operand(&free[1], architecture);
                    parse("unit.toml", &free, &schemas).unwrap_or_else(|it| panic!("{name}: {it}"))
                }
            };
            Core::new(device("expression"), config)
                .unwrap_or_else(|error| panic!("{name}: {error:#}"));
        }
    }
}

/// Counts how often the device below opened a configuration.
static OPENED: AtomicUsize = AtomicUsize::new(0);

/// Everything that is made of a configuration reads one plan: description, golden model, contract, files, vectors and checks.
#[test]
fn a_configuration_is_planned_once() {
    fn counted(config: &Config) -> PartsResult {
        OPENED.fetch_add(1, Ordering::Relaxed);
        (device("expression").parts)(config)
    }
    let counting = Device { parts: counted, ..device("expression") };
    let registry = Registry::empty().with(counting);
    let text = format!(
        "device = \"expression\"\n{SIGNED}\nresults.r = {{ formula = \"x * y\", fraction = 3 }}\n\
         architecture = \"pipelined\""
    );
    let (opened, _) = registry.parse("core.toml", &text).expect("a sound configuration");
    let core = Core::build_with_free_clock(opened).expect("a core");
    let vectors = core.shipped_vectors().expect("vectors");
    core.files("core.toml", vectors).expect("files");
    core.lockstep(1).expect("the same signals").run(100, &|_| ()).expect("a run");
    core.job().expect("the same signals");
    let mut sequential = core.config().clone();
    sequential.set("architecture", Value::Text("sequential".to_owned()));
    sequential.reset_keys_without_effect(&(counting.schema)());
    Core::build(core.opened.with_config(sequential).expect("the same keys")).expect("a core");
    assert_eq!(OPENED.load(Ordering::Relaxed), 1);
}

/// The error of a quotient by a product of lengths has shares that are not known for all roundings. The longer operands need the
/// known shares to decide which rounding gets bits, and the shorter ones the unknown shares.
#[test]
fn similarities_of_directions_are_proved() {
    for (axes, bits, fraction) in [("xyz", 14, 10), ("xy", 12, 8)] {
        let operand = format!(
            "{{ axes = \"{axes}\", bits = {bits}, fraction = {}, signed = true }}",
            bits - 2
        );
        let text = format!(
            "device = \"expression\"\noperands.a = {operand}\noperands.b = {operand}\n\
             results.c = {{ formula = \"dot(a, b) / (length(a) * length(b))\", fraction = {fraction}, error = 2.0, \
             where = \"length(a) > 0.5 and length(b) > 0.5\" }}\n"
        );
        let core = parsed("similarity.toml", &text);
        assert!(core.contract.bounds().governing_units() < 2.0, "{axes}");
    }
}
