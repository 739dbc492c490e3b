//! Each mistake in a configuration file: its message, its place and its remedy, word for word.

use std::fs;
use std::path::Path;

use crate::config_device::{lamp, schemas};
use glint::config::{Config, Problems, Value, parse, read};

/// `line:column key | message | remedy` for each problem.
fn lines(problems: &Problems) -> Vec<String> {
    let each = |problem: &glint::config::Problem| {
        let (line, column) = problems.position(problem).unwrap_or((0, 0));
        format!("{line}:{column} {} | {} | {}", problem.key, problem.message, problem.remedy)
    };
    problems.iter().map(each).collect()
}

fn of_file(name: &str, text: &str) -> Vec<String> {
    match parse(name, text, &schemas()) {
        Ok(config) => vec![format!("accepted: {config:?}")],
        Err(problems) => lines(&problems),
    }
}

/// The problems of a file for `lamp` whose further lines are given; they start at line 2.
fn of_lamp(text: &str) -> Vec<String> {
    of_file("lamp.toml", &format!("device = \"lamp\"\n{text}"))
}

#[test]
fn unknown_names_are_answered_with_the_nearest() {
    assert_eq!(
        of_lamp("cosine.fracton = 20\n"),
        ["2:8 cosine.fracton | device `lamp` has no key `cosine.fracton` \
          | did you mean `cosine.fraction`?"]
    );
    assert_eq!(
        of_lamp("Arithmetic = \"exact\"\n"),
        ["2:1 Arithmetic | device `lamp` has no key `Arithmetic` | did you mean `arithmetic`?"]
    );
    assert_eq!(
        of_lamp("[cosin]\nfraction = 20\n"),
        ["2:2 cosin | device `lamp` has no table `cosin` | did you mean `cosine`?"]
    );
    assert_eq!(
        of_lamp("fraction = 20\n"),
        ["2:1 fraction | device `lamp` has no key `fraction` | there is `cosine.fraction`"]
    );
    assert_eq!(
        of_lamp("zzz = 20\n"),
        ["2:1 zzz | device `lamp` has no key `zzz` | keys outside tables: device, name, strict, \
          arithmetic, power, architecture; tables: [cosine], [sine], [domain], [pipeline], [output], [operands], [interface], [package]"]
    );
    assert_eq!(
        of_lamp("[cosine]\nzzz = 20\n"),
        [
            "3:1 cosine.zzz | device `lamp` has no key `cosine.zzz` | keys of [cosine]: fraction, signed"
        ]
    );
    assert_eq!(
        of_lamp("\"cosine.fraction\" = 20\n"),
        ["2:1 \"cosine.fraction\" | device `lamp` has no key `\"cosine.fraction\"` \
          | did you mean `cosine.fraction`?"]
    );
}

#[test]
fn a_key_below_the_wrong_heading_is_told_where_it_belongs() {
    assert_eq!(
        of_lamp("[cosine]\nfraction = 20\nstrict = true\nsine.address = 9\n"),
        [
            "4:1 cosine.strict | device `lamp` has no key `cosine.strict` \
             | `strict` is outside [cosine]: move it above the first [table] heading",
            "5:1 cosine.sine | device `lamp` has no table `cosine.sine` \
             | `sine` is outside [cosine]: move it above the first [table] heading",
        ]
    );
}

#[test]
fn keys_that_every_device_shares_are_read_as_its_own() {
    assert_eq!(
        of_lamp("[package]\nsofware = true\nsoftware = \"yes\"\n"),
        [
            "3:1 package.sofware | device `lamp` has no key `package.sofware` \
             | did you mean `package.software`?",
            "4:12 package.software | `package.software` must be true or false, not the string \"yes\" \
             | give true or false (default false)",
        ]
    );
}

