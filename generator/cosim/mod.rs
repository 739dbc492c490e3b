//! Co-simulation: the same stimulus through independent simulators, compared clock by clock.

pub mod external;
