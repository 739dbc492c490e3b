//! Tests the mistakes that a device's description can contain: each has a message that names the signals and the source line,
//! and a code.

mod instances;
mod microprogram;

use std::panic::Location;

use glint::config::Config;
use glint::dsl::{About, Designer, StepSetting, end, loop_while, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::blocks::divider::Divider;
use glint::registry::Registry;

use crate::common::Sure;
use crate::common::files::{below, read};

const BYTE: Format = Format::unsigned(0, 8);

/// The mistakes of a description.
#[derive(Debug)]
struct Found(Vec<String>);

impl Found {
    #[track_caller]
    fn are<const COUNT: usize>(&self, expected: [&str; COUNT]) {
        assert_eq!(self.0, expected);
    }
}

#[track_caller]
fn finish(d: Designer) -> Found {
    let found = d.finish().err().map_or_else(Vec::new, |diagnostics| diagnostics.0);
    for diagnostic in &found {
        assert_eq!(diagnostic.location.file(), Location::caller().file(), "{diagnostic}");
        assert!(diagnostic.location.line() > 1);
    }
    Found(found.into_iter().map(|diagnostic| diagnostic.message).collect())
}

/// Returns a small device with these microinstructions.
#[track_caller]
fn program(steps: impl FnOnce(&Designer, StepSetting) -> Vec<glint::dsl::Step>) -> Found {
    let d = Designer::new("device");
    let x = d.operand("x", BYTE);
    let y = d.register("y", BYTE);
    y.takes(x.q());
    d.output("y_out", y.q());
    let steps = steps(&d, y.load());
    d.microprogram(steps);
    finish(d)
}

/// Returns a small device that is right but for what `wrong` adds.
#[track_caller]
fn mistakes(wrong: impl FnOnce(&Designer)) -> Found {
    program(|d, load| {
        wrong(d);
        vec![step("idle", []), step("load", [load]), step("result", [valid(), end()])]
    })
}

/// Each code has its page and is reported somewhere; no page is left over.
#[test]
fn every_code_has_its_page() {
    let declared = read("generator/base/codes.rs");
    let codes = declared.lines().filter_map(|line| {
        let (name, number) = line.strip_prefix("pub const ")?.split_once(": Code = Code(")?;
        Some((name, format!("G{:0>4}", number.strip_suffix(");")?)))
    });
    let codes: Vec<_> = codes.collect();
    let pages: Vec<_> = glint::base::codes::pages().collect();
    let paged: Vec<&str> = pages.iter().map(|page| page.0).collect();
    assert_eq!(codes.iter().map(|it| it.1.as_str()).collect::<Vec<_>>(), paged);
    assert!(pages.len() > 20 && pages.iter().all(|page| page.2.len() > 100), "{pages:?}");
    let sources: String = below("generator/hdl".as_ref()).into_iter().map(read).collect();
    for (name, code) in codes {
        assert!(sources.contains(&format!("codes::{name},")), "{code} is never reported");
    }
}

#[test]
fn a_mistake_names_its_code_and_the_command_that_explains_it() {
    let d = Designer::new("device");
    let wrong = d.finish().expect_err("no microprogram");
    let text = wrong.to_string();
    assert!(
        text.starts_with("error[G0401]: the design has no microprogram\n  --> tests/"),
        "{text}"
    );
    assert!(text.ends_with("\n`glint explain G0401` explains the mistake"), "{text}");
}

#[test]
fn a_right_description_has_no_mistakes() {
    mistakes(|_| ()).are([]);
}

#[test]
fn two_drivers_are_reported() {
    mistakes(|d| {
        let w = d.wire("w", BYTE);
        let a = d.operand("a", BYTE);
        d.drive(w, a.q());
        d.drive(w, a.q());
        let r = d.register("r", BYTE);
        r.takes(a.q());
        r.takes(w);
    })
    .are(["`w` has two drivers: `a_reg` is the second", "`r` has two drivers: `w` is the second"]);
}

#[test]
fn the_line_of_a_mistake_is_that_of_the_description() {
    let d = Designer::new("device");
    let a = d.operand("a", BYTE);
    let w = d.wire("w", BYTE);
    d.drive(w, a.q());
    let line = line!() + 1;
    d.drive(w, a.q());
    d.microprogram([step("idle", []), step("end", [end()])]);
    let found = d.finish().unwrap_err();
    assert_eq!(found.0[0].location.line(), line);
    assert!(found.to_string().contains(&format!("--> {}:{line}:", file!())), "{found}");
}

#[test]
fn missing_drivers_are_reported() {
    mistakes(|d| {
        d.wire("floating", BYTE);
        let r = d.register("idle_register", BYTE);
        let _ = r;
    })
    .are([
        "nothing drives `floating`",
        "nothing drives the data input of register `idle_register`",
    ]);
}

#[test]
fn combinational_loops_are_reported() {
    let Found(found) = mistakes(|d| {
        let a = d.operand("a", BYTE);
        let w = d.wire("w", BYTE);
        let sum = d.add_modulo("sum", w, a.q(), None);
        let back = d.not("back", sum);
        d.drive(w, back);
    });
    assert_eq!(found.len(), 1);
    assert!(found[0].starts_with("combinational loop: `"), "{found:?}");
    for name in ["`w`", "`sum`", "`back`"] {
        assert!(found[0].contains(name), "{found:?}");
    }
}

#[test]
fn formats_must_match() {
    let found = mistakes(|d| {
        let a = d.operand("a", Format::unsigned(2, 3));
        let b = d.operand("b", Format::unsigned(1, 7));
        let r = d.register("r", BYTE);
        r.takes(a.q());
        d.mux("m", [a.q(), b.q()]);
        d.add_modulo("s", a.q(), b.q(), None);
        let _ = b.q().with_fraction(3);
        let _ = a.q().bits(3, BYTE);
        d.and("both", a.q(), b.q());
    });
    let expected = [
        "register `r` is u0.8, but `a_reg` is u2.3 with values from 0 to 31 ulp: narrow the signal or change \
         the format",
        "mux `m`: `a_reg` is u2.3 and `b_reg` is u1.7; the binary points differ: align them with \
         `with_fraction`, or use a `bus`",
        "`s` adds `a_reg` (u2.3) and `b_reg` (u1.7) modulo the width: the formats must be \
         equal",
        "`b_reg` is u1.7, and 3 fraction bits would drop some of its bits: use `narrow`",
        "bits 3 to 10 of `a_reg` do not all exist: the signal has 5 bits",
        "`a_reg` is u2.3, but one bit is required here",
        "`b_reg` is u1.7, but one bit is required here",
    ];
    found.are(expected);
}

#[test]
fn products_must_be_formed() {
    mistakes(|d| {
        let a = d.operand("a", BYTE);
        let b = d.operand("b", Format::unsigned(2, 6));
        let select = d.select("operands", &["a", "b"]);
        let first = d.bus("first", select, [a.q(), b.q()]);
        let second = d.bus("second", select, [a.q(), b.q()]);
        let product = d.shared_mul("product", &first, &second);
        let _ = product.of(a.q(), b.q());
        let _ = product.of_any(&[(a.q(), a.q()), (b.q(), b.q())]);
    })
    .are([
        "`product` never multiplies `a_reg` by `b_reg`",
        "the selected products of `product` have different numbers of fraction bits, [16, 12]: append zeros \
         to an operand",
    ]);
}

#[test]
fn nets_have_at_most_64_bits() {
    mistakes(|d| {
        let a = d.operand("a", Format::unsigned(0, 40));
        d.mul("square", a.q(), a.q());
    })
    .are(["`square` would have 80 bits (u0.80); a net has 1 to 64 bits"]);
}

#[test]
fn roms_fit_their_address_and_format() {
    mistakes(|d| {
        let a = d.operand("a", Format::unsigned(3, 0));
        d.rom("short", a.q(), BYTE, &[1, 2, 3], false);
        d.rom("wide", a.q(), BYTE, &[0, 1, 2, 3, 4, 5, 6, 256], false);
    })
    .are([
        "ROM `short` has 3 words, but its address `a_reg` (u3.0) runs from 0 to 7",
        "ROM `wide`: word 7 is 256, which does not fit u0.8",
    ]);
}

#[test]
fn constants_must_be_representable() {
    mistakes(|d| {
        d.constant("third", 1.0 / 3.0, BYTE);
        d.raw_constant("many", 256, BYTE);
    })
    .are([
        "constant `third`: 0.3333333333333333 is not representable in u0.8",
        "constant `many`: 256 does not fit u0.8",
    ]);
}

#[test]
fn names_must_be_verilog_names() {
    let Found(found) = mistakes(|d| {
        d.operand("a", BYTE);
        d.operand("a", BYTE);
        d.operand("module", BYTE);
        d.operand("two words", BYTE);
        d.operand("clk", BYTE);
    });
    let twice =
        ["a", "a_write", "a_load", "a_reg"].map(|name| format!("the name `{name}` is used twice"));
    for message in twice {
        assert!(found.contains(&message), "{found:#?}");
    }
    let has = |start: &str| found.iter().any(|message| message.starts_with(start));
    assert!(has("`module` cannot be a Verilog name: "), "{found:#?}");
    assert!(has("`two words` cannot be a Verilog name: "), "{found:#?}");
    assert!(has("`clk` is the clock of every design"), "{found:#?}");
}

#[test]
fn names_of_the_sequencer_are_reserved() {
    // The second of the two is where the program is, which is what makes it.
    mistakes(|d| {
        d.operand("word_address", BYTE);
    })
    .are(["the name `word_address` is used twice"]);
}

#[test]
fn no_signal_has_the_name_of_the_device() {
    mistakes(|d| {
        d.about(About { device: "soft-blend".into(), ..About::default() });
        d.operand("soft_blend", BYTE);
    })
    .are(["`soft_blend` is the name of the device and of its module; choose another name"]);
}

#[test]
fn formats_have_limits() {
    let Found(found) = mistakes(|d| {
        d.constant("nothing", 0.0, Format::unsigned(-3, 1));
        d.raw_constant("huge", 0, Format::unsigned(i32::MAX, 1));
        d.register("far", Format::unsigned(2001, -2000));
        let a = d.operand("a", BYTE).q();
        let _ = a.bits(u32::MAX, Format::BIT);
        let _ = a.with_fraction(500);
        let _ = a.shift_left(i32::MIN);
        d.narrow("none", a, Format::signed(0, -1), Rounding::Truncate, Overflow::Saturate);
    });
    let expected = [
        "`nothing` would have -2 bits (u-3.1); a net has 1 to 64 bits",
        "`huge` would have 2147483648 bits (u2147483647.1); a net has 1 to 64 bits",
        "`far` would have -2000 fraction bits (u2001.-2000); a net has -1000 to 1000 fraction bits",
        "bits 4294967295 to 4294967295 of `a_reg` do not all exist: the signal has 8 bits",
        "`a_reg_scaled` would have 500 bits (u0.500); a net has 1 to 64 bits",
    ];
    assert_eq!(found[..expected.len()], expected);
    assert!(found[expected.len()].starts_with("`a_reg_shifted` would"), "{found:?}");
    assert!(found[expected.len() + 1].starts_with("`none` would have 0 bits"), "{found:?}");
}

/// Returns the warnings of a small device that says more than it needs to.
fn warnings(more: impl FnOnce(&Designer) -> Vec<StepSetting>) -> Found {
    let d = Designer::new("device");
    let x = d.operand("x", BYTE);
    let y = d.register("y", BYTE);
    y.takes(x.q());
    d.output("y_out", y.q());
    let load = more(&d).into_iter().chain([y.load()]);
    d.microprogram([step("idle", []), step("load", load), step("result", [valid(), end()])]);
    let design = d.finish().sure();
    for warning in &design.warnings {
        assert_eq!(warning.location.file(), file!(), "{warning}");
    }
    Found(design.warnings.into_iter().map(|warning| warning.message).collect())
}

#[test]
fn unused_logic_has_a_warning() {
    warnings(|_| Vec::new()).are([]);
    // Of the logic before a register, or before a sum, that is not used there is no word.
    warnings(|d| {
        let a = d.operand("a", BYTE).q();
        d.output("a_out", a);
        let unread = d.register("unread", Format::unsigned(1, 8));
        unread.takes(d.add("taken", a, a));
        let _ = d.not("inverted", d.add("sum", a, a));
        let address = a.read_as(Format::unsigned(8, 0));
        let _ = d.rom("words", address, BYTE, &[1; 256], false);
        vec![unread.load()]
    })
    .are([
        "`unread` is not used: no output depends on it",
        "`inverted` is not used: no output depends on it",
        "`words_word` is not used: no output depends on it",
    ]);
}

#[test]
fn constant_muxes_have_a_warning() {
    warnings(|d| {
        let a = d.operand("a", BYTE).q();
        let b = d.operand("b", BYTE).q();
        d.output("same", d.choose("twice", a.bit(0), [b, b]));
        let one = d.raw_constant("one", 1, Format::BIT);
        d.output("known", d.choose("second", one, [a, b]));
        let m = d.mux("m", [a, b, d.not("inverted", a)]);
        d.output("m_out", m.out());
        vec![m.pick(b)]
    })
    .are([
        "mux `twice` always passes `b_reg` on: use that signal in place of the mux",
        "mux `second` always passes `b_reg` on: use that signal in place of the mux",
        "no microinstruction selects `inverted` with `m_select`",
    ]);
}

#[test]
fn the_catalogue_has_no_warnings() {
    for device in Registry::catalogue().devices() {
        let config = Config::defaults(&(device.schema)(), "core");
        let design = device.open(config).sure().design().sure();
        assert!(design.warnings.is_empty(), "{}: {:?}", device.name, design.warnings);
    }
}

#[test]
fn signs_are_refused_where_magnitudes_are_wanted() {
    mistakes(|d| {
        let a = d.operand("a", Format::signed(2, 0)).q();
        let b = d.operand("b", Format::unsigned(2, 0)).q();
        d.output("word", d.concat("pair", b, a));
        let _ = Divider::new(d, "ratio", b, a, 1);
    })
    .are([
        "`pair` puts `a_reg`, which is s2.0, beside other bits of an unsigned number: convert the signal \
         with `read_as`, or use `join`",
        "divider `ratio` has a quotient of 1 bits: request at least two bits",
        "divider `ratio`: `a_reg` has values from -4 to 3 ulp: divide absolute values, or narrow the operand \
         to an unsigned format, which saturates at 0",
    ]);
}

#[test]
fn signals_belong_to_their_designer() {
    let other = Designer::new("other");
    let theirs = other.operand("theirs", BYTE);
    let select = other.select("way", &["one", "other"]);
    let register = other.register("there", BYTE);
    let said = |name: &str| {
        format!("`{name}` is a signal of the designer of `other`, not of the designer of `device`")
    };
    let Found(found) = mistakes(|d| {
        let ours = d.operand("ours", BYTE).q();
        let bit = other.raw_constant("bit", 1, Format::BIT);
        let _ = d.add("sum", ours, theirs.q());
        let _ = d.mul("product", theirs.q(), ours);
        let _ = d.less("less", ours, theirs.q());
        let _ = d.choose("chosen", bit, [ours, ours]);
        let _ = d.narrow("narrowed", theirs.q(), BYTE, Rounding::Nearest, Overflow::Saturate);
        let _ = d.mux("mux", [ours, theirs.q()]).pick(theirs.q());
        let _ = d.mux_on("on", select, [ours, ours]);
        let _ = d.output("shown", theirs.q());
        let _ = d.join("joined", &[ours, theirs.q()], Format::unsigned(0, 16));
        let _ = d.pipeline("late", theirs.q());
        d.register("r", BYTE).takes(theirs.q());
    });
    let reg = said("theirs_reg");
    let expected: Vec<String> = [
        vec![reg.clone(); 3],
        vec![said("bit"), reg.clone(), reg.clone(), reg.clone(), said("way")],
        vec![reg; 4],
    ]
    .concat();
    assert_eq!(found, expected);
    // Knobs and conditions, whose numbers would mean other fields and nets.
    program(|_, load| {
        let more = other.any("more", theirs.q());
        vec![
            step("idle", []),
            step("load", [load, register.load()]),
            step("again", [loop_while(more, "load")]),
            step("result", [valid(), end()]),
        ]
    })
    .are([
        "microinstruction `load`: `there.load` belongs to the designer of `other`, not to the designer of \
         `device`",
        "microinstruction `again`: a condition belongs to the designer of `other`, not to the designer of \
         `device`",
    ]);
}
