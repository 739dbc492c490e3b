//! Collects the facts that a datasheet shows, and prints them with a template as an HTML page.

use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glint_base::template::Template;

use super::measured::{self, RecordView};
use super::microprogram::Microprogram;
use super::table::TableView;
use super::{DatasheetResults, Subject, timing};
use crate::evidence::advice;
use crate::evidence::chart::Chart;
use crate::evidence::comparison::{self, MultiplierSize};
use crate::evidence::hardware::FamilyUsage;
use crate::pages::account::{self, PageInputs, blocks, short};
use crate::pages::diagram;
use crate::pages::figure::{Figure, figures};
use crate::pages::formula;
use crate::pages::markup::html;
use crate::pages::stages;
use glint_base::target::FAMILIES;
use glint_base::{input, text};
use glint_core::package::{self, HandshakeTiming, InstanceExample, Seal};
use glint_rtl::netlist::Design;

#[glint_base::template::template("datasheet.html")]
struct Page<'a> {
    version: &'static str,
    design: &'a Design,
    path: &'a str,
    title: String,
    formula: String,
    source: String,
    notes: Vec<String>,
    glance: Vec<(&'static str, String)>,
    diagram: String,
    formats: String,
    ports: TableView,
    domain: TableView,
    example: TableView,
    program: ControlSection,
    roms: Option<TableView>,
    clocks: TableView,
    throughput: String,
    timing: String,
    wavedrom: String,
    wavedrom_link: String,
    accuracy: String,
    terms: TableView,
    parts: Option<TableView>,
    limit: String,
    sweep: String,
    proof: Option<ProofView>,
    remarks: Vec<String>,
    figures: Vec<Figure<'a>>,
    over_domain: bool,
    highlight: Option<HighlightView>,
    record: Option<RecordView>,
    synthesis: Option<&'a (String, Vec<FamilyUsage>)>,
    instances: Vec<InstanceExample>,
    keys: TableView,
    toml: String,
}

enum ControlSection {
    Microprogram {
        microprogram: Microprogram,
        fields: TableView,
        numbering: &'static str,
        blocks: TableView,
    },
    Pipeline {
        stages: TableView,
        reservations: Option<TableView>,
        handshake: String,
    },
}

impl ControlSection {
    fn new(design: &Design) -> Self {
        match &design.pipeline {
            None => Self::Microprogram {
                microprogram: Microprogram::new(design),
                fields: TableView::new("Fields of the control word", &account::fields(design)),
                numbering: account::numbering(design),
                blocks: TableView::new("Blocks", &blocks::table(design)),
            },
            Some(pipeline) => Self::Pipeline {
                stages: TableView::new("Stages", &stages::table(design, pipeline)),
                reservations: stages::reservations(pipeline)
                    .map(|table| TableView::new("Shared multipliers", &table)),
                handshake: html(account::handshake(pipeline)),
            },
        }
    }
}

struct ProofView {
    holds: bool,
    evaluations: String,
    /// The number of colour products; `None` if nothing multiplies colours.
    products: Option<String>,
    /// The largest errors that the check found, in words.
    found: String,
}

struct HighlightView {
    data: String,
    ball: String,
    exponent: u32,
    likeness: String,
    gain: u8,
}

