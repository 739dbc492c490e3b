//! Builds a chain of mirrors, which are choices between v and c − v, with a single adder ([`MirrorChain`]).

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_plan::{ExpressionPlan, MirrorChain, NodeId};
use glint_rtl::dsl::{Designer, Signal};

/// Builds the chain; its value may be wider than the format of its last node. `signal` returns the signal of a node that is
/// already built.
pub(super) fn mirrored<'d>(
    chain: &MirrorChain,
    d: &'d Designer,
    plan: &ExpressionPlan,
    name: &str,
    signal: &dyn Fn(NodeId) -> Signal<'d>,
) -> Signal<'d> {
    let frac = chain.fraction_bits(plan);
    let mut conditions = Vec::new();
    for mirror in &chain.mirrors {
        conditions.push(signal(mirror.condition));
    }
    let bases = chain.bases(plan, frac);
    let base = match chain.addend {
        Some(addend) => {
            let base = signal(addend).with_fraction(frac);
            match bases.iter().all(|constant| *constant == 0) {
                true => base,
                false => {
                    let constant =
                        chosen_base(d, &format!("{name}_base"), &bases, frac, &conditions);
                    d.add(&format!("{name}_base_sum"), base, constant)
                }
            }
        }
        None => chosen_base(d, &format!("{name}_base"), &bases, frac, &conditions),
    };
    let mut is_negative = conditions[0];
    for (number, condition) in conditions.iter().enumerate().skip(1) {
        is_negative = d.xor(&format!("{name}_is_negative{number}"), is_negative, *condition);
    }
    // −v equals ~v with a carry into the sum.
    let [value, inverted] = match chain.choice {
        Some((condition, cases)) => {
            let cases = cases.map(|case| signal(case).as_signed().with_fraction(frac));
            let inverted = [
                d.not(&format!("{name}_zero_inverted"), cases[0]),
                d.not(&format!("{name}_one_inverted"), cases[1]),
            ];
            let condition = signal(condition);
            [
                d.choose(&format!("{name}_chosen"), condition, cases),
                d.choose(&format!("{name}_inverted_chosen"), condition, inverted),
            ]
        }
        None => {
            let value = signal(chain.start).as_signed().with_fraction(frac);
            [value, d.not(&format!("{name}_inverted"), value)]
        }
    };
    let value = d.choose(&format!("{name}_mirrored"), is_negative, [value, inverted]);
    let sum = d.add_carry(&format!("{name}_sum"), base, value, is_negative);
    match chain.rounded {
        Some(node) => {
            let format = plan.node(node).format;
            d.narrow(name, sum, format, Rounding::Truncate, Overflow::Wrap)
        }
        None => sum,
    }
}

/// Chooses a constant by the conditions from `bases`, in which bit 0 of an index is the first condition. Equal constants share
/// one net.
fn chosen_base<'d>(
    d: &'d Designer,
    name: &str,
    bases: &[i128],
    frac: i32,
    conditions: &[Signal<'d>],
) -> Signal<'d> {
    let mut row = Vec::new();
    for (number, raw) in bases.iter().enumerate() {
        let same = bases.iter().position(|other| other == raw).unwrap_or(number);
        let constant = match same < number {
            true => row[same],
            false => {
                d.raw_constant(&format!("{name}{number}"), *raw, Format::holding(*raw, *raw, frac))
            }
        };
        row.push(constant);
    }
    for (number, condition) in conditions.iter().enumerate() {
        let mut next = Vec::new();
        for (place, pair) in row.chunks(2).enumerate() {
            let is_same = pair[0].name() == pair[1].name();
            next.push(match is_same {
                true => pair[0],
                false => {
                    let level = format!("{name}_of{number}_{place}");
                    d.choose(&level, *condition, [pair[0], pair[1]])
                }
            });
        }
        row = next;
    }
    row[0]
}
