//! Records the waveform of one computation, or of several points in a pipeline, with the built-in simulator.
//!
//! A waveform has a lane for the clock and for each recorded signal. In a core with a microprogram, these are the handshake, the
//! microinstruction, the registers that change, and the results. In a pipeline, they are the handshake, the operands, the results
//! and the status outputs. A waveform can be written as JSON for the drawing tool WaveDrom.

use anyhow::Result;
use serde_json::{Value, json};

use crate::pages::account::short;
use glint_base::fixed::Format;
use glint_core::core::Core;
use glint_core::cosim::trial;
use glint_core::package::sealed_json;
use glint_rtl::netlist::{Design, Driver, Handshake, NetId, Port, RegisterKind, Role};

/// The largest number of clocks that the diagram shows in full. It leaves out the middle of a longer computation.
const MOST: usize = 40;

/// The number of clocks at the beginning of a long computation that the diagram shows.
const HEAD: usize = 24;

/// The number of clocks at the end of a long computation that the diagram shows.
const TAIL: usize = 8;

pub const MICROINSTRUCTION: &str = "microinstruction";

pub struct Waves {
    pub name: String,
    /// Whether the waveform shows several points in a pipeline; otherwise it shows one computation.
    pub pipelined: bool,
    pub what: &'static str,
    /// The numbers of the shown clocks, from 0. A jump in the numbers means that clocks are left out.
    pub clocks: Vec<usize>,
    /// The signals from top to bottom.
    pub lanes: Vec<Lane>,
}

pub struct Lane {
    pub name: String,
    /// The number of the block that drives the signal, in the source's figure.
    pub number: Option<u16>,
    pub shape: LaneStyle,
    /// The value in each shown clock; `None` while the signal has no meaning, such as a result before the first `valid`.
    pub values: Vec<Option<String>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneStyle {
    /// A rising edge begins each clock period.
    Clock,
    /// One bit, drawn high or low.
    Bit,
    /// Several bits, drawn as a value in a frame.
    Bus,
}

struct Probe {
    net: NetId,
    kind: Meaning,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Meaning {
    /// The signal has a known value from the first clock on.
    Control,
    /// The signal has no known value before it first changes.
    Register,
    /// The signal has no known value before the first `valid`.
    Result,
}

impl Waves {
    /// Simulates the worked example. A pipeline gets several points, one after another, beginning with the example.
    ///
    /// # Errors
    ///
    /// Fails if a simulated computation of the device never ends.
    pub fn record(core: &Core) -> Result<Self> {
        match core.design.pipeline {
            None => Self::computation(core),
            Some(_) => Self::points(core),
        }
    }

    /// Records points in a pipeline. The diagram shows operands while `in_valid` is 1, and results while `out_valid` is 1.
    fn points(core: &Core) -> Result<Self> {
        let design = &core.design;
        let groups: [&[Role]; 6] = [
            &[Role::InValid],
            &[Role::InReady],
            &[Role::Point],
            &[Role::Valid],
            &[Role::OutReady],
            &[Role::Result, Role::Status],
        ];
        let mut ports: Vec<&Port> = Vec::new();
        for roles in groups {
            ports.extend(design.ports.iter().filter(|port| roles.contains(&port.role)));
        }
        let nets: Vec<NetId> = ports.iter().map(|port| port.net).collect();
        let clocks = trial::record_points(design, core.contract.as_ref(), &nets)?;
        let in_valid = ports.iter().position(|port| port.role == Role::InValid);
        let out_valid = ports.iter().position(|port| port.role == Role::Valid);
        let mut lanes = vec![clock_lane(clocks.len())];
        for (at, port) in ports.iter().enumerate() {
            // Operands and results have a meaning only while their valid bit is 1.
            let valid = match port.role {
                Role::Point => in_valid,
                Role::Result | Role::Status => out_valid,
                _ => None,
            };
            let net = design.net(port.net);
            let mut values = Vec::new();
            for clock in &clocks {
                let is_known = valid.is_none_or(|valid| clock[valid] == 1);
                values.push(if is_known { Some(text(net.format, clock[at])) } else { None });
            }
            lanes.push(Lane {
                name: net.name.clone(),
                number: net.block,
                shape: shape(net.format),
                values,
            });
        }
        Ok(Self::cut(design, "points through the pipeline", clocks.len(), lanes))
    }

