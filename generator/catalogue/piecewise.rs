//! Builds the hardware of a piecewise polynomial: a table of coefficients, and Horner's rule with one product and one sum in
//! each step. The devices `function`, `expression`, `unit`, `blinn` and `gauss` use it.
//!
//! The position of the operand within its domain addresses the table, which gives the coefficients of the operand's segment.
//! One multiplier serves all polynomials of a device; in a pipeline, each step can get its own.

use std::ops::Range;

use glint_approximate::{HornerStep, Layout, Piecewise};
use glint_base::fixed::{Format, MAX_WIDTH, Overflow, Rounding};
use glint_plan::SMALLEST_BLOCK;
use glint_rtl::dsl::{Designer, OperandMux, Register, SharedProduct, Signal, StepSetting};

/// A note on a table that can be written.
pub(super) const WRITABLE_TABLE: &str = "The table can be written: raise table_write with an address and the coefficients until table_ready is high. \
     `glint table` finds the coefficients for another function, and proves their error.";

/// One multiplier for all steps of all polynomials, and for other products, each in its own microinstruction.
pub struct StepMultiplier<'d> {
    d: &'d Designer,
    name: String,
    /// The mux of the first factors, and the shared product; `None` if the device has at most one product.
    shared: Option<(OperandMux<'d>, SharedProduct<'d>)>,
}

