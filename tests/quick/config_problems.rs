//! Tests the mistakes that a configuration file can contain: the message, the position and the remedy of each, word for word.
//!
//! Most cases are in `config_problems.txt`.

use std::path::Path;

use crate::common::files::put;
use crate::common::said::{Case, cases};
use crate::config_device::{lamp, schemas};
use glint::config::{Config, Problems, Value, parse, read};

/// `line:column key | message | remedy` for each problem.
fn lines(problems: &Problems) -> Vec<String> {
    let each = |problem: &glint::config::Problem| {
        let error = &problem.error;
        let (line, column) = problems.position(problem).unwrap_or((0, 0));
        format!("{line}:{column} {} | {} | {}", error.key, error.message, error.remedy)
    };
    problems.iter().map(each).collect()
}

fn of_file(name: &str, text: &str) -> Vec<String> {
    match parse(name, text, &schemas()) {
        Ok(config) => vec![format!("accepted: {config:?}")],
        Err(problems) => lines(&problems),
    }
}

/// Returns the problems of a file for `lamp` whose further lines are given; they start at line 2.
fn of_lamp(text: &str) -> Vec<String> {
    of_file("lamp.toml", &format!("device = \"lamp\"\n{text}"))
}

/// As `config_problems.txt` says.
#[test]
fn each_mistake_has_its_message_its_place_and_its_remedy() {
    let cases = cases(include_str!("config_problems.txt"));
    assert_eq!(cases.len(), 93);
    for Case { file, said, .. } in cases {
        let whole = file.starts_with("device");
        let mut found = if whole { of_file("a.toml", &file) } else { of_lamp(&file) };
        if found[0].starts_with("accepted: ") {
            found[0].truncate("accepted".len());
        }
        assert_eq!(found, said, "{file}");
    }
}

#[test]
fn what_is_not_said_in_the_file() {
    assert_eq!(
        of_file("a.toml", "strict = true\n"),
        ["0:0 device | the file does not name the device that it configures \
          | add `device = \"…\"`; devices: lamp, mirror"]
    );
    assert_eq!(
        of_file("configs/3-lamps.toml", "device = \"lamp\"\n"),
        [
            "0:0 name | the module name \"3_lamps\" starts with a digit; the module has the name of the file \
          | set `name`: give a Verilog identifier of at most 60 letters, digits and _, as \"glint_3_lamps\""
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
        "error: the file does not name the device that it configures\n--> a.toml\n \
         = help: add `device = \"…\"`; devices: lamp, mirror"
    );
}

#[test]
fn empty_files_and_other_line_ends() {
    let empty = "0:0  | the file is empty | write a configuration with `glint new DEVICE > FILE.toml`; \
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
            "0:0 cosine.colour | device `lamp` has no key \"cosine.colour\" | keys of [cosine]: fraction, \
             signed",
            "0:0 arithmetic | `arithmetic` must be a string, not the integer 1 \
             | give \"exact\" or \"patent\" (default \"exact\")",
            "0:0 sine.segments | `sine.segments` has no effect with sine.scheme = \"direct\" \
             | remove the key, or set sine.scheme = \"segmented\"",
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
    let new =
        "0:0  | there is no such file | write a configuration with `glint new DEVICE > FILE.toml`";
    assert_eq!(of(&path("lamp.toml")), [new]);
    put(path("lamp-8.toml"), "device = \"lamp\"\n");
    let near = path("lamp-8.toml").display().to_string();
    let near = format!("0:0  | there is no such file | did you mean `{near}`?");
    assert_eq!(of(&path("lamp_9.toml")), [near]);
    assert_eq!(
        of(directory.path()),
        ["0:0  | the path is a directory | give the path of a TOML file"]
    );
    for (name, contents, said) in [
        (
            "latin.toml",
            &b"device = \"lamp\"\n# gr\xfcn\n"[..],
            "2:5  | the file is not UTF-8: byte 20 is 0xfc | save the file as UTF-8 text",
        ),
        (
            "wide.toml",
            b"\xff\xfed\0e\0",
            "1:1  | the file is not UTF-8: byte 0 is 0xff | save the file as UTF-8; the file looks like UTF-16",
        ),
        (
            "large.toml",
            &[b'#'; 65_537],
            "0:0  | the file has more than 65536 bytes | give the path of a TOML file",
        ),
    ] {
        put(path(name), contents);
        assert_eq!(of(&path(name)), [said], "{name}");
    }
    let config = read(&path("lamp-8.toml"), &schemas()).expect("a good file");
    assert_eq!((config.name.as_str(), config.device.as_str()), ("lamp_8", "lamp"));
}

#[test]
#[should_panic(expected = "device `lamp` has no key `cosine.fracton`")]
fn a_misspelt_key_in_a_program_is_named() {
    Config::defaults(&lamp(), "lamp").integer("cosine.fracton");
}
