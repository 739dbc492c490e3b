//! What of a golden model belongs to what of a design.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow, ensure};

use super::combinations::{Combinations, Ports};
use super::lockstep::{Mismatch, Worst};
use super::stimulus::Stimulus;
use super::stream::Stream;
use crate::base::fixed::{Format, MAX_WIDTH, exp2};
use crate::golden::{Contract, Model, Operand, nearer};
use crate::hdl::netlist::{Design, NetId, RegisterKind};

/// A design and its golden model, paired by the names of ports and registers.
pub(super) struct Pairing<'a> {
    pub(super) design: &'a Design,
    contract: &'a dyn Contract,
    /// At power-up; every stream runs a copy of it.
    pub(super) model: Box<dyn Model>,
    pub(super) outputs: Vec<NetId>,
    /// For each input of the model its position among the design's; none if the orders are the same.
    pub(super) order: Option<Vec<usize>>,
    /// The nets that the model predicts, in its order.
    pub(super) compared: Vec<NetId>,
    /// Of the outputs `busy` and `valid`, the positions among these.
    pub(super) busy: usize,
    pub(super) valid: usize,
    /// The address of the microprogram.
    pub(super) address: NetId,
    pub(super) ports: Arc<Ports>,
    /// The operands of the contract, as positions in the stimulus.
    operands: Vec<usize>,
    /// The same, with the domains that the stimulus draws from.
    drawn: Vec<Operand>,
    /// Of each result: itself, and the unit of the colour operand that it is made of.
    results: Vec<(Quantity, f64)>,
}

/// A net that carries a number.
struct Quantity {
    /// Its position among those that are compared.
    at: usize,
    format: Format,
    /// The value of its last place.
    unit: f64,
}

impl Quantity {
    fn value(&self, bits: u64) -> f64 {
        if self.format.signed {
            let drop = MAX_WIDTH - self.format.width();
            ((bits << drop) as i64 >> drop) as f64 * self.unit
        } else {
            bits as f64 * self.unit
        }
    }
}