/// Prints the page. Fails if a chart cannot be plotted, or if a template cannot be printed.
pub fn page(subject: &Subject, measured: &DatasheetResults) -> Result<String> {
    let core = subject.core;
    let path = &input::label(subject.path);
    let design = &core.design;
    let about = &design.about;
    let contract = core.contract.as_ref();
    let schema = (core.device().schema)();
    let bound = contract.bounds();
    let inputs = PageInputs {
        path,
        config: core.config(),
        schema: &schema,
        contract,
        backing: &subject.backing,
        advice: advice::of(core),
        timing: &measured.timing,
        example: &measured.example,
        line: measured.line.as_ref(),
    };
    let charts = measured.curves.charts.iter().chain(&measured.over_domain);
    let charts: Vec<(&Chart, &str)> = charts.map(|it| (it, "")).collect();
    let wavedrom = measured.waves.wavedrom()?;
    let page = Page {
        version: env!("CARGO_PKG_VERSION"),
        design,
        path,
        title: html(&about.title),
        formula: formula::typeset(&about.formula),
        source: html(&about.source),
        notes: about.paragraphs().map(html).collect(),
        glance: glance(subject, measured),
        diagram: diagram::drawing(design).svg()?,
        formats: html(account::FORMATS),
        ports: TableView::new("Ports", &account::ports(design)),
        domain: TableView::new("Domain of the operands", &account::domain(design, contract)),
        example: TableView::new("A worked example", &account::example(contract, &measured.example)),
        program: ControlSection::new(design),
        roms: (!design.roms.is_empty())
            .then(|| TableView::new("ROMs", &account::roms(design, core.config()))),
        clocks: TableView::new(
            "Clocks",
            &match &design.pipeline {
                None => account::clocks(&measured.timing, measured.line.as_ref(), design),
                Some(pipeline) => account::pipeline_clocks(pipeline),
            },
        ),
        throughput: throughput(subject, &measured.timing),
        timing: timing::drawing(&measured.waves).svg()?,
        wavedrom_link: format!("data:application/json;base64,{}", STANDARD.encode(&wavedrom)),
        wavedrom,
        accuracy: html(&account::accuracy(contract, &subject.backing)),
        terms: TableView::new("Terms of the bound", &account::terms(&bound)),
        parts: account::parts(contract)
            .map(|table| TableView::new("Parts of the computation", &table)),
        limit: html(&account::limit(&inputs)),
        sweep: html(&account::proof(&inputs)),
        proof: subject.proof.as_ref().map(|proof| ProofView {
            holds: proof.holds,
            evaluations: grouped(proof.evaluations),
            products: (proof.colour_products > 0).then(|| grouped(proof.colour_products)),
            found: proof.words(contract),
        }),
        remarks: contract.remarks().iter().map(|it| html(it)).collect(),
        figures: figures(&charts)?,
        over_domain: !measured.over_domain.is_empty(),
        highlight: measured.highlight.as_ref().map(|highlight| HighlightView {
            data: STANDARD.encode(&highlight.png),
            ball: STANDARD.encode(&highlight.ball),
            exponent: highlight.exponent,
            likeness: match highlight.psnr {
                Some(psnr) => format!(
                    "The largest difference is {} of 255, PSNR {psnr:.1} dB over what is lit",
                    highlight.largest
                ),
                None => "The two are the same".to_owned(),
            },
            gain: highlight.gain,
        }),
        record: subject.figures.as_ref().map(|record| RecordView::new(record, target(design))),
        synthesis: measured.synthesis.as_ref(),
        instances: core.instances()?,
        keys: TableView::new("Keys of the configuration", &account::keys(&schema, core.config())),
        toml: core.config().to_toml(&schema),
    };
    let mut text = page.render()?;
    text.push('\n');
    Ok(package::sealed(text, Seal::Markup))
}

