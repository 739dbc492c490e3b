//! Tests that the defaults of keys adapt to the keys that a file states. For example, `exponent.bits = 8` lowers the default of
//! `domain.exponent_max` to 255.

use glint::config::{Config, Key, KeyKind, Problems, Schema, Value, parse};
use glint::core::Core;
use glint::keys::presets::FUNCTION;
use glint::registry::{Device, Registry};

use crate::common::Sure;
use crate::common::cores::device;
use crate::common::files::{paths, read};
use crate::common::sample::sampled_by_name;
use crate::config_device::{lamp, schemas};

/// Reads a file of a device of the catalogue.
fn of(text: &str) -> Result<Config, Problems> {
    parse("core.toml", text, &Registry::shipped().schemas())
}

#[test]
fn a_narrower_exponent_ends_its_domain() {
    let devices =
        "rough threshold quadratic cosine-power schlick blinn gauss lyon quad-cosine".split(' ');
    for device in devices {
        let config = of(&format!("device = \"{device}\"\nexponent.bits = 8\n")).sure();
        // The largest of eight bits.
        assert_eq!(config.integer("domain.exponent_max"), 255, "{device}");
        assert_eq!(config.integer("exponent.bits"), 8, "{device}");
    }
    // And a larger domain widens the exponent: 2000 takes eleven bits.
    let config = of("device = \"cosine-power\"\ndomain.exponent_max = 2000\n").expect("valid");
    assert_eq!(config.integer("exponent.bits"), 11);
    // What needs no change has none.
    let config = of("device = \"cosine-power\"\nexponent.bits = 12\n").expect("valid");
    assert_eq!(config.integer("domain.exponent_max"), 1000);
}

#[test]
fn a_coarse_cosine_alone_is_a_valid_rough() {
    let config = of("device = \"rough\"\ncosine.fraction = 12\n").sure();
    assert_eq!(config.integer("cosine.fraction"), 12);
    // Two bits a range of twelve: the last of the default's nine ranges have no bits left.
    assert!(config.integers("sine.segments").len() <= 6, "{config:?}");
    Core::new(device("rough"), config).sure();
}

/// Every integer of every device, at either end of its range and alone, makes a configuration, or is itself what is wrong.
#[test]
fn one_key_can_be_changed_alone() {
    // A function's ends are searches of minutes.
    let catalogue = Registry::catalogue();
    let devices = catalogue.devices().iter().filter(|device| device.name != FUNCTION);
    let name_of = |device: &&Device| device.name.to_owned();
    for device in sampled_by_name("devices with one changed key", devices, name_of) {
        let schema = (device.schema)();
        for key in &schema.keys {
            let KeyKind::Integer { min, max } = key.kind else {
                continue;
            };
            for value in [min, max] {
                let given = vec![(key.name.to_owned(), Value::Integer(value))];
                let applies = Config::defaults(&schema, "core").applies(&schema, key.name);
                match Config::from_values(&schema, "core", given) {
                    Ok(config) => assert_eq!(config.integer(key.name), value),
                    Err(_) if !applies => {}
                    Err(problems) => {
                        let others =
                            problems.iter().filter(|problem| problem.error.key != key.name);
                        assert_eq!(
                            others.count(),
                            0,
                            "{} {} = {value}: {problems}",
                            device.name,
                            key.name
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_given_stays_and_the_nearest_follows() {
    let parsed = |text: &str| parse("lamp.toml", &format!("device = \"lamp\"\n{text}"), &schemas());
    // The table has no more address bits than the cosine: 12 comes down to 8, not further.
    let config = parsed("cosine.fraction = 8\n").expect("valid");
    assert_eq!((config.integer("cosine.fraction"), config.integer("sine.address")), (8, 8));
    // The other way about.
    let mut schema = lamp();
    schema.keys[2].default = Value::Integer(9);
    let given = vec![("sine.address".to_owned(), Value::Integer(11))];
    let config = Config::from_values(&schema, "lamp", given).expect("valid");
    assert_eq!(config.integer("cosine.fraction"), 11);
    // Both given: nothing may follow.
    let problems = parsed("cosine.fraction = 8\nsine.address = 9\n").expect_err("a problem");
    assert_eq!(
        problems.iter().map(|it| it.error.key.as_str()).collect::<Vec<_>>(),
        ["sine.address"]
    );
}

/// A word does not follow; the message names it and says where its value comes from.
#[test]
fn a_problem_of_a_key_that_is_not_given_names_it() {
    let schema = Schema {
        device: "meter",
        keys: vec![
            Key::choice("scale", "linear", &["linear", "log"], "How values are shown."),
            Key::integer("range", 10, 1..=99, "The largest value."),
        ],
        check: |config, problems| {
            if config.choice("scale") == "linear" && config.integer("range") > 50 {
                problems.push("scale", "a linear scale ends at 50", "\"log\", or a smaller range");
            }
        },
    };
    let problems = parse("meter.toml", "device = \"meter\"\nrange = 60\n", &[schema]);
    let text = problems.expect_err("a problem").to_string();
    assert!(
        text.contains("`scale` is not set and has the default \"linear\": a linear scale"),
        "{text}"
    );
    assert!(text.contains("meter.toml"), "{text}");
}

/// Values that follow are written into the file that others read.
#[test]
fn shipped_configurations_follow_from_nothing() {
    for path in paths("configs", ".toml") {
        let config = of(&read(&path)).sure_of(&path);
        let schema = (device(&config.device).schema)();
        let again = of(&config.to_toml(&schema)).sure_of(&path);
        assert_eq!(again.values().collect::<Vec<_>>(), config.values().collect::<Vec<_>>());
    }
}
