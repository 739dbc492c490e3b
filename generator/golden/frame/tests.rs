use super::*;
use crate::Model;

/// The operand `from` (s1.2, limited to 0 … 1.0) starts the countdown `count`, and the output `twice` is −2 · `count`.
fn countdown(frame: &mut Frame) -> (Slot, Slot) {
    let from = frame.clamped("from", Format::signed(1, 2), 0, 4);
    let count = frame.register("count", Format::unsigned(3, 0));
    frame.output("twice", Format::signed(4, 0), move |s| -2 * s[count]);
    (from, count)
}

fn model(valid_delay: u32) -> ClockedModel {
    let mut frame = Frame::default();
    let (from, count) = countdown(&mut frame);
    let counts = frame.flag("counts");
    frame.delay_valid(valid_delay);
    let load = step(move |s| s[count] = s[from]).skip_if(1, move |s| s[from] == 0);
    let down = step(move |s| s[count] -= 1).repeat_while(move |s| s[count] > 1);
    frame.model([idle(), load, down.asserts(counts), idle().valid().end()])
}

const NAMES: [&str; 7] = ["run", "word_address", "count", "twice", "counts", "valid", "done"];

#[track_caller]
fn assert_course(model: &mut dyn Model, from: u64, expected: &[[u64; 7]]) {
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
    assert_course(&mut model(0), 2, &course);
}

#[test]
fn a_microinstruction_is_passed_over() {
    // The bits 1111 are −1/4, which the register clamps to 0. The microinstruction that counts is skipped.
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 3, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 0],
    ];
    assert_course(&mut model(0), 15, &course);
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
    assert_course(&mut model(2), 0, &course);
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

#[test]
fn results_in_registers() {
    let mut model = model(0).with_output_registers().expect("one result");
    // The register still shows 0 while `twice` itself would be −2 · 2. It shows −2 · 0 after the load.
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 2, 0, 1, 0, 0],
        [1, 2, 1, 0, 1, 0, 0],
        [1, 3, 0, 0, 0, 0, 0],
        [1, 4, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 0],
    ];
    assert_course(model.as_mut(), 2, &course);
}

/// A skip also skips an added microinstruction inside the skipped ones. The register keeps its result.
#[test]
fn a_jump_beyond_a_result_in_a_register() {
    let mut frame = Frame::default();
    let (from, count) = countdown(&mut frame);
    let counts = frame.flag("counts");
    let load = step(move |s| s[count] = s[from]);
    let program = [
        idle(),
        load,
        idle().skip_if(1, move |s| s[from] == 0),
        idle().valid().asserts(counts),
        idle().end(),
    ];
    let mut model = frame.model(program).with_output_registers().expect("one result");
    let mut course = |from: u64, clocks: usize| {
        let mut seen = Vec::new();
        for clock in 0..clocks {
            model.clock(&[1, u64::from(clock == 0), from, 1]);
            seen.push(NAMES.map(|name| model.value(name).unwrap()));
        }
        seen
    };
    let expected = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 3, 0, 0, 0, 0],
        // The register loads the result at the end of this clock: −6, which is 26 in five bits.
        [1, 3, 3, 0, 1, 0, 0],
        [1, 4, 3, 26, 0, 1, 0],
        [1, 5, 3, 26, 0, 0, 1],
        [0, 0, 3, 26, 0, 0, 0],
    ];
    assert_eq!(course(3, 7), expected);
    let expected = [
        [1, 0, 3, 26, 0, 0, 0],
        [1, 1, 3, 26, 0, 0, 0],
        [1, 2, 0, 26, 0, 0, 0],
        [1, 5, 0, 26, 0, 0, 1],
        [0, 0, 0, 26, 0, 0, 0],
    ];
    assert_eq!(course(0, 5), expected);
}

#[test]
fn results_in_registers_that_follow() {
    let mut model = model(2).with_output_registers().expect("one result");
    let course = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 2, 0, 1, 0, 0],
        [1, 2, 1, 28, 1, 0, 0],
        [1, 3, 0, 30, 0, 0, 0],
        [1, 4, 0, 0, 0, 0, 1],
        [0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 1, 0],
    ];
    assert_course(model.as_mut(), 2, &course);
}

/// A microinstruction with `valid` must not decide by a condition what follows.
#[test]
fn no_registers_behind_a_result_that_decides() {
    let mut frame = Frame::default();
    let (_, count) = countdown(&mut frame);
    let again = idle().valid().repeat_while(move |s| s[count] > 0);
    let model = frame.model([idle(), again, idle().end()]);
    assert!(model.with_output_registers().is_none());
}

/// A `start` in the last microinstruction begins the next computation, with the value that is written in the same clock.
#[test]
fn operands_in_buffers() {
    let mut model = model(0).with_operand_buffers().expect("a frame's");
    let names = ["run", "word_address", "from_buffer", "from_reg", "count"];
    // rst_n, start, from, write; then the values after the edge.
    let course = [
        ([1, 0, 1, 1], [0, 0, 1, 0, 0]),
        ([1, 1, 9, 0], [1, 0, 1, 1, 0]),
        ([1, 1, 3, 1], [1, 1, 3, 1, 0]),
        ([1, 0, 9, 0], [1, 2, 3, 1, 1]),
        ([1, 0, 9, 0], [1, 3, 3, 1, 0]),
        ([1, 1, 2, 1], [1, 0, 2, 2, 0]),
        ([1, 0, 9, 0], [1, 1, 2, 2, 0]),
        ([0, 1, 9, 0], [0, 0, 2, 2, 2]),
    ];
    for (inputs, expected) in course {
        model.clock(&inputs);
        assert_eq!(names.map(|name| model.value(name).unwrap()), expected, "{inputs:?}");
    }
}

/// The operand selects microinstruction 2 or 3. An added microinstruction for a result register moves the numbers behind it.
#[test]
fn an_operand_selects_the_next_microinstruction() {
    let mut frame = Frame::default();
    let x = frame.operand("x", Format::unsigned(1, 0));
    let sum = frame.register("sum", Format::unsigned(4, 0));
    frame.output("sum_out", Format::unsigned(4, 0), move |s| s[sum]);
    let program = [
        idle(),
        step(move |s| s[sum] = 1).dispatch(x, &[2, 3]),
        step(move |s| s[sum] += 2),
        step(move |s| s[sum] += 4).dispatch(x, &[5, 4]),
        step(move |s| s[sum] += 8),
        idle().valid().end(),
    ];
    let frame_model = frame.model(program);
    let addresses = |model: &mut dyn Model, x: u64| {
        let mut addresses = Vec::new();
        model.clock(&[1, 1, x, 1]);
        while model.value("busy") == Some(1) {
            addresses.push(model.value("word_address").unwrap());
            model.clock(&[1, 0, 0, 0]);
        }
        (addresses, model.value("sum_out").unwrap())
    };
    let mut model = frame_model.clone();
    assert_eq!(addresses(&mut model, 0), (vec![0, 1, 2, 3, 5], 7));
    assert_eq!(addresses(&mut model, 1), (vec![0, 1, 3, 4, 5], 13));
    let mut model = frame_model.with_output_registers().expect("one result");
    assert_eq!(addresses(&mut *model, 0), (vec![0, 1, 2, 3, 5, 6], 7));
}
