//! Models the handshake of a pipeline clock by clock: which stage has which point, and when points move.

use std::collections::VecDeque;

/// The points in the stages of a pipeline, and when they move.
///
/// All points move on together. They do not while the last stage has one that is not taken. A point is
/// taken when it is offered, all points move and the slot is 0: every `interval` clocks in which they move.
#[derive(Clone, Debug)]
pub struct Occupancy<P> {
    /// From stage 1 on; the last has the results.
    stages: VecDeque<Option<P>>,
    interval: usize,
    slot: usize,
}

impl<P> Occupancy<P> {
    /// Makes a pipeline of `latency` stages without any point, which takes one every `interval` clocks. For example, a point
    /// that `empty(2, 1)` takes has its results on the outputs after two rising edges, the taking one included.
    pub fn empty(latency: usize, interval: usize) -> Self {
        Self { stages: (0..latency).map(|_| None).collect(), interval, slot: 0 }
    }

    /// Returns whether a point that is offered is taken: `in_ready`.
    pub fn takes(&self, out_ready: bool) -> bool {
        self.moves(out_ready) && self.slot == 0
    }

    /// Returns whether all points move on.
    fn moves(&self, out_ready: bool) -> bool {
        out_ready || self.last().is_none()
    }

    /// Returns the point whose results are on the outputs; there is one exactly if `out_valid` is high.
    pub fn last(&self) -> Option<&P> {
        self.stages.back().and_then(Option::as_ref)
    }

    /// Returns the point in a stage, which counts from 1.
    pub fn stage(&self, stage: usize) -> Option<&P> {
        self.stages.get(stage.checked_sub(1)?).and_then(Option::as_ref)
    }

    /// Returns the points with their stages, from 1 on.
    pub fn points(&self) -> impl Iterator<Item = (usize, &P)> {
        let stages = self.stages.iter().enumerate();
        stages.filter_map(|(at, point)| point.as_ref().map(|point| (at + 1, point)))
    }

    /// Performs a rising edge, and returns the point whose results were taken.
    pub fn clock(&mut self, rst_n: bool, offered: Option<P>, out_ready: bool) -> Option<P> {
        let taken = if self.moves(out_ready) {
            self.stages.push_front(offered.filter(|_| self.slot == 0));
            self.slot = (self.slot + 1) % self.interval;
            self.stages.pop_back().flatten()
        } else {
            None
        };
        if !rst_n {
            self.stages.iter_mut().for_each(|point| *point = None);
            self.slot = 0;
        }
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::Occupancy;

    #[test]
    fn a_point_waits_at_the_end_and_nothing_overtakes_it() {
        let mut stages = Occupancy::empty(2, 1);
        assert_eq!(stages.clock(true, Some('a'), false), None);
        assert_eq!(stages.clock(true, Some('b'), false), None);
        assert_eq!(stages.last(), Some(&'a'));
        assert!(!stages.takes(false) && stages.takes(true));
        assert_eq!(stages.clock(true, Some('c'), false), None);
        assert_eq!(stages.clock(true, None, true), Some('a'));
        assert_eq!(stages.clock(true, None, true), Some('b'));
        assert_eq!(stages.clock(true, None, true), None);
    }

    #[test]
    fn a_reset_drops_every_point() {
        let mut stages = Occupancy::empty(3, 2);
        stages.clock(true, Some(1), true);
        assert!(!stages.takes(true));
        stages.clock(false, Some(2), true);
        assert_eq!(stages.points().count(), 0);
        assert!(stages.takes(true));
    }

    #[test]
    fn a_point_is_taken_every_few_clocks_in_which_points_move() {
        let mut stages = Occupancy::empty(2, 3);
        assert!(stages.takes(false));
        assert_eq!(stages.clock(true, Some('a'), true), None);
        assert!(!stages.takes(true));
        // Offered too soon, and lost.
        assert_eq!(stages.clock(true, Some('b'), true), None);
        assert_eq!(stages.clock(true, None, false), None);
        assert_eq!(stages.clock(true, None, true), Some('a'));
        assert!(stages.takes(false));
        stages.clock(true, Some('c'), true);
        assert_eq!(stages.points().map(|(at, _)| at).collect::<Vec<_>>(), [1]);
    }
}
