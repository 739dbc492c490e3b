//! A device of your own: Schlick's approximation of the Fresnel factor.
//!
//! Glint knows the devices of its catalogue. This program knows one that is not there, and has the
//! whole command line for it:
//!
//! ```sh
//! cargo run --release --example fresnel -- new fresnel > f.toml
//! cargo run --release --example fresnel -- generate f.toml --out /tmp/x
//! cargo run --release --example fresnel -- cosim f.toml --simulator verilator
//! cargo run --release --example fresnel -- eval f.toml cos_half=0.1 f0=0.04
//! ```
//!
//! Seen at a grazing angle, every surface is a mirror. C. Schlick ("An Inexpensive BRDF Model for
//! Physically-based Rendering", Computer Graphics Forum 13(3), 1994) puts it as
//!
//! ```text
//! f = f0 + (1 − f0)·(1 − c)⁵
//! ```
//!
//! where c is the cosine between the direction of the light and the half vector, and f0 the
//! reflectance at normal incidence: 0.04 for glass, 0.95 for silver. The device multiplies the three
//! colours by it. It has one multiplier for f, which a microprogram of six words uses four times.
//!
//! A device is five things: configuration keys, a description, a golden model, a contract, and the
//! line that ties them together. They follow in this order.

use std::process::ExitCode;

use glint::config::{Config, Key, Problems, Schema};
use glint::dsl::{About, Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding, exp2};
use glint::golden::contract::{bound, colour_operands, colour_outputs};
use glint::golden::handshake::{After, Handshake, OperandRegister};
use glint::golden::keys;
use glint::golden::narrow::{Narrow, rounding_error};
use glint::golden::{Bound, Contract, Model, Operand};
use glint::hdl::blocks::colour::Colours;
use glint::registry::{Device, Registry};

// 1. The keys: what the user of the device may choose. `new` writes them into a commented file, with
//    these sentences; a file with a wrong value is refused with its line and a remedy.

const ROUNDINGS: &[&str] = &["truncate", "nearest"];

fn schema() -> Schema {
    let bits = |name, default, doc| Key::integer(name, default, 4..=16, doc);
    let rounding = |name, doc| Key::choice(name, "nearest", ROUNDINGS, doc);
    let power = "Fraction bits of the powers of 1 - c and of f, u0.F: the width of the multiplier.";
    Schema {
        device: "fresnel",
        keys: vec![
            bits("cosine.fraction", 10, "Fraction bits of cos_half, u1.F."),
            bits("reflectance.fraction", 8, "Fraction bits of f0, u0.F."),
            Key::integer("power.fraction", 12, 4..=24, power),
            rounding("power.rounding", "How the powers and f are rounded."),
            bits("colour.bits", 8, "Bits of colour operands and outputs."),
            rounding("output.rounding", "How the outputs are rounded."),
        ],
        check,
    }
}

/// The multiplier takes 1 − c and 1 − f0 whole, so they have no more fraction bits than the powers.
fn check(config: &Config, problems: &mut Problems) {
    let power = config.integer("power.fraction");
    for key in ["cosine.fraction", "reflectance.fraction"] {
        if config.integer(key) > power {
            problems.push(
                key,
                format!("more fraction bits than the {power} of power.fraction"),
                format!("at most {power}, or a larger power.fraction"),
            );
        }
    }
}

/// The keys once more, as formats and rounding modes. Description, model and contract have this in
/// common, and nothing else.
#[derive(Clone, Copy)]
struct Formats {
    cosine: Format,
    reflectance: Format,
    power: Format,
    power_rounding: Rounding,
    colour: Format,
    output_rounding: Rounding,
}

impl Formats {
    fn new(config: &Config) -> Self {
        let bits = |key| keys::bits(config, key) as i32;
        Self {
            cosine: Format::unsigned(1, bits("cosine.fraction")),
            reflectance: Format::unsigned(0, bits("reflectance.fraction")),
            power: Format::unsigned(0, bits("power.fraction")),
            power_rounding: keys::rounding(config, "power.rounding"),
            colour: Format::unsigned(bits("colour.bits"), 0),
            output_rounding: keys::rounding(config, "output.rounding"),
        }
    }
}

// 2. The description: blocks, wires and the microprogram. Every signal knows its format and its range,
//    so that widths follow by themselves; only `narrow` gives bits up, and says how.

