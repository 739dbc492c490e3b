//! Tests the datasheets of the configurations in `configs/` and `configs/studies/`; `tests/kinds.toml` says which of them a run
//! takes. The datasheets must be well-formed, need no other file, be usable without a pointer or
//! colours, and agree with the netlist, the manifest and the formula.

use std::collections::BTreeSet;
use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{configuration, configurations, pipelines};
use crate::common::files::json;
use crate::common::json::Json;
use crate::common::sample::sampled_by_name;
use glint::core::Core;
use glint::cosim::exhaustive::Record;
use glint::hdl::netlist::{Design, Driver, RegId, Role};
use glint::package::{Seal, is_sealed};
use glint::pages::account::blocks::Blocks;
use glint::pages::datasheet::{Datasheet, Subject, datasheet};
use glint::synth;
use roxmltree::{Document, Node, ParsingOptions};
use serde_json::Value;

fn make(path: &str, core: &Core) -> Datasheet {
    let digest = core.contract_digest();
    let proof = Record::find(Path::new("records/proofs"), &digest, core.contract.as_ref());
    let subject = Subject {
        core,
        path,
        backing: core.backing(Path::new("records/proofs")).sure_of(path),
        proof: proof.sure_of(path),
        figures: synth::SynthesisRecord::find(Path::new(synth::DIRECTORY), &core.core_digest())
            .sure_of(path),
        synthesis: None,
    };
    datasheet(&subject, &|| ()).sure_of(path)
}

/// Returns the pages are XML as well.
fn parse(page: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(page, options).sure()
}

fn elements<'a>(document: &'a Document, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    let all = document.descendants();
    all.filter(move |node| node.tag_name().name() == name)
}

fn text(node: Node) -> String {
    let texts = node.descendants().filter(|node| node.is_text());
    texts.filter_map(|node| node.text()).collect()
}

fn of_class<'a>(document: &'a Document, class: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| {
        let classes = node.attribute("class").unwrap_or_default();
        classes.split(' ').any(|other| other == class)
    })
}

#[test]
fn every_configuration_has_its_page() {
    for (path, core) in sampled_by_name("data sheets", configurations(), |(path, _)| path.clone()) {
        let made = make(&path, &core);
        let document = parse(&made.page);
        needs_nothing_else(&path, &made.page, &document);
        is_accessible(&path, &document);
        wires_are_clear(&path, &document);
        has_the_numbers_of_the_netlist(&path, &document, &core);
        has_the_arrows_of_the_blocks(&path, &document, &core.design);
        // Studies are not in the main job, which writes manifests.
        if !path.starts_with("configs/studies/") {
            has_the_clocks_of_the_manifest(&path, &made.wavedrom, &core);
        }
        has_every_word(&path, &document, &core);
        assert!(is_sealed(made.page.as_bytes(), Seal::Markup), "{path}");
    }
}

fn needs_nothing_else(path: &str, page: &str, document: &Document) {
    for load in ["http:", "https:", "url(", "@import", "file:"] {
        assert!(!page.contains(load), "{path}: `{load}`");
    }
    for name in ["script", "link", "iframe", "object", "base"] {
        assert_eq!(elements(document, name).count(), 0, "{path}: <{name}>");
    }
    for node in document.descendants() {
        for attribute in node.attributes() {
            let value = attribute.value();
            match attribute.name() {
                "src" => assert!(value.starts_with("data:image/png;"), "{path}: {value}"),
                "href" => assert!(
                    value.starts_with('#') || value.starts_with("data:application/json;"),
                    "{path}: {value}"
                ),
                name => assert!(!name.starts_with("on"), "{path}: {name}"),
            }
        }
    }
}

