//! Configurations written and read back, and random ones.

use std::collections::BTreeSet;

use crate::config_device::{lamp, schemas};
use glint::config::{Config, Key, Schema, Value, commented, parse, sample};

#[test]
fn the_commented_file() {
    let expected = "\
# Glint configuration of the device \"lamp\". All keys are shown with their defaults; those
# that you do not change may be deleted.

# The device that is generated.
device = \"lamp\"

# The name of the Verilog module and of its files: a Verilog identifier of at most 60
# characters. By default the name of this file, with _ for -.
name = \"my_lamp\"

# Refuse a configuration that misses the accuracy contract, rather than warn of it. True
# or false, default false.
strict = false

# How numbers are kept.
# \"exact\" or \"patent\", default \"exact\".
arithmetic = \"exact\"

# The power of the cosine.
# 2, 4, 8 or 16, default 16.
power = 16

# A microprogram on one set of arithmetic, or the same unrolled: a point every clock.
# \"sequential\" or \"pipelined\", default \"sequential\".
architecture = \"sequential\"

[cosine]
# Fraction bits of the cosines.
# An integer from 4 to 30, default 20.
fraction = 20

# Whether cosines may be negative.
# True or false, default false.
signed = false

[sine]
# How the sine is had.
# \"direct\" or \"segmented\", default \"direct\".
scheme = \"direct\"

# Address bits of the table.
# An integer from 1 to 16, default 12; only with sine.scheme = \"direct\".
address = 12

# Log2 of the segments.
# 1 to 8 integers from 2 to 14, default [6, 5]; only with sine.scheme = \"segmented\".
# segments = [6, 5]

[domain]
# Largest deviation in degrees.
# A number from 0.5 to 90.0, default 30.0.
deviation = 30.0

[pipeline]
# Whose delays and multipliers decide what a stage of the pipeline does.
# \"ecp5\", \"ice40\", \"xilinx7\" or \"generic\", default \"ecp5\"; only with architecture =
# \"pipelined\".
# target = \"ecp5\"

# The clock that every stage must reach; the schedule has the fewest registers for it.
# A number from 1.0 to 2000.0, default 130.0; only with architecture = \"pipelined\".
# clock_mhz = 130.0

# The number of stages, in place of a clock; as fast as they allow. 0: pipeline.clock_mhz
# decides.
# An integer from 0 to 1000, default 0; only with architecture = \"pipelined\".
# stages = 0

# Products as the synthesiser finds them, or in instances of <name>_multiplier, whose
# output register is that of the DSP block: faster, and every product takes a block.
# \"inferred\" or \"registered\", default \"inferred\"; only with pipeline.target = \"ecp5\".
# multipliers = \"inferred\"

# Whether out_ready can hold the results back; without it every register moves in every
# clock.
# \"ready\" or \"none\", default \"ready\"; only with architecture = \"pipelined\".
# stall = \"ready\"

# What holds values that no stage reads for some time: memory in look-up tables, where the
# target has such, or a register a stage.
# \"memory\" or \"registers\", default \"memory\"; only with architecture = \"pipelined\".
# delays = \"memory\"

# Bits of side_in and side_out, which travel with a point: a pixel's address, say.
# An integer from 0 to 64, default 0; only with architecture = \"pipelined\".
# side = 0

[output]
# Registers behind results that are logic: a multiplier and a rounding adder for a colour.
# They are valid a clock later.
# True or false, default false; only with architecture = \"sequential\".
registered = false

[operands]
# Buffers that take operands while a point is computed. The next one then begins in the
# clock after the last of this one.
# True or false, default false; only with architecture = \"sequential\".
buffered = false

[interface]
# Write an AXI4-Stream wrapper of the core, <name>_axis.v.
# True or false, default false.
stream = false

# Bits of tuser, the side channel that travels with a point.
# An integer from 1 to 1024, default 1; only with interface.stream = true.
# user_bits = 1

# Write registers around the core: <name>_axil.v on AXI4-Lite, <name>_wb.v on Wishbone.
# \"none\", \"axi-lite\" or \"wishbone\", default \"none\"; only with architecture = \"sequential\".
registers = \"none\"

[package]
# Write software/<name>/: a bit-accurate model of the core in C.
# True or false, default false.
software = false

# Whether ROM contents are .mem files, or stand in the Verilog, for flows that do not find
# files.
# \"files\" or \"inline\", default \"files\".
memories = \"files\"

# Where ROMs that are read on the clock are to be, as their attribute rom_style says:
# block memory, look-up tables, or as the synthesiser finds.
# \"auto\", \"block\" or \"distributed\", default \"auto\".
rom_style = \"auto\"

# Registers of the core are 0 before the first clock, but for those that ROMs are read
# into. Without it a simulation has unknown values until the first reset and the first
# writes; wrappers need their reset all the same.
# True or false, default false; only with architecture = \"sequential\".
initial_values = false

# Write software/<name>/<name>_litex.py: the core as a module of LiteX.
# True or false, default false; only with package.memories = \"inline\".
# litex = false

# Write the clock as constraints: <top>.sdc and <top>.xdc.
# True or false, default false.
constraints = false

# The frequency of the clock in constraints and vendors' projects. 0 for that of the
# pipeline, or 100 for a sequential core.
# 0, or a number from 1.0 to 2000.0, default 0.0; only with package.constraints = true.
# clock_mhz = 0.0

# Write Tcl for Vivado: <name>_vivado.tcl builds, <name>_vivado_ip.tcl packages IP.
# True or false, default false; only with package.constraints = true.
# vivado = false

# Write Tcl for Quartus: <name>_quartus.tcl builds, <top>_hw.tcl is for Platform Designer.
# True or false, default false; only with package.constraints = true.
# quartus = false

# Write IP-XACT components (IEEE 1685-2014): <top>.xml.
# True or false, default false.
ip_xact = false

# The vendor in IP-XACT, Vivado and Platform Designer; a domain name, as a rule.
# A name of at most 60 letters, digits, `.`, `-` and `_`, beginning with a letter, default
# \"glint\".
vendor = \"glint\"

# The version of the core for FuseSoC, IP-XACT, Vivado and Platform Designer.
# A version of three numbers up to 9999, as \"1.0.0\", default \"0.1.0\".
version = \"0.1.0\"

# The licence of the files for FuseSoC, of which only the characters are checked. What
# Glint generates belongs to its user.
# An SPDX licence expression of at most 60 characters, as \"MIT OR Apache-2.0\", default
# \"LicenseRef-belongs-to-its-user\".
licence = \"LicenseRef-belongs-to-its-user\"
";
    let text = commented(&lamp(), "my_lamp");
    assert_eq!(text, expected);
    let read = parse("x.toml", &text, &schemas()).expect("valid");
    assert_eq!(read, Config::defaults(&lamp(), "my_lamp"));
}

