//! Tests that the list of Verilog modules of an emitted file names exactly the modules that the text of the file defines.

use std::collections::BTreeSet;

use regex::Regex;

use crate::common::cores::{Emitted, all_configurations, configuration_between};
use glint::core::Core;

/// Keys that put a core between streams, or behind registers on a bus.
const WRAPPERS: [(&str, &str); 4] = [
    ("quad_cosine", "stream = true\n"),
    ("lyon", "stream = true\nregisters = \"axi-lite\"\n"),
    ("rough", "registers = \"wishbone\"\n"),
    ("cosine_power_pipelined", "stream = true\n"),
];

#[test]
fn files_define_the_modules_that_emission_names() {
    let mut stubs = 0;
    for (path, core) in all_configurations() {
        stubs += stubs_of(&path, &core);
    }
    for (name, keys) in WRAPPERS {
        let path = format!("configs/{name}.toml");
        stubs += stubs_of(&path, &configuration_between(&path, keys));
    }
    assert!(stubs >= 8, "{stubs} modules beside the main one");
}

/// Checks every file of a core, and returns the number of modules beside the main module of their file.
fn stubs_of(path: &str, core: &Core) -> usize {
    let definition = Regex::new(r"(?m)^module (\w+)").expect("a pattern");
    let mut stubs = 0;
    for file in &Emitted::new(core, 1, 1).files {
        let mut defined = BTreeSet::new();
        for found in definition.captures_iter(&file.contents) {
            defined.insert(found[1].to_owned());
        }
        let named: BTreeSet<String> = file.modules.iter().cloned().collect();
        assert_eq!(named, defined, "{path}: {}", file.path);
        stubs += named.len().saturating_sub(1);
    }
    stubs
}