impl<'d> StepMultiplier<'d> {
    /// The four names are for the select lines, the two operands and the product. `others` has the names and factors of products
    /// that belong to no polynomial. No two products may have the same first factor, by which a microinstruction selects them.
    pub fn new(
        d: &'d Designer,
        [select, sums, offsets, product]: [&str; 4],
        polynomials: &[&PolynomialDatapath<'d, '_>],
        others: &[(String, [Signal<'d>; 2])],
    ) -> Self {
        let mut all: Vec<(String, [Signal<'d>; 2])> = Vec::new();
        for polynomial in polynomials {
            for step in polynomial.steps() {
                if let Some(factors) = polynomial.factors(step) {
                    all.push((format!("{}x{}", polynomial.prefix, step + 1), factors));
                }
            }
        }
        all.extend_from_slice(others);
        let shared = (all.len() > 1).then(|| {
            let choices: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
            let select = d.select(select, &choices);
            let sums = d.bus(sums, select, all.iter().map(|(_, [sum, _])| *sum));
            let offsets = d.bus(offsets, select, all.iter().map(|(_, [_, offset])| *offset));
            let product = d.shared_mul(product, &sums, &offsets);
            (sums, product)
        });
        Self { d, name: product.to_owned(), shared }
    }

    /// Connects the register of one step of a polynomial, and returns the settings that execute this step.
    pub fn step(&self, polynomial: &PolynomialDatapath<'d, '_>, step: usize) -> Vec<StepSetting> {
        let register = polynomial.register(step).expect("the register of a step");
        register.takes(self.sum(polynomial, step));
        let mut settings = self.settings(polynomial, step);
        settings.push(register.load());
        settings
    }

    /// Connects the registers of the partial sums of a polynomial without a register for its value. Returns the settings of each
    /// step, the last step first, and the value, which the caller must load in the last step.
    pub fn steps_to_value(
        &self,
        polynomial: &PolynomialDatapath<'d, '_>,
    ) -> (Vec<Vec<StepSetting>>, Signal<'d>) {
        let mut of_steps = vec![self.settings(polynomial, 0)];
        for step in 1..polynomial.count() {
            of_steps.push(self.step(polynomial, step));
        }
        (of_steps, self.sum(polynomial, 0))
    }

    /// Returns the settings that select the factors of a step.
    fn settings(&self, polynomial: &PolynomialDatapath<'d, '_>, step: usize) -> Vec<StepSetting> {
        let factors = polynomial.factors(step);
        factors.and_then(|factors| self.pick(factors)).into_iter().collect()
    }

    /// Builds the sum of a step: its coefficient plus the product.
    fn sum(&self, polynomial: &PolynomialDatapath<'d, '_>, step: usize) -> Signal<'d> {
        let product = polynomial.factors(step).map(|factors| self.product(factors));
        polynomial.sum(step, product)
    }

    /// Returns the product of a pair of factors. If the device has several products, [`StepMultiplier::new`] must have received
    /// the pair.
    pub fn product(&self, [first, second]: [Signal<'d>; 2]) -> Signal<'d> {
        match &self.shared {
            Some((_, product)) => product.of(first, second),
            None => self.d.mul(&self.name, first, second),
        }
    }

    /// Returns the setting that selects a pair of factors, or `None` for the only product of a device.
    pub fn pick(&self, [first, _]: [Signal<'d>; 2]) -> Option<StepSetting> {
        let (factors, _) = self.shared.as_ref()?;
        Some(factors.pick(first))
    }
}

/// How the table of a polynomial stores its coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Tables {
    /// Whether each coefficient has its own table. Otherwise one word has all coefficients of a segment, or several tables if the
    /// word would be wider than a net can be.
    pub split: bool,
    /// Whether the table is read at the rising clock edge, so that the coefficients arrive one clock after the address.
    pub synchronous: bool,
    /// Whether a register holds the highest coefficient, which a microinstruction before the first sum loads.
    pub holds_highest: bool,
}

impl Tables {
    /// In a pipeline, each coefficient of a small table has its own table, because registers then delay the address instead of
    /// the wider coefficient. Otherwise, one block memory has all coefficients.
    pub fn of(it: &Piecewise, is_pipelined: bool) -> Self {
        let split = is_pipelined && it.rom_bits() < SMALLEST_BLOCK;
        Self { split, synchronous: true, holds_highest: false }
    }
}

/// Reads the bits of a signal as an integer.
pub(super) fn whole(x: Signal) -> Signal {
    let Format { signed, .. } = x.format();
    let int = x.format().width() as i32 - i32::from(signed);
    x.read_as(Format { int, frac: 0, ..x.format() })
}

/// Builds the number of an operand within the domain of a table, as [`Piecewise::number`] computes it.
pub(super) fn number<'d>(d: &'d Designer, name: &str, x: Signal<'d>, it: &Piecewise) -> Signal<'d> {
    let width = x.format().width() as i32;
    let integer = |bits: i32| Format::unsigned(bits, 0);
    let bits = it.segments.number_bits() as i32;
    let origin = i128::from(it.origin);
    if origin == it.operand.min_raw() {
        return match it.operand.signed {
            true => flipped(d, name, x, integer(width)),
            false => x.read_as(integer(width)),
        };
    }
    let first = d.raw_constant("first", origin, Format::holding(origin, origin, 0));
    let number = d.sub(name, whole(x), first);
    if number.format() == integer(bits) { number } else { number.bits(0, integer(bits)) }
}

pub struct PolynomialDatapath<'d, 'p> {
    d: &'d Designer,
    it: &'p Piecewise,
    prefix: String,
    /// The coefficients of the operand's segment, the constant first.
    coefficients: Vec<Signal<'d>>,
    /// The offset from the middle of the segment, shortened to the bits that each step multiplies.
    offsets: Vec<Signal<'d>>,
    /// The register of the whole polynomial. `None` if several operands share the table, so that each value has a register elsewhere.
    value: Option<Register<'d>>,
    /// The partial sums. Register number k has the sum of the terms from coefficient k + 1 on.
    partial_sums: Vec<Register<'d>>,
    /// The register of the highest coefficient, if it has one.
    highest: Option<Register<'d>>,
}

impl<'d, 'p> PolynomialDatapath<'d, 'p> {
    /// Makes the table, and the registers of the whole polynomial and of the partial sums. The three names are names of these
    /// registers, the whole polynomial first; with `None` in its place, the value has no register. Other names begin with
    /// `prefix`. `number` is the position of the operand in its domain, an integer of
    /// [`glint_approximate::Segments::number_bits`] bits. `number` must be stable while the sums are loaded, and also one clock
    /// earlier if the table is read at the rising clock edge.
    pub fn new(
        d: &'d Designer,
        prefix: &str,
        [value, partial_sums @ ..]: [Option<&str>; 3],
        number: Signal<'d>,
        it: &'p Piecewise,
        tables: Tables,
    ) -> Self {
        let (address, offset) = place(d, prefix, number, it);
        let coefficients = table(d, prefix, address, it, tables);
        let cut = |step: &HornerStep| {
            let offset = offset.expect("a polynomial has an offset");
            let width = step.offset as i32;
            let whole = it.segments.extra_bit() as i32 - 1;
            offset.bits(it.segments.rest() - step.offset, Format::signed(whole, width))
        };
        let offsets = it.steps.iter().map(cut).collect();
        let value = value.map(|name| d.register(name, it.sums[0]));
        let partial_sums = partial_sums.iter().flatten().zip(it.sums.iter().skip(1));
        let partial_sums: Vec<Register> = partial_sums
            .take(it.degree().saturating_sub(1))
            .map(|(name, format)| d.register(name, *format))
            .collect();
        let highest = tables.holds_highest.then(|| {
            let last = it.degree();
            let register = d.register(&format!("{prefix}highest"), it.coefficients[last]);
            register.takes(coefficients[last]);
            register
        });
        Self {
            d,
            it,
            prefix: prefix.to_owned(),
            coefficients,
            offsets,
            value,
            partial_sums,
            highest,
        }
    }

    /// Returns the numbers of Horner's steps in the order of execution; the last is 0.
    pub fn steps(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.count()).rev()
    }

    fn count(&self) -> usize {
        self.it.degree().max(1)
    }

    /// Returns the register of a step, which step number 0 may lack.
    fn register(&self, step: usize) -> Option<&Register<'d>> {
        match step {
            0 => self.value.as_ref(),
            _ => self.partial_sums.get(step - 1),
        }
    }

    /// Returns the factors of a step's product: the sum of the previous step, or the highest coefficient, and the offset. A
    /// constant polynomial has no product.
    fn factors(&self, step: usize) -> Option<[Signal<'d>; 2]> {
        let offset = *self.offsets.get(step)?;
        let above = self.partial_sums.get(step).or(self.highest.as_ref());
        let above = above.map(|register| register.q());
        Some([above.unwrap_or(self.coefficients[step + 1]), offset])
    }

    fn sum(&self, step: usize, product: Option<Signal<'d>>) -> Signal<'d> {
        let Self { d, it, prefix, .. } = self;
        let coefficient = self.coefficients[step];
        let sum = product.map_or(coefficient, |product| {
            let dropped = it.steps[step].dropped;
            let (low, high) = product.range();
            let kept = Format::holding(low >> dropped, high >> dropped, it.coefficients[step].frac);
            let name = format!("{prefix}product{step}");
            let cut = d.narrow(&name, product, kept, Rounding::Truncate, Overflow::Wrap);
            d.add(&format!("{prefix}added{step}"), coefficient, cut)
        });
        let name = format!("{prefix}kept{step}");
        d.narrow(&name, sum, it.sums[step], Rounding::Truncate, Overflow::Wrap)
    }

    /// Returns the setting that loads the register of the highest coefficient.
    ///
    /// # Panics
    /// Panics if there is no such register.
    pub fn load_highest(&self) -> StepSetting {
        self.highest.expect("a register of the highest coefficient").load()
    }

    /// Returns the value of the polynomial, which is valid after all steps.
    ///
    /// # Panics
    /// Panics if the polynomial has no register for its value.
    pub fn q(&self) -> Signal<'d> {
        self.value.expect("a register of the value").q()
    }
}

/// Inverts the top bit, and reads the word in a format of the same width. For example, an unsigned number becomes its signed
/// distance from the middle.
pub(super) fn flipped<'d>(
    d: &'d Designer,
    name: &str,
    word: Signal<'d>,
    format: Format,
) -> Signal<'d> {
    let low = word.format().width() - 1;
    let top = d.not(&format!("{name}_top"), word.bit(low));
    if low == 0 {
        return top.read_as(format);
    }
    d.join(name, &[top, word.bits(0, Format::unsigned(low as i32, 0))], format)
}

/// Builds the address of the segment in the table, and the operand's offset from the middle of the segment. A constant polynomial
/// needs no offset.
fn place<'d>(
    d: &'d Designer,
    prefix: &str,
    number: Signal<'d>,
    it: &Piecewise,
) -> (Signal<'d>, Option<Signal<'d>>) {
    let cut = it.segments;
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let number = match cut.layout {
        Layout::Halving => d.not(&format!("{prefix}mirrored"), number),
        _ => number,
    };
    let words = usize::BITS - (cut.words() - 1).leading_zeros();
    // The address and the position within the segment for the operands of one block of segments. The position begins with the
    // bits that every block has.
    let arm = |block: u32| {
        let rest = cut.rest_of(block);
        let base = d.raw_constant("block", i128::from(block) << cut.prefix, integer(words));
        let word = if cut.prefix == 0 {
            base
        } else {
            d.beside(base, number.bits(rest, integer(cut.prefix)), integer(words))
        };
        let way = (it.degree() > 0).then(|| {
            if rest == 0 {
                return d.raw_constant("no_rest", 0, integer(cut.rest()));
            }
            let places = (cut.rest() - rest) as i32;
            number.bits(0, integer(rest)).with_fraction(places).shift_left(places)
        });
        (word, way)
    };
    let (mut word, mut way) = arm(0);
    for block in 1..=cut.octaves {
        let low = cut.bits - cut.octaves + block - 1;
        let above = number.bits(low, integer(cut.number_bits() - low));
        let here = d.any(&format!("{prefix}octave{block}"), above);
        let (own, own_way) = arm(block);
        word = d.choose(&format!("{prefix}word{block}"), here, [word, own]);
        way = way
            .zip(own_way)
            .map(|(below, own)| d.choose(&format!("{prefix}way{block}"), here, [below, own]));
    }
    let name = format!("{prefix}offset");
    if cut.overhang == 0 {
        let format = Format::signed(-1, cut.rest() as i32);
        return (word, way.map(|way| flipped(d, &name, way, format)));
    }
    let beyond = number.bit(cut.bits).named(&format!("{prefix}beyond"));
    let last = d.raw_constant("last", cut.words() as i128 - 1, word.format());
    let word = d.choose(&format!("{prefix}segment"), beyond, [word, last]);
    (word, way.map(|way| offset_with_overhang(d, &name, way, beyond)))
}

/// Builds the offset from the middle of a segment. `way` is the offset from its beginning. If `beyond` is 1, the operand lies
/// beyond the last segment, and its offset is half a segment plus `way`.
fn offset_with_overhang<'d>(
    d: &'d Designer,
    name: &str,
    way: Signal<'d>,
    beyond: Signal<'d>,
) -> Signal<'d> {
    let rest = way.format().width();
    let top = d.not(&format!("{name}_top"), way.bit(rest - 1));
    let no_sign = d.raw_constant("no_sign", 0, Format::BIT);
    let sign = d.choose(&format!("{name}_sign"), beyond, [top, no_sign]);
    let low = way.bits(0, Format::unsigned(rest as i32 - 1, 0));
    d.join(name, &[sign, top, low], Format::signed(0, rest as i32))
}