fn is_accessible(path: &str, document: &Document) {
    let mut ids = BTreeSet::new();
    for id in document.descendants().filter_map(|node| node.attribute("id")) {
        assert!(ids.insert(id), "{path}: `{id}` twice");
    }
    for node in document.descendants() {
        let references = ["aria-labelledby", "aria-describedby"];
        let references = references.iter().filter_map(|&name| node.attribute(name));
        for id in references.flat_map(|value| value.split(' ')) {
            assert!(ids.contains(id), "{path}: no `{id}`");
        }
        if let Some(id) = node.attribute("href").and_then(|it| it.strip_prefix('#')) {
            assert!(ids.contains(id), "{path}: no `{id}`");
        }
        if node.attribute("class") == Some("scroll") {
            let usable = node.attribute("tabindex").is_some() && node.attribute("role").is_some();
            assert!(usable && node.attribute("aria-label").is_some(), "{path}: a scroller");
        }
    }
    for figure in elements(document, "figure") {
        let has = |name| figure.descendants().any(|node| node.has_tag_name(name));
        let named = |node: &Node| node.tag_name().name() == "figcaption";
        assert!(figure.descendants().any(|node| named(&node)), "{path}: a figure without caption");
        assert!(has("svg") || has("img"), "{path}: a figure without picture");
    }
    for picture in elements(document, "svg") {
        let hidden = picture.attribute("aria-hidden") == Some("true");
        let named = picture.attribute("role") == Some("img")
            && picture.attribute("aria-labelledby").is_some();
        assert!(hidden || named, "{path}: a picture without a name");
    }
    for heading in elements(document, "th") {
        assert!(heading.attribute("scope").is_some(), "{path}: {}", text(heading));
    }
    // No level is left out.
    let mut level = 0;
    for node in document.descendants() {
        if let Some(digit) = node.tag_name().name().strip_prefix('h')
            && let Ok(found) = digit.parse::<u32>()
        {
            assert!(found <= level + 1, "{path}: h{found} after h{level}");
            level = found;
        }
    }
    assert_eq!(elements(document, "h1").count(), 1, "{path}");
    let language = document.root_element().attribute("lang");
    assert_eq!(language, Some("en"), "{path}");
}

fn diagram<'a>(document: &'a Document) -> Node<'a, 'a> {
    let mut pictures = elements(document, "svg").filter(|svg| {
        let label = svg.attribute("aria-labelledby").unwrap_or_default();
        label.starts_with("block-diagram")
    });
    pictures.next().expect("a block diagram")
}

type Point = (i32, i32);

/// Returns the corners of a path of absolute lines.
fn corners(path: &str) -> Vec<Point> {
    let mut corners: Vec<Point> = Vec::new();
    let (mut x, mut y) = (0, 0);
    let mut rest = path.trim_end_matches('Z');
    while let Some(command) = rest.chars().next() {
        let end = rest[1..].find(|sign: char| sign.is_ascii_uppercase());
        let end = end.map_or(rest.len(), |end| end + 1);
        let mut numbers = rest[1..end].split(' ').map(|it| it.parse().expect("a number"));
        let mut number = || numbers.next().expect("a number");
        match command {
            'H' => x = number(),
            'V' => y = number(),
            _ => (x, y) = (number(), number()),
        }
        corners.push((x, y));
        rest = &rest[end..];
    }
    corners
}

