//! What the inputs do, clock by clock.
//!
//! A stimulus is a mix of everything that a device meets: points with idle gaps and back to back,
//! operands written one after another, all at once or together with `start`, some left from the point
//! before, writes and starts while busy, and resets in the middle of a computation. It reacts to `busy`,
//! as a host does, and is a function of its seed.
//!
//! Whether a computation is to be reset, and when, is drawn as it starts, with short and long times alike:
//! resets come often in the middle of a computation of ten clocks, and still let most of one of thousands
//! come to its end.

use crate::base::fixed::mask;
use crate::golden::Operand;
use crate::hdl::netlist::{Design, NetId, Role};

/// A small deterministic generator (SplitMix64): the same numbers on every machine, and fast enough
/// not to matter beside the simulation.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer from 0 to `below - 1`.
    pub fn below(&mut self, below: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(below)) >> 64) as u64
    }

    /// True once in `times`.
    pub fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }

    /// An integer from `low` to `high`.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        let span = high.wrapping_sub(low).wrapping_add(1) as u64;
        if span == 0 { self.bits() as i64 } else { low.wrapping_add(self.below(span) as i64) }
    }

    /// A raw value from `low` to `high`: often one of its ends or close to one (or to 0, which is as good as an
    /// end).
    pub fn of_domain(&mut self, domain: (i64, i64)) -> i64 {
        let choice = self.below(16);
        self.near_an_end(choice, domain)
    }

    /// A bit pattern for an operand: mostly of its domain, as [`Random::of_domain`] draws it, at times any.
    pub fn pattern(&mut self, operand: &Operand) -> u64 {
        let raw = match self.below(16) {
            ANYTHING => self.bits() as i64,
            choice => self.near_an_end(choice, operand.domain),
        };
        raw as u64 & mask(operand.format.width())
    }

    /// By one of 16 choices: an end, close to one, anywhere.
    fn near_an_end(&mut self, choice: u64, (low, high): (i64, i64)) -> i64 {
        match choice {
            0 => low,
            1 => high,
            // Off by a random power of two: from the upper end, from the lower, from 0 where that is between
            // (an angle, the component of a vector).
            3..=13 if choice <= 8 || low < 0 && high > 0 => {
                let reach = high.abs_diff(low);
                let bits = self.below(u64::from(64 - reach.max(1).leading_zeros()) + 1);
                let off = self.below(1 << bits.min(62)).min(reach) as i64;
                match choice {
                    3 | 4 => high.wrapping_sub(off),
                    _ if low >= 0 || high <= 0 => low.wrapping_add(off),
                    _ if choice.is_multiple_of(2) => off.min(high),
                    _ => (-off).max(low),
                }
            }
            _ => self.within(low, high),
        }
    }
}

/// The choice of 16 that a stimulus takes for any bit pattern at all.
const ANYTHING: u64 = 2;

/// Resets come within 2⁰, 2¹, … clocks after a start, in equal parts up to this many powers: as long as
/// the longest line.
const RESET_MAGNITUDES: u64 = 13;

/// An operand as the stimulus drives it.
struct Driven {
    /// Positions of data and strobe among the inputs.
    data: usize,
    strobe: usize,
    operand: Operand,
    /// Of its width.
    mask: u64,
    /// The raw value that the register was last given while the device could take it.
    accepted: i64,
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    /// `rst_n` low for so many clocks more.
    Reset(u32),
    /// Writing; the operands still to be written, as a mask.
    Writing(u64),
    /// `start` is due after so many idle clocks.
    Starting(u32),
    /// A computation runs; the clocks to its reset, when one is due.
    Running(Option<u64>),
}

/// The inputs of a device, clock by clock.
pub struct Stimulus {
    random: Random,
    operands: Vec<Driven>,
    /// The operand that says how many results a computation has.
    length: Option<usize>,
    reset: usize,
    start: usize,
    phase: Phase,
    inputs: Vec<u64>,
    /// Whether a reset has come between the start of the current computation and now.
    disturbed: bool,
    first: bool,
}

