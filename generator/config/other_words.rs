//! Finds the setting that a user means by a word that Glint does not use for it. For example, `interface.axi_lite = true` means
//! `interface.registers = "axi-lite"`, and `target = "artix7"` means `"xilinx7"`.

use super::schema::{Key, KeyKind};

/// A key that a user may mean, and its value as TOML. The value is empty if any value can be meant.
#[derive(Clone, Copy)]
pub(super) struct MeantSetting {
    pub(super) key: &'static str,
    value: &'static str,
}

const AXI_LITE: MeantSetting = MeantSetting::to("interface.registers", "\"axi-lite\"");
const WISHBONE: MeantSetting = MeantSetting::to("interface.registers", "\"wishbone\"");
const CFU: MeantSetting = MeantSetting::to("interface.processor", "\"cfu\"");
const PCPI: MeantSetting = MeantSetting::to("interface.processor", "\"pcpi\"");
const STREAM: MeantSetting = MeantSetting::to("interface.stream", "true");

/// Alternative words, in [`folded`] form, for the keys that every device has.
const SETTINGS: [(&[&str], &[MeantSetting]); 24] = [
    (&["axilite", "axi4lite", "axil"], &[AXI_LITE]),
    (&["wishbone", "wb"], &[WISHBONE]),
    (&["axistream", "axi4stream", "axis", "axi4s", "streaming"], &[STREAM]),
    (&["axi", "axi4"], &[AXI_LITE, STREAM]),
    (&["bus", "apb", "ahb", "avalon", "csr"], &[AXI_LITE, WISHBONE]),
    (&["cfu", "vexriscv"], &[CFU]),
    (&["pcpi", "picorv32"], &[PCPI]),
    (&["instruction", "instructions", "custom", "coprocessor", "cpu"], &[CFU, PCPI]),
    (&["tuser"], &[MeantSetting::of("interface.user_bits")]),
    (&["tkeep"], &[MeantSetting::to("interface.keep", "true")]),
    (&["pipelined", "pipeline"], &[MeantSetting::to("architecture", "\"pipelined\"")]),
    (&["sequential"], &[MeantSetting::to("architecture", "\"sequential\"")]),
    (
        &["clock", "clk", "clkmhz", "mhz", "fmax", "freq", "freqmhz", "frequency", "frequencymhz"],
        &[MeantSetting::of("pipeline.clock_mhz")],
    ),
    (&["latency", "depth"], &[MeantSetting::of("pipeline.stages")]),
    (&["ii", "initiationinterval"], &[MeantSetting::of("pipeline.interval")]),
    (&["throughput", "samplerate"], &[MeantSetting::of("pipeline.rate")]),
    (&["dsp", "dsps", "maxdsp", "maxdsps"], &[MeantSetting::of("pipeline.max_multipliers")]),
    (&["fpga", "family", "part", "chip"], &[MeantSetting::of("pipeline.target")]),
    (&["ready", "backpressure"], &[MeantSetting::to("pipeline.stall", "\"ready\"")]),
    (&["module", "modulename", "top", "entity"], &[MeantSetting::of("name")]),
    (&["cmodel", "driver", "header"], &[MeantSetting::to("package.software", "true")]),
    (&["sdc", "xdc"], &[MeantSetting::to("package.constraints", "true")]),
    (&["sv"], &[MeantSetting::to("package.systemverilog", "true")]),
    (&["bram", "lutram"], &[MeantSetting::of("package.rom_style")]),
];

/// Alternative words for the last part of a key in the same table, or for a field of an entry.
const LAST_PARTS: [(&[&str], &str); 8] = [
    (&["width", "size"], "bits"),
    (&["min", "low", "lower"], "from"),
    (&["max", "high", "upper"], "to"),
    (&["expr", "expression", "equation"], "formula"),
    (&["tolerance", "maxerror", "ulp", "ulps"], "error"),
    (&["relativeerror", "relerror"], "error_relative"),
    (&["condition", "when", "domain"], "where"),
    (&["inclusive"], "to_included"),
];

