//! Searches for operands at which a mutant of a pipeline (the pipeline with one fault) gives a wrong value.
//!
//! Some hardware exists in a pipeline but not in its sequential core, such as a split product's parts. A fault in this hardware
//! may show only if a carry runs through all bits that are later dropped, which random points rarely cause. The search keeps
//! points that make registers differ in the latest stage so far, and changes one operand of such a point at a time. A search
//! without a result proves nothing.

use std::sync::Arc;

use anyhow::{Context, Result};

use super::coverage::OperandValues;
use glint_base::fixed::mask;
use glint_core::cosim::Random;
use glint_golden::{Contract, Operand};
use glint_rtl::netlist::{Design, NetId, Pipeline, Role};
use glint_rtl::sim::{CompiledDesign, Machine};

/// The number of simulations side by side. In each clock, each simulation gets a point of its own.
const LANES: usize = 64;

const CLOCKS: usize = 1 << 16;

/// The number of calls of `confirm` without a confirmed point after which the search ends. The golden model predicts a checkpoint
/// only for points that execute its microinstruction, so some differences are not confirmed.
const TRIES: usize = 32;

/// The largest number of points that the search keeps for further changes.
const KEPT: usize = 32;

const SEED: u64 = 4;

/// A fault-free pipeline, prepared for a search for points at which mutants differ from it.
pub(super) struct PointSearch {
    sound: Arc<CompiledDesign>,
    /// `inputs` is the number of inputs. `high` has the indices of the inputs that are 1 after a clock of reset (reset,
    /// `in_valid`, `out_ready`), so points enter and leave whenever they can.
    inputs: usize,
    high: Vec<usize>,
    /// The contract's operands, each with the index of its input.
    operands: Vec<(usize, Operand)>,
    stages: Vec<StageNets>,
    interval: usize,
}

#[derive(Clone, Default)]
struct StageNets {
    registers: Vec<NetId>,
    predicted: Vec<NetId>,
}

type RawPoint = Vec<i64>;

impl PointSearch {
    /// Finds the ports of the operands, and the registers and checkpoints of each stage.
    ///
    /// # Errors
    /// Fails if the pipeline lacks an operand of the contract, or if it cannot be simulated.
    pub(super) fn new(
        sound: &Design,
        pipeline: &Pipeline,
        contract: &dyn Contract,
    ) -> Result<Self> {
        let place = |role: Role| sound.inputs().position(|port| port.role == role);
        let operands = contract.operands().iter().map(|operand| {
            let mut inputs = sound.inputs();
            let at = inputs.position(|port| sound.net(port.net).name == operand.name);
            Ok((
                at.with_context(|| format!("the design has no operand `{}`", operand.name))?,
                operand.clone(),
            ))
        });
        let mut stages = vec![StageNets::default(); pipeline.stages.len() + 1];
        for register in sound.registers.iter().filter(|it| !pipeline.handshake.contains(&it.q)) {
            stages[pipeline.clock_of(register.q)].registers.push(register.q);
        }
        for checkpoint in &pipeline.checkpoints {
            stages[pipeline.clock_of(checkpoint.net)].predicted.push(checkpoint.net);
        }
        let results = sound.outputs().filter(|port| port.role == Role::Result);
        stages[pipeline.stages.len()].predicted.extend(results.map(|port| port.net));
        Ok(Self {
            sound: Arc::new(CompiledDesign::new(sound)?),
            inputs: sound.inputs().count(),
            high: [Role::Reset, Role::InValid, Role::OutReady]
                .into_iter()
                .filter_map(place)
                .collect(),
            operands: operands.collect::<Result<_>>()?,
            stages,
            interval: pipeline.interval,
        })
    }

