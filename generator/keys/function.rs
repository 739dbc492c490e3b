//! Finds the piecewise polynomial for the function that a configuration of the device `function` states.

use std::sync::Arc;

use glint_approximate::{
    Layout, Piecewise, Refusal, RefusalKind, TargetFunction, UnsuitedReduction, Wish, find,
    reachable_error,
};
use glint_base::config_error::ConfigError;
use glint_config::{Config, Problems, Schema};
use glint_plan::{ExpressionPlan, StatedOperand};

use super::images;
pub use super::stated_function::Keys;
use super::stated_function::stated_function;

pub fn schema() -> Schema {
    Schema { device: "function", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let [formula, samples] = ["function.formula", "function.samples"];
    if config.text(samples).is_empty() && problems.gives(samples) {
        // The samples could not be read, and the reader has already reported the problem. The default of the formula must not
        // replace them.
        return;
    }
    if !config.text(samples).is_empty() && problems.gives(formula) {
        let message = format!("`{formula}` and `{samples}` are both given");
        return problems.push(formula, message, "remove one of the two keys");
    }
    let keys = Keys::of(config);
    let checked = stated_function(&keys).and_then(|_| images::check(&keys));
    if let Err(error) = checked {
        problems.push_error(error);
    }
}

pub struct FunctionPlan {
    /// The function with its domain and the allowed error.
    pub function: TargetFunction,
    /// The polynomials that approximate the function, with a proved bound of the error.
    pub polynomials: Arc<Piecewise>,
    /// The operations that evaluate the polynomials.
    pub plan: ExpressionPlan,
}

/// Finds polynomials that approximate the function of a configuration, and proves a bound of the error.
///
/// # Errors
/// Fails if the formula, the samples or the domain are wrong, if no approximation can be found, or if the planner refuses the
/// approximation. The error names a key to change.
pub fn plan(config: &Config) -> Result<FunctionPlan, ConfigError> {
    let keys = Keys::of(config);
    let function = stated_function(&keys)?;
    let wish = Wish {
        degree: keys.degree.parse().ok(),
        layout: Layout::NAMES.iter().find(|it| it.0 == keys.segments).map(|it| it.1),
        identity: keys.reduction,
        prefix: None,
        most_cells: None,
        least_words: 0,
    };
    if images::are_tables_writable(&keys) {
        let polynomials = images::find_common(&keys, &function, wish)?;
        return FunctionPlan::of_polynomials(function, Arc::new(polynomials));
    }
    let polynomials = find(&function, wish).map_err(|refusal| refused(refusal, &function, wish))?;
    FunctionPlan::of_polynomials(function, polynomials)
}

impl FunctionPlan {
    /// Plans the operations that evaluate the polynomials.
    fn of_polynomials(
        function: TargetFunction,
        polynomials: Arc<Piecewise>,
    ) -> Result<Self, ConfigError> {
        let plan = ExpressionPlan::of_function(&function, &polynomials).map_err(|refusal| {
            ConfigError::new("operand.fraction", refusal.message, "set a smaller operand.fraction")
        })?;
        Ok(Self { function, polynomials, plan })
    }

    /// Plans the function of `config` for the datapath of this plan, whose configuration differs only in the function and in the
    /// allowed error.
    ///
    /// # Errors
    /// Fails if the table of this plan cannot be written, or cannot hold the function with its error.
    pub fn with_function_of(&self, config: &Config) -> Result<Self, ConfigError> {
        let function = stated_function(&Keys::of(config))?;
        let polynomials = images::refit(&self.polynomials, &function)?;
        Self::of_polynomials(function, Arc::new(polynomials))
    }
}

/// Turns the refusal of the search into an error of the key that the user should change.
fn refused(refusal: Refusal, function: &TargetFunction, wish: Wish) -> ConfigError {
    const SMALLER: &str = "set a smaller operand.fraction";
    const DIVIDED: &str = "use device = \"expression\", which divides such a domain into octaves, or set a smaller \
                           operand.fraction";
    let (key, remedy) = match refusal.kind {
        RefusalKind::NoValue => (
            "function.formula",
            "exclude such operands from the domain: change function.from or function.to".to_owned(),
        ),
        RefusalKind::OperandBits { most } => {
            ("operand.fraction", format!("set operand.fraction to at most {most}"))
        }
        RefusalKind::ManyOperandsOfSamples => ("operand.fraction", SMALLER.to_owned()),
        RefusalKind::ResultBits => {
            ("result.fraction", "set fewer fraction bits, or another domain".to_owned())
        }
        RefusalKind::Error => {
            let larger = match reachable_error(function, wish) {
                Some(error) => format!("set result.error to {error}, or "),
                None => String::new(),
            };
            ("result.error", format!("{larger}{SMALLER} or result.fraction"))
        }
        RefusalKind::ErrorExceeded => ("result.error", "allow a larger error".to_owned()),
        RefusalKind::Unproved => ("result.error", DIVIDED.to_owned()),
        RefusalKind::Reduction(why) => {
            let remedy = match why {
                UnsuitedReduction::NoReduction => "set approximation.reduction to \"none\"",
                UnsuitedReduction::NoIdentity => {
                    "set approximation.reduction to \"none\" or to another identity"
                }
                UnsuitedReduction::OneSide => {
                    "set approximation.reduction to \"none\", or change function.from"
                }
                UnsuitedReduction::FromZero => "set function.from to the smallest operand above 0",
                UnsuitedReduction::NoPeriod => {
                    "scale the operand, for example sin(2 * pi * x) from 0 to 1"
                }
                UnsuitedReduction::Bits => "set other fraction bits, or another domain",
                UnsuitedReduction::ManyOperands => DIVIDED,
            };
            ("approximation.reduction", remedy.to_owned())
        }
    };
    ConfigError::new(key, refusal.message, remedy).at(refusal.place)
}

/// Returns the operand x, with the format and the domain of the piecewise polynomial.
pub fn operand(polynomials: &Piecewise) -> StatedOperand {
    StatedOperand {
        name: "x".to_owned(),
        format: polynomials.operand,
        domain: polynomials.domain,
        outside: polynomials.outside,
        doc: String::new(),
    }
}
