//! Defines the registry of devices: for each device its configuration keys, its description, its golden model and its contract.

mod design_error;
mod pipeline_keys;

use anyhow::{Result, ensure};

use glint_base::codes;
use glint_base::diagnostic::Diagnostics;
use glint_catalogue as devices;
use glint_config::{Config, Schema, Shared, Value};
use glint_golden::{self as golden, Contract, Model};
use glint_keys as keys;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::Design;
use glint_rtl::pipeline::{self, PassResult};

pub use design_error::DesignError;
pub use pipeline_keys::CLOCK_MHZ;

/// The key that asks for registers behind the results.
const OUTPUT_REGISTERED: &str = "output.registered";

/// The key that asks for buffers in front of the operand registers.
const OPERANDS_BUFFERED: &str = "operands.buffered";

/// A device that Glint can generate, simulate and check.
///
/// Callers must call the functions only with configurations that the schema accepts. The file `examples/fresnel` is an
/// example of a complete device outside Glint.
#[derive(Clone, Copy)]
pub struct Device {
    /// The name of the device, which the key `device` of a configuration gives. The name must equal [`Schema::device`].
    pub name: &'static str,
    /// A line about the device, which `glint list` prints.
    pub summary: &'static str,
    /// Returns the device's own configuration keys, with their defaults.
    pub schema: fn() -> Schema,
    /// Describes the hardware of a configuration: adds blocks and a microprogram to a designer, whose name is the name of the
    /// module. The function must not call `finish`.
    pub describe: fn(&Designer, &Config),
    /// Returns the golden model of a configuration.
    pub model: fn(&Config) -> Box<dyn Model>,
    /// Returns the accuracy contract of a configuration.
    pub contract: fn(&Config) -> Box<dyn Contract>,
    /// Whether the contract's bound is proved for every configuration, by a proof next to the golden model. Otherwise the bound
    /// is only the statement of the author.
    ///
    /// A device that replaces the contract must set this field too: `Device { contract, proved: false, ..own }`.
    pub proved: bool,
}

impl Device {
    /// Returns the default configuration of the device. Its module name is [`Schema::module`].
    pub fn defaults(&self) -> Config {
        let schema = (self.schema)();
        Config::defaults(&schema, &schema.module())
    }

    /// Returns the netlist of a configuration: with a microprogram, or as a pipeline if the configuration asks for a pipeline.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the pipeline cannot be made. The error lists the mistakes, or names the key
    /// to change.
    pub fn design(&self, config: &Config) -> Result<Design, DesignError> {
        let sequential = self.sequential(config)?;
        let pipelined = pipeline_keys::pipelined(&sequential, config)?;
        Ok(pipelined.unwrap_or(sequential))
    }

    /// Returns the netlist of a configuration that does not set a clock frequency. If a pipeline cannot reach the default of
    /// [`CLOCK_MHZ`], the function sets this key in `config` to the fastest clock that the pipeline can reach.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the pipeline cannot be made with that clock either.
    pub fn design_with_free_clock(&self, config: &mut Config) -> Result<Design, DesignError> {
        let sequential = self.sequential(config)?;
        let mut pipelined = pipeline_keys::pipelined(&sequential, config);
        if let Err(error) = &pipelined
            && error.key == CLOCK_MHZ
            && let Some(nearest) = error.nearest
        {
            config.set(CLOCK_MHZ, Value::Number(nearest));
            pipelined = pipeline_keys::pipelined(&sequential, config);
        }
        Ok(pipelined?.unwrap_or(sequential))
    }

    /// Returns the computation of a pipeline before the passes that rewrite it, and after each pass. Returns an empty list if
    /// the configuration has a sequential architecture.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the microprogram cannot be unrolled.
    pub fn pass_results(&self, config: &Config) -> Result<Vec<PassResult>, DesignError> {
        let sequential = self.sequential(config)?;
        let results = pipeline_keys::pass_results(&sequential, config)?;
        Ok(results.unwrap_or_default())
    }

    /// Returns the sequential netlist, which executes a microprogram. [`Device::design`] makes pipelines from this netlist.
    ///
    /// # Errors
    /// Fails if the description has mistakes. The error lists them.
    pub fn sequential(&self, config: &Config) -> Result<Design, Diagnostics> {
        let designer = Designer::new(&config.name);
        let keys = Shared::of(config);
        if keys.operands_buffered {
            designer.buffer_operands();
        }
        (self.describe)(&designer, config);
        if keys.output_registered {
            designer.register_outputs();
        }
        if keys.operands_logic == "combinational" {
            designer.keep_operand_logic();
        }
        designer.finish().map_err(|mistakes| with_key_remedies(mistakes, &keys))
    }

    /// Returns the golden model of the sequential netlist, with output registers and operand buffers if the configuration asks
    /// for them and the model supports them.
    pub fn golden(&self, config: &Config) -> Box<dyn Model> {
        let mut model = (self.model)(config);
        // A model that lacks the registers or buffers differs from the design, and the comparison reports the difference.
        if config.flag(OUTPUT_REGISTERED) {
            model = model.with_output_registers().unwrap_or(model);
        }
        if config.flag(OPERANDS_BUFFERED) {
            model = model.with_operand_buffers().unwrap_or(model);
        }
        model
    }

