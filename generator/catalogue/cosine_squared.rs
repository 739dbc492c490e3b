//! The hardware description of the device `cosine-squared`, which computes f = cos²(a·δ) for the points of a scan line.
//!
//! δ is the angle at a point of the line, and a = √(n/2) with the specular exponent n. The host multiplies its angles by a, so
//! that the accumulated angle addresses a single table. f is 0 if a·δ does not lie from −90° (included) to 90°. The accumulator
//! is the same as in `quad-cosine`. The source is a prototype (Abbas, Szirmay-Kalos, Horváth 2000), which [seed
//! 000](crate#symbols) cites.

use glint_config::Config;
use glint_keys::cosine_squared::Keys;
use glint_rtl::blocks::angle;
use glint_rtl::blocks::colour::Colours;
use glint_rtl::blocks::line::Line;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::{About, Topic};

use super::{common, quad_cosine};

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let table = keys.table_address as i32;
    let f = keys.f_format();
    // The registers after the address and after the word of ROM 12, and after multiplier 13.
    let staged = keys.stages == 5;
    d.about(about(keys.stages));

    let colours = Colours::amplitude(d, keys.colour_bits as i32, Some(quad_cosine::AMPLITUDE));
    let line =
        Line::new(d, keys.angle_format(), keys.length_bits as i32, Some(common::LINE_BLOCKS));
    let folded = angle::fold(d, line.angle(), table);
    let mut address = angle::address(d, "table_address", folded.magnitude, folded.within, table);
    if staged {
        address = d.pipeline("table_address_held", address);
    }
    let cosine = d
        .rom("cosine", address, f, &angle::cosine_power_table(2, table, f.frac), true)
        .block(12)
        .doc(&format!("cos^2 at 2^{table} angles of a right angle"))
        .comments(angle::step_comments(2, table));
    let rounding = keys.output_rounding;
    if staged {
        colours.outputs_staged(d.pipeline("cosine_held", cosine.out()), rounding);
    } else {
        colours.outputs(cosine.out(), rounding);
    }
    // The clocks of register 8 and ROM 12, and of the registers between them.
    line.microprogram(keys.stages);
}

fn about(stages: u32) -> About {
    About {
        device: "cosine-squared".to_owned(),
        title: "Specular intensity along a scan line by a stretched cosine squared".to_owned(),
        formula: "out = amplitude * cos^2(angle); angle = zeta_start + i * delta_zeta, stretched by sqrt(n/2)"
            .to_owned(),
        source: "Seed 000, the prototype: Abbas, Szirmay-Kalos, Horvath 2000".to_owned(),
        notes: vec![
            "The core has no exponent: the host must multiply both angles by a = sqrt(n/2) before it writes \
             them. The unit of angles is the right angle: 1.0 is 90 degrees. The intensity is 0 if the \
             stretched angle is below -90 degrees, or 90 degrees or more."
                .into(),
            "A stretched angle is no angle on a circle, so it must not wrap around within a line. With \
             angle.integer = 7, the register holds -128 to 128 right angles. The angles of a host reach at \
             most 3*sqrt(n/2), which is 68 for n = 1000. Beyond its range the register wraps around, in the \
             model and in the hardware."
                .into(),
            "By default an angle has 22 fraction bits. Over the longest line, with 4095 intervals, the host's \
             roundings of delta_zeta and zeta_start add up to at most 2^11 ulps. The slope of the formula is \
             at most 1.58 per right angle. So with an amplitude of 255 the result drifts by at most 255 * 1.58 \
             * 2^(11 - 22) = 0.20 units. With the contract's 0.82 units and half a unit for the rounding of \
             the amplitude, the error against the host's unrounded numbers is at most 1.52 units."
                .into(),
            "The source has no drawing of the prototype. Its accumulator is assumed to be the one of the \
             claimed device, and has the same block numbers: registers 1 to 3, counter 5, adder 6, mux 7, \
             register 8, ROM 12, multiplier 13."
                .into(),
            Topic::Latency.note(format!(
                "A start computes length + 1 points, one per clock. valid is high for each point, {} clocks \
                 after output 37 (write_angle) has written its angle. busy is high until the last point, and \
                 done is high together with the last point.",
                if stages == 2 { "two".to_owned() } else { stages.to_string() }
            )),
            Topic::Writes.note(
                "Writes while busy are ignored. The output depends on the operand register of the amplitude: \
                 it keeps its value from valid until the amplitude is written or the next computation starts.",
            ),
        ],
    }
}
