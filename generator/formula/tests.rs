//! Tests that formulas are parsed, evaluated and printed.

use std::sync::Arc;

use super::{
    CArithmetic, EULER, Enclosure, Expression, Fault, NumberList, NumberOrList, RBig, parse,
    parse_condition, parse_with_lists,
};

fn value(text: &str, x: f64) -> Enclosure {
    let formula = parse(text).unwrap_or_else(|fault| panic!("{}", fault.under(text)));
    formula
        .enclose(&[("x", Enclosure::exactly(x))])
        .unwrap_or_else(|fault| panic!("{}", fault.under(text)))
}

/// Compares the limits with values to 20 digits, from tables (Abramowitz and Stegun) and by hand. The limits must be close to
/// each other.
#[test]
#[expect(
    clippy::excessive_precision,
    clippy::approx_constant,
    reason = "digits as tables have them"
)]
fn enclosures_hold_known_values() {
    for (text, x, known) in [
        ("1 - 2 * x ^ 3", 2.0, -15.0),
        ("-x ** 2", 3.0, -9.0),
        ("2 ^ -x ^ 2", 2.0, 0.0625),
        ("4 - 2 - 1", 0.0, 1.0),
        ("8 / 4 / 2 % 3", 0.0, 1.0),
        ("e", 0.0, 2.718_281_828_459_045_235_4),
        ("sin(pi / 6) + cos(pi / 3) + tan(pi / 4)", 0.0, 2.0),
        ("atan(x) * 4", 1.0, 3.141_592_653_589_793_238_5),
        ("exp(x)", 1.0, 2.718_281_828_459_045_235_4),
        ("log2(x) + ln(exp(2)) + exp2(3)", 8.0, 13.0),
        ("rsqrt(x) + reciprocal(x) + sqrt(x)", 4.0, 2.75),
        ("erf(x)", 1.0, 0.842_700_792_949_714_869_3),
        ("tanh(x)", 0.5, 0.462_117_157_260_009_758_5),
        ("sigmoid(x)", 1.0, 0.731_058_578_630_004_879_3),
        ("softplus(x)", 0.0, 0.693_147_180_559_945_309_4),
        ("silu(x)", 1.0, 0.731_058_578_630_004_879_3),
        ("gelu(x)", 1.0, 0.841_344_746_068_542_948_6),
        ("if(x < 2, min(x, 7), max(x, 9)) + abs(-x)", 1.0, 2.0),
        ("x if x >= 1 else 5", 1.0, 1.0),
        ("x ^ 0.5", 2.0, 1.414_213_562_373_095_048_8),
        ("x^-2", 4.0, 0.0625),
        ("0.1 + 0.2", 0.0, 0.3),
        ("1e-3 * 1.5E3", 0.0, 1.5),
        ("floor(x) + 10 * int(x)", -1.5, -12.0),
        ("floor(x) + 10 * int(x)", 1.5, 11.0),
        ("floor(x) + int(x)", -2.0, -4.0),
        ("asin(x)", 1.0, 1.570_796_326_794_896_619_2),
        ("acos(x) - π", -1.0, 0.0),
        ("sinh(x)", 1.0, 1.175_201_193_643_801_456_9),
        ("cosh(x)", 1.0, 1.543_080_634_815_243_778_5),
        ("log10(x)", 1000.0, 3.0),
        ("cbrt(x) + cbrt(-x) + cbrt(8)", 27.0, 2.0),
        ("hypot(3, x) + pow(x, 2)", 4.0, 21.0),
        ("atan2(x, 1) * 4", 1.0, 3.141_592_653_589_793_238_5),
        ("atan2(x, -1) * 4 / 3", 1.0, 3.141_592_653_589_793_238_5),
        ("atan2(-x, -1) * -4 / 3", 1.0, 3.141_592_653_589_793_238_5),
        ("atan2(-x, 0) * -2", 1.0, 3.141_592_653_589_793_238_5),
        ("atan2(0, -x) + atan2(0, x)", 1.0, 3.141_592_653_589_793_238_5),
    ] {
        let limits = value(text, x);
        assert!(limits.holds(known) && limits.high - limits.low < 1e-13, "{text}: {limits:?}");
    }
}

