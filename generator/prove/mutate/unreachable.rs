//! Finds faults that the default test cannot notice because its stimulus never exercises them: stuck bits of registers, and
//! faults in ROM words.

use anyhow::Result;

use super::coverage::Coverage;
use super::fault::{BitChange, NetlistFault, Site};
use glint_core::core::{Core, TEST_POINTS, TEST_SEED};
use glint_rtl::netlist::NetId;
use glint_rtl::sim::Simulator;

/// Records, for each bit of some nets, whether a test had it at 0 and at 1.
struct BitWatch<'a> {
    nets: &'a [NetId],
    /// The bits of each net that were 0, and the bits that were 1.
    seen: Vec<[u64; 2]>,
}

impl BitWatch<'_> {
    fn note(&mut self, _: u64, simulator: &Simulator) {
        for (&net, [zero, one]) in self.nets.iter().zip(&mut self.seen) {
            let bits = simulator.value(net);
            *zero |= !bits;
            *one |= bits;
        }
    }
}

/// Returns the faults that the default test never exercises. For example, a register bit is stuck at the value that it always
/// has in the test, or the test never reads a ROM word.
///
/// # Errors
/// Fails if the design cannot be simulated.
pub fn unreached<'f>(core: &Core, faults: &[&'f NetlistFault]) -> Result<Vec<&'f NetlistFault>> {
    let lockstep = core.lockstep(TEST_SEED)?;
    // Only the outputs of registers are watched, after each clock edge.
    let nets: Vec<NetId> = core.design.registers.iter().map(|register| register.q).collect();
    let streams = lockstep.watch(
        TEST_POINTS,
        |_| BitWatch { nets: &nets, seen: vec![[0; 2]; nets.len()] },
        BitWatch::note,
    )?;
    let reads_words = faults.iter().any(|fault| matches!(fault.site, Site::Words(..)));
    let coverage =
        if reads_words { Some(Coverage::of(&core.design, &lockstep, TEST_POINTS)?) } else { None };
    let mut unreached = Vec::new();
    for &fault in faults {
        let is_unreached = match (&fault.site, &coverage) {
            (Site::Bit(net, bit, BitChange::Stuck0), _) => !has_had(&nets, &streams, *net, 1, *bit),
            (Site::Bit(net, bit, BitChange::Stuck1), _) => !has_had(&nets, &streams, *net, 0, *bit),
            (Site::Words(rom, words), Some(coverage)) => {
                words.iter().all(|(word, _)| coverage.places(*rom, *word).is_empty())
            }
            _ => false,
        };
        if is_unreached {
            unreached.push(fault);
        }
    }
    Ok(unreached)
}

/// Returns whether a bit of `net` was `value` at some time in a stream, or true for a net that was not watched.
fn has_had(nets: &[NetId], streams: &[BitWatch], net: NetId, value: usize, bit: u32) -> bool {
    let Some(at) = nets.iter().position(|&other| other == net) else {
        return true;
    };
    streams.iter().any(|stream| stream.seen[at][value] >> bit & 1 == 1)
}