/// No wire runs through a box or upon a wire of another net, and no box lies on another.
fn wires_are_clear(path: &str, document: &Document) {
    let mut boxes: Vec<(Point, Point)> = Vec::new();
    let mut pieces: Vec<(usize, Point, Point)> = Vec::new();
    let groups = diagram(document).children().filter(Node::is_element);
    for (net, group) in groups.enumerate() {
        let shape = |class: &str| {
            let mut paths = group.children().filter(Node::is_element);
            let found = paths.find(|node| {
                let classes = node.attribute("class").unwrap_or_default();
                classes.split(' ').next() == Some(class)
            });
            found.and_then(|node| node.attribute("d")).map(corners)
        };
        match group.attribute("class") {
            Some("net") => {
                let corners = shape("wire").expect("a wire");
                let ends = corners.chunks(2);
                pieces.extend(ends.map(|ends| (net, ends[0].min(ends[1]), ends[0].max(ends[1]))));
            }
            Some("block") => {
                let corners = shape("box").expect("a box");
                let low = |of: fn(&Point) -> i32| corners.iter().map(of).min().unwrap_or(0);
                let high = |of: fn(&Point) -> i32| corners.iter().map(of).max().unwrap_or(0);
                boxes.push(((low(|p| p.0), low(|p| p.1)), (high(|p| p.0), high(|p| p.1))));
            }
            _ => {}
        }
    }
    assert!(boxes.len() > 5 && pieces.len() > 5, "{path}");
    let clear = |a: (Point, Point), b: (Point, Point)| {
        a.1.0 <= b.0.0 || b.1.0 <= a.0.0 || a.1.1 <= b.0.1 || b.1.1 <= a.0.1
    };
    for (at, &one) in boxes.iter().enumerate() {
        for &other in &boxes[..at] {
            assert!(clear(one, other), "{path}: {one:?} on {other:?}");
        }
        for &(_, from, to) in &pieces {
            let through = from.0 < one.1.0 && one.0.0 < to.0 && one.0.1 < to.1 && from.1 < one.1.1;
            assert!(!through, "{path}: {from:?} to {to:?} through {one:?}");
        }
    }
    for (at, &(net, from, to)) in pieces.iter().enumerate() {
        assert!(from.0 == to.0 || from.1 == to.1, "{path}: {from:?} to {to:?} is slanted");
        for &(other, start, end) in &pieces[..at] {
            let shared =
                (to.0.min(end.0) - from.0.max(start.0), to.1.min(end.1) - from.1.max(start.1));
            let upon = shared.0 >= 0 && shared.1 >= 0 && shared != (0, 0);
            assert!(net == other || !upon, "{path}: {from:?} to {to:?} upon {start:?} to {end:?}");
        }
    }
}

/// Returns the numbers that stand in the diagram.
fn drawn(document: &Document) -> BTreeSet<u16> {
    let texts = diagram(document).descendants().filter(|node| node.tag_name().name() == "text");
    // The value of a constant is no number of a block.
    let texts = texts.filter(|node| {
        let title = node.parent().and_then(|it| it.children().find_map(|it| it.text()));
        !title.is_some_and(|title| title.starts_with("the constant "))
    });
    let numbers = texts.flat_map(|node| {
        let text = text(node);
        let class = node.attribute("class").unwrap_or_default();
        let words = text.split(' ').map(str::to_owned);
        // Control lines may be several; a block has its number before its name.
        let count = match class {
            "control-lines" => usize::MAX,
            "tick small" => 0,
            _ => 1,
        };
        let numbers = words.map_while(|word| word.parse().ok()).take(count);
        numbers.collect::<Vec<u16>>()
    });
    numbers.collect()
}

fn has_the_numbers_of_the_netlist(path: &str, document: &Document, core: &Core) {
    let design = &core.design;
    let nets = design.nets.iter().filter_map(|net| net.block);
    let roms = design.roms.iter().filter_map(|rom| rom.block);
    let lines = design.control.fields.iter().flat_map(|field| field.lines.iter().copied());
    let blocks: BTreeSet<u16> = nets.chain(roms).collect();
    let known: BTreeSet<u16> = blocks.iter().copied().chain(lines).collect();
    let drawn = drawn(document);
    assert!(drawn.is_subset(&known), "{path}: {drawn:?}, {known:?}");
    let missing: Vec<&u16> = blocks.difference(&drawn).collect();
    assert!(missing.is_empty(), "{path}: not drawn: {missing:?}");
}

