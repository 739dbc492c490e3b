//! Merges the plans of several functions into one plan with an opcode.
//!
//! The nodes of each plan are copied in their order. Where several functions have an operation in the same slot ([`MergedOperation`]), the
//! merged plan has a single node for all, and choices by the opcode select its inputs. Shared operations work on raw integers, so
//! that the functions may have different binary points. Two functions that compute the same value share its nodes too.

use std::sync::Arc;

use glint_approximate::{Outside, Piecewise, SharedWidths};
use glint_base::fixed::Format;
use glint_formula::Enclosure;

use super::align::{MergedOperation, SharedKind, TableRead, shared_operations, slots};
use super::equality::MergedFunction;
use super::factors::with_narrow_factors;
use super::select::OpcodeChoices;
use super::tables::{PagedTable, paged};
use super::{UnitFunction, opcode_bits};
use crate::node::{Approximation, NodeId, Operation, PlanNode};
use crate::plan::{ExpressionPlan, PlanBuilder};
use crate::refusal::PlanRefusal;
use crate::statement::StatedOperand;

const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// The merged plan so far, and where the values of each function are in it.
pub(super) struct Merger<'u> {
    pub(super) functions: &'u [UnitFunction],
    /// The plan of each function, with narrow factors.
    plans: Vec<ExpressionPlan>,
    pub(super) plan: PlanBuilder,
    opcode: NodeId,
    /// The nodes of the operand ports behind the opcode.
    ports: Vec<NodeId>,
    /// For each function and each node of its plan, the node of the merged plan with its value.
    pub(super) nodes: Vec<Vec<NodeId>>,
    /// For each function whose first result passes through the shifter without a shift: the value of its table behind the
    /// shifter.
    pub(super) routed: Vec<Option<NodeId>>,
    /// The widths of the tables that can be pages of a shared table; `None` if there are none.
    common_widths: Option<SharedWidths>,
    /// The table of all functions, if a single table serves all slots.
    common_table: Option<SetTable>,
    choices: OpcodeChoices,
}

/// One table for several polynomials of functions.
#[derive(Clone)]
struct SetTable {
    /// For each polynomial, its function and its node.
    members: Vec<(usize, NodeId)>,
    tables: Vec<Arc<Piecewise>>,
    paged: PagedTable,
}

/// The place of a function's operand in the table of several functions.
struct TablePlace {
    /// The node of the operand's number within its page.
    number: NodeId,
    /// The page, or the first of several.
    first_page: i128,
    /// The node of the number of pages after the first one; `None` for a single page.
    further_page: Option<NodeId>,
}

