//! From a schedule to a design: the logic of every stage, and registers between the stages.

use std::collections::{HashMap, HashSet};

use super::graph::{self, Cell, Graph, NodeId};
use super::schedule::{Problems, Schedule, megahertz};
use super::unroll::Unrolled;
use super::{Delays, Goal, Options};
use crate::netlist::{
    About, Checkpoint, Delayed, Design, Driver, Net, NetId, Op, Pipeline, Port, RegId,
    RegisterKind, Role, Rom, RomId, Stage, Topic,
};
use glint_base::fixed::Format;

/// The design of a schedule.
pub fn assemble(
    sequential: &Design,
    unrolled: &Unrolled,
    problems: &Problems<'_>,
    schedule: &Schedule,
    options: &Options,
) -> Design {
    let notes = sequential.about.notes.iter();
    let about = About {
        title: format!("{}, a point a clock", sequential.about.title),
        notes: notes.filter(|note| note.topic == Topic::Device).cloned().collect(),
        ..sequential.about.clone()
    };
    let mut builder = Builder {
        sequential,
        graph: &unrolled.graph,
        problems,
        schedule,
        design: Design { about, ..Design::empty(&sequential.name) },
        stage_of: Vec::new(),
        value_of: Vec::new(),
        advance: None,
        taken: HashSet::from(["clk".to_owned()]),
        names: HashMap::new(),
        values: HashMap::new(),
        flow: Vec::new(),
        valid: Vec::new(),
        side_values: Vec::new(),
        registered: Vec::new(),
        memories: HashMap::new(),
    };
    builder.ports(unrolled, options);
    builder.names();
    builder.handshake();
    builder.cells();
    builder.results(unrolled);
    let stages = builder.stages(unrolled);
    let checkpoints = builder.checkpoints(unrolled);
    let Builder { mut design, stage_of, value_of, flow, valid, side_values, registered, .. } =
        builder;
    design.ports.sort_by_key(|port| match port.role {
        role if role.is_input() => 0,
        Role::InReady => 1,
        Role::Valid => 2,
        Role::SideOut => 4,
        _ => 3,
    });
    design.pipeline = Some(Pipeline {
        target: options.target.name.to_owned(),
        clock_mhz: match options.goal {
            Goal::ClockMhz(clock) => clock,
            Goal::Stages(_) => megahertz(schedule.period),
        },
        most_mhz: problems.fastest().map_or(f64::INFINITY, |it| megahertz(it.period)),
        stall: options.stall,
        side: options.side,
        delay_memory: options.target.delay_memory.filter(|_| options.delays == Delays::Memory),
        stages,
        stage_of,
        value_of,
        handshake: flow,
        valid,
        side_values,
        registered,
        checkpoints,
    });
    count_delayed(&mut design);
    design
}

/// Counts apart what memories hold in place of registers.
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

struct Builder<'a> {
    sequential: &'a Design,
    graph: &'a Graph,
    problems: &'a Problems<'a>,
    schedule: &'a Schedule,
    design: Design,
    /// The stage of every net.
    stage_of: Vec<usize>,
    /// The name of every net's value.
    value_of: Vec<String>,
    /// 1 when every point moves on by a stage; none if they always do.
    advance: Option<NetId>,
    taken: HashSet<String>,
    /// The name of every node's value, without a stage.
    names: HashMap<NodeId, String>,
    /// The net with the value of a node in a stage.
    values: HashMap<(NodeId, usize), NetId>,
    /// The nets of the handshake.
    flow: Vec<NetId>,
    /// Whether a stage has a point, from stage 1 on.
    valid: Vec<NetId>,
    /// The side values of the points, from stage 1 on.
    side_values: Vec<NetId>,
    /// The registers inside multipliers.
    registered: Vec<RegId>,
    /// The read ports of each memory.
    memories: HashMap<RomId, Vec<RomId>>,
}

