//! From [`Design`] to [`Program`].

use std::collections::{BTreeMap, HashMap};

use anyhow::{Context, Result, anyhow, bail, ensure};

use crate::fixed::{MAX_WIDTH, mask};
use crate::netlist::{Design, Driver, NetId, Op, Role};
use crate::sim::machine::execute;
use crate::sim::program::{
    InputPort, Instruction, Program, ReadEdge, RegisterEdge, Segment, Slot, Sources, Span,
};
use crate::sim::references;

/// Compiles a design. The errors are those of [`Program::new`].
pub(super) fn compile(design: &Design) -> Result<Program> {
    references::check(design)?;
    let mut compiler = Compiler::new(design)?;
    let order = design.levelise().map_err(|nets| {
        let names: Vec<_> = nets
            .iter()
            .map(|net| design.net(*net).name.as_str())
            .collect();
        anyhow!("combinational loop through `{}`", names.join("`, `"))
    })?;
    for net in order {
        let slot = compiler.net(net).with_context(|| {
            let net = design.net(net);
            format!("net `{}` ({})", net.name, net.location)
        })?;
        compiler.of_net[net.index()] = slot;
    }
    compiler.finish()
}

struct Compiler<'a> {
    design: &'a Design,
    /// For each slot: the [`Sources`] it depends on within one clock; none for constants.
    sources: Vec<Sources>,
    /// How many sources there are so far.
    numbered: u32,
    /// For each slot; the only lane is that of the folded constants.
    initial: Vec<[u64; 1]>,
    constants: BTreeMap<u64, Slot>,
    /// Instructions already there, written to slot 0, and the slots that have their results.
    known: HashMap<Instruction, Slot>,
    /// In an order of evaluation, each with what it depends on.
    instructions: Vec<(Sources, Instruction)>,
    choices: Vec<Slot>,
    words: Vec<u64>,
    roms: Vec<Span>,
    /// For each net; `Slot::MAX` until the net has been compiled.
    of_net: Vec<Slot>,
    inputs: Vec<InputPort>,
    /// For each field of the control word, the number of its lowest bit.
    fields: Vec<u32>,
}

impl<'a> Compiler<'a> {
    fn new(design: &'a Design) -> Result<Self> {
        let mut compiler = Self {
            design,
            sources: Vec::new(),
            numbered: 0,
            initial: Vec::new(),
            constants: BTreeMap::new(),
            known: HashMap::new(),
            instructions: Vec::new(),
            choices: Vec::new(),
            words: Vec::new(),
            roms: Vec::new(),
            of_net: vec![Slot::MAX; design.nets.len()],
            inputs: Vec::new(),
            fields: Vec::new(),
        };
        for port in design.inputs() {
            let net = design.net(port.net);
            let new = compiler.of_net[port.net.index()] == Slot::MAX;
            ensure!(
                new && net.driver == Driver::Input,
                "`{}` ({}) is not an input port, or is one twice",
                net.name,
                net.location
            );
            let slot = compiler.source();
            compiler.of_net[port.net.index()] = slot;
            compiler.inputs.push(InputPort {
                slot,
                source: compiler.sources[slot as usize],
                mask: mask(design.width(port.net)),
            });
        }
        for rom in &design.roms {
            let mask = mask(design.width(rom.data));
            let start = u32::try_from(compiler.words.len()).context("the ROMs are too large")?;
            let len = u32::try_from(rom.words.len()).context("the ROMs are too large")?;
            compiler.roms.push(Span { start, len });
            compiler
                .words
                .extend(rom.words.iter().map(|word| word & mask));
        }
        if !design.control.fields.is_empty() {
            let fields = &design.control.fields;
            let wide: u32 = fields.iter().map(|field| design.width(field.net)).sum();
            let word = design.width(design.rom(design.control.rom).data);
            ensure!(
                wide <= word,
                "the fields take {wide} bits of a control word of {word}"
            );
            compiler.fields = design.field_positions();
        }
        Ok(compiler)
    }

    fn fresh(&mut self, sources: Sources) -> Slot {
        self.sources.push(sources);
        self.initial.push([0]);
        (self.sources.len() - 1) as Slot
    }

