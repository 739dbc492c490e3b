//! Makes one table of the tables of several functions. The upper bits of its address, the page, select the function.

use std::sync::Arc;

use glint_approximate::{
    Curve, HornerStep, Outside, Piecewise, Segments, SharedWidths, TargetFunction,
};
use glint_base::fixed::Format;

/// A table whose pages are the tables of functions with the same widths.
#[derive(Clone)]
pub(super) struct PagedTable {
    pub(super) polynomials: Arc<Piecewise>,
    /// The number of bits of an operand's number within a page.
    pub(super) number_bits: u32,
    /// The first page of each function, in the order of the tables.
    pub(super) pages: Vec<usize>,
    /// The number of bits of the page that come from the top of the operand's number, for each function.
    pub(super) page_bits: Vec<u32>,
}

/// Returns a table with pages for each different table in `tables`, which must have the same [`SharedWidths`] apart from the
/// number of segments and of bits of an offset. A page has as many segments as the smallest table; a larger table has several pages.
///
/// `are_pairs` says of each table whether a condition chooses between it and the table after or before it. The tables of such a pair have
/// an even page and the next one, if no other pair has one of them.
///
/// The operand of the new table is an integer: the page, and below it the number of the function's operand, whose top bits select the
/// segment. A function whose operands have fewer bits has zeros below its number. The value of the new table has the raw value of
/// the function's table.
pub(super) fn paged(tables: &[Arc<Piecewise>], are_pairs: &[bool]) -> PagedTable {
    let mut in_order: Vec<(&Piecewise, bool)> =
        tables.iter().map(|table| &**table).zip(are_pairs.iter().copied()).collect();
    // The first page of a table is then a multiple of the number of its pages.
    in_order
        .sort_by_key(|(table, is_of_pair)| (std::cmp::Reverse(table.segments.prefix), !is_of_pair));
    let mut distinct: Vec<&Piecewise> = Vec::new();
    for (table, _) in in_order {
        if !distinct.contains(&table) {
            distinct.push(table);
        }
    }
    let prefix = distinct.iter().map(|table| table.segments.prefix).min().expect("a table");
    let widths = distinct.iter().filter_map(|table| SharedWidths::of(table));
    let widths = widths.reduce(|a, b| a.max(&b)).expect("tables with widths");
    let rests = distinct.iter().map(|table| table.segments.rest());
    let number_bits = prefix + rests.max().expect("a table");
    let mut words = Vec::new();
    let mut firsts = Vec::new();
    for table in &distinct {
        firsts.push(words.len() >> prefix);
        let mut of_table = table.words.clone();
        // No operand reads the words behind the last one of a function.
        let last = of_table.last().expect("a table has words").clone();
        of_table.resize(1 << table.segments.prefix, last);
        words.extend(of_table);
    }
    let mut pages = Vec::new();
    let mut page_bits = Vec::new();
    for table in tables {
        let at = distinct.iter().position(|other| *other == &**table).expect("a table of the set");
        pages.push(firsts[at]);
        page_bits.push(table.segments.prefix - prefix);
    }
    let count = words.len() >> prefix;
    let bits = number_bits + usize::BITS - (count - 1).leading_zeros();
    let raw_format = |table: &Piecewise, format: Format| {
        let fraction = table.result.frac;
        Format { int: format.int + fraction, frac: format.frac - fraction, ..format }
    };
    let degree = widths.offset.len();
    let mut coefficients = Vec::new();
    let mut sums = Vec::new();
    for k in 0..=degree {
        let of_table = distinct.iter().map(|table| raw_format(table, table.coefficients[k]));
        coefficients.push(of_table.reduce(wide_enough).expect("a table"));
        let of_table = distinct.iter().map(|table| raw_format(table, table.sums[k]));
        sums.push(of_table.reduce(wide_enough).expect("a table"));
    }
    let mut steps = Vec::new();
    for (k, offset) in widths.offset.iter().enumerate() {
        let dropped = widths.guard[k + 1] + *offset as i32 - widths.guard[k];
        steps.push(HornerStep { offset: *offset, dropped: dropped.max(0) as u32 });
    }
    let segments = Segments { bits, prefix: prefix + bits - number_bits, ..distinct[0].segments };
    let rest = number_bits - prefix;
    let last = ((words.len() as i64) << rest) - 1;
    let polynomials = Piecewise {
        operand: Format::unsigned(bits as i32, 0),
        domain: (0, last),
        outside: Outside::Anything,
        reduction: None,
        origin: 0,
        segments,
        coefficients,
        words,
        steps,
        result: sums[0],
        sums,
        bound: f64::INFINITY,
        is_writable: false,
    };
    PagedTable { polynomials: Arc::new(polynomials), number_bits, pages, page_bits }
}

/// Returns a format that can represent all values of two formats, with the larger number of fraction bits.
pub(super) fn wide_enough(a: Format, b: Format) -> Format {
    let signed = a.signed || b.signed;
    Format { signed, int: a.int.max(b.int), frac: a.frac.max(b.frac) }
}

impl PagedTable {
    /// Returns a function for the table's node in the merged plan. Its formula is never evaluated: the error of each page was
    /// proved for the function's own plan.
    pub(super) fn function(&self) -> TargetFunction {
        TargetFunction {
            curve: Curve::Formula(glint_formula::Expression::operand("x")),
            domain: self.polynomials.domain,
            operand: self.polynomials.operand,
            outside: Outside::Anything,
            fraction: 0,
            error: f64::INFINITY,
        }
    }
}
