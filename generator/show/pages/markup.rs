//! Converts plain text with names in backquotes to HTML.

/// Returns `text` as HTML, with names in `code` elements. Escapes `&`, `<`, `>` and `"`. For example, `` `a<b` `` becomes
/// `<code>a&lt;b</code>`.
pub fn html(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    // A last backquote without a partner remains a backquote.
    let names = text.matches('`').count() / 2;
    let mut quotes = 0;
    for sign in text.chars() {
        match sign {
            '`' if quotes < 2 * names => {
                html += if quotes % 2 == 0 { "<code>" } else { "</code>" };
                quotes += 1;
            }
            '&' => html += "&amp;",
            '<' => html += "&lt;",
            '>' => html += "&gt;",
            '"' => html += "&quot;",
            _ => html.push(sign),
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_code_and_signs_are_signs() {
        assert_eq!(html("`a<b` & c > `d`"), "<code>a&lt;b</code> &amp; c &gt; <code>d</code>");
        assert_eq!(html("one ` alone"), "one ` alone");
    }
}
