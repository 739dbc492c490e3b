//! Replays recorded inputs of a design clock by clock, again and again.

use std::sync::Arc;

#[derive(Debug)]
pub(super) struct Recording {
    words: Vec<u64>,
    inputs: usize,
}

impl Recording {
    /// Takes the bit patterns of the inputs in each clock: at least one clock, and the same number of inputs in all.
    pub(super) fn new(clocks: &[Vec<u64>]) -> Self {
        Self { words: clocks.concat(), inputs: clocks[0].len() }
    }
}

pub(super) struct RecordedInputs {
    recording: Arc<Recording>,
    /// The index in `words` at which the inputs of the next clock begin.
    next: usize,
}

impl RecordedInputs {
    pub(super) fn new(recording: &Arc<Recording>) -> Self {
        Self { recording: Arc::clone(recording), next: 0 }
    }

    #[inline]
    pub(super) fn next(&mut self) -> &[u64] {
        let Recording { words, inputs } = &*self.recording;
        let first = if self.next == words.len() { 0 } else { self.next };
        self.next = first + inputs;
        &words[first..self.next]
    }

    /// [`RecordedInputs::next`] must have been called.
    #[inline]
    pub(super) fn inputs(&self) -> &[u64] {
        &self.recording.words[self.next - self.recording.inputs..self.next]
    }
}

#[cfg(test)]
mod tests {
    use crate::core::Core;
    use crate::cosim::Lockstep;
    use crate::registry::Registry;
    use glint_config::{Config, Value};

    /// Each stream begins at power-up. When it begins again, the registers have the values that a computation left.
    #[test]
    fn replayed_inputs_show_what_drawn_ones_do() {
        ["sequential", "pipelined"].into_iter().for_each(replayed);
    }

    fn replayed(architecture: &str) {
        let registry = Registry::catalogue();
        let device = *registry.device("threshold").expect("a device");
        let config = |rounding: &str| {
            let keys = [("output.rounding", rounding), ("architecture", architecture)];
            let keys = keys.map(|(key, text)| (key.to_owned(), Value::Text(text.to_owned())));
            Config::from_values(&(device.schema)(), "device", keys.into()).expect("its keys")
        };
        let core = Core::new(device, config("nearest")).unwrap();
        // More streams than lanes.
        let streams: Vec<_> = (0..40).map(|seed| core.vectors(5, seed).unwrap().inputs).collect();
        let most = streams.iter().map(Vec::len).max().unwrap_or_default() as u64;
        let outcome = core.lockstep(1).unwrap().replay(&streams, 3 * most).unwrap();
        assert_eq!((outcome.mismatch, outcome.clocks), (None, 40 * 3 * most));
        assert!(outcome.points > 2 * 40 * 5, "{}", outcome.points);

        let other = device.open(config("truncate")).unwrap().golden();
        let lockstep = Lockstep::new(&core.design, other, core.contract.as_ref(), 1).unwrap();
        let mismatch =
            lockstep.replay(&streams, 3 * most).unwrap().mismatch.expect("another model");
        assert!(mismatch.signal.ends_with("_out"), "{mismatch}");

        let refused =
            |streams: &[Vec<Vec<u64>>]| lockstep.replay(streams, 1).unwrap_err().to_string();
        assert_eq!(refused(&[vec![]]), "recorded stream 0 has no clock");
        let (fewer, inputs) = (vec![vec![0; 3]], core.design.inputs().count());
        let message = format!("clock 0 of recorded stream 0 has 3 inputs, not {inputs}");
        assert_eq!(refused(&[fewer]), message);
    }
}
