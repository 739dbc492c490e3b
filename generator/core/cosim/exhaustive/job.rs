//! Runs an exhaustive check as a job that can be interrupted, resumed, and divided among machines.
//!
//! The check is divided into numbered blocks, and the blocks are divided among shards: shard i of N has every N-th block,
//! beginning with block i − 1. For example, shard 2 of 4 has the blocks 1, 5, 9 and so on. A [`ShardState`] records the
//! progress of a shard, as a few numbers in a file. [`Job::merge`] joins the states of all shards to exactly the result of one
//! uninterrupted run, because the largest error does not depend on the order of the blocks.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::ControlFlow;
use std::str::FromStr;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use super::clocks::{Clocks, Steps};
use super::places::{BLOCK, Peak, Places};
use glint_base::text::grouped;
use glint_golden::{Contract, Sweep};

/// A larger number is probably a typing error.
pub const MOST_SHARDS: u64 = 1_000_000;

/// The largest number of missing shards that an error message names.
const NAMED: usize = 10;

/// The number of blocks for each thread between two calls of `look` in [`Job::run`]. These blocks take some tenths of a second.
const CHUNK: u64 = 4;

/// One part of a job that is divided among machines. For example, `2/4` is the second of four shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// The number of this shard, from 1.
    pub number: u64,
    /// The number of shards of the job.
    pub of: u64,
}

impl Shard {
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    fn is_valid(self) -> bool {
        (1..=MOST_SHARDS).contains(&self.of) && (1..=self.of).contains(&self.number)
    }

    /// Returns the number of the shard's blocks. For example, shard 1 of 4 has 3 of 10 blocks.
    fn count(self, blocks: u64) -> u64 {
        (blocks + self.of - self.number) / self.of
    }

    /// Returns the number, among all blocks, of the shard's own block `at`. Both numbers are counted from 0.
    fn block(self, at: u64) -> u64 {
        self.number - 1 + at * self.of
    }

    /// Returns the next blocks to check after the first `done` of the shard's `count` blocks, and how many are done
    /// afterwards.
    fn chunk(self, done: u64, count: u64) -> (u64, Vec<u64>) {
        let end = (done + CHUNK * rayon::current_num_threads() as u64).min(count);
        (end, (done..end).map(|at| self.block(at)).collect())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let numbers = parts.and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if (Self { number, of }).is_valid() => Ok(Self { number, of }),
            _ => Err(format!(
                "expected a shard i/N, for example 3/16, with i from 1 to N, and N at most {}",
                grouped(MOST_SHARDS)
            )),
        }
    }
}

/// Returns the number of places in the blocks of a shard after its first `done` blocks. The function does not visit the blocks,
/// because a sweep of 2^48 combinations has 2^31 blocks.
fn places_remaining(places: &Places<'_>, shard: Shard, done: u64) -> u64 {
    let blocks = places.blocks();
    let count = shard.count(blocks);
    let left = count.saturating_sub(done);
    // The last block of all may be shorter than the others.
    let has_last = left > 0 && shard.block(count - 1) == blocks - 1;
    let missing = if has_last { BLOCK - 1 - (places.count() - 1) % BLOCK } else { 0 };
    let all = u128::from(left) * u128::from(BLOCK) - u128::from(missing);
    u64::try_from(all).unwrap_or(u64::MAX)
}

/// The progress of a shard in the errors of `f`, or of the products with colours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// The number of finished blocks, which are the first blocks of the shard.
    pub done: u64,
    pub peak: Peak,
}

/// The progress of a shard, which is one machine's part of a job, in all parts of the check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardState {
    /// A digest of the configuration and of the checking code: [`crate::core::Core::fingerprint`].
    pub digest: String,
    pub shard: Shard,
    /// The errors of `f`.
    pub f: Progress,
    /// The products of every word `f` with every colour.
    pub colours: Progress,
    /// The comparison of model and hardware clock by clock.
    pub clocks: Steps,
}

impl ShardState {
    /// Makes the state of a shard that has checked nothing. `digest` is [`crate::core::Core::fingerprint`].
    pub fn new(digest: &str, shard: Shard) -> Self {
        let nothing = Progress { done: 0, peak: Peak::NONE };
        Self {
            digest: digest.to_owned(),
            shard,
            f: nothing,
            colours: nothing,
            clocks: Steps::default(),
        }
    }
}

pub struct Job<'a> {
    /// The operand combinations at which the errors of `f` are measured, or of the outputs of a device that is no highlight.
    pub f: Places<'a>,
    /// The combinations of a word `f` with a colour, at which the rounding errors of products are measured.
    pub colours: Places<'a>,
    /// The comparison of model and hardware clock by clock, if the job has one.
    pub clocks: Option<Clocks<'a>>,
}

