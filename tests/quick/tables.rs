//! Tests that the tables between markers in README.md and docs/ agree with the cores and records of today.
//!
//! `bash tools/bless` rewrites the tables: it sets the environment variable `GLINT_BLESS`. Columns that only a benchmark
//! measures stay unchanged.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::Arc;

use glint::approximate::{Layout, Piecewise};
use glint::base::input;
use glint::base::text::{grouped, rounded_up};
use glint::config::{Config, Value as ConfigValue};
use glint::core::{Core, TEST_POINTS, TEST_SEED};
use glint::evidence::comparison::{accuracy, clocks_per_point};
use glint::hdl::area::Features;
use glint::hdl::netlist::Pipeline;
use glint::keys::function::{plan, schema};
use glint::keys::presets;
use glint::mutate::{GOAL_MEMORY, GOAL_TEXT};
use glint::registry::Registry;
use glint::synth::{self, Figures, Frequency, Rate, SynthesisRecord, Target};
use glint::tune::{self, Cost};
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::Value;

use crate::common::Sure;
use crate::common::cores::{all_configurations, configuration, parsed};
use crate::common::files::{json, read};
use crate::common::json::Json;

/// The cells of a row.
type Row = Vec<String>;

/// Brings the rows of a table up to date.
type Make = fn(&mut Vec<Row>);

const MEASUREMENTS: &str = "docs/measurements.md";
const AREA: &str = "docs/evidence/area.md";
const RATES: &str = "docs/evidence/rates.md";
const VERIFICATION: &str = "docs/verification.md";
const FAULTS: &str = "docs/evidence/faults.md";
const FUNCTIONS: &str = "docs/functions.md";
const FUNCTION_SIZES: &str = "docs/evidence/functions.md";

/// A table: its page, its name, and the function that makes it.
const TABLES: [(&str, &str, Make); 17] = [
    ("README.md", "main_job", |rows| rows.iter_mut().for_each(main_job)),
    (MEASUREMENTS, "devices", |rows| rows.iter_mut().for_each(device)),
    (MEASUREMENTS, "choices", |rows| rows.iter_mut().for_each(choice)),
    (AREA, "area_and_speed", area_and_speed),
    (AREA, "small_ice40", |rows| small(rows, "small", "_60", Target::Ice40)),
    (AREA, "small_ecp5", |rows| small(rows, "small", "_up5k", Target::Ecp5)),
    (RATES, "intervals", |rows| small(rows, "intervals", "none", Target::Ecp5)),
    (MEASUREMENTS, "literature", |rows| literature(rows)),
    (RATES, "pipelines", pipelines),
    (RATES, "registered_multipliers", |rows| rows.iter_mut().for_each(registered_multipliers)),
    (FUNCTIONS, "presets", |rows| rows.par_iter_mut().for_each(preset)),
    (FUNCTION_SIZES, "functions", |rows| rows.par_iter_mut().for_each(function)),
    (VERIFICATION, "verify", |rows| verify(rows)),
    (FAULTS, "faults", |rows| *rows = faults_in_netlists(false)),
    (FAULTS, "faults_of_pipelines", |rows| *rows = faults_in_netlists(true)),
    (FAULTS, "faults_in_verilog", |rows| *rows = faults_in_verilog()),
    (FAULTS, "shipped_benches", |rows| *rows = shipped_benches()),
];

