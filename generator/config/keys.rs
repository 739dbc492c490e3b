//! Declares configuration keys as a struct's fields, which the hardware description and the golden model of a device both read.

use super::schema::Key;
use super::values::{Config, TableEntries};
use glint_base::fixed::Rounding;

/// A type of fields in a struct that [`keys!`](macro@crate::keys) declares.
pub trait Setting: Sized {
    /// Reads the field's value from `config`. `keys` are the configuration keys of the field, at least one. Panics if `config`
    /// lacks the keys, or has values of another type.
    fn read(config: &Config, keys: &[Key]) -> Self;
}

/// Declares a struct whose fields are configuration keys. Its function `keys` returns the keys for a [`Schema`](super::Schema),
/// in the order of the fields. Its function `of` reads the values of these keys from a configuration. `of` panics if the
/// configuration belongs to a device without these keys. Each field has a [`Key`], or is another such struct with several keys.
///
/// ```
/// use glint_config::{Config, Key, Schema};
/// use glint_base::fixed::Rounding;
///
/// glint_config::keys! {
///     struct Keys {
///         fraction: u32 = Key::integer("x.fraction", 12, 4..=20, "Fraction bits of x."),
///         rounding: Rounding = Key::rounding("x.rounding", "nearest", "How x is rounded."),
///     }
/// }
///
/// let schema = Schema { device: "lamp", keys: Keys::keys(), check: |_, _| {} };
/// let keys = Keys::of(&Config::defaults(&schema, "lamp"));
/// assert_eq!((keys.fraction, keys.rounding), (12, Rounding::Nearest));
/// ```
#[macro_export]
macro_rules! keys {
    (
        $(#[$about:meta])* $visible:vis struct $Keys:ident {
            $($(#[$doc:meta])* $field:ident: $type:ty = $key:expr),* $(,)?
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq)]
        $visible struct $Keys { $($(#[$doc])* $visible $field: $type),* }

        impl $Keys {
            /// Returns the keys, in the order in which a written file shows them.
            $visible fn keys() -> Vec<$crate::Key> {
                let mut keys = Vec::new();
                $(keys.extend(Vec::<$crate::Key>::from($key));)*
                keys
            }

            /// Reads a configuration's values.
            $visible fn of(config: &$crate::Config) -> Self {
                Self { $($field: $crate::Setting::read(config, &Vec::from($key))),* }
            }
        }

        impl $crate::Setting for $Keys {
            fn read(config: &$crate::Config, _: &[$crate::Key]) -> Self {
                Self::of(config)
            }
        }
    };
}

/// Declares an enum whose variants are the words of a choice ([`Key::choice`](super::Key::choice)), as the type of a field in
/// [`keys!`](macro@crate::keys).
#[macro_export]
macro_rules! choices {
    (
        $(#[$about:meta])* $visible:vis enum $Choice:ident {
            $($(#[$doc:meta])* $Variant:ident = $word:literal),* $(,)?
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visible enum $Choice { $($(#[$doc])* $Variant),* }

        impl $Choice {
            /// The words, in order.
            $visible const WORDS: &'static [&'static str] = &[$($word),*];
        }

        impl $crate::Setting for $Choice {
            fn read(config: &$crate::Config, keys: &[$crate::Key]) -> Self {
                match config.choice(keys[0].name) {
                    $($word => Self::$Variant,)*
                    other => unreachable!("`{}` = {other}", keys[0].name),
                }
            }
        }
    };
}

impl From<Key> for Vec<Key> {
    fn from(key: Key) -> Self {
        vec![key]
    }
}

impl Key {
    /// Returns a key with the choices `"truncate"` and `"nearest"`.
    pub fn rounding(name: &'static str, default: &'static str, doc: &'static str) -> Self {
        Self::choice(name, default, &["truncate", "nearest"], doc)
    }
}

impl Setting for Rounding {
    fn read(config: &Config, keys: &[Key]) -> Self {
        match config.choice(keys[0].name) {
            "nearest" => Self::Nearest,
            _ => Self::Truncate,
        }
    }
}

impl Setting for i64 {
    fn read(config: &Config, keys: &[Key]) -> Self {
        config.integer(keys[0].name)
    }
}

/// The key's range must exclude negative values.
impl Setting for u32 {
    fn read(config: &Config, keys: &[Key]) -> Self {
        u32::try_from(config.integer(keys[0].name)).expect("no negative number")
    }
}

impl Setting for Vec<u32> {
    fn read(config: &Config, keys: &[Key]) -> Self {
        let entries = config.integers(keys[0].name).iter();
        entries.map(|&entry| u32::try_from(entry).expect("no negative number")).collect()
    }
}

impl Setting for TableEntries {
    fn read(config: &Config, keys: &[Key]) -> Self {
        config.records(keys[0].name).clone()
    }
}

impl Setting for f64 {
    fn read(config: &Config, keys: &[Key]) -> Self {
        config.number(keys[0].name)
    }
}

/// A text, or a choice's word.
impl Setting for String {
    fn read(config: &Config, keys: &[Key]) -> Self {
        config.text(keys[0].name).to_owned()
    }
}

impl Setting for bool {
    fn read(config: &Config, keys: &[Key]) -> Self {
        config.flag(keys[0].name)
    }
}
