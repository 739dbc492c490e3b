//! Unrolls a computation with several results, such as the points of a scan line. The parts are the first point, and the step
//! from a point to the next.
//!
//! The registers that carry state from one point to the next are called the *walk*, for example the register with the current
//! angle. The module proves by induction that every point is the same function of the operands and the walk. The first point
//! must load functions of the operands into the walk, and every other point the same function of the walk and the operands.

use super::{Clock, Executor, Iterations, State, Unrolled};
use crate::netlist::{Design, NetId, RegisterKind, Role, Sequence};
use crate::pipeline::graph::{Cell, NodeId};
use glint_base::codes;
use glint_base::cone::reached;
use glint_base::diagnostic::{Diagnostic, Diagnostics};

/// The largest number of clocks from the microinstruction that writes a point to the clock with its results.
const MOST_DELAY: usize = 12;

/// The first point of a computation with several results, and the registers from which each later point follows.
#[derive(Debug)]
pub struct UnrolledLine {
    /// Computes the first point. Later points differ only in the registers of the walk.
    pub unrolled: Unrolled,
    pub walk: Vec<WalkRegister>,
}

/// The values of one register of the walk, as nodes of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WalkRegister {
    /// The first point loads this value.
    pub first: NodeId,
    /// The unknown value of the register before a later point is loaded.
    pub before: NodeId,
    /// A later point loads this function of the `before` values of the walk.
    pub next: NodeId,
}

/// Unrolls a computation with several results.
///
/// # Errors
/// Fails if the design has no output `valid`, or if `valid` follows no microinstruction within 12 clocks. Fails if the
/// microprogram has no first point that is computed once and before all others. Fails if two points differ in the function that
/// loads the walk or in the results, or if another microinstruction changes the walk. Fails if a result depends on a register or
/// a memory word that an earlier computation has left.
pub fn unroll_line(design: &Design) -> Result<UnrolledLine, Diagnostics> {
    let executor = Executor::new(design, Iterations::OneByOne);
    LineUnroller { executor }.line().map_err(|diagnostic| Diagnostics(vec![diagnostic]))
}

struct LineUnroller<'a> {
    executor: Executor<'a>,
}