#[test]
fn keys_for_vendors_tools_are_checked() {
    let of_package = |keys: &str| of_lamp(&format!("[package]\n{keys}"));
    assert_eq!(
        of_package("vivado = true\n"),
        ["3:10 package.vivado | `package.vivado` has no effect with package.constraints = false \
          | remove it, or set package.constraints = true"]
    );
    // A period of such a clock is none that a tool reads.
    for (given, shown) in
        [("-1", "-1.0"), ("5e-324", "5e-324"), ("0.999", "0.999"), ("2001", "2001.0")]
    {
        assert_eq!(
            of_package(&format!("constraints = true\nclock_mhz = {given}\n")),
            [format!(
                "4:13 package.clock_mhz | `package.clock_mhz` = {shown} is out of range \
                 | give 0, or a number from 1.0 to 2000.0 (default 0.0)"
            )]
        );
    }
    for given in ["0", "0.0", "1", "2000"] {
        let said = of_package(&format!("constraints = true\nclock_mhz = {given}\n"));
        assert!(said[0].starts_with("accepted"), "{said:?}");
    }
    assert_eq!(
        of_package("litex = true\n"),
        ["3:9 package.litex | `package.litex` has no effect with package.memories = \"files\" \
          | remove it, or set package.memories = \"inline\""]
    );
    assert_eq!(
        of_package("vendor = \"a \\\"b\\\" [exit]\"\nversion = \"1.0\"\nlicence = 7\n"),
        [
            "3:10 package.vendor | `package.vendor` cannot be \"a \\\"b\\\" [exit]\" \
             | give a name of at most 60 letters, digits, `.`, `-` and `_`, beginning with a letter (default \"glint\")",
            "4:11 package.version | `package.version` cannot be \"1.0\" \
             | give a version of three numbers up to 9999, as \"1.0.0\" (default \"0.1.0\")",
            "5:11 package.licence | `package.licence` must be a string, not the integer 7 \
             | give an SPDX licence expression of at most 60 characters, as \"MIT OR Apache-2.0\" \
             (default \"LicenseRef-belongs-to-its-user\")",
        ]
    );
}

#[test]
fn an_unknown_bus_is_told_of() {
    assert_eq!(
        of_lamp("[interface]\nregisters = \"wishbon\"\n"),
        ["3:13 interface.registers | `interface.registers` cannot be \"wishbon\" \
          | did you mean \"wishbone\"? give \"none\", \"axi-lite\" or \"wishbone\" (default \"none\")"]
    );
    assert_eq!(
        of_lamp("architecture = \"pipelined\"\n[interface]\nregisters = \"wishbone\"\n"),
        [
            "4:13 interface.registers | `interface.registers` has no effect with architecture = \"pipelined\" \
          | remove it, or set architecture = \"sequential\""
        ]
    );
}

#[test]
fn registered_multipliers_are_for_a_pipeline_on_ecp5() {
    let of_target = |target: &str| {
        of_lamp(&format!(
            "architecture = \"pipelined\"\n[pipeline]\ntarget = \"{target}\"\nmultipliers = \"registered\"\n"
        ))
    };
    for target in ["ice40", "xilinx7", "generic"] {
        assert_eq!(
            of_target(target),
            [format!(
                "5:15 pipeline.multipliers | `pipeline.multipliers` has no effect with pipeline.target = \"{target}\" \
                 | remove it, or set pipeline.target = \"ecp5\""
            )]
        );
    }
    let said = of_target("ecp5");
    assert!(said[0].starts_with("accepted"), "{said:?}");
    assert_eq!(
        of_lamp("[pipeline]\nmultipliers = \"registered\"\n"),
        [
            "3:15 pipeline.multipliers | `pipeline.multipliers` has no effect with architecture = \"sequential\" \
             | remove it, or set architecture = \"pipelined\""
        ]
    );
}

#[test]
fn a_stream_that_does_not_fit_is_told_of() {
    assert_eq!(
        of_lamp("[interface]\nstream = true\nuser_bits = 1025\n"),
        ["4:13 interface.user_bits | `interface.user_bits` = 1025 is out of range \
          | give an integer from 1 to 1024 (default 1)"]
    );
    assert_eq!(
        of_lamp(
            "architecture = \"pipelined\"\n[pipeline]\nstall = \"none\"\n[interface]\nstream = true\n"
        ),
        [
            "6:10 interface.stream | `interface.stream` needs a pipeline that its receiver can hold back \
          | set pipeline.stall = \"ready\", or remove interface.stream"
        ]
    );
}

#[test]
fn devices() {
    assert_eq!(
        of_file("a.toml", "device = \"lmap\"\npower = 3\n"),
        [
            "1:10 device | there is no device \"lmap\" | did you mean \"lamp\"? devices: lamp, mirror",
            "2:9 power | `power` cannot be 3 | give 2, 4, 8 or 16 (default 16)",
        ]
    );
    assert_eq!(
        of_file("a.toml", "device = \"teapot\"\nstrict = 1\nanything = 3\n"),
        [
            "1:10 device | there is no device \"teapot\" | devices: lamp, mirror",
            "2:10 strict | `strict` must be true or false, not the integer 1 \
             | give true or false (default false)",
        ]
    );
    assert_eq!(
        of_file("a.toml", "strict = true\n"),
        ["0:0 device | the file does not say which device it configures \
          | add `device = \"…\"`; devices: lamp, mirror"]
    );
    assert_eq!(
        of_file("a.toml", "device = 7\n"),
        ["1:10 device | `device` must be a string, not the integer 7 | devices: lamp, mirror"]
    );
}

