//! Builds the hardware of a plan: registers, the logic of the operations between them, and a microprogram.
//!
//! The devices `function`, `expression` and `unit` use this hardware. A plan is a list of fixed-point operations
//! ([`glint_plan`]). All products of a plan share one multiplier, and each has its own microinstruction. In a pipeline the
//! microprogram is unrolled, and each product gets its own multiplier. With an interval above 1 (the key `pipeline.interval`),
//! products can share multipliers.

use glint_approximate::{Outside, Piecewise};
use glint_base::fixed::{Format, Overflow, Rounding};
use glint_plan::{
    ExpressionPlan, MirrorChain, NodeId, Operation, PlanNode, PlanSchedule, PlanStep,
    StatedOperand, StepWork,
};
use glint_rtl::blocks::shift::{left_justified, normalise, normalise_by_pairs, right_by};
use glint_rtl::dsl::{
    Designer, Mux, Register, Signal, Step, StepSetting, dispatch, end, step, valid,
};

use crate::mirror::mirrored;
use crate::piecewise::{PolynomialDatapath, StepMultiplier, Tables, number};
use crate::shared_table::{SharedSteps, SharedTable, TableReaders};

pub(super) struct PlanOutput {
    pub(super) name: String,
    /// The user's remark about the result; empty without one.
    pub(super) doc: String,
}

/// Builds the hardware. Result k of the plan is connected to the port `outputs[k]`. `is_pipelined` decides how tables store
/// their coefficients.
pub(super) fn describe_plan(
    d: &Designer,
    operands: &[StatedOperand],
    plan: &ExpressionPlan,
    outputs: &[PlanOutput],
    is_pipelined: bool,
) {
    let schedule = plan.schedule(is_pipelined);
    let mut datapath = PlanDatapath::new(d, operands, plan, &schedule, is_pipelined);
    datapath.build();
    let steps = datapath.microprogram();
    for (PlanOutput { name, doc }, node) in outputs.iter().zip(plan.results()) {
        let output = d.output(name, datapath.signal(*node));
        if !doc.is_empty() {
            let _ = output.doc(doc);
        }
    }
    d.microprogram(steps);
}

struct PlanDatapath<'d, 'p> {
    d: &'d Designer,
    operands: &'p [StatedOperand],
    plan: &'p ExpressionPlan,
    schedule: &'p PlanSchedule,
    is_pipelined: bool,
    /// The register of each node that has one. Polynomials have their own registers.
    registers: Vec<Option<Register<'d>>>,
    /// For each node that is built, the signal that later nodes read.
    signals: Vec<Option<Signal<'d>>>,
    polynomials: Vec<Option<PolynomialDatapath<'d, 'p>>>,
    /// For each owner of a table that several polynomials share, these polynomials.
    table_readers: Vec<TableReaders<'d>>,
    /// For each owner, the table with its polynomials, once all their operands are built.
    shared_tables: Vec<Option<SharedTable<'d, 'p>>>,
    /// The value of each node that shares its register with other nodes.
    shared_inputs: Vec<Option<Signal<'d>>>,
    /// For each node whose register others share, the mux of their values.
    input_muxes: Vec<Option<Mux<'d>>>,
    /// The two factors of each product.
    factors: Vec<Option<[Signal<'d>; 2]>>,
    /// The chain of mirrors that ends at each node, if there is one.
    chains: Vec<Option<MirrorChain>>,
    /// Whether a chain of mirrors replaces each node, so that it is not built.
    is_inner: Vec<bool>,
    /// Whether a result needs each node.
    is_read: Vec<bool>,
}

impl<'d, 'p> PlanDatapath<'d, 'p> {
    fn new(
        d: &'d Designer,
        operands: &'p [StatedOperand],
        plan: &'p ExpressionPlan,
        schedule: &'p PlanSchedule,
        is_pipelined: bool,
    ) -> Self {
        let count = plan.nodes().len();
        let mut registers = Vec::with_capacity(count);
        for (node, is_held) in plan.nodes().iter().zip(&schedule.held) {
            let has_own = matches!(node.operation, Operation::Polynomial(..));
            let owner = schedule.register_owners[registers.len()];
            registers.push(match *is_held && !has_own {
                true if owner.0 < registers.len() => registers[owner.0],
                true => Some(d.register(&node.name, node.format)),
                false => None,
            });
        }
        let (chains, is_inner) = mirror_chains(plan, schedule);
        Self {
            d,
            operands,
            plan,
            schedule,
            is_pipelined,
            chains,
            is_inner,
            is_read: plan.read_nodes(),
            registers,
            signals: vec![None; count],
            polynomials: (0..count).map(|_| None).collect(),
            table_readers: (0..count).map(|_| TableReaders::new()).collect(),
            shared_tables: (0..count).map(|_| None).collect(),
            shared_inputs: vec![None; count],
            input_muxes: vec![None; count],
            factors: vec![None; count],
        }
    }

