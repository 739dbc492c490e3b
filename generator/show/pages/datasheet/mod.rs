//! Makes a configuration's datasheet: one HTML page, like a vendor's product guide, that needs no other file and no network.
//!
//! All content comes from the configuration, the netlist, the golden model, the contract, simulation, synthesis and records.

mod measured;
mod microprogram;
mod page;
mod table;
mod timing;
mod waves;

use anyhow::Result;

use crate::evidence::chart::Chart;
use crate::evidence::curves::{self, DeviceCurves};
use crate::evidence::domain;
use crate::evidence::hardware::{self, FamilyUsage, Synthesis};
use crate::figures;
use crate::render::{self, BACKGROUND, BuiltIn, Light, Material, Scene, Settings, View};
use glint_base::target::COMPARED;
use glint_core::core::Core;
use glint_core::cosim::batch::Golden;
use glint_core::cosim::exhaustive::{Backing, Record};
use glint_core::package::{HandshakeTiming, LineClocks, WorkedExample};
use waves::Waves;

/// The width and the height of a highlight's picture, in pixels.
const SIDE: u32 = 260;

/// The number of samples along each side of a pixel of the picture.
const SAMPLES: u32 = 2;

pub struct Subject<'a> {
    pub core: &'a Core,
    /// The path that the user gave. The page shows its label.
    pub path: &'a str,
    pub backing: Backing,
    pub proof: Option<Record>,
    pub figures: Option<figures::SynthesisRecord>,
    /// The tool that counts the core's cells if there is no record. With neither record nor tool, the page explains how to
    /// synthesise the core.
    pub synthesis: Option<&'a dyn Synthesis>,
}

pub struct Datasheet {
    /// The HTML page. Its last line has a digest of the lines above; see [`glint_core::package::is_sealed`].
    pub page: String,
    /// The timing diagram for WaveDrom.
    pub wavedrom: String,
}

/// The results for a page that need simulation, rendering, measurement or synthesis.
struct DatasheetResults {
    timing: HandshakeTiming,
    example: WorkedExample,
    line: Option<LineClocks>,
    waves: Waves,
    curves: DeviceCurves,
    /// The charts of a function of one operand; empty for all other devices.
    over_domain: Vec<Chart>,
    /// A highlight's picture; `None` if a scene cannot supply the device's operands.
    highlight: Option<HighlightPicture>,
    synthesis: Option<(String, Vec<FamilyUsage>)>,
}

/// A picture that the golden model computes, beside the picture with Blinn's function in f64 and their difference.
struct HighlightPicture {
    /// The picture of the golden model, the picture with Blinn's function in f64, and their difference, side by side as PNG.
    png: Vec<u8>,
    /// The picture of the golden model alone, as PNG.
    ball: Vec<u8>,
    exponent: u32,
    /// The peak signal-to-noise ratio in decibels; `None` if the pictures are equal.
    psnr: Option<f64>,
    /// The largest difference of a colour channel, from 0 to 255.
    largest: u8,
    gain: u8,
}

/// Returns the number of times that [`datasheet`] calls `done`. For example, without synthesis it is 26: 25 times for the curves
/// and once for the picture.
pub fn steps(synthesis: bool) -> usize {
    curves::STEPS + 1 + if synthesis { COMPARED.len() } else { 0 }
}

/// Makes the datasheet.
///
/// # Errors
///
/// Fails if a simulated computation of the device never ends, if synthesis fails, or if a picture or a chart cannot be drawn.
pub fn datasheet(subject: &Subject, done: &(dyn Fn() + Sync)) -> Result<Datasheet> {
    let core = subject.core;
    let contract = core.contract.as_ref();
    let synthesis = || -> Result<_> {
        let Some(synthesis) = subject.synthesis.filter(|_| subject.figures.is_none()) else {
            return Ok(None);
        };
        let usage = hardware::usage(core, synthesis, done)?;
        Ok(Some((synthesis.version()?, usage)))
    };
    let pictures = || -> Result<_> {
        let highlight = render::draws(core).then(|| highlight(core)).transpose()?;
        done();
        Ok((highlight, curves::configuration(core.device(), contract, done)))
    };
    let (synthesis, pictures) = rayon::join(synthesis, pictures);
    let (highlight, curves) = pictures?;
    let measured = DatasheetResults {
        timing: core.timing()?,
        example: core.example()?,
        line: core.line()?,
        waves: Waves::record(core)?,
        curves,
        over_domain: domain::charts(contract),
        highlight,
        synthesis: synthesis?,
    };
    Ok(Datasheet { page: page::page(subject, &measured)?, wavedrom: measured.waves.wavedrom()? })
}

/// Returns the timing diagram as an SVG file, and a description of the diagram in words.
///
/// # Errors
///
/// Fails if a simulated computation of the device never ends.
pub fn timing_diagram(core: &Core) -> Result<(String, String)> {
    let waves = Waves::record(core)?;
    Ok((timing::drawing(&waves).file()?, waves.described()))
}

/// Renders a ball in the two default lights, with the golden model and with Blinn's function.
fn highlight(core: &Core) -> Result<HighlightPicture> {
    let contract = core.contract.as_ref();
    let exponent = render::usual_exponent(contract);
    let settings = Settings {
        size: (SIDE, SIDE),
        samples: SAMPLES,
        view: View { eye: None, target: None, field: render::FIELD },
        material: Material::usual(exponent),
        background: BACKGROUND,
        compare: true,
        operands: Vec::new(),
    };
    let scene = Scene {
        objects: Scene::built_in(BuiltIn::Sphere, None, render::walks_lines(contract))?,
        lights: Light::usual(),
        relief: None,
    };
    let mut engine = Golden(core.contract.as_ref());
    let rendered = render::render(core, &mut engine, &scene, &settings, &mut |_| ())?;
    let difference = rendered.comparison.as_ref().map(|comparison| &comparison.difference);
    Ok(HighlightPicture {
        png: rendered.whole(core.device().name).png()?,
        ball: rendered.picture.png()?,
        exponent,
        psnr: difference.and_then(|difference| difference.psnr),
        largest: difference.map_or(0, |difference| difference.largest),
        gain: difference.map_or(1, |difference| difference.gain),
    })
}
