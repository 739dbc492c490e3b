//! Opens the devices whose configurations state formulas. The formulas are planned once, and the hardware description, the
//! golden model and the contract read the plan.

use std::sync::Arc;

use glint_catalogue as devices;
use glint_config::Config;
use glint_golden::{self as golden, Contract, Model};
use glint_keys as keys;
use glint_keys::function::FunctionPlan;
use glint_keys::images::StatedImage;
use glint_keys::shading::LightParts;
use glint_plan::{ProvedPlan, UnitPlan};
use glint_rtl::dsl::Designer;

use super::PartsResult;
use super::opened::DeviceParts;

struct FunctionParts(FunctionPlan);

impl DeviceParts for FunctionParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::function::describe(designer, config, &self.0);
    }

    fn model(&self, config: &Config) -> Box<dyn Model> {
        golden::function::model(config, &self.0)
    }

    fn contract(&self, config: &Config) -> Box<dyn Contract> {
        golden::function::contract(config, &self.0)
    }

    fn refitted(&self, config: &Config) -> Option<PartsResult> {
        let refitted = self.0.with_function_of(config);
        Some(refitted.map(|plan| Arc::new(Self(plan)) as Arc<dyn DeviceParts>))
    }

    fn images(&self, config: &Config) -> Vec<StatedImage> {
        keys::images::stated(config)
    }

    fn image_config(&self, config: &Config, formula: &str, error: Option<f64>) -> Option<Config> {
        let is_writable = self.0.polynomials.is_writable;
        is_writable.then(|| keys::images::config(config, formula, error))
    }
}

/// Finds polynomials for the function. The error of a function without such polynomials names the key to change.
pub(super) fn function(config: &Config) -> PartsResult {
    Ok(Arc::new(FunctionParts(keys::function::plan(config)?)))
}

struct ExpressionParts(Arc<ProvedPlan>);

impl DeviceParts for ExpressionParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::expression::describe(designer, config, &self.0);
    }

    fn model(&self, config: &Config) -> Box<dyn Model> {
        golden::expression::model(config, &self.0)
    }

    fn contract(&self, config: &Config) -> Box<dyn Contract> {
        golden::expression::contract(config, &self.0)
    }
}

/// Plans the formulas, and proves the error of each result. The error of a formula without a plan names the formula.
pub(super) fn expression(config: &Config) -> PartsResult {
    Ok(Arc::new(ExpressionParts(Arc::new(keys::expression::plan(config)?))))
}

struct UnitParts(Arc<UnitPlan>);

impl DeviceParts for UnitParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::unit::describe(designer, config, &self.0);
    }

    fn model(&self, config: &Config) -> Box<dyn Model> {
        golden::unit::model(config, &self.0)
    }

    fn contract(&self, config: &Config) -> Box<dyn Contract> {
        golden::unit::contract(config, &self.0)
    }

    fn function_contracts(&self, config: &Config) -> Vec<Box<dyn Contract>> {
        let functions = self.0.functions.iter();
        functions.map(|it| golden::expression::contract(config, &it.planned)).collect()
    }

    fn refitted(&self, config: &Config) -> Option<PartsResult> {
        let refitted = keys::unit::refit(config, &self.0);
        Some(refitted.map(|plan| Arc::new(Self(Arc::new(plan))) as Arc<dyn DeviceParts>))
    }

    fn images(&self, config: &Config) -> Vec<StatedImage> {
        keys::unit::stated_images(config)
    }

    fn image_config(&self, config: &Config, formula: &str, error: Option<f64>) -> Option<Config> {
        keys::unit::written_function(config)?;
        Some(keys::unit::image_config(config, formula, error))
    }

    fn written_function(&self, config: &Config) -> Option<(String, usize)> {
        keys::unit::written_function(config)
    }
}

/// Plans the functions, proves their errors, and merges the plans. The error of a function without a plan names the function.
pub(super) fn unit(config: &Config) -> PartsResult {
    Ok(Arc::new(UnitParts(Arc::new(keys::unit::plan(config)?))))
}

struct ShadingParts(LightParts);

impl DeviceParts for ShadingParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::shading::describe(designer, config, &self.0);
    }

    fn model(&self, config: &Config) -> Box<dyn Model> {
        golden::shading::model(config, &self.0)
    }

    fn contract(&self, config: &Config) -> Box<dyn Contract> {
        golden::shading::contract(config, &self.0)
    }
}

/// Makes the configurations of the parts, and plans the formula of the highlight. The error of a part names the key to change.
pub(super) fn shading(config: &Config) -> PartsResult {
    Ok(Arc::new(ShadingParts(keys::shading::parts(config)?)))
}
