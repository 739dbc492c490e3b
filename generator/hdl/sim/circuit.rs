//! Wraps a compiled design as one block of the simulation kernel rust_hdl. rust_hdl drives the clock, checks the ports and writes
//! waveforms. Glint computes the nets.

use std::sync::Arc;

use anyhow::{Result, anyhow};
use rust_hdl::core::check_error::check_all;
use rust_hdl::core::prelude::{Block, Clock, In, Logic, Probe, Signal};
use rust_hdl::core::signal::get_signal_id;

use crate::netlist::{Design, NetId, Partition};
use crate::sim::machine::Machine;
use crate::sim::program::CompiledDesign;
use crate::sim::wire::{Direction, ProbeView, Wire};

/// `LANES` independent instances of a design as one rust_hdl [`Block`]. rust_hdl updates the block until nothing changes, and
/// writes the waveform of lane 0.
///
/// The caller must change inputs together with the falling edge of [`Circuit::clock`]. Inputs that change together with the
/// rising edge take effect only after this edge.
#[derive(Debug)]
pub struct Circuit<const LANES: usize = 1> {
    /// The clock; registers change on the rising edge.
    pub clock: Signal<In, Clock>,
    pub(super) machine: Machine<LANES>,
    inputs: Vec<[u64; LANES]>,
    /// Whether the machine has not yet read inputs that were set.
    input_set: bool,
    /// Whether the latest update had an edge or changed a value.
    changed: bool,
    connected: bool,
    ports: Vec<Observed>,
    /// The scopes of a waveform: control unit and datapath, or the handshake and the stages of a pipeline.
    scopes: Vec<(String, Vec<Observed>)>,
    microprogram: MicroinstructionNames,
}

#[derive(Debug)]
struct Observed {
    net: NetId,
    name: String,
    width: u32,
    signed: bool,
    direction: Direction,
    id: usize,
}

impl Observed {
    /// Makes an observed net, with an id from rust_hdl's counter.
    fn new(design: &Design, net: NetId, direction: Direction) -> Self {
        Self {
            net,
            name: design.net(net).name.clone(),
            width: design.width(net),
            signed: design.net(net).format.signed,
            direction,
            id: get_signal_id(),
        }
    }
}

#[derive(Debug)]
struct MicroinstructionNames {
    names: Arc<[String]>,
    /// The address counter and the run flag; `None` without a microprogram.
    state: Option<(NetId, NetId)>,
    id: usize,
}

impl<const LANES: usize> Circuit<LANES> {
    /// Compiles a design and lets rust_hdl check the result. The circuit is in the state after power-up, with the clock low.
    ///
    /// # Errors
    /// Fails if the design has mistakes in its structure, or 2^32 ROM words or more, or if rust_hdl's `check_all` finds a fault.
    pub fn new(design: &Design) -> Result<Self> {
        let program = Arc::new(CompiledDesign::new(design)?);
        let inputs = vec![[0; LANES]; program.inputs()];
        let mut ports = Vec::new();
        for port in &design.ports {
            let direction = if port.role.is_input() { Direction::Input } else { Direction::Output };
            ports.push(Observed::new(design, port.net, direction));
        }
        let scopes = scopes(design).into_iter().map(|(name, nets)| {
            let local = nets.into_iter().map(|net| Observed::new(design, net, Direction::Local));
            (name, local.collect())
        });
        let mut circuit = Self {
            clock: Signal::default(),
            machine: Machine::new(program),
            inputs,
            input_set: false,
            changed: false,
            connected: false,
            ports,
            scopes: scopes.collect(),
            microprogram: MicroinstructionNames::new(design),
        };
        circuit.connect_all();
        check_all(&circuit).map_err(|error| anyhow!("rust_hdl rejects the circuit: {error:?}"))?;
        Ok(circuit)
    }