    /// Builds the nodes that a result reads and no chain of mirrors replaces, in their order. `microprogram` builds the products,
    /// and the nodes between a product and the next register, with the multiplier.
    fn build(&mut self) {
        let plan = self.plan;
        for (at, node) in plan.nodes().iter().enumerate() {
            if self.is_inner[at] || !self.is_read[at] {
                continue;
            }
            if let Operation::Multiply(a, b) = node.operation {
                self.factors[at] = Some(self.distinct_factors(&node.name, [a, b]));
            }
            let is_behind_product =
                node.operation.hardware_inputs().iter().any(|it| self.signals[it.0].is_none());
            let value = if self.chains[at].is_some() {
                Some(self.mirrored(NodeId(at)))
            } else if matches!(node.operation, Operation::Multiply(..)) || is_behind_product {
                None
            } else {
                Some(self.logic(NodeId(at)))
            };
            self.signals[at] = match (self.registers[at], value) {
                (Some(register), Some(value)) => {
                    self.connect(NodeId(at), register, value);
                    Some(register.q())
                }
                (Some(register), None) => Some(register.q()),
                (None, value) => value,
            };
        }
    }

    /// Connects a register to the value of a node. If several nodes share the register, a mux selects one of their values, once all of
    /// them are built.
    fn connect(&mut self, node: NodeId, register: Register<'d>, value: Signal<'d>) {
        let sharers = self.schedule.register_sharers(node);
        if sharers.len() == 1 {
            register.takes(value);
            return;
        }
        self.shared_inputs[node.0] = Some(value);
        let inputs: Vec<Signal<'d>> =
            sharers.iter().filter_map(|sharer| self.shared_inputs[sharer.0]).collect();
        if inputs.len() == sharers.len() {
            let name = format!("{}_input", self.plan.node(sharers[0]).name);
            let mux = self.d.mux(&name, inputs);
            register.takes(mux.out());
            self.input_muxes[sharers[0].0] = Some(mux);
        }
    }

    fn load(&self, node: NodeId) -> Vec<StepSetting> {
        let mut settings = vec![self.register(node).load()];
        let owner = self.schedule.register_owners[node.0];
        if let Some(mux) = self.input_muxes[owner.0] {
            settings.push(mux.pick(self.shared_inputs[node.0].expect("the value of a sharer")));
        }
        settings
    }

    /// Returns the factors of a product. The microprogram selects a product by its first factor, so the factor gets a new net if
    /// another product has the same one.
    fn distinct_factors(&self, name: &str, inputs: [NodeId; 2]) -> [Signal<'d>; 2] {
        let [first, second] = inputs.map(|input| self.signal(input));
        let mut others = self.factors.iter().flatten();
        let is_first = others.any(|[other, _]| other.name() == first.name());
        if !is_first {
            return [first, second];
        }
        let own = format!("{name}_first");
        let first = self.d.narrow(&own, first, first.format(), Rounding::Truncate, Overflow::Wrap);
        [first, second]
    }

