//! Draws random valid configurations of a device, for tests.

use glint_base::config_error::ConfigError;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::problems::Problems;
use super::schema::{Key, KeyKind, Schema};
use super::values::{Config, Value};

/// The number of drawn configurations after which the search for a valid one fails.
const DRAWS: usize = 1000;
/// The largest number of times that keys with problems are drawn again in one configuration.
const REPAIRS: usize = 100;

/// Returns a random valid configuration of a device. The same `seed` always gives the same configuration, with a name such as
/// `dot_product_7`.
///
/// Integers, numbers, choices, flags and lists of the device are drawn from their ranges, or from the range of [`Key::drawn`].
/// The ends are drawn more often than other values. Texts, tables, keys that do not apply and the keys that every device shares
/// keep their defaults. If the device refuses a combination, the offending key is drawn again. `refusal` returns the error of a
/// configuration that the schema accepts and the device cannot have.
///
/// # Panics
///
/// Panics if the device refuses all 1000 configurations that are drawn.
pub fn sample(
    schema: &Schema,
    seed: u64,
    refusal: &dyn Fn(&Config) -> Option<ConfigError>,
) -> Config {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let name = format!("{}_{seed}", schema.device.replace('-', "_"));
    for _ in 0..DRAWS {
        let mut config = Config::defaults(schema, &name);
        for key in &schema.keys {
            config.set(key.name, draw(key, &mut rng));
        }
        for _ in 0..REPAIRS {
            config.reset_keys_without_effect(schema);
            let mut problems = Problems::default();
            (schema.check)(&config, &mut problems);
            if problems.is_empty()
                && let Some(error) = refusal(&config)
            {
                problems.push_error(error);
            }
            if problems.is_empty() {
                return config;
            }
            for problem in problems.iter() {
                match schema.key(&problem.error.key) {
                    Some(key) if config.applies(schema, key.name) => {
                        config.set(key.name, draw(key, &mut rng));
                    }
                    // A new value of another key would not help.
                    _ => {}
                }
            }
        }
    }
    panic!("no valid configuration of `{}` was found", schema.device)
}

fn draw(key: &Key, rng: &mut ChaCha8Rng) -> Value {
    match &key.kind {
        KeyKind::Integer { min, max } => {
            let (min, max) = key.drawn.unwrap_or((*min, *max));
            Value::Integer(integer(min, max, rng))
        }
        KeyKind::Number { min, max, or_zero } => {
            let drawn = number(*min, *max, rng);
            Value::Number(if *or_zero && drawn == *min { 0.0 } else { drawn })
        }
        KeyKind::Choice(options) => {
            let index = integer(0, options.len() as i64 - 1, rng) as usize;
            Value::Text(options[index].to_owned())
        }
        KeyKind::Flag => Value::Flag(rng.next_u32() & 1 == 1),
        // A different text or table would test nothing more.
        KeyKind::Text(_) | KeyKind::Table { .. } => key.default.clone(),
        KeyKind::Integers { min, max, len_min, len_max } => {
            let len = integer(*len_min as i64, *len_max as i64, rng);
            Value::Integers((0..len).map(|_| integer(*min, *max, rng)).collect())
        }
    }
}

/// Draws an integer. Each end has a probability of at least 1/8, and the rest is uniform.
fn integer(min: i64, max: i64, rng: &mut ChaCha8Rng) -> i64 {
    match rng.next_u32() % 8 {
        0 => min,
        1 => max,
        _ => {
            // The remainder favours small values by less than 2^-64 of the range's size.
            let size = (i128::from(max) - i128::from(min) + 1) as u128;
            (i128::from(min) + (u128::from(rng.next_u64()) % size) as i128) as i64
        }
    }
}

fn number(min: f64, max: f64, rng: &mut ChaCha8Rng) -> f64 {
    match rng.next_u32() % 8 {
        0 => min,
        1 => max,
        _ => {
            let unit = rng.next_u32() as f64 / u32::MAX as f64;
            (min * (1.0 - unit) + max * unit).clamp(min, max)
        }
    }
}