impl Stimulus {
    /// The inputs of `design` in the order of its ports; `operands` give the domains.
    ///
    /// Operands of the design that `operands` does not mention take any bit pattern.
    pub fn new(design: &Design, operands: &[Operand], seed: u64) -> Self {
        let names: Vec<&str> =
            design.inputs().map(|port| design.net(port.net).name.as_str()).collect();
        let position = |net: NetId| {
            let name = &design.net(net).name;
            names.iter().position(|other| other == name).unwrap_or(0)
        };
        let mut driven = Vec::new();
        let (mut reset, mut start) = (0, 0);
        for port in design.inputs() {
            let net = design.net(port.net);
            match port.role {
                Role::Reset => reset = position(port.net),
                Role::Start => start = position(port.net),
                Role::Operand { strobe } => {
                    let known = operands.iter().find(|operand| operand.name == net.name);
                    let operand = known.cloned().unwrap_or_else(|| Operand {
                        name: net.name.clone(),
                        format: net.format,
                        domain: (net.format.min_raw() as i64, net.format.max_raw() as i64),
                        colour: false,
                        doc: String::new(),
                    });
                    driven.push(Driven {
                        data: position(port.net),
                        strobe: position(strobe),
                        mask: mask(operand.format.width()),
                        operand,
                        accepted: 0,
                    });
                }
                _ => {}
            }
        }
        Self {
            random: Random::new(seed),
            operands: driven,
            length: None,
            reset,
            start,
            phase: Phase::Reset(2),
            inputs: vec![0; names.len()],
            disturbed: false,
            first: true,
        }
    }

    /// Operand `name` says how many results a computation has: it is drawn small more often than not, so that
    /// long computations do not crowd out all others.
    #[must_use]
    pub fn with_length(mut self, name: &str) -> Self {
        self.length = self.position(name);
        self
    }

    /// The position of an operand among those of the design, for [`Stimulus::accepted`].
    pub fn position(&self, name: &str) -> Option<usize> {
        self.operands.iter().position(|driven| driven.operand.name == name)
    }

    /// The raw value that was last written to an operand while the device could take it.
    pub fn accepted(&self, position: usize) -> i64 {
        self.operands[position].accepted
    }

    /// Whether the computation that runs was started by this stimulus and not reset since.
    pub fn undisturbed(&self) -> bool {
        !self.disturbed
    }

    /// The inputs of the next clock, given `busy` as it stands before the edge.
    pub fn next(&mut self, busy: bool) -> &[u64] {
        self.inputs.fill(0);
        self.inputs[self.reset] = 1;
        match self.phase {
            Phase::Reset(left) => {
                self.inputs[self.reset] = 0;
                self.disturbed = true;
                if !self.first {
                    self.noise(busy);
                }
                self.phase = if left > 0 { Phase::Reset(left - 1) } else { self.next_point() };
            }
            Phase::Writing(left) => self.write(left),
            Phase::Starting(idle) => {
                if idle == 0 {
                    self.begin();
                } else {
                    self.phase = Phase::Starting(idle - 1);
                }
            }
            Phase::Running(reset) => self.run(busy, reset),
        }
        self.accept(busy);
        &self.inputs
    }

    /// The latest inputs.
    #[inline]
    pub fn inputs(&self) -> &[u64] {
        &self.inputs
    }

    fn begin(&mut self) {
        self.inputs[self.start] = 1;
        self.disturbed = false;
        self.first = false;
        let reset = self.random.once_in(16).then(|| {
            let magnitude = self.random.below(RESET_MAGNITUDES);
            self.random.below(1 << magnitude)
        });
        self.phase = Phase::Running(reset);
    }

    /// A clock after `start`: until the device has ended, now and then something that it must ignore,
    /// or a reset.
    fn run(&mut self, busy: bool, reset: Option<u64>) {
        if busy {
            if self.random.once_in(6) {
                self.noise(true);
            }
            self.phase = Phase::Running(reset.map(|clocks| clocks.saturating_sub(1)));
            if reset == Some(0) {
                self.inputs[self.reset] = 0;
                self.disturbed = true;
                self.phase = Phase::Reset(self.random.below(3) as u32);
            }
            return;
        }
        // Ended, and the device takes operands again in this very clock.
        self.phase = self.next_point();
        match self.phase {
            Phase::Writing(left) => self.write(left),
            Phase::Starting(0) => self.begin(),
            Phase::Starting(idle) => self.phase = Phase::Starting(idle - 1),
            _ => {}
        }
    }

    /// What to do for the next point.
    fn next_point(&mut self) -> Phase {
        let all = (1u64 << self.operands.len()) - 1;
        if self.first {
            return Phase::Writing(all);
        }
        match self.random.below(8) {
            // The same operands once more.
            0 => Phase::Starting(self.random.below(4) as u32),
            // Some of them.
            1 | 2 => Phase::Writing(self.random.bits() & all),
            _ => Phase::Writing(all),
        }
    }

