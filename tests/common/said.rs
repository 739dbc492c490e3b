//! Reads test cases from a text: each case is a file, followed by the lines that Glint is expected to print about it.

/// A file, and what is said of it.
pub struct Case {
    /// The heading above it and those before it.
    pub heading: &'static str,
    /// The text of the file.
    pub file: String,
    /// The lines that begin with `-> `, without that.
    pub said: Vec<&'static str>,
}

/// Returns the cases of a text: a file, the lines that are said of it, and an empty line; with headings, which begin with `## `, and
/// comments, which begin with `#`.
pub fn cases(text: &'static str) -> Vec<Case> {
    let (mut cases, mut heading) = (Vec::new(), "");
    for block in text.split("\n\n") {
        heading = block.lines().find_map(|line| line.strip_prefix("## ")).unwrap_or(heading);
        let lines = || block.lines().filter(|line| !line.starts_with('#'));
        let said: Vec<&str> = lines().filter_map(|line| line.strip_prefix("-> ")).collect();
        if !said.is_empty() {
            let file = lines().filter(|line| !line.starts_with("-> "));
            let file = file.map(|line| format!("{line}\n")).collect();
            cases.push(Case { heading, file, said });
        }
    }
    cases
}
