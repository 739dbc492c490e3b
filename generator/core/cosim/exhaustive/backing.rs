//! Finds the evidence for the error bound that a contract states.
//!
//! A device of Glint has a proof in the Rust code of its golden model. For another device, the evidence is a record of `glint
//! cosim --exhaustive` or of `glint certify`. Datasheets and reports print the evidence next to the bound.

use std::fmt;
use std::path::Path;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::Record;
use glint_base::input;
use glint_base::program::Program;
use glint_golden::Contract;

/// The folder with the records of `glint certify`, inside the directory of the records.
const CERTIFICATES: &str = "certificates";

/// The largest accepted difference between the recorded and the stated bound, in units.
const SAME: f64 = 1e-9;

/// The evidence for the error bound that a contract states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Backing {
    /// Rust code in the golden model of a device of the catalogue proves the bound.
    Catalogue,
    /// The record of an exhaustive check proves the bound. The text is the path of the record.
    Exhaustive(String),
    /// The record of statements that the prover Gappa accepted proves the bound. The text is the path of the record.
    Certificate(String),
    /// Only the author of the contract states the bound.
    Author,
}

/// The record of `glint certify`: the result of a proof of a configuration.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Certificate {
    /// The version of Glint that wrote the record.
    pub glint: String,
    /// The path of the configuration file, as the user gave it.
    pub config: String,
    /// A digest that identifies the proved contract: [`crate::core::Core::contract_digest`].
    pub contract: String,
    /// The proved error bound, in units of the last bit of an output.
    pub bound: f64,
    /// Whether the prover Gappa accepted all statements.
    pub certified: bool,
    #[serde(default)]
    pub statements: usize,
    /// A digest of the Gappa scripts with these statements, SHA-256 in hexadecimal. `glint certify --out` writes the scripts.
    #[serde(default)]
    pub scripts: String,
}

impl Backing {
    /// Finds the evidence for a contract that is not in the catalogue, from the records in `directory`. `digest` is
    /// [`crate::core::Core::contract_digest`]. A record of an exhaustive check comes before a certificate.
    ///
    /// # Errors
    /// Fails if the directory or a record cannot be read, or if the record of the exhaustive check belongs to another sweep.
    pub fn of_records(directory: &Path, digest: &str, contract: &dyn Contract) -> Result<Self> {
        let shown = |path: &Path| path.display().to_string().replace('\\', "/");
        if let Some(record) = Record::find(directory, digest, contract)?
            && record.proves(contract)
        {
            return Ok(Self::Exhaustive(shown(&record.path)));
        }
        let units = contract.bounds().governing().units;
        let proves = |it: &Certificate| {
            it.certified && it.contract == digest && (it.bound - units).abs() <= SAME
        };
        let certificates =
            input::records::<Certificate>(&directory.join(CERTIFICATES))?.into_iter();
        let mut found = certificates.filter(|(_, it)| proves(it)).map(|(path, _)| shown(&path));
        Ok(found.next().map_or(Self::Author, Self::Certificate))
    }

    pub fn sentence(&self) -> String {
        match self {
            Self::Catalogue => "The bound is proven, not measured".to_owned(),
            Self::Exhaustive(path) => {
                format!("The bound holds for every combination of operands, by the record `{path}`")
            }
            Self::Certificate(path) => {
                format!("The bound is proven by Gappa, by the record `{path}`")
            }
            Self::Author => format!(
                "The bound is stated by its author, and is not proved yet: prove it with `{Program} \
                 certify`, or with `{Program} cosim --exhaustive --json` if all operands can be computed"
            ),
        }
    }
}

/// Prints the evidence as an attribute of the bound, for example "proven by Gappa".
impl fmt::Display for Backing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Catalogue => "proven",
            Self::Exhaustive(_) => "proven by all operands",
            Self::Certificate(_) => "proven by Gappa",
            Self::Author => "stated by its author",
        })
    }
}