    /// Returns the signal of a node. Panics if the node is not built yet.
    fn signal(&self, id: NodeId) -> Signal<'d> {
        self.signals[id.0].unwrap_or_else(|| panic!("`{}` is built", self.plan.node(id).name))
    }

    /// Drops bits above and below the format.
    fn in_format(&self, name: &str, signal: Signal<'d>, format: Format) -> Signal<'d> {
        if signal.format() == format {
            return signal;
        }
        // The plan knows narrower limits of the value than the interval of the signal.
        let name = format!("{name}_kept");
        self.d.narrow(&name, signal, format, Rounding::Truncate, Overflow::Wrap)
    }

    fn mirrored(&self, id: NodeId) -> Signal<'d> {
        let PlanNode { name, format, .. } = self.plan.node(id);
        let chain = self.chains[id.0].as_ref().expect("a chain that ends at the node");
        let name = match self.registers[id.0] {
            Some(_) => format!("{name}_next"),
            None => name.clone(),
        };
        let value = mirrored(chain, self.d, self.plan, &name, &|input| self.signal(input));
        self.in_format(&name, value, *format)
    }

    /// Builds the logic of node `id`, which must not be a product. The nodes that it reads must already be built.
    fn logic(&mut self, id: NodeId) -> Signal<'d> {
        let d = self.d;
        let plan = self.plan;
        let node = plan.node(id);
        let PlanNode { name, format, .. } = node;
        let name = &match self.registers[id.0] {
            Some(_) => format!("{name}_next"),
            None => name.clone(),
        };
        let input = |id: &NodeId| self.signals[id.0].expect("a node that is built");
        let value = match &node.operation {
            Operation::Operand(number) => {
                let StatedOperand { name, format, domain, outside, doc } = &self.operands[*number];
                let register = match outside {
                    Outside::Clamp => {
                        let [first, last] =
                            [domain.0, domain.1].map(|raw| format.to_f64(raw.into()));
                        d.operand_clamped(name, *format, first, last)
                    }
                    Outside::Wrap | Outside::Anything => d.operand(name, *format),
                };
                let doc = match (doc.as_str(), self.operands.len()) {
                    ("", 1) => "the operand",
                    ("", _) => "an operand",
                    (doc, _) => doc,
                };
                return register.doc(doc).q();
            }
            Operation::Constant { raw, .. } => d.raw_constant(name, *raw, *format),
            Operation::Add(a, b) => match are_joined(input(a), input(b), *format) {
                true => d.join(name, &[input(a), input(b)], *format),
                false => d.add(name, input(a), input(b)),
            },
            Operation::Subtract(a, b) => match plan.is_inversion(*a, *b) {
                true => {
                    let wide = self.in_format(name, input(b), plan.node(*a).format);
                    d.not(name, wide)
                }
                false => d.sub(name, input(a), input(b)),
            },
            Operation::Multiply(..) => unreachable!("a product needs the multiplier"),
            Operation::Absolute(a) => {
                // −a equals ~a plus a carry. If the choice came after the sum, synthesis would merge it with the choices that
                // follow into one large function.
                let a = input(a);
                let is_negative = a.bit(a.format().width() - 1);
                let inverted = d.not(&format!("{name}_inverted"), a);
                let mirrored = d.choose(&format!("{name}_mirrored"), is_negative, [a, inverted]);
                let zero = d.raw_constant("zero", 0, a.format());
                d.add_carry(&format!("{name}_sum"), zero, mirrored, is_negative)
            }
            Operation::Minimum(a, b) => {
                let (a, b) = (input(a), input(b));
                let is_first = d.less(&format!("{name}_is_first"), a, b);
                d.choose(&format!("{name}_chosen"), is_first, aligned([b, a]))
            }
            Operation::Maximum(a, b) => {
                let (a, b) = (input(a), input(b));
                let is_second = d.less(&format!("{name}_is_second"), a, b);
                d.choose(&format!("{name}_chosen"), is_second, aligned([a, b]))
            }
            Operation::Less(a, b) => {
                let zero = matches!(plan.node(*b).operation, Operation::Constant { raw: 0, .. });
                let format = input(a).format();
                return match zero && format.signed {
                    // The sign bit says whether a number is below 0.
                    true => input(a).bit(format.width() - 1),
                    false => d.less(name, input(a), input(b)),
                };
            }
            Operation::NonZero(a) => return d.any(name, input(a)),
            Operation::Choose { condition, cases } => {
                let cases = aligned(cases.map(|it| input(&it)));
                d.choose(&format!("{name}_chosen"), input(condition), cases)
            }
            Operation::Scale(a) => input(a).read_as(*format),
            Operation::Narrow(a, rounding) => {
                return d.narrow(name, input(a), *format, *rounding, Overflow::Wrap);
            }
            Operation::Middle(a) => return middle(d, name, input(a), *format),
            Operation::Bit(a, number) => {
                let a = input(a);
                let top = a.format().width() - 1;
                // Above its sign bit, a number has copies of the sign, and an unsigned number has zeros.
                return match *number <= top || a.format().signed {
                    true => a.bit((*number).min(top)),
                    false => d.raw_constant(name, 0, Format::BIT),
                };
            }
            Operation::IntegerPart(a) => {
                return d.narrow(name, input(a), *format, Rounding::Truncate, Overflow::Wrap);
            }
            Operation::FractionPart(a, _) => {
                // A number below 1 may have fewer bits than its fraction.
                return d.narrow(name, input(a), *format, Rounding::Truncate, Overflow::Wrap);
            }
            Operation::Lookup { address, words } => {
                return d.rom(name, input(address), *format, words, false).out();
            }
            Operation::Normalise { word, by_pairs } => {
                // The node with the number of shifted bits directly follows the node of the word.
                let places = id.0 + 1;
                if !self.is_read[places] {
                    let least = if *by_pairs { 2 } else { 1 };
                    return left_justified(d, name, input(word), least).read_as(*format);
                }
                let found = match by_pairs {
                    true => normalise_by_pairs(d, name, input(word)),
                    false => normalise(d, name, input(word)),
                };
                self.signals[places] = Some(found.zeros);
                found.word.read_as(*format)
            }
            Operation::Places(_) => {
                return self.signals[id.0].expect("the places of a normalised word");
            }
            Operation::ShiftLeft(a, places) => left_by(d, name, input(a), input(places), *format),
            Operation::ShiftRight(a, places) => right_by(d, name, input(a), input(places)),
            Operation::Reverse(a) => {
                let a = input(a);
                let bits: Vec<Signal> = (0..format.width()).map(|bit| a.bit(bit)).collect();
                return d.join(name, &bits, *format);
            }
            Operation::Polynomial(a, approximation) => {
                let polynomials = approximation.polynomials.as_deref();
                let it = polynomials.expect("polynomials that are found");
                return self.polynomial(id, input(a), it);
            }
        };
        self.in_format(name, value, *format)
    }

    /// Builds a table of polynomials and its registers, and returns the register with the result. If several polynomials share the
    /// table, it is built for the last of them.
    fn polynomial(&mut self, id: NodeId, operand: Signal<'d>, it: &'p Piecewise) -> Signal<'d> {
        let owner = self.schedule.table_owners[id.0];
        let sharers = self.schedule.table_sharers(owner);
        let prefix = self.plan.table_prefix(owner);
        let [value, first_sum, second_sum] = &self.plan.sum_names(owner);
        let holds_highest = self.schedule.is_coefficient_held[id.0];
        let tables = Tables { holds_highest, ..Tables::of(it, self.is_pipelined) };
        if sharers.len() == 1 {
            let number = number(self.d, &format!("{prefix}number"), operand, it);
            let names = [value, first_sum, second_sum].map(|name| Some(name.as_str()));
            let datapath = PolynomialDatapath::new(self.d, &prefix, names, number, it, tables);
            let q = datapath.q();
            self.polynomials[id.0] = Some(datapath);
            return q;
        }
        let value = self.d.register(&self.plan.node(id).name, it.sums[0]);
        self.table_readers[owner.0].add(id, operand, value);
        if sharers.last() == Some(&id) {
            let readers = std::mem::replace(&mut self.table_readers[owner.0], TableReaders::new());
            let table = readers.build(self.d, &prefix, [first_sum, second_sum], it, tables);
            self.shared_tables[owner.0] = Some(table);
        }
        value.q()
    }

    /// Builds the microinstructions, and connects the registers of products to the multiplier.
    fn microprogram(&mut self) -> Vec<Step> {
        let of_shared = self.shared_tables.iter().flatten().map(SharedTable::datapath);
        let polynomials: Vec<&PolynomialDatapath> =
            self.polynomials.iter().flatten().chain(of_shared).collect();
        let mut others = Vec::new();
        for (node, factors) in self.plan.nodes().iter().zip(&self.factors) {
            others.extend(factors.map(|factors| (node.name.clone(), factors)));
        }
        let names = match others.is_empty() {
            true => ["factors_select", "factor", "offset_of_step", "product"],
            false => ["factors_select", "first_factor", "second_factor", "product_of_factors"],
        };
        let names = names.map(|name| self.beside_operands(name));
        let names = names.each_ref().map(String::as_str);
        let multiplier = StepMultiplier::new(self.d, names, &polynomials, &others);
        let mut shared_steps = Vec::new();
        for table in &self.shared_tables {
            shared_steps.push(table.as_ref().map(|table| table.steps(&multiplier)));
        }
        let work = PlanWork { multiplier, shared_steps };
        let first = self.schedule.steps.first();
        let addresses_table = first.is_some_and(|first| {
            matches!(first.work, Some(StepWork::Sum { .. })) || !first.coefficients.is_empty()
        });
        let first = match addresses_table {
            true => format!("{}; table addressed", noun(self.operands.len(), "operand")),
            false => noun(self.operands.len(), "operand"),
        };
        let mut steps = vec![step(&first, self.addresses(0))];
        for (at, plan_step) in self.schedule.steps.iter().enumerate() {
            steps.push(self.microinstruction(at + 1, plan_step, &work));
        }
        steps.push(step(&noun(self.plan.results().len(), "result"), [valid(), end()]));
        self.with_dispatches(steps)
    }

    /// Lets the microinstructions of a unit continue with the next microinstruction that the opcode needs.
    fn with_dispatches(&self, mut steps: Vec<Step>) -> Vec<Step> {
        let names: Vec<String> = steps.iter().map(|step| step.name().to_owned()).collect();
        for (at, step) in steps.iter_mut().enumerate() {
            if let Some(targets) = self.schedule.dispatch(at) {
                let targets: Vec<&str> = targets.iter().map(|&to| names[to].as_str()).collect();
                let opcode = self
                    .plan
                    .nodes()
                    .iter()
                    .position(|node| matches!(node.operation, Operation::Operand(0)));
                let opcode = self.signal(NodeId(opcode.expect("the opcode of a unit")));
                step.add(dispatch(opcode, &targets));
            }
        }
        steps
    }

    /// Returns `name` as the name of a net of the multiplier, or `name` with a number if an operand's name begins with `name`.
    /// Otherwise the net could have the same name as a net of the operand. For example, `product` becomes `product2` if there
    /// is an operand `product`.
    fn beside_operands(&self, name: &str) -> String {
        let mut free = name.to_owned();
        let mut number = 2;
        while self.operands.iter().any(|operand| operand.name.starts_with(&free)) {
            free = format!("{name}{number}");
            number += 1;
        }
        free
    }

    /// Returns the settings by which microinstruction number `at` addresses shared tables.
    fn addresses(&self, at: usize) -> Vec<StepSetting> {
        let mut settings = Vec::new();
        for (owner, table) in self.shared_tables.iter().enumerate() {
            if let Some(table) = table
                && let Some(polynomial) = self.schedule.addressing(NodeId(owner), at)
            {
                settings.extend(table.address_by(polynomial));
            }
        }
        settings
    }

    fn microinstruction(&self, at: usize, plan_step: &PlanStep, parts: &PlanWork<'d>) -> Step {
        let PlanStep { work, loads, coefficients } = plan_step;
        let mut names = Vec::new();
        let mut settings = self.addresses(at);
        if let Some(work) = work {
            let (name, of_work) = self.work(work, parts);
            names.push(name);
            settings.extend(of_work);
        }
        let mut loaded = Vec::new();
        for polynomial in coefficients {
            settings.push(self.polynomial_datapath(*polynomial).load_highest());
            let owner = self.schedule.table_owners[polynomial.0];
            let name = self.plan.highest_name(owner);
            loaded.push(format!("{name}{}", self.of_sharer(*polynomial)));
        }
        for node in loads {
            settings.extend(self.load(*node));
            loaded.push(self.plan.node(*node).name.clone());
        }
        if !loaded.is_empty() {
            names.push(format!("{} loaded", loaded.join(", ")));
        }
        step(&names.join("; "), settings)
    }

    /// Returns the words that name a polynomial, for a microinstruction that loads a register of another polynomial with the same
    /// table; empty for the polynomial after which the register is named.
    fn of_sharer(&self, polynomial: NodeId) -> String {
        match self.schedule.table_owners[polynomial.0] == polynomial {
            true => String::new(),
            false => format!(" for {}", self.plan.node(polynomial).name),
        }
    }

    fn register(&self, node: NodeId) -> Register<'d> {
        self.registers[node.0].expect("a register of a node that is held")
    }

    fn polynomial_datapath(&self, node: NodeId) -> &PolynomialDatapath<'d, 'p> {
        let owner = self.schedule.table_owners[node.0].0;
        let shared = self.shared_tables[owner].as_ref().map(SharedTable::datapath);
        shared.or(self.polynomials[owner].as_ref()).expect("a polynomial")
    }

    /// Returns the name and the settings for the work of the multiplier or a table.
    fn work(&self, work: &StepWork, parts: &PlanWork<'d>) -> (String, Vec<StepSetting>) {
        let multiplier = &parts.multiplier;
        let name_of = |id: NodeId| self.plan.node(id).name.as_str();
        match work {
            StepWork::Product { product, held } => {
                let factors = self.factors[product.0].expect("the factors of a product");
                let register = self.register(*held);
                register.takes(self.following(multiplier.product(factors), *product, *held));
                let mut settings = vec![register.load()];
                settings.extend(multiplier.pick(factors));
                (format!("{} <- a product", name_of(*held)), settings)
            }
            StepWork::Address(polynomial) => {
                (format!("{}: table addressed", name_of(*polynomial)), Vec::new())
            }
            StepWork::Sum { polynomial, coefficient } => {
                let owner = self.schedule.table_owners[polynomial.0];
                let settings = match &parts.shared_steps[owner.0] {
                    Some(shared) => shared.step(*polynomial, *coefficient),
                    None => multiplier.step(self.polynomial_datapath(*polynomial), *coefficient),
                };
                let register = match coefficient {
                    0 => &self.plan.node(*polynomial).name,
                    _ => &self.plan.sum_names(owner)[*coefficient],
                };
                let sum = match coefficient {
                    0 if self.plan.results().contains(polynomial) => "the polynomial".to_owned(),
                    0 => "all coefficients".to_owned(),
                    _ => {
                        let of_sharer = self.of_sharer(*polynomial);
                        format!("coefficients from {coefficient} on{of_sharer}")
                    }
                };
                (format!("{register} <- {sum}"), settings)
            }
        }
    }

    /// Returns the value of the node `held`, computed from the signal `product` of the node `from`. The nodes between them only
    /// scale and shorten the value.
    fn following(&self, product: Signal<'d>, from: NodeId, held: NodeId) -> Signal<'d> {
        let node = self.plan.node(held);
        if held == from {
            return self.in_format(&format!("{}_next", node.name), product, node.format);
        }
        let inputs = node.operation.inputs();
        let before = self.following(product, from, inputs[0]);
        match node.operation {
            Operation::Narrow(_, rounding) => {
                let name = format!("{}_next", node.name);
                self.d.narrow(&name, before, node.format, rounding, Overflow::Wrap)
            }
            Operation::Middle(_) => {
                middle(self.d, &format!("{}_next", node.name), before, node.format)
            }
            _ => before.read_as(node.format),
        }
    }
}

