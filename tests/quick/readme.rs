//! The tables of README.md and docs/verification.md say what Glint and its records say today.
//!
//! What only outside tools know (area, frequency) is that of the records in `synthesis/`, which are of today's netlists; how
//! fast simulators are is not here.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use glint::base::input;
use glint::base::text::grouped;
use glint::core::Core;
use glint::evidence::comparison::{accuracy, clocks_per_point};
use glint::hdl::netlist::Pipeline;
use glint::mutate::{GOAL_MEMORY, GOAL_TEXT};
use glint::registry::Registry;
use glint::synth::{self, Figures, Frequency, Rate, Record, Target};
use glint::tune::{Cost, Features};
use serde::Deserialize;
use serde_json::Value;

use crate::common::cores::{all_configurations, configuration};

/// The exponent of the comparison in README.md.
const EXPONENT: f64 = 35.0;

fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn json(path: &str) -> Value {
    serde_json::from_str(&read(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn cells(line: &str) -> Vec<String> {
    let line = line.trim().trim_matches('|');
    line.split('|').map(|cell| cell.trim().replace('`', "")).collect()
}

/// The rows of the table whose first line begins so, without the lines of its head.
fn table(path: &str, head: &str) -> Vec<Vec<String>> {
    let text = read(path);
    let lines = text.lines().skip_while(|line| !line.starts_with(head));
    let rows: Vec<_> = lines.skip(2).take_while(|line| line.starts_with('|')).map(cells).collect();
    assert!(!rows.is_empty(), "{path} has no table that begins with {head}");
    rows
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A file name without `-`.
fn module(device: &str) -> String {
    device.replace('-', "_")
}

fn of(name: &str) -> Core {
    let studies = format!("configs/studies/{name}.toml");
    let path = format!("configs/{name}.toml");
    configuration(if fs::exists(&path).expect("readable") { &path } else { &studies })
}

#[test]
fn every_device_stands_in_the_table() {
    let rows = table("README.md", "| device | computes |");
    let mut listed: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    listed.sort_unstable();
    let catalogue = Registry::catalogue();
    let mut devices: Vec<&str> = catalogue.devices().iter().map(|it| it.name).collect();
    devices.sort_unstable();
    assert_eq!(listed, devices);
}

/// All columns but those of a run of 100 000 points, which the main job has.
#[test]
fn the_main_job() {
    for row in table("README.md", "| configuration    | device") {
        let core = of(&row[0]);
        let timing = core.timing().expect("clocks");
        let bound = core.contract.bound().units;
        let clocks = timing.clocks_per_point().map(|it| it.to_string());
        assert_eq!(
            [&row[1], &row[2], &row[5], &row[6]],
            [
                core.device.name,
                &clocks.unwrap_or_default(),
                &grouped(core.design.rom_bits()),
                &format!("{bound:.3}")
            ],
            "{row:?}"
        );
        assert!(row[7].parse::<f64>().is_ok_and(|error| error <= bound), "{row:?}");
    }
    let configurations = fs::read_dir("configs").expect("configs/").filter(|entry| {
        let path = entry.as_ref().expect("an entry").path();
        path.extension().is_some_and(|it| it == "toml")
    });
    let count = configurations.count();
    assert!(read("README.md").contains(&format!("\n{count} of {count} hold.\n")), "{count}");
}

#[test]
fn choosing_a_device() {
    for row in table("README.md", "| device | largest error of f") {
        let device = row[0].split(' ').next().expect("a name");
        let core = of(&module(device));
        let found = accuracy(core.contract.as_ref(), EXPONENT).expect("a highlight");
        let clocks =
            clocks_per_point(&core.design, core.contract.as_ref(), EXPONENT).expect("it ends");
        let clocks = format!("{clocks:.3}");
        assert_eq!(
            row[1..6],
            [
                format!("{:.5}", found.whole.largest),
                format!("{:.5}", found.formula.largest),
                format!("{:.5}", found.fixed_point.largest),
                clocks.trim_end_matches(".000").to_owned(),
                core.design.rom_bits().to_string(),
            ],
            "{device}"
        );
    }
}

/// What Yosys makes of the devices, by family.
#[test]
fn areas_of_the_devices() {
    let rows = table("README.md", "| device | largest error of f");
    let recorded = rows.iter().filter_map(|row| {
        let name = module(row[0].split(' ').next().expect("a name"));
        fs::exists(path(&name)).expect("readable").then(|| (row, record(&name)))
    });
    for (row, record) in recorded {
        for (target, cell) in [Target::Ice40, Target::Ecp5, Target::Xilinx7].iter().zip(&row[6..]) {
            assert_eq!(*cell, area(figures(&record, *target)), "{}, {target}", row[0]);
        }
    }
}

#[test]
fn area_and_speed() {
    let rows = table("README.md", "| configuration | clocks a point |");
    for row in &rows {
        let record = record(&row[0]);
        let clocks = format!("{:.3}", record.clocks_per_point);
        let mut expected = vec![clocks.trim_end_matches('0').trim_end_matches('.').to_owned()];
        let rate = |figures: &Figures| Rate::new(figures, record.clocks_per_point);
        let one = |number: Option<f64>| number.map_or("–".to_owned(), |it| format!("{it:.1}"));
        let ice40 = figures(&record, Target::Ice40);
        expected.push(one(ice40.frequency.map(|it| it.median)));
        expected.push(one(rate(ice40).map(|it| it.points)));
        let ecp5 = figures(&record, Target::Ecp5);
        let frequency = ecp5.frequency.expect("a frequency");
        let Frequency { lowest, median, highest, .. } = frequency;
        expected.push(format!("{median:.1} ({lowest:.1}–{highest:.1})"));
        let rate_there = rate(ecp5);
        expected.push(one(rate_there.map(|it| it.points)));
        expected.push(one(rate_there.and_then(|it| it.per_lut).map(|it| 1000.0 * it)));
        expected.push(one(rate_there.and_then(|it| it.per_dsp)));
        let cells = figures(&record, Target::Osu018);
        expected.push(grouped(cells.area.gates.expect("gates") as u64));
        expected.push(one(rate(cells).map(|it| it.points)));
        assert_eq!(row[1..], expected, "{}", row[0]);
    }
    let listed: BTreeSet<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    let records = input::records::<Record>(Path::new(synth::DIRECTORY)).expect("records");
    let recorded: BTreeSet<&str> = records.iter().map(|(_, it)| it.name.as_str()).collect();
    assert_eq!(listed, recorded);
}

/// The pipeline of a configuration in which the line of the clock is another, or the same.
fn pipeline(name: &str, clock: Option<&str>) -> Pipeline {
    let text = read(&format!("configs/{name}_pipelined.toml"));
    let line = text.lines().find(|line| line.starts_with("clock_mhz")).expect("a clock");
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join(format!("{name}.toml"));
    fs::write(&path, text.replace(line, clock.unwrap_or(line))).expect("written");
    configuration(path.to_str().expect("a path")).design.pipeline.expect("a pipeline")
}

fn register_bits(pipeline: &Pipeline) -> String {
    grouped(pipeline.stages.iter().map(|stage| u64::from(stage.register_bits)).sum())
}

/// Stages and register bits of the pipelines; frequencies and DSP blocks are of `benches/pipeline/ecp5.py`.
#[test]
fn pipelines() {
    let rows = table("README.md", "| pipeline | stages |");
    for row in &rows {
        let now = pipeline(&row[0], None);
        let slower = pipeline(&row[0], Some("clock_mhz = 60"));
        let expected = [now.stages.len().to_string(), register_bits(&now), register_bits(&slower)];
        assert_eq!([row[1].clone(), row[5].clone(), row[6].clone()], expected, "{}", row[0]);
    }
    let listed: BTreeSet<String> = rows.iter().map(|row| format!("{}_pipelined", row[0])).collect();
    let all = all_configurations().into_iter();
    let inferred = all.filter(|(_, core)| {
        core.design.pipeline.as_ref().is_some_and(|pipeline| pipeline.registered.is_empty())
    });
    assert_eq!(listed, inferred.map(|(_, core)| core.config.name).collect());
}

/// All columns but the frequency of pipelines with registered multipliers.
#[test]
fn registered_multipliers() {
    for row in table("README.md", "| with registered multipliers | stages |") {
        let asked = "clock_mhz = 165\nmultipliers = \"registered\"";
        let now = pipeline(&row[0], Some(asked));
        let counts = [now.stages.len(), now.registered.len()].map(|count| count.to_string());
        assert_eq!((&row[1], &row[4]), (&counts[0], &counts[1]), "{}", row[0]);
        assert_eq!(row[5], register_bits(&now), "{}", row[0]);
    }
}

/// A record stands for the netlist that it was made of: the sums of what that consists of are today's, within a
/// twentieth, and so is the estimated clock, which `benches/tune/fit` reads. `glint synth CONFIG --out synthesis` makes it anew.
#[test]
fn records_of_synthesis_are_of_todays_netlists() {
    let records = input::records::<Record<Recorded>>(Path::new(synth::DIRECTORY)).expect("records");
    assert!(!records.is_empty());
    for (path, record) in records {
        let path = path.display();
        let core = today(&record);
        for Recorded { target, netlist, estimated_mhz } in record.targets {
            let Features { adder, mux, logic, rom, product } = Features::new(&core.design, target);
            let now = [adder, mux, logic, rom, product];
            let Features { adder, mux, logic, rom, product } = netlist;
            let then = [adder, mux, logic, rom, product];
            let (now, then): (f64, f64) = (now.iter().sum(), then.iter().sum());
            assert!((now - then).abs() <= 0.05 * then, "{path}, {target}: {now}, was {then}");
            let mhz = Cost::new(&core.design, target).mhz;
            let apart = (mhz - estimated_mhz).abs();
            assert!(apart <= 0.05 * mhz, "{path}, {target}: {mhz} MHz, was {estimated_mhz}");
        }
    }
}

/// Of a record, what its netlist consisted of, and the clock by the estimate.
#[derive(Deserialize)]
struct Recorded {
    target: Target,
    netlist: Features,
    estimated_mhz: f64,
}

/// The record of a configuration.
fn path(name: &str) -> String {
    format!("{}/{name}.json", synth::DIRECTORY)
}

fn record(name: &str) -> Record {
    let path = path(name);
    serde_json::from_str(&read(&path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The core of a record, which is of today's configuration.
fn today<T>(record: &Record<T>) -> Core {
    let core = configuration(&record.config);
    assert_eq!(core.core_digest(), record.core, "{}: another configuration", record.name);
    core
}

fn figures(record: &Record, target: Target) -> &Figures {
    record.of(target).unwrap_or_else(|| panic!("{}: no figures for {target}", record.name))
}

/// LUT, DSP, RAM.
fn area(figures: &Figures) -> String {
    let usage = figures.area.usage().expect("an FPGA");
    format!("{}, {}, {}", usage.luts, usage.dsps, usage.block_rams)
}

/// Rows of the records in `benches/small/`, and of the sequential cores beside them in `synthesis/`.
#[test]
fn fewer_multipliers_fewer_stages() {
    let small = input::records::<Record>(Path::new("benches/small")).expect("records");
    let mut shown = BTreeSet::new();
    for (head, target) in
        [("| core on a UP5K |", Target::Ice40), ("| core on ECP5 |", Target::Ecp5)]
    {
        for row in table("README.md", head) {
            let own = small.iter().find(|(_, it)| it.name == row[0]).map(|(_, it)| it);
            let of_all;
            let record = match own {
                Some(own) => own,
                None => {
                    of_all = record(&row[0]);
                    &of_all
                }
            };
            shown.extend(own.map(|own| own.name.clone()));
            today(record);
            let figures = figures(record, target);
            let Frequency { lowest, median, highest, .. } = figures.frequency.expect("a frequency");
            let rate = Rate::new(figures, record.clocks_per_point).expect("a rate");
            let flip_flops = figures.area.usage().expect("an FPGA").flip_flops;
            assert_eq!(
                row[1..],
                [
                    record.clocks_per_point.to_string(),
                    area(figures),
                    flip_flops.to_string(),
                    format!("{median:.1} ({lowest:.1}–{highest:.1})"),
                    format!("{:.1}", rate.points),
                ],
                "{}",
                row[0]
            );
        }
    }
    assert_eq!(shown.len(), small.len());
}

/// Rows of Glint's own devices: gates and rate of the records in `benches/literature/`, and the error against cosⁿγ at n = 20,
/// over γ = 0…90°.
#[test]
fn beside_the_literature() {
    let rows = table("README.md", "| unit | what it computes | gates |");
    let directory = Path::new("benches/literature");
    for (_, record) in input::records::<Record>(directory).expect("records") {
        let row = rows.iter().find(|row| row[0] == record.name);
        let row = row.unwrap_or_else(|| panic!("no row {}", record.name));
        let cells = figures(&record, Target::Osu018);
        let core = today(&record);
        let error = accuracy(core.contract.as_ref(), 20.0).expect("a highlight").whole.largest;
        let rate = Rate::new(cells, record.clocks_per_point).expect("a frequency");
        assert_eq!(
            row[2..5],
            [
                grouped(cells.area.gates.expect("gates") as u64),
                format!("{:.1}", rate.points),
                format!("{error:.5}")
            ],
            "{}",
            record.name
        );
    }
}

#[test]
fn what_the_choices_cost() {
    for row in table("README.md", "| configuration | arithmetic |") {
        let core = of(&row[0]);
        let bound = core.contract.bound().units;
        let digits = row[4].split_once('.').map_or(0, |(_, digits)| digits.len());
        assert_eq!(
            row[3..5],
            [grouped(core.design.rom_bits()), format!("{bound:.digits$}")],
            "{}",
            row[0]
        );
        let worst = &json(&format!("proofs/worst/{}.json", row[0]))["units"];
        let said = row[5].split(' ').next().expect("an error");
        let digits = said.split_once('.').map_or(0, |(_, digits)| digits.len());
        let worst = worst.as_f64().expect("an error");
        assert_eq!(said, format!("{worst:.digits$}"), "{}", row[0]);
        let record = format!("proofs/{}.json", row[0]);
        if row[5].contains(&record) {
            let together = &json(&record)["configurations"][0]["together"];
            let found = format!("{:.3} in its record", together.as_f64().expect("an error"));
            assert!(row[5].contains(&found), "{row:?} without {found}");
        }
    }
}

/// Of a record of `glint mutate`: planted, caught by each test, proved equivalent, undecided.
fn faults(all: &Value) -> (u64, BTreeMap<String, u64>, u64, u64) {
    let each = |value: &Value| -> BTreeMap<String, u64> {
        let of = value.as_object().expect("an object").iter();
        of.map(|(name, count)| (name.clone(), number(count))).collect()
    };
    let equivalent = each(&all["equivalent"]).values().sum();
    (number(&all["planted"]), each(&all["caught"]), equivalent, number(&all["undecided"]))
}

/// The sums of a table of faults in netlists, each row of which is what its record says.
fn faults_by_record(head: &str) -> [u64; 5] {
    let share = |undecided: u64, planted: u64| {
        format!("{undecided} ({:.2} %)", 100.0 * undecided as f64 / planted as f64)
    };
    let mut sum = [0; 5];
    for row in table("docs/verification.md", head) {
        let [planted, default, rest, equivalent, undecided] = if row[0] == "all" {
            sum
        } else {
            let record = json(&format!("mutation/{}.json", row[0]));
            let (planted, caught, equivalent, undecided) = faults(&record["netlist"]["all"]);
            let default = caught.get("cosim").copied().unwrap_or(0);
            let rest = caught.values().sum::<u64>() - default;
            let counts = [planted, default, rest, equivalent, undecided];
            sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            counts
        };
        let expected = [planted, default, rest, equivalent].map(grouped);
        assert_eq!(row[1..5], expected, "{}", row[0]);
        assert_eq!(row[5], share(undecided, planted), "{}", row[0]);
    }
    sum
}

#[test]
fn faults_in_the_netlists() {
    let pipelines = faults_by_record("| pipeline | faults | default test |");
    assert!(pipelines[0] > 50_000, "{pipelines:?}");
    let [planted, default, rest, equivalent, undecided] =
        faults_by_record("| configuration | faults | default test |");
    let (planted, caught) = (planted, default + rest);
    let readme = read("README.md").replace('\n', " ");
    for said in [
        format!(
            "Of {} faults in the ten default configurations {} are caught",
            grouped(planted),
            grouped(caught)
        ),
        format!("{} proved equivalent and {} undecided", grouped(equivalent), grouped(undecided)),
        format!("({:.2} %)", 100.0 * undecided as f64 / planted as f64),
    ] {
        assert!(readme.contains(&said), "README.md does not say: {said}");
    }
}

/// Whose bench misses the goal for faults in the Verilog, as docs/verification.md says.
const SHORT_OF_GOAL: [&str; 1] = ["blinn"];

/// What the shipped bench notices in a netlist, of what any check notices; of the upper bits of ROM words, and of the faults
/// in the Verilog, no less than the goals, but for what is known to fall short.
#[test]
fn faults_that_shipped_benches_notice() {
    let cell = |noticed: u64, of: u64, reached: Option<(f64, bool)>| {
        let share = noticed as f64 / of as f64;
        if let Some((goal, reached)) = reached {
            assert_eq!(share >= goal, reached, "{noticed} of {of}");
        }
        format!("{} of {} ({:.1} %)", grouped(noticed), grouped(of), 100.0 * share)
    };
    let tallied = |tally: &Value, reached: Option<(f64, bool)>| {
        if tally.is_null() {
            "—".to_owned()
        } else {
            let [noticed, missed] = ["shipped", "missed"].map(|count| number(&tally[count]));
            cell(noticed, noticed + missed, reached)
        }
    };
    let rows = table("docs/verification.md", "| shipped bench | netlist |");
    let mut together = [0, 0];
    for row in &rows {
        let record = json(&format!("mutation/{}.json", row[0]));
        let netlist = &record["netlist"];
        assert_eq!(row[1], tallied(&netlist["all"], None), "{}", row[0]);
        let memory = tallied(&netlist["kinds"]["rom-high-bit"], Some((GOAL_MEMORY, true)));
        assert_eq!(row[2], memory, "{}", row[0]);
        let [noticed, of] =
            ["noticed", "of"].map(|count| number(&record["verilog"]["shipped"][count]));
        let reached = !SHORT_OF_GOAL.contains(&row[0].as_str());
        assert_eq!(row[3], cell(noticed, of, Some((GOAL_TEXT, reached))), "{}", row[0]);
        together = [together[0] + noticed, together[1] + of];
    }
    let together = cell(together[0], together[1], Some((GOAL_TEXT, true)));
    let text = read("docs/verification.md");
    assert!(
        text.contains(&format!("In the Verilog of all devices together {together}")),
        "{together}"
    );
    assert_eq!(rows.len(), Registry::catalogue().devices().len());
}

/// The lines of `glint verify` that come from records.
#[test]
fn what_verify_says_of_cosine_power() {
    let rows = table("README.md", "| check of `glint verify");
    let over = |check: &str| {
        let row = rows.iter().find(|row| row[0] == check);
        row.unwrap_or_else(|| panic!("no row {check}"))[2].clone()
    };
    let proof = &json("proofs/cosine_power.json")["configurations"][0];
    let [evaluations, products] =
        ["evaluations", "colour_products"].map(|key| grouped(number(&proof[key])));
    assert_eq!(
        over("golden model against the formula"),
        format!("{evaluations} evaluations of f and {products} colour products")
    );
    let (planted, caught, equivalent, undecided) =
        faults(&json("mutation/cosine_power.json")["netlist"]["all"]);
    let caught: u64 = caught.values().sum();
    let planted = grouped(planted);
    assert_eq!(
        over("faults in the netlist"),
        format!(
            "{planted} faults: {caught} caught, {equivalent} proved equivalent, {undecided} undecided"
        )
    );
    let certificates = fs::read_dir("proofs/certificates/cosine_power").expect("certificates");
    assert_eq!(
        over("the error bound, by Gappa"),
        format!("all operands: {} statements", certificates.count())
    );
}

/// Faults in the emitted text: planted, noticed by lint and by the bench, equivalent, undecided; and the share that is undecided
/// of all, those in the netlist too.
#[test]
fn faults_in_the_verilog() {
    let mut sum = [0; 7];
    for row in table("docs/verification.md", "| configuration | faults | lint |") {
        let counts = if row[0] == "all" {
            sum
        } else {
            let record = json(&format!("mutation/{}.json", row[0]));
            let (netlist, _, _, undecided) = faults(&record["netlist"]["all"]);
            let verilog = &record["verilog"];
            let [planted, lint, bench] =
                ["planted", "lint", "bench"].map(|key| number(&verilog[key]));
            let [equivalent, left] = ["equivalent", "undecided"]
                .map(|key| verilog[key].as_array().expect("a list").len() as u64);
            [planted, lint, bench, equivalent, left, planted + netlist, left + undecided]
        };
        if row[0] != "all" {
            sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
        let [planted, lint, bench, equivalent, left, all, undecided] = counts;
        assert_eq!(row[1..6], [planted, lint, bench, equivalent, left].map(grouped), "{}", row[0]);
        let share = format!("{:.2} %", 100.0 * undecided as f64 / all as f64);
        assert_eq!(row[6], share, "{}", row[0]);
    }
}
