//! Merges the plans of several functions into one plan with an opcode.
//!
//! The nodes of each plan are copied in their order. Where several functions have an operation in the same slot ([`MergedOperation`]), the
//! merged plan has a single node for all, and choices by the opcode select its inputs. Shared operations work on raw integers, so
//! that the functions may have different binary points. Two functions that compute the same value share its nodes too.

use std::sync::Arc;

use glint_approximate::{Outside, Piecewise, SharedWidths};
use glint_base::fixed::{Format, Rounding};
use glint_formula::Enclosure;

use super::align::{MergedOperation, SharedKind, shared_operations, slots};
use super::tables::{PagedTable, paged, wide_enough};
use super::{UnitFunction, opcode_bits};
use crate::node::{Approximation, NodeId, Operation, PlanNode};
use crate::plan::ExpressionPlan;
use crate::refusal::PlanRefusal;
use crate::statement::StatedOperand;

const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

struct Merger<'u> {
    functions: &'u [UnitFunction],
    plan: ExpressionPlan,
    opcode: NodeId,
    /// The nodes of the operand ports behind the opcode.
    ports: Vec<NodeId>,
    /// For each function and each node of its plan, the node of the merged plan with its value.
    nodes: Vec<Vec<NodeId>>,
    /// The table of all functions, if a single table serves all slots.
    common_table: Option<SetTable>,
}

/// One table for several polynomials of functions.
#[derive(Clone)]
struct SetTable {
    /// For each polynomial, its function and its node.
    members: Vec<(usize, NodeId)>,
    tables: Vec<Arc<Piecewise>>,
    paged: PagedTable,
}