/// Every block has its box, and an arrow for each number that it takes.
fn has_the_arrows_of_the_blocks(path: &str, document: &Document, design: &Design) {
    let diagram = diagram(document);
    let groups = |class: &'static str| {
        let groups = diagram.children().filter(move |node| node.attribute("class") == Some(class));
        groups.map(|group| {
            let paths = group.children().filter_map(|node| {
                Some((node.attribute("class")?.split(' ').next()?, node.attribute("d")?))
            });
            (
                group.children().find_map(|node| node.text()).unwrap_or_default(),
                Vec::from_iter(paths),
            )
        })
    };
    let arrows = groups("net").flat_map(|(_, paths)| paths).filter(|(class, _)| *class == "arrow");
    let tips: Vec<Point> = arrows
        .flat_map(|(_, d)| d.split('M'))
        .filter_map(|arrow| corners(&format!("M{}", arrow.split_once("l-3")?.0)).pop())
        .collect();
    let mut drawn: Vec<(String, usize)> = groups("block")
        .map(|(title, paths)| {
            let outline = paths.iter().find(|(class, _)| *class == "box").expect("a box").1;
            let corners = corners(outline);
            let (left, top) = corners[0];
            let right = corners.iter().map(|it| it.0).max().unwrap_or(left);
            let into = tips.iter().filter(|(x, y)| *y == top && (left..=right).contains(x));
            (title.split(", ").next().unwrap_or_default().to_owned(), into.count())
        })
        .filter(|(title, _)| title.contains(" ("))
        .collect();
    let blocks = Blocks::new(design, true).all().into_iter();
    let mut expected: Vec<(String, usize)> = blocks
        .map(|block| {
            // Fields and strobes stand beside the block.
            let strobe =
                |net| design.ports.iter().any(|it| it.net == net && it.role == Role::Strobe);
            let beside = |net| strobe(net) || matches!(design.net(net).driver, Driver::Field(_));
            let selects = block.selected_by.iter().filter(|it| !beside(**it));
            let taken = block.inputs.len() + selects.count();
            let title = format!("{} ({})", block.name, block.kind);
            (title.split(", ").next().unwrap_or_default().to_owned(), taken)
        })
        .collect();
    drawn.sort();
    expected.sort();
    assert_eq!(drawn, expected, "{path}");
}

/// Finds the wave of a signal.
fn waves(wavedrom: &str) -> impl Fn(&str) -> String {
    let waves: Value = serde_json::from_str(wavedrom).expect("JSON");
    move |signal| waves["signal"].of("name", signal)["wave"].text().to_owned()
}

fn has_the_clocks_of_the_manifest(path: &str, wavedrom: &str, core: &Core) {
    let name = &core.config().name;
    let manifest = json(format!("rtl_out/{name}/{name}.json"));
    let wave = waves(wavedrom);
    assert!(wave("start").starts_with("10"), "{path}: {}", wave("start"));
    assert!(wave("busy").starts_with("01"), "{path}: {}", wave("busy"));
    for (signal, event) in [("valid", "start_to_valid"), ("done", "start_to_done")] {
        // Beyond a gap places are no clocks.
        let wave = wave(signal);
        let shown = wave.split('|').next().and_then(|head| head.find('1'));
        if let (Some(clock), Some(expected)) = (shown, manifest["timing"][event].as_u64()) {
            assert_eq!(clock as u64, expected, "{path}: {signal}");
        }
    }
}

fn has_every_word(path: &str, document: &Document, core: &Core) {
    let control = &core.design.control;
    let width = core.design.width(core.design.rom(control.rom).data);
    let bits: String = of_class(document, "bit").map(text).collect();
    let words = &core.design.rom(control.rom).words;
    let expected: String = words[..control.microprogram.len()]
        .iter()
        .map(|word| format!("{word:0width$b}", width = width as usize))
        .collect();
    assert_eq!(bits, expected, "{path}");
}

/// Returns the cells of a table, row by row, the heading among them.
fn rows(document: &Document, label: &str) -> Vec<Vec<String>> {
    let mut tables = elements(document, "div");
    let table = tables.find(|div| div.attribute("aria-label") == Some(label)).expect("a table");
    let rows = table.descendants().filter(|node| node.tag_name().name() == "tr");
    rows.map(|row| row.children().filter(Node::is_element).map(text).collect()).collect()
}

/// The figures of `records/synthesis/cosine_power.json` for ECP5, over eight clocks a point.
#[test]
fn area_and_speed_are_those_of_the_record() {
    let path = "configs/cosine_power.toml";
    let page = make(path, &configuration(path)).page;
    let document = parse(&page);
    let rows = rows(&document, "Area and speed");
    let row = rows.iter().find(|row| row[0].starts_with("ECP5")).expect("ECP5");
    let record = json("records/synthesis/cosine_power.json");
    let ecp5 = record["targets"].of("target", "ecp5");
    let counts =
        ["luts", "dsps", "block_rams", "flip_flops"].map(|it| ecp5["area"][it].to_string());
    assert_eq!(row[1..5], counts);
    let median = ecp5["frequency"]["median"].number();
    assert!(row[6].starts_with(&format!("{median:.1} (")), "{row:?}");
    let points = median / 8.0;
    let luts = ecp5["area"]["luts"].number();
    assert_eq!(row[7..9], [format!("{points:.1}"), format!("{:.1}", 1000.0 * points / luts)]);
    for step in ecp5["critical_path"].list() {
        assert!(page.contains(step["name"].text()), "{step}");
    }
}

