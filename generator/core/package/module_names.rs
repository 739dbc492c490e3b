//! Checks the module names in emitted Verilog: a module's name must not be used for anything else, and no two configurations
//! may define the same module.
//!
//! Verilog allows a module to have the name of something inside it, but some tools fail. For example, elaboration fails if a
//! bench reads a signal of the instance `control` of a module `control`.

use std::collections::BTreeMap;

use anyhow::{Result, bail};

use super::file_kind::FileKind;
use super::output_file::OutputFile;

/// Checks the files of one configuration.
///
/// # Errors
/// Fails if the name of a module is also used for something else. The error names the module, the file and the line.
pub fn check(files: &[OutputFile]) -> Result<()> {
    let mut modules: Vec<&str> = Vec::new();
    for file in files {
        modules.extend(file.modules.iter().map(String::as_str));
    }
    for file in files {
        if !is_checked(file.kind) {
            continue;
        }
        let tokens = tokens(&file.contents);
        for (at, token) in tokens.iter().enumerate() {
            if modules.contains(&token.text) && !names_module(&tokens, at) {
                bail!(
                    "a module cannot be named `{name}`, because the emitted Verilog has something else with \
                     this name (`{}`, line {}); set another `name` in the configuration, for example \
                     \"{name}_core\"",
                    file.path,
                    token.line,
                    name = token.text,
                );
            }
        }
    }
    Ok(())
}

/// Makes sure that no two configurations define a module of the same name. Each of `configurations` has a name for messages.
///
/// # Errors
/// Fails if two configurations define the same module. The error names the module and both configurations.
pub fn check_together<'a>(
    configurations: impl IntoIterator<Item = (&'a str, &'a [OutputFile])>,
) -> Result<()> {
    let mut found: BTreeMap<&str, &str> = BTreeMap::new();
    for (path, files) in configurations {
        for file in files {
            for module in &file.modules {
                let other = *found.entry(module).or_insert(path);
                if other != path {
                    bail!(
                        "`{other}` and `{path}` both generate a module `{module}`; set another `name` in one \
                         of the two files"
                    );
                }
            }
        }
    }
    Ok(())
}

/// Returns whether a file is Verilog or SystemVerilog, in which the name of a module can have another meaning.
fn is_checked(kind: FileKind) -> bool {
    let is_system_verilog = matches!(
        kind,
        FileKind::SystemVerilogPackage | FileKind::WrapperProof | FileKind::CoreProof
    );
    is_system_verilog || kind.is_verilog()
}

/// Returns whether token `at`, which is the name of a module, defines or instantiates the module.
fn names_module(tokens: &[Token<'_>], at: usize) -> bool {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    let is_defined = at > 0 && text(at - 1) == "module";
    let is_instance = is_identifier(text(at + 1)) && text(at + 2) == "(";
    is_defined || text(at + 1) == "#" || is_instance
}

struct Token<'a> {
    text: &'a str,
    line: usize,
}

fn is_identifier(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
}

/// Splits Verilog into identifiers and other characters, without comments, strings, directives and system tasks.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '$';
            let length = match first {
                '/' if rest.starts_with("//") => rest.len(),
                '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
                // A number, a directive or a system task belongs together with the word after it.
                '\'' | '`' | '$' => 1 + rest[1..].find(|c| !word(c)).unwrap_or(rest.len() - 1),
                _ if word(first) => rest.find(|c| !word(c)).unwrap_or(rest.len()),
                _ => first.len_utf8(),
            };
            let (token, after) = rest.split_at(length);
            rest = after;
            let skipped =
                token.starts_with("//") || token.starts_with(['"', '\'', '`', '$', ' ', '\t']);
            if !skipped {
                found.push(Token { text: token, line });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(kind: FileKind, module: &str, contents: &str) -> OutputFile {
        let path = format!("{module}.v");
        OutputFile { modules: vec![module.to_owned()], ..OutputFile::new(kind, path, contents) }
    }

    #[test]
    fn a_name_inside_is_found_and_a_mention_is_not() {
        let core = "// core\nmodule core (\n    input wire start\n);\n    core_control control (.start(start));\nendmodule\n";
        let bench = "`timescale 1ns / 1ps\nmodule core_tb;\n    core dut (.start(1'b0));\n    initial $display(\"core\");\nendmodule\n";
        let files = |name: &str| {
            let renamed = |text: &str| {
                text.replace("core_control", &format!("{name}_control"))
                    .replace("module core", &format!("module {name}"))
                    .replace("    core dut", &format!("    {name} dut"))
            };
            [
                OutputFile {
                    path: "core.v".to_owned(),
                    ..file(FileKind::CoreVerilog, name, &renamed(core))
                },
                OutputFile {
                    path: "core_tb.v".to_owned(),
                    ..file(FileKind::Bench, &format!("{name}_tb"), &renamed(bench))
                },
            ]
        };
        check(&files("core")).unwrap();
        for (name, place) in [
            ("start", "`core.v`, line 3"),
            ("control", "`core.v`, line 5"),
            ("dut", "`core_tb.v`, line 3"),
        ] {
            let refused = check(&files(name)).unwrap_err().to_string();
            assert!(refused.contains(&format!("`{name}`")) && refused.contains(place), "{refused}");
        }
    }

    #[test]
    fn two_configurations_with_one_module() {
        let one = [
            file(FileKind::CoreVerilog, "core", "module core;\nendmodule\n"),
            file(FileKind::Bench, "core_tb", "module core_tb;\nendmodule\n"),
        ];
        let two = [file(FileKind::Bench, "core_tb", "module core_tb;\nendmodule\n")];
        check_together([("a.toml", &one[..])]).unwrap();
        let refused = check_together([("a.toml", &one[..]), ("b.toml", &two[..])]).unwrap_err();
        assert!(
            refused.to_string().contains("`a.toml` and `b.toml` both generate a module `core_tb`")
        );
    }
}
