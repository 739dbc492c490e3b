//! Models which point each stage of a pipeline contains, clock by clock. The model predicts the handshake, and computes no
//! results.

use std::collections::VecDeque;

/// The points in the stages.
///
/// At a rising edge either all points move to the next stage or none does. The points stay if the last stage contains a point
/// whose results nobody takes (`out_ready` is low). A pipeline with an interval of more than 1 accepts a new point only at every
/// `interval`-th move.
#[derive(Clone, Debug)]
pub struct Occupancy<P> {
    /// The points from stage 1 on. The last stage has the results.
    stages: VecDeque<Option<P>>,
    interval: usize,
    slot: usize,
}

impl<P> Occupancy<P> {
    /// Makes an empty pipeline of `latency` stages that accepts a point every `interval` clocks. A point's results are on the
    /// outputs after `latency` rising edges, counting the edge that accepts the point.
    pub fn empty(latency: usize, interval: usize) -> Self {
        Self { stages: (0..latency).map(|_| None).collect(), interval, slot: 0 }
    }

    /// Returns whether the pipeline accepts a point in this clock: the value of `in_ready`.
    pub fn takes(&self, out_ready: bool) -> bool {
        self.moves(out_ready) && self.slot == 0
    }

    fn moves(&self, out_ready: bool) -> bool {
        out_ready || self.last().is_none()
    }

    /// Returns the point whose results are on the outputs; `None` exactly if `out_valid` is low.
    pub fn last(&self) -> Option<&P> {
        self.stages.back().and_then(Option::as_ref)
    }

    /// Returns the point in stage number `stage`, counted from 1; `None` if the stage has no point or does not exist.
    pub fn stage(&self, stage: usize) -> Option<&P> {
        self.stages.get(stage.checked_sub(1)?).and_then(Option::as_ref)
    }

    pub fn is_empty(&self) -> bool {
        self.stages.iter().all(Option::is_none)
    }

    /// Returns every point with the number of its stage, from 1 on.
    pub fn points(&self) -> impl Iterator<Item = (usize, &P)> {
        let stages = self.stages.iter().enumerate();
        stages.filter_map(|(at, point)| point.as_ref().map(|point| (at + 1, point)))
    }

    /// Performs a rising edge. The pipeline drops the point `offered` if it does not accept it in this clock
    /// ([`Occupancy::takes`]). Returns the point whose results were taken at this edge. If `rst_n` is low, the pipeline is empty
    /// after the edge.
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
        // The pipeline does not accept a point in this clock, so `b` is lost.
        assert_eq!(stages.clock(true, Some('b'), true), None);
        assert_eq!(stages.clock(true, None, false), None);
        assert_eq!(stages.clock(true, None, true), Some('a'));
        assert!(stages.takes(false));
        stages.clock(true, Some('c'), true);
        assert_eq!(stages.points().map(|(at, _)| at).collect::<Vec<_>>(), [1]);
    }
}