impl<'a> Pairing<'a> {
    /// Pairs them.
    ///
    /// # Errors
    /// A name of one side that the other does not have.
    pub(super) fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
    ) -> Result<Self> {
        let find = |name: &str| {
            design.find(name).ok_or_else(|| {
                anyhow!("the golden model speaks of `{name}`, which the design does not have")
            })
        };
        let inputs: Vec<NetId> = design.inputs().map(|port| port.net).collect();
        let outputs: Vec<NetId> = design.outputs().map(|port| port.net).collect();
        let order = model
            .inputs()
            .iter()
            .map(|name| {
                let id = find(name)?;
                let at = inputs.iter().position(|&input| input == id);
                at.with_context(|| format!("the golden model takes `{name}` for an input"))
            })
            .collect::<Result<Vec<_>>>()?;
        let compared = model.signals().iter().map(|name| find(name)).collect::<Result<Vec<_>>>()?;
        for id in outputs.iter().chain(&registers(design)) {
            let name = &design.net(*id).name;
            ensure!(compared.contains(id), "the golden model does not predict `{name}`");
        }
        let order = (!order.iter().copied().eq(0..inputs.len())).then_some(order);
        let stimulus = Stimulus::new(design, contract.operands(), 0);
        let operands = contract
            .operands()
            .iter()
            .map(|operand| {
                let at = stimulus.position(&operand.name);
                at.with_context(|| format!("the contract speaks of operand `{}`", operand.name))
            })
            .collect::<Result<Vec<_>>>()?;
        let position = |net: NetId| compared.iter().position(|&other| other == net);
        let handshake = design.handshake()?;
        let predicted = |net: NetId| {
            position(net).with_context(|| {
                format!("the golden model does not predict `{}`", design.net(net).name)
            })
        };
        let (busy, valid) = (predicted(handshake.busy)?, predicted(handshake.valid)?);
        let colours = contract.operands().iter().filter(|it| it.colour);
        ensure!(
            colours.clone().count() == contract.outputs().len(),
            "the contract has not one colour operand for each output"
        );
        let results = contract
            .outputs()
            .iter()
            .zip(colours)
            .map(|(name, colour)| {
                let net = find(name)?;
                let at = position(net);
                let at =
                    at.with_context(|| format!("the contract takes `{name}` for an output"))?;
                let format = design.net(net).format;
                let unit = exp2(-format.frac);
                Ok((Quantity { at, format, unit }, exp2(-colour.format.frac)))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Self {
            design,
            contract,
            model,
            outputs,
            order,
            compared,
            busy,
            valid,
            ports: Arc::new(Ports::new(design)),
            address: design.register(design.control.address).q,
            operands,
            drawn: contract.operands().to_vec(),
            results,
        })
    }

    /// Holds operands at raw values: combinations are of the others alone, and the stimulus seldom draws
    /// anything else.
    pub(super) fn holding(mut self, held: &[(String, i64)]) -> Self {
        for (name, raw) in held {
            let drawn = self.drawn.iter_mut().filter(|it| it.name == *name);
            drawn.for_each(|operand| operand.domain = (*raw, *raw));
        }
        let mut ports = Ports::new(self.design);
        ports.hold(held);
        self.ports = Arc::new(ports);
        self
    }

    /// The inputs of a seed.
    pub(super) fn stimulus(&self, seed: u64) -> Stimulus {
        let stimulus = Stimulus::new(self.design, &self.drawn, seed);
        match self.contract.length() {
            Some(length) => stimulus.with_length(length),
            None => stimulus,
        }
    }

    /// The combinations of operands at so many places, from the first on.
    pub(super) fn combinations(&self, first: u64, count: u64) -> Combinations {
        Combinations::new(self.ports.clone(), first, count)
    }

    /// A bound on the results of one computation.
    pub(super) fn longest(&self) -> u64 {
        let length = self.contract.length();
        let operands = self.contract.operands().iter();
        let operand = operands.filter(|operand| Some(operand.name.as_str()) == length);
        // A length of 0 is a result too.
        operand.map(|it| it.domain.1.unsigned_abs() + 1).max().unwrap_or(1)
    }

    /// How many registers a golden model must predict.
    pub(super) fn registers(&self) -> usize {
        registers(self.design).len()
    }

    /// The first signal on which simulation and model differ after the latest clock of a stream, if they
    /// do. `word` was executed at the edge.
    pub(super) fn mismatch(
        &self,
        stream: &Stream,
        word: u64,
        simulated: impl Fn(NetId) -> u64,
    ) -> Option<Mismatch> {
        let pairs = self.compared.iter().zip(stream.predicted());
        let differs = |(&net, &golden): (&NetId, &u64)| simulated(net) != golden;
        let at = pairs.clone().position(differs)?;
        let words = &self.design.control.words;
        let word = usize::try_from(word).ok().and_then(|word| words.get(word));
        Some(Mismatch {
            seed: stream.seed(),
            clock: stream.seen.clocks,
            signal: self.model.signals()[at].clone(),
            golden: stream.predicted()[at],
            simulated: simulated(self.compared[at]),
            word: word.map_or_else(String::new, |word| word.name.clone()),
        })
    }

    /// The operands of the computation that runs, raw, in the order of the contract; whether they are in
    /// the domain.
    pub(super) fn operands(&self, stimulus: &Stimulus, raw: &mut Vec<i64>) -> bool {
        raw.clear();
        raw.extend(self.operands.iter().map(|&at| stimulus.accepted(at)));
        let operands = self.contract.operands().iter();
        operands.zip(raw).all(|(operand, raw)| (operand.domain.0..=operand.domain.1).contains(raw))
    }

    /// The largest error of the results among these values, number `index` of the computation with these
    /// operands, if it is beyond `units`.
    pub(super) fn worse(
        &self,
        units: f64,
        operands: &[i64],
        index: u64,
        values: &[u64],
    ) -> Option<Worst> {
        let (control, colours) = operands.split_at(operands.len() - self.results.len());
        let f = self.contract.references(&self.contract.point(control, index));
        let mut largest = (units, None);
        for ((result, unit), &colour) in self.results.iter().zip(colours) {
            let colour = colour as f64 * unit;
            let units = nearer(result.value(values[result.at]), f.map(|f| f * colour));
            if units > largest.0 {
                largest = (units, Some(result.at));
            }
        }
        let (units, at) = largest;
        let names = self.contract.operands().iter().map(|it| it.name.clone());
        Some(Worst {
            units,
            output: self.model.signals()[at?].clone(),
            operands: names.zip(operands.iter().copied()).collect(),
        })
    }
}

/// The registers that a golden model must predict.
fn registers(design: &Design) -> Vec<NetId> {
    design
        .registers
        .iter()
        .filter(|register| register.kind != RegisterKind::Internal)
        .map(|register| register.q)
        .collect()
}