#[test]
fn wrong_types_name_what_was_found() {
    let integer = "give an integer from 4 to 30 (default 20)";
    let cases = [
        ("20.0", "2:19", "the float 20.0"),
        ("\"20\"", "2:19", "the string \"20\""),
        ("true", "2:19", "the boolean true"),
        ("1979-05-27", "2:19", "a date"),
        ("[20]", "2:19", "a list"),
        ("{ bits = 20 }", "2:8", "a table"),
    ];
    for (value, place, found) in cases {
        assert_eq!(
            of_lamp(&format!("cosine.fraction = {value}\n")),
            [format!(
                "{place} cosine.fraction | `cosine.fraction` must be an integer, not {found} | {integer}"
            )]
        );
    }
    assert_eq!(
        of_lamp(
            "arithmetic = 1\npower = \"16\"\ncosine.signed = 0\nsine.address = 9.5\n\
                 domain.deviation = \"wide\"\n"
        ),
        [
            "2:14 arithmetic | `arithmetic` must be a string, not the integer 1 \
             | give \"exact\" or \"patent\" (default \"exact\")",
            "3:9 power | `power` must be an integer, not the string \"16\" \
             | give 2, 4, 8 or 16 (default 16)",
            "4:17 cosine.signed | `cosine.signed` must be true or false, not the integer 0 \
             | give true or false (default false)",
            "5:16 sine.address | `sine.address` must be an integer, not the float 9.5 \
             | give an integer from 1 to 16 (default 12)",
            "6:20 domain.deviation | `domain.deviation` must be a number, not the string \"wide\" \
             | give a number from 0.5 to 90.0 (default 30.0)",
        ]
    );
    assert_eq!(
        of_lamp("cosine = 20\n"),
        [
            "2:10 cosine | `cosine` is a table, not the integer 20 | keys of [cosine]: fraction, signed"
        ]
    );
    assert_eq!(
        of_lamp("[[cosine]]\nfraction = 20\n"),
        ["2:1 cosine | `cosine` is a table, not a list | keys of [cosine]: fraction, signed"]
    );
}

#[test]
fn values_out_of_range() {
    for value in [
        "0",
        "-1",
        "3",
        "31",
        "9223372036854775807",
        "99999999999999999999999",
        "0xffffffffffffffffff",
    ] {
        let shown = value.to_string();
        assert_eq!(
            of_lamp(&format!("cosine.fraction = {value}\n")),
            [format!(
                "2:19 cosine.fraction | `cosine.fraction` = {shown} is out of range \
                 | give an integer from 4 to 30 (default 20)"
            )]
        );
    }
    for (value, shown) in [("0", "0.0"), ("90.1", "90.1"), ("nan", "NaN"), ("-inf", "-inf")] {
        assert_eq!(
            of_lamp(&format!("domain.deviation = {value}\n")),
            [format!(
                "2:20 domain.deviation | `domain.deviation` = {shown} is out of range \
                 | give a number from 0.5 to 90.0 (default 30.0)"
            )]
        );
    }
    assert_eq!(
        of_lamp("arithmetic = \"exakt\"\nsine.scheme = \"cubic\"\n"),
        [
            "2:14 arithmetic | `arithmetic` cannot be \"exakt\" \
             | did you mean \"exact\"? give \"exact\" or \"patent\" (default \"exact\")",
            "3:15 sine.scheme | `sine.scheme` cannot be \"cubic\" \
             | give \"direct\" or \"segmented\" (default \"direct\")",
        ]
    );
}

#[test]
fn lists_are_checked_entry_by_entry() {
    let remedy = "give 1 to 8 integers from 2 to 14 (default [6, 5])";
    assert_eq!(
        of_lamp("sine.scheme = \"segmented\"\nsine.segments = [1, 5,\n 15]\n"),
        [
            format!("3:18 sine.segments | `sine.segments[0]` = 1 is out of range | {remedy}"),
            format!("4:2 sine.segments | `sine.segments[2]` = 15 is out of range | {remedy}"),
        ]
    );
    assert_eq!(
        of_lamp("sine.scheme = \"segmented\"\nsine.segments = [6, \"x\", 99999999999999999999]\n"),
        [
            format!(
                "3:21 sine.segments | `sine.segments[1]` must be an integer, not the string \"x\" | {remedy}"
            ),
            format!(
                "3:26 sine.segments | `sine.segments[2]` = 99999999999999999999 is out of range | {remedy}"
            ),
        ]
    );
    assert_eq!(
        of_lamp("sine.scheme = \"segmented\"\nsine.segments = []\n"),
        [format!("3:17 sine.segments | `sine.segments` has 0 entries | {remedy}")]
    );
}