#[test]
fn tables_and_dotted_keys_are_the_same() {
    let tables = "device = \"lamp\"\npower = 4\n[cosine]\nfraction = 0x10\n[sine]\n\
                  scheme = \"segmented\"\nsegments = [7, +6]\n[domain]\ndeviation = 45\n";
    let dotted = "power = 4\ncosine.fraction = 16\nsine = { scheme = \"segmented\", segments = [7, 6] }\n\
                  domain.deviation = 4.5e1\ndevice = \"lamp\"\n";
    let config = parse("a-b.toml", tables, &schemas()).expect("valid");
    assert_eq!(config, parse("a-b.toml", dotted, &schemas()).expect("valid"));
    assert_eq!((config.name.as_str(), config.strict), ("a_b", false));
    assert_eq!((config.choice("power"), config.integer("power")), ("4", 4));
    assert_eq!(config.integer("cosine.fraction"), 16);
    assert!(!config.flag("cosine.signed"));
    assert_eq!(config.integers("sine.segments"), [7, 6]);
    assert_eq!(config.number("domain.deviation"), 45.0);
}

#[test]
fn keys_that_every_device_shares() {
    let text = "device = \"lamp\"\n[package]\nsoftware = true\n";
    let config = parse("x.toml", text, &schemas()).expect("valid");
    assert!(config.flag("package.software"));
    assert_eq!(config.choice("architecture"), "sequential");
    let again = parse("x.toml", &config.to_toml(&lamp()), &schemas());
    assert_eq!(again.expect("it reads back"), config);
    // At their defaults they are not written: records of configurations are older than they are.
    let defaults = Config::defaults(&lamp(), "x").to_toml(&lamp());
    assert!(!defaults.contains("package"), "{defaults}");
}