/// Checks that an argument may have the name of the function's own parameters.
#[test]
fn arguments_keep_their_names() {
    let formula = parse("hypot(v, u) - 2 * u").unwrap();
    let operands = [("u", Enclosure::exactly(4.0)), ("v", Enclosure::exactly(3.0))];
    assert_eq!(formula.enclose(&operands).unwrap(), Enclosure::exactly(-3.0));
    assert_eq!(formula.operands(), ["v", "u"]);
}

/// Returns the parsed text as formulas without lists, for the list v of four numbers and the vectors n and l with axes.
fn written_out(text: &str) -> Result<Vec<String>, Fault> {
    let lists = |name: &str| {
        let (names, axes): (Vec<&str>, Option<&str>) = match name {
            "v" => (vec!["v0", "v1", "v2", "v3"], None),
            EULER => return Some(Expression::operand(EULER).into()),
            "n" => (vec!["nx", "ny", "nz"], Some("xyz")),
            "l" => (vec!["lx", "ly", "lz"], Some("xyz")),
            _ => return None,
        };
        let elements = names.into_iter().map(|name| Arc::new(Expression::operand(name))).collect();
        let axes = axes.map(str::to_owned);
        Some(NumberOrList::List(NumberList { elements, axes, span: (0..0).into() }))
    };
    let formula = parse_with_lists(text, &lists)?;
    Ok(formula.elements().iter().map(|element| element.python()).collect())
}

