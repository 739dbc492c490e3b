//! Formats numbers for sentences.

/// Formats `number` with spaces between the thousands. For example, 20530 becomes `20 530`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Returns a number with its noun, such as `1 net`, `12 nets` and `1 200 nets`.
pub fn counted(number: usize, thing: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{} {thing}{plural}", grouped(number as u64))
}

/// Rounds a limit up to `places` decimals, so the result is still a limit. For example, 0.12 with one decimal becomes `0.2`.
pub fn rounded_up(limit: f64, places: usize) -> String {
    let text = format!("{limit:.places$}");
    match text.parse::<f64>() {
        Ok(nearest) if nearest < limit => {
            format!("{:.places$}", limit + 10f64.powi(-(places as i32)))
        }
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_have_three_digits() {
        let found = [7, 84, 100, 1000, 20_530, 100_000, 1_048_577_000].map(grouped);
        assert_eq!(found, ["7", "84", "100", "1 000", "20 530", "100 000", "1 048 577 000"]);
    }
}
