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