    /// A slot that changes from outside settling.
    fn source(&mut self) -> Slot {
        let sources = 1 << (self.numbered % Sources::BITS);
        self.numbered += 1;
        self.fresh(sources)
    }

    fn constant(&mut self, bits: u64) -> Slot {
        if let Some(slot) = self.constants.get(&bits) {
            return *slot;
        }
        let slot = self.fresh(0);
        self.initial[slot as usize] = [bits];
        self.constants.insert(bits, slot);
        slot
    }

    /// The value of a slot that is known already.
    fn known_value(&self, slot: Slot) -> Option<u64> {
        let constant = self.sources[slot as usize] == 0;
        constant.then(|| self.initial[slot as usize][0])
    }

    /// The slot with the result of an instruction, which `make` builds for a given destination.
    fn emit(&mut self, operands: &[Slot], make: impl Fn(Slot) -> Instruction) -> Slot {
        if let Some(slot) = self.known.get(&make(0)) {
            return *slot;
        }
        let sources = operands
            .iter()
            .fold(0, |all, slot| all | self.sources[*slot as usize]);
        let to = self.fresh(sources);
        if sources == 0 {
            execute(make(to), &self.choices, &self.words, &mut self.initial);
            let [bits] = self.initial.pop().unwrap_or_default();
            self.sources.pop();
            return self.constant(bits);
        }
        self.instructions.push((sources, make(to)));
        self.known.insert(make(0), to);
        to
    }

    /// The slot of a net whose inputs have been compiled.
    fn net(&mut self, id: NetId) -> Result<Slot> {
        let design = self.design;
        let width = design.width(id);
        match &design.net(id).driver {
            Driver::Undriven => bail!("it has no driver"),
            Driver::Input => {
                let slot = self.of_net[id.index()];
                ensure!(slot != Slot::MAX, "it is an input, but not among the ports");
                Ok(slot)
            }
            Driver::Constant(bits) => Ok(self.constant(bits & mask(width))),
            Driver::Register(register) => {
                ensure!(
                    design.register(*register).q == id,
                    "its register drives another net"
                );
                Ok(self.source())
            }
            Driver::Rom(rom) => {
                ensure!(design.rom(*rom).data == id, "its ROM drives another net");
                if design.rom(*rom).synchronous {
                    return Ok(self.source());
                }
                let address = self.of_net[design.rom(*rom).address.index()];
                let words = self.roms[rom.index()];
                let read = |to| Instruction::Read { to, address, words };
                Ok(self.emit(&[address], read))
            }
            Driver::Field(field) => {
                ensure!(
                    design.control.fields[field.index()].net == id,
                    "its field drives another net"
                );
                let word = design.rom(design.control.rom).data;
                self.slice(word, self.fields[field.index()], width)
            }
            Driver::Op(op) => self.op(op, id),
        }
    }

