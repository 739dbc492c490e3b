//! Defines [`DeviceParts`], the description, golden model and contract of a device, and [`OpenedConfig`], a configuration for
//! which Glint has them.
//!
//! Opening does slow work once, and reports errors. For example, the device `expression` plans its formulas and proves their
//! error bounds.

use std::sync::Arc;

use anyhow::{Result, ensure};

use glint_base::codes;
use glint_base::config_error::ConfigError;
use glint_base::diagnostic::Diagnostics;
use glint_config::{Config, Shared, Value};
use glint_golden::{Contract, Model};
use glint_keys::images::StatedImage;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::Design;
use glint_rtl::pipeline::{self, PassResult};

use super::{CLOCK_MHZ, DesignError, Device, PartsResult, pipeline_keys};

const OUTPUT_REGISTERED: &str = "output.registered";

const OPERANDS_BUFFERED: &str = "operands.buffered";

/// The hardware description, the golden model and the contract of a device, for the values of its own keys with which it was
/// opened.
///
/// Callers must pass only configurations with these values. The keys that all devices share may differ: for example, the core
/// and the pipeline of a formula share its plan.
pub trait DeviceParts: Send + Sync {
    /// Adds blocks and a microprogram to a designer, whose name is the name of the module. The function must not call
    /// `finish`.
    fn describe(&self, designer: &Designer, config: &Config);

    fn model(&self, config: &Config) -> Box<dyn Model>;

    fn contract(&self, config: &Config) -> Box<dyn Contract>;

    /// Returns the contract of each function that an opcode selects, in the order of [`Design::functions`]. The contract's
    /// operands and results have the formats of the function.
    fn function_contracts(&self, _config: &Config) -> Vec<Box<dyn Contract>> {
        Vec::new()
    }

    /// Returns the parts of the same datapath for the function that `config` states, with other words in its writable table. `None` if
    /// the device has no such table.
    fn refitted(&self, _config: &Config) -> Option<PartsResult> {
        None
    }

    /// Returns the further functions that a writable table is planned for.
    fn images(&self, _config: &Config) -> Vec<StatedImage> {
        Vec::new()
    }

    /// Returns the configuration with another formula for a writable table, and with another allowed error if it is given. `None` if the
    /// device has no such table.
    fn image_config(
        &self,
        _config: &Config,
        _formula: &str,
        _error: Option<f64>,
    ) -> Option<Config> {
        None
    }

    /// Returns the name and the opcode of the function with a writable table, if the device has several functions.
    fn written_function(&self, _config: &Config) -> Option<(String, usize)> {
        None
    }
}

/// The parts of a device whose functions read all that they need from the configuration.
pub struct KeyParts {
    pub describe: fn(&Designer, &Config),
    pub model: fn(&Config) -> Box<dyn Model>,
    pub contract: fn(&Config) -> Box<dyn Contract>,
}

impl DeviceParts for KeyParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        (self.describe)(designer, config);
    }

    fn model(&self, config: &Config) -> Box<dyn Model> {
        (self.model)(config)
    }

    fn contract(&self, config: &Config) -> Box<dyn Contract> {
        (self.contract)(config)
    }
}

/// A configuration of a device, with the parts that the device made for it.
#[derive(Clone)]
pub struct OpenedConfig {
    pub device: Device,
    pub config: Config,
    parts: Arc<dyn DeviceParts>,
}

impl Device {
    /// Opens a configuration that the schema accepts.
    ///
    /// # Errors
    /// Fails if the device cannot have the values of the keys together, for example because a formula has no plan with the allowed
    /// error. The error names the key to change.
    pub fn open(&self, config: Config) -> Result<OpenedConfig, ConfigError> {
        let parts = (self.parts)(&config)?;
        Ok(OpenedConfig { device: *self, config, parts })
    }
}

impl OpenedConfig {
    /// Returns another configuration of the same device. The configuration shares the parts if the device's own keys have the
    /// same values; otherwise it is opened.
    ///
    /// # Errors
    /// Fails if the device cannot have the values of the keys together.
    pub fn with_config(&self, config: Config) -> Result<Self, ConfigError> {
        let schema = (self.device.schema)();
        let mut own_keys = schema.keys.iter();
        if own_keys.all(|key| self.config.value(key.name) == config.value(key.name)) {
            return Ok(Self { device: self.device, config, parts: self.parts.clone() });
        }
        self.device.open(config)
    }

    /// Returns the same core with another function, which `config` states, in its writable table.
    ///
    /// # Errors
    /// Fails if the core has no writable table, or if the table cannot hold the function. The error names a key to change.
    pub fn refitted(&self, config: Config) -> Result<Self, ConfigError> {
        let parts = self.parts.refitted(&config).unwrap_or_else(|| {
            Err(ConfigError::new(
                "device",
                format!("the device `{}` has no table that can be written", self.device.name),
                "use device = \"function\" with approximation.tables = \"writable\"",
            ))
        })?;
        Ok(Self { device: self.device, config, parts })
    }

    /// Returns the configuration with another formula for the writable table, and with another allowed error if it is given. `None` if the
    /// device has no such table.
    pub fn image_config(&self, formula: &str, error: Option<f64>) -> Option<Config> {
        self.parts.image_config(&self.config, formula, error)
    }

    /// Returns the further functions that the configuration states for a writable table.
    pub fn stated_images(&self) -> Vec<StatedImage> {
        self.parts.images(&self.config)
    }

    /// Returns the name and the opcode of the function with a writable table, if the core has several functions.
    pub fn written_function(&self) -> Option<(String, usize)> {
        self.parts.written_function(&self.config)
    }

    /// Returns the contract of the function with a writable table, in the formats of this function.
    pub fn written_contract(&self) -> Box<dyn Contract> {
        match self.written_function() {
            Some((_, opcode)) => self.function_contracts().swap_remove(opcode),
            None => self.contract(),
        }
    }

