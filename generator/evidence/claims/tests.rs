use std::sync::LazyLock;

use super::*;

static LEDGER: LazyLock<Vec<Claim>> = LazyLock::new(ledger);

fn find(id: &str) -> &'static Claim {
    let found = LEDGER.iter().find(|claim| claim.id == id);
    found.unwrap_or_else(|| panic!("no claim `{id}`"))
}

/// Figures in per cent as the device catalogue states them, each with the digits that it gives.
fn states(id: &str, key: &str, percent: f64, digits: i32) {
    let claim = find(id);
    let figure = claim.figure(key).unwrap_or_else(|| panic!("`{id}` has no `{key}`: {claim:?}"));
    let scale = libm::pow(10.0, f64::from(digits));
    let rounded = libm::round(100.0 * figure * scale) / scale;
    assert_eq!(rounded, percent, "{id}, {key}: {figure}");
}

#[test]
fn w_before_the_inflection_point() {
    states("w4-epicentre", "inflection", 3.3, 1);
    states("w4-epicentre", "level-0.46", 8.2, 1);
    states("w8-epicentre", "inflection", 1.6, 1);
    states("w8-epicentre", "level-0.46", 3.8, 1);
    states("w16-epicentre", "inflection", 0.75, 2);
    states("w16-epicentre", "level-0.46", 1.8, 1);
    for id in ["w4-epicentre", "w8-epicentre", "w16-epicentre"] {
        assert_eq!(find(id).verdict, Verdict::Depends, "{id}");
    }
}

#[test]
fn schlick_in_three_regions() {
    states("schlick-epicentre", "inflection", 9.9, 1);
    states("schlick-epicentre", "level-0.46", 22.3, 1);
    states("schlick-blooming", "level-0.20", 91.0, 0);
    states("schlick-blooming", "level-0.19", 97.0, 0);
    assert_eq!(find("schlick-under-ten").verdict, Verdict::Holds);
}

#[test]
fn w_in_the_blooming_zone() {
    states("w4-blooming", "level-0.20", 35.7, 1);
    states("w8-blooming", "level-0.20", 16.6, 1);
    states("w16-blooming", "level-0.20", 7.8, 1);
    for id in ["w4-blooming", "w8-blooming", "w16-blooming"] {
        assert_eq!(find(id).verdict, Verdict::Nearly, "{id}");
    }
}

#[test]
fn w_is_not_twenty_times_as_accurate() {
    for id in ["ratio-epicentre", "ratio-blooming"] {
        let claim = find(id);
        assert_eq!(claim.verdict, Verdict::Fails);
        // 9.9 over 0.75 is the largest of the ratios.
        assert!(claim.ours.iter().all(|one| one.value < 13.5), "{claim:?}");
    }
}

#[test]
fn w_fails_for_small_exponents() {
    let claim = find("w16-one-per-cent");
    assert_eq!(claim.verdict, Verdict::Fails);
    assert!(claim.words.starts_with("It fails for n = 2…7,"), "{claim:?}");
}

#[test]
fn powers_of_a_stretched_cosine() {
    states("quad-large", "n-7", 0.79, 2);
    states("quad-small", "n-3", 1.09, 2);
    states("four-powers", "k-9-n-4", 1.6, 1);
    states("prototype", "inflection", 4.7, 1);
    states("prototype", "level-0.46", 12.0, 0);
    for id in ["quad-large", "quad-small", "prototype"] {
        assert_eq!(find(id).verdict, Verdict::Fails, "{id}");
    }
}

#[test]
fn five_multiplications() {
    let claim = find("multiplications");
    assert_eq!(claim.figure("count"), Some(5.0));
    assert_eq!(claim.verdict, Verdict::Fails);
}

/// By hand: the parabola is a square, 0 where n/2·(1 − cos γ) = 1, and (n/2 − 1)² at 90°; (1 − 2/16)¹⁶ = 0.118.
#[test]
fn the_shape_of_w() {
    for id in ["not-negative", "falling"] {
        assert_eq!(find(id).verdict, Verdict::Holds, "{id}");
    }
    assert_eq!(find("falling").ours[2].text, "2401");
    let zero = find("zero");
    assert_eq!(zero.verdict, Verdict::Depends);
    let at = |key| zero.figure(key).expect("a figure");
    assert!(at("m-2") < 1e-20 && (at("m-16") - 0.875f64.powi(16)).abs() < 1e-9, "{zero:?}");
}

#[test]
fn powers_of_w_against_each_other_and_schlick() {
    // W with m = 4 is exact at n = 4, and so is m = 8 at n = 8.
    let power = find("better-with-power");
    assert_eq!(power.verdict, Verdict::Depends);
    for key in ["inflection", "level-0.46", "level-0.20"] {
        let one = power.ours.iter().find(|one| one.key == key).expect("a region");
        let exact =
            [4, 8].map(|n: u32| one.text.contains(&n.to_string()) || one.text.contains('…'));
        assert!(exact[0] && exact[1] && one.value < 20.0, "{one:?}");
    }
    // Schlick's function is cos γ at n = 1.
    let ahead = find("ahead-of-schlick");
    assert_eq!(ahead.verdict, Verdict::Depends);
    assert!((1.0..16.0).contains(&ahead.figure("level-0.46").expect("a figure")), "{ahead:?}");
}

#[test]
fn the_patent_of_rough() {
    let code = find("inverse-code");
    assert_eq!(code.verdict, Verdict::Depends);
    assert_eq!(code.ours[0].text, "65536 of 65536");
    assert_eq!((code.figure("ulps"), code.figure("ulps-after-n")), (Some(1.0), Some(500.0)));
    let second = find("adder-31");
    assert_eq!(second.verdict, Verdict::Contradictory);
    assert_eq!((second.figure("ones"), second.figure("zeros")), (Some(1.0), Some(0.0)));
    // Word 0 is in clock 1, «Кінець» in word 9; then comes the clock of the next start.
    let clocks = find("ten-clocks");
    assert_eq!(clocks.verdict, Verdict::Holds);
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
