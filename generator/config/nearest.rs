//! Suggests the valid word for a misspelt one, and joins words for a sentence.

/// Returns the candidate that is most similar to `word`. At most a third of the letters of the longer word may differ, or one
/// letter in shorter words. Otherwise returns the first candidate that begins with `word`, if `word` has more than two bytes.
/// Returns `None` for a `word` of more than 100 bytes.
///
/// The comparison ignores case and the difference between `-` and `_`. The first of equally similar candidates wins.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let fold = |text: &str| text.to_lowercase().replace('-', "_");
    // A longer word is no misspelling, and the time of the comparison grows with the square of the length.
    if word.len() > 100 {
        return None;
    }
    let word = fold(word);
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let distance = |candidate: &&&str| strsim::damerau_levenshtein(&word, &fold(candidate));
    let best = candidates.iter().min_by_key(distance)?;
    let longest = word.chars().count().max(best.chars().count());
    // At most a third of the letters may be wrong, or one letter in words of two.
    let slip = Some(best).filter(|best| distance(best) * 3 <= longest.max(3));
    let begins = |candidate: &&&str| word.len() > 2 && fold(candidate).starts_with(&word);
    slip.or_else(|| candidates.iter().find(begins)).copied()
}

/// Joins words for a sentence. For example, `a`, `b` and `c` become `a, b and c`.
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [only] => only.as_ref().to_owned(),
        [start @ .., last] => {
            let start: Vec<&str> = start.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", start.join(", "), last.as_ref())
        }
    }
}
