//! Finds the ports of a simulated design: the handshake by role, and the operands and results by the names in the contract.

use anyhow::{Context, Result, ensure};

use glint_base::fixed::{Format, mask};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, NetId, Role};

/// An input port is given by its index among the design's inputs, an output port by its net.
#[derive(Clone, Debug)]
pub(super) struct Ports {
    pub(super) inputs: usize,
    pub(super) reset: usize,
    /// The port `start`, or `in_valid` if the design is a pipeline.
    pub(super) start: usize,
    pub(super) out_ready: Option<usize>,
    /// The input `side_in` of a pipeline, with a mask of its bits.
    pub(super) side_in: Option<(usize, u64)>,
    /// The operands of the contract, in the order of the design.
    pub(super) operands: Vec<OperandPort>,
    pub(super) valid: NetId,
    /// A pipeline has neither `busy` nor `done`.
    pub(super) busy: Option<NetId>,
    pub(super) done: Option<NetId>,
    /// Whether the core takes a `start` in the clock in which `done` is high.
    pub(super) overlaps: bool,
    pub(super) side_out: Option<NetId>,
    /// The result outputs, in the order of `Contract::outputs`.
    pub(super) results: Vec<(NetId, Format)>,
}

#[derive(Clone, Debug)]
pub(super) struct OperandPort {
    pub(super) name: String,
    pub(super) data: usize,
    /// The index of the operand's strobe among the inputs. A pipeline takes all operands at once, by `in_valid`.
    pub(super) strobe: usize,
    pub(super) format: Format,
    /// The index of the operand in the contract.
    pub(super) at: usize,
}

impl OperandPort {
    /// `raw` has the raw values of all operands, in the order of `Contract::operands`.
    #[inline]
    pub(super) fn pattern(&self, raw: &[i64]) -> u64 {
        raw[self.at] as u64 & mask(self.format.width())
    }

    /// `inputs` has the bit patterns of all inputs of the design.
    #[inline]
    pub(super) fn raw(&self, inputs: &[u64]) -> i64 {
        self.format.raw(inputs[self.data]) as i64
    }
}

impl Ports {
    /// Fails if the design lacks a port of the handshake or an output of the contract, or if the strobe of an operand is not an
    /// input. Also fails if design and contract have different operands.
    pub(super) fn new(design: &Design, contract: &dyn Contract) -> Result<Self> {
        let pipelined = design.pipeline.is_some();
        let find = |role: Role| design.port(|other| other == role).map(|port| port.net);
        let input = |role: Role| design.inputs().position(|port| port.role == role);
        let lacks = |name: &str| format!("`{}` has no port `{name}`", design.name);
        let (start_port, start_name, valid_name) = if pipelined {
            (input(Role::InValid), "in_valid", "out_valid")
        } else {
            (input(Role::Start), "start", "valid")
        };
        let start = start_port.with_context(|| lacks(start_name))?;
        let mut operands = Vec::new();
        for (data, port) in design.inputs().enumerate() {
            let strobe = match port.role {
                Role::Operand { strobe } => design.input_position(strobe)?,
                Role::Point => start,
                _ => continue,
            };
            let net = design.net(port.net);
            let name = net.name.clone();
            let place = contract.operands().iter().position(|operand| operand.name == name);
            let at = place.with_context(|| {
                format!("the design has an operand `{name}`, and the contract does not")
            })?;
            operands.push(OperandPort { name, data, strobe, format: net.format, at });
        }
        for operand in contract.operands() {
            let found = operands.iter().any(|port| port.name == operand.name);
            ensure!(
                found,
                "the contract has an operand `{}`, and the design does not",
                operand.name
            );
        }
        let mut results = Vec::new();
        for output in contract.outputs() {
            let net = design.find(&output.name).with_context(|| lacks(&output.name))?;
            results.push((net, design.net(net).format));
        }
        let side = design.pipeline.as_ref().map(|pipeline| mask(pipeline.side));
        let core = if pipelined { None } else { Some(design.handshake()?) };
        Ok(Self {
            inputs: design.inputs().count(),
            reset: input(Role::Reset).with_context(|| lacks("rst_n"))?,
            start,
            out_ready: input(Role::OutReady),
            side_in: input(Role::SideIn).zip(side),
            operands,
            valid: find(Role::Valid).with_context(|| lacks(valid_name))?,
            busy: core.as_ref().map(|it| it.busy),
            done: core.as_ref().map(|it| it.done),
            overlaps: !pipelined && design.control.overlaps,
            side_out: find(Role::SideOut),
            results,
        })
    }
}