#[test]
fn every_pipeline_has_its_page() {
    let path_of = |(path, _): &(String, Core)| path.clone();
    for (path, core) in sampled_by_name("data sheets of pipelines", pipelines(), path_of) {
        let made = make(&path, &core);
        let document = parse(&made.page);
        needs_nothing_else(&path, &made.page, &document);
        is_accessible(&path, &document);
        assert!(is_sealed(made.page.as_bytes(), Seal::Markup), "{path}");
        assert!(!made.page.contains("<code>start</code>"), "{path}");
        let name = &core.config().name;
        let files = core.verilog().expect("Verilog");
        let (_, verilog) = files.iter().find(|it| it.0 == format!("{name}.v")).expect("a module");
        wires_are_clear(&path, &document);
        has_the_arrows_of_the_blocks(&path, &document, &core.design);
        has_the_values_of_the_stages(&path, &document, &core);
        let interval = core.design.pipeline.as_ref().map_or(1, |pipeline| pipeline.interval);
        has_the_latency_of_the_header(&path, &made.wavedrom, verilog, interval);
    }
}

/// Every value of an operator that a register of the sequential core has stands in the drawing, and the registers of every stage.
fn has_the_values_of_the_stages(path: &str, document: &Document, core: &Core) {
    let picture = diagram(document);
    let drawn: String = picture.descendants().filter_map(|node| node.text()).collect();
    let pipeline = core.design.pipeline.as_ref().expect("a pipeline");
    for checkpoint in &pipeline.checkpoints {
        let name = &core.design.net(checkpoint.net).name;
        let value = name.rsplit_once("_s").map_or(name.as_str(), |(value, _)| value);
        // Gates that one signal goes through are no box.
        let op = match &core.design.net(checkpoint.net).driver {
            Driver::Op(op) => op.mnemonic(),
            _ => "",
        };
        if ["add", "sub", "mul", "mux"].contains(&op) {
            assert!(drawn.contains(value), "{path}: `{name}` is not drawn");
        }
    }
    let bits = pipeline.stages.iter().map(|stage| stage.register_bits + stage.delayed_bits);
    let bits: u32 = bits.sum();
    // Those in multipliers are no bits of a stage.
    let registers = (0..).map(RegId).zip(&core.design.registers);
    let registers = registers.filter(|(id, _)| core.design.multiplier(*id).is_none());
    let widths = registers.map(|(_, register)| core.design.width(register.q));
    assert_eq!(bits, widths.sum::<u32>(), "{path}");
    let stages = picture.children().filter(|node| node.attribute("class") == Some("stage"));
    let said: Vec<String> = stages.map(text).collect();
    assert_eq!(said.len(), pipeline.stages.len(), "{path}");
    for (stage, said) in pipeline.stages.iter().zip(&said) {
        assert!(said.contains(&format!("{} register bits", stage.register_bits)), "{path}: {said}");
        let delayed = format!("{} in delay lines", stage.delayed_bits);
        assert_eq!(said.contains(&delayed), stage.delayed_bits > 0, "{path}: {said}");
    }
}

