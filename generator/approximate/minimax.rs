//! Fits polynomials to points so that the largest distance is as small as possible, by exchanging reference points (the Remez
//! algorithm). For example, the best constant for x² from −1 to 1 is 1/2, at a distance of at most 1/2.

/// The most coefficients; the degree is at most 3.
const MOST: usize = 4;

/// The most exchanges. The search ends earlier if the largest error equals the error at the reference points, or lies at a
/// reference point.
const EXCHANGES: usize = 30;

/// Returns the polynomial of degree `degree`, at most 3, with the smallest largest distance from `values` at the points `at`,
/// and this distance. If the search does not settle within [`EXCHANGES`] exchanges of a point, it is the best polynomial until
/// then. The coefficients start with the constant; unused ones are 0. The points must be in rising order. With no more points
/// than coefficients, the polynomial passes through all points, with a lower degree if necessary, and the distance is 0.
pub fn minimax(at: &[f64], values: &[f64], degree: usize) -> ([f64; MOST], f64) {
    let count = degree.min(at.len().saturating_sub(1)) + 1;
    if at.len() <= count {
        let all: Vec<usize> = (0..at.len()).collect();
        return (level(at, values, &all, false).0, 0.0);
    }
    // The reference starts with the extrema of the Chebyshev polynomial, each as an index of the nearest point.
    let mut reference: Vec<usize> = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let part = (1.0 - libm::cos(std::f64::consts::PI * k as f64 / count as f64)) / 2.0;
        reference.push((part * (at.len() - 1) as f64 + 0.5) as usize);
    }
    for k in 1..=count {
        reference[k] = reference[k].max(reference[k - 1] + 1);
    }
    for k in (0..=count).rev() {
        reference[k] = reference[k].min(at.len() - 1 - (count - k));
    }
    let mut best = ([0.0; MOST], f64::INFINITY);
    for _ in 0..EXCHANGES {
        let (coefficients, height) = level(at, values, &reference, true);
        let error = |k: usize| values[k] - at_point(&coefficients, at[k]);
        let worst =
            (0..at.len()).max_by(|&a, &b| error(a).abs().total_cmp(&error(b).abs())).unwrap_or(0);
        let largest = error(worst).abs();
        if largest < best.1 {
            best = (coefficients, largest);
        }
        if largest <= height.abs() * (1.0 + 1e-9) || reference.contains(&worst) {
            break;
        }
        exchange(&mut reference, worst, &error);
    }
    best
}

/// Evaluates a polynomial; the coefficients start with the constant.
pub fn at_point(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * at + coefficient)
}

/// Puts the point `worst` into the reference, in exchange for another one, so that the signs of the errors at the reference
/// points still alternate. `error` gives the error at a point, by its index.
fn exchange(reference: &mut Vec<usize>, worst: usize, error: &dyn Fn(usize) -> f64) {
    let like = |other: usize| error(other) * error(worst) > 0.0;
    let place = reference.partition_point(|&point| point < worst);
    let last = reference.len() - 1;
    if place == 0 && !like(reference[0]) {
        reference.insert(0, worst);
        reference.pop();
    } else if place > last && !like(reference[last]) {
        reference.push(worst);
        reference.remove(0);
    } else if place == 0 || (place <= last && like(reference[place])) {
        reference[place] = worst;
    } else {
        reference[place - 1] = worst;
    }
}

/// Returns the polynomial for the reference points, given by their indices, and a height. With `levelled`, the polynomial misses
/// each value by this height, with alternating signs. Otherwise it passes through all values.
fn level(at: &[f64], values: &[f64], reference: &[usize], levelled: bool) -> ([f64; MOST], f64) {
    let count = reference.len();
    let columns = if levelled { count - 1 } else { count };
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
    for (k, &point) in reference.iter().enumerate() {
        let powers = std::iter::successors(Some(1.0), |power| Some(power * at[point]));
        let mut row: Vec<f64> = powers.take(columns).collect();
        if levelled {
            row.push(if k.is_multiple_of(2) { 1.0 } else { -1.0 });
        }
        row.push(values[point]);
        rows.push(row);
    }
    let solution = solve(rows);
    let mut coefficients = [0.0; MOST];
    coefficients[..columns].copy_from_slice(&solution[..columns]);
    (coefficients, if levelled { solution[columns] } else { 0.0 })
}

/// Solves a system of linear equations. A row has the coefficients of an equation, then its right side. A variable without a
/// pivot gets 0.
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for column in 0..count {
        let pivot = (column..count)
            .max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
            .unwrap_or(column);
        rows.swap(column, pivot);
        for other in 0..count {
            if other != column && rows[column][column] != 0.0 {
                let factor = rows[other][column] / rows[column][column];
                let pivot = rows[column].clone();
                for (entry, part) in rows[other].iter_mut().zip(&pivot).skip(column) {
                    *entry -= factor * part;
                }
            }
        }
    }
    (0..count).map(|k| if rows[k][k] == 0.0 { 0.0 } else { rows[k][count] / rows[k][k] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best polynomial of degree n − 1 for x^n on −1 … 1 is x^n minus the scaled Chebyshev polynomial of degree n. Its
    /// largest error is 2^(1−n).
    #[test]
    fn powers_are_missed_by_the_height_of_chebyshev_polynomials() {
        let at: Vec<f64> = (0..=4000).map(|k| f64::from(k) / 2000.0 - 1.0).collect();
        for degree in 0..=3usize {
            let values: Vec<f64> = at.iter().map(|x| x.powi(degree as i32 + 1)).collect();
            let (_, error) = minimax(&at, &values, degree);
            let height = 0.5f64.powi(degree as i32);
            assert!((error / height - 1.0).abs() < 1e-5, "degree {degree}: {error}");
        }
    }

    #[test]
    fn few_points_are_met() {
        let (at, values) = ([0.0, 1.0, 2.0], [1.0, 3.0, 11.0]);
        let (coefficients, error) = minimax(&at, &values, 3);
        assert_eq!(error, 0.0);
        for (x, y) in at.iter().zip(values) {
            assert!((at_point(&coefficients, *x) - y).abs() < 1e-12);
        }
    }
}