/// Returns the summary's rows: a quantity's name, and its value with the unit.
fn glance(subject: &Subject, measured: &DatasheetResults) -> Vec<(&'static str, String)> {
    let design = &subject.core.design;
    let contract = subject.core.contract.as_ref();
    let clocks = |clocks: Option<u32>| clocks.map_or("by data".to_owned(), |it| it.to_string());
    let timing = &measured.timing;
    let outputs = contract.outputs().len();
    let registers = design.registers.iter();
    let flip_flops: u32 = registers.map(|register| design.width(register.q)).sum();
    let delayed: u32 = match &design.pipeline {
        None => 0,
        Some(pipeline) => pipeline.stages.iter().map(|stage| stage.delayed_bits).sum(),
    };
    let register_bits = match delayed {
        0 => flip_flops.to_string(),
        _ => format!("{}, and {delayed} in delay lines", flip_flops - delayed),
    };
    let bound = contract.bounds();
    let error = if bound.are_stated() {
        format!("{} units, {}", bound.words(), subject.backing)
    } else {
        "no bound is stated".to_owned()
    };
    let mut glance = vec![
        ("Largest error of an output", error),
        ("Outputs", outputs.to_string()),
        match &design.pipeline {
            None => ("Clocks, start to valid", clocks(timing.start_to_valid)),
            Some(pipeline) => ("Latency in clocks", pipeline.stages.len().to_string()),
        },
        ("Clocks a point", clocks(timing.clocks_per_point())),
        match &design.pipeline {
            None => ("Microinstructions", design.control.microprogram.len().to_string()),
            Some(pipeline) => {
                let clock = format!("{} MHz on {}", short(pipeline.clock_mhz), pipeline.target);
                ("Stages made for", clock)
            }
        },
        ("ROM", format!("{} bits", grouped(design.rom_bits()))),
        ("Register bits", register_bits),
        ("Multipliers", multipliers(design)),
    ];
    if let Some(highlight) = contract.highlight() {
        glance.insert(1, ("Word f", highlight.f_format().to_string()));
    }
    if let Some(rate) = rate(subject) {
        glance.push(("Points a second", rate));
    }
    if let Some((_, usage)) = &measured.synthesis
        && let Some(usage) = first_usage(usage, target(design))
    {
        glance.push((
            "LUTs, DSPs, block RAMs",
            format!("{}, {}, {} ({})", usage.luts, usage.dsps, usage.block_rams, usage.family),
        ));
    }
    glance
}

fn target(design: &Design) -> Option<&str> {
    design.pipeline.as_ref().map(|pipeline| pipeline.target.as_str())
}

/// Returns the cells on the FPGA family `target` if they are known, and otherwise on the first family.
fn first_usage<'u>(usage: &'u [FamilyUsage], target: Option<&str>) -> Option<&'u FamilyUsage> {
    let family = FAMILIES.iter().find(|family| Some(family.name()) == target);
    let on_target = usage.iter().find(|it| family.is_some_and(|own| own.title == it.family));
    on_target.or_else(|| usage.first())
}

/// Returns the number of multipliers of each size, the largest size first, for example `21 × 10, 3 of 10 × 8`, or `none`.
fn multipliers(design: &Design) -> String {
    let all = comparison::multipliers(design);
    let sizes = all.chunk_by(|a, b| a == b).map(|alike| {
        let MultiplierSize { first, second } = alike[0];
        match alike.len() {
            1 => format!("{first}\u{a0}×\u{a0}{second}"),
            count => format!("{count}\u{a0}of {first}\u{a0}×\u{a0}{second}"),
        }
    });
    match sizes.collect::<Vec<_>>()[..] {
        [] => "none".to_owned(),
        ref sizes => sizes.join(", "),
    }
}

/// Returns the points per second as text, or `None` if no frequency was measured.
fn rate(subject: &Subject) -> Option<String> {
    let target = target(&subject.core.design);
    let (figures, frequency, rate) = measured::leading(subject.figures.as_ref()?, target)?;
    Some(format!("{:.1} million at {:.1} MHz ({})", rate.points, frequency.median, figures.device))
}

fn throughput(subject: &Subject, timing: &HandshakeTiming) -> String {
    let often = match timing.clocks_per_point() {
        Some(1) => "A point takes a clock".to_owned(),
        Some(clocks) => format!("Back to back a point takes {clocks} clocks"),
        None => return "How many clocks a point takes depends on its operands.".to_owned(),
    };
    let made = subject.core.design.pipeline.as_ref().map(|pipeline| short(pipeline.clock_mhz));
    match (rate(subject), made) {
        (Some(rate), Some(made)) => {
            format!(
                "{often}. The stages are made for {made} MHz; points a second, as measured below: {rate}."
            )
        }
        (Some(rate), None) => format!("{often}; points a second, as measured below: {rate}."),
        (None, Some(made)) => {
            let pipeline = subject.core.design.pipeline.as_ref();
            let points = pipeline.map_or(0.0, |it| it.clock_mhz / it.interval as f64);
            let points = short(points);
            format!(
                "{often}: {points} million a second at {made} MHz, which the stages are made for."
            )
        }
        (None, None) => format!("{often}."),
    }
}

fn grouped(number: u64) -> String {
    text::grouped(number).replace(' ', "\u{202f}")
}
