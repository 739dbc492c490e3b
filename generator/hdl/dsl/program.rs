//! Defines microinstructions as lists of settings, and translates a microprogram to control words.

use std::collections::{BTreeSet, HashSet};
use std::panic::Location;

use super::sequencer::{Dispatches, SequenceFields, Sequencer};
use super::{Designer, Signal};
use crate::netlist::{
    Driver, FieldId, FieldKind, Microinstruction, NetId, Op, Partition, RegisterKind, Sequence,
};
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};

/// A setting of a microinstruction: the value of one field, or the choice of the next microinstruction.
#[derive(Clone)]
pub struct StepSetting {
    pub(super) kind: SettingKind,
    /// The designer to which the field or the condition belongs; `None` for a setting without field and condition.
    of: Option<DesignerIdentity>,
    location: SourceLocation,
}

/// The serial number of a designer, and the name of its design.
type DesignerIdentity = (u64, String);

fn origin(d: &Designer) -> DesignerIdentity {
    (d.serial, d.with(|inner| inner.design.name.clone()))
}

#[derive(Clone)]
pub(super) enum SettingKind {
    Field {
        field: FieldId,
        value: u64,
        what: String,
    },
    Hold,
    Valid,
    Next,
    WaitForStart,
    LoopWhile {
        condition: NetId,
        to: String,
    },
    Dispatch {
        selector: NetId,
        to: Vec<String>,
    },
    End,
    /// A setting whose mistake has already been reported.
    Wrong,
}

impl StepSetting {
    #[track_caller]
    pub(crate) fn field(d: &Designer, field: FieldId, value: u64, what: String) -> Self {
        let kind = SettingKind::Field { field, value, what };
        Self { of: Some(origin(d)), ..Self::sequence(kind) }
    }

    #[track_caller]
    fn sequence(kind: SettingKind) -> Self {
        Self { kind, of: None, location: Location::caller() }
    }

    /// Lets the mux named `mux` pass `input`: the value of `field` is the position of `input`. Reports a mistake unless `input`
    /// is exactly one input.
    #[track_caller]
    pub(crate) fn pick(d: &Designer, field: FieldId, mux: &str, input: Signal<'_>) -> Self {
        let inputs = match d.with(|inner| inner.design.find(mux)).map(|id| d.net(id).driver) {
            Some(Driver::Op(Op::Mux { inputs, .. })) => inputs,
            _ => Vec::new(),
        };
        // The net at an input may be an extended or renamed form of `input`.
        let stands_for = |id: NetId| {
            id == input.id()
                || matches!(d.net(id).driver,
                    Driver::Op(Op::Extend(a) | Op::Relabel(a) | Op::Slice { of: a, low: 0 }) if a == input.id())
        };
        let found: Vec<_> = (0..inputs.len()).filter(|&at| stands_for(inputs[at])).collect();
        Self::picked(d, field, mux, input, &found)
    }

