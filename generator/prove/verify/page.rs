//! Writes the results of `glint verify` as one HTML page that needs no other file.

use anyhow::Result;
use glint_base::template::Template;
use glint_show::pages::markup::html;
use serde::Serialize;
use serde_json::json;

use super::{CheckAnswer, CheckTime, VerificationRecord};

/// The HTML element that says which program wrote the page.
const MARKER: &str = "<meta name=\"generator\" content=\"glint verify\">";

#[glint_base::template::template("verification.html")]
struct Page<'a> {
    marker: &'static str,
    record: &'a VerificationRecord,
    class: String,
    counts: Vec<(String, &'static str, usize)>,
    checks: Vec<CheckView<'a>>,
    timings: Vec<(&'static str, String)>,
}

struct CheckView<'a> {
    answer: &'a CheckAnswer,
    class: String,
    question: String,
    domain: String,
    words: String,
    open: String,
    reads: String,
    tools: String,
}

impl<'a> CheckView<'a> {
    fn new(answer: &'a CheckAnswer) -> Self {
        let finding = &answer.finding;
        Self {
            class: class(finding.verdict),
            question: html(answer.question),
            domain: html(&finding.domain),
            words: html(&finding.words),
            open: html(&finding.open),
            reads: html(answer.reads),
            tools: html(&answer.tools.join("; ")),
            answer,
        }
    }
}

/// Writes the page. `timings` has each check's time, in the order of the record's checks. Only the last section of the page shows
/// times.
///
/// # Errors
///
/// Fails if the template fails.
pub fn page(record: &VerificationRecord, timings: &[CheckTime]) -> Result<String> {
    let counts = record.counts.iter();
    let checks = record.checks.iter();
    let page = Page {
        marker: MARKER,
        record,
        class: class(record.conclusion),
        counts: counts.map(|(&it, &count)| (class(it), it.words(), count)).collect(),
        checks: checks.clone().map(CheckView::new).collect(),
        timings: checks
            .zip(timings)
            .map(|(answer, timing)| (answer.title, format!("{:.1}", timing.seconds)))
            .collect(),
    };
    let mut text = page.render()?;
    text.push('\n');
    Ok(text)
}

/// Returns the class of a verdict or a conclusion in the style sheet, which is also its name in JSON, for example
/// `limit-reached`.
fn class(verdict: impl Serialize) -> String {
    json!(verdict).as_str().unwrap_or_default().to_owned()
}
