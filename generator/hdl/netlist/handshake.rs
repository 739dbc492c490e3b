//! Finds the handshake ports that every device with a microprogram has: `rst_n`, `start`, `valid`, `busy` and `done`.

use anyhow::{Context, Result};

use super::{Design, NetId, Role};

/// The nets of the handshake ports that every device with a microprogram has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handshake {
    /// The net of the reset input `rst_n`.
    pub reset: NetId,
    /// The net of the input `start`, which begins a computation.
    pub start: NetId,
    /// The net of the output `valid`, which is 1 while results are shown.
    pub valid: NetId,
    /// The net of the output `busy`, which is 1 during a computation.
    pub busy: NetId,
    /// The net of the output `done`, which is 1 in the last clock of a computation.
    pub done: NetId,
}

impl Role {
    /// Returns whether the port is an output of the handshake: `valid`, `busy` or `done`, or `in_ready` of a pipeline.
    pub fn is_status(self) -> bool {
        matches!(self, Self::Valid | Self::Busy | Self::Done | Self::InReady)
    }
}

impl Design {
    /// Returns the position of a net among the input ports of the design, from 0.
    ///
    /// # Errors
    /// Fails if the net is no input.
    pub fn input_position(&self, net: NetId) -> Result<usize> {
        let at = self.inputs().position(|port| port.net == net);
        at.with_context(|| format!("`{}` is not an input of `{}`", self.net(net).name, self.name))
    }

    /// Returns the nets of the handshake ports: `rst_n`, `start`, `valid`, `busy` and `done`.
    ///
    /// # Errors
    /// Fails if the design lacks one of these ports.
    pub fn handshake(&self) -> Result<Handshake> {
        let net = |role: Role, name: &str| {
            let port = self.port(|other| other == role).map(|port| port.net);
            port.with_context(|| format!("`{}` has no port `{name}`", self.name))
        };
        Ok(Handshake {
            reset: net(Role::Reset, "rst_n")?,
            start: net(Role::Start, "start")?,
            valid: net(Role::Valid, "valid")?,
            busy: net(Role::Busy, "busy")?,
            done: net(Role::Done, "done")?,
        })
    }
}
