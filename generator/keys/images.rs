//! Plans writable tables of the device `function`: the polynomials of several functions for one datapath.
//!
//! A configuration names the functions that the table must hold. `glint table` later fits further functions to the same datapath.

use glint_approximate::{
    Curve, Identity, Piecewise, Refusal, RefusalKind, TargetFunction, Wish, find_images,
    reachable_image_error,
};
use glint_base::config_error::ConfigError;
use glint_base::identifier;
use glint_config::{Config, TableEntry, Value};
use glint_formula::parse;

use super::stated_function::{Keys, misread, stated_function};

/// The value of `approximation.tables` for a table that can be written.
const WRITABLE: &str = "writable";

pub(super) fn are_tables_writable(keys: &Keys) -> bool {
    keys.tables == WRITABLE
}

/// Checks the keys of a writable table; any other table is accepted.
///
/// # Errors
/// Fails if the keys ask for segments, a degree or a range reduction that a writable table cannot have, or if an image has a bad name
/// or a wrong formula.
pub(super) fn check(keys: &Keys) -> Result<(), ConfigError> {
    if !are_tables_writable(keys) {
        return Ok(());
    }
    if keys.reduction != Identity::None {
        return Err(ConfigError::new(
            "approximation.reduction",
            "a range reduction holds for one function, and a writable table gets others",
            "remove approximation.reduction, or set approximation.tables to \"fixed\"",
        ));
    }
    if !matches!(keys.segments.as_str(), "auto" | "uniform") {
        return Err(ConfigError::new(
            "approximation.segments",
            "the segments of a writable table are equally long",
            "set approximation.segments to \"uniform\", or approximation.tables to \"fixed\"",
        ));
    }
    if keys.degree == "0" {
        return Err(ConfigError::new(
            "approximation.degree",
            "a writable table has polynomials of degree 1 to 3",
            "set approximation.degree to \"auto\", \"1\", \"2\" or \"3\"",
        ));
    }
    let names: Vec<&str> = keys.images.0.iter().map(|image| image.name.as_str()).collect();
    check_names(&names, &|name| format!("images.{name}"))?;
    for image in &keys.images.0 {
        image_function(keys, image)?;
    }
    Ok(())
}

/// Checks that the names of images are identifiers that differ in more than upper and lower case, because they are parts of file
/// names. `key` returns the configuration key of an image for errors.
///
/// # Errors
/// Fails for the first wrong name.
pub(super) fn check_names(names: &[&str], key: &dyn Fn(&str) -> String) -> Result<(), ConfigError> {
    for (number, name) in names.iter().enumerate() {
        let remedy = "give the image another name";
        if let Err(reason) = identifier::check(name) {
            let message = format!("`{name}` cannot be the name of an image: {reason}");
            return Err(ConfigError::new(key(name), message, remedy));
        }
        if names[..number].iter().any(|other| other.eq_ignore_ascii_case(name)) {
            let message =
                format!("another image has the name `{name}`, apart from upper and lower case");
            return Err(ConfigError::new(key(name), message, remedy));
        }
    }
    Ok(())
}

/// Returns the function of an image, with the domain, the formats and the error of the configuration.
fn image_function(keys: &Keys, image: &TableEntry) -> Result<TargetFunction, ConfigError> {
    let text = image.text("formula").unwrap_or_default();
    let formula = parse(text).and_then(|formula| formula.of_operand("x"));
    let key = format!("images.{}.formula", image.name);
    let formula = formula.map_err(|fault| ConfigError { key, ..misread("", fault) })?;
    let own = stated_function(keys)?;
    Ok(TargetFunction { curve: Curve::Formula(formula), ..own })
}

/// Finds one datapath for `function` and for all images of the configuration. Returns the polynomials of `function`.
///
/// # Errors
/// Fails if no datapath keeps the error of all of them. The error names a key to change.
pub(super) fn find_common(
    keys: &Keys,
    function: &TargetFunction,
    wish: Wish,
) -> Result<Piecewise, ConfigError> {
    let mut functions = vec![function.clone()];
    for image in &keys.images.0 {
        functions.push(image_function(keys, image)?);
    }
    let found = find_images(&functions, wish).map_err(|refusal| unplanned(keys, refusal))?;
    Ok(found.into_iter().next().expect("the image of the function itself"))
}

/// A further function that a configuration states for a writable table.
pub struct StatedImage {
    pub name: String,
    pub formula: String,
    /// The configuration of the core with this formula in place of its own.
    pub config: Config,
}

/// Returns the images of a configuration. A core without a writable table has none.
pub fn stated(config: &Config) -> Vec<StatedImage> {
    let keys = Keys::of(config);
    if !are_tables_writable(&keys) {
        return Vec::new();
    }
    let mut images = Vec::new();
    for image in &keys.images.0 {
        let formula = image.text("formula").unwrap_or_default();
        images.push(StatedImage {
            name: image.name.clone(),
            formula: formula.to_owned(),
            config: self::config(config, formula, None),
        });
    }
    images
}

/// Returns the configuration of a core with another formula, in place of its own formula or samples, and with another allowed error if
/// it is given.
pub fn config(config: &Config, formula: &str, error: Option<f64>) -> Config {
    let mut changed = config.clone();
    changed.set("function.formula", Value::Text(formula.to_owned()));
    changed.set("function.samples", Value::Text(String::new()));
    if let Some(error) = error {
        changed.set("result.error", Value::Number(error));
    }
    changed
}

/// Fits another function to the datapath of `table`.
///
/// # Errors
/// Fails if the table cannot be written, or cannot hold the function with its error.
pub(super) fn refit(
    table: &Piecewise,
    function: &TargetFunction,
) -> Result<Piecewise, ConfigError> {
    if !table.is_writable {
        return Err(ConfigError::new(
            "approximation.tables",
            "the table of this core is a ROM",
            "set approximation.tables to \"writable\", and generate the core again",
        ));
    }
    table.image(function).map_err(|refusal| unheld(table, function, refusal))
}

/// Turns the refusal of a datapath for all functions into an error of a key.
fn unplanned(keys: &Keys, refusal: Refusal) -> ConfigError {
    let (key, remedy) = match refusal.kind {
        RefusalKind::NoValue => {
            ("function.from", "exclude such operands: change function.from or function.to")
        }
        _ if keys.images.0.is_empty() => (
            "result.error",
            "allow a larger result.error, or set approximation.tables to \"fixed\"",
        ),
        _ => ("result.error", "allow a larger result.error, or remove an image"),
    };
    ConfigError::new(key, refusal.message, remedy)
}

/// Turns the refusal of an image into an error of the formula.
fn unheld(table: &Piecewise, function: &TargetFunction, refusal: Refusal) -> ConfigError {
    let remedy = match refusal.kind {
        RefusalKind::NoValue => {
            "the table covers the whole domain of the core: choose a function with a value at each operand"
                .to_owned()
        }
        _ => {
            let larger = reachable_image_error(table, function)
                .map_or(String::new(), |error| format!("allow an error of {error} units, or "));
            format!("{larger}add the function to the table `images` of the configuration, and generate the core again")
        }
    };
    ConfigError::new("function.formula", refusal.message, remedy).at(refusal.place)
}
