use super::{Delays, Goal, IntervalGoal, Options, PipelineError, PipelineErrorKind, pipeline};
use crate::blocks::divider::Divider;
use crate::dsl::fixture::design;
use crate::dsl::{dispatch, loop_while, step, wait_for_start};
use crate::netlist::{Design, Driver, Net, NetId, NetlistRegister, Op, RegId};
use glint_base::fixed::{Format, Overflow, Rounding};
use glint_base::target::Timing;

fn options(goal: Goal) -> Options {
    let target = Timing::named("ecp5").expect("a target");
    Options {
        target,
        goal,
        interval: IntervalGoal::Clocks(1),
        registered: false,
        stall: true,
        side: 0,
        delays: Delays::Memory,
    }
}

/// Computes a quotient of 8 bits, one bit a clock.
fn ratio() -> Design {
    design(|d| {
        let a = d.operand("a", Format::unsigned(8, 0));
        let b = d.operand("b", Format::unsigned(8, 0));
        let ratio = Divider::new(d, "ratio", a.q(), b.q(), 8);
        d.output("ratio_out", ratio.quotient());
        vec![
            step("load", ratio.load()),
            step("bit", ratio.step().into_iter().chain([loop_while(ratio.more(), "bit")])),
        ]
    })
}

fn refused(design: &Design, goal: Goal) -> PipelineError {
    pipeline(design, &options(goal)).expect_err("it cannot be made")
}

fn stages(design: &Design, goal: Goal) -> (usize, u32) {
    let made = pipeline(design, &options(goal)).unwrap_or_else(|wrong| panic!("{wrong}"));
    let stages = made.pipeline.expect("a pipeline").stages;
    (stages.len(), stages.iter().map(|stage| stage.register_bits).sum())
}

#[test]
fn a_slower_clock_takes_fewer_stages_and_fewer_registers() {
    let design = ratio();
    let (fast, slow) =
        (stages(&design, Goal::ClockMhz(150.0)), stages(&design, Goal::ClockMhz(40.0)));
    assert!(slow.0 < fast.0 && slow.1 < fast.1, "{slow:?} {fast:?}");
}

#[test]
fn so_many_stages_are_made_as_are_asked_for() {
    for wanted in 1..=6 {
        assert_eq!(stages(&ratio(), Goal::Stages(wanted)).0, wanted);
    }
}

#[test]
fn a_clock_that_cannot_be_met_names_the_nearest_and_what_limits_it() {
    let error = refused(&ratio(), Goal::ClockMhz(1500.0));
    let text = error.to_string();
    assert!(text.contains("cannot run at 1500 MHz"), "{text}");
    assert!(text.contains("`ratio_trial") && text.contains("pipeline/tests.rs"), "{text}");
    let PipelineErrorKind::Clock { nearest, registered: None } = error.kind else {
        panic!("{error:?}")
    };
    stages(&ratio(), Goal::ClockMhz(nearest));
    refused(&ratio(), Goal::ClockMhz(nearest + 0.2));
}

#[test]
fn more_stages_than_are_of_use_are_refused_with_the_most() {
    let error = refused(&ratio(), Goal::Stages(1000));
    let PipelineErrorKind::TooManyStages { most } = error.kind else { panic!("{error:?}") };
    assert_eq!(stages(&ratio(), Goal::Stages(most)).0, most);
}

#[test]
fn a_microprogram_that_waits_on_the_way_cannot_be_unrolled() {
    let design = design(|d| {
        let x = d.operand("x", Format::unsigned(8, 0));
        let y = d.register("y", x.q().format());
        y.takes(x.q());
        d.output("y_out", y.q());
        vec![step("pause", [wait_for_start()]), step("load", [y.load()])]
    });
    let text = refused(&design, Goal::ClockMhz(100.0)).to_string();
    assert!(text.contains("`pause` waits for `start`"), "{text}");
    assert!(text.contains("pipeline/tests.rs"), "{text}");
}

#[test]
fn a_loop_without_a_bound_cannot_be_unrolled() {
    let design = design(|d| {
        let x = d.operand("x", Format::unsigned(20, 0));
        let iterations = d.down_counter("iterations", x.q());
        let more = d.any("more", iterations.q());
        d.output("iterations_out", iterations.q());
        vec![
            step("load", [iterations.load()]),
            step("count", [iterations.count(), loop_while(more, "count")]),
        ]
    });
    let text = refused(&design, Goal::ClockMhz(100.0)).to_string();
    assert!(
        text.contains("`count` repeats a loop for which no largest trip count is found"),
        "{text}"
    );
}

