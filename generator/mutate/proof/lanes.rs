//! Cells over many values at once.

use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, NetId, Op};

/// Values that are evaluated together.
pub(super) const LANES: usize = 512;

/// A net in all lanes.
pub(super) type Lanes = [u64; LANES];

fn one(a: &Lanes, cell: impl Fn(u64) -> u64) -> Lanes {
    std::array::from_fn(|lane| cell(a[lane]))
}

fn two(a: &Lanes, b: &Lanes, cell: impl Fn(u64, u64) -> u64) -> Lanes {
    std::array::from_fn(|lane| cell(a[lane], b[lane]))
}

/// The bits of a signed net of this width, as a number.
fn signed(width: u32) -> impl Fn(u64) -> i64 {
    let drop = 64 - width;
    move |bits| (bits << drop) as i64 >> drop
}

/// The result of a cell so wide, as [`Op`] documents it.
pub(super) fn cell<'a>(
    design: &Design,
    op: &Op,
    width: u32,
    of: &impl Fn(NetId) -> &'a Lanes,
) -> Lanes {
    let all = mask(width);
    let is_signed = |net: NetId| design.net(net).format.signed;
    match op {
        Op::Relabel(a) => *of(*a),
        Op::Extend(a) if is_signed(*a) => {
            let number = signed(design.width(*a));
            one(of(*a), |a| number(a) as u64 & all)
        }
        Op::Extend(a) => *of(*a),
        Op::Slice { of: a, low } => one(of(*a), |a| a >> low & all),
        Op::Concat(parts) => parts.iter().fold([0; LANES], |sum, part| {
            let width = design.width(*part);
            two(&sum, of(*part), |sum, part| sum.checked_shl(width).unwrap_or(0) | part)
        }),
        Op::Not(a) => one(of(*a), |a| !a & all),
        Op::And(a, b) => two(of(*a), of(*b), |a, b| a & b),
        Op::Or(a, b) => two(of(*a), of(*b), |a, b| a | b),
        Op::Xor(a, b) => two(of(*a), of(*b), |a, b| a ^ b),
        Op::Add { a, b, carry } => {
            let sum = two(of(*a), of(*b), |a, b| a.wrapping_add(b));
            let carry = carry.map_or(&[0; LANES], of);
            two(&sum, carry, |sum, carry| sum.wrapping_add(carry) & all)
        }
        Op::Sub(a, b) => two(of(*a), of(*b), |a, b| a.wrapping_sub(b) & all),
        Op::Mul(a, b) if is_signed(*a) => {
            let (x, y) = (signed(design.width(*a)), signed(design.width(*b)));
            two(of(*a), of(*b), |a, b| x(a).wrapping_mul(y(b)) as u64 & all)
        }
        Op::Mul(a, b) => two(of(*a), of(*b), |a, b| a.wrapping_mul(b) & all),
        Op::Equal(a, b) => two(of(*a), of(*b), |a, b| u64::from(a == b)),
        Op::Less(a, b) if is_signed(*a) => {
            let number = signed(design.width(*a));
            two(of(*a), of(*b), |a, b| u64::from(number(a) < number(b)))
        }
        Op::Less(a, b) => two(of(*a), of(*b), |a, b| u64::from(a < b)),
        Op::Any(a) => one(of(*a), |a| u64::from(a != 0)),
        Op::All(a) => {
            let whole = mask(design.width(*a));
            one(of(*a), |a| u64::from(a == whole))
        }
        Op::Mux { select, inputs } => {
            let last = inputs.len() - 1;
            let mut out = *of(inputs[last]);
            for (at, input) in inputs[..last].iter().enumerate() {
                let taken =
                    two(
                        of(*select),
                        of(*input),
                        |select, input| {
                            if select == at as u64 { input } else { 0 }
                        },
                    );
                let kept =
                    two(of(*select), &out, |select, out| if select == at as u64 { 0 } else { out });
                out = two(&taken, &kept, |a, b| a | b);
            }
            out
        }
    }
}