/// Returns the text of a page before the rows of its table of that name, the rows, and the text after them.
fn divided<'a>(page: &str, text: &'a str, name: &str) -> (&'a str, Vec<Row>, &'a str) {
    let marker = format!("<!-- table {name} -->\n");
    let start = text.find(&marker).unwrap_or_else(|| panic!("{page} has no table {name}"));
    let start = start + marker.len();
    let head: usize = text[start..].split_inclusive('\n').take(2).map(str::len).sum();
    let (before, rest) = text.split_at(start + head);
    let (rows, after) = rest.split_at(rest.find("<!-- end -->").expect("an end of the table"));
    let cells = |line: &str| {
        let line = line.trim_start_matches('|').trim_end_matches('|');
        line.split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    (before, rows.lines().map(cells).collect(), after)
}

#[test]
fn bless_changes_no_table() {
    let written: Vec<Vec<Row>> = TABLES
        .par_iter()
        .map(|(page, name, make)| {
            let mut rows = divided(page, &read(page), name).1;
            make(&mut rows);
            rows
        })
        .collect();
    let bless = std::env::var_os("GLINT_BLESS").is_some();
    for ((page, name, _), rows) in TABLES.iter().zip(written) {
        let text = read(page);
        let (before, found, after) = divided(page, &text, name);
        if bless {
            let rows: String =
                rows.iter().map(|row| format!("| {} |\n", row.join(" | "))).collect();
            fs::write(page, format!("{before}{rows}{after}")).expect("written");
        } else {
            assert_eq!(found, rows, "{page}, table {name}: `bash tools/bless` writes it");
        }
    }
}

#[test]
fn every_table_between_markers_is_blessed() {
    for page in
        ["README.md", MEASUREMENTS, AREA, RATES, FUNCTIONS, FUNCTION_SIZES, VERIFICATION, FAULTS]
    {
        let names = TABLES.iter().filter(|(of, ..)| *of == page).count();
        assert_eq!(read(page).matches("<!-- table ").count(), names, "{page}");
    }
}

/// Returns the approximation that values of the keys of `function` lead to.
fn approximation(values: Vec<(String, ConfigValue)>) -> Arc<Piecewise> {
    let mut config = Config::defaults(&schema(), "f");
    values.iter().for_each(|(key, value)| config.set(key, value.clone()));
    plan(&config).unwrap_or_else(|error| panic!("{values:?}: {error}")).polynomials
}

/// Writes bits of coefficients of a function by its name, with the reduction and without.
fn preset(row: &mut Row) {
    let name = row[0].split(',').next().expect("a name");
    let values = presets::find(name).unwrap_or_else(|| panic!("no function is `{name}`")).values;
    let mut plain = values.clone();
    plain.push(("approximation.reduction".to_owned(), ConfigValue::Text("none".to_owned())));
    let bits = [values, plain].map(|values| grouped(approximation(values).rom_bits()));
    put(row, 3, bits);
}

/// Writes of a formula segments and degree, bits of coefficients and the largest error, at 16 bits and at 20.
fn function(row: &mut Row) {
    let formula = row[0].trim_matches('`').to_owned();
    let ends = if formula.starts_with("x^") { ["1", "16"] } else { ["0", "1"] };
    for (column, bits) in [(1, 16), (4, 20)] {
        let text = |key: &str, value: &str| (key.to_owned(), ConfigValue::Text(value.to_owned()));
        let number = |key: &str, value: i64| (key.to_owned(), ConfigValue::Integer(value));
        // x in [1, 16) has four bits before the point.
        let whole = if ends[1] == "16" { 4 } else { 0 };
        let it = approximation(vec![
            text("function.formula", &formula),
            text("function.from", ends[0]),
            text("function.to", ends[1]),
            number("operand.fraction", bits - whole),
            number("result.fraction", bits),
        ]);
        let layout = match it.segments.layout {
            Layout::Uniform => String::new(),
            layout => format!(" ({})", layout.name()),
        };
        let shape = format!("{}{layout}, degree {}", it.words.len(), it.degree());
        let error = rounded_up(it.bound, 3);
        put(row, column, [shape, grouped(it.rom_bits()), error]);
    }
}

/// Returns the name that a row begins with.
fn key(row: &Row) -> &str {
    row[0].trim_start_matches('`').split(['`', ' ']).next().expect("a name")
}

/// Writes these cells into a row, from a column on.
fn put<const COUNT: usize>(row: &mut Row, column: usize, cells: [String; COUNT]) {
    row.splice(column..column + COUNT, cells);
}

/// Returns the core of a configuration, a study or not.
fn core(name: &str) -> Core {
    let studies = format!("configs/studies/{name}.toml");
    let path = format!("configs/{name}.toml");
    configuration(if fs::exists(&path).expect("readable") { &path } else { &studies })
}

/// At most three digits behind the point, and none that are 0.
fn trimmed(number: f64) -> String {
    format!("{number:.3}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The largest error is that of a run of the main job.
fn main_job(row: &mut Row) {
    let core = core(key(row));
    let clocks = core.timing().expect("clocks").clocks_per_point().expect("a number");
    let bound = core.contract.bounds().governing().units;
    let device = format!("`{}`", core.device().name);
    let rom_bits = grouped(core.design.rom_bits());
    let lockstep = core.lockstep(TEST_SEED).expect("a simulation");
    let outcome = lockstep.run(TEST_POINTS, &|_| ()).expect("a run");
    let error = outcome.worst.expect("a largest error").units;
    assert!(error <= bound, "{row:?}");
    let error = format!("{error:.3}");
    put(row, 1, [device, clocks.to_string(), rom_bits, rounded_up(bound, 3), error]);
}

/// Errors at the exponent of the comparison, and areas by the records.
fn device(row: &mut Row) {
    const EXPONENT: f64 = 35.0;
    let name = key(row).replace('-', "_");
    let core = core(&name);
    let found = accuracy(core.contract.as_ref(), EXPONENT).expect("a highlight");
    let clocks = clocks_per_point(&core.design, core.contract.as_ref(), EXPONENT).expect("it ends");
    let errors = [found.whole, found.formula, found.fixed_point];
    put(row, 1, errors.map(|it| format!("{:.5}", it.largest)));
    put(row, 4, [trimmed(clocks), core.design.rom_bits().to_string()]);
    let record = record(&name);
    let targets = [Target::Ice40, Target::Ecp5, Target::Xilinx7];
    put(row, 6, targets.map(|it| area(figures(&record, it))));
}

fn choice(row: &mut Row) {
    let name = key(row).to_owned();
    let core = core(&name);
    let error = |value: &Value| format!("{:.3}", value.number());
    let worst = &json(format!("records/proofs/worst/{name}.json"))["units"];
    let record = format!("records/proofs/{name}.json");
    let together = match fs::exists(&record).expect("readable") {
        true => error(&json(&record)["configurations"][0]["together"]),
        false => "–".to_owned(),
    };
    let bound = core.contract.bounds().words();
    put(row, 3, [grouped(core.design.rom_bits()), bound, error(worst), together]);
}

fn area_and_speed(rows: &mut Vec<Row>) {
    let records = input::records::<SynthesisRecord>(Path::new(synth::DIRECTORY)).expect("records");
    let mut records: Vec<SynthesisRecord> = records.into_iter().map(|(_, record)| record).collect();
    let catalogue = Registry::catalogue();
    records.sort_by_key(|it| {
        let place = catalogue.devices().iter().position(|device| device.name == it.device);
        (it.name.ends_with("_pipelined"), place)
    });
    let row = |record: &SynthesisRecord| {
        let rate = |figures: &Figures| Rate::new(figures, record.clocks_per_point);
        let one = |number: Option<f64>| number.map_or("–".to_owned(), |it| format!("{it:.1}"));
        let [ice40, ecp5, cells] =
            [Target::Ice40, Target::Ecp5, Target::Osu018].map(|target| figures(record, target));
        let rate_there = rate(ecp5);
        vec![
            format!("`{}`", record.name),
            trimmed(record.clocks_per_point),
            one(ice40.frequency.map(|it| it.median)),
            one(rate(ice40).map(|it| it.points)),
            frequency(ecp5),
            one(rate_there.map(|it| it.points)),
            one(rate_there.and_then(|it| it.per_lut).map(|it| 1000.0 * it)),
            one(rate_there.and_then(|it| it.per_dsp)),
            grouped(cells.area.gates.expect("gates") as u64),
            one(rate(cells).map(|it| it.points)),
        ]
    };
    *rows = records.iter().map(row).collect();
}

/// Returns the pipeline of a configuration in which the line of the clock is another, or the same.
fn pipeline(name: &str, clock: Option<&str>) -> Pipeline {
    let text = read(format!("configs/{name}_pipelined.toml"));
    let line = text.lines().find(|line| line.starts_with("clock_mhz")).expect("a clock");
    let text = text.replace(line, clock.unwrap_or(line));
    parsed(&format!("{name}.toml"), &text).design.pipeline.expect("a pipeline")
}

fn register_bits(pipeline: &Pipeline) -> String {
    grouped(pipeline.stages.iter().map(|stage| u64::from(stage.register_bits)).sum())
}

/// Stages and register bits; frequencies, areas and the pipelines by hand are of `benches/pipeline/ecp5.py`.
fn pipelines(rows: &mut Vec<Row>) {
    for row in &mut *rows {
        let now = pipeline(key(row), None);
        let slower = pipeline(key(row), Some("clock_mhz = 60"));
        put(row, 1, [now.stages.len().to_string()]);
        put(row, 5, [register_bits(&now), register_bits(&slower)]);
    }
    let listed: BTreeSet<String> =
        rows.iter().map(|row| format!("{}_pipelined", key(row))).collect();
    // Of a function there is no pipeline by hand.
    let highlights = all_configurations().into_iter();
    let highlights = highlights.filter(|(_, core)| core.contract.highlight().is_some());
    let inferred = highlights.filter(|(_, core)| {
        let pipeline = core.design.pipeline.as_ref();
        pipeline.is_some_and(|it| it.registered.is_empty() && it.interval == 1)
    });
    assert_eq!(listed, inferred.map(|(_, core)| core.config().name.clone()).collect());
}

/// All columns but the frequencies, which are of `benches/pipeline/ecp5.py`.
fn registered_multipliers(row: &mut Row) {
    let now = pipeline(key(row), Some("clock_mhz = 165\nmultipliers = \"registered\""));
    put(row, 1, [now.stages.len().to_string()]);
    put(row, 4, [now.registered.len().to_string(), register_bits(&now)]);
}

/// A record stands for the netlist that it was made of: the sums of what that consists of are today's, within a
/// twentieth, and so is the estimated clock, which `benches/tune/fit` reads. `glint synth CONFIG --out synthesis` makes it anew.
#[test]
fn records_of_synthesis_are_of_todays_netlists() {
    let records =
        input::records::<SynthesisRecord<Recorded>>(Path::new(synth::DIRECTORY)).expect("records");
    assert!(!records.is_empty());
    for (path, record) in records {
        let path = path.display();
        let core = today(&record);
        for Recorded { target, netlist, estimated_mhz } in record.targets {
            let sum = |Features { adder, mux, logic, rom, product, delay }: Features| {
                adder + mux + logic + rom + product + delay
            };
            let (now, then) =
                (sum(Features::new(&core.design, tune::family(target))), sum(netlist));
            assert!((now - then).abs() <= 0.05 * then, "{path}, {target}: {now}, was {then}");
            let mhz = Cost::new(&core.design, target).mhz;
            let apart = (mhz - estimated_mhz).abs();
            assert!(apart <= 0.05 * mhz, "{path}, {target}: {mhz} MHz, was {estimated_mhz}");
        }
    }
}

/// The composition of a record's netlist, and the estimated clock.
#[derive(Deserialize)]
struct Recorded {
    target: Target,
    netlist: Features,
    estimated_mhz: f64,
}

fn record(name: &str) -> SynthesisRecord {
    let path = format!("{}/{name}.json", synth::DIRECTORY);
    serde_json::from_value(json(&path)).sure_of(path)
}

/// Returns the core of a record, which is of today's configuration.
fn today<T>(record: &SynthesisRecord<T>) -> Core {
    let core = configuration(&record.config);
    assert_eq!(core.core_digest(), record.core, "{}: another configuration", record.name);
    core
}

fn figures(record: &SynthesisRecord, target: Target) -> &Figures {
    record.of(target).unwrap_or_else(|| panic!("{}: no figures for {target}", record.name))
}

/// LUT, DSP, RAM.
fn area(figures: &Figures) -> String {
    let usage = figures.area.usage().expect("an FPGA");
    format!("{}, {}, {}", usage.luts, usage.dsps, usage.block_rams)
}

/// Returns the median, the lowest and the highest.
fn frequency(figures: &Figures) -> String {
    let Frequency { lowest, median, highest, .. } = figures.frequency.expect("a frequency");
    format!("{median:.1} ({lowest:.1}–{highest:.1})")
}

/// Rows of the records in a folder of `benches/` with a frequency for the target, and of cores in `records/synthesis/` beside them. Records
/// of the `other` target have no row.
fn small(rows: &mut Vec<Row>, folder: &str, other: &str, target: Target) {
    let small =
        input::records::<SynthesisRecord>(&Path::new("benches").join(folder)).expect("records");
    let own: BTreeMap<String, SynthesisRecord> =
        small.into_iter().map(|(_, record)| (record.name.clone(), record)).collect();
    for name in own.keys() {
        let listed = rows.iter().any(|row| key(row) == name);
        assert!(listed || name.contains(other), "{name} has no row");
    }
    for row in rows {
        let record = own.get(key(row)).cloned().unwrap_or_else(|| record(key(row)));
        today(&record);
        let figures = figures(&record, target);
        let rate = Rate::new(figures, record.clocks_per_point).expect("a rate");
        let flip_flops = figures.area.usage().expect("an FPGA").flip_flops.to_string();
        let (clocks, points) = (record.clocks_per_point.to_string(), format!("{:.1}", rate.points));
        put(row, 1, [clocks, area(figures), flip_flops, frequency(figures), points]);
    }
}

/// Rows of Glint's own devices: gates and rate of the records in `benches/literature/`, and the error against cosⁿγ at n = 20,
/// over γ = 0…90°.
fn literature(rows: &mut [Row]) {
    for (_, record) in
        input::records::<SynthesisRecord>(Path::new("benches/literature")).expect("records")
    {
        let row = rows.iter_mut().find(|row| key(row) == record.name);
        let row = row.unwrap_or_else(|| panic!("no row {}", record.name));
        let cells = figures(&record, Target::Osu018);
        let core = today(&record);
        let error = accuracy(core.contract.as_ref(), 20.0).expect("a highlight").whole.largest;
        let rate = Rate::new(cells, record.clocks_per_point).expect("a frequency");
        let gates = grouped(cells.area.gates.expect("gates") as u64);
        put(row, 2, [gates, format!("{:.1}", rate.points), format!("{error:.5}")]);
    }
}

/// The lines of `glint verify` of `cosine_power` that come from records.
fn verify(rows: &mut [Row]) {
    let proof = &json("records/proofs/cosine_power.json")["configurations"][0];
    let [evaluations, products] =
        ["evaluations", "colour_products"].map(|key| grouped(proof[key].count()));
    let Faults { planted, caught, equivalent, undecided } =
        Faults::new(&json("records/mutation/cosine_power.json")["netlist"]["all"]);
    let (planted, caught) = (grouped(planted), caught.values().sum::<u64>());
    let statements = json("records/proofs/certificates/cosine_power.json")["statements"].count();
    let [sweep, faults, gappa] = [
        format!("{evaluations} evaluations of f and {products} colour products"),
        format!(
            "{planted} faults: {caught} caught, {equivalent} proved equivalent, {undecided} undecided"
        ),
        format!("all operands: {} statements", statements),
    ];
    for (check, over) in [
        ("golden model against the formula", sweep),
        ("faults in the netlist", faults),
        ("the error bound, by Gappa", gappa),
    ] {
        let row = rows.iter_mut().find(|row| row[0] == check);
        put(row.unwrap_or_else(|| panic!("no row {check}")), 2, [over]);
    }
}

/// The netlist's part of a record of `glint mutate`.
struct Faults {
    planted: u64,
    /// By the check that catches.
    caught: BTreeMap<String, u64>,
    equivalent: u64,
    undecided: u64,
}

impl Faults {
    fn new(all: &Value) -> Self {
        let each = |value: &Value| -> BTreeMap<String, u64> {
            let counts = value.object().iter();
            counts.map(|(name, count)| (name.clone(), count.count())).collect()
        };
        Self {
            planted: all["planted"].count(),
            caught: each(&all["caught"]),
            equivalent: each(&all["equivalent"]).values().sum(),
            undecided: all["undecided"].count(),
        }
    }
}

/// Returns the records of faults, of pipelines or of sequential cores, by name.
fn mutation_records(pipelined: bool) -> Vec<(String, Value)> {
    let records =
        input::records::<Value>(Path::new("records/mutation")).expect("records").into_iter();
    let named = records.map(|(path, record)| {
        (path.file_stem().expect("a name").to_string_lossy().into_owned(), record)
    });
    named.filter(|(name, _)| name.ends_with("_pipelined") == pipelined).collect()
}

/// Returns a row for each record, and one for the sum of all, by the function that prints counts.
fn summed<const COUNT: usize>(
    pipelined: bool,
    counts: impl Fn(&Value) -> [u64; COUNT],
    print: impl Fn([u64; COUNT]) -> Row,
) -> Vec<Row> {
    let mut sum = [0; COUNT];
    let mut rows = Vec::new();
    for (name, record) in mutation_records(pipelined) {
        let counts = counts(&record);
        sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        rows.push([vec![format!("`{name}`")], print(counts)].concat());
    }
    rows.push([vec!["all".to_owned()], print(sum)].concat());
    rows
}

fn faults_in_netlists(pipelined: bool) -> Vec<Row> {
    let counts = |record: &Value| {
        let Faults { planted, caught, equivalent, undecided } =
            Faults::new(&record["netlist"]["all"]);
        let default = caught.get("cosim").copied().unwrap_or(0);
        [planted, default, caught.values().sum::<u64>() - default, equivalent, undecided]
    };
    summed(pipelined, counts, |[planted, default, rest, equivalent, undecided]| {
        let share = 100.0 * undecided as f64 / planted as f64;
        let mut row = [planted, default, rest, equivalent].map(grouped).to_vec();
        row.push(format!("{undecided} ({share:.2} %)"));
        row
    })
}

/// Faults in the emitted text: planted, noticed by lint and by the bench, equivalent, undecided; and the share that is undecided
/// of all, those in the netlist too.
fn faults_in_verilog() -> Vec<Row> {
    let counts = |record: &Value| {
        let Faults { planted: netlist, undecided, .. } = Faults::new(&record["netlist"]["all"]);
        let verilog = &record["verilog"];
        let [planted, lint, bench, equivalent] =
            ["planted", "lint", "bench", "equivalent"].map(|key| verilog[key].count());
        let left = verilog["undecided"].list().len() as u64;
        [planted, lint, bench, equivalent, left, planted + netlist, left + undecided]
    };
    summed(false, counts, |[planted, lint, bench, equivalent, left, all, undecided]| {
        let mut row = [planted, lint, bench, equivalent, left].map(grouped).to_vec();
        row.push(format!("{:.2} %", 100.0 * undecided as f64 / all as f64));
        row
    })
}

/// Returns the shares of the faults that any check notices which the shipped bench notices: noticed and all, in the netlist, in the
/// upper bits of ROM words, in the Verilog.
fn noticed_by_shipped_bench(record: &Value) -> [Option<[u64; 2]>; 3] {
    let tally = |tally: &Value| {
        let [noticed, missed] = ["shipped", "missed"].map(|count| tally[count].as_u64());
        Some([noticed?, noticed? + missed?])
    };
    let netlist = &record["netlist"];
    let verilog = &record["verilog"]["shipped"];
    [
        tally(&netlist["all"]),
        tally(&netlist["kinds"]["rom-high-bit"]),
        Some(["noticed", "of"].map(|count| verilog[count].count())),
    ]
}

fn shipped_benches() -> Vec<Row> {
    let cell = |share: Option<[u64; 2]>| match share {
        Some([noticed, all]) => {
            let share = 100.0 * noticed as f64 / all as f64;
            format!("{} of {} ({share:.1} %)", grouped(noticed), grouped(all))
        }
        None => "—".to_owned(),
    };
    let mut together = [0, 0];
    let mut rows = Vec::new();
    for (name, record) in mutation_records(false) {
        let shares = noticed_by_shipped_bench(&record);
        let [noticed, all] = shares[2].expect("counts");
        together = [together[0] + noticed, together[1] + all];
        rows.push([vec![format!("`{name}`")], shares.map(cell).to_vec()].concat());
    }
    let together = [None, None, Some(together)].map(cell);
    rows.push([vec!["all".to_owned()], together.to_vec()].concat());
    rows
}

/// Shipped benches notice no less than the goals, but for those that docs/evidence/faults.md names.
#[test]
fn shipped_benches_reach_the_goals() {
    let mut together = [0, 0];
    let share = |[noticed, all]: [u64; 2]| noticed as f64 / all as f64;
    let records = mutation_records(false);
    assert_eq!(records.len(), Registry::catalogue().devices().len());
    for (name, record) in records {
        let [_, memory, verilog] = noticed_by_shipped_bench(&record);
        assert!(memory.is_none_or(|it| share(it) >= GOAL_MEMORY), "{name}");
        let verilog = verilog.expect("counts");
        let short = ["blinn", "gauss"].contains(&name.as_str());
        assert_eq!(share(verilog) >= GOAL_TEXT, !short, "{name}: {verilog:?}");
        together = [together[0] + verilog[0], together[1] + verilog[1]];
    }
    assert!(share(together) >= GOAL_TEXT, "{together:?}");
}
