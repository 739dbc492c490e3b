//! A last line that vouches for those above, in files that no manifest speaks of.

use super::digest;

/// How the last line is a comment, in the language of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comment {
    /// `<!-- … -->`, which no reader of the page sees.
    Markdown,
    /// `# …`.
    Python,
}

impl Comment {
    fn line(self, above: &[u8]) -> String {
        let digest = digest(above);
        match self {
            Self::Markdown => format!("<!-- sha256 {digest} -->\n"),
            Self::Python => format!("# sha256 {digest}\n"),
        }
    }
}

/// The text, which ends with a newline, and the line that vouches for it.
pub fn sealed(text: String, comment: Comment) -> String {
    let line = comment.line(text.as_bytes());
    text + &line
}

/// Whether a file is as Glint wrote it: its last line vouches for those above.
pub fn is_sealed(contents: &[u8], comment: Comment) -> bool {
    let Some(body) = contents.strip_suffix(b"\n") else {
        return false;
    };
    let last = body.iter().rposition(|&byte| byte == b'\n');
    let (above, line) = contents.split_at(last.map_or(0, |at| at + 1));
    line == comment.line(above).as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edited_file_is_not_glints() {
        for (comment, other) in [
            (Comment::Markdown, Comment::Python),
            (Comment::Python, Comment::Markdown),
        ] {
            let file = sealed("# title\n\ntext\n".to_owned(), comment);
            let is_sealed = |text: &str| super::is_sealed(text.as_bytes(), comment);
            assert!(is_sealed(&file));
            assert!(!super::is_sealed(file.as_bytes(), other));
            assert!(!is_sealed(&file.replace("text", "test")));
            assert!(!is_sealed(&format!("{file}more\n")));
            assert!(!is_sealed(file.trim_end()));
            assert!(!is_sealed(""));
            assert!(!is_sealed("# title\n"));
        }
    }
}