#[test]
fn conditions_between_keys() {
    assert_eq!(
        of_lamp("[sine]\naddress = 12\nscheme = \"segmented\"\n"),
        ["3:11 sine.address | `sine.address` has no effect with sine.scheme = \"segmented\" \
          | remove it, or set sine.scheme = \"direct\""]
    );
    assert_eq!(
        of_lamp("sine.segments = [6]\n"),
        ["2:17 sine.segments | `sine.segments` has no effect with sine.scheme = \"direct\" \
          | remove it, or set sine.scheme = \"segmented\""]
    );
    // The device's own check, shown at the key that it names.
    let condition = "sine.address | the table has more address bits than the cosine \
                     | lower sine.address or raise cosine.fraction";
    assert_eq!(of_lamp("cosine.fraction = 8\nsine.address = 9\n"), [format!("3:16 {condition}")]);
}

#[test]
fn a_wrong_value_raises_no_message_about_others() {
    let fraction = "`cosine.fraction` must be an integer, not the string \"29\" \
                    | give an integer from 4 to 30 (default 20)";
    // 16 address bits fit 29 fraction bits: that the stand-in for "29" might be less is no matter.
    assert_eq!(
        of_lamp("sine.address = 16\ncosine.fraction = \"29\"\n"),
        [format!("3:19 cosine.fraction | {fraction}")]
    );
    // A wrong scheme says nothing of the keys that depend on it.
    assert_eq!(
        of_lamp("sine.scheme = \"directt\"\nsine.segments = [6]\n"),
        ["2:15 sine.scheme | `sine.scheme` cannot be \"directt\" \
          | did you mean \"direct\"? give \"direct\" or \"segmented\" (default \"direct\")"]
    );
    // A condition that fails whatever the wrong value should have been is reported all the same.
    assert_eq!(
        of_lamp("sine.address = 9\ncosine.fraction = 8\ncosine.signed = 1\n"),
        [
            "2:16 sine.address | the table has more address bits than the cosine \
             | lower sine.address or raise cosine.fraction",
            "4:17 cosine.signed | `cosine.signed` must be true or false, not the integer 1 \
             | give true or false (default false)",
        ]
    );
}

#[test]
fn module_names() {
    let cases = [
        ("", "the module name is empty", "glint_device"),
        ("../top", "the module name \"../top\" looks like a path", "top"),
        ("a\\\\b", "the module name \"a\\\\b\" looks like a path", "b"),
        ("..", "the module name \"..\" looks like a path", "glint_device"),
        ("8bit", "the module name \"8bit\" starts with a digit", "glint_8bit"),
        ("a-b", "the module name \"a-b\" has the character `-`", "a_b"),
        ("a b", "the module name \"a b\" has the character ` `", "a_b"),
        ("a$b", "the module name \"a$b\" has the character `$`", "a_b"),
        ("a\\nb", "the module name \"a\\nb\" has the character `\\n`", "a_b"),
        ("glühen", "the module name \"glühen\" has a character outside ASCII, `ü`", "gl_hen"),
        (
            "module",
            "the module name \"module\" is a keyword of Verilog or SystemVerilog",
            "glint_module",
        ),
        ("soft", "the module name \"soft\" is a keyword of Verilog or SystemVerilog", "glint_soft"),
    ];
    for (name, message, instead) in cases {
        assert_eq!(
            of_lamp(&format!("name = \"{name}\"\n")),
            [format!(
                "2:8 name | {message} | give a Verilog identifier of at most 60 letters, digits \
                 and _, as \"{instead}\""
            )]
        );
    }
    let long = "x".repeat(61);
    assert_eq!(
        of_lamp(&format!("name = \"{long}\"\n")),
        [format!(
            "2:8 name | the module name \"{}…\" has 61 characters | give a Verilog identifier of \
             at most 60 letters, digits and _, as \"{}\"",
            "x".repeat(40),
            "x".repeat(54)
        )]
    );
    assert_eq!(
        of_lamp("name = 3\n"),
        ["2:8 name | `name` must be a string, not the integer 3 \
          | give the name of the Verilog module in double quotes"]
    );
    assert_eq!(
        of_file("configs/3-lamps.toml", "device = \"lamp\"\n"),
        [
            "0:0 name | the module name \"3_lamps\" starts with a digit; it comes from the name of the file \
          | set `name`: give a Verilog identifier of at most 60 letters, digits and _, as \"glint_3_lamps\""
        ]
    );
}

