//! The commands of docs/composing.md run, with the configuration that stands before them.

use std::fs;

use super::workspace::Workspace;

/// The text between a line and the end of its block.
fn block<'t>(text: &'t str, language: &str) -> &'t str {
    let (_, rest) = text.split_once(&format!("```{language}\n")).expect("a block");
    rest.split_once("```").expect("its end").0
}

#[test]
fn commands_on_composing_run() {
    let text = fs::read_to_string("docs/composing.md").expect("the page");
    let dir = Workspace::with("shade.toml", block(&text, "toml"));
    let commands = block(&text, "sh").lines();
    let commands: Vec<(&str, i32)> = commands
        .map(|line| {
            let (command, remark) = line.split_once('#').unwrap_or((line, ""));
            (command.trim(), i32::from(remark.contains("exit code 1")))
        })
        .collect();
    assert!(commands.len() > 3, "{commands:?}");
    for (command, code) in commands {
        let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
        let run = dir.glint(&arguments);
        assert_eq!(run.code, code, "{command}\n{}{}", run.out, run.err);
    }
}
