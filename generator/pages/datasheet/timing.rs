//! The timing diagram: a waveform as a drawing.

use super::waves::{Lane, Shape, Waves};
use crate::pages::drawing::{Drawing, Item, text_width};

/// Of the type.
const SIZE: f64 = 11.0;

/// From one lane to the next.
const PITCH: i32 = 26;

/// From low to high.
const SWING: i32 = 16;

/// Above the first lane: the numbers of the clocks.
const HEAD: i32 = 24;

/// How wide a clock may be.
const CLOCK: std::ops::RangeInclusive<i32> = 34..=104;

/// How slanted edges are.
const SLANT: i32 = 3;

/// For values, beside what they say.
const MARGIN: i32 = 10;

/// Draws a waveform.
pub fn drawing(waves: &Waves, description: String) -> Drawing {
    let label = |lane: &Lane| match lane.number {
        Some(number) => format!("{} ({number})", lane.name),
        None => lane.name.clone(),
    };
    let widest = waves.lanes.iter().map(|lane| text_width(&label(lane), SIZE));
    let left = widest.max().unwrap_or(0) + 16;
    let grid = Grid::new(waves, left);
    let height = HEAD + PITCH * waves.lanes.len() as i32 + 4;
    let mut items = Vec::new();
    for (at, clock) in waves.clocks.iter().enumerate() {
        let (x, end) = (grid.x(at), grid.x(at + 1));
        items.push(Item::path("grid", format!("M{x} {HEAD}V{height}")));
        items.push(Item::text("tick", (x + end) / 2, HEAD - 9, clock.to_string()));
    }
    let end = grid.x(waves.clocks.len());
    items.push(Item::path("grid", format!("M{end} {HEAD}V{height}")));
    for (row, lane) in waves.lanes.iter().enumerate() {
        let top = HEAD + PITCH * row as i32 + (PITCH - SWING) / 2;
        items.push(Item::text("label", left - 8, top + SWING - 4, label(lane)));
        match lane.shape {
            Shape::Clock => items.push(Item::path("wave", grid.clock(top))),
            Shape::Bit => items.push(Item::path("wave", grid.bit(lane, top))),
            Shape::Bus => grid.bus(lane, top, &mut items),
        }
    }
    for at in grid.gaps() {
        let x = grid.x(at);
        items.push(Item::path(
            "gap",
            format!("M{} {HEAD}V{height}M{} {HEAD}V{height}", x - 2, x + 2),
        ));
    }
    Drawing {
        id: "timing-diagram".to_owned(),
        title: format!("Timing of {}", waves.name),
        description,
        width: end + 8,
        height,
        items,
    }
}

/// Where the clocks are.
struct Grid<'a> {
    waves: &'a Waves,
    left: i32,
    clock: i32,
}

impl<'a> Grid<'a> {
    /// Wide enough for what the values say, within reason.
    fn new(waves: &'a Waves, left: i32) -> Self {
        let mut grid = Self { waves, left, clock: 0 };
        let wanted = waves
            .lanes
            .iter()
            .filter(|lane| lane.shape == Shape::Bus)
            .flat_map(|lane| {
                let segments = grid.segments(lane).into_iter();
                segments.map(|(from, to)| {
                    let text = lane.values[from].as_deref().unwrap_or_default();
                    (text_width(text, SIZE) + MARGIN) / (to - from) as i32
                })
            })
            .max();
        grid.clock = wanted.unwrap_or(0).clamp(*CLOCK.start(), *CLOCK.end());
        grid
    }

    /// The edge that begins a clock, by its place among those shown.
    fn x(&self, at: usize) -> i32 {
        self.left + self.clock * at as i32
    }

    /// The places before which clocks are left out.
    fn gaps(&self) -> impl Iterator<Item = usize> + '_ {
        let pairs = self.waves.clocks.windows(2).enumerate();
        pairs.filter(|(_, pair)| pair[1] != pair[0] + 1).map(|(at, _)| at + 1)
    }

    /// The stretches in which a value stays, as half-open ranges of places.
    fn segments(&self, lane: &Lane) -> Vec<(usize, usize)> {
        let mut segments: Vec<(usize, usize)> = Vec::new();
        for at in 0..lane.values.len() {
            match segments.last_mut() {
                Some((from, to)) if lane.values[*from] == lane.values[at] => *to = at + 1,
                _ => segments.push((at, at + 1)),
            }
        }
        segments
    }

    fn clock(&self, top: i32) -> String {
        let low = top + SWING;
        let mut d = format!("M{} {low}", self.x(0));
        for at in 0..self.waves.clocks.len() {
            let (x, middle) = (self.x(at), self.x(at) + self.clock / 2);
            d += &format!("V{top}H{middle}V{low}H{}", x + self.clock);
        }
        d
    }

    fn bit(&self, lane: &Lane, top: i32) -> String {
        let mut d = String::new();
        for (from, to) in self.segments(lane) {
            let high = lane.values[from].as_deref() == Some("1");
            let y = if high { top } else { top + SWING };
            let x = self.x(from);
            d += &match from {
                0 => format!("M{x} {y}"),
                _ => format!("L{} {y}", x + SLANT),
            };
            d += &format!("H{}", self.x(to));
        }
        d
    }

    fn bus(&self, lane: &Lane, top: i32, items: &mut Vec<Item>) {
        let (middle, low) = (top + SWING / 2, top + SWING);
        for (from, to) in self.segments(lane) {
            let (x, end) = (self.x(from), self.x(to));
            let frame = format!(
                "M{x} {middle}L{} {top}H{}L{end} {middle}L{} {low}H{}Z",
                x + SLANT,
                end - SLANT,
                end - SLANT,
                x + SLANT
            );
            let Some(text) = &lane.values[from] else {
                items.push(Item::path("unknown", frame));
                continue;
            };
            items.push(Item::Open { class: "value", title: format!("{}: {text}", lane.name) });
            items.push(Item::path("bus", frame));
            let room = (f64::from(end - x - 2 * SLANT) / (SIZE * 0.6)) as usize;
            let shown = match text.chars().count() > room {
                true => text.chars().take(room.saturating_sub(1)).chain(['…']).collect(),
                false => text.clone(),
            };
            items.push(Item::text("tick", (x + end) / 2, low - 4, shown));
            items.push(Item::Close);
        }
    }
}