/// Has two functions: one adds 1 to the operand, and one doubles it. Each function loads its own register.
fn two_functions() -> Design {
    let byte = Format::unsigned(8, 0);
    design(|d| {
        let opcode = d.operand("opcode", Format::BIT);
        let x = d.operand("x", byte);
        let one = d.raw_constant("one", 1, byte);
        let names = ["incremented", "doubled"];
        let [incremented, doubled] = names.map(|name| d.register(name, byte));
        let wrapped =
            |name: &str, sum| d.narrow(name, sum, byte, Rounding::Truncate, Overflow::Wrap);
        incremented.takes(wrapped("more", d.add("sum", x.q(), one)));
        doubled.takes(wrapped("twice", d.add("double", x.q(), x.q())));
        let result = d.choose("result", opcode.q(), [incremented.q(), doubled.q()]);
        d.output("result_out", result);
        vec![
            step("choose", [dispatch(opcode.q(), &["increment", "double"])]),
            step("increment", [incremented.load(), dispatch(opcode.q(), &["result", "result"])]),
            step("double", [doubled.load()]),
        ]
    })
}

#[test]
fn a_dispatch_is_unrolled_for_each_value_and_becomes_no_pipeline() {
    let design = two_functions();
    // No result depends on the register that its function does not load.
    assert!(super::carried(&design).is_none());
    let unrolled = super::unroll(&design).unwrap_or_else(|wrong| panic!("{wrong}"));
    let dispatched = unrolled.dispatched.expect("a dispatch");
    let [increment, double] = &dispatched.of_values[..] else { panic!("two values") };
    assert_ne!(increment[0].1, double[0].1);
    let error = refused(&design, Goal::Stages(2)).to_string();
    assert!(error.contains("the microinstruction `choose` dispatches"), "{error}");
}

#[test]
fn what_an_earlier_computation_left_cannot_be_a_result() {
    let design = design(|d| {
        let x = d.operand("x", Format::unsigned(8, 0));
        let total = d.register("total", Format::unsigned(8, 0));
        total.takes(d.add_modulo("sum", total.q(), x.q(), None));
        d.output("total_out", total.q());
        vec![step("add", [total.load()])]
    });
    let text = refused(&design, Goal::ClockMhz(100.0)).to_string();
    assert!(text.contains("`total_out` depends on the value that `total` had before"), "{text}");
    let carried = super::carried(&design).expect("a state from one point to the next").to_string();
    assert!(carried.contains("carries a state from one point to the next"), "{carried}");
    assert!(super::carried(&power()).is_none());
}

fn power() -> Design {
    design(|d| {
        let x = d.operand("x", Format::unsigned(9, 0));
        let square = d.register("square", Format::unsigned(18, 0));
        let fourth = d.register("fourth", Format::unsigned(36, 0));
        square.takes(d.mul("x_square", x.q(), x.q()));
        fourth.takes(d.mul("x_fourth", square.q(), square.q()));
        d.output("fourth_out", fourth.q());
        vec![step("square", [square.load()]), step("fourth", [fourth.load()])]
    })
}

