//! Adds registers behind outputs that are combinational logic, on request by [`Designer::register_outputs`]. A result comes one
//! clock later.

use super::program::{MicroprogramSource, SettingKind, Step};
use super::{Designer, StepSetting, hold, step, valid};
use crate::netlist::{Design, Driver, FieldKind, NetId, Op, RegisterKind, Role};
use glint_base::codes;
use glint_base::diagnostic::Diagnostic;

/// Inserts the registers and the microinstructions. Nothing changes if every result is already a register.
pub(super) fn insert(d: &Designer, program: &mut MicroprogramSource) {
    let results = d.with(|inner| logic(&inner.design));
    if results.is_empty() {
        return;
    }
    let follows = d.with(|inner| inner.valid);
    let (kind, load) = match follows {
        Some(_) => (RegisterKind::Internal, None),
        None => {
            let field = d.add_field("outputs_load", 1, FieldKind::Enable);
            (RegisterKind::Architectural, Some(field))
        }
    };
    for port in results {
        behind(d, port, kind, load.map(|field| d.field_net(field).id()));
    }
    let note = match load {
        Some(field) => {
            let load = StepSetting::field(d, field, 1, "outputs.load".to_owned());
            loaded(d, &mut program.steps, &load);
            "Writes while busy are ignored. The outputs are registers. They keep their values from valid until \
             the next computation has its results."
        }
        None => {
            d.with(|inner| inner.valid = follows.map(|(signal, clocks)| (signal, clocks + 1)));
            followed(&mut program.steps);
            "Writes while busy are ignored. The outputs are registers, one clock behind the datapath."
        }
    };
    d.replace_note(note);
}

/// Returns the result ports that no register drives directly.
fn logic(design: &Design) -> Vec<NetId> {
    let results = design.ports.iter().filter(|port| port.role == Role::Result);
    let is_register =
        |port: NetId| matches!(design.net(design.renamed(port)).driver, Driver::Register(_));
    results.map(|port| port.net).filter(|&port| !is_register(port)).collect()
}

/// Inserts the register `<port>_reg` between a port and its driver. Without `enable`, the register loads on every clock.
fn behind(d: &Designer, port: NetId, kind: RegisterKind, enable: Option<NetId>) {
    let net = d.net(port);
    let Driver::Op(Op::Relabel(source)) = net.driver else {
        unreachable!("an output port names what it shows")
    };
    // The register is 0 from power-up to its first load.
    let range = (net.range.0.min(0), net.range.1.max(0));
    let q = d.located(net.location, || {
        d.add_register(&format!("{}_reg", net.name), net.format, range, kind)
    });
    d.set_doc(q, "output register");
    d.connect(q, source, enable);
    d.with(|inner| {
        let shown = &mut inner.design.nets[port.index()];
        shown.driver = Driver::Op(Op::Relabel(q));
        shown.range = range;
    });
}

/// Makes every microinstruction that raises `valid` load the registers by `load` instead, and inserts one behind it that raises
/// `valid`. Reports a mistake if such a microinstruction has a loop or a jump.
fn loaded(d: &Designer, steps: &mut Vec<Step>, load: &StepSetting) {
    let mut at = 0;
    while at < steps.len() {
        if steps[at].sets(|kind| matches!(kind, SettingKind::Valid)) {
            let decides = |kind: &SettingKind| {
                matches!(kind, SettingKind::LoopWhile { .. } | SettingKind::Dispatch { .. })
            };
            if steps[at].sets(decides) {
                let message = format!(
                    "microinstruction `{}` sets `valid` and decides on a condition, so there is no clock in \
                     which output registers can load the results: let another microinstruction decide",
                    steps[at].name
                );
                d.report(Diagnostic::new(codes::OUTPUT_REGISTER, message, steps[at].location));
                return;
            }
            let after = steps[at].divided();
            steps[at].settings.push(load.clone());
            steps.insert(at + 1, after.with(valid()));
            at += 1;
        }
        at += 1;
    }
}

/// Appends a microinstruction, so that the device is busy while the last result passes the registers.
fn followed(steps: &mut Vec<Step>) {
    let after = steps.last_mut().map(Step::divided);
    steps.extend(after);
}

impl Step {
    fn sets(&self, kind: impl Fn(&SettingKind) -> bool) -> bool {
        self.settings.iter().any(|setting| kind(&setting.kind))
    }

    fn with(mut self, setting: StepSetting) -> Self {
        self.settings.push(setting);
        self
    }

    /// Moves the settings that determine the next microinstruction into a new microinstruction, and returns the new one, which
    /// keeps the selections. Drops `valid`.
    fn divided(&mut self) -> Self {
        // With `hold`, a microinstruction behind the new one may hold the selections too.
        let mut after = step(&format!("{}, in output registers", self.name), [hold()]);
        after.location = self.location;
        for setting in std::mem::take(&mut self.settings) {
            match setting.kind {
                SettingKind::Valid => {}
                SettingKind::Next | SettingKind::WaitForStart | SettingKind::End => {
                    after.settings.push(setting);
                }
                _ => self.settings.push(setting),
            }
        }
        after
    }
}
