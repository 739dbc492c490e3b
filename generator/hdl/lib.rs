//! A hardware description language in Rust, for devices with a datapath and a microprogrammed control unit.
//!
//! A description in the language ([`dsl`]) becomes a [`netlist`]. A built-in simulator runs the netlist ([`sim`]), and an
//! emitter writes it as [`verilog`]. A scheduler can turn it into a [`pipeline`] first, which accepts a point every clock or
//! every few clocks. For example:
//!
//! ```
//! use glint_base::fixed::{Format, Overflow, Rounding};
//! use glint_base::target::Timing;
//! use glint_rtl::dsl::{Designer, end, step, valid};
//! use glint_rtl::pipeline::{Delays, Goal, IntervalGoal, Options, pipeline};
//! use glint_rtl::sim::Simulator;
//!
//! let byte = Format::unsigned(0, 8);
//! let d = Designer::new("squarer");
//! let x = d.operand("x", byte);
//! let y = d.register("y", byte);
//! y.takes(d.narrow("square", d.mul("product", x.q(), x.q()), byte, Rounding::Truncate, Overflow::Saturate));
//! d.output("y_out", y.q());
//! d.microprogram([step("idle", []), step("square", [y.load()]), step("result", [valid(), end()])]);
//! let design = d.finish()?;
//!
//! // Three quarters, squared: a write and a start in one clock.
//! let mut simulator: Simulator = Simulator::new(&design)?;
//! simulator.clock()?;
//! for (input, value) in [("rst_n", 1), ("start", 1), ("x_write", 1), ("x", 0xc0)] {
//!     simulator.set(simulator.input(input).expect("an input"), value);
//! }
//! for _ in 0..3 {
//!     simulator.clock()?;
//! }
//! assert_eq!(simulator.value(design.find("y_out").expect("an output")), 0x90);
//!
//! // A top module, a control unit, a datapath and the control ROM; as a pipeline one module.
//! assert_eq!(glint_rtl::verilog::files(&design)?.len(), 4);
//! let target = Timing::named("ecp5").expect("a target");
//! let (goal, delays) = (Goal::ClockMhz(100.0), Delays::Memory);
//! let options = Options { target, goal, registered: false, stall: true, side: 0, delays, interval: IntervalGoal::Clocks(1) };
//! assert_eq!(glint_rtl::verilog::files(&pipeline(&design, &options)?)?.len(), 1);
//! # Ok::<(), anyhow::Error>(())
//! ```

pub mod area;
pub mod blocks;
pub mod dsl;
pub mod netlist;
pub mod pipeline;
pub mod retime;
pub mod sim;
pub mod verilog;
