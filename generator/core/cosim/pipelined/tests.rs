use crate::cosim::{Lockstep, Outcome};
use crate::registry::{Device, OpenedConfig, Registry};
use glint_config::{Config, Value};

fn pipelined(device: &Device, keys: &[(&str, Value)]) -> OpenedConfig {
    let mut values = vec![("architecture".to_owned(), Value::Text("pipelined".to_owned()))];
    values.extend(keys.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
    let config = Config::from_values(&(device.schema)(), "device", values);
    device.open(config.expect("keys that there are")).expect("keys that can be opened")
}

fn outcome(device: &Device, keys: &[(&str, Value)], points: u64) -> Outcome {
    let opened = pipelined(device, keys);
    let design = opened.design().unwrap_or_else(|wrong| panic!("{wrong}"));
    let contract = opened.contract();
    let lockstep = Lockstep::new(&design, opened.golden(), contract.as_ref(), 1).unwrap();
    lockstep.run_alone(points).unwrap()
}

fn devices() -> Vec<Device> {
    let registry = Registry::catalogue();
    let lines = ["quad-cosine", "cosine-squared"];
    registry.devices().iter().filter(|it| !lines.contains(&it.name)).copied().collect()
}

#[test]
fn every_device_is_what_its_golden_model_says() {
    for device in devices() {
        let outcome = outcome(&device, &[], 500);
        assert_eq!(outcome.mismatch, None, "{}", device.name);
        assert!(outcome.registers > 0, "{}", device.name);
    }
}

/// Tests pipelines that take a point only every few clocks. Such a pipeline has fewer multipliers, registers that hold values,
/// and one clock in each interval in which it takes a point.
#[test]
fn every_device_with_shared_multipliers_is_what_its_golden_model_says() {
    let interval = |clocks: u32| ("pipeline.interval", Value::Text(clocks.to_string()));
    for device in devices() {
        for keys in [
            &[interval(2)][..],
            &[interval(3), ("pipeline.side", Value::Integer(9))],
            &[interval(4), ("pipeline.stall", Value::Text("none".to_owned()))],
            &[interval(4), ("pipeline.multipliers", Value::Text("registered".to_owned()))],
        ] {
            let outcome = outcome(&device, keys, 200);
            assert_eq!(outcome.mismatch, None, "{} {keys:?}", device.name);
            assert!(outcome.registers > 0 && outcome.clocks >= 400, "{}", device.name);
        }
    }
}

/// Tries every key of `[pipeline]`. The side channel is compared too.
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
        assert_eq!(outcome(device, keys, 500).mismatch, None, "{keys:?}");
    }
}

/// A side value that comes a clock too late or too early is noticed.
#[test]
fn a_wrong_side_value_is_noticed() {
    let registry = Registry::catalogue();
    let device = registry.device("cosine-power").expect("a device");
    let opened = pipelined(device, &[("pipeline.side", Value::Integer(8))]);
    let mut design = opened.design().unwrap_or_else(|wrong| panic!("{wrong}"));
    let [before, q] = design.pipeline.as_ref().expect("a pipeline").side_values[..2] else {
        panic!("two stages")
    };
    let next = design.registers.iter().find(|it| it.data == Some(q)).expect("a stage more").q;
    let wrong = design.registers.iter_mut().find(|it| it.q == next).expect("it");
    wrong.data = Some(before);
    let contract = opened.contract();
    let lockstep = Lockstep::new(&design, opened.golden(), contract.as_ref(), 1).unwrap();
    let mismatch = lockstep.run_alone(500).unwrap().mismatch.expect("a difference");
    assert_eq!(mismatch.signal, "side_out");
}

/// Every point of a list comes out, in the order of the list, after the drawn points. No point of the list is withdrawn or lost
/// in a reset.
#[test]
fn a_recording_goes_through_every_point_of_a_list() {
    let registry = Registry::catalogue();
    let device = registry.device("cosine-power").expect("a device");
    let opened = pipelined(device, &[]);
    let design = opened.design().unwrap_or_else(|wrong| panic!("{wrong}"));
    let contract = opened.contract();
    let lockstep = Lockstep::new(&design, opened.golden(), contract.as_ref(), 1).unwrap();
    // Colours count upward, so that each differs from the one before.
    let point = |number: i64| -> Vec<i64> {
        let operands = contract.operands().iter();
        operands.map(|it| if it.colour { number % 256 } else { it.domain.1 }).collect()
    };
    let listed: Vec<Vec<i64>> = (0..300).map(point).collect();
    let vectors = lockstep.record(40, &listed).unwrap();
    let names: Vec<&str> = design.inputs().map(|port| design.net(port.net).name.as_str()).collect();
    let at = |name: &str| names.iter().position(|it| *it == name).expect("a port");
    let [valid, red, reset] = ["in_valid", "red", "rst_n"].map(at);
    let outputs: Vec<&str> =
        design.outputs().map(|port| design.net(port.net).name.as_str()).collect();
    let ready = outputs.iter().position(|it| *it == "in_ready").expect("a port");
    let clocks = vectors.inputs.iter().zip(&vectors.expected);
    let taken = clocks.filter(|(inputs, outputs)| inputs[valid] == 1 && outputs[ready] == 1);
    let taken: Vec<u64> = taken.map(|(inputs, _)| inputs[red]).collect();
    let last: Vec<u64> = listed.iter().map(|point| (point[point.len() - 1] % 256) as u64).collect();
    assert_eq!(taken[taken.len() - 300..], last);
    let end = &vectors.inputs[vectors.inputs.len() - 300..];
    assert!(end.iter().all(|inputs| inputs[reset] == 1));
}
