//! Holds the facts about a pipelined design that go beyond its netlist: stages, handshake, shared multipliers and
//! checkpoints.

use std::collections::BTreeMap;

use super::{Design, Driver, Net, NetId, Op, RegId};
use glint_base::target::DelayMemory;

/// The pipeline of a design: it takes a point every clock, or every few.
#[derive(Clone, Debug, Default)]
pub struct Pipeline {
    /// The name of the target whose delays the schedule assumes.
    pub target: String,
    /// The clock that they keep.
    pub clock_mhz: f64,
    /// The fastest clock that any number of stages can reach. The slowest operation alone limits it.
    pub most_mhz: f64,
    /// The least number of clocks between two points, which are taken in slot 0. A point is in stage s while the slot is s
    /// modulo this number. For example, with an interval of 4 a point is in stage 6 while the slot is 2.
    pub interval: usize,
    /// The counter of the slots, which moves on with the points; none with an interval of 1.
    pub slot: Option<NetId>,
    /// By slot, the enables of registers that take a value in it and hold it for as many clocks.
    pub loads: BTreeMap<usize, NetId>,
    /// The multipliers that serve one operation in each slot.
    pub units: Vec<Unit>,
    /// The environment can hold the results back by `out_ready`.
    pub stall: bool,
    /// Bits that travel with a point.
    pub side: u32,
    /// The memory that the Verilog has in place of registers that nothing reads; `None` if these registers stay.
    pub delay_memory: Option<DelayMemory>,
    /// From the operands on. Results are behind the registers of the last: there are as many stages as clocks from a point to
    /// its results. For example, `rough_pipelined` has 18 stages, and its results come 18 clocks after a point is taken.
    pub stages: Vec<Stage>,
    /// For each net, its stage. A register of stage k holds a value that stage k - 1 made.
    pub stage_of: Vec<usize>,
    /// For each net the name of its value, which is the same in every stage that has it.
    pub value_of: Vec<String>,
    /// The nets that say which stage has a point, and when points move.
    pub handshake: Vec<NetId>,
    /// For each stage from 1 on, to the results: whether it has a point.
    pub valid: Vec<NetId>,
    /// For each of these stages, the net of the side channel, which travels with the point; empty without a side
    /// channel.
    pub side_values: Vec<NetId>,
    /// The registers that are inside a multiplier, with the product that they take.
    pub registered: Vec<RegId>,
    /// The nets that show values which the sequential design has in registers.
    pub checkpoints: Vec<Checkpoint>,
}

/// A multiplier that several operations share.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its name, which is also the name of the register behind it.
    pub name: String,
    /// The nets of its muxes, operand registers and product; the last is the register behind it.
    pub nets: Vec<NetId>,
    /// For each slot, the value that it computes, by name.
    pub serves: Vec<Option<String>>,
}

/// The logic between two rows of registers. For example, the first stage of `rough_pipelined` has 4.4 ns of logic and 86
/// register bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The microinstructions of the sequential design that compute the values of this stage.
    pub microinstructions: Vec<String>,
    /// Nanoseconds that the longest way through it takes on the target.
    pub logic_ns: f64,
    /// Nanoseconds of the clock that are left, registers counted.
    pub slack_ns: f64,
    /// Bits of the registers that end it.
    pub register_bits: u32,
    /// Bits that a memory holds in place of such registers.
    pub delayed_bits: u32,
}

/// A value of a pipeline that a register of the sequential design has in some microinstruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// The register, by name.
    pub register: String,
    /// The microinstruction while which it has the value, by its place in the microprogram.
    pub address: usize,
    /// How often this was executed before in the same computation.
    pub visit: usize,
    /// The net with the value, in its stage.
    pub net: NetId,
}

impl Pipeline {
    /// Returns the first clock in which a net has the value of a point, counted from that in which the point is taken: its stage.
    pub fn clock_of(&self, net: NetId) -> usize {
        self.stage_of[net.index()]
    }

    /// Returns whether a net belongs to a multiplier that operations of several stages share.
    pub fn is_shared(&self, net: NetId) -> bool {
        self.units.iter().any(|unit| unit.nets.contains(&net))
    }

    /// Returns the named nets whose logic is in a stage, each with the name of its value, in the order of the design's nets. It
    /// leaves out the nets of the handshake.
    pub fn computed<'a>(
        &'a self,
        design: &'a Design,
        stage: usize,
    ) -> impl Iterator<Item = (&'a str, &'a Net)> {
        let made = move |net: &Net, at: usize| match net.driver {
            Driver::Op(_) => at == stage,
            // The word of a block memory is there a stage after its address.
            Driver::Rom(rom) => at == stage + usize::from(design.rom(rom).synchronous),
            _ => false,
        };
        let nets = design.iter().zip(&self.stage_of);
        let nets = nets.filter(move |((id, net), at)| {
            net.named && !self.handshake.contains(id) && !self.is_shared(*id) && made(net, **at)
        });
        nets.map(|((id, net), _)| (self.value_of[id.index()].as_str(), net))
    }
}

/// A multiplier with a register at its output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multiplier {
    /// The product that the register takes.
    pub product: NetId,
    /// The factors.
    pub factors: [NetId; 2],
}

impl Design {
    /// Returns the multiplier that a register is inside of, if it is.
    pub fn multiplier(&self, register: RegId) -> Option<Multiplier> {
        self.pipeline.as_ref().filter(|it| it.registered.contains(&register))?;
        let product = self.register(register).data?;
        match self.net(product).driver {
            Driver::Op(Op::Mul(a, b)) => Some(Multiplier { product, factors: [a, b] }),
            _ => None,
        }
    }
}
