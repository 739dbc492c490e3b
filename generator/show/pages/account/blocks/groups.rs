//! Groups the nets of a netlist into blocks for a block diagram: one block for each statement of the device's description. A
//! statement makes several blocks if its operators do not belong together, such as a multiplier and an adder in a sequential
//! core.
//!
//! For each net, the module finds its *sources*: the blocks, ports and ROMs whose values reach it through wiring and gates alone.
//! A *joint* is a net in which several sources meet, and which an operator, such as an adder, reads. A joint is drawn as a block
//! of gates or wiring.

use std::collections::BTreeSet;

use super::kind::{MULTIPLIER, MUX, operator};
use glint_rtl::netlist::{Design, Driver, Net, NetId, Op, Partition, Role, RomId};

/// A design's nets, grouped into blocks, and each net's sources.
pub struct Groups<'a> {
    pub design: &'a Design,
    /// Each net's group: the lowest number of a net in the group.
    pub group: Vec<usize>,
    /// Whether each net makes its group a block: it is a register, a ROM or an operator, or the description documents or numbers
    /// it.
    pub cell: Vec<bool>,
    /// Each net's sources: the blocks, ports and ROMs whose values reach it within a clock. In a pipeline, a source may lie
    /// several clocks back.
    pub sources: Vec<Vec<NetId>>,
    pub head: Vec<Option<NetId>>,
    pub joints: BTreeSet<NetId>,
}

impl<'a> Groups<'a> {
    pub fn new(design: &'a Design, figure: bool) -> Self {
        let cell = design.iter().map(|(id, net)| is_cell(design, id, net, figure)).collect();
        let mut groups = Self {
            design,
            cell,
            group: Vec::new(),
            sources: Vec::new(),
            head: Vec::new(),
            joints: BTreeSet::new(),
        };
        groups.form(true);
        // If the blocks form a cycle, each operator becomes a block of its own.
        if groups.is_tangled() {
            groups.form(false);
        }
        groups.meet();
        groups
    }

    /// Forms the groups, and finds each net's sources. With `statements`, the nets that one statement of the description made are
    /// a group, if [`Groups::belongs`] allows it. Otherwise each net is a group of its own.
    fn form(&mut self, statements: bool) {
        let design = self.design;
        self.group = (0..design.nets.len()).collect();
        if statements {
            for (id, _) in design.iter() {
                self.join(id);
            }
        }
        for at in 0..self.group.len() {
            self.group[at] = self.root(at);
        }
        self.head = vec![None; self.group.len()];
        for (id, net) in design.iter() {
            if !self.cell[id.index()] {
                continue;
            }
            let head = &mut self.head[self.group[id.index()]];
            // A block's output is preferably a net that the source document numbers, then a net with a name, then the last net.
            let is_better = match head {
                Some(before) => {
                    let before = design.net(*before);
                    (net.block.is_some(), net.named) >= (before.block.is_some(), before.named)
                }
                None => true,
            };
            if is_better {
                *head = Some(id);
            }
        }
        let mut sources: Vec<Option<Vec<NetId>>> = vec![None; self.group.len()];
        for (id, _) in design.iter() {
            self.trace(id, &mut sources);
        }
        self.sources = sources.into_iter().map(Option::unwrap_or_default).collect();
    }

    fn root(&self, mut at: usize) -> usize {
        while self.group[at] != at {
            at = self.group[at];
        }
        at
    }

    /// Joins the group of a net and the groups of the nets from which it is computed, if one statement of the description made
    /// both. For example, the muxes of one tree are a group.
    fn join(&mut self, id: NetId) {
        let design = self.design;
        let net = design.net(id);
        let logic = matches!(net.driver, Driver::Op(_) | Driver::Register(_));
        if !logic || net.partition != Partition::Datapath {
            return;
        }
        let made = if self.cell[id.index()] { self.operators(id) } else { self.operands(id) };
        for from in made {
            let other = design.net(from);
            let logic = matches!(other.driver, Driver::Op(_) | Driver::Register(_));
            if logic && self.is_one_statement(from, id) && self.belongs(from, id) {
                let (from, to) = (self.root(from.index()), self.root(id.index()));
                self.group[from.max(to)] = from.min(to);
            }
        }
    }

