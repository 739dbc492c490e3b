//! Tests that Glint writes a model in C for every configuration in `configs/`, `configs/studies/` and `configs/reduced/`,
//! pipelines included. `tests/tools` compiles and runs some of the models.

use rayon::prelude::*;
use serde_json::Value;

use crate::common::cores::{Emitted, configuration_with};
use crate::common::files::paths;

#[test]
fn every_core_becomes_a_model_in_c() {
    let directories = ["configs", "configs/studies", "configs/reduced"];
    let paths = directories.map(|directory| paths(directory, ".toml")).concat();
    assert!(paths.len() >= 38, "{paths:?}");
    paths.into_par_iter().for_each(|path| {
        let core = configuration_with(&path, "\n[package]\nsoftware = true\n");
        let (name, files) = (&core.config().name, Emitted::new(&core, 1, 1).files);
        let text = |path: &str| {
            let file = files.iter().find(|file| file.path == path);
            file.unwrap_or_else(|| panic!("{path}")).contents.as_str()
        };
        text(&format!("software/{name}/{name}_model.c"));
        let header = text(&format!("software/{name}/{name}_model.h"));
        let manifest = text(&format!("rtl_out/{name}/{name}.json"));
        let manifest: Value = serde_json::from_str(manifest).expect("JSON");
        let listed = manifest["files"]["software"].to_string();
        let listed = |file: &str| listed.contains(&format!("{name}_{file}"));
        assert!(["model.h", "model.c", "model.py"].into_iter().all(listed), "{name}");
        // With what a host computes before a line.
        let walks = core.contract.length().is_some();
        assert!(["setup.h", "setup.c", "setup.py"].map(listed) == [walks; 3], "{name}");
        let stated = header.lines().find_map(|line| line.split_once("_LATENCY "));
        let latency = &manifest["pipeline"]["latency"];
        assert_eq!(
            stated.map(|(_, clocks)| clocks.to_owned()),
            latency.as_u64().map(|clocks| clocks.to_string()),
            "{name}"
        );
    });
}