#[test]
fn syntax_errors() {
    assert_eq!(
        of_lamp("power 8\n"),
        ["2:7  | not valid TOML: key with no value, expected `=` \
          | write `key = value` or `[table]`, one to a line"]
    );
    assert_eq!(
        of_lamp("arithmetic = exact\n"),
        ["2:14  | not valid TOML: `exact` is not a value | put a word in double quotes"]
    );
    assert_eq!(
        of_lamp("power = 8\npower = 4\n"),
        ["3:1  | `power` is given twice | keep one of the two; a table has one heading"]
    );
    assert_eq!(
        of_lamp("[cosine]\nfraction = 9\n[sine]\n[cosine]\nsigned = true\n"),
        ["5:2  | `cosine` is given twice | keep one of the two; a table has one heading"]
    );
    // One message for a broken heading, none for the keys below it.
    assert_eq!(
        of_lamp("[cosine\nfraction = 99\n[sine]\naddress = 99\n"),
        [
            "2:8  | not valid TOML: unclosed table, expected `]` \
             | write `key = value` or `[table]`, one to a line",
            "5:11 sine.address | `sine.address` = 99 is out of range \
             | give an integer from 1 to 16 (default 12)",
        ]
    );
}

#[test]
fn everything_at_once() {
    let text = "device = \"lamp\"\nname = \"begin\"\nstrict = \"yes\"\npower = 5\n\n[cosine]\n\
                fraction = = 3\nsined = true\n\n[sine]\naddress = 17\nscheme = direct\n";
    let places: Vec<String> = of_file("lamp.toml", text)
        .iter()
        .map(|line| line.split(" | ").next().unwrap_or("").to_owned())
        .collect();
    assert_eq!(
        places,
        [
            "2:8 name",
            "3:10 strict",
            "4:9 power",
            "7:12 ",
            "8:1 cosine.sined",
            "11:11 sine.address",
            "12:10 "
        ]
    );
}

#[test]
fn the_report_is_a_snippet_in_plain_text() {
    let text = "device = \"lamp\"\r\n\r\n[cosine]\r\nfraction = 0 # bits\r\nsigned = 1\r\n";
    let problems = parse("configs/lamp.toml", text, &schemas()).expect_err("two problems");
    let expected = "\
error: `cosine.fraction` = 0 is out of range
 --> configs/lamp.toml:4:12
  |
4 | fraction = 0 # bits
  |            ^
  |
  = help: give an integer from 4 to 30 (default 20)

error: `cosine.signed` must be true or false, not the integer 1
 --> configs/lamp.toml:5:10
  |
5 | signed = 1
  |          ^
  |
  = help: give true or false (default false)";
    assert_eq!(problems.to_string(), expected);
    assert_eq!(
        problems.to_json().to_string(),
        "[{\"file\":\"configs/lamp.toml\",\"line\":4,\"column\":12,\"key\":\"cosine.fraction\",\
         \"message\":\"`cosine.fraction` = 0 is out of range\",\
         \"remedy\":\"give an integer from 4 to 30 (default 20)\"},\
         {\"file\":\"configs/lamp.toml\",\"line\":5,\"column\":10,\"key\":\"cosine.signed\",\
         \"message\":\"`cosine.signed` must be true or false, not the integer 1\",\
         \"remedy\":\"give true or false (default false)\"}]"
    );
    let problems = parse("a.toml", "# nothing\n", &schemas()).expect_err("no device");
    assert_eq!(
        problems.to_string(),
        "error: the file does not say which device it configures\n--> a.toml\n \
         = help: add `device = \"…\"`; devices: lamp, mirror"
    );
}