    /// Checks whether the golden model supports the keys of the configuration.
    ///
    /// # Errors
    /// Fails if the configuration asks for output registers or operand buffers, and the golden model does not model them.
    pub fn check_golden(&self, config: &Config) -> Result<()> {
        let model = (self.model)(config);
        ensure!(
            !config.flag(OUTPUT_REGISTERED) || model.with_output_registers().is_some(),
            "the golden model of `{}` does not model output registers (`Model::with_output_registers`): \
             remove {OUTPUT_REGISTERED}",
            self.name
        );
        ensure!(
            !config.flag(OPERANDS_BUFFERED) || model.with_operand_buffers().is_some(),
            "the golden model of `{}` does not model operand buffers (`Model::with_operand_buffers`): remove \
             {OPERANDS_BUFFERED}",
            self.name
        );
        Ok(())
    }

    /// Checks that the contract can describe the results of the device.
    ///
    /// # Errors
    /// Fails if [`Contract::check`] fails, for example because the golden model never shows a result, or because the formula
    /// gives too few values. Fails also if results depend on values that an earlier computation left.
    pub fn check_contract(
        &self,
        config: &Config,
        design: &Design,
        contract: &dyn Contract,
    ) -> Result<()> {
        contract.check().map_err(anyhow::Error::msg)?;
        let carried = if design.pipeline.is_some() {
            // The design is a pipeline, and no pipeline can be made from a description that carries values over.
            None
        } else if config.flag(OPERANDS_BUFFERED) {
            // The value in a buffer is an operand, and not a value that an earlier computation left.
            let designer = Designer::new(&config.name);
            (self.describe)(&designer, config);
            pipeline::carried(&designer.finish()?)
        } else {
            pipeline::carried(design)
        };
        match carried {
            None => Ok(()),
            Some(carried) => Err(anyhow::Error::new(Diagnostics(vec![carried])).context(format!(
                "the results of `{}` must depend only on the operands of their own point, because the \
                 contract states them so",
                self.name
            ))),
        }
    }
}

/// Makes a list of devices from the modules with their keys, description and golden model, each with its name and summary.
macro_rules! of_catalogue {
    ($($module:ident: $name:literal, $summary:literal;)*) => {
        vec![$(Device {
            name: $name,
            summary: $summary,
            schema: keys::$module::schema,
            describe: devices::$module::describe,
            model: golden::$module::model,
            contract: golden::$module::contract,
            proved: true,
        }),*]
    };
}

/// The devices that a command line offers.
#[derive(Clone)]
pub struct Registry(Vec<Device>);

impl Registry {
    /// Returns a registry without devices, for a command line with devices of your own.
    pub fn empty() -> Self {
        Self(Vec::new())
    }

    /// Returns a registry with the highlight devices, and with the device `function`, which computes a formula of one operand.
    /// This repository has records of their checks.
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
            function: "function", "any formula of one operand, by piecewise polynomials with a proved error";
        ])
    }

    /// Returns a registry with all devices of Glint: the catalogue, and the devices without records in this repository, for
    /// example `normaliser` and `shading`.
    pub fn shipped() -> Self {
        let mut all = Self::catalogue();
        all.0.extend(of_catalogue![
            normaliser: "normaliser", "(x, y, z)/sqrt(x^2 + y^2 + z^2), by a table of inverse roots";
            dot_product: "dot-product", "max(0, N.H) of a normal of any length, the cosine that highlights start from";
            expression: "expression", "formulas of up to eight operands, by integer operations with a proved error";
            shading: "shading", "ambient + diffuse*N.L + specular*highlight, from normals of any length";
        ]);
        all
    }

    /// Adds a device to the registry.
    #[must_use]
    pub fn with(mut self, device: Device) -> Self {
        self.0.push(device);
        self
    }

    /// Returns all devices, in the order in which they were added.
    pub fn devices(&self) -> &[Device] {
        &self.0
    }

    /// Returns the device with this name, or `None`.
    pub fn device(&self, name: &str) -> Option<&Device> {
        self.0.iter().find(|device| device.name == name)
    }

    /// Returns the configuration keys of all devices.
    pub fn schemas(&self) -> Vec<Schema> {
        self.0.iter().map(|device| (device.schema)()).collect()
    }
}

/// Completes the messages about mistakes that come from a key of the configuration: the user can also leave out this key.
fn with_key_remedies(mut mistakes: Diagnostics, keys: &Shared) -> Diagnostics {
    for mistake in &mut mistakes.0 {
        if mistake.code == codes::OUTPUT_REGISTER && keys.output_registered {
            mistake.message += &format!(", or remove {OUTPUT_REGISTERED} from the configuration");
        }
        if mistake.code == codes::BUFFER && keys.operands_buffered {
            mistake.message += &format!(": remove {OPERANDS_BUFFERED} from the configuration");
        }
    }
    mistakes
}