impl Builder<'_> {
    fn net(&mut self, name: String, stage: usize, format: Format, driver: Driver) -> NetId {
        self.taken.insert(name.clone());
        self.stage_of.push(stage);
        self.value_of.push(name.clone());
        let location = self.sequential.nets[0].location;
        self.design.add_net(Net::new(name, format, driver, location))
    }

    fn documented(&mut self, id: NetId, doc: &str) -> NetId {
        doc.clone_into(&mut self.design.nets[id.index()].doc);
        id
    }

    fn labelled(&mut self, id: NetId, node: NodeId) -> NetId {
        if let Some(name) = self.names.get(&node) {
            name.clone_into(&mut self.value_of[id.index()]);
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

    fn port(&mut self, name: &str, width: u32, role: Role, doc: &str) -> NetId {
        let format = Format::unsigned(width as i32, 0);
        let stage = if role.is_input() { 0 } else { self.schedule.latency };
        let id = self.net(name.to_owned(), stage, format, Driver::Input);
        self.design.ports.push(Port { net: id, role });
        self.documented(id, doc)
    }

    /// The inputs.
    fn ports(&mut self, unrolled: &Unrolled, options: &Options) {
        self.port("rst_n", 1, Role::Reset, "reset, active low: drops the points on their way");
        self.port("in_valid", 1, Role::InValid, "the operands are those of a point");
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
        if options.side > 0 {
            self.port("side_in", options.side, Role::SideIn, "travels with the point");
        }
        if options.stall {
            self.port("out_ready", 1, Role::OutReady, "the results are taken in this clock");
        }
        // Names of outputs are theirs.
        let outputs =
            unrolled.results.iter().map(|(port, _)| self.sequential.net(*port).name.clone());
        let outputs: Vec<String> = outputs.collect();
        self.taken.extend(outputs);
    }

    /// A name for every value.
    fn names(&mut self) {
        for &id in self.problems.live() {
            if !self.names.contains_key(&id) {
                let wish = self.graph.node(id).label.name.clone();
                let name = self.distinct(&wish);
                self.names.insert(id, name);
            }
        }
    }

    /// `wish`, with a number where another value has it in any stage.
    fn distinct(&self, wish: &str) -> String {
        let taken = |name: &String| self.names.values().any(|other| other == name);
        let mut name = wish.to_owned();
        let mut number = 2;
        while taken(&name) {
            name = format!("{wish}_{number}");
            number += 1;
        }
        name
    }

    /// `name` in a stage, as no other net has it.
    fn staged(&self, name: &str, stage: usize) -> String {
        let mut staged = format!("{name}_s{stage}");
        while self.taken.contains(&staged) {
            staged.push('_');
        }
        staged
    }

    /// The points on their way, and when they move.
    fn handshake(&mut self) {
        let latency = self.schedule.latency;
        let find = |design: &Design, role: Role| design.port(|it| it == role).map(|it| it.net);
        let offered = find(&self.design, Role::InValid).expect("every pipeline has the port");
        let mut valid = vec![offered];
        for stage in 1..=latency {
            let name = self.staged("valid", stage);
            let id = self.net(name, stage, Format::BIT, Driver::Undriven);
            let what = if stage == latency {
                "the results are on the outputs".to_owned()
            } else {
                format!("stage {stage} has a point")
            };
            self.documented(id, &what);
            self.flow.push(id);
            valid.push(id);
        }
        let last = valid[latency];
        let out_valid =
            self.net("out_valid".to_owned(), latency, Format::BIT, Driver::Op(Op::Relabel(last)));
        self.documented(out_valid, "the results are on the outputs");
        self.flow.push(out_valid);
        self.design.ports.push(Port { net: out_valid, role: Role::Valid });
        if let Some(ready) = find(&self.design, Role::OutReady) {
            let empty =
                self.net("no_result".to_owned(), latency, Format::BIT, Driver::Op(Op::Not(last)));
            self.design.nets[empty.index()].named = false;
            let op = Driver::Op(Op::Or(ready, empty));
            let advance = self.net("advance".to_owned(), latency, Format::BIT, op);
            self.documented(advance, "every point moves on by a stage");
            self.advance = Some(advance);
            self.flow.extend([empty, advance]);
            let op = Driver::Op(Op::Relabel(advance));
            let in_ready = self.net("in_ready".to_owned(), latency, Format::BIT, op);
            self.documented(in_ready, "a point that is offered is taken in this clock");
            self.flow.push(in_ready);
            self.design.ports.push(Port { net: in_ready, role: Role::InReady });
        }
        for stage in 1..=latency {
            self.register(valid[stage], valid[stage - 1], self.advance, Some(0));
        }
        self.valid = valid.split_off(1);
        if let Some(mut side) = find(&self.design, Role::SideIn) {
            let format = self.design.net(side).format;
            for stage in 1..=latency {
                let name = self.staged("side", stage);
                let q = self.net(name, stage, format, Driver::Undriven);
                self.register(q, side, self.advance, None);
                self.side_values.push(q);
                side = q;
            }
            let driver = Driver::Op(Op::Relabel(side));
            let out = self.net("side_out".to_owned(), latency, format, driver);
            self.documented(out, "side_in of the point whose results are on the outputs");
            self.design.ports.push(Port { net: out, role: Role::SideOut });
        }
    }

    /// The value of every node in its stage, and registers up to its last use.
    fn cells(&mut self) {
        let last = self.problems.last_use(self.schedule);
        for &id in self.problems.live() {
            let stage = self.schedule.stage[id.index()];
            let node = self.graph.node(id);
            let mut value = match &node.cell {
                Cell::Operand(_) => self.values[&(id, 0)],
                Cell::Read { rom, address } => self.read(id, *rom, *address, stage),
                Cell::Op(op) if self.problems.is_clocked(id) => {
                    let product = self.cell(id, op, stage - 1);
                    self.registered.push(RegId(self.design.registers.len() as u32));
                    self.behind(id, product, stage)
                }
                Cell::Op(op) => self.cell(id, op, stage),
                Cell::Constant(_) | Cell::Unknown(_) => continue,
            };
            self.values.insert((id, stage), value);
            for stage in stage + 1..=last[id.index()] {
                value = self.behind(id, value, stage);
                self.values.insert((id, stage), value);
            }
        }
    }

    /// Makes a cell in a stage.
    fn cell(&mut self, id: NodeId, op: &graph::Op, stage: usize) -> NetId {
        let op = op.map(|&operand| self.value(operand, stage));
        let label = &self.graph.node(id).label;
        let name = self.staged(&self.names[&id], stage);
        let net = self.net(name, stage, self.graph.node(id).format, Driver::Op(op));
        self.labelled(net, id);
        self.design.nets[net.index()].named = label.named;
        net
    }

    /// A register of a stage that takes what the stage before has of a node.
    fn behind(&mut self, id: NodeId, value: NetId, stage: usize) -> NetId {
        let name = self.staged(&self.names[&id], stage);
        let q = self.net(name, stage, self.graph.node(id).format, Driver::Undriven);
        self.labelled(q, id);
        self.register(q, value, self.advance, None);
        q
    }

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

    /// Makes an extension in a stage, from the bits that registers hold.
    fn extension(&mut self, id: NodeId, stage: usize) -> NetId {
        let node = self.graph.node(id);
        let Cell::Op(op) = &node.cell else {
            unreachable!("a schedule holds every value to its last use");
        };
        let op = op.map(|&operand| self.value(operand, stage));
        let name = self.distinct(&node.label.name);
        let name = self.names.entry(id).or_insert(name).clone();
        let name = self.staged(&name, stage);
        let net = self.net(name, stage, node.format, Driver::Op(op));
        self.labelled(net, id);
        // It is wiring: written where it is used.
        self.design.nets[net.index()].named = false;
        self.values.insert((id, stage), net);
        net
    }

    /// A read port of a memory: of a block memory the word comes a stage after the address.
    fn read(&mut self, id: NodeId, rom: RomId, address: NodeId, stage: usize) -> NetId {
        let synchronous = self.problems.is_clocked(id);
        let address = self.value(address, stage - usize::from(synchronous));
        let node = self.graph.node(id);
        let source = self.sequential.rom(rom).clone();
        let number = RomId(self.design.roms.len() as u32);
        let name = self.names[&id].clone();
        let name = self.staged(&name, stage);
        let data = self.net(name, stage, node.format, Driver::Rom(number));
        self.labelled(data, id);
        // A memory has two ports.
        let ports = self.memories.entry(rom).or_default();
        let shares = (ports.len() % 2 == 1).then(|| ports[ports.len() - 1]);
        ports.push(number);
        let copy = ports.len().div_ceil(2);
        let name = if copy > 1 { format!("{}_{copy}", source.name) } else { source.name.clone() };
        let name = if shares.is_some() { format!("{name}_second") } else { name };
        let enable = self.advance.filter(|_| synchronous);
        self.design.roms.push(Rom { name, address, data, synchronous, enable, shares, ..source });
        data
    }

    /// The outputs.
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
            let role = self.sequential.ports.iter().find(|it| it.net == port).map(|it| it.role);
            let role = role.unwrap_or(Role::Result);
            self.design.ports.push(Port { net: out, role });
        }
    }

    /// Describes each stage.
    fn stages(&self, unrolled: &Unrolled) -> Vec<Stage> {
        let microprogram = &self.sequential.control.microprogram;
        (0..self.schedule.latency)
            .map(|stage| {
                let mut steps: Vec<usize> = self
                    .problems
                    .live()
                    .iter()
                    .filter(|id| self.computed_in(**id) == stage)
                    .filter(|id| !self.graph.node(**id).cell.is_wiring())
                    .filter(|id| !matches!(self.graph.node(**id).cell, Cell::Operand(_)))
                    .map(|id| self.graph.node(*id).step)
                    .collect();
                steps.sort_unstable();
                steps.dedup();
                let mut microinstructions: Vec<String> = Vec::new();
                for step in steps {
                    let address = unrolled.steps.get(step).map_or(0, |step| step.address);
                    let name = &microprogram[address].name;
                    if microinstructions.last() != Some(name) {
                        microinstructions.push(name.clone());
                    }
                }
                let boundary = stage + 1;
                let registers = (0..).map(RegId).zip(&self.design.registers);
                // A multiplier's own register is none of the fabric, as that of a block memory.
                let registers = registers.filter(|(id, _)| !self.registered.contains(id));
                let bits = registers.map(|(_, register)| register.q);
                let bits = bits.filter(|q| self.stage_of[q.index()] == boundary);
                Stage {
                    microinstructions,
                    logic_ns: self.schedule.logic[stage],
                    slack_ns: self.schedule.period
                        - self.problems.register_ns()
                        - self.schedule.logic[stage],
                    register_bits: bits.map(|q| self.design.width(q)).sum(),
                    delayed_bits: 0,
                }
            })
            .collect()
    }

    /// The stage whose logic makes a node: of a product in the register of a multiplier, that before its own.
    fn computed_in(&self, id: NodeId) -> usize {
        let product = matches!(self.graph.node(id).cell, Cell::Op(_));
        self.schedule.stage[id.index()] - usize::from(product && self.problems.is_clocked(id))
    }

    /// Where values that architectural registers hold are to be seen.
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
