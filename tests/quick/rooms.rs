//! The rooms of the source: which may import which, no circles, and where devices are known by name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use glint::registry::Registry;
use regex::Regex;

/// The folders of `generator/` that are crates of their own. Cargo holds what they import.
const CRATES: [&str; 7] = ["base", "formula", "config", "approximate", "keys", "golden", "hdl"];

/// From the bottom: a room and those above it that it may import from.
const ROOMS: [(&str, &str); 30] = [
    ("base", ""),
    ("target", ""),
    ("config", "base target"),
    ("formula", ""),
    ("approximate", "base formula"),
    ("keys", "base config formula approximate"),
    ("golden", "base config keys formula approximate"),
    ("hdl/netlist", "base target"),
    ("hdl/dsl", "base hdl/netlist"),
    ("hdl/blocks", "base hdl/dsl"),
    ("hdl/sim", "base hdl/netlist"),
    ("hdl/pipeline", "base target hdl/netlist"),
    ("observation", "golden"),
    ("hdl/verilog", "base hdl/netlist"),
    ("devices", "base config keys approximate hdl/netlist hdl/dsl hdl/blocks"),
    ("package", "base config golden hdl/netlist hdl/pipeline hdl/verilog observation"),
    ("tools", "base target package"),
    ("equality", "base hdl/netlist tools"),
    ("synth", "base target hdl/netlist package tools"),
    ("cosim", "base golden hdl/netlist hdl/sim observation package tools"),
    ("registry", "base target config keys golden hdl/netlist hdl/dsl hdl/pipeline devices"),
    ("core", "base config golden hdl/netlist package tools cosim registry"),
    ("certify", "base formula golden hdl/netlist hdl/pipeline tools"),
    ("mutate", "base golden hdl/netlist hdl/sim package tools cosim core"),
    ("render", "base config golden cosim core"),
    ("evidence", "config target golden hdl/netlist tools cosim registry core"),
    ("tune", "config golden hdl/netlist hdl/pipeline cosim registry synth evidence target"),
    (
        "pages",
        "base target config golden hdl/netlist hdl/verilog package tools synth cosim core render evidence",
    ),
    ("verify", "base target golden package tools cosim core mutate certify equality"),
    (
        "cli",
        "base target config keys golden hdl/netlist package tools cosim registry core mutate render evidence pages verify synth tune certify",
    ),
];

/// Where devices may be known by name.
const NAMING: [&str; 5] = ["keys", "devices", "golden", "registry", "evidence"];

/// And with them: the examples of the command line's help, and what the report says of Schlick's function.
const ALSO_NAMING: [&str; 2] = ["cli/mod.rs", "pages/report.rs"];

#[test]
fn rooms_import_only_what_stands_below_them() {
    let allowed: BTreeMap<&str, Vec<&str>> =
        ROOMS.iter().map(|(room, uses)| (*room, uses.split_whitespace().collect())).collect();
    for (at, (room, uses)) in ROOMS.iter().enumerate() {
        let below: Vec<&str> = ROOMS[..at].iter().map(|(room, _)| *room).collect();
        let circle = uses.split_whitespace().find(|used| !below.contains(used));
        assert_eq!(circle, None, "`{room}` may use what stands above it");
    }
    let mut wrong = BTreeSet::new();
    for (file, code) in sources() {
        let room = room_of(&file.split('/').collect::<Vec<_>>());
        let may = allowed.get(room.as_str()).unwrap_or_else(|| panic!("{file}: a room of its own"));
        // The rooms of `hdl` are those of one crate.
        let own = match file.split_once('/') {
            Some(("hdl", _)) => "hdl::",
            Some((folder, _)) if CRATES.contains(&folder) => continue,
            _ => "",
        };
        for path in imports(&code, "crate::") {
            let path = format!("{own}{path}");
            let used = room_of(&path.split("::").collect::<Vec<_>>());
            if used != room && !may.contains(&used.as_str()) {
                wrong.insert(format!("{file}: crate::{path}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
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
        // A file beside this one, by `super` or by the whole path.
        let (folder, rest) = parent.split_once("::").unwrap_or((parent, ""));
        let inside = if CRATES.contains(&folder) { rest } else { parent };
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
    let examples = Regex::new(r#"(?s)#\[command\(after_help = ".*?"\)\]"#).unwrap();
    for (file, code) in sources() {
        let room = room_of(&file.split('/').collect::<Vec<_>>());
        if NAMING.contains(&room.as_str()) || ALSO_NAMING.contains(&file.as_str()) {
            continue;
        }
        // cosⁿγ is Blinn's function, whichever device computes it.
        let code = examples.replace_all(&code, "").replace("formulas::blinn", "");
        let found = named.find(&code).map(|found| found.range());
        assert_eq!(found, None, "{file} names a device");
    }
}

/// Every file of the library by its path in `generator/`, without comments and tests.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("generator");
    let mut files = Vec::new();
    let mut folders: Vec<PathBuf> = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == "rs") {
                files.push(path);
            }
        }
    }
    let comment = Regex::new(r"(?m)^\s*//.*$|\s// .*$").unwrap();
    let files = files.into_iter().map(|path| {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
        (name, comment.replace_all(code, "").into_owned())
    });
    let apart =
        |name: &str| name.ends_with("lib.rs") || name == "main.rs" || name.contains("tests");
    let mut files: Vec<_> = files.filter(|(name, _)| !apart(name)).collect();
    files.sort();
    files
}

/// The paths behind `root`, with each name of a group in braces apart.
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

/// The room of a file or a path: a folder or a file of `generator/` or `generator/hdl/`.
fn room_of(parts: &[&str]) -> String {
    let plain = |part: &str| part.trim_end_matches(".rs").to_owned();
    match parts {
        ["hdl", part, ..] => format!("hdl/{}", plain(part)),
        [part, ..] => plain(part),
        [] => String::new(),
    }
}
