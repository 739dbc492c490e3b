//! Groups nets into blocks: one block for each statement of the description.
//!
//! A net is *made from* sources: blocks, ports and tables that reach it through wires and gates. If several sources
//! meet and an operator takes the result, the meeting point is a *joint*, a block of gates or wiring.

use std::collections::BTreeSet;

use super::kind::{MULTIPLIER, MUX, operator};
use glint_rtl::netlist::{Design, Driver, NetId, Op, Partition, Role, RomId};

/// The groups of a design's nets, and the sources of each.
pub struct Groups<'a> {
    /// The design.
    pub design: &'a Design,
    /// The nets that belong together, as the lowest of them.
    pub group: Vec<usize>,
    /// The nets that are registers, tables or operators, or shown because the source numbers or documents them.
    pub cell: Vec<bool>,
    /// For each net, the blocks, ports and tables that it is made from within a clock. In a pipeline the clocks between
    /// do not matter.
    pub sources: Vec<Vec<NetId>>,
    /// For each group with a cell its output.
    pub head: Vec<Option<NetId>>,
    /// Nets at which several signals meet by wiring or gates, and which an operator takes.
    pub joints: BTreeSet<NetId>,
}

impl<'a> Groups<'a> {
    /// Groups the nets of a design. In a `figure`, gates and wiring are blocks only if the source numbers them, or if
    /// several signals meet in them.
    pub fn new(design: &'a Design, figure: bool) -> Self {
        let ports: Vec<NetId> = design.ports.iter().map(|port| port.net).collect();
        let cell = design.iter().map(|(id, net)| {
            let own = net.block.is_some() || !figure && net.named && !net.doc.is_empty();
            let own = own && design.pipeline.is_none() && !ports.contains(&id);
            net.partition == Partition::Datapath
                && match &net.driver {
                    Driver::Register(_) => design.pipeline.is_none(),
                    Driver::Rom(rom) => !is_control(design, *rom),
                    driver @ Driver::Op(_) => operator(driver).is_some() || own,
                    _ => own,
                }
        });
        let mut groups = Self {
            design,
            cell: cell.collect(),
            group: Vec::new(),
            sources: Vec::new(),
            head: Vec::new(),
            joints: BTreeSet::new(),
        };
        groups.form(true);
        // Statements are taken apart if their operators feed each other through other statements, as in a loop.
        if groups.is_tangled() {
            groups.form(false);
        }
        groups.meet();
        groups
    }

