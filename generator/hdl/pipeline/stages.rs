//! Builds the pipelined design from a schedule, which has the stage of each value.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::graph::{self, Cell, Graph, NodeId};
use super::schedule::{Schedule, ScheduleProblem, megahertz};
use super::sharing;
use super::split::integer;
use super::unroll::Unrolled;
use super::{Delays, Goal, Options};
use crate::area::Features;
use crate::netlist::{
    self, About, Checkpoint, Delayed, Design, Driver, Net, NetId, NetlistRom, Op, Pipeline, Port,
    RegId, RegisterKind, Role, RomId, Stage, TABLE_LOAD, TABLE_READY, Topic, WritePort,
};
use glint_base::fixed::Format;
use glint_base::target::Timing;

/// Builds the netlist of a pipeline: the logic of every stage, the registers between stages, and the handshake. `sequential` is
/// the design that was unrolled; names, comments and notes come from it. `interval` is the number of clocks between points.
pub fn assemble(
    sequential: &Design,
    unrolled: &Unrolled,
    problems: &ScheduleProblem<'_>,
    schedule: &Schedule,
    (options, interval): (&Options, usize),
) -> Design {
    let notes = sequential.about.notes.iter();
    let about = About {
        title: match interval {
            1 => format!("{}, one point per clock", sequential.about.title),
            clocks => format!("{}, one point per {clocks} clocks", sequential.about.title),
        },
        notes: notes.filter(|note| note.topic == Topic::Device).cloned().collect(),
        ..sequential.about.clone()
    };
    let pipeline = Pipeline {
        target: options.target.name.to_owned(),
        clock_mhz: match options.goal {
            Goal::ClockMhz(clock) => clock,
            Goal::Stages(_) => megahertz(schedule.period),
        },
        most_mhz: problems.fastest().map_or(f64::INFINITY, |it| megahertz(it.period)),
        interval,
        stall: options.stall,
        side: options.side,
        delay_memory: options.target.delay_memory.filter(|_| options.delays != Delays::Registers),
        ..Pipeline::default()
    };
    let mut builder = StageBuilder {
        sequential,
        graph: &unrolled.graph,
        problems,
        schedule,
        design: Design {
            about,
            functions: sequential.functions.clone(),
            ..Design::empty(&sequential.name)
        },
        pipeline,
        advance: None,
        shared: HashMap::new(),
        taken: HashSet::from(["clk".to_owned()]),
        names: HashMap::new(),
        values: HashMap::new(),
        memories: HashMap::new(),
    };
    builder.ports(unrolled, options);
    builder.names();
    builder.handshake();
    let units = builder.units(options.registered);
    builder.cells();
    builder.muxes(units);
    builder.results(unrolled);
    let stages = builder.stages(unrolled);
    let checkpoints = builder.checkpoints(unrolled);
    let StageBuilder { mut design, pipeline, .. } = builder;
    design.ports.sort_by_key(|port| match port.role {
        role if role.is_input() => 0,
        Role::InReady => 1,
        Role::Valid => 2,
        Role::SideOut => 4,
        _ => 3,
    });
    design.pipeline = Some(Pipeline { stages, checkpoints, ..pipeline });
    if options.delays == Delays::Auto {
        keep_registers_beside_tables(&mut design, options.target);
    }
    count_delayed(&mut design);
    design
}

/// Lets as many registers stay in delay lines as the logic has look-up tables: each look-up table has a register beside it.
fn keep_registers_beside_tables(design: &mut Design, target: &Timing) {
    let Some(family) = target.family() else { return };
    let features = Features::new(design, family);
    let luts = features.luts(family) - features.delay;
    if let Some(pipeline) = &mut design.pipeline {
        pipeline.registers_beside_tables = luts as u32;
    }
}