/// Returns the merged plan. Its operands are `ports`, the opcode first, and its results are words with the given formats. With
/// `shares_tables`, one table serves all polynomials of shared widths. A function can read it several times, one after the other.
///
/// # Errors
/// Fails if an operation has too many bits.
pub(super) fn merged(
    functions: &[UnitFunction],
    ports: &[StatedOperand],
    results: &[(&'static str, Format)],
    shares_tables: bool,
) -> Result<ExpressionPlan, PlanRefusal> {
    let mut plan = ExpressionPlan { is_shared: true, ..ExpressionPlan::default() };
    let mut nodes = Vec::new();
    for (number, port) in ports.iter().enumerate() {
        nodes.push(plan.operand(number, &port.name, port.format, port.domain)?);
    }
    let opcode = nodes.remove(0);
    let mut merger = Merger {
        functions,
        plan,
        opcode,
        ports: nodes,
        nodes: vec![Vec::new(); functions.len()],
        common_table: None,
    };
    let slots = slots(&merger.sequences());
    if shares_tables {
        let of_tables = slots.iter().filter(|slot| slot.kind == SharedKind::Table);
        let members: Vec<(usize, NodeId)> = of_tables.flat_map(MergedOperation::present).collect();
        merger.common_table = (!members.is_empty()).then(|| merger.set_table(&members));
    }
    for slot in &slots {
        merger.add_slot(slot)?;
    }
    for (number, function) in functions.iter().enumerate() {
        merger.copy_until(number, function.planned.plan.nodes.len())?;
    }
    for (number, (name, format)) in results.iter().enumerate() {
        merger.add_result(number, name, *format)?;
    }
    Ok(merger.plan)
}

impl Merger<'_> {
    fn own(&self, function: usize) -> &ExpressionPlan {
        &self.functions[function].planned.plan
    }

    /// Returns the operations of each function that may be shared.
    fn sequences(&self) -> Vec<Vec<(NodeId, SharedKind)>> {
        let mut of_functions = Vec::new();
        let common = self.common_widths();
        for function in 0..self.functions.len() {
            let own = self.own(function);
            let is_shared_table = |node: NodeId| {
                let widths = table_of(own, node).and_then(|table| SharedWidths::of(&table));
                widths.is_some_and(|widths| common.as_ref().is_some_and(|it| fits(&widths, it)))
            };
            of_functions.push(shared_operations(own, &is_shared_table));
        }
        of_functions
    }

    /// Returns the widths that most tables have; `None` if no table can be shared.
    fn common_widths(&self) -> Option<SharedWidths> {
        let mut counts: Vec<(SharedWidths, usize)> = Vec::new();
        for function in 0..self.functions.len() {
            let own = self.own(function);
            for at in 0..own.nodes.len() {
                let Some(table) = table_of(own, NodeId(at)) else { continue };
                let Some(widths) = SharedWidths::of(&table) else { continue };
                match counts
                    .iter_mut()
                    .find(|(other, _)| fits(&widths, other) || fits(other, &widths))
                {
                    Some((other, count)) => {
                        *other = other.max(&widths);
                        *count += 1;
                    }
                    None => counts.push((widths, 1)),
                }
            }
        }
        counts.into_iter().max_by_key(|(_, count)| *count).map(|(widths, _)| widths)
    }

    /// Copies the nodes of a function's plan up to the node `end`, without it.
    fn copy_until(&mut self, function: usize, end: usize) -> Result<(), PlanRefusal> {
        while self.nodes[function].len() < end {
            let at = self.nodes[function].len();
            let node = self.own(function).nodes[at].clone();
            let id = match node.operation {
                Operation::Operand(number) => self.operand(function, number)?,
                _ => self.copy(function, &node),
            };
            self.nodes[function].push(id);
        }
        Ok(())
    }

    /// Returns the node of an operand of a function: the low bits of the word at its port, in the format of the operand.
    fn operand(&mut self, function: usize, number: usize) -> Result<NodeId, PlanRefusal> {
        let functions = self.functions;
        let StatedOperand { name, format, domain, outside, .. } =
            &functions[function].planned.statement.operands[number];
        let int = format.width() as i32 - i32::from(format.signed);
        let raw = Format { int, frac: 0, ..*format };
        let name = format!("{}_{name}", functions[function].name);
        let word = self.narrow(&format!("{name}_word"), self.ports[number], raw)?;
        let mut value = self.plan.scale(&name, word, -format.frac)?;
        if *outside == Outside::Clamp {
            let (low, high) = format.range();
            if i128::from(domain.1) < high {
                let most = self.plan.constant("most", domain.1.into(), format.frac)?;
                value = self.plan.minimum(&format!("{name}_not_above"), value, most)?;
            }
            if i128::from(domain.0) > low {
                let least = self.plan.constant("least", domain.0.into(), format.frac)?;
                value = self.plan.maximum(&format!("{name}_not_below"), value, least)?;
            }
            value = self.narrow(&format!("{name}_within"), value, *format)?;
        }
        Ok(value)
    }

    /// Returns a copy of a node, or the node that already has the same value.
    fn copy(&mut self, function: usize, node: &PlanNode) -> NodeId {
        let inputs = &self.nodes[function];
        let operation = node.operation.with_inputs(&|id: NodeId| inputs[id.0]);
        if let Some(same) = self.same(&operation, node.format) {
            return same;
        }
        let name = format!("{}_{}", self.functions[function].name, node.name);
        let copy = PlanNode {
            name,
            limits: ANYTHING,
            actual_limits: ANYTHING,
            stated: None,
            agreement: None,
            source: None,
            ..node.clone()
        };
        self.plan.push_copy(&copy, operation)
    }

    /// Returns the node that already computes `operation` in this format.
    fn same(&self, operation: &Operation, format: Format) -> Option<NodeId> {
        let is_same = |other: &PlanNode| {
            other.format == format
                && match (&other.operation, operation) {
                    (Operation::Constant { raw: a, .. }, Operation::Constant { raw: b, .. }) => {
                        a == b
                    }
                    (Operation::Narrow(a, x), Operation::Narrow(b, y)) => a == b && x == y,
                    (Operation::Middle(a), Operation::Middle(b)) => a == b,
                    (other, own) => {
                        let identity = own.identity();
                        // The places of a shift directly follow their word, so that they are copied with it.
                        let is_pair =
                            matches!(own, Operation::Places(_) | Operation::Normalise { .. });
                        !is_pair && identity.is_some() && other.identity() == identity
                    }
                }
        };
        self.plan.nodes.iter().position(is_same).map(NodeId)
    }

    /// Converts a node to a format by dropping bits, and returns the new node.
    fn narrow(&mut self, name: &str, node: NodeId, format: Format) -> Result<NodeId, PlanRefusal> {
        if let Some(same) = self.same(&Operation::Narrow(node, Rounding::Truncate), format) {
            return Ok(same);
        }
        self.plan.narrow(name, node, format, Rounding::Truncate)
    }

    /// Returns the value of a node as an integer.
    fn raw(&mut self, node: NodeId) -> Result<NodeId, PlanRefusal> {
        let PlanNode { name, format, .. } = self.plan.node(node);
        let (name, frac) = (format!("{name}_raw"), format.frac);
        self.plan.scale(&name, node, frac)
    }

    /// Reads an integer in the format of a node of a function's plan, and gives it to this node.
    fn give(&mut self, function: usize, node: NodeId, integer: NodeId) -> Result<(), PlanRefusal> {
        let PlanNode { name, format, .. } = self.own(function).node(node);
        let (name, format) = (format!("{}_{name}", self.functions[function].name), *format);
        let int = format.width() as i32 - i32::from(format.signed);
        let kept =
            self.narrow(&format!("{name}_bits"), integer, Format { int, frac: 0, ..format })?;
        let value = self.plan.scale(&name, kept, -format.frac)?;
        debug_assert_eq!(self.nodes[function].len(), node.0, "nodes in their order");
        self.nodes[function].push(value);
        Ok(())
    }

    /// Returns a node with the value of `cases[opcode]`. A missing case may have any value. The list has a case for each function.
    fn selected(&mut self, name: &str, cases: &[Option<NodeId>]) -> Result<NodeId, PlanRefusal> {
        let mut all = cases.to_vec();
        let bits = opcode_bits(self.functions.len());
        all.resize(1 << bits, None);
        let selected = self.selected_by(name, &all, bits)?;
        Ok(selected.expect("a case"))
    }

    /// Returns a node with the value of the case that the low `bits` bits of the opcode select; `None` if there is no case.
    fn selected_by(
        &mut self,
        name: &str,
        cases: &[Option<NodeId>],
        bits: u32,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let mut given = cases.iter().flatten();
        let Some(first) = given.next() else { return Ok(None) };
        if given.all(|case| case == first) {
            return Ok(Some(*first));
        }
        let half = cases.len() / 2;
        let lower = self.selected_by(name, &cases[..half], bits - 1)?;
        let upper = self.selected_by(name, &cases[half..], bits - 1)?;
        let (Some(lower), Some(upper)) = (lower, upper) else { return Ok(lower.or(upper)) };
        let bit = self.plan.bit(&format!("opcode_bit{}", bits - 1), self.opcode, bits - 1)?;
        self.plan.choose(name, bit, [lower, upper]).map(Some)
    }

    /// Adds the node of a slot, and the nodes of its functions up to it.
    fn add_slot(&mut self, slot: &MergedOperation) -> Result<(), PlanRefusal> {
        let members = slot.present();
        for (function, node) in &members {
            self.copy_until(*function, node.0)?;
        }
        let is_in_common_table = slot.kind == SharedKind::Table && self.common_table.is_some();
        if members.len() == 1 && !is_in_common_table {
            // The function alone has this operation, which is copied with the nodes that follow.
            return Ok(());
        }
        match slot.kind {
            SharedKind::Normaliser => self.add_normaliser(&members),
            SharedKind::Table => self.add_table(&members),
            SharedKind::Product => self.add_product(&members),
            SharedKind::LeftShift => self.add_shift(&members, true),
            SharedKind::RightShift => self.add_shift(&members, false),
            SharedKind::Rounding => self.add_rounding(&members),
        }
    }

    /// Returns a node for input number `input` of the members' operations, as an integer that the opcode selects.
    fn selected_input(
        &mut self,
        name: &str,
        members: &[(usize, NodeId)],
        input: usize,
    ) -> Result<NodeId, PlanRefusal> {
        let mut cases = vec![None; self.functions.len()];
        for (function, node) in members {
            let own = self.own(*function).node(*node).operation.inputs()[input];
            cases[*function] = Some(self.raw(self.nodes[*function][own.0])?);
        }
        self.selected(name, &cases)
    }

    fn add_product(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let first = self.selected_input("first", members, 0)?;
        let second = self.selected_input("second", members, 1)?;
        let product = self.plan.multiply("product", first, second)?;
        for (function, node) in members {
            self.give(*function, *node, product)?;
        }
        Ok(())
    }

    fn add_shift(&mut self, members: &[(usize, NodeId)], is_left: bool) -> Result<(), PlanRefusal> {
        let value = self.selected_input("to_shift", members, 0)?;
        let places = self.selected_input("shift_places", members, 1)?;
        let shifted = if is_left {
            let formats = members.iter().map(|(function, node)| {
                let format = self.own(*function).node(*node).format;
                Format { int: format.int + format.frac, frac: 0, ..format }
            });
            let format = formats.reduce(wide_enough).expect("a member");
            self.plan.shift_left("shifted_left", value, places, format)?
        } else {
            self.plan.shift_right("shifted_right", value, places)?
        };
        for (function, node) in members {
            self.give(*function, *node, shifted)?;
        }
        Ok(())
    }

    /// Adds an adder that rounds results. The opcode selects the value with the highest bit that its function drops.
    fn add_rounding(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let mut cases = vec![None; self.functions.len()];
        let mut formats = Vec::new();
        for (function, node) in members {
            let own = self.own(*function);
            let result = own.node(*node).format;
            let value = own.node(*node).operation.inputs()[0];
            let value = self.nodes[*function][value.0];
            let name = format!("{}_to_round", self.functions[*function].name);
            let scaled = self.plan.scale(&name, value, result.frac)?;
            let with_half = Format { frac: 1, ..self.plan.node(scaled).format };
            cases[*function] = Some(self.narrow(&name, scaled, with_half)?);
            formats.push(Format { int: result.int + result.frac, frac: 0, ..result });
        }
        let value = self.selected("to_round", &cases)?;
        let format = formats.into_iter().reduce(wide_enough).expect("a member");
        let rounded = self.plan.narrow("rounded", value, format, Rounding::Nearest)?;
        for (function, node) in members {
            self.give(*function, *node, rounded)?;
        }
        Ok(())
    }

    /// Adds a normaliser whose word has as many bits as the widest word of a function. Narrower words have zeros below them. A
    /// function that shifts by pairs of bits shifts back by one bit if the number of places is odd.
    fn add_normaliser(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let mut cases = vec![None; self.functions.len()];
        let mut width = 0;
        for (function, node) in members {
            let own = self.own(*function).node(*node);
            let word = own.operation.inputs()[0];
            let own_width = self.own(*function).node(word).format.width();
            width = width.max(own_width);
            let word = self.nodes[*function][word.0];
            let frac = self.plan.node(word).format.frac;
            let name = format!("{}_word_at_top", self.functions[*function].name);
            cases[*function] = Some(self.plan.scale(&name, word, frac - own_width as i32)?);
        }
        let word = self.selected("word", &cases)?;
        let word = self.narrow("word_to_normalise", word, Format::unsigned(0, width as i32))?;
        let by_pairs = |merger: &Self, (function, node): &(usize, NodeId)| {
            let operation = &merger.own(*function).node(*node).operation;
            matches!(operation, Operation::Normalise { by_pairs: true, .. })
        };
        let are_all_pairs = members.iter().all(|member| by_pairs(self, member));
        let [normalised, places] = self.plan.normalise("normalised", word, are_all_pairs)?;
        for member in members {
            let (function, node) = *member;
            let [word, count] = match by_pairs(self, member) && !are_all_pairs {
                true => self.by_pairs(normalised, places)?,
                false => [normalised, places],
            };
            let own = self.own(function).node(node).format;
            let places_format = self.own(function).node(NodeId(node.0 + 1)).format;
            let name = &self.functions[function].name;
            let names = [format!("{name}_normalised"), format!("{name}_places")];
            let word = self.narrow(&names[0], word, own)?;
            let count = self.narrow(&names[1], count, places_format)?;
            self.nodes[function].push(word);
            self.nodes[function].push(count);
        }
        Ok(())
    }

    /// Returns the word and the places of a normaliser by pairs of bits, from a normaliser by single bits. After an odd
    /// number of places the word has a zero at its end, so that the shift back loses nothing.
    fn by_pairs(&mut self, normalised: NodeId, places: NodeId) -> Result<[NodeId; 2], PlanRefusal> {
        let width = self.plan.node(normalised).format.frac;
        let is_odd = self.plan.bit("places_are_odd", places, 0)?;
        let half = self.plan.scale("normalised_half", normalised, -1)?;
        let word = self.plan.choose("normalised_by_pairs", is_odd, [normalised, half])?;
        let word = self.narrow("normalised_pairs", word, Format::unsigned(0, width))?;
        let halved = self.plan.scale("places_halved", places, -1)?;
        let bits = self.plan.node(places).format.width() as i32 - 1;
        let pairs = self.narrow("places_by_pairs", halved, Format::unsigned(bits.max(1), 0))?;
        Ok([word, pairs])
    }

    /// Returns a table with a page for each of the polynomials `members`.
    fn set_table(&self, members: &[(usize, NodeId)]) -> SetTable {
        let mut tables = Vec::new();
        for (function, node) in members {
            tables.push(table_of(self.own(*function), *node).expect("a table"));
        }
        let paged = paged(&tables);
        SetTable { members: members.to_vec(), tables, paged }
    }

    /// Adds a polynomial whose table has a page for each of `members`.
    fn add_table(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let set = match &self.common_table {
            Some(common) => common.clone(),
            None => self.set_table(members),
        };
        let table = set.paged;
        let mut numbers = vec![None; self.functions.len()];
        // The first page of each function, and the further pages that the top of an operand's number selects.
        let mut first_pages = vec![0; 1 << opcode_bits(self.functions.len())];
        let mut further_pages = vec![None; self.functions.len()];
        let no_further_page = self.plan.constant("zero", 0, 0)?;
        for (function, node) in members {
            let same = set.members.iter().position(|member| *member == (*function, *node));
            let member = same.expect("a polynomial of the table");
            let operand = self.own(*function).node(*node).operation.inputs()[0];
            let operand = self.nodes[*function][operand.0];
            let page_bits = table.page_bits[member];
            let bits = table.number_bits + page_bits;
            let number = self.number(*function, operand, &set.tables[member], bits)?;
            let name = &self.functions[*function].name.clone();
            let in_page = Format::unsigned(table.number_bits as i32, 0);
            numbers[*function] = Some(self.narrow(&format!("{name}_in_page"), number, in_page)?);
            first_pages[*function] = table.pages[member] as i128;
            further_pages[*function] = Some(match page_bits {
                0 => no_further_page,
                bits => {
                    let upper = self.plan.scale("number_above", number, -in_page.int)?;
                    let format = Format::unsigned(bits as i32, 0);
                    self.narrow(&format!("{name}_further_page"), upper, format)?
                }
            });
        }
        let number = self.selected("number", &numbers)?;
        let first = self.plan.lookup("pages", self.opcode, first_pages, 0)?;
        let further = self.selected("further_page", &further_pages)?;
        let page = self.plan.add("page", first, further)?;
        let upper = self.plan.scale("page_above", page, table.number_bits as i32)?;
        let address = self.plan.add("place", upper, number)?;
        let address = self.narrow("place_in_table", address, table.polynomials.operand)?;
        let function = table.function();
        let values = table.polynomials.result.range();
        let polynomials = Some(table.polynomials);
        let approximation = Approximation { function, polynomials };
        let value = self.plan.polynomial("curve", address, approximation, values)?;
        for (function, node) in members {
            self.give(*function, *node, value)?;
        }
        Ok(())
    }

    /// Returns the number of an operand within the domain of a function's table, with zeros below it up to `bits` bits.
    fn number(
        &mut self,
        function: usize,
        operand: NodeId,
        table: &Piecewise,
        bits: u32,
    ) -> Result<NodeId, PlanRefusal> {
        let own_bits = table.segments.bits;
        let name = &self.functions[function].name;
        let names = [format!("{name}_from_origin"), format!("{name}_number")];
        let mut integer = self.raw(operand)?;
        if table.origin & ((1 << own_bits) - 1) != 0 {
            let origin = self.plan.constant("origin", table.origin.into(), 0)?;
            integer = self.plan.subtract(&names[0], integer, origin)?;
        }
        let number = self.narrow(&names[1], integer, Format::unsigned(own_bits as i32, 0))?;
        let shifted = self.plan.scale(&names[1], number, (bits - own_bits) as i32)?;
        self.narrow(&names[1], shifted, Format::unsigned(bits as i32, 0))
    }

    /// Adds result number `number` as a word of a format. A function without such a result, and an opcode without a function, give 0.
    fn add_result(&mut self, number: usize, name: &str, format: Format) -> Result<(), PlanRefusal> {
        let mut cases = Vec::new();
        let zero = self.plan.constant("zero", 0, 0)?;
        for function in 0..self.functions.len() {
            let Some(result) = self.own(function).results.get(number).copied() else {
                cases.push(Some(zero));
                continue;
            };
            let integer = self.raw(self.nodes[function][result.0])?;
            let name = format!("{}_{name}", self.functions[function].name);
            let signed = Format { signed: true, int: format.width() as i32 - 1, frac: 0 };
            let is_negative = self.plan.node(integer).format.signed && !format.signed;
            let word = match is_negative {
                true => self.narrow(&format!("{name}_extended"), integer, signed)?,
                false => integer,
            };
            cases.push(Some(self.narrow(&format!("{name}_word"), word, format)?));
        }
        cases.resize(1 << opcode_bits(self.functions.len()), Some(zero));
        let selected = self.selected(&format!("{name}_selected"), &cases)?;
        let result = self.narrow(&format!("{name}_result"), selected, format)?;
        let is_operand = matches!(self.plan.node(result).operation, Operation::Operand(_));
        let result = if is_operand { self.plan.copy(name, result)? } else { result };
        self.plan.results.push(result);
        self.plan.proved.push(result);
        Ok(())
    }
}

/// Returns whether tables of these widths can be pages of one table: the widths of the coefficients agree.
fn fits(own: &SharedWidths, common: &SharedWidths) -> bool {
    own.guard == common.guard && own.offset.len() == common.offset.len()
}

fn table_of(plan: &ExpressionPlan, node: NodeId) -> Option<Arc<Piecewise>> {
    match &plan.node(node).operation {
        Operation::Polynomial(_, approximation) => approximation.polynomials.clone(),
        _ => None,
    }
}
