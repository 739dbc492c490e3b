//! Opens the devices whose configurations state formulas: `function`, `expression` and `shading`. Their formulas are planned once,
//! and the hardware description, the golden model and the contract read the plan.

use std::sync::Arc;

use glint_catalogue as devices;
use glint_config::Config;
use glint_golden::{self as golden, Contract, Model};
use glint_keys as keys;
use glint_keys::function::FunctionPlan;
use glint_keys::shading::LightParts;
use glint_plan::ProvedPlan;
use glint_rtl::dsl::Designer;

use super::PartsResult;
use super::opened::DeviceParts;

struct FunctionParts(FunctionPlan);

impl DeviceParts for FunctionParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::function::describe(designer, config, &self.0);
    }

    fn model(&self, _: &Config) -> Box<dyn Model> {
        golden::function::model(&self.0)
    }

    fn contract(&self, _: &Config) -> Box<dyn Contract> {
        golden::function::contract(&self.0)
    }
}

/// Opens a configuration of the device `function`: finds polynomials for its function.
///
/// # Errors
/// Fails if the function has no polynomials with the allowed error. The error names the key to change.
pub(super) fn function(config: &Config) -> PartsResult {
    Ok(Arc::new(FunctionParts(keys::function::plan(config)?)))
}

struct ExpressionParts(Arc<ProvedPlan>);

impl DeviceParts for ExpressionParts {
    fn describe(&self, designer: &Designer, config: &Config) {
        devices::expression::describe(designer, config, &self.0);
    }

    fn model(&self, _: &Config) -> Box<dyn Model> {
        golden::expression::model(&self.0)
    }

    fn contract(&self, _: &Config) -> Box<dyn Contract> {
        golden::expression::contract(&self.0)
    }
}

/// Opens a configuration of the device `expression`: plans its formulas, and proves the error of each result.
///
/// # Errors
/// Fails if a formula has no plan with the allowed error. The error names the formula.
pub(super) fn expression(config: &Config) -> PartsResult {
    Ok(Arc::new(ExpressionParts(Arc::new(keys::expression::plan(config)?))))
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

/// Opens a configuration of the device `shading`: makes the configurations of its parts, and plans the formula of its highlight.
///
/// # Errors
/// Fails if a part refuses its configuration. The error names the key to change.
pub(super) fn shading(config: &Config) -> PartsResult {
    Ok(Arc::new(ShadingParts(keys::shading::parts(config)?)))
}