    /// Returns the values of the input ports for the caller to change, in the order of the ports. Bits beyond the width of a port
    /// are ignored. New values take effect at rust_hdl's next update.
    pub fn inputs_mut(&mut self) -> &mut Vec<[u64; LANES]> {
        self.input_set = true;
        &mut self.inputs
    }

    fn wire<'a>(&self, id: usize, bits: u64, seen: ProbeView<'a>) -> Wire<'a> {
        Wire { id, connected: self.connected, changed: self.changed, bits, seen }
    }

    fn visit(&self, nets: &[Observed], probe: &mut dyn Probe) {
        for net in nets {
            let (width, signed, direction) = (net.width, net.signed, net.direction);
            let bits = self.machine.lane(net.net, 0);
            let wire = self.wire(net.id, bits, ProbeView::Net { width, signed, direction });
            probe.visit_atom(&net.name, &wire);
        }
    }
}

/// Returns the scopes of a waveform, each with its named nets that are no ports: `control` and `datapath`; for a pipeline
/// `control`, with the handshake, and `stage_0`, `stage_1` and so on.
pub(super) fn scopes(design: &Design) -> Vec<(String, Vec<NetId>)> {
    let mut names = vec!["control".to_owned()];
    match &design.pipeline {
        Some(pipeline) => names.extend((0..=pipeline.stages.len()).map(|at| format!("stage_{at}"))),
        None => names.push("datapath".to_owned()),
    }
    let mut scopes: Vec<_> = names.into_iter().map(|name| (name, Vec::new())).collect();
    for (id, net) in design.iter() {
        let is_port = design.ports.iter().any(|port| port.net == id);
        if !net.named || is_port {
            continue;
        }
        let scope = match &design.pipeline {
            Some(pipeline) if pipeline.handshake.contains(&id) => 0,
            Some(pipeline) => 1 + pipeline.clock_of(id),
            None => usize::from(net.partition == Partition::Datapath),
        };
        scopes[scope].1.push(id);
    }
    scopes
}

impl MicroinstructionNames {
    fn new(design: &Design) -> Self {
        let control = &design.control;
        let names = control.microprogram.iter().map(|it| it.name.clone()).collect();
        let mut state = None;
        if !control.microprogram.is_empty()
            && let Some(address) = design.registers.get(control.address.index())
            && let Some(run) = design.registers.get(control.run.index())
        {
            state = Some((address.q, run.q));
        }
        Self { names, state, id: get_signal_id() }
    }
}

impl<const LANES: usize> Logic for Circuit<LANES> {
    fn update(&mut self) {
        let edge = self.clock.pos_edge();
        let inputs = self.input_set.then_some(self.inputs.as_slice());
        let changed = (edge || inputs.is_some()) && self.machine.update(edge, inputs);
        self.changed = edge || changed;
        self.input_set = false;
    }

    fn connect(&mut self) {
        self.clock.connect();
        self.connected = true;
    }
}

impl<const LANES: usize> Block for Circuit<LANES> {
    fn connect_all(&mut self) {
        self.connect();
        self.clock.connect_all();
    }

    fn update_all(&mut self) {
        self.clock.update_all();
        self.update();
    }

    fn has_changed(&self) -> bool {
        self.changed || self.clock.has_changed()
    }

    fn accept(&self, name: &str, probe: &mut dyn Probe) {
        probe.visit_start_scope(name, self);
        self.clock.accept("clk", probe);
        self.visit(&self.ports, probe);
        for (at, (scope, nets)) in self.scopes.iter().enumerate() {
            probe.visit_start_namespace(scope, self);
            self.visit(nets, probe);
            if let (0, Some((address, run))) = (at, self.microprogram.state) {
                let [address, run] = [address, run].map(|net| self.machine.lane(net, 0));
                let names = &self.microprogram.names;
                let seen = ProbeView::Microinstruction { names, run: run == 1 };
                let name = self.wire(self.microprogram.id, address, seen);
                probe.visit_atom("microinstruction", &name);
            }
            probe.visit_end_namespace(scope, self);
        }
        probe.visit_end_scope(name, self);
    }
}
