//! What of a golden model belongs to what of a design.

use anyhow::{Context, Result, anyhow, ensure};

use super::lockstep::{Mismatch, Worst};
use super::stimulus::Stimulus;
use crate::golden::{Contract, Model, nearer};
use crate::netlist::{Design, NetId, RegisterKind, Role};

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
    pub(super) busy: NetId,
    pub(super) valid: NetId,
    /// The address of the microprogram.
    pub(super) address: NetId,
    /// The operands of the contract, as positions in the stimulus.
    operands: Vec<usize>,
    colours: usize,
    results: Vec<NetId>,
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
        let compared = model
            .signals()
            .iter()
            .map(|name| find(name))
            .collect::<Result<Vec<_>>>()?;
        for id in outputs.iter().chain(&registers(design)) {
            let name = &design.net(*id).name;
            ensure!(
                compared.contains(id),
                "the golden model does not predict `{name}`"
            );
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
        let role = |wanted: fn(Role) -> bool| design.port(wanted).map(|port| port.net);
        let busy = role(|role| role == Role::Busy).context("the design has no output `busy`")?;
        let valid = role(|role| role == Role::Valid).context("the design has no output `valid`")?;
        let results = contract
            .outputs()
            .iter()
            .map(|name| find(name))
            .collect::<Result<Vec<_>>>()?;
        let colours = contract.operands().iter().filter(|it| it.colour).count();
        Ok(Self {
            design,
            contract,
            model,
            outputs,
            order,
            compared,
            busy,
            valid,
            address: design.register(design.control.address).q,
            operands,
            colours,
            results,
        })
    }

    /// The inputs of a seed.
    pub(super) fn stimulus(&self, seed: u64) -> Stimulus {
        let stimulus = Stimulus::new(self.design, self.contract.operands(), seed);
        match self.contract.length() {
            Some(length) => stimulus.with_length(length),
            None => stimulus,
        }
    }

    /// A bound on the results of one computation.
    pub(super) fn longest(&self) -> u64 {
        let length = self.contract.length();
        let operands = self.contract.operands().iter();
        let operand = operands.filter(|operand| Some(operand.name.as_str()) == length);
        // A length of 0 is a result too.
        operand
            .map(|it| it.domain.1.unsigned_abs() + 1)
            .max()
            .unwrap_or(1)
    }

    /// How many registers a golden model must predict.
    pub(super) fn registers(&self) -> usize {
        registers(self.design).len()
    }

    /// The first signal on which they differ, if they do, given what each signal carries in the
    /// simulation and in the model. `word` was executed at the edge.
    pub(super) fn mismatch(
        &self,
        clock: u64,
        word: u64,
        simulated: impl Fn(NetId) -> u64,
        golden: &[u64],
    ) -> Option<Mismatch> {
        let pairs = self.compared.iter().zip(golden);
        let differs = |&(at, (&net, &golden)): &(usize, (&NetId, &u64))| {
            let simulated = simulated(net);
            (simulated != golden).then(|| Mismatch {
                seed: 0,
                clock,
                signal: self.model.signals()[at].clone(),
                golden,
                simulated,
                word: usize::try_from(word)
                    .ok()
                    .and_then(|word| self.design.control.words.get(word))
                    .map_or_else(String::new, |word| word.name.clone()),
            })
        };
        pairs.enumerate().find_map(|pair| differs(&pair))
    }

    /// The largest error of the results that are on the outputs now, number `index` of their
    /// computation, if it is beyond `units`; none where the operands are not in the domain.
    pub(super) fn worse(
        &self,
        units: f64,
        index: u64,
        stimulus: &Stimulus,
        output: impl Fn(NetId) -> u64,
    ) -> Option<Worst> {
        let operands = self.contract.operands();
        let raw = |at: usize| stimulus.accepted(self.operands[at]);
        let inside = operands
            .iter()
            .enumerate()
            .all(|(at, operand)| (operand.domain.0..=operand.domain.1).contains(&raw(at)));
        if !inside {
            return None;
        }
        let control = operands.len() - self.colours;
        let values: Vec<i64> = (0..control).map(raw).collect();
        let f = self
            .contract
            .references(&self.contract.point(&values, index));
        let mut largest = (units, None);
        for (at, &net) in self.results.iter().enumerate() {
            let colour = &operands[control + at];
            let colour = colour.format.to_f64(i128::from(raw(control + at)));
            let format = self.design.net(net).format;
            let out = format.to_f64(format.raw(output(net)));
            let units = nearer(out, f.map(|f| f * colour));
            if units > largest.0 {
                largest = (units, Some(net));
            }
        }
        let (units, net) = largest;
        Some(Worst {
            units,
            output: self.design.net(net?).name.clone(),
            operands: operands
                .iter()
                .enumerate()
                .map(|(at, operand)| (operand.name.clone(), raw(at)))
                .collect(),
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
