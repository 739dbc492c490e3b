//! Finds the handshake ports `rst_n`, `start`, `valid`, `busy` and `done`.

use anyhow::{Context, Result};

use super::{Design, NetId, Role};

/// The handshake ports that every device with a microprogram has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handshake {
    /// The reset input `rst_n`.
    pub reset: NetId,
    /// The input that begins a computation.
    pub start: NetId,
    /// The output that is 1 while results are shown.
    pub valid: NetId,
    /// The output that is 1 during a computation.
    pub busy: NetId,
    /// The output that is 1 in the last clock of a computation.
    pub done: NetId,
}

impl Role {
    /// Returns whether the port belongs to the write port of a table.
    pub fn is_of_table(self) -> bool {
        matches!(self, Self::TableWrite | Self::TableAddress | Self::TableWord | Self::TableReady)
    }

    /// Returns whether the port is an output of the handshake.
    pub fn is_status(self) -> bool {
        matches!(self, Self::Valid | Self::Busy | Self::Done | Self::InReady | Self::TableReady)
    }
}

impl Design {
    /// Returns the position of a net among the input ports, from 0. Fails if the net is no input.
    pub fn input_position(&self, net: NetId) -> Result<usize> {
        let at = self.inputs().position(|port| port.net == net);
        at.with_context(|| format!("`{}` is not an input of `{}`", self.net(net).name, self.name))
    }

    /// Returns the handshake ports. Fails if the design lacks one of them.
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