/// Alternative words for a key's choices. The first entry is the last part of the key's name.
const CHOICES: [(&str, &[&str], &str); 20] = [
    ("architecture", &["serial", "iterative", "multicycle", "microprogrammed"], "sequential"),
    ("architecture", &["unrolled"], "pipelined"),
    ("target", &["lfe5u", "lfe5um", "lfe5u25f", "lfe5u45f", "lfe5u85f"], "ecp5"),
    ("target", &["up5k", "ice40up5k", "ultraplus"], "ice40"),
    ("target", &["hx1k", "hx4k", "hx8k", "lp1k", "lp8k", "ice40hx8k"], "ice40-hx"),
    (
        "target",
        &[
            "xilinx", "7series", "series7", "xc7", "artix7", "kintex7", "spartan7", "virtex7",
            "zynq", "zynq7000",
        ],
        "xilinx7",
    ),
    ("target", &["gw2a", "gw2ar", "gw2ar18", "tangnano20k"], "gowin"),
    ("target", &["gw1n", "gw1nr", "gw1nr9", "tangnano9k"], "gowin-gw1n"),
    ("target", &["lifcl", "lifcl40", "crosslinknx", "certusnx"], "nexus"),
    ("target", &["ccgm1a1"], "gatemate"),
    ("rounding", &["floor", "down"], "truncate"),
    ("rounding", &["round", "rounded", "halfup"], "nearest"),
    ("overflow", &["clip", "clamp"], "saturate"),
    ("overflow", &["modulo", "truncate"], "wrap"),
    ("overflow", &["error"], "refuse"),
    ("outside", &["saturate", "clip"], "clamp"),
    ("delays", &["ff", "flipflops"], "registers"),
    ("delays", &["srl", "lutram"], "memory"),
    ("rom_style", &["bram"], "block"),
    ("rom_style", &["lut", "luts", "lutram"], "distributed"),
];

impl MeantSetting {
    const fn of(key: &'static str) -> Self {
        Self { key, value: "" }
    }

    const fn to(key: &'static str, value: &'static str) -> Self {
        Self { key, value }
    }

    /// Returns the setting in backticks, such as `` `interface.stream = true` ``.
    pub(super) fn words(self) -> String {
        match self.value {
            "" => format!("`{}`", self.key),
            value => format!("`{} = {value}`", self.key),
        }
    }
}

/// Removes case, `-` and `_`.
fn folded(word: &str) -> String {
    word.to_lowercase().replace(['-', '_'], "")
}

/// Returns the settings that a user may mean by `name`, the name of a key without its table.
pub(super) fn settings(name: &str) -> &'static [MeantSetting] {
    let name = folded(name);
    let found = SETTINGS.iter().find(|(words, _)| words.contains(&name.as_str()));
    found.map_or(&[], |(_, meant)| *meant)
}

/// Returns the name among `names` that a user means by `word`, the last part of a key, or a field.
pub(super) fn last_part<'a>(
    word: &str,
    mut names: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    let word = folded(word);
    let (_, meant) = LAST_PARTS.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    names.find(|name| name == meant)
}

/// Returns the choice of `key` that a user means by `word`, as TOML, or the setting of another key in the same table. For
/// example, `interface.registers = "axis"` means `` `interface.stream = true` ``.
pub(super) fn choice(key: &Key, word: &str) -> Option<String> {
    let KeyKind::Choice(options) = key.kind else { return None };
    let (table, leaf) = key.name.rsplit_once('.').unwrap_or(("", key.name));
    let word = folded(word);
    let found = CHOICES.iter().find(|(of, words, option)| {
        *of == leaf && words.contains(&word.as_str()) && options.contains(option)
    });
    if let Some((_, _, option)) = found {
        return Some(format!("\"{option}\""));
    }
    // A word with several meanings, such as `apb` for any bus, means no choice in particular.
    let meant = settings(&word).iter();
    let own: Vec<&MeantSetting> = meant.clone().filter(|setting| setting.key == key.name).collect();
    match own[..] {
        [one] if !one.value.is_empty() => Some(one.value.to_owned()),
        [] if !table.is_empty() => meant
            .filter(|setting| setting.key.rsplit_once('.').is_some_and(|(of, _)| of == table))
            .map(|setting| setting.words())
            .next(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::shared::shared_keys;
    use super::*;

    #[test]
    fn words_mean_keys_and_values_that_exist() {
        for (words, meant) in SETTINGS {
            for setting in meant {
                let key = shared_keys().iter().find(|key| key.name == setting.key);
                assert!(key.is_some() || setting.key == "name", "{words:?}");
                let accepted = match key.map(|key| &key.kind) {
                    Some(KeyKind::Flag) => setting.value == "true",
                    Some(KeyKind::Choice(options)) => {
                        let value = setting.value.trim_matches('"');
                        value.is_empty() || options.contains(&value)
                    }
                    _ => setting.value.is_empty(),
                };
                assert!(accepted, "{words:?}");
            }
        }
        for (leaf, words, option) in CHOICES {
            // Keys of devices, and fields of entries, are in other crates.
            for key in shared_keys() {
                let KeyKind::Choice(options) = key.kind else { continue };
                if key.name.ends_with(leaf) && !["rounding", "overflow", "outside"].contains(&leaf)
                {
                    assert!(options.contains(&option), "{words:?}");
                }
            }
        }
    }

    #[test]
    fn words_are_folded_and_listed_once() {
        let mut all = std::collections::BTreeSet::new();
        for (words, _) in SETTINGS {
            for word in words {
                assert_eq!(folded(word), *word);
                assert!(all.insert(*word), "`{word}` has two lists");
            }
        }
    }
}