    fn op(&mut self, op: &Op, id: NetId) -> Result<Slot> {
        let design = self.design;
        let width = design.width(id);
        let slot = |net: NetId| self.of_net[net.index()];
        let wide = |net: NetId, wanted: u32| {
            ensure!(
                design.width(net) == wanted,
                "operand `{}` is {} bits wide, not {wanted}",
                design.net(net).name,
                design.width(net)
            );
            Ok(())
        };
        let result_wide = |wanted: u32| {
            ensure!(width == wanted, "it is {width} bits wide, not {wanted}");
            Ok(())
        };
        let signed = |net: NetId| design.net(net).format.signed;
        let same_sign = |a: NetId, b: NetId| {
            ensure!(
                signed(a) == signed(b),
                "one of `{}` and `{}` is signed, the other is not",
                design.net(a).name,
                design.net(b).name
            );
            Ok(signed(a))
        };
        let drop = drop_of(width);
        Ok(match op {
            Op::Relabel(a) => {
                wide(*a, width)?;
                slot(*a)
            }
            Op::Extend(of) => {
                let narrow = design.width(*of);
                ensure!(narrow <= width, "the operand is wider");
                let (a, from) = (slot(*of), drop_of(narrow));
                // A pattern is masked to its width, so zeros are above it already.
                if narrow == width || !signed(*of) {
                    a
                } else {
                    self.emit(&[a], |to| Instruction::SignExtend { to, a, from, drop })
                }
            }
            Op::Slice { of, low } => self.slice(*of, *low, width)?,
            Op::Concat(parts) => {
                result_wide(parts.iter().map(|part| design.width(*part)).sum())?;
                self.concat(parts)
            }
            Op::Not(of) => {
                wide(*of, width)?;
                let (a, b) = (slot(*of), self.constant(mask(width)));
                self.emit(&[a], |to| Instruction::Xor { to, a, b })
            }
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) | Op::Sub(a, b) => {
                wide(*a, width)?;
                wide(*b, width)?;
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| match op {
                    Op::And(..) => Instruction::And { to, a, b },
                    Op::Or(..) => Instruction::Or { to, a, b },
                    Op::Xor(..) => Instruction::Xor { to, a, b },
                    _ => Instruction::Sub { to, a, b, drop },
                })
            }
            Op::Add { a, b, carry } => {
                wide(*a, width)?;
                wide(*b, width)?;
                let (a, b) = (slot(*a), slot(*b));
                match carry {
                    None => self.emit(&[a, b], |to| Instruction::Add { to, a, b, drop }),
                    Some(carry) => {
                        wide(*carry, 1)?;
                        let carry = slot(*carry);
                        self.emit(&[a, b, carry], |to| Instruction::AddCarry {
                            to,
                            a,
                            b,
                            carry,
                            drop,
                        })
                    }
                }
            }
            Op::Mul(a, b) => {
                result_wide(design.width(*a) + design.width(*b))?;
                let signed = same_sign(*a, *b)?;
                let (drop_a, drop_b) = (drop_of(design.width(*a)), drop_of(design.width(*b)));
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| match signed {
                    false => Instruction::MulUnsigned { to, a, b },
                    true => Instruction::MulSigned {
                        to,
                        a,
                        b,
                        drop_a,
                        drop_b,
                        drop,
                    },
                })
            }
            Op::Equal(a, b) | Op::Less(a, b) => {
                result_wide(1)?;
                wide(*b, design.width(*a))?;
                let drop = drop_of(design.width(*a));
                let less = matches!(op, Op::Less(..));
                let signed = less && same_sign(*a, *b)?;
                let (a, b) = (slot(*a), slot(*b));
                self.emit(&[a, b], |to| match (less, signed) {
                    (false, _) => Instruction::Equal { to, a, b },
                    (true, false) => Instruction::LessUnsigned { to, a, b },
                    (true, true) => Instruction::LessSigned { to, a, b, drop },
                })
            }
            Op::Any(of) | Op::All(of) => {
                result_wide(1)?;
                let a = slot(*of);
                if design.width(*of) == 1 {
                    a
                } else if let Op::Any(_) = op {
                    self.emit(&[a], |to| Instruction::Any { to, a })
                } else {
                    let b = self.constant(mask(design.width(*of)));
                    self.emit(&[a], |to| Instruction::Equal { to, a, b })
                }
            }
            Op::Mux { select, inputs } => {
                for input in inputs {
                    wide(*input, width)?;
                }
                let inputs: Vec<_> = inputs.iter().map(|net| slot(*net)).collect();
                self.mux(slot(*select), &inputs)?
            }
        })
    }

    /// `width` bits of `of` from `low` up.
    fn slice(&mut self, of: NetId, low: u32, width: u32) -> Result<Slot> {
        let whole = self.design.width(of);
        ensure!(
            low.checked_add(width).is_some_and(|top| top <= whole),
            "{width} bits from bit {low} are not within the {whole} of `{}`",
            self.design.net(of).name
        );
        let (a, low, drop) = (self.of_net[of.index()], low as u8, drop_of(width));
        if width == whole {
            return Ok(a);
        }
        Ok(self.emit(&[a], |to| Instruction::Slice { to, a, low, drop }))
    }

    /// The operands side by side; together they are no wider than a net.
    fn concat(&mut self, parts: &[NetId]) -> Slot {
        let mut all = self.constant(0);
        for part in parts {
            let (a, b) = (all, self.of_net[part.index()]);
            let shift = self.design.width(*part) as u8;
            all = if self.known_value(a) == Some(0) {
                b
            } else {
                self.emit(&[a, b], |to| Instruction::Concat { to, a, b, shift })
            };
        }
        all
    }

    fn mux(&mut self, select: Slot, inputs: &[Slot]) -> Result<Slot> {
        let [.., last] = inputs else {
            bail!("the mux has no inputs");
        };
        if let Some(value) = self.known_value(select) {
            let chosen = usize::try_from(value).ok().and_then(|at| inputs.get(at));
            return Ok(*chosen.unwrap_or(last));
        }
        if inputs.iter().all(|input| input == last) {
            return Ok(*last);
        }
        let mut operands = vec![select];
        operands.extend(inputs);
        if let [a, b] = *inputs {
            return Ok(self.emit(&operands, |to| Instruction::Choose { to, select, a, b }));
        }
        let first = u32::try_from(self.choices.len()).context("too many muxes")?;
        let last = first + (inputs.len() - 1) as u32;
        self.choices.extend(inputs);
        Ok(self.emit(&operands, |to| Instruction::Mux {
            to,
            select,
            first,
            last,
        }))
    }

    /// The clock edge, and everything together.
    fn finish(mut self) -> Result<Program> {
        let design = self.design;
        let one = self.constant(1);
        let reset = design.port(|role| role == Role::Reset);
        let mut written = Vec::new();
        let mut reads = Vec::new();
        for (at, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                let to = self.of_net[rom.data.index()];
                let address = self.stable(self.of_net[rom.address.index()], &written);
                written.push(to);
                reads.push(ReadEdge {
                    to,
                    source: self.sources[to as usize],
                    address,
                    words: self.roms[at],
                });
            }
        }
        let mut registers = Vec::new();
        for register in &design.registers {
            let net = design.net(register.q);
            let what = || format!("register `{}` ({})", net.name, net.location);
            let q = self.of_net[register.q.index()];
            let data = register
                .data
                .context("it takes nothing")
                .with_context(what)?;
            ensure!(
                design.width(data) == design.width(register.q),
                "{} takes data of another width",
                what()
            );
            let keep = match (register.reset, reset) {
                (None, _) => one,
                (Some(_), Some(port)) => self.of_net[port.net.index()],
                (Some(_), None) => bail!("{} is reset, but there is no reset port", what()),
            };
            let enable = register.enable.map_or(one, |net| self.of_net[net.index()]);
            let data = self.stable(self.of_net[data.index()], &written);
            let enable = self.stable(enable, &written);
            written.push(q);
            registers.push(RegisterEdge {
                q,
                source: self.sources[q as usize],
                data,
                enable,
                keep,
                reset: register.reset.unwrap_or(0) & mask(design.width(register.q)),
            });
        }
        // An operand depends on no source that the result does not depend on, so its set is the
        // smaller number, and this remains an order of evaluation.
        self.instructions.sort_by_key(|(sources, _)| *sources);
        let segments = self
            .instructions
            .chunk_by(|(a, _), (b, _)| a == b)
            .map(|chunk| Segment {
                sources: chunk[0].0,
                len: chunk.len() as u32,
            })
            .collect();
        Ok(Program {
            instructions: self.instructions.into_iter().map(|(_, i)| i).collect(),
            segments,
            reads,
            registers,
            choices: self.choices,
            words: self.words,
            initial: self.initial.into_iter().map(|[bits]| bits).collect(),
            slots: self.of_net,
            inputs: self.inputs,
        })
    }

    /// A slot that holds the value of `a` until the edge is over, although the edge has written the
    /// slots `written` before: the edge happens everywhere at once.
    fn stable(&mut self, a: Slot, written: &[Slot]) -> Slot {
        if written.contains(&a) {
            self.emit(&[a], |to| Instruction::Copy { to, a })
        } else {
            a
        }
    }
}

/// How much narrower than 64 bits a width is.
fn drop_of(width: u32) -> u8 {
    (MAX_WIDTH - width) as u8
}