    /// Returns whether the net `from` and its reader `to` belong to one block. For example, a mux behind a mux belongs to the
    /// block of the first mux. In a sequential core, an adder behind a multiplier is in a separate block.
    fn belongs(&self, from: NetId, to: NetId) -> bool {
        let design = self.design;
        let (Some(a), Some(b)) = (self.operator(from), self.operator(to)) else {
            return !self.cell[to.index()];
        };
        let is_pipeline = design.pipeline.is_some();
        let before = design.net(from);
        let is_shown = !is_pipeline && (before.block.is_some() || !before.doc.is_empty());
        let both_named = before.named && design.net(to).named;
        match (a, b) {
            (MUX, MUX) => !is_shown,
            // A multiplier begins a statement. Logic that adds to its product, or rounds it, is a block apart.
            (_, MULTIPLIER) => false,
            (MULTIPLIER, _) if !is_pipeline => false,
            (_, MUX) => !(is_shown || both_named && !is_pipeline),
            _ if !is_pipeline => !(both_named || is_shown),
            _ => !self.rounds(to) && self.takes_its_statement_alone(to),
        }
    }

    /// Returns the kind of a net's operator ([`operator`]), or `None` if the net is in no block.
    fn operator(&self, id: NetId) -> Option<usize> {
        match self.cell[id.index()] {
            true => operator(&self.design.net(id).driver),
            false => None,
        }
    }

    /// Returns whether an operator of a pipeline reads only values of operators that the same statement made.
    fn takes_its_statement_alone(&self, id: NetId) -> bool {
        let mut whole = self.operands(id);
        whole.retain(|operand| !self.is_product_row(*operand, id));
        for source in self.through(whole) {
            if self.operator(source).is_none() || !self.is_one_statement(source, id) {
                return false;
            }
        }
        true
    }

    /// Returns whether an operand is, through wires, an AND of the statement that made `of`.
    fn is_product_row(&self, operand: NetId, of: NetId) -> bool {
        let mut at = operand;
        while !self.cell[at.index()] {
            match (&self.design.net(at).driver, &self.operands(at)[..]) {
                (Driver::Op(Op::And(..)), _) => return self.is_one_statement(at, of),
                (_, [only]) => at = *only,
                _ => return false,
            }
        }
        false
    }

    fn is_one_statement(&self, one: NetId, other: NetId) -> bool {
        std::ptr::eq(self.design.net(one).location, self.design.net(other).location)
    }

    /// Returns whether an adder only adds a single bit to a number, as rounding does.
    pub fn rounds(&self, adder: NetId) -> bool {
        self.operands(adder).iter().any(|operand| self.design.net(*operand).range == (0, 1))
    }

    /// Returns the operators, registers and ROMs whose values form the value of a net through wires and gates. In a pipeline, the
    /// search also passes through registers.
    pub fn operators(&self, id: NetId) -> Vec<NetId> {
        self.through(self.operands(id))
    }

    /// Returns the operators, registers and ROMs among the nets `pending` or behind them, through wires and gates.
    fn through(&self, mut pending: Vec<NetId>) -> Vec<NetId> {
        let (mut found, mut seen) = (Vec::new(), BTreeSet::new());
        while let Some(id) = pending.pop() {
            if seen.insert(id) {
                match self.cell[id.index()] {
                    true => found.push(id),
                    false => pending.extend(self.operands(id)),
                }
            }
        }
        found
    }

    /// Returns the operands of a net's cell, the data of a register, or the address of a ROM; nothing for other nets.
    pub fn operands(&self, id: NetId) -> Vec<NetId> {
        match &self.design.net(id).driver {
            Driver::Op(op) => op.operands(),
            Driver::Register(register) => {
                self.design.register(*register).data.into_iter().collect()
            }
            Driver::Rom(rom) if !is_control(self.design, *rom) => {
                vec![self.design.rom(*rom).address]
            }
            _ => Vec::new(),
        }
    }

