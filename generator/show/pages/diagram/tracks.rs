//! Assigns the vertical pieces of wires in the gap between two columns of a block diagram to parallel tracks.
//!
//! Two pieces that would overlap get different tracks. The order of the tracks is chosen so that few wires cross.

/// The smallest distance at which two parallel lines do not seem to touch, in units of the drawing.
const NEAR: f64 = 5.0;

/// The cost of two wires that would lie upon each other, as a number of crossings. It exceeds the crossings that occur in a
/// gap.
const OVERLAP: usize = 1000;

/// The side of the gap between two columns at which a wire enters or leaves the gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side of columns with lower numbers.
    Left,
    /// The side of columns with higher numbers.
    Right,
}

/// The vertical piece of one box's wires in the gap between two columns, with horizontal taps to the left and right.
#[derive(Clone, Debug)]
pub struct Trunk {
    /// The index of the box that drives the wires.
    pub net: usize,
    pub entry: (f64, Side),
    pub exits: Vec<(f64, Side)>,
    /// The number of the track from the left, which [`assign`] sets.
    pub track: usize,
}

impl Trunk {
    /// Returns the vertical position of each horizontal tap, and the side of the gap to which it leads.
    pub fn taps(&self) -> impl Iterator<Item = (f64, Side)> + '_ {
        std::iter::once(self.entry).chain(self.exits.iter().copied())
    }

    pub fn reach(&self) -> (f64, f64) {
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for (y, _) in self.taps() {
            low = low.min(y);
            high = high.max(y);
        }
        (low, high)
    }

    fn reaches(&self, y: f64) -> bool {
        let (low, high) = self.reach();
        (low..=high).contains(&y)
    }

    pub fn is_straight(&self) -> bool {
        let (low, high) = self.reach();
        high - low < 0.5
    }

    /// Returns a position's cost to the left of `other`: the number of crossings, plus [`OVERLAP`] for each pair of horizontal
    /// taps that would lie upon each other.
    fn left_of(&self, other: &Self) -> usize {
        let (mut crossings, mut overlaps) = (0, 0);
        for (y, side) in self.taps() {
            if side != Side::Right {
                continue;
            }
            if other.reaches(y) {
                crossings += 1;
            }
            for (other_y, other_side) in other.taps() {
                if other_side == Side::Left && (y - other_y).abs() < NEAR {
                    overlaps += 1;
                }
            }
        }
        for (y, side) in other.taps() {
            if side == Side::Left && self.reaches(y) {
                crossings += 1;
            }
        }
        crossings + OVERLAP * overlaps
    }

    /// Returns whether two trunks overlap, so they cannot share a track.
    fn meets(&self, other: &Self) -> bool {
        let ((low, high), (from, to)) = (self.reach(), other.reach());
        from < high + NEAR && low < to + NEAR
    }
}

/// Orders a gap's trunks so that few wires cross, sets their tracks, and returns the number of tracks. For example, two trunks
/// that go down from 0 to 40 and from 20 to 60 need two tracks.
pub fn assign(trunks: &mut [Trunk]) -> usize {
    trunks.sort_by(|a, b| a.reach().0.total_cmp(&b.reach().0));
    // Exchange neighbours as long as an exchange reduces the cost. Every exchange reduces the total cost, so the loop ends.
    let mut better = true;
    while better {
        better = false;
        for at in 1..trunks.len() {
            let (a, b) = (&trunks[at - 1], &trunks[at]);
            if b.left_of(a) < a.left_of(b) {
                trunks.swap(at - 1, at);
                better = true;
            }
        }
    }
    while separate(trunks) {}
    let mut tracks = 0;
    for at in 0..trunks.len() {
        if trunks[at].is_straight() {
            continue;
        }
        let mut track = 0;
        for other in &trunks[..at] {
            let is_bound = other.meets(&trunks[at]) || trunks[at].left_of(other) >= OVERLAP;
            if is_bound && !other.is_straight() {
                track = track.max(other.track + 1);
            }
        }
        trunks[at].track = track;
        tracks = tracks.max(track + 1);
    }
    tracks
}

/// Moves a trunk to the left of a second trunk if fewer wires then lie upon each other, and returns whether it did. Exchanges of
/// neighbours can miss such a move, because a trunk between the two may cost the same on both sides.
fn separate(trunks: &mut [Trunk]) -> bool {
    let before = overlaps(trunks);
    for right in 1..trunks.len() {
        for left in 0..right {
            if trunks[left].left_of(&trunks[right]) < OVERLAP {
                continue;
            }
            trunks[left..=right].rotate_right(1);
            if overlaps(trunks) < before {
                return true;
            }
            trunks[left..=right].rotate_left(1);
        }
    }
    false
}

fn overlaps(trunks: &[Trunk]) -> usize {
    let mut count = 0;
    for (at, trunk) in trunks.iter().enumerate() {
        for other in &trunks[at + 1..] {
            count += usize::from(trunk.left_of(other) >= OVERLAP);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trunk(net: usize, from: f64, to: f64) -> Trunk {
        Trunk { net, entry: (from, Side::Left), exits: vec![(to, Side::Right)], track: 0 }
    }

    fn tracks(trunks: &[Trunk]) -> Vec<(usize, usize)> {
        let mut tracks: Vec<_> = trunks.iter().map(|it| (it.net, it.track)).collect();
        tracks.sort_unstable();
        tracks
    }

    #[test]
    fn wires_that_do_not_meet_share_a_track() {
        let mut trunks = [trunk(0, 0.0, 20.0), trunk(1, 50.0, 80.0), trunk(2, 90.0, 90.0)];
        assert_eq!(assign(&mut trunks), 1);
        assert_eq!(tracks(&trunks), [(0, 0), (1, 0), (2, 0)]);
    }

    #[test]
    fn parallel_wires_do_not_cross() {
        // Both wires go down, so the lower wire must turn first.
        let mut trunks = [trunk(0, 0.0, 40.0), trunk(1, 20.0, 60.0)];
        assert_eq!(assign(&mut trunks), 2);
        assert_eq!(tracks(&trunks), [(0, 1), (1, 0)]);
        assert_eq!(trunks[0].left_of(&trunks[1]), 0);
    }

    /// The straight wire between the two costs the same on both sides, so no exchange of neighbours helps.
    #[test]
    fn a_wire_between_does_not_keep_wires_upon_each_other() {
        let mut trunks = [trunk(0, 0.0, 50.0), trunk(1, 25.0, 25.0), trunk(2, 50.0, 100.0)];
        assign(&mut trunks);
        let track = |net| trunks.iter().find(|it| it.net == net).map(|it| it.track);
        assert!(track(0) > track(2), "{trunks:?}");
    }

    #[test]
    fn wires_never_lie_upon_each_other() {
        // The first wire leaves the gap on the right at the height at which the second one enters on the left.
        let mut trunks = [trunk(0, 0.0, 50.0), trunk(1, 50.0, 100.0)];
        assert_eq!(assign(&mut trunks), 2);
        let track = |net| trunks.iter().find(|it| it.net == net).map(|it| it.track);
        assert!(track(0) > track(1), "{trunks:?}");
    }
}
