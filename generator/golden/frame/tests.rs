use super::*;
use crate::golden::Model;

/// An operand that counts down by ones, or not at all where it is 0 (s1.2, clamped to 0 … 1.0).
struct Countdown {
    from: Slot,
    count: Slot,
    twice: Slot,
}

impl Datapath for Countdown {
    fn outputs(&self, state: &mut State) {
        state[self.twice] = -2 * state[self.count];
    }
}

fn model(valid_delay: u32) -> Clocked<Countdown> {
    let mut frame = Frame::default();
    let device = Countdown {
        from: frame.clamped("from", Format::signed(1, 2), 0, 4),
        count: frame.register("count", Format::unsigned(3, 0)),
        twice: frame.output("twice", Format::signed(4, 0)),
    };
    let counts = frame.flag("counts");
    frame.delay_valid(valid_delay);
    let load = step(|it: &Countdown, s| s[it.count] = s[it.from]);
    let count = step(|it: &Countdown, s| s[it.count] -= 1);
    frame.model(
        device,
        [
            idle(),
            load.skip_if(1, |it, s| s[it.from] == 0),
            count.repeat_while(|it, s| s[it.count] > 1).asserts(counts),
            idle().valid().end(),
        ],
    )
}

const NAMES: [&str; 7] = ["run", "word_address", "count", "twice", "counts", "valid", "done"];

#[track_caller]
fn assert_course(mut model: Clocked<Countdown>, from: u64, expected: &[[u64; 7]]) {
    model.clock(&[1, 1, from, 1]);
    for row in expected {
        assert_eq!(NAMES.map(|name| model.value(name).unwrap()), *row);
        // Writes and starts while busy change nothing.
        model.clock(&[1, row[0], 1, row[0]]);
    }
}

#[test]
fn a_loop_runs_from_idle_to_the_end() {
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 2, 28, 1, 0, 0],
        [1, 2, 1, 30, 1, 0, 0],
        [1, 3, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 0],
    ];
    assert_course(model(0), 2, &course);
}

#[test]
fn a_microinstruction_is_passed_over() {
    // 1111 is −1/4, which the register takes for 0.
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 3, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 0],
    ];
    assert_course(model(0), 15, &course);
}

#[test]
fn valid_comes_later_and_a_reset_forgets_it() {
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 3, 0, 0, 0, 0, 1],
        [0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 1, 0],
    ];
    assert_course(model(2), 0, &course);
    let mut reset = model(2);
    for row in [[1, 1, 0, 1], [1, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]] {
        reset.clock(&row);
        assert_eq!(reset.value("valid"), Some(0));
    }
    reset.clock(&[1, 0, 0, 0]);
    assert_eq!(reset.value("valid"), Some(0));
}

#[test]
fn an_operand_clamps_and_is_written_by_its_strobe() {
    let mut model = model(0);
    // 7/4 is beyond 1.0; without a strobe nothing is taken; −1/4 is 0.
    for (row, held) in [([1, 0, 7, 1], 4), ([1, 0, 1, 0], 4), ([1, 0, 15, 1], 0)] {
        model.clock(&row);
        assert_eq!(model.value("from_reg"), Some(held));
    }
    assert_eq!(model.inputs(), ["rst_n", "start", "from", "from_write"]);
    assert_eq!(model.value("nothing"), None);
}