    /// Searches for a point at which `mutant` differs in a value that the golden model predicts, and calls `confirm` with the raw
    /// operands by name. Returns the first result of `confirm` that is not `None`. The search ends after 65 536 clocks, or if
    /// `confirm` returns `None` 32 times.
    ///
    /// # Errors
    ///
    /// Fails if `confirm` fails, or if the mutant cannot be simulated.
    pub(super) fn search<T>(
        &self,
        mutant: &Design,
        confirm: impl Fn(OperandValues) -> Result<Option<T>>,
    ) -> Result<Option<T>> {
        let mut sound = Machine::<LANES>::new(self.sound.clone());
        let mut mutant = Machine::<LANES>::new(Arc::new(CompiledDesign::new(mutant)?));
        let mut random = Random::new(SEED);
        let mut inputs = vec![[0; LANES]; self.inputs];
        let mut kept = DeepestPoints::default();
        let mut tries = 0;
        // The points in the pipeline, by the clock in which they entered it.
        let mut points = vec![vec![RawPoint::new(); LANES]; self.stages.len()];
        for machine in [&mut sound, &mut mutant] {
            machine.update(false, Some(&inputs));
            machine.update(true, None);
        }
        self.high.iter().for_each(|&at| inputs[at] = [1; LANES]);
        for clock in 0..CLOCKS {
            let taken = clock % self.interval == 0;
            let arriving = points[clock % self.stages.len()].iter_mut().enumerate();
            for (lane, point) in arriving.filter(|_| taken) {
                self.draw(&mut random, &kept, point);
                for ((at, operand), &raw) in self.operands.iter().zip(point.iter()) {
                    inputs[*at][lane] = raw as u64 & mask(operand.format.width());
                }
            }
            for machine in [&mut sound, &mut mutant] {
                machine.update(false, Some(&inputs));
            }
            let stages = self.stages.iter().enumerate().take(clock + 1);
            for (depth, stage) in stages.skip(clock % self.interval).step_by(self.interval) {
                let points = &points[(clock - depth) % self.stages.len()];
                for lane in differing(&sound, &mutant, &stage.registers) {
                    kept.keep(depth, &points[lane], &mut random);
                }
                for lane in differing(&sound, &mutant, &stage.predicted).take(1) {
                    let confirmed = confirm(self.named(&points[lane]))?;
                    tries += 1;
                    if confirmed.is_some() || tries == TRIES {
                        return Ok(confirmed);
                    }
                }
            }
            for machine in [&mut sound, &mut mutant] {
                machine.update(true, None);
            }
        }
        Ok(None)
    }

    fn draw(&self, random: &mut Random, kept: &DeepestPoints, point: &mut RawPoint) {
        let parent = kept.any(random).filter(|_| !random.once_in(4));
        point.clear();
        if let Some(parent) = parent {
            point.extend(parent);
            let at = random.below(point.len() as u64) as usize;
            let (_, operand) = &self.operands[at];
            point[at] = if random.once_in(2) {
                value(random, operand)
            } else {
                flipped(random, operand, point[at])
            };
        } else {
            point.extend(self.operands.iter().map(|(_, operand)| value(random, operand)));
        }
    }

    fn named(&self, point: &RawPoint) -> OperandValues {
        let pairs = self.operands.iter().zip(point);
        pairs.map(|((_, operand), &raw)| (operand.name.clone(), raw)).collect()
    }
}

/// Returns mostly a value of the operand's domain, sometimes a value with a single bit set, and sometimes any value of the
/// format.
fn value(random: &mut Random, operand: &Operand) -> i64 {
    let format = operand.format;
    match random.below(8) {
        0 => random.within(format.min_raw() as i64, format.max_raw() as i64),
        1 | 2 => flipped(random, operand, 0),
        _ => random.of_domain(operand.domain),
    }
}

/// Inverts a random bit of `raw`. For example, 0 in an unsigned format of 8 bits becomes a power of two up to 128.
fn flipped(random: &mut Random, Operand { format, .. }: &Operand, raw: i64) -> i64 {
    format.raw(raw as u64 ^ 1 << random.below(format.width().into())) as i64
}

fn differing<'m>(
    sound: &Machine<LANES>,
    mutant: &'m Machine<LANES>,
    nets: &[NetId],
) -> impl Iterator<Item = usize> + use<'m> {
    let expected: Vec<[u64; LANES]> = nets.iter().map(|&net| sound.lanes(net)).collect();
    let differences = mutant.differences(nets, &expected, None);
    (0..LANES).filter(move |&lane| differences[lane] != 0)
}

/// The points that make registers differ in the latest stage that a search has reached so far.
#[derive(Default)]
struct DeepestPoints {
    depth: usize,
    points: Vec<RawPoint>,
}

impl DeepestPoints {
    fn keep(&mut self, depth: usize, point: &RawPoint, random: &mut Random) {
        if depth < self.depth {
            return;
        }
        if depth > self.depth {
            (self.depth, self.points) = (depth, Vec::new());
        }
        if self.points.len() < KEPT {
            self.points.push(point.clone());
        } else if random.once_in(KEPT as u64) {
            let at = random.below(KEPT as u64) as usize;
            self.points[at].clone_from(point);
        }
    }

    fn any(&self, random: &mut Random) -> Option<&RawPoint> {
        let at = random.below(self.points.len().max(1) as u64);
        self.points.get(at as usize)
    }
}