    /// Writes of the operands in `left`: one, or all at once, perhaps together with `start`.
    fn write(&mut self, left: u64) {
        let now = match self.random.below(4) {
            0 if left != 0 => 1 << left.trailing_zeros(),
            1 => left & self.random.bits(),
            _ => left,
        };
        for at in 0..self.operands.len() {
            if now >> at & 1 == 1 {
                let bits = self.value(at);
                let driven = &self.operands[at];
                self.inputs[driven.data] = bits;
                self.inputs[driven.strobe] = 1;
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

    /// Strobes, data and `start` at random: ignored while busy.
    fn noise(&mut self, busy: bool) {
        for at in 0..self.operands.len() {
            let bits = self.value(at);
            let strobe = self.random.once_in(3);
            let driven = &self.operands[at];
            self.inputs[driven.data] = bits;
            self.inputs[driven.strobe] = u64::from(strobe);
        }
        if busy {
            self.inputs[self.start] = u64::from(self.random.once_in(2));
        }
    }

    /// A bit pattern for an operand: mostly of its domain, often at its ends or close to one (or to 0, which
    /// is as good as an end), sometimes anything.
    fn value(&mut self, at: usize) -> u64 {
        let Driven { operand, mask, .. } = &self.operands[at];
        let (low, high) = operand.domain;
        let reach = high.abs_diff(low).max(1);
        if self.length == Some(at) && !self.random.once_in(16) {
            // Of a random magnitude, small ones first: the smaller of two draws.
            let magnitudes = u64::from(64 - reach.leading_zeros()) + 1;
            let bits = self.random.below(magnitudes);
            let bits = bits.min(self.random.below(magnitudes));
            let above = self.random.below(1 << bits.min(62)).min(reach);
            return low.wrapping_add(above as i64) as u64 & mask;
        }
        self.random.pattern(&self.operands[at].operand)
    }

    /// Notes what the registers take at this edge.
    fn accept(&mut self, busy: bool) {
        if busy {
            return;
        }
        for driven in &mut self.operands {
            if self.inputs[driven.strobe] == 1 {
                driven.accepted = driven.operand.format.raw(self.inputs[driven.data]) as i64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::fixed::Format;
    use crate::hdl::dsl::{Designer, end, step, valid};

    /// A design with one operand; how long a computation takes is for the tests to say.
    fn design() -> Design {
        let d = Designer::new("device");
        let x = d.operand("x", Format::unsigned(12, 0));
        let y = d.register("y", x.q().format());
        y.takes(x.q());
        d.output("y_out", y.q());
        d.microprogram([step("idle", []), step("load", [y.load(), valid(), end()])]);
        d.finish().unwrap()
    }

    #[test]
    fn what_is_drawn_of_a_domain_is_in_it() {
        let mut random = Random::new(5);
        for (low, high) in [(0, 0), (7, 7), (0, 1), (-3, -2), (-4, 9), (i64::MIN, i64::MAX)] {
            let mut ends = [false; 2];
            for _ in 0..500 {
                let raw = random.of_domain((low, high));
                assert!((low..=high).contains(&raw), "{raw} of {low}..={high}");
                ends = [ends[0] || raw == low, ends[1] || raw == high];
            }
            assert_eq!(ends, [true; 2], "{low}..={high}");
        }
    }

    /// What happened to computations of some length.
    #[derive(Debug, Default)]
    struct Events {
        complete: u32,
        reset: u32,
        written: u32,
        started_again: u32,
        with_last_write: u32,
    }

    fn events(length: u32, clocks: u32) -> Events {
        let mut stimulus = Stimulus::new(&design(), &[], 1);
        let (reset, start, strobe) = (stimulus.reset, stimulus.start, stimulus.operands[0].strobe);
        let mut left = 0;
        let mut events = Events::default();
        for _ in 0..clocks {
            let busy = left > 0;
            let inputs = stimulus.next(busy);
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
    fn short_computations_meet_everything() {
        let events = events(10, 100_000);
        assert!(events.complete > 5_000, "{events:?}");
        // One in some forty.
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

    #[test]
    fn lengths_are_small_and_at_times_the_largest() {
        let mut stimulus = Stimulus::new(&design(), &[], 1).with_length("x");
        let drawn: Vec<u64> = (0..10_000).map(|_| stimulus.value(0)).collect();
        let count = |wanted: fn(u64) -> bool| drawn.iter().filter(|&&x| wanted(x)).count();
        assert!(count(|x| x == 0) > 1_000);
        assert!(count(|x| x < 64) > 6_000);
        assert!(count(|x| x > 2_000) > 200);
        assert!(count(|x| x == 4095) > 20);
    }
}
