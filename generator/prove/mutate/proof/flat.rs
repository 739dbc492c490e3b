//! Makes a copy of a pipeline without delay: every register passes on its input at once, except the handshake's registers.
//!
//! A multiplier that several products share becomes one multiplier for each product. The copy computes the same results for a
//! single point, and a proof about a fault can reach across the stages.

use std::collections::BTreeMap;

use glint_rtl::netlist::{Design, Driver, Net, NetId, Op, Pipeline};

/// A copy of a pipeline with data registers that pass on their inputs at once.
pub(super) struct Flat {
    pub(super) design: Design,
    /// The copies of each net of a shared multiplier: one net for each product.
    pub(super) copies: BTreeMap<NetId, Vec<NetId>>,
    /// The slot in which each copy's factors are chosen, in the order of the added nets.
    chosen: Vec<usize>,
}

impl Flat {
    pub(super) fn of(design: &Design, pipeline: &Pipeline) -> Self {
        let mut flat = Self { design: design.clone(), copies: BTreeMap::new(), chosen: Vec::new() };
        let mut taken = vec![false; design.nets.len()];
        for register in &mut flat.design.registers {
            if !pipeline.handshake.contains(&register.q)
                && let Some(data) = register.data.take()
            {
                flat.design.nets[register.q.index()].driver = Driver::Op(Op::Relabel(data));
                taken[register.q.index()] = true;
            }
        }
        let made = flat.unshared(pipeline);
        let interval = pipeline.interval;
        // A product is read in the stage in which its register has it.
        let of = |net: NetId, stage: usize| {
            made.get(&(net, (stage + interval - 1) % interval)).copied().unwrap_or(net)
        };
        for (at, net) in flat.design.nets.iter_mut().enumerate() {
            let stage = match pipeline.stage_of.get(at) {
                Some(stage) => stage - usize::from(taken[at]),
                None => flat.chosen[at - taken.len()],
            };
            if let Driver::Op(op) = &net.driver {
                net.driver = Driver::Op(op.map(|operand| of(*operand, stage)));
            }
        }
        for rom in &mut flat.design.roms {
            let stage = pipeline.stage_of[rom.data.index()] - usize::from(rom.synchronous);
            rom.address = of(rom.address, stage);
        }
        for port in &mut flat.design.ports {
            port.net = of(port.net, pipeline.stages.len());
        }
        let seen = flat.design.pipeline.iter_mut().flat_map(|it| &mut it.checkpoints);
        seen.for_each(|it| it.net = of(it.net, pipeline.clock_of(it.net)));
        flat
    }

    /// Gives each product a multiplier of its own in place of the shared multiplier, whose nets lose their drivers. Returns the
    /// copies by the original net and the product's slot. For example, at an interval of 4, the copy for slot 0 has the factors
    /// that the multiplier chooses in slot 3.
    fn unshared(&mut self, pipeline: &Pipeline) -> BTreeMap<(NetId, usize), NetId> {
        let mut made = BTreeMap::new();
        for unit in &pipeline.units {
            for slot in (0..pipeline.interval).filter(|&slot| unit.serves[slot].is_some()) {
                // The multiplier chooses the factors in the slot before.
                let chosen = (slot + pipeline.interval - 1) % pipeline.interval;
                let mut own: BTreeMap<NetId, NetId> = BTreeMap::new();
                for &net in &unit.nets {
                    let nets = &mut self.design.nets;
                    let id = NetId(nets.len() as u32);
                    let driver = match &nets[net.index()].driver {
                        Driver::Op(Op::Mux { inputs, .. }) => {
                            Driver::Op(Op::Relabel(inputs[chosen]))
                        }
                        Driver::Op(op) => {
                            Driver::Op(op.map(|operand| *own.get(operand).unwrap_or(operand)))
                        }
                        other => other.clone(),
                    };
                    nets.push(Net { driver, ..nets[net.index()].clone() });
                    self.chosen.push(chosen);
                    own.insert(net, id);
                    self.copies.entry(net).or_default().push(id);
                    made.insert((net, slot), id);
                }
            }
            for net in &unit.nets {
                self.design.nets[net.index()].driver = Driver::Undriven;
            }
        }
        made
    }
}
