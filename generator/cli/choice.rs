//! Parses arguments that are one of a few words, such as `--target ecp5`, and prints the words with their meanings in `--help`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glint_prove::tune::{ErrorUnit, Objective};
use glint_show::figures::{TARGETS, Target};
use glint_show::render::BuiltIn;

/// A word, the value that it selects, and its meaning for `--help`.
type Choice<T> = (&'static str, T, &'static str);

fn one_of<T: Copy + Send + Sync + 'static>(
    choices: Vec<Choice<T>>,
) -> impl TypedValueParser<Value = T> {
    let mut words = Vec::with_capacity(choices.len());
    for (word, _, help) in &choices {
        words.push(PossibleValue::new(*word).help(*help));
    }
    PossibleValuesParser::new(words).map(move |given| {
        let is_given = |choice: &&Choice<T>| choice.0 == given;
        choices.iter().find(is_given).expect("clap accepts these words only").1
    })
}

pub fn target() -> impl TypedValueParser<Value = Target> {
    one_of(TARGETS.map(|target| (target.name(), target, target.title())).to_vec())
}

pub fn error_unit() -> impl TypedValueParser<Value = ErrorUnit> {
    one_of(vec![
        ("f", ErrorUnit::F, "The reflectance f, from 0 to 1"),
        ("output", ErrorUnit::Output, "An output's least significant bit"),
    ])
}

pub fn objective() -> impl TypedValueParser<Value = Objective> {
    const AREA: &str = "The area in look-up tables; a DSP block or a block RAM counts as the number of \
                        look-up tables that the chip has per such block";
    one_of(vec![
        ("area", Objective::Area, AREA),
        ("luts", Objective::Luts, "Look-up tables"),
        (
            "dsps",
            Objective::Dsps,
            "The number of DSP blocks; of two equal numbers, the one with the smaller area",
        ),
        (
            "memory",
            Objective::Memory,
            "The number of bits in the ROMs; of two equal numbers, the one with the smaller area",
        ),
    ])
}

pub fn shape() -> impl TypedValueParser<Value = BuiltIn> {
    one_of(vec![
        ("sphere", BuiltIn::Sphere, "A ball"),
        ("torus", BuiltIn::Torus, "A ring"),
        ("vase", BuiltIn::Vase, "A vase"),
        ("group", BuiltIn::Group, "A vase, a ball and a ring"),
    ])
}