    fn computation(core: &Core) -> Result<Self> {
        let design = &core.design;
        let Handshake { start, busy, valid, done, .. } = design.handshake()?;
        let address = design.register(design.control.address).q;
        let probes = probes(design, [start, busy, valid, done]);
        let mut nets: Vec<NetId> = probes.iter().map(|probe| probe.net).collect();
        nets.extend([address, busy, valid]);
        let clocks = trial::record(design, core.contract.as_ref(), &nets)?;
        let [addresses, busy, valid] = [0, 1, 2].map(|at| column(&clocks, probes.len() + at));

        let mut lanes = vec![clock_lane(clocks.len())];
        let known = valid.iter().position(|&valid| valid == 1).unwrap_or(0);
        for (at, probe) in probes.iter().enumerate() {
            if at == 4 {
                lanes.push(microprogram_lane(design, &addresses, &busy));
            }
            if let Some(lane) = lane(design, probe, &column(&clocks, at), known) {
                lanes.push(lane);
            }
        }
        Ok(Self::cut(design, "one computation", clocks.len(), lanes))
    }

    /// Keeps only the clocks that the diagram shows. `what` is the caption.
    fn cut(design: &Design, what: &'static str, clocks: usize, mut lanes: Vec<Lane>) -> Self {
        let shown = shown(clocks);
        for lane in &mut lanes {
            lane.values = shown.iter().map(|&at| lane.values[at].take()).collect();
        }
        let pipelined = design.pipeline.is_some();
        Self { name: design.name.clone(), pipelined, what, clocks: shown, lanes }
    }

    /// Returns the number of the first shown clock in which the signal `name` is 1, or `None` without such a clock.
    pub fn first(&self, name: &str) -> Option<u32> {
        let lane = self.lanes.iter().find(|lane| lane.name == name)?;
        let at = lane.values.iter().position(|value| value.as_deref() == Some("1"))?;
        u32::try_from(self.clocks[at]).ok()
    }

    /// Describes the diagram in words, for example for a screen reader.
    pub fn described(&self) -> String {
        if self.pipelined {
            return format!(
                "Points through the pipeline, simulated: the first is taken in clock 0, its results are on the outputs from clock {} \
                 on. One clock has no point; where the pipeline can be held back, the first results wait.",
                self.first_text("out_valid")
            );
        }
        let clocks = match self.clocks.last() {
            Some(last) => last + 1,
            None => 0,
        };
        format!(
            "One computation in {clocks} clocks, simulated: start is high in clock 0, valid first in clock {}, done in clock {}. \
             Below the handshake are the microinstruction, registers and results with their values.",
            self.first_text("valid"),
            self.first_text("done"),
        )
    }

    /// Returns the number of the first clock as text, or `some` if the signal is 1 in no shown clock.
    fn first_text(&self, name: &str) -> String {
        match self.first(name) {
            Some(clock) => clock.to_string(),
            None => "some".to_owned(),
        }
    }

    /// Returns the waveform as JSON that ends with a newline. For example, a bit that is 0 and 1, and after a gap 1 and 0, has
    /// the wave `01|.0`.
    ///
    /// # Errors
    ///
    /// Fails only through a bug, not through anything that a user gives.
    pub fn wavedrom(&self) -> Result<String> {
        let signal: Vec<Value> = self.lanes.iter().map(|lane| self.signal(lane)).collect();
        sealed_json(json!({
            "signal": signal,
            "head": { "text": format!("{}: {}", self.name, self.what), "tick": 0 },
        }))
    }