    /// Writes the sources of the net `id`, and of all nets on which it depends, to `sources`.
    fn trace(&self, id: NetId, sources: &mut [Option<Vec<NetId>>]) {
        let mut pending = vec![id];
        while let Some(&id) = pending.last() {
            let at = id.index();
            if sources[at].is_none() {
                let net = self.design.net(id);
                let control = net.partition == Partition::Control || counts_slots(self.design, id);
                if self.cell[at] {
                    sources[at] = Some(self.head[self.group[at]].into_iter().collect());
                } else if control || matches!(net.driver, Driver::Input) {
                    sources[at] = Some(if control { Vec::new() } else { vec![id] });
                } else {
                    let operands = self.operands(id);
                    let mut open = operands.clone();
                    open.retain(|operand| sources[operand.index()].is_none());
                    if !open.is_empty() {
                        pending.extend(open);
                        continue;
                    }
                    sources[at] = Some(self.joined_sources(id, &operands, sources));
                }
            }
            pending.pop();
        }
    }

    /// Returns the sources of a net that is wiring or a gate: all sources of its operands, each once.
    fn joined_sources(
        &self,
        id: NetId,
        operands: &[NetId],
        sources: &[Option<Vec<NetId>>],
    ) -> Vec<NetId> {
        let mut found: Vec<NetId> = Vec::new();
        for operand in operands {
            for source in sources[operand.index()].iter().flatten() {
                if !found.contains(source) {
                    found.push(*source);
                }
            }
        }
        // Bits that bypass the operators of a statement belong to its result.
        match self.head[self.group[id.index()]] {
            Some(head) if found.contains(&head) => vec![head],
            _ => found,
        }
    }

    /// Returns whether the blocks of a pipeline form a cycle, which a drawing by stages cannot show.
    fn is_tangled(&self) -> bool {
        if self.design.pipeline.is_none() {
            return false;
        }
        let mut waiting: Vec<(NetId, BTreeSet<NetId>)> = Vec::new();
        for head in self.heads() {
            let mut inputs = BTreeSet::new();
            for operand in self.operands_inside(head) {
                inputs.extend(&self.sources[operand.index()]);
            }
            inputs.remove(&head);
            waiting.push((head, inputs));
        }
        loop {
            let known: BTreeSet<NetId> = waiting.iter().map(|(head, _)| *head).collect();
            let before = waiting.len();
            waiting.retain(|(_, inputs)| !inputs.is_disjoint(&known));
            if waiting.is_empty() || waiting.len() == before {
                return !waiting.is_empty();
            }
        }
    }

    /// Finds the joints: the nets in which several signals meet before a block or an output port reads them.
    fn meet(&mut self) {
        let mut read: Vec<NetId> = Vec::new();
        for port in self.design.outputs() {
            if !port.role.is_status() && !matches!(port.role, Role::InReady | Role::SideOut) {
                read.push(port.net);
            }
        }
        for head in self.heads() {
            for operand in self.operands_inside(head) {
                if !self.is_part(operand, head) {
                    read.push(operand);
                }
            }
        }
        self.joints = read.into_iter().filter_map(|net| self.joint(net)).collect();
    }

    pub fn heads(&self) -> impl Iterator<Item = NetId> {
        self.head.iter().copied().flatten()
    }

    fn operands_inside(&self, head: NetId) -> Vec<NetId> {
        let mut operands = Vec::new();
        for net in self.inside(head) {
            operands.extend(self.operands(net));
        }
        operands
    }

    /// Returns whether the sources of `operand` meet inside the block with the output `head`, so no joint is drawn. Either the
    /// block is one of the sources, or the gates in which they meet belong to the block's statement of the description.
    pub fn is_part(&self, operand: NetId, head: NetId) -> bool {
        if self.sources[operand.index()].contains(&head) {
            return true;
        }
        let group = self.group[head.index()];
        let is_product = self.group.iter().filter(|other| **other == group).count() > 1;
        if !is_product || self.design.pipeline.is_none() {
            return false;
        }
        match self.joint(operand) {
            Some(joint) => self.is_one_statement(joint, head),
            None => false,
        }
    }