#[test]
fn empty_files_and_other_line_ends() {
    let empty = "0:0  | the file is empty | `glint new DEVICE` writes a file to start from; \
                 devices: lamp, mirror";
    for text in ["", "\n\n", "\u{feff}", " \r\n"] {
        assert_eq!(of_file("lamp.toml", text), [empty]);
    }
    // A byte order mark is no part of the first line's columns.
    assert_eq!(
        of_file("lamp.toml", "\u{feff}device = \"lamp\"\r\npower = 3\r\n"),
        ["2:9 power | `power` cannot be 3 | give 2, 4, 8 or 16 (default 16)"]
    );
    assert_eq!(
        of_file("lamp.toml", "\u{feff}device = 1\r\n"),
        ["1:10 device | `device` must be a string, not the integer 1 | devices: lamp, mirror"]
    );
    // Columns count characters, not bytes.
    assert_eq!(
        of_lamp("cosine = { \"größe\" = 1, fraction = 1 }\n").last().map(|line| &line[..4]),
        Some("2:36")
    );
}

#[test]
fn nesting_has_an_end() {
    let deep = |open: &str, n: usize| format!("power = {}", open.repeat(n));
    for text in [deep("[", 100_000), deep("{a=", 50_000), format!("{} = 1", ["a"; 5000].join("."))]
    {
        let found = of_lamp(&text);
        assert!(found.iter().any(|line| line.contains("nested too deeply")), "{found:?}");
    }
}

#[test]
fn values_from_a_program_obey_the_same_rules() {
    let value = |name: &str, value: Value| (name.to_owned(), value);
    let problems = Config::from_values(
        &lamp(),
        "wire",
        vec![
            value("cosine.fraction", Value::Integer(31)),
            value("sine.segments", Value::Integers(vec![6])),
            value("cosine.colour", Value::Flag(true)),
            value("arithmetic", Value::Integer(1)),
        ],
    )
    .expect_err("five problems");
    assert_eq!(
        lines(&problems),
        [
            "0:0 name | the module name \"wire\" is a keyword of Verilog or SystemVerilog | give a \
             Verilog identifier of at most 60 letters, digits and _, as \"glint_wire\"",
            "0:0 cosine.fraction | `cosine.fraction` = 31 is out of range \
             | give an integer from 4 to 30 (default 20)",
            "0:0 cosine.colour | device `lamp` has no key \"cosine.colour\" | keys outside tables: \
             device, name, strict, arithmetic, power, architecture; tables: [cosine], [sine], [domain], \
             [pipeline], [output], [operands], [interface], [package]",
            "0:0 arithmetic | `arithmetic` must be a string, not the integer 1 \
             | give \"exact\" or \"patent\" (default \"exact\")",
            "0:0 sine.segments | `sine.segments` has no effect with sine.scheme = \"direct\" \
             | remove it, or set sine.scheme = \"segmented\"",
        ]
    );
}

#[test]
fn files_that_cannot_be_read() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = |name: &str| directory.path().join(name);
    let of = |path: &Path| match read(path, &schemas()) {
        Ok(config) => vec![format!("accepted: {config:?}")],
        Err(problems) => lines(&problems),
    };
    assert_eq!(
        of(&path("lamp.toml")),
        ["0:0  | there is no such file | `glint new DEVICE` writes a file to start from"]
    );
    fs::write(path("lamp-8.toml"), "device = \"lamp\"\n").expect("written");
    assert_eq!(
        of(&path("lamp_9.toml")),
        [format!(
            "0:0  | there is no such file | did you mean `{}`?",
            path("lamp-8.toml").display()
        )]
    );
    assert_eq!(of(directory.path()), ["0:0  | this is a directory | give the path of a TOML file"]);
    fs::write(path("latin.toml"), b"device = \"lamp\"\n# gr\xfcn\n").expect("written");
    assert_eq!(
        of(&path("latin.toml")),
        ["2:5  | the file is not UTF-8: byte 20 is 0xfc | save it as UTF-8 text"]
    );
    fs::write(path("wide.toml"), b"\xff\xfed\0e\0").expect("written");
    assert_eq!(
        of(&path("wide.toml")),
        ["1:1  | the file is not UTF-8: byte 0 is 0xff | it looks like UTF-16; save it as UTF-8"]
    );
    fs::write(path("large.toml"), "#".repeat(65_537)).expect("written");
    assert_eq!(
        of(&path("large.toml")),
        ["0:0  | the file has more than 65536 bytes | give the path of a TOML file"]
    );
    let config = read(&path("lamp-8.toml"), &schemas()).expect("a good file");
    assert_eq!((config.name.as_str(), config.device.as_str()), ("lamp_8", "lamp"));
}

#[test]
#[should_panic(expected = "device `lamp` has no key `cosine.fracton`")]
fn a_misspelt_key_in_a_program_is_named() {
    Config::defaults(&lamp(), "lamp").integer("cosine.fracton");
}