#[test]
fn a_registered_multiplier_is_named_where_it_reaches_the_clock_and_holds_every_product() {
    let goal = Goal::ClockMhz(165.0);
    let error = refused(&power(), goal);
    assert!(error.to_string().contains("cannot run at 165 MHz: `fourth`"), "{error}");
    // The message names the registers also for a clock that even they do not reach.
    for clock in [165.0, 250.0] {
        let kind = refused(&power(), Goal::ClockMhz(clock)).kind;
        let PipelineErrorKind::Clock { nearest, registered: Some(higher) } = kind else {
            panic!("{kind:?}")
        };
        assert_eq!(higher, 173.9);
        assert!(nearest < 165.0, "{nearest}");
    }
    let made = pipeline(&power(), &Options { registered: true, ..options(goal) }).unwrap();
    let products = made.iter().filter(|(_, net)| matches!(net.driver, Driver::Op(Op::Mul(..))));
    let products: Vec<NetId> = products.map(|(id, _)| id).collect();
    assert_eq!(products.len(), 2);
    let registered = &made.pipeline.as_ref().expect("a pipeline").registered;
    let inside: Vec<NetId> =
        registered.iter().filter_map(|&it| Some(made.multiplier(it)?.product)).collect();
    assert_eq!(inside, products);
    // No other cell or register reads the product inside a multiplier.
    let data = made.registers.iter().filter_map(|register| register.data);
    let taken = made.iter().flat_map(|(id, _)| made.combinational_inputs(id)).chain(data);
    assert_eq!(taken.filter(|net| products.contains(net)).count(), products.len());
    let beyond = Options { registered: true, ..options(Goal::ClockMhz(250.0)) };
    let error = pipeline(&power(), &beyond).expect_err("too fast");
    assert!(error.to_string().contains("which allows at most 173.9 MHz"), "{error}");
    let kind = PipelineErrorKind::Clock { nearest: 173.9, registered: None };
    assert_eq!(error.kind, kind);
}

#[test]
fn without_registered_multipliers_no_register_is_inside_one() {
    let made = pipeline(&power(), &options(Goal::ClockMhz(100.0))).unwrap();
    let mut registers = (0..made.registers.len()).map(|at| RegId(at as u32));
    assert!(registers.all(|register| made.multiplier(register).is_none()));
}

/// A product that no stage reads for several stages is stored in a memory behind the multiplier's register.
#[test]
fn a_delay_line_begins_behind_a_registered_multiplier() {
    let goal = Goal::ClockMhz(165.0);
    let mut made = pipeline(&power(), &Options { registered: true, ..options(goal) }).unwrap();
    let registered = made.pipeline.as_ref().expect("a pipeline").registered.clone();
    let product = made.register(registered[0]).q;
    let second = made.multiplier(registered[1]).expect("a multiplier");
    // The scheduler delays the factors where they are narrower, so the test adds the delay by hand.
    let mut waiting = second.factors[0];
    for clocks in 1..=4 {
        let register = RegId(made.registers.len() as u32);
        let data = Some(waiting);
        waiting = NetId(made.nets.len() as u32);
        made.registers.push(NetlistRegister {
            q: waiting,
            data,
            ..made.register(registered[0]).clone()
        });
        made.nets.push(Net { driver: Driver::Register(register), ..made.net(product).clone() });
        let stages = &mut made.pipeline.as_mut().expect("a pipeline").stage_of;
        stages.push(stages[second.product.index()] + clocks);
    }
    made.nets[second.product.index()].driver = Driver::Op(Op::Mul(waiting, waiting));
    let lines = made.delay_lines();
    let values: Vec<_> = lines.iter().flat_map(|line| &line.values).collect();
    assert!(values.iter().any(|it| it.data == product && it.registers.len() == 5), "{lines:?}");
    assert!(values.iter().all(|it| it.registers.iter().all(|at| !registered.contains(at))));
}

/// Computes (x² + z)² + y with a wide y, which waits for the products, and compares another number with some constants.
fn sum_behind_products(comparisons: u32) -> Design {
    design(|d| {
        let x = d.operand("x", Format::unsigned(9, 0));
        let y = d.operand("y", Format::unsigned(40, 0));
        let z = d.operand("z", Format::unsigned(17, 0));
        let square = d.register("square", Format::unsigned(18, 0));
        let near = d.register("near", Format::unsigned(19, 0));
        let fourth = d.register("fourth", Format::unsigned(38, 0));
        let total = d.register("total", Format::unsigned(41, 0));
        square.takes(d.mul("x_square", x.q(), x.q()));
        near.takes(d.add("near_sum", square.q(), z.q()));
        fourth.takes(d.mul("near_square", near.q(), near.q()));
        total.takes(d.add("total_sum", fourth.q(), y.q()));
        d.output("total_out", total.q());
        let compared = d.operand("compared", Format::unsigned(40, 0));
        let mut is_any = d.less("below_first", compared.q(), z.q());
        for number in 0..comparisons {
            let limit = d.constant(
                &format!("limit{number}"),
                f64::from(2 * number + 1),
                Format::unsigned(40, 0),
            );
            let is_below = d.less(&format!("below{number}"), compared.q(), limit);
            is_any = d.xor(&format!("any{number}"), is_any, is_below);
        }
        d.output("any_out", is_any);
        vec![
            step("square", [square.load()]),
            step("near", [near.load()]),
            step("fourth", [fourth.load()]),
            step("total", [total.load()]),
        ]
    })
}

