//! Finds polynomials whose table can be written at run time: several functions have the same bit widths, so that one datapath
//! evaluates all of them, and only the words of the table differ.
//!
//! The words for one function are an *image* of the table. [`find_images`] chooses the widths for a set of functions;
//! [`Piecewise::image`] fits a further function to a datapath that exists already.

use super::seen::AllowedResults;
use super::shared::{SharedWidths, find_with_widths};
use super::table::{Table, Widths};
use super::{Layout, Piecewise, Refusal, RefusalKind, TargetFunction, Wish, search};
use glint_base::fixed::{Format, MAX_WIDTH};

/// The degrees to choose from. A table of results (degree 0) would have a word for each operand.
const DEGREES: std::ops::RangeInclusive<u32> = 1..=3;

/// The most fraction bits that every coefficient gets beyond the narrowest ones, until all functions keep their errors.
const MOST_GUARD: i32 = 3;

/// The integer bits of each coefficient except the constant that no function of the set needs, so that steeper functions fit too.
const SPARE: i32 = 1;

/// Returns an image for each function, in their order, for the cheapest datapath that keeps the error of all of them. The functions
/// must have the same domain and the same formats. Each coefficient is signed, and all but the constant have a spare bit.
///
/// # Errors
/// Fails if the domain has more than 2^26 operands, if a function has no value at an operand, or if no datapath keeps the error of
/// all functions. `wish` may state the degree; its other choices do not apply.
pub fn find_images(functions: &[TargetFunction], wish: Wish) -> Result<Vec<Piecewise>, Refusal> {
    let mut cheapest: Option<(f64, Vec<Piecewise>)> = None;
    let mut refusal = None;
    for degree in DEGREES {
        if wish.degree.is_some_and(|wanted| wanted != degree) {
            continue;
        }
        match images_of_degree(functions, degree) {
            Ok(images) => {
                let cost = images[0].rom_cells() + search::STEP * f64::from(degree);
                if cheapest.as_ref().is_none_or(|(least, _)| cost < *least) {
                    cheapest = Some((cost, images));
                }
            }
            Err(why) => refusal = Some(why),
        }
    }
    match (cheapest, refusal) {
        (Some((_, images)), _) => Ok(images),
        (None, Some(refusal)) => Err(refusal),
        (None, None) => Err(unkept("a table that can be written has polynomials of degree 1 to 3")),
    }
}

/// Returns the images for polynomials of one degree. Fails if a domain has more than 2^26 operands, if a function has no value at
/// an operand, or if no datapath keeps the error of all functions.
fn images_of_degree(functions: &[TargetFunction], degree: u32) -> Result<Vec<Piecewise>, Refusal> {
    let mut prefix = None;
    for function in functions {
        let own = narrowest(function, degree, None)?;
        prefix = prefix.max(Some(own.prefix));
    }
    let mut widths: Option<SharedWidths> = None;
    for function in functions {
        let own = narrowest(function, degree, prefix)?;
        widths = Some(widths.map_or_else(|| own.clone(), |widths| widths.max(&own)));
    }
    let widths = widths.ok_or_else(|| unkept("there is no function"))?;
    let mut refusal = unkept("the functions need wider coefficients");
    for more in 0..=MOST_GUARD {
        let wider = widths.with_guard(more);
        let found: Result<Vec<Piecewise>, Refusal> =
            functions.iter().map(|function| find_with_widths(function, &wider)).collect();
        match found {
            Ok(images) => return with_same_formats(images),
            Err(why) => refusal = why,
        }
    }
    Err(refusal)
}

/// Returns the narrowest bit widths of a table with polynomials of this degree that keeps the error of `function`. The table has
/// 2^`prefix` segments of equal length, or as few as possible if `prefix` is `None`. Fails if no widths keep the error, or if the
/// domain has more than 2^26 operands.
fn narrowest(
    function: &TargetFunction,
    degree: u32,
    prefix: Option<u32>,
) -> Result<SharedWidths, Refusal> {
    if function.is_wide() {
        return Err(unkept("a table that can be written has at most 2^26 operands"));
    }
    let wish =
        Wish { degree: Some(degree), layout: Some(Layout::Uniform), prefix, ..Wish::default() };
    let found = search::attempt_numbered(function, wish, function.numbering_without_overhang())?;
    let widths = found.as_ref().and_then(SharedWidths::of);
    widths.ok_or_else(|| unkept(&format!("degree {degree} does not keep the error")))
}