fn describe(d: &Designer, config: &Config) {
    let formats = Formats::new(config);
    d.about(About {
        device: "fresnel".into(),
        title: "Schlick's Fresnel factor".into(),
        formula: "f0 + (1 - f0)*(1 - c)^5".into(),
        source: "C. Schlick, Computer Graphics Forum 13(3), 1994".into(),
        notes: vec!["c = 1 is normal incidence, where f = f0; c = 0 grazes the surface.".into()],
    });

    // An operand is a port, a write strobe and a register. u1.F could hold almost 2; a cosine beyond 1
    // is taken for 1, so that 1 − c below cannot be negative. The DSL knows that from here on.
    let c = d
        .operand_clamped("cos_half", formats.cosine, 0.0, 1.0)
        .doc("cosine between the light and the half vector");
    let f0 = d.operand("f0", formats.reflectance).doc("reflectance at normal incidence");
    let colours = Colours::new(d, formats.colour.int, None);

    let power = d.register("power", formats.power).doc("(1 - c)^2, then ^4, then ^5");
    let f = d.register("f", formats.power).doc("the Fresnel factor");

    // 1 − x, with as many fraction bits as the powers: the muxes want their points in one place.
    let complement = |name: &str, x| {
        let one = d.constant("one", 1.0, Format::unsigned(1, 0));
        d.sub(name, one, x).with_fraction(formats.power.frac)
    };
    let grazing = complement("grazing", c.q());
    let absorbed = complement("absorbed", f0.q());

    // The one multiplier, and what it multiplies. A word that does not turn a mux leaves it at its first
    // input, so that comes first which most words want.
    let first = d.mux("first", [power.q(), grazing]);
    let second = d.mux("second", [power.q(), grazing, absorbed]);
    let product = d.mul("product", first.out(), second.out());

    // 1.0 is no value of u0.F: it becomes the largest, one last place below. Elsewhere the ranges leave
    // saturation something to do, but the values do not; the proof is at the bound.
    let (u0, rounding) = (formats.power, formats.power_rounding);
    let narrow = |name, x| d.narrow(name, x, u0, rounding, Overflow::Saturate);
    power.takes(narrow("power_rounded", product));
    f.takes(narrow("f_rounded", d.add("blend", product, f0.q())));
    colours.outputs(f.q(), formats.output_rounding);

    // A word is a clock. What a register loads in a word is there in the next.
    d.microprogram([
        step("idle", []),
        step("square", [first.pick(grazing), second.pick(grazing), power.load()]),
        step("fourth", [power.load()]),
        step("fifth", [second.pick(grazing), power.load()]),
        step("blend", [second.pick(absorbed), f.load()]),
        step("result", [valid(), end()]),
    ]);
}

// 3. The golden model: the device once more, from the formula, in integers. It never looks at the
//    description; that `cosim` finds both equal on every clock is what makes the description right.

impl Formats {
    /// 1 − x, from `format` to the fraction bits of the powers.
    fn complement(&self, x: i64, format: Format) -> i64 {
        ((1 << format.frac) - x) << (self.power.frac - format.frac)
    }

    /// From the fraction bits of a product to u0.F.
    fn rounded(&self, product: i64) -> i64 {
        Narrow::new(2 * self.power.frac as u32, self.power, self.power_rounding).apply(product)
    }

    fn square(&self, c: i64) -> i64 {
        let t = self.complement(c, self.cosine);
        self.rounded(t * t)
    }

    fn fourth(&self, square: i64) -> i64 {
        self.rounded(square * square)
    }

    fn fifth(&self, fourth: i64, c: i64) -> i64 {
        self.rounded(fourth * self.complement(c, self.cosine))
    }

    fn blend(&self, fifth: i64, f0: i64) -> i64 {
        let exact = f0 << (2 * self.power.frac - self.reflectance.frac);
        self.rounded(exact + fifth * self.complement(f0, self.reflectance))
    }

    fn output(&self, f: i64, colour: i64) -> i64 {
        Narrow::new(self.power.frac as u32, self.colour, self.output_rounding).apply(f * colour)
    }
}

/// The operands, in the order of the model's and the contract's.
const OPERANDS: [&str; 5] = ["cos_half", "f0", "red", "green", "blue"];

/// What else the model predicts. `run` and `word_address` are the sequencer's registers.
const SIGNALS: &str = "valid busy done run word_address power f red_out green_out blue_out";

/// The device at one clock.
#[derive(Clone)]
struct FresnelModel {
    formats: Formats,
    handshake: Handshake,
    operands: [OperandRegister; 5],
    power: i64,
    f: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: Vec<u64>,
}

impl FresnelModel {
    fn new(config: &Config) -> Self {
        let formats = Formats::new(config);
        let one = 1 << formats.cosine.frac;
        let colour = OperandRegister::new(formats.colour);
        let mut inputs = vec!["rst_n".to_owned(), "start".to_owned()];
        for operand in OPERANDS {
            inputs.extend([operand.to_owned(), format!("{operand}_write")]);
        }
        let mut signals: Vec<String> = SIGNALS.split(' ').map(str::to_owned).collect();
        signals.extend(OPERANDS.map(|name| format!("{name}_reg")));
        Self {
            formats,
            handshake: Handshake::default(),
            operands: [
                OperandRegister::clamped(formats.cosine, 0, one),
                OperandRegister::new(formats.reflectance),
                colour,
                colour,
                colour,
            ],
            power: 0,
            f: 0,
            inputs,
            values: vec![0; signals.len()],
            signals,
        }
    }
}

