//! Defines lists of numbers in formulas, such as a vector's coordinates.
//!
//! A list exists only while a text is parsed. An operator on lists becomes an operator on each pair of elements. A function such
//! as `dot(a, b)` becomes a formula of the elements, such as `a_0 * b_0 + a_1 * b_1`. The parsed formulas contain only numbers.

use std::ops::Range;
use std::sync::Arc;

use super::{Expression, Fault, Function, Kind, Literal, Operator, TextSpan};

/// The largest number of elements of a list.
pub const LONGEST_LIST: usize = 16;

/// The functions that read a whole list, with their numbers of arguments. `min`, `max` and `hypot` are included, because they
/// also take a single list.
const LIST_FUNCTIONS: [(&str, usize); 13] = [
    ("sum", 1),
    ("mean", 1),
    ("variance", 1),
    ("length", 1),
    ("normalize", 1),
    ("normalise", 1),
    ("softmax", 1),
    ("min", 1),
    ("max", 1),
    ("hypot", 1),
    ("dot", 2),
    ("cross", 2),
    ("distance", 2),
];

pub(super) fn names_of_list_functions() -> impl Iterator<Item = &'static str> {
    LIST_FUNCTIONS.into_iter().map(|(name, _)| name).filter(|name| !is_also_of_numbers(name))
}

fn is_also_of_numbers(name: &str) -> bool {
    matches!(name, "min" | "max" | "hypot")
}

/// Returns the number of arguments of a function that reads only lists, or `None` for any other name.
pub(super) fn arguments_of(name: &str) -> Option<usize> {
    let (_, count) = LIST_FUNCTIONS.iter().find(|(own, _)| *own == name)?;
    (!is_also_of_numbers(name)).then_some(*count)
}

/// A list of numbers, which is a part of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberList {
    /// The formulas of the elements, at least one.
    pub elements: Vec<Arc<Expression>>,
    /// A letter for each element, such as `xyz`, or `None` if the elements have only numbers.
    pub axes: Option<String>,
    /// The location of the list in the text.
    pub span: TextSpan,
}

impl NumberList {
    fn new(elements: Vec<Arc<Expression>>, axes: Option<String>, span: Range<usize>) -> Self {
        Self { elements, axes, span: span.into() }
    }

    fn fault<T>(&self, message: String) -> Result<T, Fault> {
        Err(Fault::new(self.span.clone(), message))
    }

    /// Returns the element with the index `index`, counted from 0. Fails if `index` is no integer or is beyond the last element.
    pub(super) fn element(&self, index: &Expression) -> Result<Expression, Fault> {
        let number = index.rational().filter(|value| value.is_int());
        let place = number.and_then(|value| usize::try_from(value.numerator().clone()).ok());
        match place.and_then(|place| self.elements.get(place)) {
            Some(element) => Ok((**element).clone()),
            None => {
                let last = self.elements.len() - 1;
                let message = format!("the index of this list is an integer from 0 to {last}");
                Err(Fault::new(index.span.clone(), message))
            }
        }
    }

    /// Returns the elements with the given axes. For example, `n.x` has one element, and `n.xy` two. Fails for a letter that is
    /// no axis of the list.
    pub(super) fn on_axes(&self, letters: &str, span: Range<usize>) -> Result<NumberOrList, Fault> {
        let Some(axes) = &self.axes else {
            return Err(Fault::new(span, "this list has no axes: write its index, as in `v[0]`"));
        };
        let mut elements = Vec::new();
        for letter in letters.chars() {
            match axes.chars().position(|axis| axis == letter) {
                Some(place) => elements.push(self.elements[place].clone()),
                None => {
                    let message = format!("`{letter}` is not one of the axes `{axes}`");
                    return Err(Fault::new(span, message));
                }
            }
        }
        Ok(match &elements[..] {
            [element] => Expression::clone(element).at(span).into(),
            _ => NumberOrList::List(Self::new(elements, Some(letters.to_owned()), span)),
        })
    }
}

/// A text's meaning: a number or a list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberOrList {
    /// A number's formula.
    Number(Arc<Expression>),
    /// The formulas of several numbers.
    List(NumberList),
}

impl From<Expression> for NumberOrList {
    fn from(formula: Expression) -> Self {
        Self::Number(Arc::new(formula))
    }
}