/// Moves bits that memories store in place of registers from the stages' `register_bits` to their `delayed_bits`.
fn count_delayed(design: &mut Design) {
    let lines = design.delay_lines();
    let passed = lines.iter().flat_map(|line| &line.values).flat_map(Delayed::passed);
    let passed: Vec<NetId> = passed.map(|&it| design.register(it).q).collect();
    for q in passed {
        let bits = design.width(q);
        let Some(pipeline) = &mut design.pipeline else { return };
        let stage = &mut pipeline.stages[pipeline.stage_of[q.index()] - 1];
        stage.register_bits -= bits;
        stage.delayed_bits += bits;
    }
}

struct StageBuilder<'a> {
    sequential: &'a Design,
    graph: &'a Graph,
    problems: &'a ScheduleProblem<'a>,
    schedule: &'a Schedule,
    design: Design,
    /// Stages and checkpoints are added last.
    pipeline: Pipeline,
    /// The net that is 1 if every point moves to the next stage; `None` if the pipeline cannot stall, so that points always move.
    advance: Option<NetId>,
    /// For each product that shares a multiplier, the register behind the multiplier.
    shared: HashMap<NodeId, NetId>,
    taken: HashSet<String>,
    /// The names of the nodes, without the suffix of a stage.
    names: HashMap<NodeId, String>,
    /// The net with the value of a node in a stage; constants have stage 0.
    values: HashMap<(NodeId, usize), NetId>,
    /// For each ROM of the sequential design, its read ports in the pipeline.
    memories: HashMap<RomId, Vec<RomId>>,
}