impl Model for FresnelModel {
    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn signals(&self) -> &[String] {
        &self.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let Handshake { run, word } = self.handshake;
        let [c, f0] = [self.operands[0].value, self.operands[1].value];
        // The registers of the datapath know neither reset nor `run`: the word alone loads them.
        match word {
            1 => self.power = self.formats.square(c),
            2 => self.power = self.formats.fourth(self.power),
            3 => self.power = self.formats.fifth(self.power, c),
            4 => self.f = self.formats.blend(self.power, f0),
            _ => {}
        }
        for (operand, ports) in self.operands.iter_mut().zip(inputs[2..].chunks_exact(2)) {
            operand.clock(run, ports[1], ports[0]);
        }
        let after = if word == 5 { After::End } else { After::Next };
        self.handshake.clock(inputs[0] == 1, inputs[1] == 1, after);

        let Handshake { run, word } = self.handshake;
        let last = u64::from(word == 5);
        let [power, f] = [self.power, self.f].map(|raw| raw as u64);
        self.values = vec![last, run.into(), last, run.into(), word.into(), power, f];
        let colours = &self.operands[2..];
        let out = |colour: &OperandRegister| self.formats.output(self.f, colour.value) as u64;
        self.values.extend(colours.iter().map(out));
        let held = self.operands.map(|operand| operand.value as u64);
        self.values.extend(held);
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

// 4. The contract: which function the device computes, and how far off it may be.

struct FresnelContract {
    formats: Formats,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl FresnelContract {
    fn new(config: &Config) -> Self {
        let formats = Formats::new(config);
        let control = |at: usize, format: Format, most: i64, doc: &str| Operand {
            name: OPERANDS[at].to_owned(),
            format,
            domain: (0, most),
            colour: false,
            doc: doc.to_owned(),
        };
        let [c, f0] = [formats.cosine, formats.reflectance];
        let mut operands = vec![
            control(0, c, 1 << c.frac, "cosine to the half vector"),
            control(1, f0, f0.max_raw() as i64, "reflectance head-on"),
        ];
        operands.extend(colour_operands(formats.colour));
        Self { formats, operands, outputs: colour_outputs() }
    }
}

impl Contract for FresnelContract {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn f_format(&self) -> Format {
        self.formats.power
    }

    fn f(&self, control: &[i64]) -> i64 {
        let square = self.formats.square(control[0]);
        let fifth = self.formats.fifth(self.formats.fourth(square), control[0]);
        self.formats.blend(fifth, control[1])
    }

    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.formats.output(f, colour)
    }

    fn reference(&self, control: &[i64]) -> f64 {
        let c = self.formats.cosine.to_f64(control[0].into());
        let f0 = self.formats.reflectance.to_f64(control[1].into());
        let t = 1.0 - c;
        f0 + (1.0 - f0) * (t * t * t * t * t)
    }

    fn expressions(&self) -> Vec<String> {
        vec!["f0 + (1 - f0) * (1 - cos_half) ** 5".to_owned()]
    }

    /// Let u be the last place of u0.F, r what a rounding is off by at most (u/2 or u), and t = 1 − c,
    /// which is exact, as is 1 − f0.
    ///
    /// - The square s is off by at most u: t = 1 saturates to 1 − u. Any other t is at most 1 − u, so that
    ///   t² ≤ 1 − 2u + u² is rounded, by r ≤ u, to no more than 1 − u.
    /// - The fourth power q is off by at most 2u + r: |s² − t⁴| = |s − t²|·(s + t²) ≤ u·2; s ≤ 1 − u does
    ///   not saturate, as t above.
    /// - The fifth is off by at most 2u + 2r: |q·t − t⁵| ≤ |q − t⁴|; q·t ≤ 1 − u does not saturate.
    /// - f is off by at most 2u + 2r + u: 1 − f0 ≤ 1 adds nothing to the error of the fifth power, and
    ///   the sum is at most 1, so that rounding and saturation together move it by u at most.
    fn bound(&self) -> Bound {
        let frac = self.formats.power.frac as u32;
        let u = exp2(-self.formats.power.frac);
        let r = rounding_error(2 * frac, frac, self.formats.power_rounding);
        let shares = [
            ("power.fraction", "(1 - c)^2 below 1", 2.0 * u),
            ("power.rounding", "rounding of the higher powers", 2.0 * r),
            ("power.fraction", "f rounded and below 1", u),
        ];
        let colour_bits = self.formats.colour.width();
        bound(&shares, frac, colour_bits, self.formats.output_rounding)
    }
}

// 5. The line that ties them together, and the command line.

/// The device.
pub const FRESNEL: Device = Device {
    name: "fresnel",
    summary: "Schlick's Fresnel factor, f0 + (1 - f0)*(1 - c)^5",
    schema,
    describe,
    model: |config| Box::new(FresnelModel::new(config)),
    contract: |config| Box::new(FresnelContract::new(config)),
};

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(FRESNEL))
}
