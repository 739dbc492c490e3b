use std::sync::LazyLock;

use super::*;

static LEDGER: LazyLock<Vec<Claim>> = LazyLock::new(ledger);

fn find(id: &str) -> &'static Claim {
    let found = LEDGER.iter().find(|claim| claim.id == id);
    found.unwrap_or_else(|| panic!("no claim `{id}`"))
}

impl Claim {
    /// Our figure under a definition.
    fn figure(&self, key: &str) -> Option<f64> {
        let found = self.ours.iter().find(|measured| measured.key == key)?;
        Some(found.value)
    }
}

#[test]
fn claims_are_as_stated() {
    let lines = include_str!("stated.txt").lines().filter(|line| !line.starts_with('#'));
    for line in lines {
        let (id, rest) = line.split_once(": ").expect("a claim");
        let (claim, mut parts) = (find(id), rest.split(", "));
        let verdict = serde_json::to_value(claim.verdict).expect("a word");
        assert_eq!(Some(verdict), parts.next().map(Into::into), "{line}");
        for part in parts {
            let (key, percent) = part.split_once(' ').expect("a figure");
            let figure = claim.figure(key).unwrap_or_else(|| panic!("no `{key}`: {claim:?}"));
            let digits = percent.split_once('.').map_or(0, |(_, digits)| digits.len());
            assert_eq!(format!("{:.digits$}", 100.0 * figure), percent, "{id}, {key}");
        }
    }
}

#[test]
fn w_is_not_twenty_times_as_accurate() {
    for id in ["ratio-epicentre", "ratio-blooming"] {
        let claim = find(id);
        // 9.9 over 0.75 is the largest of the ratios.
        assert!(claim.ours.iter().all(|one| one.value < 13.5), "{claim:?}");
    }
}

#[test]
fn w_fails_for_small_exponents() {
    let claim = find("w16-one-per-cent");
    assert!(claim.words.starts_with("It fails for n = 2…7,"), "{claim:?}");
}

#[test]
fn five_multiplications() {
    assert_eq!(find("multiplications").figure("count"), Some(5.0));
}

/// By hand: the parabola is a square, 0 where n/2·(1 − cos γ) = 1, and (n/2 − 1)² at 90°; (1 − 2/16)¹⁶ = 0.118.
#[test]
fn the_shape_of_w() {
    assert_eq!(find("falling").ours[2].text, "2401");
    let zero = find("zero");
    let at = |key| zero.figure(key).expect("a figure");
    assert!(at("m-2") < 1e-20 && (at("m-16") - 0.875f64.powi(16)).abs() < 1e-9, "{zero:?}");
}

#[test]
fn powers_of_w_against_each_other_and_schlick() {
    // W with m = 4 is exact at n = 4, and so is m = 8 at n = 8.
    let power = find("better-with-power");
    for key in ["inflection", "level-0.46", "level-0.20"] {
        let one = power.ours.iter().find(|one| one.key == key).expect("a region");
        let exact =
            [4, 8].map(|n: u32| one.text.contains(&n.to_string()) || one.text.contains('…'));
        assert!(exact[0] && exact[1] && one.value < 20.0, "{one:?}");
    }
    // Schlick's function is cos γ at n = 1.
    let ahead = find("ahead-of-schlick");
    assert!((1.0..16.0).contains(&ahead.figure("level-0.46").expect("a figure")), "{ahead:?}");
}

#[test]
fn the_patent_of_rough() {
    let code = find("inverse-code");
    assert_eq!(code.ours[0].text, "65536 of 65536");
    assert_eq!((code.figure("ulps"), code.figure("ulps-after-n")), (Some(1.0), Some(500.0)));
    let second = find("adder-31");
    assert_eq!((second.figure("ones"), second.figure("zeros")), (Some(1.0), Some(0.0)));
    // Word 0 is in clock 1, «Кінець» in word 9; then comes the clock of the next start.
    let clocks = find("ten-clocks");
    let figures: Vec<f64> = clocks.ours.iter().map(|one| one.value).collect();
    assert_eq!(figures, [10.0, 10.0, 11.0]);
}

#[test]
fn ids_are_unique_and_words_are_plain() {
    let claims = &LEDGER;
    for (at, claim) in claims.iter().enumerate() {
        assert!(claims[..at].iter().all(|other| other.id != claim.id));
        assert!(!claim.ours.is_empty(), "{claim:?}");
        assert!(claim.ours.iter().all(|one| one.value.is_finite()), "{claim:?}");
        assert!(!claim.words.contains("NaN") && claim.words.ends_with('.'), "{claim:?}");
    }
}

#[test]
fn verdicts_of_an_upper_limit() {
    let one = |value| Measured {
        key: String::new(),
        definition: String::new(),
        value,
        text: String::new(),
        n: None,
    };
    let of =
        |values: &[f64]| upper(&values.iter().map(|value| one(*value)).collect::<Vec<_>>(), 0.08);
    assert_eq!(of(&[0.03, 0.0804]), Verdict::Holds);
    assert_eq!(of(&[0.03, 0.0806]), Verdict::Depends);
    assert_eq!(of(&[0.0806]), Verdict::Nearly);
    assert_eq!(of(&[0.09]), Verdict::Fails);
}

#[test]
fn exponents_in_runs() {
    assert_eq!(runs(&[2, 3, 4, 7, 9, 10]), "2…4, 7, 9…10");
}
