use crate::config::{Config, Value};
use crate::cosim::Lockstep;
use crate::registry::{Device, Registry};

/// The default configuration of a device with these keys.
fn pipelined(device: &Device, keys: &[(&str, Value)]) -> Config {
    let mut values = vec![("architecture".to_owned(), Value::Text("pipelined".to_owned()))];
    values.extend(keys.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
    Config::from_values(&(device.schema)(), "device", values).expect("keys that there are")
}

/// The devices that compute a point at a time.
fn devices() -> Vec<Device> {
    let registry = Registry::catalogue();
    let lines = ["quad-cosine", "cosine-squared"];
    registry.devices().iter().filter(|it| !lines.contains(&it.name)).copied().collect()
}

#[test]
fn every_device_is_what_its_golden_model_says() {
    for device in devices() {
        let config = pipelined(&device, &[]);
        let design = device.design(&config).unwrap_or_else(|wrong| panic!("{wrong}"));
        let contract = (device.contract)(&config);
        let lockstep =
            Lockstep::new(&design, (device.model)(&config), contract.as_ref(), 1).unwrap();
        let outcome = lockstep.run_alone(500).unwrap();
        assert_eq!(outcome.mismatch, None, "{}", device.name);
        assert!(outcome.registers > 0, "{}", device.name);
    }
}

/// Those of every key of `[pipeline]`: the side channel is compared too.
#[test]
fn a_pipeline_with_a_side_channel_or_without_stalls_is_what_its_golden_model_says() {
    let registry = Registry::catalogue();
    let device = registry.device("cosine-power").expect("a device");
    let (stall, side) = ("pipeline.stall", "pipeline.side");
    let none = || Value::Text("none".to_owned());
    let keys: [&[(&str, Value)]; 4] = [
        &[(side, Value::Integer(1))],
        &[(side, Value::Integer(64))],
        &[(stall, none())],
        &[(stall, none()), (side, Value::Integer(17)), ("pipeline.stages", Value::Integer(1))],
    ];
    for keys in keys {
        let config = pipelined(device, keys);
        let design = device.design(&config).unwrap_or_else(|wrong| panic!("{wrong}"));
        let contract = (device.contract)(&config);
        let lockstep =
            Lockstep::new(&design, (device.model)(&config), contract.as_ref(), 1).unwrap();
        let outcome = lockstep.run_alone(500).unwrap();
        assert_eq!(outcome.mismatch, None, "{keys:?}");
    }
}

/// A side value that stays behind, or goes ahead, is noticed.
#[test]
fn a_wrong_side_value_is_noticed() {
    let registry = Registry::catalogue();
    let device = registry.device("cosine-power").expect("a device");
    let config = pipelined(device, &[("pipeline.side", Value::Integer(8))]);
    let mut design = device.design(&config).unwrap_or_else(|wrong| panic!("{wrong}"));
    let [before, q] = design.pipeline.as_ref().expect("a pipeline").side_values[..2] else {
        panic!("two stages")
    };
    let next = design.registers.iter().find(|it| it.data == Some(q)).expect("a stage more").q;
    let wrong = design.registers.iter_mut().find(|it| it.q == next).expect("it");
    wrong.data = Some(before);
    let contract = (device.contract)(&config);
    let lockstep = Lockstep::new(&design, (device.model)(&config), contract.as_ref(), 1).unwrap();
    let mismatch = lockstep.run_alone(500).unwrap().mismatch.expect("a difference");
    assert_eq!(mismatch.signal, "side_out");
}
