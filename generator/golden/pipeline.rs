//! The handshake of a pipeline: which stage has which point.

use std::collections::VecDeque;

/// The points in the stages of a pipeline, and when they move.
///
/// All points move on together. They do not while the last stage has one that is not taken. A point is
/// taken when it is offered and all points move.
#[derive(Clone, Debug)]
pub struct Occupancy<P> {
    /// From stage 1 on; the last has the results.
    stages: VecDeque<Option<P>>,
}

impl<P> Occupancy<P> {
    /// A pipeline of `latency` stages without any point.
    pub fn empty(latency: usize) -> Self {
        Self { stages: (0..latency).map(|_| None).collect() }
    }

    /// Whether a point that is offered is taken: `in_ready`.
    pub fn moves(&self, out_ready: bool) -> bool {
        out_ready || self.last().is_none()
    }

    /// The point whose results are on the outputs; there is one exactly if `out_valid` is high.
    pub fn last(&self) -> Option<&P> {
        self.stages.back().and_then(Option::as_ref)
    }

    /// The point in a stage, which counts from 1.
    pub fn stage(&self, stage: usize) -> Option<&P> {
        self.stages.get(stage.checked_sub(1)?).and_then(Option::as_ref)
    }

    /// The points with their stages, from 1 on.
    pub fn points(&self) -> impl Iterator<Item = (usize, &P)> {
        let stages = self.stages.iter().enumerate();
        stages.filter_map(|(at, point)| point.as_ref().map(|point| (at + 1, point)))
    }

    /// A rising edge. The point whose results were taken.
    pub fn clock(&mut self, rst_n: bool, offered: Option<P>, out_ready: bool) -> Option<P> {
        let taken = if self.moves(out_ready) {
            self.stages.push_front(offered);
            self.stages.pop_back().flatten()
        } else {
            None
        };
        if !rst_n {
            self.stages.iter_mut().for_each(|point| *point = None);
        }
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::Occupancy;

    #[test]
    fn a_point_waits_at_the_end_and_nothing_overtakes_it() {
        let mut stages = Occupancy::empty(2);
        assert_eq!(stages.clock(true, Some('a'), false), None);
        assert_eq!(stages.clock(true, Some('b'), false), None);
        assert_eq!(stages.last(), Some(&'a'));
        assert!(!stages.moves(false) && stages.moves(true));
        assert_eq!(stages.clock(true, Some('c'), false), None);
        assert_eq!(stages.clock(true, None, true), Some('a'));
        assert_eq!(stages.clock(true, None, true), Some('b'));
        assert_eq!(stages.clock(true, None, true), None);
    }

    #[test]
    fn a_reset_drops_every_point() {
        let mut stages = Occupancy::empty(3);
        stages.clock(true, Some(1), true);
        stages.clock(false, Some(2), true);
        assert_eq!(stages.points().count(), 0);
    }
}
