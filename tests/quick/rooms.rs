//! Tests the structure of the source: which folder may import which, that files of a folder do not import each other in a
//! circle, and that device names occur only in certain folders.
//!
//! It also tests that some crates start no thread, no process and no signal handler.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::common::files::{below, read};
use glint::registry::Registry;
use regex::Regex;

/// The rooms of each crate that has several, from the bottom: a room imports from those before it. What a crate can see of others
/// is in its `Cargo.toml`.
const ROOMS: [(&str, &[&str]); 4] = [
    ("hdl", &["netlist", "area", "retime", "dsl", "blocks", "sim", "pipeline", "verilog"]),
    ("core", &["observation", "package", "cosim", "registry", "core"]),
    ("show", &["figures", "evidence", "render", "pages"]),
    ("prove", &["batch", "synth", "equality", "certify", "mutate", "tune", "verify"]),
];

/// The crates without a thread of their own, a process or a signal.
const EVERYWHERE: [&str; 11] = [
    "base",
    "formula",
    "config",
    "approximate",
    "plan",
    "keys",
    "golden",
    "hdl",
    "catalogue",
    "core",
    "show",
];

/// Where devices may be known by name. Formulas can call highlights by these names.
const NAMING: [&str; 5] =
    ["keys/", "catalogue/", "golden/", "core/registry.rs", "formula/highlights.rs"];

#[test]
fn rooms_of_a_crate_import_only_what_stands_below_them() {
    let mut wrong = BTreeSet::new();
    let mut seen = 0;
    for (file, code) in sources() {
        let (folder, inside) = file.split_once('/').unwrap_or((&file, ""));
        let Some((_, rooms)) = ROOMS.iter().find(|(name, _)| *name == folder) else { continue };
        let room = inside.split('/').next().unwrap_or("").trim_end_matches(".rs");
        let at = rooms.iter().position(|it| *it == room);
        let at = at.unwrap_or_else(|| panic!("{file}: a room of its own"));
        for path in imports(&code, "crate::") {
            let used = path.split("::").next().unwrap_or("");
            seen += 1;
            if rooms[at + 1..].contains(&used) {
                wrong.insert(format!("{file}: crate::{path}"));
            }
        }
    }
    assert!(wrong.is_empty() && seen > 100, "{seen} imports: {wrong:#?}");
}

#[test]
fn what_is_shown_starts_no_thread_and_no_process() {
    let system = Regex::new(
        r"std::(thread|process::\w*Command|os)\b|process::Command|signal_hook|rustix|glint_tools",
    )
    .unwrap();
    let mut seen = BTreeSet::new();
    for (file, code) in sources() {
        let folder = file.split('/').next().unwrap_or("");
        if let Some(known) = EVERYWHERE.iter().find(|name| **name == folder) {
            seen.insert(known);
            assert_eq!(system.find(&code).map(|found| found.as_str()), None, "{file}");
        }
    }
    assert_eq!(seen.len(), EVERYWHERE.len(), "{seen:?}");
}

#[test]
fn files_of_a_folder_import_each_other_in_one_direction() {
    let files: BTreeMap<String, String> = sources().into_iter().collect();
    let module = |file: &str| file.trim_end_matches(".rs").replace('/', "::");
    let modules: BTreeSet<String> = files.keys().map(|file| module(file)).collect();
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (file, code) in &files {
        let own = module(file);
        let parent = own.rsplit_once("::").map_or("", |(parent, _)| parent);
        // A file beside this one, by `super` or by the whole path in its crate.
        let (_, inside) = parent.split_once("::").unwrap_or((parent, ""));
        let whole = ["crate", inside].join("::");
        let beside = ["super::".to_owned(), format!("{}::", whole.trim_end_matches("::"))];
        let named = beside.iter().flat_map(|root| imports(code, root));
        let named = named.map(|path| format!("{parent}::{}", path.split("::").next().unwrap()));
        let siblings = named.filter(|name| *name != own && modules.contains(name));
        uses.insert(own.clone(), siblings.collect());
    }
    // What imports nothing that is left is taken away, until only circles remain.
    while let Some(free) = uses.iter().find(|(_, uses)| uses.is_empty()).map(|(it, _)| it.clone()) {
        uses.remove(&free);
        uses.values_mut().for_each(|uses| {
            uses.remove(&free);
        });
    }
    assert!(uses.is_empty(), "{uses:#?}");
}

#[test]
fn devices_are_known_by_name_where_they_are_described_predicted_and_weighed() {
    let registry = Registry::catalogue();
    // The function of a user is a word of every text.
    let names = registry.devices().iter().map(|device| device.name).filter(|it| *it != "function");
    let names: Vec<String> = names.flat_map(|it| [it.to_owned(), it.replace('-', "_")]).collect();
    let named = Regex::new(&format!(r"(^|[^\w-])({})($|[^\w-])", names.join("|"))).unwrap();
    // The examples in the help of a command.
    let examples = Regex::new(r#"(?s)#\[command\(after_help = .*?\)\]\npub struct"#).unwrap();
    for (file, code) in sources() {
        if NAMING.iter().any(|place| file.starts_with(place)) {
            continue;
        }
        // cosⁿγ is Blinn's function, whichever device computes it.
        let code = examples.replace_all(&code, "").replace("formulas::blinn", "");
        let found = named.find(&code).map(|found| found.range());
        assert_eq!(found, None, "{file} names a device");
    }
}

/// Returns every file of the library by its path in `generator/`, without comments and tests.
fn sources() -> Vec<(String, String)> {
    let root = Path::new("generator");
    let files = below(root).into_iter();
    let files = files.filter(|path| path.extension().is_some_and(|it| it == "rs"));
    let comment = Regex::new(r"(?m)^\s*//.*$|\s// .*$").unwrap();
    let files = files.map(|path| {
        let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = read(&path);
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
        (name, comment.replace_all(code, "").into_owned())
    });
    let apart = |name: &str| {
        ["lib.rs", "main.rs", "build.rs"].iter().any(|it| name.ends_with(it))
            || name.contains("tests")
    };
    let mut files: Vec<_> = files.filter(|(name, _)| !apart(name)).collect();
    files.sort();
    files
}

/// Returns the paths behind `root`, with each name of a group in braces apart.
fn imports(code: &str, root: &str) -> Vec<String> {
    let path = format!(r"\b{root}((?:\w+::)*)(?:(\w+)|\{{([^}}]*)\}})");
    let path = Regex::new(&path).unwrap();
    path.captures_iter(code)
        .flat_map(|found| {
            let names = found.get(2).or(found.get(3)).map_or("", |names| names.as_str());
            let names = names.split(',').map(|name| name.trim().split("::").next().unwrap_or(""));
            let start = found[1].to_owned();
            names.map(move |name| format!("{start}{name}")).collect::<Vec<_>>()
        })
        .collect()
}
