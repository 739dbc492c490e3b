//! The structure of pipelines that come with Glint: nothing overtakes anything.
//!
//! With the proof by induction that the stages have points where a queue has them, this is why no result is of
//! another point.

use glint::hdl::netlist::{Driver, NetId, Role};

use crate::common::cores::all_configurations;

#[test]
fn values_of_a_stage_are_made_of_values_of_this_stage_and_all_registers_move_together() {
    let mut seen = 0;
    for (path, unit) in all_configurations() {
        let design = &unit.design;
        let Some(pipeline) = &design.pipeline else { continue };
        seen += 1;
        let Driver::Register(first) = design.net(pipeline.valid[0]).driver else {
            panic!("{path}: stage 1 does not remember whether it has a point")
        };
        let advance = design.register(first).enable;
        assert_eq!(advance.is_some(), pipeline.stall, "{path}");
        let stage = |net: NetId| pipeline.stage_of[net.index()];
        let constant = |net: &NetId| matches!(design.net(*net).driver, Driver::Constant(_));
        for (id, net) in design.iter() {
            let what = || format!("{path}: `{}`", net.name);
            let follows = |from: NetId| assert_eq!(stage(id), stage(from) + 1, "{}", what());
            match &net.driver {
                Driver::Op(_) if pipeline.handshake.contains(&id) => {}
                Driver::Op(op) => {
                    for from in op.operands().iter().filter(|it| !constant(it)) {
                        assert_eq!(stage(id), stage(*from), "{}", what());
                    }
                }
                Driver::Register(register) => {
                    let register = design.register(*register);
                    register.data.iter().for_each(|&data| follows(data));
                    assert_eq!(register.enable, advance, "{}", what());
                    assert_eq!(
                        register.reset.is_some(),
                        pipeline.valid.contains(&id),
                        "{}",
                        what()
                    );
                }
                Driver::Rom(rom) => {
                    let rom = design.rom(*rom);
                    if rom.synchronous {
                        follows(rom.address);
                        assert_eq!(rom.enable, advance, "{}", what());
                    } else {
                        assert_eq!(stage(id), stage(rom.address), "{}", what());
                    }
                }
                Driver::Input => assert_eq!(stage(id), 0, "{}", what()),
                Driver::Constant(_) => {}
                other => panic!("{}: {other:?}", what()),
            }
        }
        let outputs = design.outputs().filter(|port| port.role == Role::Result);
        for port in outputs {
            assert_eq!(stage(port.net), pipeline.stages.len(), "{path}");
        }
    }
    assert_eq!(seen, 8, "pipelines");
}