impl<'a> Job<'a> {
    /// Makes the check of a contract's error bound, for the contract's own sweep. [`Job::with`] adds the comparison clock by
    /// clock.
    pub fn new(contract: &'a dyn Contract) -> Self {
        Self::of_sweep(contract, contract.sweep())
    }

    pub fn of_sweep(contract: &'a dyn Contract, sweep: Sweep) -> Self {
        let (f, colours) = (Places::of_sweep(contract, sweep), Places::of_colours(contract));
        Self { f, colours, clocks: None }
    }

    /// Names the number of evaluations, for example "1 000 evaluations of f and 500 colour products". For a device without
    /// colours it is "1 000 evaluations of the outputs".
    pub fn words(&self) -> String {
        let places = grouped(self.f.count());
        match self.colours.count() {
            0 => format!("{places} evaluations of the outputs"),
            colours => {
                format!("{places} evaluations of f and {} colour products", grouped(colours))
            }
        }
    }

    /// Adds the comparison of model and hardware clock by clock, which is empty if there are too many combinations.
    #[must_use]
    pub fn with(mut self, clocks: Clocks<'a>) -> Self {
        self.clocks = Some(clocks);
        self
    }

    fn blocks_of_clocks(&self) -> u64 {
        self.clocks.as_ref().map_or(0, Clocks::blocks)
    }

    /// Returns the number of combinations that the shard has still to visit.
    pub fn remaining(&self, state: &ShardState) -> u64 {
        self.parts_remaining(state).into_iter().fold(0, u64::saturating_add)
    }

    /// Returns the numbers of combinations to visit for `f`, for the colours, and clock by clock.
    fn parts_remaining(&self, state: &ShardState) -> [u64; 3] {
        let f = places_remaining(&self.f, state.shard, state.f.done);
        let colours = places_remaining(&self.colours, state.shard, state.colours.done);
        let left = |done: u64, blocks: u64| {
            let count = state.shard.count(blocks);
            (done.min(count)..count).map(|at| state.shard.block(at))
        };
        let clocks = match &self.clocks {
            Some(clocks) => clocks.visits(left(state.clocks.done, clocks.blocks())),
            None => 0,
        };
        [f, colours, clocks]
    }

    /// Checks that a state from a file can be a state of this job. The numbers must be in range, and the recorded largest
    /// errors must be in blocks that are done. Computed again at the recorded operands, these errors must be the recorded
    /// ones.
    ///
    /// # Errors
    /// Fails if any of these conditions is violated.
    pub fn validate(&self, state: &ShardState) -> Result<()> {
        let shard = state.shard;
        ensure!(shard.is_valid(), "there is no shard {shard}");
        for (what, places, progress) in
            [("f", &self.f, state.f), ("the colours", &self.colours, state.colours)]
        {
            let count = shard.count(places.blocks());
            let Progress { done, peak } = progress;
            ensure!(
                done <= count,
                "for {what}, the file says that {done} blocks are done, but there are only {count} blocks"
            );
            if done == 0 {
                ensure!(
                    peak == Peak::NONE,
                    "for {what}, no block is done, but the file has a largest error"
                );
                continue;
            }
            ensure!(
                peak.place < places.count(),
                "for {what}, the largest error is at place {}, but there are only {} places",
                peak.place,
                places.count()
            );
            let block = Places::block_of(peak.place);
            ensure!(
                block % shard.of == shard.number - 1 && block / shard.of < done,
                "for {what}, the largest error is at place {}, which the shard has not done",
                peak.place
            );
            ensure!(
                places.error(peak.place) == peak.error,
                "for {what}, the error at place {} is {:e}, but the file has {:e}",
                peak.place,
                places.error(peak.place),
                peak.error
            );
        }
        let count = shard.count(self.blocks_of_clocks());
        let Steps { done, differs } = state.clocks;
        ensure!(
            done <= count,
            "for the combinations, the file says that {done} blocks are done, but there are only {count} \
             blocks"
        );
        let combinations = self.clocks.as_ref().map_or(0, Clocks::count);
        ensure!(
            differs.is_none_or(|place| place < combinations && done == count),
            "for the combinations, the file names a difference at a combination that was not run"
        );
        Ok(())
    }