/// Widens the formats of all images to formats that hold every one of them, with a sign and a spare bit. Fails if a product would
/// then be too wide for a net.
fn with_same_formats(mut images: Vec<Piecewise>) -> Result<Vec<Piecewise>, Refusal> {
    let first = &images[0];
    let result = hull(images.iter().map(|image| image.result), first.result.frac);
    let mut coefficients = Vec::new();
    let mut sums = vec![result];
    for (k, format) in first.coefficients.iter().enumerate() {
        let whole = signed(hull(images.iter().map(|image| image.coefficients[k]), format.frac));
        coefficients.push(match k {
            // The constant is the value in the middle of a segment, which lies within the range of the results.
            0 => signed(Format { int: whole.int.max(result.int), ..whole }),
            _ => Format { int: whole.int + SPARE, ..whole },
        });
        if k > 0 {
            let sum = signed(hull(images.iter().map(|image| image.sums[k]), first.sums[k].frac));
            sums.push(Format { int: sum.int + SPARE, ..sum });
        }
    }
    for image in &mut images {
        image.coefficients.clone_from(&coefficients);
        image.sums.clone_from(&sums);
        image.result = result;
        image.is_writable = true;
    }
    match images[0].has_narrow_products() {
        true => Ok(images),
        false => Err(unkept(&format!("a product would have {MAX_WIDTH} bits or more"))),
    }
}

/// Returns the smallest format that holds all numbers of `formats`, which have `frac` fraction bits.
fn hull(formats: impl Iterator<Item = Format> + Clone, frac: i32) -> Format {
    let low = formats.clone().map(Format::min_raw).min().unwrap_or(0);
    let high = formats.map(Format::max_raw).max().unwrap_or(0);
    Format::holding(low, high, frac)
}

fn signed(format: Format) -> Format {
    Format { signed: true, ..format }
}

fn unkept(message: &str) -> Refusal {
    Refusal::new(RefusalKind::Error, message.to_owned())
}

impl Piecewise {
    /// Returns the image of another function for the same datapath: the same segments, formats and widths, other words, and the
    /// proved bound for `function`. The function must have the domain and the operand format of these polynomials.
    ///
    /// # Errors
    /// Fails if no coefficients of these formats keep the error of `function`, if a sum or a result does not fit its format, or if the
    /// function has no value at an operand.
    pub fn image(&self, function: &TargetFunction) -> Result<Self, Refusal> {
        let numbering = function.numbering_without_overhang();
        let misses = || {
            unkept(&format!(
                "no coefficients of this table keep an error of {} units",
                function.error
            ))
        };
        let seen = AllowedResults::new(function, 0.0, numbering)?.ok_or_else(misses)?;
        if hull([self.result, seen.result].into_iter(), self.result.frac) != self.result {
            let message = format!(
                "the results of this function need the format {}, and the core has {}",
                seen.result, self.result
            );
            return Err(Refusal::new(RefusalKind::ResultBits, message));
        }
        let guard = self.coefficients.iter().map(|it| it.frac - self.result.frac).collect();
        let offset = self.steps.iter().map(|step| step.offset).collect();
        let widths = Widths { guard, offset };
        let table = Table::new(&seen, self.segments).within(&self.coefficients);
        let words = table.fitted(&widths).ok_or_else(misses)?;
        let fitted = table.finished(&widths, words).ok_or_else(misses)?;
        let image = Self { words: fitted.words, bound: f64::INFINITY, ..self.clone() };
        let bound = image.prove(function)?;
        Ok(Self { bound, ..image })
    }
}

/// Returns an error above the allowed error of `function` that an image for the datapath of `table` keeps, in units of the result's
/// last bit. The function tries only a few such errors.
pub fn reachable_image_error(table: &Piecewise, function: &TargetFunction) -> Option<f64> {
    let larger = search::NEAREST.iter().copied().filter(|error| *error > function.error);
    larger.into_iter().find(|&error| {
        let relaxed = TargetFunction { error, ..function.clone() };
        table.image(&relaxed).is_ok()
    })
}
