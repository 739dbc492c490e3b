//! Finds the counters in a pipeline's Verilog: the slot counter, and the address counters of its delay memories.
//!
//! A counter is a register that a reset sets to a constant, and that returns to this constant after a fixed number of clocks,
//! at most 1024. The module executes the Verilog with constants in the counters, in the reset and in `out_ready`, and with
//! unknowns everywhere else. The constants decide in which clocks the pipeline takes a point, and which word each memory reads
//! and writes. For example, a memory that writes word 0, 1, 2, 0, … and reads each word just before it is overwritten delays
//! its input by three clocks.

use std::collections::{BTreeMap, HashMap};

use anyhow::{Context, Result, ensure};

use super::module::{Memory, Module, Read};
use super::term::{VectorTermId, VectorTerms};
use glint_base::fixed::mask;
use glint_rtl::netlist::Role;

/// The longest period of a counter that the module recognises, in clocks.
const LONGEST_PERIOD: usize = 1024;

pub type Roles = HashMap<String, Role>;

/// The values of some registers. The keys are the numbers of the registers; a `BTreeMap` has them in the same order in every run.
type RegisterValues = BTreeMap<usize, u64>;

/// A pipeline's counters, in clocks in which all points move.
pub struct Counters {
    /// The values of the registers that count the slots, for each slot. An interval of 1 needs no such registers, so the map is
    /// empty.
    pub slots: Vec<RegisterValues>,
    /// For each memory, read port and slot, the number of clocks from a write to the read, if it is fixed.
    delays: Vec<Vec<Vec<Option<usize>>>>,
}

struct MemoryClock {
    /// The address at which all bits of a word are written; `None` if nothing is written.
    write: Option<u64>,
    /// The address of each read port, if it is known.
    reads: Vec<Option<u64>>,
}

struct ClockConstants {
    /// The registers that are constant after the clock, with their values.
    registers: RegisterValues,
    /// The accesses to each memory; `None` if it is not known which word is written.
    memories: Vec<Option<MemoryClock>>,
    /// The value of `in_ready`; `None` if it is not constant.
    ready: Option<u64>,
}

impl Counters {
    /// Finds the counters of `module`.
    ///
    /// # Errors
    ///
    /// Fails if the interval is longer than 1 and no counter decides the clocks in which the pipeline takes a point. Fails if a
    /// memory delays its words by no fixed number of clocks, or if the module has an unknown cell.
    pub fn new(module: &Module, roles: &Roles, interval: usize) -> Result<Self> {
        let reset = constants(module, roles, 0, &RegisterValues::new())?.registers;
        let slots = slots(module, roles, &reset, interval)?;
        let mut delays = vec![None; module.memories.len()];
        let is_slot = |register: &usize| slots[0].contains_key(register);
        let addresses = reset.iter().filter(|&(register, _)| !is_slot(register)).map(Some);
        // The slot counter alone may address a memory, too.
        for counter in addresses.chain([None]) {
            let Some(course) = course(module, roles, &slots, counter)? else { continue };
            for (at, memory) in module.memories.iter().enumerate() {
                let clocks: Option<Vec<&MemoryClock>> =
                    course.iter().map(|clock| clock.memories[at].as_ref()).collect();
                let Some(clocks) = clocks else { continue };
                let found = lags(&clocks, memory.reads.len(), interval);
                let is_delay = found.iter().all(|slots| slots.iter().any(Option::is_some));
                if delays[at].is_none() && is_delay {
                    delays[at] = Some(found);
                }
            }
        }
        let delays: Option<Vec<_>> = delays.into_iter().collect();
        let delays = delays.context(
            "a memory of the emitted Verilog does not delay by a fixed number of clocks",
        )?;
        Ok(Self { slots, delays })
    }

    /// Returns the number of clocks from a write to the read of the same word, or `None` if the number is not fixed. The read is
    /// `clock` clocks after a point entered.
    pub fn delay(&self, read: Read, clock: usize) -> Option<usize> {
        self.delays[read.memory][read.port][clock % self.slots.len()]
    }

    /// Returns the longest delay of each read port of each memory, in clocks.
    pub fn longest_delays(&self) -> Vec<usize> {
        let mut longest = Vec::new();
        for of_slots in self.delays.iter().flatten() {
            longest.push(of_slots.iter().flatten().copied().max().unwrap_or(0));
        }
        longest
    }
}

/// Returns the values of the registers that count the slots, for each slot. `reset` has the registers that are constant after
/// a reset. For an interval above 1, these registers must make `in_ready` 1 in slot 0 and 0 in all other slots.
fn slots(
    module: &Module,
    roles: &Roles,
    reset: &RegisterValues,
    interval: usize,
) -> Result<Vec<RegisterValues>> {
    let mut slots = vec![RegisterValues::new(); interval];
    if interval == 1 {
        return Ok(slots);
    }
    for (&register, &first) in reset {
        let mut values = vec![first];
        while values.len() <= interval {
            let known = RegisterValues::from([(register, values[values.len() - 1])]);
            let next = constants(module, roles, 1, &known)?;
            let Some(&value) = next.registers.get(&register) else { break };
            values.push(value);
        }
        // A counter of the slots has its first value again after the interval, and never before.
        let again = values.iter().skip(1).position(|&value| value == first);
        if again == Some(interval - 1) {
            for (slot, value) in slots.iter_mut().zip(values) {
                slot.insert(register, value);
            }
        }
    }
    for (slot, known) in slots.iter().enumerate() {
        let ready = constants(module, roles, 1, known)?.ready;
        ensure!(
            ready == Some(u64::from(slot == 0)),
            "no counter of the emitted Verilog determines that `in_ready` is 1 every {interval} clocks"
        );
    }
    Ok(slots)
}