#[test]
fn samples_are_valid_and_read_back() {
    for seed in 0..500 {
        let config = sample(&lamp(), seed);
        let text = config.to_toml(&lamp());
        let read = parse("x.toml", &text, &schemas());
        assert_eq!(read.expect("a sample is valid"), config, "{text}");
    }
}

#[test]
fn samples_cover_ends_and_both_sides_of_every_choice() {
    let configs: Vec<Config> = (0..500).map(|seed| sample(&lamp(), seed)).collect();
    let seen = |key: &str| -> BTreeSet<String> {
        configs.iter().map(|config| config.value(key).bare()).collect()
    };
    assert_eq!(seen("power").len(), 4);
    assert_eq!(seen("arithmetic").len(), 2);
    assert_eq!(seen("cosine.fraction").len(), 27);
    assert_eq!(seen("sine.address").len(), 16);
    let often = |key: &str, value: Value| {
        configs.iter().filter(|config| *config.value(key) == value).count()
    };
    // A uniform draw would give each about 18 times.
    assert!(often("cosine.fraction", Value::Integer(4)) > 30);
    assert!(often("cosine.fraction", Value::Integer(30)) > 40);
    assert!(often("domain.deviation", Value::Number(0.5)) > 30);
    let lengths: BTreeSet<usize> = configs
        .iter()
        .filter(|config| config.choice("sine.scheme") == "segmented")
        .map(|config| config.integers("sine.segments").len())
        .collect();
    assert_eq!(lengths, (1..=8).collect());
    // The same seed, the same configuration; and seeds differ.
    assert_eq!(sample(&lamp(), 7), configs[7]);
    assert_ne!(configs[7].to_toml(&lamp()), configs[8].to_toml(&lamp()));
}

#[test]
fn mistakes_in_a_schema_are_found() {
    assert_eq!(lamp().faults(), Vec::<String>::new());
    let doc = "Something.";
    let faulty = Schema {
        device: "faulty",
        keys: vec![
            Key::integer("a", 0, 1..=2, doc),
            Key::flag("a.b", false, doc),
            Key::flag("Name", false, doc),
            Key::flag("strict", false, doc),
            Key::flag("package.software", false, doc),
            Key::flag("package", false, doc),
            Key::flag("twice", false, doc),
            Key::flag("twice", false, doc).only_when("later", "true"),
            Key::choice("later", "x", &["x", "y"], doc).only_when("twice", "maybe"),
            Key::choice("mixed", "x", &["x", "1"], doc),
        ],
        check: |_, _| {},
    };
    assert_eq!(
        faulty.faults(),
        [
            "`a` is both a key and a table",
            "default of `a`: `a` = 0 is out of range",
            "`Name` is not made of plain lower-case words",
            "`strict` is a key of every device",
            "`package.software` is a key of every device",
            "`package` is both a key and a table",
            "`twice` is declared twice",
            "`twice` depends on `later`, which is not declared before it",
            "`later` depends on `twice` = maybe, which that can never be",
            "`mixed` is a choice among integers and words",
        ]
    );
    let refused =
        Schema { check: |_, problems| problems.push("power", "too much", "less"), ..lamp() };
    assert_eq!(refused.faults(), ["defaults: too much"]);
}
