//! Defines the facts about a pipeline that its netlist alone does not state: stages, handshake, shared multipliers, and
//! checkpoints.

use std::collections::BTreeMap;

use super::{Design, Driver, Net, NetId, Op, RegId};
use glint_base::target::DelayMemory;

/// The facts about a design that accepts a point every clock or every few clocks.
#[derive(Clone, Debug, Default)]
pub struct Pipeline {
    /// The FPGA target whose delays divide the computation into stages, such as `ecp5`.
    pub target: String,
    /// The clock frequency that the stages reach, in MHz.
    pub clock_mhz: f64,
    /// The highest clock frequency that any number of stages can reach, in MHz. The slowest operation limits it.
    pub most_mhz: f64,
    /// The smallest number of clocks between two points. A counter counts slots from 0 to this number less one, and slot 0
    /// accepts a point. A point is in stage s while the slot is s modulo the interval. For example, with an interval of 4 a point
    /// is in stage 6 while the slot is 2.
    pub interval: usize,
    /// The counter of slots, which increases whenever the points move to the next stage; `None` if the interval is 1.
    pub slot: Option<NetId>,
    /// For each slot in which registers load a value for a whole interval, the net that enables these registers.
    pub loads: BTreeMap<usize, NetId>,
    /// The multipliers that serve several products, each product in a slot of its own.
    pub units: Vec<Unit>,
    /// Whether the environment can stall the pipeline by setting `out_ready` to 0.
    pub stall: bool,
    /// The number of bits of the side channel, which carries the user's data along with each point.
    pub side: u32,
    /// The kind of memory that replaces delay lines in the Verilog. `None` if their registers stay.
    pub delay_memory: Option<DelayMemory>,
    /// The number of registers that need no memory in their place, because they are beside look-up tables that are there anyway.
    /// Memories replace delay lines only until no more registers are left.
    pub registers_beside_tables: u32,
    /// The stages, from the operands on. The results are in the registers behind the last one, so there are as many stages as
    /// clocks from a point to its results: `rough_pipelined` has 18.
    pub stages: Vec<Stage>,
    /// The stage of each net. A register in stage k has a value that stage k − 1 computed.
    pub stage_of: Vec<usize>,
    /// For each net, the name of the value that it carries, the same in every stage through which the value travels.
    pub value_of: Vec<String>,
    /// The valid bits, the slot counter, and the nets that determine when points move.
    pub handshake: Vec<NetId>,
    /// For each stage from 1 on, the net that is 1 if the stage has a point. The last entry is the stage of the results.
    pub valid: Vec<NetId>,
    /// For each stage from 1 on, the net of the side channel; empty without one.
    pub side_values: Vec<NetId>,
    /// The registers that become output registers of multipliers, inside a DSP block.
    pub registered: Vec<RegId>,
    pub checkpoints: Vec<Checkpoint>,
}

/// A multiplier that several products share. The multiplier computes one product in each slot, a clock modulo the interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The name of the multiplier, and of the register behind it, in the Verilog.
    pub name: String,
    /// Its muxes if it has any, its two operand registers, its product, and the register behind it.
    pub nets: Vec<NetId>,
    /// For each slot, the name of the product that the multiplier computes.
    pub serves: Vec<Option<String>>,
}

/// The logic between two rows of registers. For example, the first stage of `rough_pipelined` has 4.4 ns of logic and 86 register
/// bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The microinstructions of the sequential design that compute the stage's values.
    pub microinstructions: Vec<String>,
    /// The delay of the longest path through the logic, in nanoseconds.
    pub logic_ns: f64,
    /// The rest of the clock period after the delays of logic and registers, in nanoseconds.
    pub slack_ns: f64,
    /// The number of bits in the registers at the end of the stage.
    pub register_bits: u32,
    /// The number of bits that memories store in place of registers at the end of the stage.
    pub delayed_bits: u32,
}

/// A value of a pipeline that a register of the sequential design has at some time too. Checks compare both values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// A register of the sequential design.
    pub register: String,
    /// The microinstruction in which the register has the value.
    pub address: usize,
    /// The number of earlier executions of this microinstruction in the same computation.
    pub visit: usize,
    /// The net of the pipeline that carries the value.
    pub net: NetId,
}

impl Pipeline {
    /// Returns the stage of a net: the first clock in which the net has its value for a point that the pipeline accepts in
    /// clock 0.
    pub fn clock_of(&self, net: NetId) -> usize {
        self.stage_of[net.index()]
    }

    pub fn is_shared(&self, net: NetId) -> bool {
        self.units.iter().any(|unit| unit.nets.contains(&net))
    }

    /// Returns each multiplier's name and the product that it computes in each slot, the shared multipliers first. A multiplier
    /// with a single product has the product's name; a product with a constant takes no multiplier. For example, with an
    /// interval of 3, `lerp` has one multiplier, which is idle in two slots.
    pub fn multipliers(&self, design: &Design) -> Vec<(String, Vec<Option<String>>)> {
        let shared = self.units.iter().map(|unit| (unit.name.clone(), unit.serves.clone()));
        let mut multipliers: Vec<_> = shared.collect();
        let is_constant = |net: NetId| matches!(design.net(net).driver, Driver::Constant(_));
        for (id, net) in design.iter() {
            let Driver::Op(Op::Mul(a, b)) = net.driver else { continue };
            if self.is_shared(id) || is_constant(a) || is_constant(b) {
                continue;
            }
            let product = &self.value_of[id.index()];
            let mut serves = vec![None; self.interval];
            serves[self.clock_of(id) % self.interval] = Some(product.clone());
            multipliers.push((product.clone(), serves));
        }
        multipliers
    }

    /// Returns the named nets whose logic is in this stage, each with the name of its value, without nets of the handshake.
    pub fn computed<'a>(
        &'a self,
        design: &'a Design,
        stage: usize,
    ) -> impl Iterator<Item = (&'a str, &'a Net)> {
        let mut computed = Vec::new();
        for ((id, net), &at) in design.iter().zip(&self.stage_of) {
            let is_computed_here = match net.driver {
                Driver::Op(_) => at == stage,
                // The word of a block memory is available one stage after its address.
                Driver::Rom(rom) => at == stage + usize::from(design.rom(rom).synchronous),
                _ => false,
            };
            let is_value = net.named && !self.handshake.contains(&id) && !self.is_shared(id);
            if is_computed_here && is_value {
                computed.push((self.value_of[id.index()].as_str(), net));
            }
        }
        computed.into_iter()
    }
}

/// A multiplier together with its output register inside the same DSP block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multiplier {
    /// The net that the output register loads.
    pub product: NetId,
    pub factors: [NetId; 2],
}

impl Design {
    /// Returns the multiplier whose output register is `register`, or `None` for any other register.
    pub fn multiplier(&self, register: RegId) -> Option<Multiplier> {
        self.pipeline.as_ref().filter(|it| it.registered.contains(&register))?;
        let product = self.register(register).data?;
        match self.net(product).driver {
            Driver::Op(Op::Mul(a, b)) => Some(Multiplier { product, factors: [a, b] }),
            _ => None,
        }
    }
}