/// Returns the merged plan, and the nodes of each function in it. Its operands are `ports`, the opcode first, and its results are words with the
/// given formats. With `shares_tables`, one table serves all polynomials of shared widths. A function can read it several times, one after
/// the other.
///
/// # Errors
/// Fails if an operation has too many bits.
pub(super) fn merged(
    functions: &[UnitFunction],
    ports: &[StatedOperand],
    results: &[(&'static str, Format)],
    shares_tables: bool,
) -> Result<(ExpressionPlan, Vec<MergedFunction>), PlanRefusal> {
    let mut plan = PlanBuilder::shared();
    let mut nodes = Vec::new();
    for (number, port) in ports.iter().enumerate() {
        nodes.push(plan.operand(number, &port.name, port.format, port.domain)?);
    }
    let opcode = nodes.remove(0);
    let choices = OpcodeChoices::new(&mut plan, opcode, functions.len())?;
    let mut plans = Vec::new();
    for function in functions {
        plans.push(with_narrow_factors(&function.planned.plan)?);
    }
    let mut merger = Merger {
        functions,
        plans,
        plan,
        opcode,
        ports: nodes,
        nodes: vec![Vec::new(); functions.len()],
        routed: vec![None; functions.len()],
        common_widths: common_widths(functions),
        common_table: None,
        choices,
    };
    let mut slots = slots(&merger.sequences());
    merger.route_results(&mut slots);
    if shares_tables {
        let of_tables = slots.iter().filter(|slot| slot.kind == SharedKind::Table);
        let members: Vec<(usize, NodeId)> = of_tables.flat_map(MergedOperation::present).collect();
        merger.common_table = (!members.is_empty()).then(|| merger.set_table(&members));
    }
    for slot in &slots {
        merger.add_slot(slot)?;
    }
    for number in 0..functions.len() {
        merger.copy_until(number, merger.own(number).nodes().len())?;
    }
    for (number, (name, format)) in results.iter().enumerate() {
        merger.add_result(number, name, *format)?;
    }
    let nodes = merger.function_nodes();
    merger.choices.finish(&mut merger.plan);
    Ok((merger.plan.finish()?, nodes))
}

impl Merger<'_> {
    pub(super) fn own(&self, function: usize) -> &ExpressionPlan {
        &self.plans[function]
    }

    fn function_nodes(&self) -> Vec<MergedFunction> {
        let mut functions = Vec::new();
        for (function, nodes) in self.nodes.iter().enumerate() {
            let mut merged = Vec::new();
            for (at, node) in nodes.iter().enumerate() {
                let is_hidden = self.is_part_of_choice(function, NodeId(at));
                merged.push((!is_hidden).then_some(*node));
            }
            functions.push(MergedFunction { plan: self.plans[function].clone(), merged });
        }
        functions
    }

    fn sequences(&self) -> Vec<Vec<(NodeId, SharedKind)>> {
        let mut of_functions = Vec::new();
        for function in 0..self.functions.len() {
            let is_shared_table = |node| self.is_shared_table(function, node);
            of_functions.push(shared_operations(self.own(function), &is_shared_table));
        }
        of_functions
    }

    /// Returns whether a node of a function is a polynomial whose table can be pages of the shared table.
    fn is_shared_table(&self, function: usize, node: NodeId) -> bool {
        let table = table_of(self.own(function), node);
        let widths = table.and_then(|table| SharedWidths::of(&table));
        let common = self.common_widths.as_ref();
        widths.is_some_and(|widths| common.is_some_and(|common| fits(&widths, common)))
    }

    /// Returns how a function reads the shared table at a node of its plan; `None` for other nodes.
    pub(super) fn table_read(&self, function: usize, node: NodeId) -> Option<TableRead> {
        TableRead::at(self.own(function), node, &|node| self.is_shared_table(function, node))
    }

    /// Copies the nodes of a function's plan up to the node `end`, without it.
    fn copy_until(&mut self, function: usize, end: usize) -> Result<(), PlanRefusal> {
        while self.nodes[function].len() < end {
            let at = self.nodes[function].len();
            let node = self.own(function).nodes()[at].clone();
            let id = match node.operation {
                Operation::Operand(number) => self.operand(function, number)?,
                // A choice between two tables reads the shared table in place of these polynomials.
                Operation::Polynomial(operand, _)
                    if self.is_part_of_choice(function, NodeId(at)) =>
                {
                    self.nodes[function][operand.0]
                }
                _ => self.copy(function, &node),
            };
            self.nodes[function].push(id);
        }
        Ok(())
    }

    /// Returns whether a node is a polynomial of a shared table that only choices between two tables read.
    fn is_part_of_choice(&self, function: usize, node: NodeId) -> bool {
        self.is_shared_table(function, node) && self.table_read(function, node).is_none()
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
            deviation: 0.0,
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
        self.plan.so_far().nodes().iter().position(is_same).map(NodeId)
    }

    /// Converts a node to a format by dropping bits, and returns the new node.
    pub(super) fn narrow(
        &mut self,
        name: &str,
        node: NodeId,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        self.plan.low_bits(name, node, format)
    }

    /// Returns a node with the raw value of `node` as an integer.
    pub(super) fn raw(&mut self, node: NodeId) -> Result<NodeId, PlanRefusal> {
        let PlanNode { name, format, .. } = self.plan.node(node);
        let (name, frac) = (format!("{name}_raw"), format.frac);
        self.plan.scale(&name, node, frac)
    }

    /// Gives a node of a function's plan its value in the merged plan: the raw value `integer`, in the format of the node.
    pub(super) fn give(
        &mut self,
        function: usize,
        node: NodeId,
        integer: NodeId,
    ) -> Result<(), PlanRefusal> {
        let PlanNode { name, format, .. } = self.own(function).node(node);
        let (name, format) = (format!("{}_{name}", self.functions[function].name), *format);
        let int = format.width() as i32 - i32::from(format.signed);
        let kept =
            self.narrow(&format!("{name}_bits"), integer, Format { int, frac: 0, ..format })?;
        self.choices.add_low_bits(kept, integer);
        let value = self.plan.scale(&name, kept, -format.frac)?;
        debug_assert_eq!(self.nodes[function].len(), node.0, "nodes in their order");
        self.nodes[function].push(value);
        Ok(())
    }

    /// Returns a node with the value of `cases[opcode]`. A missing case may have any value. The list has a case for each function.
    pub(super) fn selected(
        &mut self,
        name: &str,
        cases: &[Option<NodeId>],
    ) -> Result<NodeId, PlanRefusal> {
        self.choices.selected(&mut self.plan, name, cases)
    }

    /// Adds the shared node of a slot, after the nodes of its functions that precede it.
    fn add_slot(&mut self, slot: &MergedOperation) -> Result<(), PlanRefusal> {
        let members = slot.present();
        for (function, node) in &members {
            self.copy_until(*function, node.0)?;
        }
        let is_choice_of_tables = |(function, node): &(usize, NodeId)| {
            let read = self.table_read(*function, *node);
            read.is_some_and(|read| read.condition.is_some())
        };
        let has_pages = slot.kind == SharedKind::Table
            && (self.common_table.is_some() || members.iter().any(is_choice_of_tables));
        if members.len() == 1 && !has_pages {
            // The function alone has this operation, which is copied with the nodes that follow.
            return Ok(());
        }
        match slot.kind {
            SharedKind::Normaliser => self.add_normaliser(&members),
            SharedKind::Table => self.add_table(&members),
            SharedKind::Product => self.add_product(&members),
            SharedKind::Shift => self.add_shift(&members),
        }
    }

    /// Returns a node for input number `input` of the members' operations, as an integer that the opcode selects.
    pub(super) fn selected_input(
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

    /// Returns a table with pages for the polynomials that `members` read.
    fn set_table(&self, members: &[(usize, NodeId)]) -> SetTable {
        let mut polynomials = Vec::new();
        let mut tables = Vec::new();
        let mut are_pairs = Vec::new();
        for (function, node) in members {
            let read = self.table_read(*function, *node).expect("a node that reads a table");
            for polynomial in read.polynomials {
                are_pairs.push(read.condition.is_some());
                polynomials.push((*function, polynomial));
                tables.push(table_of(self.own(*function), polynomial).expect("a table"));
            }
        }
        let paged = paged(&tables, &are_pairs);
        SetTable { members: polynomials, tables, paged }
    }

    /// Adds a polynomial whose table has the pages that `members` read.
    fn add_table(&mut self, members: &[(usize, NodeId)]) -> Result<(), PlanRefusal> {
        let set = match &self.common_table {
            Some(common) => common.clone(),
            None => self.set_table(members),
        };
        let table = &set.paged;
        let mut numbers = vec![None; self.functions.len()];
        let mut further_pages = vec![None; self.functions.len()];
        let mut first_pages = vec![0; 1 << opcode_bits(self.functions.len())];
        for (function, node) in members {
            let place = self.place_in_table(*function, *node, &set)?;
            numbers[*function] = Some(place.number);
            further_pages[*function] = place.further_page;
            first_pages[*function] = place.first_page;
        }
        let number = self.selected("number", &numbers)?;
        let first = self.plan.lookup("pages", self.opcode, first_pages.clone(), 0)?;
        let mut pages = vec![None; self.functions.len()];
        for (function, _) in members {
            pages[*function] = Some(match further_pages[*function] {
                Some(further) => self.page_after(*function, first_pages[*function], further)?,
                None => first,
            });
        }
        let page = self.selected("page", &pages)?;
        let upper = self.plan.scale("page_above", page, table.number_bits as i32)?;
        let address = self.plan.add("place", upper, number)?;
        let address = self.narrow("place_in_table", address, table.polynomials.operand)?;
        let function = table.function();
        let values = table.polynomials.result.range();
        let polynomials = Some(table.polynomials.clone());
        let approximation = Approximation { function, polynomials };
        let value = self.plan.polynomial("curve", address, approximation, values)?;
        for (function, node) in members {
            self.give(*function, *node, value)?;
        }
        Ok(())
    }

    /// Returns where a function reads a table at a node of its plan.
    fn place_in_table(
        &mut self,
        function: usize,
        node: NodeId,
        set: &SetTable,
    ) -> Result<TablePlace, PlanRefusal> {
        let table = &set.paged;
        let read = self.table_read(function, node).expect("a node that reads a table");
        let [zero, one] = read.polynomials.map(|polynomial| {
            let mut all = set.members.iter();
            all.position(|it| *it == (function, polynomial)).expect("a page")
        });
        let operand = self.nodes[function][read.operand.0];
        let page_bits = table.page_bits[zero];
        let bits = table.number_bits + page_bits;
        let whole_number = self.number(function, operand, &set.tables[zero], bits)?;
        let name = self.functions[function].name.clone();
        let in_page = Format::unsigned(table.number_bits as i32, 0);
        let number = self.narrow(&format!("{name}_in_page"), whole_number, in_page)?;
        let pages = [zero, one].map(|member| table.pages[member] as i128);
        let first_page = pages[0].min(pages[1]);
        let mut further_page = None;
        if let Some(condition) = read.condition {
            let condition = self.nodes[function][condition.0];
            further_page = Some(self.page_beyond_first(&name, condition, pages)?);
        }
        if page_bits > 0 {
            let upper = self.plan.scale("number_above", whole_number, -in_page.int)?;
            let format = Format::unsigned(page_bits as i32, 0);
            let name = format!("{name}_further_page");
            let of_number = self.narrow(&name, upper, format)?;
            further_page = Some(match further_page {
                Some(of_condition) => self.plan.add(&name, of_condition, of_number)?,
                None => of_number,
            });
        }
        Ok(TablePlace { number, first_page, further_page })
    }

    /// Returns the page number `first` + `further`. The sum is a concatenation if the first page is a multiple of a power of two
    /// above `further`.
    fn page_after(
        &mut self,
        function: usize,
        first: i128,
        further: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let name = format!("{}_page", self.functions[function].name);
        let bits = self.plan.node(further).format.width();
        if first == 0 {
            return Ok(further);
        }
        if first & ((1 << bits) - 1) != 0 {
            let first = self.plan.constant(&name, first, 0)?;
            return self.plan.add(&name, first, further);
        }
        let above = self.plan.constant(&name, first >> bits, 0)?;
        let above = self.plan.scale(&name, above, bits as i32)?;
        self.plan.add(&name, above, further)
    }

    /// Returns by how much the page that `condition` selects exceeds the smaller one of `pages`.
    fn page_beyond_first(
        &mut self,
        name: &str,
        condition: NodeId,
        pages: [i128; 2],
    ) -> Result<NodeId, PlanRefusal> {
        let least = pages[0].min(pages[1]);
        let name = format!("{name}_page_of_condition");
        if pages == [least, least + 1] {
            return Ok(condition);
        }
        let zero = self.plan.constant(&name, pages[0] - least, 0)?;
        let one = self.plan.constant(&name, pages[1] - least, 0)?;
        self.plan.choose(&name, condition, [zero, one])
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
}

/// Returns the widths that most tables have; `None` if no table can be shared.
fn common_widths(functions: &[UnitFunction]) -> Option<SharedWidths> {
    let mut counts: Vec<(SharedWidths, usize)> = Vec::new();
    for function in functions {
        let own = &function.planned.plan;
        for at in 0..own.nodes().len() {
            let Some(table) = table_of(own, NodeId(at)) else { continue };
            let Some(widths) = SharedWidths::of(&table) else { continue };
            match counts.iter_mut().find(|(other, _)| fits(&widths, other) || fits(other, &widths))
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