impl NumberOrList {
    /// Returns a number's formula.
    ///
    /// # Errors
    ///
    /// Fails for a list, at the list's location.
    pub fn number(self) -> Result<Arc<Expression>, Fault> {
        match self {
            Self::Number(formula) => Ok(formula),
            Self::List(list) => {
                let count = list.elements.len();
                let numbers = if count == 1 { "number" } else { "numbers" };
                list.fault(format!(
                    "this is a list of {count} {numbers}, and a single number is needed here"
                ))
            }
        }
    }

    /// Returns the formulas of all elements, or the only formula of a number.
    pub fn elements(&self) -> &[Arc<Expression>] {
        match self {
            Self::Number(formula) => std::slice::from_ref(formula),
            Self::List(list) => &list.elements,
        }
    }

    fn list(&self, name: &str) -> Result<&NumberList, Fault> {
        match self {
            Self::List(list) => Ok(list),
            Self::Number(number) => {
                let message = format!("`{name}` needs a list, and this is a number");
                Err(Fault::new(number.span.clone(), message))
            }
        }
    }
}

/// Makes a list of numbers from the formulas in brackets, such as `[x, y, 1]`. Fails if a part is a list, or if there are more
/// than `LONGEST_LIST` parts.
pub(super) fn list_of(parts: Vec<NumberOrList>, span: Range<usize>) -> Result<NumberOrList, Fault> {
    let mut elements = Vec::new();
    for part in parts {
        elements.push(part.number()?);
    }
    if elements.len() > LONGEST_LIST {
        return Err(Fault::new(span, format!("a list has at most {LONGEST_LIST} numbers")));
    }
    Ok(NumberOrList::List(NumberList::new(elements, None, span)))
}

/// Calls `make` with the arguments, or for lists with each group of elements, and returns the result or a list of the results. A
/// number counts as a list of equal numbers. Fails if two lists have different sizes, or if `make` fails.
pub(super) fn for_each_element(
    arguments: &[NumberOrList],
    span: &Range<usize>,
    mut make: impl FnMut(&[Expression]) -> Result<Expression, Fault>,
) -> Result<NumberOrList, Fault> {
    let mut first: Option<&NumberList> = None;
    let mut axes = None;
    for argument in arguments {
        let NumberOrList::List(list) = argument else { continue };
        axes = axes.or_else(|| list.axes.clone());
        let expected = first.get_or_insert(list);
        check_sizes(expected, list)?;
    }
    let Some(first) = first else {
        let numbers: Vec<Expression> =
            arguments.iter().map(|argument| (*argument.elements()[0]).clone()).collect();
        return Ok(make(&numbers)?.into());
    };
    let mut elements = Vec::new();
    for at in 0..first.elements.len() {
        let mut group = Vec::new();
        for argument in arguments {
            let place = if matches!(argument, NumberOrList::List(_)) { at } else { 0 };
            group.push((*argument.elements()[place]).clone());
        }
        elements.push(Arc::new(make(&group)?));
    }
    Ok(NumberOrList::List(NumberList::new(elements, axes, span.clone())))
}

/// Fails if two lists have different numbers of elements.
fn check_sizes(first: &NumberList, second: &NumberList) -> Result<(), Fault> {
    let (one, other) = (first.elements.len(), second.elements.len());
    if one == other {
        return Ok(());
    }
    second.fault(format!("this list has {other} numbers, and the one before it has {one}"))
}

