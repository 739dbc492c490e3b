//! Draws random inputs for a sequential core, clock by clock.
//!
//! Computations follow each other with idle gaps or back to back. Operands are written one after another, all at once or
//! together with `start`, or they stay from the previous computation. Writes, starts and resets also come while the core is
//! busy. The stimulus reacts to `busy`, as a host does, and the same seed gives the same inputs.

use std::sync::Arc;

use super::points::PointSource;
use super::ports::Ports;
use super::random::Random;
use glint_base::fixed::mask;

/// The delay from `start` to a reset is drawn below 2^m clocks, with m equally likely from 0 to 12. Resets therefore often hit
/// a computation of ten clocks, and most computations of thousands of clocks still finish. The largest delay, 4095 clocks,
/// reaches the end of the longest line.
const RESET_MAGNITUDES: u64 = 13;

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    /// A reset. The number is the clocks of reset that follow the next clock.
    Reset(u32),
    /// Operands are being written. Bit i of the mask is 1 if operand port i must still be written.
    Writing(u64),
    /// The idle clocks until `start` is due.
    Starting(u32),
    /// A computation runs. The number is the clocks until a reset interrupts it, if one does.
    Running(Option<u64>),
}

/// The random inputs of a sequential core. Each call of [`Stimulus::next`] gives the inputs of one clock.
pub(super) struct Stimulus {
    ports: Arc<Ports>,
    random: Random,
    phase: Phase,
    inputs: Vec<u64>,
    /// Whether the latest inputs hold `rst_n` high and everything else at 0.
    idle: bool,
    /// The raw operands of the next point, in the order of `Contract::operands`.
    next: Vec<i64>,
    /// The raw values in the device's operand registers or buffers.
    written: Vec<i64>,
    /// The raw operands that the latest `start` copied from the buffers, if the core has operand buffers.
    taken: Option<Vec<i64>>,
    first: bool,
}

impl Stimulus {
    /// Begins with three clocks of reset after power-up.
    pub(super) fn new(ports: &Arc<Ports>, seed: u64) -> Self {
        let nothing = vec![0; ports.operands.len()];
        Self {
            random: Random::new(seed),
            phase: Phase::Reset(2),
            inputs: vec![0; ports.inputs],
            idle: false,
            next: nothing.clone(),
            written: nothing.clone(),
            taken: ports.overlaps.then_some(nothing),
            first: true,
            ports: ports.clone(),
        }
    }

    /// Returns the raw operands of the computation that the latest `start` began, in the order of `Contract::operands`.
    pub(super) fn accepted(&self) -> &[i64] {
        self.taken.as_ref().unwrap_or(&self.written)
    }

    /// Returns the bit patterns of all inputs in the next clock, in the order of the design's input ports. `busy` must say
    /// whether the device ignores a `start` at the next edge.
    pub(super) fn next(&mut self, busy: bool, points: &PointSource) -> &[u64] {
        if !self.idle {
            self.inputs.fill(0);
            self.inputs[self.ports.reset] = 1;
            self.idle = true;
        }
        match self.phase {
            Phase::Reset(left) => {
                self.idle = false;
                self.inputs[self.ports.reset] = 0;
                if !self.first {
                    self.noise(busy, points);
                }
                self.phase =
                    if left > 0 { Phase::Reset(left - 1) } else { self.next_point(points) };
            }
            Phase::Writing(left) => self.write(left),
            Phase::Starting(idle) => {
                if idle == 0 {
                    self.begin();
                } else {
                    self.phase = Phase::Starting(idle - 1);
                }
            }
            Phase::Running(reset) => self.run(busy, reset, points),
        }
        self.accept(busy);
        &self.inputs
    }

    /// Returns whether the latest inputs neither start, write nor reset anything.
    #[inline]
    pub(super) fn is_idle(&self) -> bool {
        self.idle
    }

    #[inline]
    pub(super) fn inputs(&self) -> &[u64] {
        &self.inputs
    }

    fn begin(&mut self) {
        self.idle = false;
        self.inputs[self.ports.start] = 1;
        self.first = false;
        let reset = self.random.once_in(16).then(|| {
            let magnitude = self.random.below(RESET_MAGNITUDES);
            self.random.below(1 << magnitude)
        });
        self.phase = Phase::Running(reset);
    }

    /// Drives one clock after `start`. While the device is busy, this clock may have a reset, or random writes and starts. The
    /// device must ignore such writes and starts, except that operand buffers take the writes. Once the device is free, the
    /// next point begins in the same clock.
    fn run(&mut self, busy: bool, reset: Option<u64>, points: &PointSource) {
        if busy {
            if self.random.once_in(6) {
                self.noise(true, points);
            }
            self.phase = Phase::Running(reset.map(|clocks| clocks.saturating_sub(1)));
            if reset == Some(0) {
                self.idle = false;
                self.inputs[self.ports.reset] = 0;
                self.phase = Phase::Reset(self.random.below(3) as u32);
            }
            return;
        }
        // The computation has ended, and the device takes operands again in this very clock.
        self.phase = self.next_point(points);
        match self.phase {
            Phase::Writing(left) => self.write(left),
            Phase::Starting(0) => self.begin(),
            Phase::Starting(idle) => self.phase = Phase::Starting(idle - 1),
            _ => {}
        }
    }