impl LineUnroller<'_> {
    fn line(mut self) -> Result<UnrolledLine, Diagnostic> {
        let design = self.executor.design;
        let unknown = self.executor.power_up();
        let started = self.executor.start(&unknown);
        let mut any = unknown;
        for (number, register) in design.registers.iter().enumerate() {
            if register.kind == RegisterKind::Operand {
                any.registers[number] = started.registers[number];
            }
        }
        let (delay, writes) = self.delay(&any)?;
        let after: Vec<usize> = writes.iter().flat_map(|&at| successors(design, at)).collect();
        let shown = self.shown(&any, &after, delay - 1)?;
        let walk = self.walk_of(&any, &shown)?;
        let (first, others): (Vec<usize>, Vec<usize>) = writes.iter().partition(|&&at| {
            let state = self.edge(&any, at);
            walk.iter().all(|&number| self.unknowns(state.registers[number]).is_empty())
        });
        let ([first], [other, more @ ..]) = (&first[..], &others[..]) else {
            return Err(self.cannot(0, "does not begin a line of a first point and other points"));
        };
        self.in_order(*first, &writes)?;
        let (begun, gone) = (self.edge(&any, *first), self.edge(&any, *other));
        let [at_first, before, next] =
            [&begun, &any, &gone].map(|state| walk_registers(state, &walk));
        for &at in more {
            if walk_registers(&self.edge(&any, at), &walk) != next {
                return Err(self.cannot(
                    at,
                    "goes to the next point in another way than a microinstruction before",
                ));
            }
        }
        for at in 0..design.control.microprogram.len() {
            if !writes.contains(&at) && walk_registers(&self.edge(&any, at), &walk) != before {
                return Err(self.cannot(
                    at,
                    "changes the registers of the current point without computing a point",
                ));
            }
        }
        // The next values of the walk may depend on the walk and on operands alone.
        for &value in &next {
            if self.unknowns(value).iter().any(|id| !before.contains(id)) {
                return Err(self.cannot(
                    *other,
                    "computes the next point from a register that does not belong to the current point",
                ));
            }
        }
        let mut from_first = any.clone();
        for &number in &walk {
            from_first.registers[number] = begun.registers[number];
        }
        let results = self.shown(&from_first, &successors(design, *first), delay - 1)?;
        self.executor.determined(&results, "cannot be a pipeline")?;
        self.executor.unrolled.results = results;
        let mut registers = Vec::new();
        for at in 0..walk.len() {
            let (first, before, next) = (at_first[at], before[at], next[at]);
            registers.push(WalkRegister { first, before, next });
        }
        Ok(UnrolledLine { unrolled: self.executor.unrolled, walk: registers })
    }

    /// Finds the smallest number of clocks, up to [`MOST_DELAY`], after which the first microinstruction of any path determines
    /// `valid`, whatever registers other than operands contain. Returns this number, and the addresses of the microinstructions
    /// that set `valid`. Fails if a microinstruction sets `valid` on some paths only.
    fn delay(&mut self, any: &State) -> Result<(usize, Vec<usize>), Diagnostic> {
        let design = self.executor.design;
        let Some(valid) = design.port(|role| role == Role::Valid).map(|port| port.net) else {
            return Err(self.cannot(0, "belongs to a device without `valid`"));
        };
        let all: Vec<usize> = (0..design.control.microprogram.len()).collect();
        for delay in 1..=MOST_DELAY {
            let mut writes = Some(Vec::new());
            for path in paths(design, &all, delay) {
                let value = self.at_end(any, &path, |clock| clock.value(valid));
                let bit = self.executor.unrolled.graph.constant_of(value);
                writes = writes.filter(|_| bit.is_some());
                if let (Some(writes), Some(1)) = (&mut writes, bit)
                    && !writes.contains(&path[0])
                {
                    writes.push(path[0]);
                }
            }
            if let Some(writes) = writes.filter(|writes| !writes.is_empty()) {
                for path in paths(design, &writes, delay) {
                    let value = self.at_end(any, &path, |clock| clock.value(valid));
                    if self.executor.unrolled.graph.constant_of(value) != Some(1) {
                        return Err(self.cannot(path[0], "sets `valid` only on some paths"));
                    }
                }
                return Ok((delay, writes));
            }
        }
        Err(self.cannot(0, "begins a computation in which no microinstruction determines `valid`"))
    }

    /// Returns each result port with its node, `clocks` clocks after a path begins at one of the microinstructions `from`. Fails
    /// if two paths have different values, or if no path is that long.
    fn shown(
        &mut self,
        state: &State,
        from: &[usize],
        clocks: usize,
    ) -> Result<Vec<(NetId, NodeId)>, Diagnostic> {
        let design = self.executor.design;
        let ports = design.ports.iter().filter(|port| port.role == Role::Result);
        let ports: Vec<NetId> = ports.map(|port| port.net).collect();
        let mut all: Option<Vec<(NetId, NodeId)>> = None;
        for path in paths(design, from, clocks) {
            let results = self.at_end(state, &path, |clock| {
                ports.iter().map(|&port| (port, clock.value(port))).collect::<Vec<_>>()
            });
            if all.as_ref().is_some_and(|all| *all != results) {
                return Err(self.cannot(path[0], "shows different results on different paths"));
            }
            all = Some(results);
        }
        all.ok_or_else(|| self.cannot(0, "ends before the results are shown"))
    }

    /// Returns the walk: the registers on whose earlier contents the results `shown` depend. Fails if a result depends on an
    /// earlier output of a memory.
    fn walk_of(&self, any: &State, shown: &[(NetId, NodeId)]) -> Result<Vec<usize>, Diagnostic> {
        let mut walk = Vec::new();
        for id in shown.iter().flat_map(|&(_, node)| self.unknowns(node)) {
            let Some(number) = any.registers.iter().position(|&register| register == id) else {
                return Err(
                    self.cannot(0, "shows a result that depends on an earlier output of a memory")
                );
            };
            if !walk.contains(&number) {
                walk.push(number);
            }
        }
        Ok(walk)
    }

    /// Checks that `first` comes before all other microinstructions in `writes`, and is executed once.
    fn in_order(&self, first: usize, writes: &[usize]) -> Result<(), Diagnostic> {
        let design = self.executor.design;
        // The search stops at microinstructions that write points.
        let until_a_write = reached([0], |at| match writes.contains(&at) {
            true => Vec::new(),
            false => successors(design, at),
        });
        if until_a_write.into_iter().any(|at| writes.contains(&at) && at != first) {
            return Err(self.cannot(first, "does not compute the first point on every path"));
        }
        if reached(successors(design, first), |at| successors(design, at)).contains(&first) {
            return Err(self.cannot(first, "begins a second line"));
        }
        Ok(())
    }

    fn edge(&mut self, state: &State, address: usize) -> State {
        Clock::new(&mut self.executor, state, Some(address), false).edge()
    }

    /// Executes `path` from `state` on, and returns the answer of `ask` in the clock of its last microinstruction.
    fn at_end<T>(
        &mut self,
        state: &State,
        path: &[usize],
        ask: impl Fn(&mut Clock<'_, '_>) -> T,
    ) -> T {
        let (last, before) = path.split_last().expect("a way has a microinstruction");
        let mut now = state.clone();
        for &address in before {
            now = self.edge(&now, address);
        }
        ask(&mut Clock::new(&mut self.executor, &now, Some(*last), false))
    }

    /// Returns the unknown values on which node `id` depends: contents of registers and memory outputs that no executed
    /// microinstruction has loaded.
    fn unknowns(&self, id: NodeId) -> Vec<NodeId> {
        let graph = &self.executor.unrolled.graph;
        let mut unknowns = graph.cone([id]);
        unknowns.retain(|id| matches!(graph.node(*id).cell, Cell::Unknown(_)));
        unknowns
    }

    fn cannot(&self, address: usize, why: &str) -> Diagnostic {
        let microinstruction = &self.executor.design.control.microprogram[address];
        let (design, own) = (&self.executor.design.name, &microinstruction.name);
        let message = format!(
            "the points of `{design}` are not computed in the same way: the microinstruction `{own}` {why}"
        );
        Diagnostic::new(codes::UNROLL, message, microinstruction.location)
    }
}

/// Returns the microinstructions that can follow `at` within a computation; none at its end.
fn successors(design: &Design, at: usize) -> Vec<usize> {
    match design.control.microprogram[at].sequence {
        Sequence::End => Vec::new(),
        _ => design.control.successors(at).into_iter().filter(|&to| to != 0).collect(),
    }
}

/// Returns every path of `clocks` + 1 microinstructions that begins at one of `from`.
fn paths(design: &Design, from: &[usize], clocks: usize) -> Vec<Vec<usize>> {
    let mut paths: Vec<Vec<usize>> = from.iter().map(|&at| vec![at]).collect();
    for _ in 0..clocks {
        let mut longer = Vec::new();
        for path in &paths {
            let last = path.last().copied().unwrap_or_default();
            for next in successors(design, last) {
                longer.push([&path[..], &[next]].concat());
            }
        }
        paths = longer;
    }
    paths
}

fn walk_registers(state: &State, walk: &[usize]) -> Vec<NodeId> {
    walk.iter().map(|&number| state.registers[number]).collect()
}