/// Returns each clock's constants, until the slot counter and `counter` have their first values again. `counter` is a register
/// with its value after a reset. Returns `None` if it has no constant value in a clock, or if this takes more than 1024 clocks.
fn course(
    module: &Module,
    roles: &Roles,
    slots: &[RegisterValues],
    counter: Option<(&usize, &u64)>,
) -> Result<Option<Vec<ClockConstants>>> {
    let mut course = Vec::new();
    let mut value = counter.map(|(_, &first)| first);
    while course.len() < LONGEST_PERIOD {
        let mut known = slots[course.len() % slots.len()].clone();
        if let (Some((&register, _)), Some(value)) = (counter, value) {
            known.insert(register, value);
        }
        let clock = constants(module, roles, 1, &known)?;
        if let Some((register, _)) = counter {
            let Some(&next) = clock.registers.get(register) else { return Ok(None) };
            value = Some(next);
        }
        course.push(clock);
        let is_first = value == counter.map(|(_, &first)| first);
        if is_first && course.len().is_multiple_of(slots.len()) {
            return Ok(Some(course));
        }
    }
    Ok(None)
}

/// Returns the number of clocks from the latest write of a word to its read, for each read port and each slot. `course` is a
/// period of accesses, which repeats. A number is `None` if it varies between the slot's clocks, if the address is unknown, or if
/// nothing writes there. For example, with one slot, write addresses 0, 1, 2, 3 and read addresses 2, 3, 0, 1 give 2 clocks.
fn lags(course: &[&MemoryClock], reads: usize, interval: usize) -> Vec<Vec<Option<usize>>> {
    let period = course.len();
    let lag = |read: usize, now: usize| {
        let address = course[now].reads[read]?;
        (1..=period).find(|lag| course[(now + period - lag) % period].write == Some(address))
    };
    let mut lags = Vec::new();
    for read in 0..reads {
        let mut of_slots = Vec::new();
        for slot in 0..interval {
            let first = lag(read, slot);
            let mut clocks = (slot..period).step_by(interval);
            let is_fixed = clocks.all(|now| lag(read, now) == first);
            of_slots.push(first.filter(|_| is_fixed));
        }
        lags.push(of_slots);
    }
    lags
}

/// Returns a clock's constants. The clock is a reset if `rst_n` is 0, and otherwise the environment takes results. `known` are
/// the values of some registers before the clock; everything else is unknown.
fn constants(
    module: &Module,
    roles: &Roles,
    rst_n: u64,
    known: &RegisterValues,
) -> Result<ClockConstants> {
    let mut terms = VectorTerms::default();
    let mut held = module.power_up(&mut terms);
    for (&at, &bits) in known {
        held[at] = vec![terms.constant(bits, terms.width(held[at][0]))];
    }
    let input = |terms: &mut VectorTerms, name: &str, width: u32| match roles.get(name) {
        Some(Role::Reset) => terms.constant(rst_n, width),
        Some(Role::OutReady) if rst_n == 1 => terms.constant(1, width),
        _ => terms.unknown(width),
    };
    let any = |terms: &mut VectorTerms, read: Read| module.memories[read.memory].any(terms);
    let values = module.settle(&mut terms, &held, input, any)?;
    let mut registers = RegisterValues::new();
    for (at, columns) in module.edge(&mut terms, &values).iter().enumerate() {
        if let [column] = columns[..]
            && let Some(bits) = terms.constant_of(column)
        {
            registers.insert(at, bits);
        }
    }
    let mut memories = Vec::new();
    for memory in &module.memories {
        let ports = memory.control(&mut terms, &values);
        memories.push(accesses(&terms, memory, &ports));
    }
    let shown = module.shown(&mut terms, &values);
    let ready = shown.iter().find(|(name, _)| roles.get(*name) == Some(&Role::InReady));
    let ready = ready.and_then(|(_, &id)| terms.constant_of(id));
    Ok(ClockConstants { registers, memories, ready })
}

/// Returns the accesses to a memory. `ports` are the terms of [`Memory::control`]. Returns `None` if a write's address is
/// unknown, or if only some bits of a word are written.
fn accesses(terms: &VectorTerms, memory: &Memory, ports: &[VectorTermId]) -> Option<MemoryClock> {
    let (addresses, enables) = ports.split_at(1 + memory.reads.len());
    let all_are = |wanted: fn(u32) -> u64| {
        enables.iter().all(|&id| terms.constant_of(id) == Some(wanted(terms.width(id))))
    };
    let write = if all_are(|_| 0) {
        None
    } else if all_are(mask) {
        Some(terms.constant_of(addresses[0])?)
    } else {
        return None;
    };
    let reads = addresses[1..].iter().map(|&id| terms.constant_of(id)).collect();
    Some(MemoryClock { write, reads })
}