    /// Estimates the time of the shard's remaining work on `threads` threads from a short sample of each part.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, or if its signals do not settle in a clock.
    pub fn estimate(&self, state: &ShardState, threads: usize) -> Result<Duration> {
        let [f, colours, clocks] = self.parts_remaining(state);
        let mut sum = 0.0;
        for (count, places) in [(f, &self.f), (colours, &self.colours)] {
            if count > 0 {
                sum += count as f64 * places.pace().as_secs_f64();
            }
        }
        if let Some(own) = &self.clocks
            && clocks > 0
        {
            sum += clocks as f64 * own.pace()?.as_secs_f64();
        }
        Ok(Duration::from_secs_f64(sum / threads.max(1) as f64))
    }

    /// Checks the remaining blocks of the shard in `state`, and updates `state`. After every few blocks, the function calls
    /// `look` with the state, and returns `ControlFlow::Break` if `look` does. Calls `progress` with the number of
    /// combinations in each finished block. The comparison clock by clock ends at its first difference.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, if its signals do not settle in a clock, or if the golden model of a pipeline
    /// does not finish a computation.
    pub fn run(
        &self,
        state: &mut ShardState,
        progress: &(dyn Fn(u64) + Sync),
        look: &mut dyn FnMut(&ShardState) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>> {
        let shard = state.shard;
        for part in [JobPart::F, JobPart::Colours] {
            let places = part.places(self);
            let count = shard.count(places.blocks());
            while part.progress(state).done < count {
                let own = part.progress(state);
                let (end, blocks) = shard.chunk(own.done, count);
                own.peak = own.peak.join(places.check(blocks, progress));
                own.done = end;
                if look(state).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        let count = shard.count(self.blocks_of_clocks());
        while let Some(clocks) = &self.clocks
            && state.clocks.done < count
        {
            let (end, blocks) = shard.chunk(state.clocks.done, count);
            state.clocks.differs = clocks.check(blocks, progress)?;
            state.clocks.done = match state.clocks.differs {
                Some(_) => count,
                None => end,
            };
            if look(state).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Merges the results of all shards of one job into the state of an undivided job. Error messages use `names`, which has a
    /// name for each of the `states`.
    ///
    /// # Errors
    /// Fails if `states` is empty, if the shards belong to different jobs or divisions, or if a shard is missing, duplicated,
    /// damaged or not done.
    pub fn merge(&self, states: &[ShardState], names: &[String]) -> Result<ShardState> {
        let Some(first) = states.first() else {
            anyhow::bail!("there are no shards to merge");
        };
        let of = first.shard.of;
        let mut merged = ShardState::new(&first.digest, Shard::WHOLE);
        let mut seen: BTreeMap<u64, &String> = BTreeMap::new();
        for (state, name) in states.iter().zip(names) {
            ensure!(
                state.digest == first.digest,
                "`{name}` does not belong to the same configuration and build of Glint as `{}`",
                names[0]
            );
            ensure!(
                state.shard.of == of,
                "`{name}` is shard {}, and `{}` is shard {}: the numbers of shards differ",
                state.shard,
                names[0],
                first.shard
            );
            self.validate(state).with_context(|| format!("`{name}` is damaged"))?;
            ensure!(
                self.remaining(state) == 0,
                "`{name}` is not complete; continue with --shard {} --resume {name}",
                state.shard
            );
            if let Some(other) = seen.insert(state.shard.number, name) {
                anyhow::bail!("`{other}` and `{name}` are both shard {}", state.shard);
            }
            merged.f.peak = merged.f.peak.join(state.f.peak);
            merged.colours.peak = merged.colours.peak.join(state.colours.peak);
            let differ = merged.clocks.differs.into_iter().chain(state.clocks.differs);
            merged.clocks.differs = differ.min();
        }
        let missing = of - seen.len() as u64;
        if missing > 0 {
            let absent = (1..=of).filter(|number| !seen.contains_key(number)).take(NAMED);
            let named: Vec<String> =
                absent.map(|number| Shard { number, of }.to_string()).collect();
            let more = match missing.saturating_sub(NAMED as u64) {
                0 => String::new(),
                more => format!(" and {} more", grouped(more)),
            };
            anyhow::bail!("missing: shard {}{more}", named.join(", "));
        }
        merged.f.done = self.f.blocks();
        merged.colours.done = self.colours.blocks();
        merged.clocks.done = self.blocks_of_clocks();
        Ok(merged)
    }
}

#[derive(Clone, Copy)]
enum JobPart {
    F,
    Colours,
}

impl JobPart {
    fn places<'j, 'a>(self, job: &'j Job<'a>) -> &'j Places<'a> {
        match self {
            Self::F => &job.f,
            Self::Colours => &job.colours,
        }
    }

    fn progress(self, state: &mut ShardState) -> &mut Progress {
        match self {
            Self::F => &mut state.f,
            Self::Colours => &mut state.colours,
        }
    }
}