/// As many registers stay as there are look-up tables, and memories replace the rest.
#[test]
fn registers_stay_beside_look_up_tables() {
    let lines = |delays: Delays, comparisons: u32| {
        let options = Options { delays, ..options(Goal::ClockMhz(120.0)) };
        let made = pipeline(&sum_behind_products(comparisons), &options);
        made.unwrap_or_else(|wrong| panic!("{wrong}")).delay_lines().len()
    };
    let [little_logic, much_logic] = [0, 12];
    assert_eq!(lines(Delays::Memory, little_logic), 1);
    assert_eq!(lines(Delays::Auto, little_logic), 1);
    assert_eq!(lines(Delays::Memory, much_logic), 1);
    assert_eq!(lines(Delays::Auto, much_logic), 0);
    assert_eq!(lines(Delays::Registers, little_logic), 0);
}

/// Computes `(taken ? x : 0) + y`, and a fourth power that takes longer, so that the scheduler may delay the sum.
fn row_beside_a_power() -> Design {
    design(|d| {
        let x = d.operand("x", Format::unsigned(9, 0));
        let y = d.operand("y", Format::unsigned(9, 0));
        let taken = d.operand("taken", Format::BIT);
        let square = d.register("square", Format::unsigned(18, 0));
        let fourth = d.register("fourth", Format::unsigned(36, 0));
        let total = d.register("total", Format::unsigned(10, 0));
        square.takes(d.mul("x_square", x.q(), x.q()));
        fourth.takes(d.mul("x_fourth", square.q(), square.q()));
        let zero = d.constant("zero", 0.0, Format::unsigned(9, 0));
        let row = d.choose("row", taken.q(), [zero, x.q()]);
        total.takes(d.add("row_sum", row, y.q()));
        d.output("fourth_out", fourth.q());
        d.output("total_out", total.q());
        vec![step("square", [square.load(), total.load()]), step("fourth", [fourth.load()])]
    })
}

#[test]
fn a_choice_that_a_reset_makes_is_held_before_a_sum() {
    let made = pipeline(&row_beside_a_power(), &options(Goal::ClockMhz(130.0))).unwrap();
    let stages = &made.pipeline.as_ref().expect("a pipeline").stage_of;
    let stage = |id: NetId| stages[id.index()];
    let mut wanted = made.iter().filter_map(|(id, net)| match &net.driver {
        Driver::Op(Op::Mux { inputs, .. }) if inputs.len() == 2 => Some(id),
        _ => None,
    });
    let row = wanted.next().expect("the row");
    assert_eq!(wanted.next(), None);
    let is_sum = |net: &Net| matches!(net.driver, Driver::Op(Op::Add { .. }));
    let (sum, _) = made.iter().find(|(_, net)| is_sum(net)).expect("the sum");
    assert!(stage(row) < stage(sum), "{} {}", stage(row), stage(sum));
}

/// The signal that selects between a sum and 0.
#[derive(Clone, Copy)]
enum By {
    Nothing,
    Operand,
    /// A bit of the sum itself.
    Sum,
}

/// Returns the clock frequency in MHz of one stage, whose register loads a sum, or 0 if the signal `by` is 0.
fn clock_of_a_sum(by: By) -> f64 {
    let design = design(|d| {
        let wide = Format::unsigned(40, 0);
        let (a, b) = (d.operand("a", wide), d.operand("b", wide));
        let taken = d.operand("taken", Format::BIT);
        let sum = d.add_modulo("a_and_b", a.q(), b.q(), None);
        let zero = d.constant("zero", 0.0, wide);
        let total = d.register("total", wide);
        let held = d.register("held", Format::BIT);
        held.takes(taken.q());
        total.takes(match by {
            By::Nothing => sum,
            By::Operand => d.choose("chosen", taken.q(), [zero, sum]),
            By::Sum => d.choose("chosen", sum.bit(39), [zero, sum]),
        });
        d.output("total_out", total.q());
        d.output("held_out", held.q());
        vec![step("sum", [total.load(), held.load()])]
    });
    let made = pipeline(&design, &options(Goal::Stages(1))).unwrap();
    made.pipeline.expect("a pipeline").clock_mhz
}