impl StageBuilder<'_> {
    /// Adds a net to `stage`. The net has the source line of the sequential design's first net until `labelled` changes the
    /// line.
    fn net(&mut self, name: String, stage: usize, format: Format, driver: Driver) -> NetId {
        self.taken.insert(name.clone());
        self.pipeline.stage_of.push(stage);
        self.pipeline.value_of.push(name.clone());
        let location = self.sequential.nets[0].location;
        self.design.add_net(Net::new(name, format, driver, location))
    }

    fn documented(&mut self, id: NetId, doc: &str) -> NetId {
        doc.clone_into(&mut self.design.nets[id.index()].doc);
        id
    }

    fn labelled(&mut self, id: NetId, node: NodeId) -> NetId {
        if let Some(name) = self.names.get(&node) {
            name.clone_into(&mut self.pipeline.value_of[id.index()]);
        }
        let node = self.graph.node(node);
        let net = &mut self.design.nets[id.index()];
        net.range = node.range;
        net.block = node.label.block;
        net.doc.clone_from(&node.label.doc);
        net.location = node.label.location;
        id
    }

    fn register(&mut self, q: NetId, data: NetId, enable: Option<NetId>, reset: Option<u64>) {
        let register = self.design.add_register(q, RegisterKind::Internal);
        (register.data, register.enable, register.reset) = (Some(data), enable, reset);
    }

    /// Adds a port with the comment `doc`. Inputs belong to stage 0, outputs to the last stage.
    fn port(&mut self, name: &str, width: u32, role: Role, doc: &str) -> NetId {
        let format = Format::unsigned(width as i32, 0);
        let stage = if role.is_input() { 0 } else { self.schedule.latency };
        let id = self.net(name.to_owned(), stage, format, Driver::Input);
        self.design.ports.push(Port { net: id, role });
        self.documented(id, doc)
    }

    /// Makes the input ports, and reserves the names of the output ports.
    fn ports(&mut self, unrolled: &Unrolled, options: &Options) {
        self.port(
            "rst_n",
            1,
            Role::Reset,
            "reset, active low: discards all points in the pipeline",
        );
        self.port("in_valid", 1, Role::InValid, "the operands are valid");
        for (at, &operand) in unrolled.operands.iter().enumerate() {
            let net = self.sequential.net(operand).clone();
            let id = self.net(net.name.clone(), 0, net.format, Driver::Input);
            let stored = &mut self.design.nets[id.index()];
            (stored.doc, stored.block, stored.location) = (net.doc, net.block, net.location);
            self.design.ports.push(Port { net: id, role: Role::Point });
            for node in self.problems.live() {
                if self.graph.node(*node).cell == Cell::Operand(at) {
                    self.names.insert(*node, net.name.clone());
                    self.values.insert((*node, 0), id);
                }
            }
        }
        self.write_ports();
        if options.side > 0 {
            self.port("side_in", options.side, Role::SideIn, "side data, delayed like the point");
        }
        if options.stall {
            self.port("out_ready", 1, Role::OutReady, "the receiver accepts the results");
        }
        let outputs =
            unrolled.results.iter().map(|(port, _)| self.sequential.net(*port).name.clone());
        let outputs: Vec<String> = outputs.collect();
        self.taken.extend(outputs);
    }

    fn names(&mut self) {
        for &id in self.problems.live() {
            if !self.names.contains_key(&id) {
                let wish = self.graph.node(id).label.name.clone();
                let name = self.distinct(&wish);
                self.names.insert(id, name);
            }
        }
    }

    /// Returns `wish`, with a number if another value has this name in any stage: a second `base` is `base_2`.
    fn distinct(&self, wish: &str) -> String {
        let mut name = wish.to_owned();
        let mut number = 2;
        while self.names.values().any(|other| *other == name) {
            name = format!("{wish}_{number}");
            number += 1;
        }
        name
    }

    /// Returns the name of a value in a stage: `base` in stage 3 is `base_s3`.
    fn staged(&self, name: &str, stage: usize) -> String {
        self.free(format!("{name}_s{stage}"))
    }

    /// Appends `_` until no other net has this name.
    fn free(&self, mut name: String) -> String {
        while self.taken.contains(&name) {
            name.push('_');
        }
        name
    }

    fn net_with(&self, role: Role) -> Option<NetId> {
        self.design.port(|it| it == role).map(|it| it.net)
    }

    /// Makes the valid bits, the stall signal `advance`, the slot counter, the side channel, and their ports.
    fn handshake(&mut self) {
        let latency = self.schedule.latency;
        let offered = self.net_with(Role::InValid).expect("every pipeline has the port");
        let mut valid = vec![offered];
        for stage in 1..=latency {
            let name = self.staged("valid", stage);
            let id = self.net(name, stage, Format::BIT, Driver::Undriven);
            let what = if stage == latency {
                "the results are on the outputs".to_owned()
            } else {
                format!("stage {stage} holds a point")
            };
            self.documented(id, &what);
            self.pipeline.handshake.push(id);
            valid.push(id);
        }
        let last = valid[latency];
        let out_valid =
            self.net("out_valid".to_owned(), latency, Format::BIT, Driver::Op(Op::Relabel(last)));
        self.documented(out_valid, "the results are on the outputs");
        self.pipeline.handshake.push(out_valid);
        self.design.ports.push(Port { net: out_valid, role: Role::Valid });
        if let Some(ready) = self.net_with(Role::OutReady) {
            let empty =
                self.net("no_result".to_owned(), latency, Format::BIT, Driver::Op(Op::Not(last)));
            self.design.nets[empty.index()].named = false;
            let op = Driver::Op(Op::Or(ready, empty));
            let advance = self.net("advance".to_owned(), latency, Format::BIT, op);
            self.documented(advance, "all points advance by one stage");
            self.advance = Some(advance);
            self.pipeline.handshake.extend([empty, advance]);
        }
        let first = self.slots();
        let ready = match (self.advance, first) {
            (Some(advance), Some(first)) => Some(Op::And(advance, first)),
            (one, other) => one.or(other).map(Op::Relabel),
        };
        if let Some(ready) = ready {
            let in_ready = self.net("in_ready".to_owned(), latency, Format::BIT, Driver::Op(ready));
            self.documented(in_ready, "the pipeline accepts a point");
            self.pipeline.handshake.push(in_ready);
            self.design.ports.push(Port { net: in_ready, role: Role::InReady });
        }
        if let Some(first) = first {
            valid[0] = self.inner("offered", Format::BIT, Driver::Op(Op::And(offered, first)));
        }
        for stage in 1..=latency {
            self.register(valid[stage], valid[stage - 1], self.advance, Some(0));
        }
        self.table_ready(&valid, offered);
        self.pipeline.valid = valid.split_off(1);
        if let Some(mut side) = self.net_with(Role::SideIn) {
            let format = self.design.net(side).format;
            for stage in 1..=latency {
                let name = self.staged("side", stage);
                let q = self.net(name, stage, format, Driver::Undriven);
                self.register(q, side, self.advance, None);
                self.pipeline.side_values.push(q);
                side = q;
            }
            let driver = Driver::Op(Op::Relabel(side));
            let out = self.net("side_out".to_owned(), latency, format, driver);
            self.documented(out, "side_in of the point on the outputs");
            self.design.ports.push(Port { net: out, role: Role::SideOut });
        }
    }

    /// Adds a net of the handshake whose name is generated.
    fn inner(&mut self, name: &str, format: Format, driver: Driver) -> NetId {
        let id = self.net(self.free(name.to_owned()), 0, format, driver);
        self.design.nets[id.index()].named = false;
        self.pipeline.handshake.push(id);
        id
    }

    /// Makes the counter of slots, and returns the net that is 1 in slot 0. Returns `None` for an
    /// interval of 1, which needs no counter.
    fn slots(&mut self) -> Option<NetId> {
        let last = self.pipeline.interval.checked_sub(1).filter(|last| *last > 0)?;
        let bits = usize::BITS - last.leading_zeros();
        let format = Format::unsigned(bits as i32, 0);
        let slot = self.net(self.free("slot".to_owned()), 1, format, Driver::Undriven);
        self.documented(
            slot,
            "counts clocks modulo the interval: a point leaves stage s in slot s modulo the \
                               interval",
        );
        self.pipeline.handshake.push(slot);
        self.pipeline.slot = Some(slot);
        let first = self.is_slot(slot, 0);
        let one = self.inner("slot_step", format, Driver::Constant(1));
        let next = Op::Add { a: slot, b: one, carry: None };
        let mut next = self.inner("slot_after", format, Driver::Op(next));
        if !self.pipeline.interval.is_power_of_two() {
            let begin = self.inner("slot_begin", format, Driver::Constant(0));
            let select = self.is_slot(slot, last);
            let inputs = vec![next, begin];
            next = self.inner("slot_next", format, Driver::Op(Op::Mux { select, inputs }));
        }
        self.register(slot, next, self.advance, Some(0));
        Some(first)
    }

    fn is_slot(&mut self, slot: NetId, number: usize) -> NetId {
        let format = self.design.net(slot).format;
        let value = Driver::Constant(number as u64);
        let number = self.inner(&format!("slot_{number}"), format, value);
        self.inner("slot_is", Format::BIT, Driver::Op(Op::Equal(slot, number)))
    }

    /// Returns the enable of the registers behind `stage`, which store the stage's values until its next point. The enable is 1
    /// only in the slot in which a point leaves `stage`. With an interval of 1, the enable is `advance`, or `None` if points
    /// always move.
    fn load(&mut self, stage: usize) -> Option<NetId> {
        let Some(slot) = self.pipeline.slot else { return self.advance };
        let number = stage % self.pipeline.interval;
        if let Some(&load) = self.pipeline.loads.get(&number) {
            return Some(load);
        }
        let here = self.is_slot(slot, number);
        let op = self.advance.map_or(Op::Relabel(here), |advance| Op::And(advance, here));
        let load = self.net(self.free(format!("load_{number}")), 0, Format::BIT, Driver::Op(op));
        self.documented(load, &format!("the stages of slot {number} advance"));
        self.pipeline.handshake.push(load);
        self.pipeline.loads.insert(number, load);
        Some(load)
    }

    /// Makes the shared multipliers, without the muxes of their factors. Returns each multiplier with the nets of its two
    /// operand registers. `registered` says whether products use the registers inside the multipliers.
    fn units(&mut self, registered: bool) -> Vec<(sharing::MultiplierUnit, [NetId; 2])> {
        let mut made = Vec::new();
        for (number, unit) in (1..).zip(self.problems.units(self.schedule)) {
            let products: Vec<NodeId> = unit.serves.iter().flatten().map(|(id, _)| *id).collect();
            let first = products.iter().map(|id| self.schedule.stage[id.index()]).min();
            let stage = first.unwrap_or(2);
            let name = self.free(format!("multiplier_{number}"));
            let factors = [(unit.widths[0], "a"), (unit.widths[1], "b")].map(|(width, letter)| {
                let name = self.free(format!("{name}_{letter}"));
                let format = integer(unit.signed, width);
                let q = self.net(name, stage - 1, format, Driver::Undriven);
                self.documented(q, "factor of the product of this slot")
            });
            let wide = integer(unit.signed, unit.widths[0] + unit.widths[1]);
            let op = Driver::Op(Op::Mul(factors[0], factors[1]));
            let product = self.net(self.free(format!("{name}_product")), stage - 1, wide, op);
            let q = self.net(name.clone(), stage, wide, Driver::Undriven);
            if registered {
                self.pipeline.registered.push(RegId(self.design.registers.len() as u32));
            }
            self.register(q, product, self.advance, None);
            for id in products {
                self.shared.insert(id, q);
            }
            // The multiplier works in the slot before the one in which its register has the product.
            let mut serves = Vec::new();
            for slot in 0..self.pipeline.interval {
                let served = unit.serves[(slot + 1) % self.pipeline.interval].as_ref();
                serves.push(served.map(|(id, _)| self.names[id].clone()));
            }
            let nets = vec![factors[0], factors[1], product, q];
            self.pipeline.units.push(netlist::Unit { name, nets, serves });
            made.push((unit, factors));
        }
        made
    }

    /// Makes the operand registers of shared multipliers, behind muxes that choose the factors by the slot. A factor leaves its
    /// stage two stages before the product is available.
    fn muxes(&mut self, units: Vec<(sharing::MultiplierUnit, [NetId; 2])>) {
        for (at, (unit, factors)) in units.into_iter().enumerate() {
            for (side, q) in factors.into_iter().enumerate() {
                let mut inputs = vec![None; self.pipeline.interval];
                for (id, of) in unit.serves.iter().flatten() {
                    let stage = self.schedule.stage[id.index()] - 2;
                    let value = self.value(of[side], stage);
                    inputs[stage % self.pipeline.interval] = Some(self.widened(value, q));
                }
                // In a slot without a product, the factor has no effect. The mux keeps the input of the slot before, so that it
                // needs less logic.
                let first = inputs.iter().rev().flatten().next().copied();
                let mut known = first.unwrap_or(q);
                let mut filled: Vec<NetId> = Vec::new();
                for input in inputs {
                    known = input.unwrap_or(known);
                    filled.push(known);
                }
                let data = match self.pipeline.slot {
                    Some(select) if filled.iter().any(|it| *it != filled[0]) => {
                        let name = self.free(format!("{}_next", self.design.net(q).name));
                        let format = self.design.net(q).format;
                        let stage = self.pipeline.stage_of[q.index()] - 1;
                        let mux = Driver::Op(Op::Mux { select, inputs: filled });
                        let chosen = self.net(name, stage, format, mux);
                        self.pipeline.units[at].nets.insert(0, chosen);
                        chosen
                    }
                    _ => filled[0],
                };
                self.register(q, data, self.advance, None);
            }
        }
    }

    /// Extends `value` to the width of the net `as_many`.
    fn widened(&mut self, value: NetId, as_many: NetId) -> NetId {
        let format = self.design.net(as_many).format;
        if self.design.width(value) == format.width() {
            return value;
        }
        let name = self.free(format!("{}_wide", self.design.net(value).name));
        let stage = self.pipeline.stage_of[value.index()];
        let wide = self.net(name, stage, format, Driver::Op(Op::Extend(value)));
        self.design.nets[wide.index()].named = false;
        wide
    }

    /// Makes the value of every node in its stage, and the registers that carry the value to its last use. With an interval
    /// above 1, such a register stores the value until the next point arrives.
    fn cells(&mut self) {
        let last = self.problems.last_use(self.schedule);
        for &id in self.problems.live() {
            let stage = self.schedule.stage[id.index()];
            let node = self.graph.node(id);
            let mut value = match &node.cell {
                Cell::Operand(_) => self.values[&(id, 0)],
                Cell::Read { rom, address } => self.read(id, *rom, *address, stage),
                Cell::Op(_) if self.shared.contains_key(&id) => self.shared_product(id, stage),
                Cell::Op(op) if self.problems.is_clocked(id) => {
                    let product = self.cell(id, op, stage - 1);
                    self.pipeline.registered.push(RegId(self.design.registers.len() as u32));
                    self.behind(id, product, stage, self.advance)
                }
                Cell::Op(op) => self.cell(id, op, stage),
                Cell::Constant(_) | Cell::Unknown(_) => continue,
            };
            self.values.insert((id, stage), value);
            let last = last[id.index()];
            for from in (stage..last).step_by(self.pipeline.interval) {
                // If only the next stage reads the value, the register may load on every clock.
                let enable = if last - stage > 1 { self.load(from) } else { self.advance };
                value = self.behind(id, value, from + 1, enable);
                let held = from + 1..=last.min(from + self.pipeline.interval);
                self.values.extend(held.map(|stage| ((id, stage), value)));
            }
        }
    }

    /// Returns the net of a product that shares a multiplier: the low bits of the multiplier's register.
    fn shared_product(&mut self, id: NodeId, stage: usize) -> NetId {
        let (of, format) = (self.shared[&id], self.graph.node(id).format);
        let op = match self.design.width(of) == format.width() {
            true => Op::Relabel(of),
            false => Op::Slice { of, low: 0 },
        };
        self.of_node(id, stage, Driver::Op(op), self.graph.node(id).label.named)
    }

    fn of_node(&mut self, id: NodeId, stage: usize, driver: Driver, named: bool) -> NetId {
        let name = self.staged(&self.names[&id], stage);
        let net = self.net(name, stage, self.graph.node(id).format, driver);
        self.labelled(net, id);
        self.design.nets[net.index()].named = named;
        net
    }

    fn cell(&mut self, id: NodeId, op: &graph::NodeOp, stage: usize) -> NetId {
        let cell = op.map(|&operand| self.value(operand, stage));
        self.of_node(id, stage, Driver::Op(cell), self.graph.node(id).label.named)
    }

    /// Makes a register in `stage` for the value of node `id`. `value` is the net with this value in the stage before.
    fn behind(&mut self, id: NodeId, value: NetId, stage: usize, enable: Option<NetId>) -> NetId {
        let q = self.of_node(id, stage, Driver::Undriven, true);
        self.register(q, value, enable, None);
        q
    }

    /// Returns the net with the value of node `id` in `stage`, and makes a constant or an extension if necessary.
    fn value(&mut self, id: NodeId, stage: usize) -> NetId {
        let node = self.graph.node(id);
        let key = if let Cell::Constant(_) = node.cell { (id, 0) } else { (id, stage) };
        if let Some(&net) = self.values.get(&key) {
            return net;
        }
        let Cell::Constant(bits) = node.cell else {
            return self.extension(id, stage);
        };
        let mut name = node.label.name.clone();
        let mut number = 2;
        while self.taken.contains(&name) {
            name = format!("{}_{number}", node.label.name);
            number += 1;
        }
        let net = self.net(name, 0, node.format, Driver::Constant(bits));
        self.labelled(net, id);
        self.design.nets[net.index()].named = node.label.named;
        self.values.insert(key, net);
        net
    }

    /// Makes an extension in `stage` from the narrower value that registers carry there.
    fn extension(&mut self, id: NodeId, stage: usize) -> NetId {
        let node = self.graph.node(id);
        let Cell::Op(op) = &node.cell else {
            unreachable!("a schedule holds every value to its last use");
        };
        let wiring = op.map(|&operand| self.value(operand, stage));
        let name = self.distinct(&node.label.name);
        self.names.entry(id).or_insert(name);
        // The Verilog has the extension in the expression that reads it.
        let net = self.of_node(id, stage, Driver::Op(wiring), false);
        self.values.insert((id, stage), net);
        net
    }

    /// Makes a read port of a memory, and returns its data. The word of a block memory comes a stage after the address. Two reads
    /// share a memory, which has two ports; a third read starts a second copy.
    fn read(&mut self, id: NodeId, rom: RomId, address: NodeId, stage: usize) -> NetId {
        let synchronous = self.problems.is_clocked(id);
        let address = self.value(address, stage - usize::from(synchronous));
        let source = self.sequential.rom(rom).clone();
        let number = RomId(self.design.roms.len() as u32);
        let data = self.of_node(id, stage, Driver::Rom(number), true);
        let ports = self.memories.entry(rom).or_default();
        let shares = (ports.len() % 2 == 1).then(|| ports[ports.len() - 1]);
        ports.push(number);
        let copy = ports.len().div_ceil(2);
        let name = if copy > 1 { format!("{}_{copy}", source.name) } else { source.name.clone() };
        let name = if shares.is_some() { format!("{name}_second") } else { name };
        let enable = self.advance.filter(|_| synchronous);
        let write = source.write.as_ref().map(|write| self.write_port(write));
        self.design.roms.push(NetlistRom {
            name,
            address,
            data,
            synchronous,
            enable,
            shares,
            write,
            ..source
        });
        data
    }

    /// Makes the inputs of the sequential design's write port.
    fn write_ports(&mut self) {
        for port in &self.sequential.ports {
            if matches!(port.role, Role::TableWrite | Role::TableAddress | Role::TableWord) {
                let net = self.sequential.net(port.net).clone();
                let id = self.net(net.name, 0, net.format, Driver::Input);
                self.design.nets[id.index()].doc = net.doc;
                self.design.ports.push(Port { net: id, role: port.role });
            }
        }
    }

    /// Returns the write port of a memory, with nets of the same names as in the sequential design.
    fn write_port(&self, of: &WritePort) -> WritePort {
        let here = |id: NetId| {
            let name = &self.sequential.net(id).name;
            self.design.find(name).expect("the pipeline has the nets of the write port")
        };
        WritePort {
            enable: here(of.enable),
            address: here(of.address),
            parts: of.parts.iter().map(|&part| here(part)).collect(),
        }
    }

    /// Makes the output `table_ready` and the net that loads a word, if the design has a write port. `table_ready` is 1 while
    /// no stage has a point and no point is offered. `valid` has the valid bits of the stages.
    fn table_ready(&mut self, valid: &[NetId], offered: NetId) {
        let Some(write) = self.net_with(Role::TableWrite) else { return };
        let stages = valid[1..].iter().copied();
        let parts: Vec<NetId> = stages.rev().chain([offered]).collect();
        let format = Format::unsigned(parts.len() as i32, 0);
        let points = self.inner("points", format, Driver::Op(Op::Concat(parts)));
        let any = self.inner("any_point", Format::BIT, Driver::Op(Op::Any(points)));
        let ready = self.net(TABLE_READY.to_owned(), 0, Format::BIT, Driver::Op(Op::Not(any)));
        self.documented(
            ready,
            "no point is in the pipeline or offered, and a written word is loaded",
        );
        let load = Driver::Op(Op::And(write, ready));
        let load = self.net(TABLE_LOAD.to_owned(), 0, Format::BIT, load);
        self.pipeline.handshake.extend([ready, load]);
        self.design.ports.push(Port { net: ready, role: Role::TableReady });
    }

    fn results(&mut self, unrolled: &Unrolled) {
        let latency = self.schedule.latency;
        for &(port, id) in &unrolled.results {
            let value = self.value(id, latency);
            let net = self.sequential.net(port).clone();
            let driver = Driver::Op(Op::Relabel(value));
            let out = self.net(net.name, latency, net.format, driver);
            let stored = &mut self.design.nets[out.index()];
            (stored.range, stored.doc, stored.block) = (net.range, net.doc, net.block);
            stored.location = net.location;
            let sequential_port = self.sequential.ports.iter().find(|it| it.net == port);
            let role = sequential_port.map_or(Role::Result, |it| it.role);
            self.design.ports.push(Port { net: out, role });
        }
    }

    fn stages(&self, unrolled: &Unrolled) -> Vec<Stage> {
        let mut stages = Vec::new();
        for stage in 0..self.schedule.latency {
            let logic = self.schedule.logic[stage];
            stages.push(Stage {
                microinstructions: self.microinstructions(unrolled, stage),
                logic_ns: logic,
                slack_ns: self.schedule.period - self.problems.register_ns() - logic,
                register_bits: self.register_bits(stage + 1),
                delayed_bits: 0,
            });
        }
        stages
    }

    /// Returns the microinstructions whose operations a stage computes, in the order of execution.
    fn microinstructions(&self, unrolled: &Unrolled, stage: usize) -> Vec<String> {
        let mut steps: BTreeSet<usize> = BTreeSet::new();
        for &id in self.problems.live() {
            let node = self.graph.node(id);
            let is_logic = !node.cell.is_wiring() && !matches!(node.cell, Cell::Operand(_));
            if is_logic && self.computed_in(id) == stage {
                steps.insert(node.step);
            }
        }
        let mut names: Vec<String> = Vec::new();
        for step in steps {
            let address = unrolled.steps.get(step).map_or(0, |step| step.address);
            let name = &self.sequential.control.microprogram[address].name;
            if names.last() != Some(name) {
                names.push(name.clone());
            }
        }
        names
    }

    /// Returns the number of register bits in the row behind stage `boundary` − 1, without those inside multipliers and block
    /// memories.
    fn register_bits(&self, boundary: usize) -> u32 {
        let mut bits = 0;
        for (id, register) in (0..).map(RegId).zip(&self.design.registers) {
            let is_at_boundary = self.pipeline.stage_of[register.q.index()] == boundary;
            if is_at_boundary && !self.pipeline.registered.contains(&id) {
                bits += self.design.width(register.q);
            }
        }
        bits
    }

    /// Returns the stage whose logic computes a node: the stage before its own for a product with a register behind it.
    fn computed_in(&self, id: NodeId) -> usize {
        let product = matches!(self.graph.node(id).cell, Cell::Op(_));
        self.schedule.stage[id.index()] - usize::from(product && self.problems.is_clocked(id))
    }

    /// Returns the nets with the values of operand registers and architectural registers, each with the first executed
    /// microinstruction at which the register has this value. Constants and nets with generated names are left out.
    fn checkpoints(&self, unrolled: &Unrolled) -> Vec<Checkpoint> {
        let mut before: HashMap<RegId, NodeId> = HashMap::new();
        let mut checkpoints = Vec::new();
        for step in &unrolled.steps {
            for &(register, node) in &step.registers {
                if before.insert(register, node) == Some(node) {
                    continue;
                }
                let stage = self.schedule.stage[node.index()];
                if let Some(&net) = self.values.get(&(node, stage))
                    && self.design.net(net).named
                    && !matches!(self.graph.node(node).cell, Cell::Constant(_))
                {
                    let register = self.sequential.register(register).q;
                    checkpoints.push(Checkpoint {
                        register: self.sequential.net(register).name.clone(),
                        address: step.address,
                        visit: step.visit,
                        net,
                    });
                }
            }
        }
        checkpoints
    }
}
