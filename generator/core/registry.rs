//! Defines the registry of devices: for each device its configuration keys, its description, its golden model and its contract.

mod design_error;
mod opened;
mod pipeline_keys;
mod planned;

use std::path::Path;
use std::sync::Arc;

use glint_base::config_error::ConfigError;
use glint_catalogue as devices;
use glint_config::{self as config, Config, ConfigSource, Problems, Schema};
use glint_golden as golden;
use glint_keys as keys;

pub use design_error::DesignError;
pub use opened::{DeviceParts, KeyParts, OpenedConfig};
pub use pipeline_keys::CLOCK_MHZ;

/// The parts of a device for a configuration, or the error of the key whose value the device cannot have.
pub type PartsResult = Result<Arc<dyn DeviceParts>, ConfigError>;

/// A device that Glint can generate, simulate and check.
///
/// Callers must call the functions only with configurations that the schema accepts. `examples/fresnel` is a complete device
/// outside Glint.
#[derive(Clone, Copy)]
pub struct Device {
    /// The value of the key `device`. The value must equal [`Schema::device`].
    pub name: &'static str,
    /// A description of one line, which `glint list` prints.
    pub summary: &'static str,
    pub schema: fn() -> Schema,
    /// Returns the description, golden model and contract for a configuration; [`KeyParts`] if nothing must be found first.
    /// The function fails if the device cannot have the values of the keys together. An error that needs no long search
    /// belongs into the check of the schema.
    pub parts: fn(&Config) -> PartsResult,
    /// Whether a proof next to the golden model proves the contract's bound for every configuration. Otherwise the bound is
    /// only the statement of the author.
    ///
    /// A device that replaces the contract must set this field too: `Device { parts, proved: false, ..own }`.
    pub proved: bool,
}

impl Device {
    /// Returns the default configuration. The module name is [`Schema::module`].
    pub fn defaults(&self) -> Config {
        let schema = (self.schema)();
        Config::defaults(&schema, &schema.module())
    }
}

/// Makes devices from the modules with their keys, description and golden model. The functions of these modules read all that
/// they need from the keys.
macro_rules! of_catalogue {
    ($($module:ident: $name:literal, $summary:literal;)*) => {
        vec![$(Device {
            name: $name,
            summary: $summary,
            schema: keys::$module::schema,
            parts: |_| {
                Ok(Arc::new(KeyParts {
                    describe: devices::$module::describe,
                    model: golden::$module::model,
                    contract: golden::$module::contract,
                }))
            },
            proved: true,
        }),*]
    };
}

const FUNCTION: Device = Device {
    name: "function",
    summary: "any formula of one operand, by piecewise polynomials with a proved error",
    schema: keys::function::schema,
    parts: planned::function,
    proved: true,
};

const EXPRESSION: Device = Device {
    name: "expression",
    summary: "formulas of numbers and lists, by integer operations with a proved error",
    schema: keys::expression::schema,
    parts: planned::expression,
    proved: true,
};

const UNIT: Device = Device {
    name: "unit",
    summary: "several functions behind one datapath, selected by an opcode",
    schema: keys::unit::schema,
    parts: planned::unit,
    proved: true,
};

const SHADING: Device = Device {
    name: "shading",
    summary: "ambient + diffuse*N.L + specular*highlight, from normals of any length",
    schema: keys::shading::schema,
    parts: planned::shading,
    proved: true,
};

#[derive(Clone)]
pub struct Registry(Vec<Device>);

impl Registry {
    /// Begins a registry for a command line with devices of your own.
    pub fn empty() -> Self {
        Self(Vec::new())
    }

    /// Returns the devices whose checks have records in this repository: the highlight devices, and the device `function`.
    pub fn catalogue() -> Self {
        Self(of_catalogue![
            quad_cosine: "quad-cosine", "cos^k(sqrt(n/k)*delta) along a scan line, k = 1, 2, 4, 16 by n (seed 000)";
            cosine_squared: "cosine-squared", "cos^2(a*delta) along a scan line, a = sqrt(n/2) outside (seed 000's prototype)";
            lyon: "lyon", "max(0, 1 - beta*D^2)^m, D = N - H, m = 2, 4, 8, 16 (US 5 739 820)";
            rough: "rough", "rough surface, (n/2*(cos(gamma +- dgamma) - 1) + 1)^2 (UA 60139)";
            threshold: "threshold", "(n/2*(cos gamma - 1) + 1)^2 where it reaches ROM(n) (UA 30041)";
            quadratic: "quadratic", "c + a(n)*(c^2 - c), c = cos gamma, a(n) from ROM (UA 20998)";
            cosine_power: "cosine-power", "W(n, gamma) = (n/m*(cos gamma - 1) + 1)^m, m = 2, 4, 8, 16 (seed 002)";
            schlick: "schlick", "Schlick's function, c / (n - n*c + c), by a divider (seed 002)";
            blinn: "blinn", "cos(gamma)^n itself, by tables of -log2 and 2^-x (seeds 000 to 002)";
            gauss: "gauss", "exp(-n*gamma^2/2), by tables of gamma^2 and 2^-x (seed 002)";
        ])
        .with(FUNCTION)
    }

    /// Returns all devices of Glint: the catalogue, and the devices without records in this repository, such as `shading`.
    pub fn shipped() -> Self {
        let mut all = Self::catalogue();
        all.0.extend(of_catalogue![
            normaliser: "normaliser", "(x, y, z)/sqrt(x^2 + y^2 + z^2), by a table of inverse roots";
            dot_product: "dot-product", "max(0, N.H) of a normal of any length, the cosine that highlights start from";
        ]);
        all.with(EXPRESSION).with(UNIT).with(SHADING)
    }

    #[must_use]
    pub fn with(mut self, device: Device) -> Self {
        self.0.push(device);
        self
    }

    /// Returns the devices in the order in which they were added.
    pub fn devices(&self) -> &[Device] {
        &self.0
    }

    pub fn device(&self, name: &str) -> Option<&Device> {
        self.0.iter().find(|device| device.name == name)
    }

    /// Reads and opens a configuration file. Also returns the location of each key, for errors that are found later.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is not valid, or if the device cannot have the configuration ([`Device::open`]).
    pub fn read(&self, path: &Path) -> Result<(OpenedConfig, ConfigSource), Problems> {
        self.opened(config::read_located(path, &self.schemas())?)
    }

    /// Does the same as [`Registry::read`] with the text of a configuration file, whose name in messages is `file_name`.
    ///
    /// # Errors
    /// Fails if the text is not valid, or if the device cannot have the configuration ([`Device::open`]).
    pub fn parse(
        &self,
        file_name: &str,
        text: &str,
    ) -> Result<(OpenedConfig, ConfigSource), Problems> {
        self.opened(config::parse_located(file_name, text, &self.schemas())?)
    }

    fn opened(
        &self,
        (config, source): (Config, ConfigSource),
    ) -> Result<(OpenedConfig, ConfigSource), Problems> {
        let device = self.device(&config.device).expect("each schema belongs to a device");
        match device.open(config.clone()) {
            Ok(opened) => Ok((opened, source)),
            Err(error) => Err(source.refusal(&(device.schema)(), &config, error)),
        }
    }

    pub fn schemas(&self) -> Vec<Schema> {
        self.0.iter().map(|device| (device.schema)()).collect()
    }
}
