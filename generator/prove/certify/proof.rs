//! Runs Gappa on a statement, and optionally lets Coq check the proof that Gappa found.
//!
//! If Gappa assumes a hint without a proof, the statement counts as not proved. For a proved statement, the module also searches
//! a point at which all hypotheses hold. If it finds no point, it asks Gappa whether the hypotheses contradict each other.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::statement::Statement;
use super::witness;
use glint_tools::transient::Directory;
use glint_tools::{LimitReached, Tool};

/// Whether the hypotheses of a proved statement can hold. If they cannot, the statement is true but says nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProofSubject {
    /// There is a point at which all hypotheses hold, for example `x = -0.5, y = 3`.
    Point(String),
    /// Gappa proves that the hypotheses contradict each other.
    Nothing,
    /// Neither a point nor a contradiction was found.
    Unknown,
}

pub enum ProofOutcome {
    /// Gappa accepted a script and, if Coq was given, Coq accepted the proof. The fields are the index of this script in
    /// [`Statement::scripts`], and whether the script's hypotheses can hold.
    Proved(usize, ProofSubject),
    /// The statement is not proved. The text is Gappa's or Coq's answer to the last script, or the time limit that Gappa
    /// reached.
    Open(String),
}

/// Runs Gappa on a statement's scripts, in order, until Gappa accepts one. With `coq`, Coq must also accept the proof. `limit` is
/// the time limit of each run of Gappa; Coq has ten times as long.
///
/// # Errors
///
/// Fails if Gappa or Coq cannot be run or is killed, or if Gappa cannot write its proof for Coq. Fails if Coq takes too long. If
/// Gappa does not prove the statement within the limit, or if Coq refuses the proof, the outcome is [`ProofOutcome::Open`].
pub fn prove(
    gappa: &Tool,
    coq: Option<&Tool>,
    statement: &Statement,
    limit: Duration,
) -> Result<ProofOutcome> {
    let dir = Directory::new().context("cannot make a temporary directory")?;
    let mut why = String::new();
    for (number, script) in statement.scripts.iter().enumerate() {
        fs::write(dir.path().join("statement.g"), script)
            .context("cannot write a script for Gappa")?;
        let run = match gappa.run(["statement.g"], dir.path(), limit) {
            Ok(run) => run,
            Err(error) if error.is::<LimitReached>() => {
                why = format!("Gappa did not end within {} s", limit.as_secs());
                continue;
            }
            Err(error) => return Err(error),
        };
        if run.status.code().is_none() {
            bail!("`{gappa}` failed ({}): {}", run.status, run.output.trim());
        }
        // If Gappa cannot prove a rewriting of a hint, it assumes the rewriting, and says so.
        let assumed = run.output.contains("trivially equal");
        if !run.status.success() || assumed {
            let mut lines =
                run.output.lines().filter(|line| line.contains("rror") || line.contains("best"));
            why = lines
                .next_back()
                .unwrap_or("Gappa assumes a step without a proof")
                .trim()
                .to_owned();
            continue;
        }
        if let Some(coq) = coq {
            let proof = gappa.run(["-Bcoq", "statement.g"], dir.path(), limit)?;
            if !proof.status.success() {
                bail!(
                    "Gappa proves a statement, but cannot write the proof for Coq: {}",
                    proof.output
                );
            }
            // Gappa writes warnings between the proof's lines.
            let lines = proof.output.lines().filter(|line| !line.starts_with("Warning:"));
            let proof: String = lines.flat_map(|line| [line, "\n"]).collect();
            fs::write(dir.path().join("statement.v"), proof)
                .context("cannot write a proof for Coq")?;
            let check = coq.run(["statement.v"], dir.path(), limit * 10)?;
            if !check.status.success() {
                why = format!(
                    "Coq rejects the proof: {}",
                    check.output.lines().next().unwrap_or_default()
                );
                continue;
            }
        }
        let subject = subject(gappa, script, limit)?;
        return Ok(ProofOutcome::Proved(number, subject));
    }
    Ok(ProofOutcome::Open(why))
}

/// Searches a point at which the hypotheses of an accepted script hold. If the search finds no point, asks Gappa whether the
/// hypotheses contradict each other.
fn subject(gappa: &Tool, script: &str, limit: Duration) -> Result<ProofSubject> {
    if let Some(point) = witness::witness(script) {
        return Ok(ProofSubject::Point(point));
    }
    let Some(asked) = witness::contradiction(script) else { return Ok(ProofSubject::Unknown) };
    let dir = Directory::new().context("cannot make a temporary directory")?;
    fs::write(dir.path().join("statement.g"), asked).context("cannot write a script for Gappa")?;
    match gappa.run(["statement.g"], dir.path(), limit) {
        Ok(run) if run.status.success() => Ok(ProofSubject::Nothing),
        Ok(_) => Ok(ProofSubject::Unknown),
        Err(error) if error.is::<LimitReached>() => Ok(ProofSubject::Unknown),
        Err(error) => Err(error),
    }
}