    /// Returns each further function that the configuration states for a writable table, and the core with this function.
    ///
    /// # Errors
    /// Fails if the table cannot hold one of the functions. The error names a key to change.
    pub fn images(&self) -> Result<Vec<(StatedImage, Self)>, ConfigError> {
        let mut images = Vec::new();
        for image in self.stated_images() {
            let opened = self.refitted(image.config.clone())?;
            images.push((image, opened));
        }
        Ok(images)
    }

    pub fn contract(&self) -> Box<dyn Contract> {
        self.parts.contract(&self.config)
    }

    /// Returns the contract of each function that an opcode selects; none for most devices.
    pub fn function_contracts(&self) -> Vec<Box<dyn Contract>> {
        self.parts.function_contracts(&self.config)
    }

    /// Returns the netlist: with a microprogram, or as a pipeline.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the pipeline cannot be made. The error lists the mistakes, or names the key
    /// to change.
    pub fn design(&self) -> Result<Design, DesignError> {
        let sequential = self.sequential()?;
        let pipelined = pipeline_keys::pipelined(&sequential, &self.config)?;
        Ok(pipelined.unwrap_or(sequential))
    }

    /// Returns the netlist of a configuration without a clock frequency. If a pipeline cannot reach the default of
    /// [`CLOCK_MHZ`], the function sets this key to the fastest clock that the pipeline can reach.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the pipeline cannot be made with that clock either.
    pub fn design_with_free_clock(&mut self) -> Result<Design, DesignError> {
        let sequential = self.sequential()?;
        let mut pipelined = pipeline_keys::pipelined(&sequential, &self.config);
        if let Err(error) = &pipelined
            && error.key == CLOCK_MHZ
            && let Some(nearest) = error.nearest
        {
            self.config.set(CLOCK_MHZ, Value::Number(nearest));
            pipelined = pipeline_keys::pipelined(&sequential, &self.config);
        }
        Ok(pipelined?.unwrap_or(sequential))
    }

    /// Returns the computation of a pipeline before the passes that rewrite it, and after each pass. A sequential architecture
    /// gives an empty list.
    ///
    /// # Errors
    /// Fails if the description has mistakes, or if the microprogram cannot be unrolled.
    pub fn pass_results(&self) -> Result<Vec<PassResult>, DesignError> {
        let sequential = self.sequential()?;
        let results = pipeline_keys::pass_results(&sequential, &self.config)?;
        Ok(results.unwrap_or_default())
    }

    /// Returns the netlist with a microprogram, from which [`OpenedConfig::design`] makes pipelines.
    ///
    /// # Errors
    /// Fails if the description has mistakes. The error lists them.
    pub fn sequential(&self) -> Result<Design, Diagnostics> {
        let designer = Designer::new(&self.config.name);
        let keys = Shared::of(&self.config);
        if keys.operands_buffered {
            designer.buffer_operands();
        }
        self.parts.describe(&designer, &self.config);
        if keys.output_registered {
            designer.register_outputs();
        }
        if keys.operands_logic == "combinational" {
            designer.keep_operand_logic();
        }
        designer.finish().map_err(|mistakes| with_key_remedies(mistakes, &keys))
    }

    /// Returns the golden model of the sequential netlist, with output registers and operand buffers if the configuration asks
    /// for them.
    pub fn golden(&self) -> Box<dyn Model> {
        let mut model = self.parts.model(&self.config);
        // A model that lacks the registers or buffers differs from the design, and the comparison reports the difference.
        if self.config.flag(OUTPUT_REGISTERED) {
            model = model.with_output_registers().unwrap_or(model);
        }
        if self.config.flag(OPERANDS_BUFFERED) {
            model = model.with_operand_buffers().unwrap_or(model);
        }
        model
    }

    /// Fails if the configuration asks for output registers or operand buffers, and the golden model does not model them.
    pub fn check_golden(&self) -> Result<()> {
        let model = self.parts.model(&self.config);
        ensure!(
            !self.config.flag(OUTPUT_REGISTERED) || model.with_output_registers().is_some(),
            "the golden model of `{}` does not model output registers (`Model::with_output_registers`): \
             remove {OUTPUT_REGISTERED}",
            self.device.name
        );
        ensure!(
            !self.config.flag(OPERANDS_BUFFERED) || model.with_operand_buffers().is_some(),
            "the golden model of `{}` does not model operand buffers (`Model::with_operand_buffers`): remove \
             {OPERANDS_BUFFERED}",
            self.device.name
        );
        Ok(())
    }

    /// Fails if [`Contract::check`] fails, for example because the golden model never shows a result, or because the formula
    /// gives too few values. Fails also if results depend on values that an earlier computation left.
    pub fn check_contract(&self, design: &Design, contract: &dyn Contract) -> Result<()> {
        contract.check().map_err(anyhow::Error::msg)?;
        let carried = if design.pipeline.is_some() {
            // The design is a pipeline, and no pipeline can be made from a description that carries values over.
            None
        } else if self.config.flag(OPERANDS_BUFFERED) {
            // The value in a buffer is an operand, and not a value that an earlier computation left.
            let designer = Designer::new(&self.config.name);
            self.parts.describe(&designer, &self.config);
            pipeline::carried(&designer.finish()?)
        } else {
            pipeline::carried(design)
        };
        match carried {
            None => Ok(()),
            Some(carried) => Err(anyhow::Error::new(Diagnostics(vec![carried])).context(format!(
                "the results of `{}` must depend only on the operands of their own point, because the \
                 contract states them so",
                self.device.name
            ))),
        }
    }
}

/// Adds to each mistake that comes from a key the remedy to remove the key.
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