    /// Draws the operands of the next point, and returns the phase that writes them. One point in eight starts with the
    /// operands of the previous point instead.
    fn next_point(&mut self, points: &PointSource) -> Phase {
        let all = (1u64 << self.ports.operands.len()) - 1;
        let written = if self.first {
            all
        } else {
            match self.random.below(8) {
                // The same operands once more.
                0 => return Phase::Starting(self.random.below(4) as u32),
                // Some of the operands.
                1 | 2 => self.random.bits() & all,
                _ => all,
            }
        };
        let mut free = 0;
        for (at, port) in self.ports.operands.iter().enumerate() {
            if written >> at & 1 == 1 {
                free |= 1 << port.at;
            }
        }
        self.next.copy_from_slice(&self.written);
        points.draw(&mut self.random, &mut self.next, free);
        // `draw` may also have changed an operand outside `free`, to reach the peak of the function; that operand is written
        // too.
        let mut changed = written;
        for (at, port) in self.ports.operands.iter().enumerate() {
            if self.next[port.at] != self.written[port.at] {
                changed |= 1 << at;
            }
        }
        Phase::Writing(changed)
    }

    /// Writes some of the operands in the mask `left`: one, a random selection, or all. After the last write, `start` follows
    /// in the same clock or later.
    fn write(&mut self, left: u64) {
        self.idle = false;
        let now = match self.random.below(4) {
            0 if left != 0 => 1 << left.trailing_zeros(),
            1 => left & self.random.bits(),
            _ => left,
        };
        for (at, port) in self.ports.operands.iter().enumerate() {
            if now >> at & 1 == 1 {
                self.inputs[port.data] = port.pattern(&self.next);
                self.inputs[port.strobe] = 1;
            }
        }
        let left = left & !now;
        if left != 0 {
            self.phase = Phase::Writing(left);
        } else if self.random.once_in(3) {
            // Together with the last write.
            self.begin();
        } else {
            self.phase = Phase::Starting(if self.random.once_in(4) {
                self.random.below(6) as u32
            } else {
                0
            });
        }
    }

    /// Drives random strobes and data. A device in reset, and a busy device without operand buffers, must ignore them.
    fn noise(&mut self, busy: bool, points: &PointSource) {
        self.idle = false;
        let random = &mut self.random;
        for port in &self.ports.operands {
            let any = random.once_in(8);
            let raw = if any { points.any(random, port.at) } else { points.one(random, port.at) };
            self.inputs[port.data] = raw as u64 & mask(port.format.width());
            self.inputs[port.strobe] = u64::from(random.once_in(3));
        }
        if busy {
            self.inputs[self.ports.start] = u64::from(self.random.once_in(2));
        }
    }

    fn accept(&mut self, busy: bool) {
        if self.idle || busy && self.taken.is_none() {
            return;
        }
        for port in &self.ports.operands {
            if self.inputs[port.strobe] == 1 {
                self.written[port.at] = port.raw(&self.inputs);
            }
        }
        if let Some(taken) = &mut self.taken
            && !busy
            && self.inputs[self.ports.start] == 1
        {
            taken.copy_from_slice(&self.written);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::points::tests::Pulse;
    use super::*;
    use glint_base::fixed::Format;
    use glint_rtl::dsl::{Designer, end, step, valid};
    use glint_rtl::netlist::{Design, Role};

    /// Returns a design with one operand `x` of 12 bits. The tests decide how long a computation takes.
    fn design() -> Design {
        let d = Designer::new("device");
        let x = d.operand("x", Format::unsigned(12, 0));
        let y = d.register("y", x.q().format());
        y.takes(x.q());
        d.output("y_out", y.q());
        let load = step("load", [y.load()]);
        d.microprogram([step("idle", []), load, step("result", [valid(), end()])]);
        d.finish().unwrap()
    }

    #[derive(Debug, Default)]
    struct Events {
        complete: u32,
        reset: u32,
        written: u32,
        started_again: u32,
        with_last_write: u32,
    }

    fn events(length: u32, clocks: u32) -> Events {
        let pulse = Pulse::single(false);
        let points = PointSource::new(&pulse);
        let ports = Arc::new(Ports::new(&design(), &pulse).unwrap());
        let mut stimulus = Stimulus::new(&ports, 1);
        let (reset, start, strobe) = (ports.reset, ports.start, ports.operands[0].strobe);
        let mut left = 0;
        let mut events = Events::default();
        for _ in 0..clocks {
            let busy = left > 0;
            let inputs = stimulus.next(busy, &points);
            let (reset, start) = (inputs[reset] == 0, inputs[start] == 1);
            let strobe = inputs[strobe] == 1;
            events.written += u32::from(busy && strobe);
            events.started_again += u32::from(busy && start);
            events.with_last_write += u32::from(!busy && start && strobe);
            if reset {
                events.reset += u32::from(busy);
                left = 0;
            } else if busy {
                left -= 1;
                events.complete += u32::from(left == 0);
            } else if start {
                left = length;
            }
        }
        events
    }

    #[test]
    fn a_strobe_that_is_no_input_is_refused() {
        let (pulse, mut design) = (Pulse::single(false), design());
        let busy = design.handshake().unwrap().busy;
        let operand = |role: Role| matches!(role, Role::Operand { .. });
        let port = design.ports.iter_mut().find(|port| operand(port.role)).unwrap();
        port.role = Role::Operand { strobe: busy };
        let error = Ports::new(&design, &pulse).err().unwrap();
        assert_eq!(error.to_string(), "`busy` is not an input of `device`");
    }

    #[test]
    fn short_computations_meet_everything() {
        let events = events(10, 100_000);
        assert!(events.complete > 5_000, "{events:?}");
        // About one computation in forty is reset.
        assert!(events.reset > 100 && events.reset < 500, "{events:?}");
        assert!(events.written > 2_000, "{events:?}");
        assert!(events.started_again > 2_000, "{events:?}");
        assert!(events.with_last_write > 1_000, "{events:?}");
    }

    #[test]
    fn most_long_computations_come_to_their_end() {
        let events = events(4100, 4_000_000);
        assert!(events.complete > 800, "{events:?}");
        assert!(events.reset > 30 && events.reset < 150, "{events:?}");
    }
}