/// The multiplier, and the steps of the polynomials that share a table, for each owner of such a table.
struct PlanWork<'d> {
    multiplier: StepMultiplier<'d>,
    shared_steps: Vec<Option<SharedSteps<'d>>>,
}

/// Replaces the low bits by a single 1, the lowest bit of `format`.
fn middle<'d>(d: &'d Designer, name: &str, signal: Signal<'d>, format: Format) -> Signal<'d> {
    let kept = Format { frac: format.frac - 1, ..format };
    let name_of_kept = format!("{name}_kept");
    let upper = d.narrow(&name_of_kept, signal, kept, Rounding::Truncate, Overflow::Wrap);
    let one = d.raw_constant("middle", 1, Format::BIT);
    d.join(name, &[upper, one], format)
}

/// Returns for each node the chain of mirrors that ends there, and whether a chain replaces the node.
fn mirror_chains(
    plan: &ExpressionPlan,
    schedule: &PlanSchedule,
) -> (Vec<Option<MirrorChain>>, Vec<bool>) {
    let count = plan.nodes().len();
    let mut chains = vec![None; count];
    let mut is_inner = vec![false; count];
    // If two chains overlap, the chain that ends later is longer.
    for at in (0..count).rev() {
        if is_inner[at] {
            continue;
        }
        let Some(chain) = MirrorChain::ending_at(plan, NodeId(at), &schedule.held) else {
            continue;
        };
        if chain.adders() < 2 {
            continue;
        }
        for node in &chain.inner {
            is_inner[node.0] = true;
        }
        chains[at] = Some(chain);
    }
    (chains, is_inner)
}

