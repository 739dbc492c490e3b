//! The model in C is written for every core with a microprogram; `tests/tools` compiles and runs some.

use std::fs;

use rayon::prelude::*;

use crate::common::cores::{Emitted, configuration_with};

#[test]
fn every_microprogram_becomes_a_model_in_c() {
    let mut paths = Vec::new();
    for directory in ["configs", "configs/studies", "configs/reduced"] {
        for entry in fs::read_dir(directory).expect("a directory") {
            let path = entry.expect("an entry").path();
            let text = fs::read_to_string(&path).unwrap_or_default();
            if path.extension().is_some_and(|it| it == "toml") && !text.contains("\"pipelined\"") {
                paths.push(path.display().to_string());
            }
        }
    }
    assert!(paths.len() >= 30, "{paths:?}");
    paths.into_par_iter().for_each(|path| {
        let core = configuration_with(&path, "\n[package]\nsoftware = true\n");
        let model = format!("software/{0}/{0}_model.c", core.config.name);
        let files = Emitted::new(&core, 1, 1).files;
        assert!(files.iter().any(|file| file.path.ends_with(&model)), "{path}: {model}");
    });
}