/// Builds the tables, and returns the coefficients of the addressed segment, the constant first.
fn table<'d>(
    d: &'d Designer,
    prefix: &str,
    address: Signal<'d>,
    it: &Piecewise,
    tables: Tables,
) -> Vec<Signal<'d>> {
    let mut parts: Vec<Range<usize>> = Vec::new();
    let width = |part: &Range<usize>| -> u32 {
        it.coefficients[part.clone()].iter().map(|format| format.width()).sum()
    };
    for k in 0..it.coefficients.len() {
        match parts.last_mut() {
            Some(part) if !tables.split && width(&(part.start..k + 1)) <= MAX_WIDTH => {
                part.end = k + 1
            }
            _ => parts.push(k..k + 1),
        }
    }
    let last = it.words.len() - 1;
    let reached = usize::try_from(address.range().1).unwrap_or(last);
    let (mut signals, mut memories) = (Vec::new(), Vec::new());
    for part in &parts {
        let formats = &it.coefficients[part.clone()];
        let packed = |word: usize| {
            let words = it.words[word.min(last)][part.clone()].iter().zip(formats);
            words.fold(0i128, |all, (&word, format)| {
                all << format.width() | i128::from(format.bits(word.into()))
            })
        };
        let words: Vec<i128> = (0..=reached).map(packed).collect();
        let mut below = width(part);
        let format = Format::unsigned(below as i32, 0);
        let name = if part.start == 0 {
            format!("{prefix}coefficients")
        } else {
            format!("{prefix}coefficients{}", part.start)
        };
        let doc = match part.len() {
            1 => "coefficient of the polynomial of a segment",
            _ => "coefficients of the polynomial of a segment, the constant term in the top bits",
        };
        let rom = d.rom(&name, address, format, &words, tables.synchronous).doc(doc);
        let named = |k: usize| (format!("c{k}"), it.coefficients[k]);
        memories.push((rom, part.clone().map(named).collect()));
        for (k, format) in part.clone().zip(formats) {
            below -= format.width();
            signals.push(rom.out().bits(below, *format).named(&format!("{prefix}c{k}")));
        }
    }
    if it.is_writable {
        d.write_port(&memories);
    }
    signals
}
