//! What a device is to the command line: keys, description, golden model, contract.

use crate::config::{Config, Schema};
use crate::devices;
use crate::golden::{self, Contract, Model};
use crate::hdl::dsl::Designer;
use crate::hdl::dsl::rules::Diagnostics;
use crate::hdl::netlist::Design;

/// A device that Glint can generate, simulate and check.
///
/// All functions are called with configurations that the schema accepts. The file
/// `examples/fresnel.rs` is a device of one's own, in full.
#[derive(Clone, Copy)]
pub struct Device {
    /// As the key `device` names it: the same as [`Schema::device`].
    pub name: &'static str,
    /// One line for `glint list`.
    pub summary: &'static str,
    /// Its configuration keys.
    pub schema: fn() -> Schema,
    /// Its description: builds on a designer that has the module's name, and does not finish it.
    pub describe: fn(&Designer, &Config),
    /// Its golden model.
    pub model: fn(&Config) -> Box<dyn Model>,
    /// Its accuracy contract.
    pub contract: fn(&Config) -> Box<dyn Contract>,
}

impl Device {
    /// The design that a configuration asks for.
    ///
    /// # Errors
    /// The mistakes of the description.
    pub fn design(&self, config: &Config) -> Result<Design, Diagnostics> {
        let designer = Designer::new(&config.name);
        (self.describe)(&designer, config);
        designer.finish()
    }
}

/// The devices that a command line knows.
#[derive(Clone)]
pub struct Registry(Vec<Device>);

impl Registry {
    /// No device at all: for a command line of your own devices.
    pub fn empty() -> Self {
        Self(Vec::new())
    }

    /// The devices of the seeds.
    pub fn catalogue() -> Self {
        Self(vec![
            Device {
                name: "quad-cosine",
                summary: "cos^k(sqrt(n/k)*delta) along a scan line, k = 1, 2, 4, 16 by n (seed 000)",
                schema: devices::quad_cosine::schema,
                describe: devices::quad_cosine::describe,
                model: |config| Box::new(golden::quad_cosine::QuadCosineModel::new(config)),
                contract: |config| Box::new(golden::quad_cosine::QuadCosineContract::new(config)),
            },
            Device {
                name: "cosine-squared",
                summary: "cos^2(a*delta) along a scan line, a = sqrt(n/2) outside (seed 000's prototype)",
                schema: devices::cosine_squared::schema,
                describe: devices::cosine_squared::describe,
                model: |config| Box::new(golden::cosine_squared::CosineSquaredModel::new(config)),
                contract: |config| {
                    Box::new(golden::cosine_squared::CosineSquaredContract::new(config))
                },
            },
            Device {
                name: "lyon",
                summary: "max(0, 1 - beta*D^2)^m, D = N - H, m = 2, 4, 8, 16 (US 5 739 820)",
                schema: devices::lyon::schema,
                describe: devices::lyon::describe,
                model: |config| Box::new(golden::lyon::LyonModel::new(config)),
                contract: |config| Box::new(golden::lyon::LyonContract::new(config)),
            },
            Device {
                name: "rough",
                summary: "rough surface, (n/2*(cos(gamma +- dgamma) - 1) + 1)^2 (UA 60139)",
                schema: devices::rough::schema,
                describe: devices::rough::describe,
                model: |config| Box::new(golden::rough::RoughModel::new(config)),
                contract: |config| Box::new(golden::rough::RoughContract::new(config)),
            },
            Device {
                name: "threshold",
                summary: "(n/2*(cos gamma - 1) + 1)^2 where it reaches ROM(n) (UA 30041)",
                schema: devices::threshold::schema,
                describe: devices::threshold::describe,
                model: |config| Box::new(golden::threshold::ThresholdModel::new(config)),
                contract: |config| Box::new(golden::threshold::ThresholdContract::new(config)),
            },
            Device {
                name: "quadratic",
                summary: "c + a(n)*(c^2 - c), c = cos gamma, a(n) from ROM (UA 20998)",
                schema: devices::quadratic::schema,
                describe: devices::quadratic::describe,
                model: |config| Box::new(golden::quadratic::QuadraticModel::new(config)),
                contract: |config| Box::new(golden::quadratic::QuadraticContract::new(config)),
            },
            Device {
                name: "cosine-power",
                summary: "W(n, gamma) = (n/m*(cos gamma - 1) + 1)^m, m = 2, 4, 8, 16 (seed 002)",
                schema: devices::cosine_power::schema,
                describe: devices::cosine_power::describe,
                model: |config| Box::new(golden::cosine_power::CosinePowerModel::new(config)),
                contract: |config| Box::new(golden::cosine_power::CosinePowerContract::new(config)),
            },
            Device {
                name: "schlick",
                summary: "Schlick's function, c / (n - n*c + c), by a divider (seed 002)",
                schema: devices::schlick::schema,
                describe: devices::schlick::describe,
                model: |config| Box::new(golden::schlick::SchlickModel::new(config)),
                contract: |config| Box::new(golden::schlick::SchlickContract::new(config)),
            },
            Device {
                name: "blinn",
                summary: "cos(gamma)^n itself, by tables of -log2 and 2^-x (seeds 000 to 002)",
                schema: devices::blinn::schema,
                describe: devices::blinn::describe,
                model: |config| Box::new(golden::blinn::model(config)),
                contract: |config| Box::new(golden::blinn::contract(config)),
            },
            Device {
                name: "gauss",
                summary: "exp(-n*gamma^2/2), by tables of gamma^2 and 2^-x (seed 002)",
                schema: devices::gauss::schema,
                describe: devices::gauss::describe,
                model: |config| Box::new(golden::gauss::model(config)),
                contract: |config| Box::new(golden::gauss::contract(config)),
            },
        ])
    }

    /// The registry with one device more.
    #[must_use]
    pub fn with(mut self, device: Device) -> Self {
        self.0.push(device);
        self
    }

    /// All devices, in order.
    pub fn devices(&self) -> &[Device] {
        &self.0
    }

    /// The device of a configuration, which was read with the schemas of this registry.
    pub fn device(&self, name: &str) -> Option<&Device> {
        self.0.iter().find(|device| device.name == name)
    }

    /// The keys of all devices.
    pub fn schemas(&self) -> Vec<Schema> {
        self.0.iter().map(|device| (device.schema)()).collect()
    }
}