    #[track_caller]
    pub(crate) fn pick_of(
        d: &Designer,
        field: FieldId,
        mux: &str,
        input: Signal<'_>,
        inputs: &[Signal<'_>],
    ) -> Self {
        let found: Vec<_> = (0..inputs.len()).filter(|&at| inputs[at].id() == input.id()).collect();
        Self::picked(d, field, mux, input, &found)
    }

    #[track_caller]
    fn picked(d: &Designer, field: FieldId, mux: &str, input: Signal<'_>, found: &[usize]) -> Self {
        if input.designer().serial != d.serial {
            let _ = d.own(input);
            return Self::sequence(SettingKind::Wrong);
        }
        let [at] = found else {
            let how = if found.is_empty() { "is not an input" } else { "is more than one input" };
            d.error(codes::PICK, format!("`{}` {how} of `{mux}`", input.name()));
            return Self::sequence(SettingKind::Wrong);
        };
        let what = format!("{mux}.pick({})", input.name());
        Self::field(d, field, *at as u64, what)
    }
}

/// Keeps all selections (values of select lines) of the previous microinstruction that this one does not state itself. In
/// microinstruction 0 this setting has no effect.
#[track_caller]
pub fn hold() -> StepSetting {
    StepSetting::sequence(SettingKind::Hold)
}

/// Raises `valid`, which means that the results are on the outputs. A microinstruction that loads a result register must not
/// raise `valid`, but the next one can. An exception is a microinstruction before which every path has loaded the register.
#[track_caller]
pub fn valid() -> StepSetting {
    StepSetting::sequence(SettingKind::Valid)
}

/// Continues at the next address. Without this setting, every microinstruction except number 0, which waits for `start`,
/// continues there.
#[track_caller]
pub fn next() -> StepSetting {
    StepSetting::sequence(SettingKind::Next)
}

/// Repeats this microinstruction until `start` is high; the device is not busy meanwhile. Microinstruction 0 always waits.
/// [`Designer::finish`] reports a mistake if another microinstruction has this setting and the operands have buffers.
#[track_caller]
pub fn wait_for_start() -> StepSetting {
    StepSetting::sequence(SettingKind::WaitForStart)
}

/// Jumps back to the microinstruction named `to` while the bit `condition` is 1. A microinstruction of the loop must be able to
/// change the condition, so that the loop ends.
#[track_caller]
pub fn loop_while(condition: Signal<'_>, to: &str) -> StepSetting {
    let kind = SettingKind::LoopWhile { condition: condition.id(), to: to.to_owned() };
    StepSetting { of: Some(origin(condition.designer())), ..StepSetting::sequence(kind) }
}

/// Jumps ahead to the microinstruction named `to` if the bit `condition` is 1, for example over a loop that may run zero times.
#[track_caller]
pub fn jump_if(condition: Signal<'_>, to: &str) -> StepSetting {
    // The sequencer treats a jump ahead like a jump back.
    loop_while(condition, to)
}

/// Jumps ahead to one of the microinstructions named in `to`: the bits of the operand `selector` are the index. For example, an
/// opcode selects whether a device adds or subtracts:
///
/// ```
/// use glint_base::fixed::Format;
/// use glint_rtl::dsl::{Designer, dispatch, end, step, valid};
///
/// let d = Designer::new("adder");
/// let opcode = d.operand("opcode", Format::BIT);
/// let [a, b] = ["a", "b"].map(|name| d.operand(name, Format::unsigned(8, 0)));
/// let sum = d.add("sum", a.q(), b.q());
/// let difference = d.sub("difference", a.q(), b.q());
/// let mux = d.mux("chosen", [sum, difference]);
/// let result = d.register("result", mux.out().format());
/// result.takes(mux.out());
/// d.output("result_out", result.q());
/// d.microprogram([
///     step("operands", [dispatch(opcode.q(), &["add", "subtract"])]),
///     step("add", [mux.pick(sum), result.load(), dispatch(opcode.q(), &["result", "result"])]),
///     step("subtract", [mux.pick(difference), result.load()]),
///     step("result", [valid(), end()]),
/// ]);
/// assert!(d.finish().is_ok());
/// ```
///
/// `selector` must be the output of an operand's register, and `to` must have a name for each value of its bits. All dispatches of
/// a microprogram have the same selector. [`Designer::finish`] reports a mistake otherwise.
#[track_caller]
pub fn dispatch(selector: Signal<'_>, to: &[&str]) -> StepSetting {
    let to = to.iter().map(|name| (*name).to_owned()).collect();
    let kind = SettingKind::Dispatch { selector: selector.id(), to };
    StepSetting { of: Some(origin(selector.designer())), ..StepSetting::sequence(kind) }
}

/// Ends the computation: the device raises `done` in this microinstruction, and is idle after it. If the operands have buffers
/// and `start` is high in this clock, the next computation begins at once.
#[track_caller]
pub fn end() -> StepSetting {
    StepSetting::sequence(SettingKind::End)
}

/// A microinstruction of a microprogram: a name, and settings such as "load this register".
#[derive(Clone)]
pub struct Step {
    pub(super) name: String,
    pub(super) settings: Vec<StepSetting>,
    pub(super) location: SourceLocation,
}

impl Step {
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Adds a setting.
    pub fn add(&mut self, setting: StepSetting) {
        self.settings.push(setting);
    }
}

/// Makes a microinstruction: `step("load", [y.load()])` loads the register `y`. Muxes without a setting pass their first input,
/// or with [`hold`] the input of the previous microinstruction. Registers without a setting keep their value.
#[track_caller]
pub fn step(name: &str, settings: impl IntoIterator<Item = StepSetting>) -> Step {
    Step {
        name: name.to_owned(),
        settings: settings.into_iter().collect(),
        location: Location::caller(),
    }
}

/// A microprogram as a description states it: microinstructions with settings, not yet control words.
pub struct MicroprogramSource {
    pub(crate) steps: Vec<Step>,
    /// Whether the microprogram executes the parts (instances) of the description.
    pub(crate) of_parts: bool,
    pub(crate) location: SourceLocation,
}

/// Builds the hardware of a microprogram: control ROM, sequencer and handshake. A program needs at least two microinstructions.
pub(crate) fn assemble(d: &Designer, program: &MicroprogramSource) {
    let steps = &program.steps;
    if steps.len() < 2 {
        d.report(Diagnostic::new(
            codes::MICROPROGRAM,
            "a microprogram needs at least two microinstructions: one waits for `start`, and one ends the \
             computation"
                .to_owned(),
            program.location,
        ));
        return;
    }
    if foreign(d, steps) {
        return;
    }
    let mut picked: HashSet<FieldId> = HashSet::new();
    for setting in steps.iter().flat_map(|step| &step.settings) {
        if let SettingKind::Field { field, .. } = setting.kind {
            picked.insert(field);
        }
    }
    d.with(|inner| inner.picked = picked);
    let sequences: Vec<Sequence> = steps.iter().map(|step| sequence(d, steps, step)).collect();
    let (mut conditions, mut targets) = (BTreeSet::new(), BTreeSet::new());
    for sequence in &sequences {
        if let Sequence::LoopWhile { condition, to } = sequence {
            conditions.insert(*condition);
            targets.insert(*to);
        }
    }
    let (conditions, targets) = (Vec::from_iter(conditions), Vec::from_iter(targets));
    let dispatches = Dispatches::of(&sequences);
    let tables = dispatches.as_ref().map_or(0, |it| it.tables.len());
    if let Some(dispatches) = &dispatches {
        check_selectors(d, steps, &sequences, dispatches.selector);
    }
    let waits = sequences.contains(&Sequence::WaitStart);
    d.with(|inner| inner.partition = Partition::Control);
    let address_width = usize::BITS - (steps.len() - 1).leading_zeros();
    let sequence_field = |name: &str, width: u32| d.add_field(name, width, FieldKind::Sequence);
    let by_field = d.with(|inner| inner.valid.is_none());
    let fields = SequenceFields {
        valid: by_field.then(|| d.add_field("valid_word", 1, FieldKind::Flag)),
        wait: waits.then(|| sequence_field("wait_word", 1)),
        again: (!conditions.is_empty()).then(|| sequence_field("loop_word", 1)),
        condition: (conditions.len() > 1).then(|| {
            let bits = usize::BITS - (conditions.len() - 1).leading_zeros();
            sequence_field("loop_condition", bits)
        }),
        target: (targets.len() > 1).then(|| sequence_field("loop_target", address_width)),
        dispatch: (tables > 0).then(|| sequence_field("dispatch_word", 1)),
        table: (tables > 1).then(|| {
            let bits = usize::BITS - (tables - 1).leading_zeros();
            sequence_field("dispatch_table", bits)
        }),
        go_on: sequence_field("go_on", 1),
    };
    let lines = d.with(|inner| inner.sequencer_lines);
    let describe = |field: FieldId, doc: &str, line: Option<u16>| {
        d.set_doc(d.field_net(field).id(), doc);
        d.with(|inner| {
            inner.design.control.fields[field.index()].lines = line.into_iter().collect();
        });
    };
    if let Some(valid) = fields.valid {
        describe(valid, "1 if the microinstruction sets valid", lines.map(|[valid, _]| valid));
    }
    let line = lines.map(|[_, go_on]| go_on);
    describe(fields.go_on, "0 in the last microinstruction, else 1", line);
    if let Some(dispatch) = fields.dispatch {
        describe(dispatch, "1 if an operand selects the next microinstruction", None);
    }
    let sequencer = Sequencer { fields, conditions, targets, dispatches, address_width };
    let microinstructions = microinstructions(d, steps, &sequences, &sequencer);
    sequencer.build(d, microinstructions, program.location);
}

/// Reports each setting that belongs to another designer, whose numbers of nets and fields mean other nets and fields here.
/// Returns whether such a setting exists.
fn foreign(d: &Designer, steps: &[Step]) -> bool {
    let own = origin(d);
    let settings = steps.iter().flat_map(|step| step.settings.iter().map(move |it| (step, it)));
    let mut any = false;
    for (step, setting) in settings {
        if let Some((serial, name)) = &setting.of
            && *serial != own.0
        {
            let what = match &setting.kind {
                SettingKind::Field { what, .. } => format!("`{what}`"),
                _ => "a condition".to_owned(),
            };
            let message = format!(
                "microinstruction `{}`: {what} belongs to the designer of `{name}`, not to the designer of \
                 `{}`",
                step.name, own.1
            );
            d.report(Diagnostic::new(codes::FOREIGN, message, setting.location));
            any = true;
        }
    }
    any
}

/// Returns the rule for the microinstruction after `step`. Reports a mistake if two settings contradict each other, or if a
/// jump leads to an unknown name or has a condition of several bits. With operand buffers, it is a mistake if `step` waits for
/// `start`.
fn sequence(d: &Designer, steps: &[Step], step: &Step) -> Sequence {
    let mut found: Option<(Sequence, SourceLocation)> = None;
    let own = &step.name;
    for setting in &step.settings {
        let wrong = |code, message| Diagnostic::new(code, message, setting.location);
        let sequence = match &setting.kind {
            SettingKind::Next => Sequence::Next,
            // Microinstruction 0 waits for `start` with or without this setting.
            SettingKind::WaitForStart if std::ptr::eq(step, &steps[0]) => Sequence::Next,
            SettingKind::WaitForStart => {
                if d.with(|inner| inner.taken.is_some()) {
                    let message = format!(
                        "microinstruction `{own}` waits for `start`, but the operands have buffers, and only \
                         the start of a computation empties buffers"
                    );
                    d.report(wrong(codes::BUFFER, message));
                }
                Sequence::WaitStart
            }
            SettingKind::End => Sequence::End,
            SettingKind::LoopWhile { condition, to } => {
                if d.net(*condition).format.width() != 1 {
                    let name = d.net(*condition).name;
                    let message = format!(
                        "microinstruction `{own}`: the condition `{name}` has more than one bit"
                    );
                    d.report(wrong(codes::WIDTH, message));
                }
                match steps.iter().position(|step| step.name == *to) {
                    Some(to) => Sequence::LoopWhile { condition: *condition, to },
                    None => {
                        d.report(wrong(codes::SUCCESSOR, unknown_successor(own, to)));
                        Sequence::Next
                    }
                }
            }
            SettingKind::Dispatch { selector, to } => {
                match dispatched(d, steps, own, *selector, to) {
                    Ok(to) => Sequence::Dispatch { selector: *selector, to },
                    Err(message) => {
                        d.report(wrong(codes::SUCCESSOR, message));
                        Sequence::Next
                    }
                }
            }
            _ => continue,
        };
        if let Some((first, location)) = &found
            && *first != sequence
        {
            let message = format!("microinstruction `{own}` has two successors");
            let note = "the other successor".to_owned();
            d.report(wrong(codes::SUCCESSOR, message).note(note, location));
        }
        found = Some((sequence, setting.location));
    }
    found.map_or(Sequence::Next, |(sequence, _)| sequence)
}

/// Reports each microinstruction that dispatches by another operand than `selector`.
fn check_selectors(d: &Designer, steps: &[Step], sequences: &[Sequence], selector: NetId) {
    for (step, sequence) in steps.iter().zip(sequences) {
        let Sequence::Dispatch { selector: other, .. } = sequence else { continue };
        if *other != selector {
            let [first, other] = [selector, *other].map(|net| d.net(net).name);
            let message = format!(
                "microinstruction `{}` dispatches by `{other}`, but an earlier one by `{first}`: all \
                 dispatches must have the same selector",
                step.name
            );
            d.report(Diagnostic::new(codes::SUCCESSOR, message, step.location));
        }
    }
}

fn unknown_successor(own: &str, to: &str) -> String {
    format!("microinstruction `{own}` goes to `{to}`, but no microinstruction has this name")
}

/// Returns the addresses to which the microinstruction named `own` dispatches. The error is a message.
fn dispatched(
    d: &Designer,
    steps: &[Step],
    own: &str,
    selector: NetId,
    to: &[String],
) -> Result<Vec<usize>, String> {
    let net = d.net(selector);
    let is_operand = match net.driver {
        Driver::Register(id) => {
            d.with(|inner| inner.design.register(id).kind == RegisterKind::Operand)
        }
        _ => false,
    };
    if !is_operand {
        return Err(format!(
            "microinstruction `{own}` dispatches by `{}`, which is not the register of an operand",
            net.name
        ));
    }
    let (values, stated) = (1u64 << net.format.width().min(32), to.len());
    if stated as u64 != values {
        return Err(format!(
            "microinstruction `{own}` dispatches to {stated} microinstructions, but `{}` has {values} values: \
             state a microinstruction for each value",
            net.name
        ));
    }
    let here = steps.iter().position(|step| step.name == own).unwrap_or(0);
    let mut addresses = Vec::new();
    for name in to {
        match steps.iter().position(|step| step.name == *name) {
            Some(at) if at > here => addresses.push(at),
            Some(_) => {
                return Err(format!(
                    "microinstruction `{own}` dispatches to `{name}`, which does not come after it: a \
                     dispatch jumps ahead"
                ));
            }
            None => return Err(unknown_successor(own, name)),
        }
    }
    Ok(addresses)
}

/// Gives each field of each microinstruction its value. Reports two microinstructions of one name, and two values for a field.
fn microinstructions(
    d: &Designer,
    steps: &[Step],
    sequences: &[Sequence],
    sequencer: &Sequencer,
) -> Vec<Microinstruction> {
    let Sequencer { fields, conditions, dispatches, .. } = sequencer;
    let fields_of_word = d.with(|inner| inner.design.control.fields.clone());
    let kinds: Vec<FieldKind> = fields_of_word.into_iter().map(|field| field.kind).collect();
    let mut microinstructions: Vec<Microinstruction> = Vec::new();
    for (step, sequence) in steps.iter().zip(sequences) {
        let own = &step.name;
        if let Some(first) = steps.iter().find(|other| other.name == step.name)
            && !std::ptr::eq(first, step)
        {
            let message = format!("two microinstructions are named `{own}`");
            let found = Diagnostic::new(codes::NAME_TWICE, message, step.location);
            d.report(found.note("the first".to_owned(), first.location));
        }
        let mut values = vec![0; kinds.len()];
        if step.settings.iter().any(|setting| matches!(setting.kind, SettingKind::Hold))
            && let Some(before) = microinstructions.last()
        {
            for (at, kind) in kinds.iter().enumerate() {
                if matches!(kind, FieldKind::Select(_)) {
                    values[at] = before.values[at];
                }
            }
        }
        let mut set: Vec<Option<(u64, &str, SourceLocation)>> = vec![None; kinds.len()];
        for setting in &step.settings {
            let (field, value, what) = match &setting.kind {
                SettingKind::Field { field, value, what } => (*field, *value, what.as_str()),
                SettingKind::Valid => match fields.valid {
                    Some(field) => (field, 1, "valid"),
                    None => {
                        let message = format!(
                            "microinstruction `{own}` sets `valid`, but `valid` follows a signal in this \
                             design"
                        );
                        d.report(Diagnostic::new(codes::VALID, message, setting.location));
                        continue;
                    }
                },
                _ => continue,
            };
            if let Some((other, other_what, location)) = set[field.index()]
                && other != value
            {
                let message = format!(
                    "microinstruction `{own}`: `{what}` clashes with `{other_what}`: they share select lines"
                );
                let found = Diagnostic::new(codes::CLASH, message, setting.location);
                d.report(found.note("the other".to_owned(), location));
            }
            set[field.index()] = Some((value, what, setting.location));
            values[field.index()] = value;
        }
        let mut assign = |field: Option<FieldId>, value: u64| {
            if let Some(field) = field {
                values[field.index()] = value;
            }
        };
        match sequence {
            Sequence::Next => assign(Some(fields.go_on), 1),
            Sequence::End => {}
            Sequence::WaitStart => {
                assign(Some(fields.go_on), 1);
                assign(fields.wait, 1);
            }
            Sequence::LoopWhile { condition, to } => {
                assign(Some(fields.go_on), 1);
                assign(fields.again, 1);
                let number = conditions.iter().position(|other| other == condition);
                assign(fields.condition, number.unwrap_or(0) as u64);
                assign(fields.target, *to as u64);
            }
            Sequence::Dispatch { to, .. } => {
                assign(Some(fields.go_on), 1);
                assign(fields.dispatch, 1);
                let tables = dispatches.iter().flat_map(|it| &it.tables);
                let number = tables.into_iter().position(|table| table == to);
                assign(fields.table, number.unwrap_or(0) as u64);
            }
        }
        microinstructions.push(Microinstruction {
            name: step.name.clone(),
            values,
            sequence: sequence.clone(),
            location: step.location,
        });
    }
    microinstructions
}