/// Expands a call of a function that reads whole lists. `span` is the call's location. Fails if an argument is no list, or if two
/// lists have different sizes.
pub(super) fn list_function(
    name: &str,
    arguments: &[NumberOrList],
    span: Range<usize>,
) -> Result<NumberOrList, Fault> {
    let mut lists = Vec::new();
    for argument in arguments {
        lists.push(argument.list(name)?);
    }
    for list in &lists[1..] {
        check_sizes(lists[0], list)?;
    }
    let place = Place(TextSpan::from(span.clone()));
    let v = &lists[0].elements;
    let list = |elements: Vec<Arc<Expression>>| {
        NumberOrList::List(NumberList::new(elements, lists[0].axes.clone(), span.clone()))
    };
    Ok(match name {
        "sum" => NumberOrList::Number(place.joined(Operator::Add, v)),
        "min" => NumberOrList::Number(place.joined(Operator::Min, v)),
        "max" => NumberOrList::Number(place.joined(Operator::Max, v)),
        "mean" => NumberOrList::Number(place.mean(v)),
        "variance" => {
            let mean = place.mean(v);
            let apart: Vec<_> = v.iter().map(|it| place.binary(Operator::Sub, it, &mean)).collect();
            let squares: Vec<_> = apart.iter().map(|it| place.squared(it)).collect();
            NumberOrList::Number(place.mean(&squares))
        }
        "length" | "hypot" => NumberOrList::Number(place.length(v)),
        "normalize" | "normalise" => {
            let length = place.length(v);
            list(v.iter().map(|it| place.binary(Operator::Div, it, &length)).collect())
        }
        "softmax" => {
            // The largest number is subtracted first, so no power exceeds 1.
            let largest = place.joined(Operator::Max, v);
            let mut powers = Vec::new();
            for number in v {
                let below = place.binary(Operator::Sub, number, &largest);
                powers.push(place.part(Kind::Unary(Function::Exp, below)));
            }
            let sum = place.joined(Operator::Add, &powers);
            list(powers.iter().map(|it| place.binary(Operator::Div, it, &sum)).collect())
        }
        "dot" => NumberOrList::Number(place.dot(v, &lists[1].elements)),
        "distance" => {
            let pairs = v.iter().zip(&lists[1].elements);
            let apart: Vec<_> = pairs.map(|(a, b)| place.binary(Operator::Sub, a, b)).collect();
            NumberOrList::Number(place.length(&apart))
        }
        _ => list(place.cross(v, &lists[1].elements)?),
    })
}

/// The location of all parts that a function makes.
struct Place(TextSpan);

impl Place {
    fn part(&self, kind: Kind) -> Arc<Expression> {
        Arc::new(Expression::new(kind, self.0.clone()))
    }

    fn binary(
        &self,
        operator: Operator,
        a: &Arc<Expression>,
        b: &Arc<Expression>,
    ) -> Arc<Expression> {
        self.part(Kind::Binary(operator, a.clone(), b.clone()))
    }

    fn number(&self, value: usize) -> Arc<Expression> {
        let literal = Literal::read(&value.to_string()).expect("an integer is a number");
        self.part(Kind::Number(literal))
    }

    /// Joins all numbers by `operator`, as a tree of the least depth.
    fn joined(&self, operator: Operator, numbers: &[Arc<Expression>]) -> Arc<Expression> {
        match numbers {
            [only] => only.clone(),
            _ => {
                let (first, second) = numbers.split_at(numbers.len().div_ceil(2));
                let (first, second) = (self.joined(operator, first), self.joined(operator, second));
                self.binary(operator, &first, &second)
            }
        }
    }

    fn mean(&self, numbers: &[Arc<Expression>]) -> Arc<Expression> {
        let sum = self.joined(Operator::Add, numbers);
        self.binary(Operator::Div, &sum, &self.number(numbers.len()))
    }

    fn squared(&self, number: &Arc<Expression>) -> Arc<Expression> {
        self.binary(Operator::Power, number, &self.number(2))
    }

    fn length(&self, numbers: &[Arc<Expression>]) -> Arc<Expression> {
        let squares: Vec<_> = numbers.iter().map(|it| self.squared(it)).collect();
        self.part(Kind::Unary(Function::Sqrt, self.joined(Operator::Add, &squares)))
    }

    fn dot(&self, a: &[Arc<Expression>], b: &[Arc<Expression>]) -> Arc<Expression> {
        let mut products = Vec::new();
        for (a, b) in a.iter().zip(b) {
            products.push(if a == b { self.squared(a) } else { self.binary(Operator::Mul, a, b) });
        }
        self.joined(Operator::Add, &products)
    }

    /// Returns the cross product of two vectors. Fails unless they have three coordinates.
    fn cross(
        &self,
        a: &[Arc<Expression>],
        b: &[Arc<Expression>],
    ) -> Result<Vec<Arc<Expression>>, Fault> {
        let ([a0, a1, a2], [b0, b1, b2]) = (a, b) else {
            return Err(Fault::new(self.0.clone(), "`cross` needs two lists of three numbers"));
        };
        let difference = |[a, b, c, d]: [&Arc<Expression>; 4]| {
            let first = self.binary(Operator::Mul, a, b);
            let second = self.binary(Operator::Mul, c, d);
            self.binary(Operator::Sub, &first, &second)
        };
        Ok([[a1, b2, a2, b1], [a2, b0, a0, b2], [a0, b1, a1, b0]].map(difference).to_vec())
    }
}