#[test]
fn what_a_reset_chooses_costs_the_select_time_and_the_value_none() {
    let sum = clock_of_a_sum(By::Nothing);
    assert_eq!(clock_of_a_sum(By::Operand), sum);
    assert!(clock_of_a_sum(By::Sum) < sum);
}

/// Three products, the first of them signed.
fn products() -> Design {
    design(|d| {
        let a = d.operand("a", Format::signed(11, 0)).q();
        let b = d.operand("b", Format::unsigned(12, 0)).q();
        let signed = d.mul("with_sign", a, a);
        let square = d.mul("square", b, b);
        let y = d.register("y", square.format());
        let z = d.register("z", signed.format());
        y.takes(square);
        z.takes(signed);
        let upper = y.q().bits(12, Format::unsigned(12, 0));
        let again = d.mul("again", upper, b);
        d.output("y_out", again);
        d.output("z_out", z.q());
        vec![step("load", [y.load(), z.load()]), step("show", [])]
    })
}

#[test]
fn a_multiplier_serves_a_product_in_each_slot_and_no_more_than_are_needed() {
    let of = |interval: usize| {
        let interval = IntervalGoal::Clocks(interval);
        let options = Options { interval, ..options(Goal::ClockMhz(100.0)) };
        let made = pipeline(&products(), &options).unwrap_or_else(|wrong| panic!("{wrong}"));
        let mistakes = made.verify();
        assert!(mistakes.is_empty(), "{mistakes:?}");
        let multipliers =
            made.nets.iter().filter(|it| matches!(it.driver, Driver::Op(Op::Mul(..))));
        let units = made.pipeline.as_ref().expect("a pipeline").units.clone();
        (multipliers.count(), units)
    };
    assert_eq!(of(1).0, 3);
    assert!(of(1).1.is_empty());
    for (interval, multipliers) in [(2, 2), (3, 1)] {
        let (count, units) = of(interval);
        assert_eq!(count, multipliers, "{interval}");
        let served = units.iter().flat_map(|it| it.serves.iter().flatten()).count();
        assert_eq!(count + served, 3 + units.len());
    }
}

#[test]
fn an_interval_beyond_the_sequential_clocks_is_refused_with_the_most() {
    let made = |clocks| {
        let interval = IntervalGoal::Clocks(clocks);
        pipeline(&products(), &Options { interval, ..options(Goal::ClockMhz(100.0)) })
    };
    let error = made(64).expect_err("no interval");
    let PipelineErrorKind::Interval { most } = error.kind else { panic!("{error:?}") };
    assert!(made(most).is_ok() && made(most + 1).is_err());
}

#[test]
fn an_interval_is_the_longest_for_a_rate_and_the_shortest_for_multipliers() {
    let at = |goal, interval| {
        let made = pipeline(&products(), &Options { interval, ..options(goal) });
        made.map(|it| it.pipeline.expect("a pipeline").interval).map_err(|error| error.kind)
    };
    let at_100 = |interval| at(Goal::ClockMhz(100.0), interval);
    // The sequential core takes five clocks, including the clock of the write; there are three products.
    for (rate, interval) in [(100.0, 1), (50.1, 1), (50.0, 2), (34.0, 2), (33.3, 3), (0.1, 5)] {
        assert_eq!(at_100(IntervalGoal::Rate(rate)), Ok(interval), "{rate}");
    }
    for (most, interval) in [(1, 3), (2, 2), (3, 1), (9, 1)] {
        assert_eq!(at_100(IntervalGoal::Multipliers(most)), Ok(interval), "{most}");
    }
    let refused = [
        (at_100(IntervalGoal::Rate(100.1)), PipelineErrorKind::Rate { most: 100.0 }),
        (at_100(IntervalGoal::Multipliers(0)), PipelineErrorKind::Multipliers { fewest: 1 }),
        (at(Goal::Stages(4), IntervalGoal::Rate(1.0)), PipelineErrorKind::RateWithoutClock),
    ];
    for (refused, kind) in refused {
        assert_eq!(refused, Err(kind));
    }
}
