//! Tests the numbering of operand combinations, the division into shards and the merging, on a contract whose errors are known.

use std::ops::ControlFlow;

use super::*;
use std::sync::LazyLock;

use glint_base::fixed::Format;
use glint_golden::{Axis, Bound, Bounds, Operand, Output, Sweep, Term, Values};

static OUTPUT: LazyLock<Output> =
    LazyLock::new(|| Output { name: "place".to_owned(), format: Format::unsigned(20, 1) });

/// A contract with one output, which is never computed. The contract's "error" is the number of the place, and its largest
/// value occurs at many places.
struct Counting;

impl Contract for Counting {
    fn operands(&self) -> &[Operand] {
        &[]
    }
    fn outputs(&self) -> &[Output] {
        std::slice::from_ref(&*OUTPUT)
    }
    fn results(&self, _: &[i64], _: u64, _: &mut Vec<i64>) {}
    fn exact(&self, _: &[i64], _: u64, _: &mut Vec<[f64; 2]>) {}
    fn bounds(&self) -> Bounds {
        let term = Term { key: "none", what: "everything", units: 1.0 };
        Bounds::alike(1.0, &Bound::of(vec![term]), self.outputs())
    }
    fn sweep(&self) -> Sweep {
        let axis = |values| Axis { name: String::new(), values };
        Sweep {
            axes: vec![
                axis(Values::List(vec![7, 3])),
                axis(Values::Range(-5, 149_994)),
                axis(Values::Range(0, 2)),
            ],
            omits: String::new(),
        }
    }
    fn sweep_error(&self, place: &[i64]) -> f64 {
        let major = if place[0] == 3 { 450_000 } else { 0 };
        ((major + (place[1] + 5) * 3 + place[2]) as f64).min(700_000.5)
    }
}

#[test]
fn places_are_numbered_last_axis_fastest() {
    let places = Places::of_f(&Counting);
    assert_eq!(places.count(), 900_000);
    assert_eq!(places.place(0), [7, -5, 0]);
    assert_eq!(places.place(4), [7, -4, 1]);
    assert_eq!(places.place(899_999), [3, 149_994, 2]);
    assert_eq!(places.error(451_234), 451_234.0);
}

/// Three operands of 16 bits have 2^48 combinations. Four have 2^64, which does not fit into 64 bits and must not become 0.
#[test]
fn many_combinations_are_counted_at_once() {
    for (operands, count) in [(3, 1 << 48), (4, u64::MAX), (5, u64::MAX)] {
        let axis = Axis { name: String::new(), values: Values::Range(-32_768, 32_767) };
        let sweep = Sweep { axes: vec![axis; operands], omits: String::new() };
        let job = Job::of_sweep(&Counting, sweep);
        assert_eq!(job.f.count(), count);
        assert_eq!(job.remaining(&ShardState::new("digest", Shard::WHOLE)), count);
        let half = ShardState::new("digest", Shard { number: 1, of: 2 });
        assert_eq!(job.remaining(&half), 1 << [47, 63][usize::from(operands > 3)]);
    }
}

#[test]
fn the_peak_is_the_first_of_the_largest_however_the_work_is_divided() {
    let places = Places::of_f(&Counting);
    let whole = places.check(0..places.blocks(), &|_| ());
    assert_eq!((whole.error, whole.place), (700_000.5, 700_001));
    let parts = (0..places.blocks())
        .rev()
        .map(|block| places.check(block..block + 1, &|_| ()))
        .reduce(Peak::join);
    assert_eq!(parts, Some(whole));
    assert_eq!(places.check(0..2, &|_| ()).error, f64::from(2 * (1 << 17) - 1));
}

#[test]
fn without_colours_there_are_no_products() {
    assert_eq!(Places::of_colours(&Counting).count(), 0);
}

fn completed(mut state: ShardState) -> ShardState {
    let end = Job::new(&Counting).run(&mut state, &|_| (), &mut |_| ControlFlow::Continue(()));
    assert_eq!(end.unwrap(), ControlFlow::Continue(()));
    state
}

fn whole() -> ShardState {
    completed(ShardState::new("digest", Shard::WHOLE))
}

#[test]
fn an_interrupted_run_ends_as_an_uninterrupted_one() {
    let job = Job::new(&Counting);
    let mut state = ShardState::new("digest", Shard { number: 2, of: 3 });
    assert_eq!(job.remaining(&state), 2 * (1 << 17));
    // Interrupted as soon as one block is done, and resumed from the text that a file would hold.
    let broken = job.run(&mut state, &|_| (), &mut |_| ControlFlow::Break(()));
    assert_eq!(broken.unwrap(), ControlFlow::Break(()));
    let text = serde_json::to_string(&state).unwrap();
    let state = completed(serde_json::from_str(&text).unwrap());
    assert_eq!(job.remaining(&state), 0);
    // The shard has blocks 1 and 4 of blocks 0 to 6. The largest error of block 4 is at its last place.
    assert_eq!(state.f.done, 2);
    assert_eq!(state.f.peak.error, f64::from(5 * (1 << 17) - 1));
}