#[test]
fn lists_become_formulas_of_their_numbers() {
    let cases = [
        ("2 * n", vec!["2 * nx", "2 * ny", "2 * nz"]),
        ("e * pi", vec!["e * pi"]),
        ("-n ^ 2", vec!["-nx ** 2", "-ny ** 2", "-nz ** 2"]),
        ("dot(n, l)", vec!["nx * lx + ny * ly + nz * lz"]),
        ("dot(n, n)", vec!["nx ** 2 + ny ** 2 + nz ** 2"]),
        ("cross(n, l)", vec!["ny * lz - nz * ly", "nz * lx - nx * lz", "nx * ly - ny * lx"]),
        ("sum(v)", vec!["v0 + v1 + (v2 + v3)"]),
        ("mean(n)", vec!["(nx + ny + nz) / 3"]),
        ("length(n.xz)", vec!["sqrt(nx ** 2 + nz ** 2)"]),
        ("if(n.xy == 0, 1, 2)", vec!["1 if 0 >= abs(nx ** 2 + ny ** 2) else 2"]),
        ("n.xy != l.xy ? 1 : 2", vec!["1 if abs((nx - lx) ** 2 + (ny - ly) ** 2) > 0 else 2"]),
        ("hypot(n.xz)", vec!["sqrt(nx ** 2 + nz ** 2)"]),
        ("distance(n.xy, l.xy)", vec!["sqrt((nx - lx) ** 2 + (ny - ly) ** 2)"]),
        ("v[2] + n.y", vec!["v2 + ny"]),
        ("(n - l)[1]", vec!["ny - ly"]),
        ("[n.x, 1] + 0.5", vec!["nx + 0.5", "1 + 0.5"]),
        ("max(n.xy)", vec!["max(nx, ny)"]),
        ("max(n.xy, 0)", vec!["max(nx, 0)", "max(ny, 0)"]),
        ("exp(n.xy)", vec!["exp(nx)", "exp(ny)"]),
        (
            "softmax(n.xy)",
            vec![
                "exp(nx - max(nx, ny)) / (exp(nx - max(nx, ny)) + exp(ny - max(nx, ny)))",
                "exp(ny - max(nx, ny)) / (exp(nx - max(nx, ny)) + exp(ny - max(nx, ny)))",
            ],
        ),
    ];
    for (text, expected) in cases {
        let found = written_out(text).unwrap_or_else(|fault| panic!("{}", fault.under(text)));
        let expected: Vec<String> = expected
            .into_iter()
            .map(|formula| parse(formula).expect("a formula").python())
            .collect();
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn mistakes_with_lists_are_shown_under_their_places() {
    let cases = [
        ("n + v", "this list has 4 numbers, and the one before it has 3"),
        ("n > 0 ? 1 : 2", "a single number is needed here"),
        ("dot(n, 2)", "`dot` needs a list"),
        ("cross(v, v)", "three numbers"),
        ("v[4]", "an integer from 0 to 3"),
        ("v.x", "has no axes"),
        ("n.w", "not one of the axes"),
        ("sum(v[0])", "`sum` needs a list"),
        ("[n, 1]", "a single number is needed here"),
        ("[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17]", "at most 16"),
    ];
    for (text, message) in cases {
        let fault = written_out(text).unwrap_err();
        assert!(fault.message.contains(message), "{}", fault.under(text));
    }
    assert!(parse("[1, 2]").unwrap_err().message.contains("a single number"));
}

#[test]
fn directions_near_their_jump_and_at_the_origin() {
    let formula = parse("atan2(y, x)").unwrap();
    let across = [("y", Enclosure::between(-1.0, 1.0)), ("x", Enclosure::between(-2.0, -1.0))];
    let both = formula.enclose(&across).unwrap();
    assert!(both.low < -3.0 && both.high > 3.0);
    let around = [("y", Enclosure::between(-1.0, 1.0)), ("x", Enclosure::between(-1.0, 1.0))];
    let message = formula.enclose(&around).unwrap_err().message;
    assert_eq!(message, "the direction of a point that can be the origin, (0, 0)");
    let ahead = parse("atan2(x, 2)").unwrap();
    let (_, slope) = ahead.slope("x", Enclosure::exactly(2.0)).unwrap();
    assert!(slope.holds(0.25) && slope.high - slope.low < 1e-12);
}

/// Checks that a root at the end of its domain has a value, because values that `f64` represents exactly stay exact.
#[test]
fn exact_steps_stay_exact() {
    for (text, x, known) in [
        ("sqrt(1 - x * x)", 1.0, 0.0),
        ("0.5 + x / 4 - 1", 3.0, 0.25),
        ("x ^ 3 / 2", 1.5, 1.6875),
        ("sqrt(x)", 2.25, 1.5),
    ] {
        assert_eq!(value(text, x), Enclosure::exactly(known), "{text}");
    }
    let third = value("1 / 3", 0.0);
    assert_eq!(third.high, third.low.next_up());
    assert!(value("0.1", 0.0).low < value("0.1", 0.0).high);
}

#[test]
fn intervals_hold_every_value_within_them() {
    for text in [
        "x * x - x",
        "sin(3 * x)",
        "1 / (x + 2)",
        "abs(x) ^ 1.7",
        "x^4 - x^3",
        "max(x, -x / 2)",
        "exp(-x) % 3",
    ] {
        let formula = parse(text).unwrap();
        let wide = formula.enclose(&[("x", Enclosure::between(-1.0, 1.5))]).unwrap();
        for k in 0..=250 {
            let inner = value(text, -1.0 + f64::from(k) / 100.0);
            assert!(wide.low <= inner.low && inner.high <= wide.high, "{text} at {k}");
        }
    }
}

#[test]
fn mistakes_are_shown_under_their_places() {
    let wide = Enclosure::between(-1.0, 2.0);
    for (text, shown) in [
        ("1 / sqrt(", "         ^ a number, an operand or a function is missing"),
        ("1 + 2 )", "      ^ this does not belong here"),
        ("2 * foo(x)", "    ^^^ there is no function `foo`"),
        ("x # 2", "  ^ `#` cannot be a part of a formula"),
        ("(x + 1", "      ^ `)` is missing"),
        ("1.2.3", "^^^^^ this is not a number"),
        ("if(x, 1, 2)", "    ^ a comparison sign is missing: `<`, `>`, `<=`, `>=`, `==` or `!=`"),
        ("2x", " ^ this does not belong here: write the sign of a product, as in `2*x`"),
        (
            "if(x = 2, 1, 2)",
            "     ^ `=` cannot be a part of a formula: compare with `<`, `>`, `<=`, `>=`, `==` or `!=`",
        ),
        ("1 + square(x)", "    ^^^^^^ there is no function `square`: write x^2"),
        ("clamp(x, 1)", "          ^ `,` is missing"),
        ("x < 1 ? 2", "         ^ `:` is missing"),
        ("2 * y", "    ^ there is no `y`: the operand is `x`"),
        ("3 + 1 / x", "    ^^^^^ a pole: the divisor is from -1 to 2"),
        ("2 · sqrt(x)", "    ^^^^^^^ the root of a negative number, from -1 to 2"),
        ("ln(x + 1)", "^^^^^^^^^ the logarithm of from 0 to 3, which is not above 0"),
        ("tan(x)", "^^^^^^ a pole of the tangent near from -1 to 2"),
    ] {
        let evaluated =
            parse(text).and_then(|it| it.of_operand("x")).and_then(|it| it.enclose(&[("x", wide)]));
        let under = evaluated.unwrap_err().under(text);
        let (first, second) = under.split_once('\n').unwrap();
        assert!(first == text && second.starts_with(shown), "{under}");
    }
    assert!(parse(&"(".repeat(5000)).unwrap_err().message.contains("nested more than"));
    assert!(
        parse(&format!("2{}", "^2".repeat(5000))).unwrap_err().message.contains("nested more than")
    );
}

#[test]
fn python_is_read_again() {
    let formula = parse("if(x < 2, sqrt(x) ^ 2, -(x - 1) / pi) * min(ln(x), 3)").unwrap();
    let python = formula.python();
    assert_eq!(python, "(sqrt(x) ** 2.0 if 2.0 > x else -(x - 1.0) / pi) * min(log(x), 3.0)");
    assert_eq!(parse(&python).unwrap(), formula);
}

fn ceiling(text: &str, fraction: u32) -> (i128, bool) {
    let formula = parse(text).unwrap_or_else(|fault| panic!("{}", fault.under(text)));
    formula.ceiling(fraction).unwrap_or_else(|fault| panic!("{}", fault.under(text)))
}

/// Checks that the evaluation finds, for every notation, that these values are multiples of 2^−fraction.
#[test]
fn exact_values_are_known_to_be_exact() {
    for (text, fraction, raw) in [
        ("1e0", 4, 16),
        ("2e0", 0, 2),
        ("1e3", 0, 1000),
        ("1E+3", 0, 1000),
        ("1.52587890625e-05", 16, 1),
        ("2**-14", 14, 1),
        ("2^-4", 4, 1),
        ("exp2(-2)", 2, 1),
        ("16^(1/2)", 0, 4),
        ("8 ^ (2 / 3)", 0, 4),
        ("cbrt(-27)", 0, -3),
        ("log2(16)", 0, 4),
        ("log2(1/8)", 0, -3),
        ("log10(1000)", 0, 3),
        ("ln(8) / ln(2)", 0, 3),
        ("exp(3 * ln(2))", 0, 8),
        ("0.1*10", 0, 1),
        ("1/3*3", 0, 1),
        ("0.1 + 0.2 - 0.3", 0, 0),
        ("sqrt(2.25)", 1, 3),
        ("sin(pi / 6)", 1, 1),
        ("cos(2 * pi / 3)", 1, -1),
        ("tan(-3 * pi / 4)", 0, 1),
        ("acos(0) / pi", 1, 1),
        ("atan(1) * 4 / pi", 0, 1),
        ("floor(0.7 * 10) + int(-2.5) + 7 % 0.1", 0, 5),
        ("max(0.1 * 3, 0.3) * 10", 0, 3),
        ("+3 - +1", 0, 2),
        ("1e−3 * 1000", 0, 1),
    ] {
        assert_eq!(ceiling(text, fraction), (raw, true), "{text}");
    }
    // These values lie between two neighbouring multiples: π = 3.14…, 2^16·π = 205887.4…, e^700 is large.
    for (text, fraction, raw) in [
        ("pi", 16, 205_888),
        ("-pi", 16, -205_887),
        ("0.3", 2, 2),
        ("1 + 1e-30", 0, 2),
        ("1 - 1e-30", 0, 1),
        ("sqrt(2)^2 + 1e-200", 0, 3),
        ("exp(700) / exp(699)", 0, 3),
        ("exp(-1000)", 0, 1),
    ] {
        assert_eq!(ceiling(text, fraction), (raw, false), "{text}");
    }
    let doubt = parse("sqrt(2)^2").unwrap().ceiling(0).unwrap_err();
    assert!(doubt.message.contains("1024 bits cannot"), "{doubt}");
}

/// Compares random decimals, with and without a power of ten, with integer arithmetic: digits · 10^(exponent − places) ≥ k /
/// 2^fraction.
#[test]
fn random_decimals_are_read_exactly() {
    let mut state = 1u64;
    let mut below = |most: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    for _ in 0..20_000 {
        let bits = below(31);
        let digits = i128::from(below(1 << bits));
        let places = below(7) as usize;
        let exponent = below(13) as i32 - 6;
        let fraction = below(21) as u32;
        let padded = format!("{digits:0>width$}", width = places + 1);
        let (whole, part) = padded.split_at(padded.len() - places);
        let text = match below(3) {
            0 => format!("{whole}.{part}"),
            1 => format!("{whole}.{part}e{exponent}"),
            _ => format!("-{whole}.{part}E{exponent:+}"),
        };
        let power = if text.contains(['e', 'E']) { exponent } else { 0 } - places as i32;
        let digits = if text.starts_with('-') { -digits } else { digits };
        let numerator = (digits * 10i128.pow(power.max(0) as u32)) << fraction;
        let denominator = 10i128.pow((-power).max(0) as u32);
        let expected = (numerator + denominator - 1).div_euclid(denominator);
        let is_operand = numerator % denominator == 0;
        assert_eq!(ceiling(&text, fraction), (expected, is_operand), "{text} with {fraction}");
    }
}

/// Checks formulas for which `f64` rounds to the wrong side of a jump, is too small, or overflows.
#[test]
fn steps_signs_and_sizes_are_decided_at_exact_operands() {
    for (text, operand, known) in [
        ("floor(log2(x))", "8", 3.0),
        ("floor(x * 0.1)", "30", 3.0),
        ("floor(x * 0.1)", "29", 2.0),
        ("floor(1.164 * (x - 16) + 0.5)", "141", 146.0),
        ("x % 0.1 * 10", "0.3", 0.0),
        ("if(log2(x) >= 3, 1, 0)", "8", 1.0),
        ("sqrt(-2 * ln(x))", "1", 0.0),
        ("sqrt(sin(pi * x))", "1", 0.0),
        ("tanh(x) ^ 0.7", "0", 0.0),
        ("(x ^ 2.2) ^ (1 / 2.4)", "0", 0.0),
        ("sqrt(log2(x))", "1", 0.0),
        ("x ^ 200 / (1 + x ^ 200)", "1e6", 1.0),
        ("softplus(x)", "1000", 1000.0),
        ("sigmoid(x)", "-710", 0.0),
        ("erf(x)", "40", 1.0),
        ("cbrt(sin(x))", "0", 0.0),
        ("floor(x * sqrt(2))", "0", 0.0),
        ("ceil(exp(1) * x)", "0", 0.0),
        ("floor(erf(x) * 1000)", "0.5", 520.0),
        ("floor(erf(-x) * 1000)", "0.5", -521.0),
    ] {
        let formula = parse(text).unwrap();
        let operand = parse(operand).unwrap().rational().unwrap();
        let value = formula
            .evaluate_exactly(&[("x", operand.clone())])
            .unwrap_or_else(|fault| panic!("{}", fault.under(text)));
        let is_near = (value.low - known).abs() < 1e-300 || value.holds(known);
        assert!(is_near && value.high - value.low <= 1e-12, "{text} at {operand}: {value:?}");
    }
    let undecided = "floor(sqrt(x)^2)";
    let fault = parse(undecided).unwrap().evaluate_exactly(&[("x", RBig::from(2))]).unwrap_err();
    assert_eq!(
        fault.under(undecided),
        "floor(sqrt(x)^2)\n^^^^^^^^^^^^^^^^ 1024 bits cannot decide on which side of a step this value is"
    );
}

/// Checks that the intervals of the two evaluations overlap, because each contains the exact value.
#[test]
fn both_evaluations_overlap() {
    for text in [
        "exp(x) - exp2(x) + ln(x + 4) * log2(x + 5)",
        "sin(3 * x) / cos(x / 4) + tan(x / 3)",
        "atan(x) * tanh(x) + erf(x) - abs(x) ^ 1.7",
        "x^7 - x^-2 + sqrt(x + 9) % 2",
        "if(x < 0.3, min(x, e), max(x, pi / 4))",
    ] {
        let formula = parse(text).unwrap();
        for k in (-300..=300).filter(|k| *k != 0) {
            let x = f64::from(k) / 128.0;
            let fast = value(text, x);
            let exact = RBig::try_from(x).unwrap();
            let slow = formula.evaluate_exactly(&[("x", exact)]).unwrap();
            assert!(slow.low <= fast.high && fast.low <= slow.high, "{text} at {x}");
            assert!(slow.low.next_up().next_up() >= slow.high, "{text} at {x}: {slow:?}");
        }
    }
}

#[test]
fn signs_of_other_alphabets_are_named() {
    for (text, shown) in [
        ("x²", " ^ `²` cannot be a part of a formula: a square is written `x^2`"),
        ("√x", "^ `√` cannot be a part of a formula: a root is written `sqrt(x)`"),
        ("x ÷ 2", "  ^ `÷` cannot be a part of a formula: a quotient is written `a / b`"),
        (
            "|x|",
            "^ `|` cannot be a part of a formula: an absolute value is written `abs(x)`; one of two conditions is \
             written with `or` or `||`",
        ),
        ("x – 1", "  ^ `–` cannot be a part of a formula: a minus sign is written `-`"),
    ] {
        let under = parse(text).unwrap_err().under(text);
        assert_eq!(under, format!("{text}\n{shown}"));
    }
    let nested = format!("{}x{}", "silu(".repeat(24), ")".repeat(24));
    assert!(parse(&nested).unwrap_err().message.contains("more than 4096 parts"));
    assert!(parse("1e401").is_err() && parse("2e").is_err() && parse(".").is_err());
}

#[test]
fn c_calls_the_functions_of_an_arithmetic() {
    for (text, limits, near) in [
        (
            "x^2 + 0.1",
            "add(power(x, number(\"2.0\")), number(\"0.1\"))",
            "near_add(near_square(x), near_rounded(0.1))",
        ),
        (
            "if(x >= 0.5, sin(x), sqrt(-x))",
            "choose(x, number(\"0.5\"), 1, wave(mpfr_sin, x), rising(mpfr_sqrt, negate(x)))",
            "near_choose(x, near_exactly(0.5), 1, near_wave(sin, x), near_rising(sqrt, near_negate(x)))",
        ),
        (
            "x^3 % pi",
            "remainder_of(power(x, number(\"3.0\")), constant(mpfr_const_pi))",
            "near_remainder_of(near_power(x, near_exactly(3.0)), near_rounded(3.141592653589793))",
        ),
    ] {
        let formula = parse(text).unwrap();
        assert_eq!(formula.c(CArithmetic::Limits), limits);
        assert_eq!(formula.c(CArithmetic::Near), near);
    }
}

/// Checks functions of shading languages and of C.
#[test]
fn functions_of_other_languages_have_their_values() {
    for (text, x, expected) in [
        ("clamp(x, -1, 2)", 5.0, 2.0),
        ("clamp(x, -1, 2)", -5.0, -1.0),
        ("mix(3, 7, x)", 0.25, 4.0),
        ("lerp(3, 7, x)", 1.0, 7.0),
        ("step(0.5, x)", 0.5, 1.0),
        ("step(0.5, x)", 0.25, 0.0),
        // t = 1/2: 1/4 · (3 − 1).
        ("smoothstep(1, 3, x)", 2.0, 0.5),
        // t = 1/4: 1/16 · (3 − 1/2).
        ("smoothstep(0, 1, x)", 0.25, 0.15625),
        ("smoothstep(1, 3, x)", 9.0, 1.0),
        ("fract(x)", -1.25, 0.75),
        ("mod(x, 3)", -1.0, 2.0),
        ("sign(x)", -4.0, -1.0),
        ("sign(x)", 0.0, 0.0),
        ("ceil(x)", 1.25, 2.0),
        ("ceil(x)", -1.25, -1.0),
        ("round(x)", 2.5, 3.0),
        ("round(x)", -2.5, -2.0),
        ("trunc(x)", -2.5, -2.0),
        ("saturate(x)", 1.5, 1.0),
        ("min(4, x, 2, 3)", 2.5, 2.0),
        ("max(1, 2, x)", 2.5, 2.5),
        ("hypot(2, x, 6)", 3.0, 7.0),
        ("x > 1 ? 10 : x < -1 ? 20 : 30", -2.0, 20.0),
        ("clamp(u, v, w) + x", 0.0, 0.0),
        ("if(x == 2, 5, 6)", 2.0, 5.0),
        ("if(x == 2, 5, 6)", 2.5, 6.0),
        ("x != 0 ? 1 / x : 9", 0.0, 9.0),
        ("x != 0 ? 1 / x : 9", -0.5, -2.0),
    ] {
        let formula = parse(text).unwrap_or_else(|fault| panic!("{}", fault.under(text)));
        let operands = ["x", "u", "v", "w"].map(|name| {
            let value = if name == "x" { x } else { 0.0 };
            (name, Enclosure::exactly(value))
        });
        let value = formula.enclose(&operands).expect(text);
        assert!(value.low <= expected && expected <= value.high, "{text} at {x}: {value:?}");
        assert!(value.high - value.low < 1e-9, "{text} at {x}: {value:?}");
    }
}

type KnownCondition = (&'static str, fn(f64, f64) -> bool);

#[test]
fn conditions_join_comparisons() {
    let known: [KnownCondition; 12] = [
        ("0 < x < y", |x, y| 0.0 < x && x < y),
        ("0 <= x < y", |x, y| 0.0 <= x && x < y),
        ("x > 0 and y > 0", |x, y| x > 0.0 && y > 0.0),
        ("x > 0 && y >= 0", |x, y| x > 0.0 && y >= 0.0),
        ("x > 0 or y > 1", |x, y| x > 0.0 || y > 1.0),
        ("x >= 1 || y > 1", |x, y| x >= 1.0 || y > 1.0),
        ("x != y", |x, y| x != y),
        ("not (x < y)", |x, y| x >= y),
        ("!(x == y) and x <= 1", |x, y| x != y && x <= 1.0),
        ("x > 1 or x < y and y > 0", |x, y| x > 1.0 || x < y && y > 0.0),
        ("(x > 1 or x < y) and (y) > (0)", |x, y| (x > 1.0 || x < y) && y > 0.0),
        ("(x + 1) * (y - 1) < 0 or (x > y ? x : y) > 1", |x, y| {
            (x + 1.0) * (y - 1.0) < 0.0 || x.max(y) > 1.0
        }),
    ];
    for (text, holds) in known {
        let comparison = parse_condition(text).unwrap();
        let choices = [
            format!("if({text}, 5, 7)"),
            format!("({text}) ? 5 : 7"),
            format!("5 if {text} else 7"),
        ];
        for (x, y) in (-2..=2).flat_map(|x| (-2..=2).map(move |y| (f64::from(x), f64::from(y)))) {
            let operands = [("x", Enclosure::exactly(x)), ("y", Enclosure::exactly(y))];
            let expected = holds(x, y);
            assert_eq!(comparison.holds(&operands), Ok(Some(expected)), "{text} at {x}, {y}");
            for choice in &choices {
                let value = parse(choice).unwrap().enclose(&operands).unwrap();
                let case = if expected { 5.0 } else { 7.0 };
                assert_eq!(value, Enclosure::exactly(case), "{choice} at {x}, {y}");
            }
        }
    }
    let many = vec!["x < y"; 1000];
    for joined in [many.join(" and "), many.join(" or "), format!("x{}", " < y".repeat(1000))] {
        assert!(parse_condition(&joined).unwrap_err().message.contains("more than 400 conditions"));
    }
    assert!(parse_condition(&format!("{}x < y", "! ".repeat(9000))).is_ok());
    for wrong in ["x", "x <", "x < y z", "x and y", "not", "(x < y", "x < y and", "x ? y : 1"] {
        assert!(parse_condition(wrong).is_err(), "{wrong}");
    }
}
