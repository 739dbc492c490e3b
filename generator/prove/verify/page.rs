//! Writes a verification as one HTML page that needs nothing but itself.

use anyhow::Result;
use glint_base::template::Template;

use super::{Answer, CheckTime, Conclusion, Record, Verdict};

/// The mark of a page that Glint wrote: nothing else is overwritten.
pub const MARKER: &str = "<meta name=\"generator\" content=\"glint verify\">";

#[glint_base::template::template("verification.html")]
struct Page<'a> {
    marker: &'static str,
    record: &'a Record,
    class: &'static str,
    counts: Vec<(&'static str, &'static str, usize)>,
    checks: Vec<View<'a>>,
    timings: Vec<(&'static str, String)>,
}

struct View<'a> {
    answer: &'a Answer,
    class: &'static str,
}

/// Returns the page; nothing before its last section depends on the timings.
///
/// # Errors
/// A template that fails.
pub fn page(record: &Record, timings: &[CheckTime]) -> Result<String> {
    let counts = record.counts.iter();
    let checks = record.checks.iter();
    let page = Page {
        marker: MARKER,
        record,
        class: match record.conclusion {
            Conclusion::Verified => "verified",
            Conclusion::InPart => "in-part",
            Conclusion::Incomplete => "incomplete",
            Conclusion::Failed => "failed",
        },
        counts: counts.map(|(&it, &count)| (class(it), it.words(), count)).collect(),
        checks: checks
            .clone()
            .map(|answer| View { answer, class: class(answer.finding.verdict) })
            .collect(),
        timings: checks
            .zip(timings)
            .map(|(answer, timing)| (answer.title, format!("{:.1}", timing.seconds)))
            .collect(),
    };
    let mut text = page.render()?;
    text.push('\n');
    Ok(text)
}

/// Returns the class of a verdict in the style sheet.
fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Proved => "proved",
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::Undecided => "undecided",
        Verdict::LimitReached => "limit-reached",
        Verdict::NotRun => "not-run",
        Verdict::Unconfirmed => "unconfirmed",
        Verdict::LeftOut => "left-out",
        Verdict::NotApplicable => "not-applicable",
    }
}