    /// Returns the net in which several signals meet, by wiring or gates, to form the net `id`. Returns `None` if a single signal
    /// forms it.
    pub fn joint(&self, mut id: NetId) -> Option<NetId> {
        if self.sources[id.index()].len() < 2 {
            return None;
        }
        loop {
            let mut operands = self.operands(id);
            operands.retain(|it| !self.sources[it.index()].is_empty());
            match operands[..] {
                [only] => id = only,
                _ => return Some(id),
            }
        }
    }

    /// Returns a block's cells, and wiring that passes on its value.
    pub fn inside(&self, head: NetId) -> Vec<NetId> {
        let group = self.group[head.index()];
        let mut inside = Vec::new();
        for (id, _) in self.design.iter() {
            if self.group[id.index()] == group && self.sources[id.index()] == [head] {
                inside.push(id);
            }
        }
        inside
    }

    pub fn driver(&self, net: NetId) -> Option<NetId> {
        match self.sources[net.index()][..] {
            [] => None,
            [only] => Some(only),
            _ => self.joint(net),
        }
    }

    pub fn held(&self, source: NetId) -> Vec<NetId> {
        let mut held = Vec::new();
        for (id, net) in self.design.iter() {
            let is_register = matches!(net.driver, Driver::Register(_)) && !self.cell[id.index()];
            if is_register && self.holds(id) == Some(source) {
                held.push(id);
            }
        }
        held
    }

    /// Returns the block, port or joint whose value a register of a pipeline holds.
    ///
    /// A register may also hold an intermediate value of gates, in which several sources meet before the joint. The function
    /// then follows the nets that read the register, and returns the first block or joint that it reaches.
    fn holds(&self, register: NetId) -> Option<NetId> {
        let driver = self.driver(register);
        if self.sources[register.index()].len() < 2
            || driver.is_some_and(|it| self.joints.contains(&it))
        {
            return driver;
        }
        let (mut at, mut taken) = (0, vec![register]);
        while let Some(&id) = taken.get(at) {
            for (reader, _) in self.design.iter() {
                if !self.operands(reader).contains(&id) {
                    continue;
                }
                match self.sources[reader.index()][..] {
                    [head] => return Some(head),
                    _ if self.joints.contains(&reader) => return Some(reader),
                    _ if !taken.contains(&reader) => taken.push(reader),
                    _ => {}
                }
            }
            at += 1;
        }
        None
    }
}

/// Returns whether a net is the slot counter of a pipeline, or an operator of the counter or its comparisons.
fn counts_slots(design: &Design, id: NetId) -> bool {
    let Some(pipeline) = &design.pipeline else { return false };
    let is_operator = operator(&design.net(id).driver).is_some();
    pipeline.slot == Some(id) || is_operator && pipeline.handshake.contains(&id)
}

/// Returns whether a net makes a block. Registers, ROMs and operators of the datapath do, and nets that the source numbers or the
/// description documents.
fn is_cell(design: &Design, id: NetId, net: &Net, figure: bool) -> bool {
    if net.partition != Partition::Datapath || counts_slots(design, id) {
        return false;
    }
    let is_told = net.block.is_some() || !figure && net.named && !net.doc.is_empty();
    let is_port = design.ports.iter().any(|port| port.net == id);
    let is_shown = is_told && design.pipeline.is_none() && !is_port;
    match &net.driver {
        Driver::Register(_) => design.pipeline.is_none(),
        Driver::Rom(rom) => !is_control(design, *rom),
        driver @ Driver::Op(_) => operator(driver).is_some() || is_shown,
        _ => is_shown,
    }
}

fn is_control(design: &Design, rom: RomId) -> bool {
    design.pipeline.is_none() && design.rom(design.control.rom).data == design.rom(rom).data
}
