//! Evaluates control lines, such as enables and the selects of muxes, for one microinstruction.

use super::{Design, Driver, Microinstruction, NetId, Op};
use glint_base::fixed::mask;

/// Returns the value of a control line while `microinstruction` is executed. Follows fields and constants through renaming,
/// slices, inverters, and bitwise `and` and `or`. Returns `None` if the value depends on anything else; but an `and` with an
/// operand 0 is 0.
pub fn setting_of(
    design: &Design,
    microinstruction: &Microinstruction,
    line: NetId,
) -> Option<u64> {
    let net = design.net(line);
    let of = |line: NetId| setting_of(design, microinstruction, line);
    match &net.driver {
        Driver::Field(field) => Some(microinstruction.values[field.index()]),
        Driver::Constant(bits) => Some(*bits),
        Driver::Op(Op::Relabel(a)) => of(*a),
        Driver::Op(Op::Slice { of: a, low }) => Some(of(*a)? >> low & mask(net.format.width())),
        Driver::Op(Op::Not(a)) => Some(!of(*a)? & mask(net.format.width())),
        Driver::Op(Op::Or(a, b)) => Some(of(*a)? | of(*b)?),
        Driver::Op(Op::And(a, b)) if of(*a) == Some(0) || of(*b) == Some(0) => Some(0),
        Driver::Op(Op::And(a, b)) => Some(of(*a)? & of(*b)?),
        _ => None,
    }
}

/// Returns the nets on which `net` depends within the clock of `microinstruction`. If the microinstruction determines the
/// select of a mux, the mux depends only on the chosen input.
pub fn passed_on(design: &Design, microinstruction: &Microinstruction, net: NetId) -> Vec<NetId> {
    if let Driver::Op(Op::Mux { select, inputs }) = &design.net(net).driver
        && let Some(chosen) = setting_of(design, microinstruction, *select)
    {
        return inputs.get(chosen as usize).or(inputs.last()).copied().into_iter().collect();
    }
    design.combinational_inputs(net)
}