#[test]
fn shards_join_to_the_whole() {
    let job = Job::new(&Counting);
    let shard = |number| completed(ShardState::new("digest", Shard { number, of: 3 }));
    let names: Vec<String> = ["c", "a", "b"].map(String::from).to_vec();
    let states = [shard(3), shard(1), shard(2)];
    assert_eq!(job.merge(&states, &names).unwrap(), whole());

    let refused = |states: &[ShardState]| job.merge(states, &names).unwrap_err().to_string();
    assert_eq!(refused(&states[..2]), "missing: shard 2/3");
    assert_eq!(refused(&[states[0].clone(), states[0].clone()]), "`c` and `a` are both shard 3/3");
    assert!(refused(&[states[0].clone(), whole()]).contains("the numbers of shards differ"));
    let mut other = states[1].clone();
    other.digest = "another".to_owned();
    assert!(
        refused(&[states[0].clone(), other]).contains("does not belong to the same configuration")
    );
    let nothing = ShardState::new("digest", Shard { number: 1, of: 3 });
    assert!(refused(&[nothing]).contains("`c` is not complete; continue with --shard 1/3"));
}

/// Tries states that a damaged disk or an attacker could have written.
#[test]
fn what_cannot_be_a_state_is_refused() {
    let job = Job::new(&Counting);
    let right = whole();
    job.validate(&right).unwrap();
    job.validate(&ShardState::new("digest", Shard { number: 3, of: 9 })).unwrap();
    type Change = fn(&mut ShardState);
    let changes: [(Change, &str); 9] = [
        (|state| state.f.done = 8, "8 blocks are done, but there are only 7"),
        (|state| state.f.done = 0, "no block is done, but the file"),
        (|state| state.f.peak = Peak::NONE, "the largest error is at place 18446744073709551615"),
        (|state| state.f.peak.place = 1_000_000_000_000_000, "there are only 900000 places"),
        (
            |state| state.f.peak.error = 1.0,
            "the error at place 700001 is 7.000005e5, but the file has 1e0",
        ),
        (|state| state.f.peak.place = 5, "the error at place 5 is 5e0"),
        (|state| state.clocks.done = 1, "1 blocks are done, but there are only 0"),
        (|state| state.clocks.differs = Some(0), "a combination that was not run"),
        (|state| state.shard.of = 1_000_000_000_000, "there is no shard 1/1000000000000"),
    ];
    for (change, message) in changes {
        let mut state = right.clone();
        change(&mut state);
        let refused = job.validate(&state).unwrap_err().to_string();
        assert!(refused.contains(message), "{refused}");
        let merged = job.merge(&[state], &["part".to_owned()]).unwrap_err();
        assert!(format!("{merged:#}").contains("`part` is damaged"), "{merged:#}");
    }
    // The largest error is in a block of another shard, or in a block that is not done.
    let mut state = ShardState::new("digest", Shard { number: 1, of: 2 });
    state.f = Progress { done: 1, peak: Peak { error: f64::from(1 << 17), place: 1 << 17 } };
    assert!(job.validate(&state).unwrap_err().to_string().contains("has not done"));
    state.f.peak.place = 2 << 17;
    assert!(job.validate(&state).unwrap_err().to_string().contains("has not done"));
}

#[test]
fn a_file_that_was_changed_is_no_state() {
    let text = kept::to_text(&whole()).unwrap();
    assert_eq!(kept::from_text(&text).unwrap(), whole());
    let changed = [
        text.replace("700001", "700002"),
        text.replace("\"done\": 7", "\"done\": 6"),
        text.replace("digest", "another"),
        text[..text.len() / 2].to_owned(),
        text.replace("\"shard\"", "\"more\": 1, \"shard\""),
        serde_json::to_string(&whole()).unwrap(),
    ];
    for changed in changed {
        assert_ne!(changed, text);
        assert!(kept::from_text(&changed).is_err(), "{changed}");
    }
}

#[test]
fn missing_shards_of_many_are_counted() {
    let job = Job::new(&Counting);
    let state = completed(ShardState::new("digest", Shard { number: 900_000, of: MOST_SHARDS }));
    let refused = job.merge(&[state], &["part".to_owned()]).unwrap_err().to_string();
    assert!(refused.starts_with("missing: shard 1/1000000, 2/1000000"), "{refused}");
    assert!(refused.ends_with("10/1000000 and 999 989 more"), "{refused}");
}

#[test]
fn a_shard_is_one_of_so_many() {
    assert_eq!("3/16".parse(), Ok(Shard { number: 3, of: 16 }));
    assert!(format!("1/{MOST_SHARDS}").parse::<Shard>().is_ok());
    let many = ["1/1000000000000", "1/18446744073709551615", "1/18446744073709551616"];
    for text in ["0/4", "5/4", "1", "a/b", "1/0", "-1/2"].iter().chain(&many) {
        assert!(text.parse::<Shard>().is_err(), "{text}");
    }
}

#[test]
fn errors_beyond_the_bound_are_failures() {
    let peak = |error| Peak { error, place: 0 };
    // The bound of `Counting` is 1.0 for f and 1.0 units in all.
    let failures = |f, colour| Proof::new(&Counting, peak(f), peak(colour)).failures.len();
    assert_eq!(failures(0.5, 0.5), 0);
    assert_eq!(failures(0.5, 0.6), 1);
    assert_eq!(failures(1.5, 0.0), 2);
}
