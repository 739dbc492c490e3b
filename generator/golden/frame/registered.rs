//! The same device with registers behind results that are logic (`output.registered`).

use super::clocked::{Fixed, HANDSHAKE, levels};
use super::{Clocked, Datapath, Microinstruction, Next, Slot, idle};

impl<D: Datapath> Clocked<D> {
    /// It at power-up. Results are taken in the microinstruction that was to set `valid`, and one more sets it. Where
    /// `valid` comes later than a microinstruction says, they are taken in every clock.
    ///
    /// None for a device that goes on by a condition from such a microinstruction.
    pub(super) fn with_output_registers(&self) -> Option<Self> {
        let it = &*self.fixed;
        if it.logic.is_empty() {
            return Some(self.clone());
        }
        let delayed = it.valid_delay > 0;
        let mut program = if delayed { later(&it.program) } else { taking(&it.program)? };
        if delayed {
            program.iter_mut().for_each(|it| it.takes_results = true);
        }
        let (mut shown, mut signals, mut taken) =
            (it.shown.clone(), it.signals.clone(), Vec::new());
        let mut slots = self.state.0.len();
        for &at in &it.logic {
            let (logic, mask) = shown[at];
            let register = Slot(slots);
            slots += 1;
            taken.push((logic, register));
            shown[at].0 = register;
            shown.push((register, mask));
            signals.push(format!("{}_reg", signals[HANDSHAKE.len() + at]));
        }
        let fixed = Fixed {
            levels: levels(&program, &it.flags),
            program,
            shown,
            taken,
            valid_delay: it.valid_delay + u32::from(delayed),
            signals,
            logic: Vec::new(),
            operands: it.operands.clone(),
            buffers: it.buffers.clone(),
            flags: it.flags.clone(),
            shows_flags: it.shows_flags,
            inputs: it.inputs.clone(),
        };
        Some(self.at_power_up(fixed, slots))
    }
}

/// The program with one microinstruction more at its end.
fn later<D>(program: &[Microinstruction<D>]) -> Vec<Microinstruction<D>> {
    let mut longer = program.to_vec();
    if let Some(last) = longer.last_mut() {
        last.next = Next::Following;
    }
    longer.push(idle().end());
    longer
}

/// The program with one microinstruction more after each that was to set `valid`.
fn taking<D>(program: &[Microinstruction<D>]) -> Option<Vec<Microinstruction<D>>> {
    let mut longer = Vec::new();
    for (at, here) in program.iter().enumerate() {
        let mut here = here.clone();
        if let Next::SkipIf(count, _) = &mut here.next {
            let skipped = program.iter().skip(at + 1).take(*count as usize);
            *count += skipped.filter(|it| it.valid).count() as u32;
        }
        if !here.valid {
            longer.push(here);
            continue;
        }
        if matches!(here.next, Next::RepeatWhile(_) | Next::SkipIf(..)) {
            return None;
        }
        let next = std::mem::replace(&mut here.next, Next::Following);
        longer.push(Microinstruction { valid: false, takes_results: true, ..here });
        longer.push(Microinstruction { next, ..idle().valid() });
    }
    Some(longer)
}