    fn signal(&self, lane: &Lane) -> Value {
        let (mut wave, mut data) = (String::new(), Vec::new());
        let mut before: Option<&Option<String>> = None;
        for (at, value) in lane.values.iter().enumerate() {
            if at > 0 && self.clocks[at] != self.clocks[at - 1] + 1 {
                wave.push('|');
            }
            wave.push(match (lane.shape, value) {
                (LaneStyle::Clock, _) if at == 0 => 'p',
                (LaneStyle::Clock, _) => '.',
                _ if before == Some(value) => '.',
                (_, None) => 'x',
                (LaneStyle::Bit, Some(bit)) if bit == "1" => '1',
                (LaneStyle::Bit, Some(_)) => '0',
                (LaneStyle::Bus, Some(text)) => {
                    data.push(text.clone());
                    '='
                }
            });
            before = Some(value);
        }
        if data.is_empty() {
            json!({ "name": lane.name, "wave": wave })
        } else {
            json!({ "name": lane.name, "wave": wave, "data": data })
        }
    }
}

fn probes(design: &Design, handshake: [NetId; 4]) -> Vec<Probe> {
    let mut probes = Vec::new();
    for net in handshake {
        probes.push(Probe { net, kind: Meaning::Control });
    }
    for register in &design.registers {
        if register.kind == RegisterKind::Architectural {
            probes.push(Probe { net: register.q, kind: Meaning::Register });
        }
    }
    for port in design.outputs() {
        if port.role == Role::Result {
            probes.push(Probe { net: port.net, kind: Meaning::Result });
        }
    }
    probes
}

fn column(clocks: &[Vec<u64>], at: usize) -> Vec<u64> {
    clocks.iter().map(|values| values[at]).collect()
}

fn clock_lane(clocks: usize) -> Lane {
    Lane {
        name: "clk".to_owned(),
        number: None,
        shape: LaneStyle::Clock,
        values: vec![None; clocks],
    }
}

fn shape(format: Format) -> LaneStyle {
    if format.width() == 1 { LaneStyle::Bit } else { LaneStyle::Bus }
}

/// Returns a signal's lane. `bits` has the bit pattern of the net in each clock, and `valid` is the index of the first clock with
/// results. Returns `None` for a register that never changes.
fn lane(design: &Design, probe: &Probe, bits: &[u64], valid: usize) -> Option<Lane> {
    let net = design.net(probe.net);
    let known = match probe.kind {
        Meaning::Control => 0,
        Meaning::Result => valid,
        Meaning::Register => {
            let resets = match net.driver {
                Driver::Register(register) => design.register(register).reset.is_some(),
                _ => false,
            };
            let change = bits.windows(2).position(|pair| pair[0] != pair[1])?;
            if resets { 0 } else { change + 1 }
        }
    };
    let mut values = Vec::new();
    for (clock, &bits) in bits.iter().enumerate() {
        values.push(if clock >= known { Some(text(net.format, bits)) } else { None });
    }
    Some(Lane { name: net.name.clone(), number: net.block, shape: shape(net.format), values })
}

/// Returns the lane of the microinstructions, with values such as `3 result` and `idle`.
fn microprogram_lane(design: &Design, addresses: &[u64], busy: &[u64]) -> Lane {
    let mut values = Vec::new();
    for (&address, &busy) in addresses.iter().zip(busy) {
        let named = design.control.microprogram.get(address as usize);
        values.push(Some(match (address, busy, named) {
            (0, 0, _) => "idle".to_owned(),
            (_, _, Some(instruction)) => format!("{address} {}", instruction.name),
            (_, _, None) => address.to_string(),
        }));
    }
    Lane { name: MICROINSTRUCTION.to_owned(), number: None, shape: LaneStyle::Bus, values }
}

/// Returns the value of a bit pattern as text, with at most five digits after the point.
fn text(format: Format, bits: u64) -> String {
    let value = format.to_f64(format.raw(bits));
    match format.frac {
        ..=0 => short(value),
        _ => short((value * 1e5).round() / 1e5),
    }
}

/// Returns the numbers of the clocks that the diagram shows: all of at most 40, and otherwise the first 24 and the last 8.
fn shown(clocks: usize) -> Vec<usize> {
    match clocks {
        0..=MOST => (0..clocks).collect(),
        _ => (0..HEAD).chain(clocks - TAIL..clocks).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_computations_are_cut_in_the_middle() {
        assert_eq!(shown(3), [0, 1, 2]);
        assert_eq!(shown(MOST).len(), MOST);
        let cut = shown(100);
        assert_eq!(cut.len(), HEAD + TAIL);
        assert_eq!((cut[HEAD - 1], cut[HEAD], cut.last()), (23, 92, Some(&99)));
    }

    #[test]
    fn wavedrom_repeats_with_dots() {
        let lane = |name: &str, shape, values: [Option<&str>; 4]| Lane {
            name: name.to_owned(),
            number: None,
            shape,
            values: values.map(|value| value.map(str::to_owned)).to_vec(),
        };
        let waves = Waves {
            pipelined: false,
            name: "core".to_owned(),
            what: "one computation",
            clocks: vec![0, 1, 7, 8],
            lanes: vec![
                lane("clk", LaneStyle::Clock, [None; 4]),
                lane("busy", LaneStyle::Bit, ["0", "1", "1", "0"].map(Some)),
                lane("r", LaneStyle::Bus, [None, None, Some("5"), Some("6")]),
            ],
        };
        let text = waves.wavedrom().expect("JSON");
        let value: Value = serde_json::from_str(&text).expect("JSON");
        let wave = |at: usize| value["signal"][at]["wave"].clone();
        assert_eq!([wave(0), wave(1), wave(2)], ["p.|..", "01|.0", "x.|=="]);
        assert_eq!(value["signal"][2]["data"], json!(["5", "6"]));
    }
}
