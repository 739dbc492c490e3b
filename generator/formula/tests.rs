//! Tests that formulas are parsed, evaluated and printed.

use super::{Enclosure, parse};

fn value(text: &str, x: f64) -> Enclosure {
    let formula = parse(text).unwrap_or_else(|fault| panic!("{}", fault.under(text)));
    formula
        .enclose(&[("x", Enclosure::exactly(x))])
        .unwrap_or_else(|fault| panic!("{}", fault.under(text)))
}

/// Values to 20 digits, from tables (Abramowitz and Stegun) and by hand: between the limits, which are near.
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
    ] {
        let limits = value(text, x);
        assert!(limits.holds(known) && limits.high - limits.low < 1e-13, "{text}: {limits:?}");
    }
}

/// Values that f64 has exactly stay exact, so that a root at the end of its domain is one.
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
        ("x # 2", "  ^ `#` is no part of a formula"),
        ("(x + 1", "      ^ `)` is missing"),
        ("1.2.3", "^^^^^ this is no number"),
        ("if(x, 1, 2)", "    ^ `<`, `>`, `<=` or `>=` is missing"),
        ("2x", " ^ this does not belong here: a product has a sign, `2*x`"),
        ("if(x == 2, 1, 2)", "     ^ `=` is no part of a formula: `<`, `>`, `<=` and `>=` compare"),
        ("1 + hypot(3, x)", "    ^^^^^ there is no function `hypot`: write sqrt(x^2 + y^2)"),
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
    assert!(parse(&"(".repeat(5000)).unwrap_err().message.contains("within each other"));
    assert!(
        parse(&format!("2{}", "^2".repeat(5000)))
            .unwrap_err()
            .message
            .contains("within each other")
    );
}

#[test]
fn python_is_read_again() {
    let formula = parse("if(x < 2, sqrt(x) ^ 2, -(x - 1) / pi) * min(ln(x), 3)").unwrap();
    let python = formula.python();
    assert_eq!(python, "(sqrt(x) ** 2.0 if 2.0 > x else -(x - 1.0) / pi) * min(log(x), 3.0)");
    assert_eq!(parse(&python).unwrap(), formula);
}