    /// Forms the groups, and finds the sources of each net.
    fn form(&mut self, statements: bool) {
        let design = self.design;
        self.group = (0..design.nets.len()).collect();
        if statements {
            design.iter().for_each(|(id, _)| self.join(id));
        }
        for at in 0..self.group.len() {
            self.group[at] = self.root(at);
        }
        self.head = vec![None; self.group.len()];
        for (id, net) in design.iter().filter(|(id, _)| self.cell[id.index()]) {
            let head = &mut self.head[self.group[id.index()]];
            // A net that the source numbers is the block. The nets that serve it are inside.
            let better = head.is_none_or(|head| {
                let head = design.net(head);
                (net.block.is_some(), net.named) >= (head.block.is_some(), head.named)
            });
            if better {
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

    /// Puts a net into the group of the nets that it is made from, if one statement made both. For example, the muxes
    /// of one tree are a group.
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
            if logic && std::ptr::eq(other.location, net.location) && self.belongs(from, id) {
                let (from, to) = (self.root(from.index()), self.root(id.index()));
                self.group[from.max(to)] = from.min(to);
            }
        }
    }

    /// Returns whether an operator is part of another that takes it, if one statement made both.
    fn belongs(&self, from: NetId, to: NetId) -> bool {
        let design = self.design;
        let kind = |id: NetId| operator(&design.net(id).driver).filter(|_| self.cell[id.index()]);
        let (Some(a), Some(b)) = (kind(from), kind(to)) else { return !self.cell[to.index()] };
        let shown = |id: NetId| {
            let net = design.net(id);
            design.pipeline.is_none() && (net.block.is_some() || !net.doc.is_empty())
        };
        let named = |id: NetId| design.net(id).named;
        match (a, b) {
            (MUX, MUX) => !shown(from),
            // A multiplier begins a statement. Logic that adds to its product, or rounds it, is a block apart.
            (_, MULTIPLIER) => false,
            (MULTIPLIER, _) if design.pipeline.is_none() => false,
            (_, MUX) => !(shown(from) || named(from) && named(to) && design.pipeline.is_none()),
            _ if design.pipeline.is_none() => !(named(from) && named(to) || shown(from)),
            _ => {
                let one =
                    |it: &NetId| std::ptr::eq(design.net(*it).location, design.net(to).location);
                // Rows of a product are gates of its statement.
                let row = |it: &NetId| {
                    let mut at = *it;
                    while !self.cell[at.index()] {
                        match (&design.net(at).driver, &self.operands(at)[..]) {
                            (Driver::Op(Op::And(..)), _) => return one(&at),
                            (_, [only]) => at = *only,
                            _ => return false,
                        }
                    }
                    false
                };
                let whole = self.operands(to).into_iter().filter(|it| !row(it));
                let all = self.through(whole.collect());
                !self.rounds(to) && all.iter().all(|it| kind(*it).is_some() && one(it))
            }
        }
    }

    /// Returns whether an adder adds a bit to a number, as rounding does. For example, `upper + half` rounds if `half`
    /// is 0 or 1.
    pub fn rounds(&self, adder: NetId) -> bool {
        let mut operands = self.operands(adder).into_iter();
        operands.any(|it| self.design.net(it).range == (0, 1))
    }

    /// Returns the operators, registers and tables that a net takes, through wires and gates. In a pipeline, it also
    /// goes through registers.
    pub fn operators(&self, id: NetId) -> Vec<NetId> {
        self.through(self.operands(id))
    }

    /// Returns the operators, registers and tables that these nets are or take.
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

    /// Returns the nets from which a net is made: the operands of its cell, the data of a register or the address of
    /// a table.
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

    /// Finds the sources of a net, after the sources of its operands.
    fn trace(&self, id: NetId, sources: &mut [Option<Vec<NetId>>]) {
        let mut pending = vec![id];
        while let Some(&id) = pending.last() {
            let at = id.index();
            if sources[at].is_none() {
                let net = self.design.net(id);
                let control = net.partition == Partition::Control;
                if self.cell[at] {
                    sources[at] = Some(self.head[self.group[at]].into_iter().collect());
                } else if control || matches!(net.driver, Driver::Input) {
                    sources[at] = Some(if control { Vec::new() } else { vec![id] });
                } else {
                    let operands = self.operands(id);
                    let open = operands.iter().filter(|it| sources[it.index()].is_none());
                    let open: Vec<NetId> = open.copied().collect();
                    if !open.is_empty() {
                        pending.extend(open);
                        continue;
                    }
                    let mut found: Vec<NetId> = Vec::new();
                    for source in
                        operands.iter().flat_map(|it| sources[it.index()].iter().flatten())
                    {
                        if !found.contains(source) {
                            found.push(*source);
                        }
                    }
                    // Bits that go around the operators of a statement belong to its result.
                    let head = self.head[self.group[at]].filter(|head| found.contains(head));
                    sources[at] = Some(head.map_or(found, |head| vec![head]));
                }
            }
            pending.pop();
        }
    }

    /// Returns whether the blocks of a pipeline form a cycle. It is always false for a sequential core.
    fn is_tangled(&self) -> bool {
        if self.design.pipeline.is_none() {
            return false;
        }
        let heads: Vec<NetId> = self.head.iter().copied().flatten().collect();
        let inputs = |head: NetId| -> BTreeSet<NetId> {
            let operands = self.inside(head).into_iter().flat_map(|it| self.operands(it));
            operands
                .flat_map(|it| self.sources[it.index()].clone())
                .filter(|it| *it != head)
                .collect()
        };
        let mut waiting: Vec<(NetId, BTreeSet<NetId>)> =
            heads.iter().map(|&head| (head, inputs(head))).collect();
        loop {
            let known: BTreeSet<NetId> = waiting.iter().map(|it| it.0).collect();
            let before = waiting.len();
            waiting.retain(|(_, inputs)| !inputs.is_disjoint(&known));
            if waiting.is_empty() || waiting.len() == before {
                return !waiting.is_empty();
            }
        }
    }

    /// Finds the nets at which signals meet.
    fn meet(&mut self) {
        let design = self.design;
        let outputs = design.outputs().filter(|port| {
            !port.role.is_status() && !matches!(port.role, Role::InReady | Role::SideOut)
        });
        let mut read: Vec<NetId> = outputs.map(|port| port.net).collect();
        for head in self.head.iter().copied().flatten() {
            let operands = self.inside(head).into_iter().flat_map(|it| self.operands(it));
            read.extend(operands.filter(|it| !self.is_part(*it, head)));
        }
        self.joints = read.into_iter().filter_map(|it| self.joint(it)).collect();
    }

    /// Returns whether the sources of an operand meet inside a block: they are bits beside its result, or gates of
    /// its statement.
    pub fn is_part(&self, operand: NetId, head: NetId) -> bool {
        let location = |id: NetId| self.design.net(id).location;
        let product = self.group.iter().filter(|it| **it == self.group[head.index()]).count() > 1;
        self.sources[operand.index()].contains(&head)
            || product
                && self.design.pipeline.is_some()
                && self.joint(operand).is_some_and(|it| std::ptr::eq(location(it), location(head)))
    }

    /// Returns the net at which the signals meet that a net is made from, if several do.
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

    /// Returns the nets that are inside the block with this output: its cells, and wiring behind them.
    pub fn inside(&self, head: NetId) -> Vec<NetId> {
        let group = self.group[head.index()];
        let nets = self.design.iter().map(|(id, _)| id);
        let inside = nets.filter(|id| self.group[id.index()] == group);
        inside.filter(|id| self.sources[id.index()] == [head]).collect()
    }

    /// Returns the block or port that drives the value of a net.
    pub fn driver(&self, net: NetId) -> Option<NetId> {
        match self.sources[net.index()][..] {
            [] => None,
            [only] => Some(only),
            _ => self.joint(net),
        }
    }

    /// Returns the registers of a pipeline that hold the value of a block or port.
    pub fn held(&self, source: NetId) -> Vec<NetId> {
        let nets = self.design.iter().filter(|(id, net)| {
            let register = matches!(net.driver, Driver::Register(_)) && !self.cell[id.index()];
            register && self.holds(*id) == Some(source)
        });
        nets.map(|(id, _)| id).collect()
    }

    /// Returns the block or port whose value a register of a pipeline holds. If the register holds a part of a gate,
    /// it returns the gate.
    fn holds(&self, register: NetId) -> Option<NetId> {
        let driver = self.driver(register);
        if self.sources[register.index()].len() < 2
            || driver.is_some_and(|it| self.joints.contains(&it))
        {
            return driver;
        }
        let (mut at, mut taken) = (0, vec![register]);
        while let Some(&id) = taken.get(at) {
            let readers =
                self.design.iter().map(|it| it.0).filter(|it| self.operands(*it).contains(&id));
            for reader in readers {
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

fn is_control(design: &Design, rom: RomId) -> bool {
    design.pipeline.is_none() && design.rom(design.control.rom).data == design.rom(rom).data
}
