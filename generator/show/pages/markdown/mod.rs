//! Writes the documentation page of a configuration in Markdown: ports, timing, microprogram, accuracy and more.

mod prose;

use anyhow::Result;

use super::account::{self, PageInputs};
use super::stages;
use glint_core::package::seal::{Seal, sealed};
use glint_rtl::netlist::Design;
use prose::{prose, table};

#[glint_base::template::template("page.md")]
struct Page<'a> {
    title: String,
    device: &'a str,
    name: &'a str,
    formula: &'a str,
    source: String,
    notes: Vec<String>,
    ports: String,
    numbering: &'static str,
    program: ControlTables,
    roms: String,
    clocks: String,
    accuracy: String,
    terms: String,
    parts: Option<String>,
    limit: String,
    proof: String,
    domain: String,
    remarks: Vec<String>,
    example: String,
    keys: String,
    config: &'a str,
}

enum ControlTables {
    /// The tables of a sequential core. `writes` says what happens to operands that the user writes while the device is busy.
    Microprogram {
        blocks: String,
        fields: String,
        microprogram: String,
        writes: &'static str,
    },
    Pipeline {
        stages: String,
        reservations: Option<String>,
        handshake: &'static str,
    },
}

impl ControlTables {
    fn new(design: &Design) -> Self {
        match &design.pipeline {
            None => Self::Microprogram {
                blocks: table(&account::blocks::table(design)),
                fields: table(&account::fields(design)),
                microprogram: table(&account::microprogram(design)),
                writes: if design.control.overlaps { "for the next one" } else { "ignored" },
            },
            Some(pipeline) => Self::Pipeline {
                stages: table(&stages::table(design, pipeline)),
                reservations: stages::reservations(pipeline).map(|it| table(&it)),
                handshake: account::handshake(pipeline),
            },
        }
    }
}

/// Returns the page, which ends with a newline.
pub fn page(design: &Design, inputs: &PageInputs) -> Result<String> {
    let about = &design.about;
    let bound = inputs.contract.bounds();
    let text = glint_base::template::render(&Page {
        title: prose(&about.title),
        device: &about.device,
        name: &design.name,
        formula: &about.formula,
        source: prose(&about.source),
        notes: about.paragraphs().map(prose).collect(),
        ports: table(&account::ports(design)),
        numbering: account::numbering(design),
        program: ControlTables::new(design),
        roms: if design.roms.is_empty() {
            String::new()
        } else {
            table(&account::roms(design, inputs.config))
        },
        clocks: table(&match &design.pipeline {
            None => account::clocks(inputs.timing, inputs.line, design),
            Some(pipeline) => account::pipeline_clocks(pipeline),
        }),
        accuracy: account::accuracy(inputs.contract, inputs.backing),
        terms: table(&account::terms(&bound)),
        parts: account::parts(inputs.contract).map(|parts| table(&parts)),
        limit: prose(&account::limit(inputs)),
        proof: prose(&account::proof(inputs)),
        domain: table(&account::domain(design, inputs.contract)),
        remarks: inputs
            .contract
            .remarks()
            .iter()
            .map(|remark| format!("Remark: {}.", prose(remark)))
            .collect(),
        example: table(&account::example(inputs.contract, inputs.example)),
        keys: table(&account::keys(inputs.schema, inputs.config)),
        config: inputs.path,
    })?;
    Ok(sealed(text, Seal::Markup))
}