fn aligned(signals: [Signal<'_>; 2]) -> [Signal<'_>; 2] {
    let [first, second] = signals.map(|signal| signal.format().frac);
    signals.map(|signal| signal.with_fraction(first.max(second)))
}

/// Builds x · 2^`places` in `format`, without bits above and below the format.
fn left_by<'d>(
    d: &'d Designer,
    name: &str,
    x: Signal<'d>,
    places: Signal<'d>,
    format: Format,
) -> Signal<'d> {
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let width = format.width();
    let wide = d.narrow(&format!("{name}_wide"), x, format, Rounding::Truncate, Overflow::Wrap);
    let mut row = wide.read_as(integer(width));
    for bit in 0..places.format().width() {
        let shift = 1u32.checked_shl(bit).unwrap_or(u32::MAX);
        let moved = if shift < width {
            let kept = row.bits(0, integer(width - shift));
            kept.with_fraction(shift as i32).shift_left(shift as i32)
        } else {
            d.raw_constant("zeros", 0, integer(width))
        };
        row = d.choose(&format!("{name}_by{shift}"), places.bit(bit), [row, moved]);
    }
    row.read_as(format)
}

/// Returns whether the sum of two numbers, in the format `sum`, is the concatenation of their bits, `first` above `second`, and
/// so needs no adder: `second` is unsigned, and its highest bit is directly below the lowest bit of `first`. For example, u4.0
/// and u0.4 in u4.4.
fn are_joined(first: Signal<'_>, second: Signal<'_>, sum: Format) -> bool {
    let [upper, lower] = [first, second].map(|number| number.format());
    let is_above = !lower.signed && lower.int == -upper.frac;
    is_above && upper.width() + lower.width() == sum.width()
}

/// Appends an `s` unless the count is 1.
fn noun(count: usize, noun: &str) -> String {
    if count == 1 { noun.to_owned() } else { format!("{noun}s") }
}