fn has_the_latency_of_the_header(path: &str, wavedrom: &str, verilog: &str, interval: usize) {
    let header = verilog.lines().map_while(|line| line.strip_prefix("//"));
    let header: String = header.collect();
    let (before, _) = header.split_once(" clocks later").expect("the latency");
    let latency: usize =
        before.rsplit(' ').next().and_then(|it| it.parse().ok()).expect("a number");
    let wave = waves(wavedrom);
    // Two points, a bubble and a point; nothing after them. With a longer interval, a point waits until it is taken.
    let two_points = wave("in_valid").starts_with("1.010");
    assert_eq!(two_points, interval == 1, "{path}: {}", wave("in_valid"));
    assert!(wave("in_valid").starts_with('1'), "{path}");
    assert_eq!(wave("out_valid").find('1'), Some(latency), "{path}");
    // The first result waits for two clocks, and in_ready follows.
    let waits = format!("{}0.1", wave("out_ready").split('0').next().unwrap_or_default());
    assert!(wave("out_ready").starts_with(&waits), "{path}: {}", wave("out_ready"));
    assert_eq!(wave("out_ready").find('0'), Some(latency), "{path}");
    if interval == 1 {
        assert_eq!(wave("in_ready"), wave("out_ready"), "{path}");
    } else {
        // A point is taken in slot 0 alone, and the next one an interval later.
        let ready: Vec<usize> = wave("in_ready").match_indices('1').map(|it| it.0).collect();
        assert_eq!(ready[..2], [0, interval], "{path}: {}", wave("in_ready"));
    }
}

#[test]
fn the_same_bytes_twice() {
    let path = "configs/quad_cosine.toml";
    let core = configuration(path);
    let (first, second) = (make(path, &core), make(path, &core));
    assert_eq!(first.page, second.page);
    assert_eq!(first.wavedrom, second.wavedrom);
}

/// Returns the worked example of a page: port, integer, value.
fn example(path: &str) -> Vec<(String, i64, f64)> {
    let core = configuration(path);
    let page = make(path, &core).page;
    let document = parse(&page);
    let rows = rows(&document, "A worked example");
    rows[1..]
        .iter()
        .map(|cells| {
            let integer = cells[1].parse().unwrap_or_else(|_| panic!("{path}: {cells:?}"));
            let value = cells[2].parse().unwrap_or_else(|_| panic!("{path}: {cells:?}"));
            (cells[0].clone(), integer, value)
        })
        .collect()
}

/// Outputs within a unit of colour times f, at the operands that the page shows; cosines have 20 fraction bits.
fn agrees(path: &str, formula: impl Fn(&dyn Fn(&str) -> f64) -> f64) {
    let rows = example(path);
    let raw = |name: &str| {
        let row = rows.iter().find(|row| row.0 == name);
        row.unwrap_or_else(|| panic!("{path}: no `{name}`")).1 as f64
    };
    let f = formula(&raw);
    assert!((0.1..0.9).contains(&f), "{path}: f = {f} shows nothing");
    for colour in ["red", "green", "blue"] {
        let (out, right) = (raw(&format!("{colour}_out")), raw(colour) * f);
        assert!((out - right).abs() < 1.0, "{path}: {out} for {right}");
    }
    for (name, integer, value) in &rows {
        let fraction = if name.starts_with("cos_") { 20 } else { 0 };
        let right = *integer as f64 / f64::from(1 << fraction);
        assert!((value - right).abs() < 1e-6, "{path}: {name}");
    }
}

#[test]
fn worked_examples_agree_with_the_formulas() {
    const ONE: f64 = (1 << 20) as f64;
    agrees("configs/cosine_power.toml", |raw| {
        let (c, n) = (raw("cos_gamma") / ONE, raw("exponent"));
        (n / 16.0 * (c - 1.0) + 1.0).max(0.0).powi(16)
    });
    agrees("configs/schlick.toml", |raw| {
        let (c, n) = (raw("cos_gamma") / ONE, raw("exponent"));
        c / (n - n * c + c)
    });
    agrees("configs/blinn.toml", |raw| (raw("cos_gamma") / ONE).powf(raw("exponent")));
    agrees("configs/rough.toml", |raw| {
        let (gamma, deviation) = (raw("cos_gamma") / ONE, raw("cos_dgamma") / ONE);
        let sign = if raw("dgamma_negative") == 1.0 { -1.0 } else { 1.0 };
        let c = (gamma.acos() + sign * deviation.acos()).cos();
        (raw("exponent") / 2.0 * (c - 1.0) + 1.0).max(0.0).powi(2)
    });
}
