//! Draws a recorded waveform as the timing diagram of a datasheet. A waveform that is wider than the page continues in
//! strips below each other.

use std::ops::Range;

use super::waves::{Lane, LaneStyle, MICROINSTRUCTION, Waves};
use crate::pages::drawing::{Drawing, Item, SIZE, text_width};

/// The distance from one lane to the next, in units of the drawing.
const PITCH: i32 = 26;

/// The vertical distance from a low signal to a high one.
const SWING: i32 = 16;

/// The space above the first lane for the numbers of the clocks.
const HEAD: i32 = 24;

/// The smallest and the largest width of a clock.
const CLOCK: std::ops::RangeInclusive<i32> = 34..=104;

/// The horizontal length of a slanted edge.
const SLANT: i32 = 3;

/// The amount by which a frame is wider than the text in it.
const MARGIN: i32 = 10;

/// The largest width of a drawing that a page shows without scrolling.
const ROOM: i32 = 1120;

/// The vertical distance between two strips of a waveform that is too wide for one strip.
const APART: i32 = 22;

/// Draws the waveform. A waveform that is too long for one strip continues in strips below.
pub fn drawing(waves: &Waves) -> Drawing {
    let widest = waves.lanes.iter().map(|lane| text_width(&label(lane)));
    let left = widest.max().unwrap_or(0) + 16;
    let count = waves.clocks.len();
    let [named, cut] = clock_widths(waves);
    let strips = count.div_ceil(((ROOM - left) / cut).max(1) as usize).max(1);
    let clocks = count.div_ceil(strips).max(1);
    let clock = named.min(((ROOM - left) / clocks as i32).max(cut));
    let height = HEAD + PITCH * waves.lanes.len() as i32 + 4;
    let mut items = Vec::new();
    for strip in 0..strips {
        let places = strip * clocks..count.min((strip + 1) * clocks);
        let top = (height + APART) * strip as i32;
        Grid { waves, places, left, top, clock }.draw(height, &mut items);
    }
    Drawing {
        id: "timing-diagram".to_owned(),
        title: format!("Timing of {}", waves.name),
        description: waves.described(),
        width: left + clock * clocks as i32 + 8,
        height: (height + APART) * strips as i32 - APART,
        items,
    }
}

/// Returns a signal's name, with the number of its block in the source's figure.
fn label(lane: &Lane) -> String {
    match lane.number {
        Some(number) => format!("{} ({number})", lane.name),
        None => lane.name.clone(),
    }
}

/// Returns two widths for a clock, both limited to [`CLOCK`]. With the first width, all texts fit. With the second, they fit if
/// the diagram shows addresses instead of the names of microinstructions.
fn clock_widths(waves: &Waves) -> [i32; 2] {
    let (mut with_names, mut with_addresses) = (0, 0);
    for lane in &waves.lanes {
        if lane.shape != LaneStyle::Bus {
            continue;
        }
        let mut widest = 0;
        for (from, to) in segments(lane, 0..lane.values.len()) {
            let text = lane.values[from].as_deref().unwrap_or_default();
            widest = widest.max((text_width(text) + MARGIN) / (to - from) as i32);
        }
        with_names = with_names.max(widest);
        if lane.name != MICROINSTRUCTION {
            with_addresses = with_addresses.max(widest);
        }
    }
    [with_names, with_addresses].map(|width| width.clamp(*CLOCK.start(), *CLOCK.end()))
}

/// Returns the half-open ranges of positions in `places` over which the value stays the same. For example, the values 5, 5 and 6
/// give the ranges from 0 to 2 and from 2 to 3.
fn segments(lane: &Lane, places: Range<usize>) -> Vec<(usize, usize)> {
    let mut segments = Vec::new();
    let mut from = places.start;
    for alike in lane.values[places].chunk_by(|a, b| a == b) {
        let to = from + alike.len();
        segments.push((from, to));
        from = to;
    }
    segments
}

/// A strip of the drawing: `places` are the indices of its clocks, `left` and `top` its position, and `clock` a clock's width.
struct Grid<'a> {
    waves: &'a Waves,
    places: Range<usize>,
    left: i32,
    top: i32,
    clock: i32,
}

impl Grid<'_> {
    fn draw(&self, height: i32, items: &mut Vec<Item>) {
        let (head, bottom) = (self.top + HEAD, self.top + height);
        let line = |x: i32| format!("M{x} {head}V{bottom}");
        for at in self.places.clone() {
            let (x, end) = (self.x(at), self.x(at + 1));
            items.push(Item::path("grid", line(x)));
            let number = self.waves.clocks[at].to_string();
            items.push(Item::text("tick", (x + end) / 2, head - 9, number));
        }
        items.push(Item::path("grid", line(self.x(self.places.end))));
        for (row, lane) in self.waves.lanes.iter().enumerate() {
            let top = head + PITCH * row as i32 + (PITCH - SWING) / 2;
            items.push(Item::text("label", self.left - 8, top + SWING - 4, label(lane)));
            match lane.shape {
                LaneStyle::Clock => items.push(Item::path("wave", self.clock(top))),
                LaneStyle::Bit => items.push(Item::path("wave", self.bit(lane, top))),
                LaneStyle::Bus => self.bus(lane, top, items),
            }
        }
        for at in self.gaps() {
            let x = self.x(at);
            items.push(Item::path("gap", line(x - 2) + &line(x + 2)));
        }
    }

    /// Returns the x coordinate of the edge that begins the clock at index `at`.
    fn x(&self, at: usize) -> i32 {
        self.left + self.clock * (at - self.places.start) as i32
    }

    /// Returns the indices before which the diagram leaves clocks out. For example, for the clocks 0, 1, 7 and 8 it returns 2.
    fn gaps(&self) -> impl Iterator<Item = usize> + '_ {
        let clocks = &self.waves.clocks;
        self.places.clone().filter(|&at| at > 0 && clocks[at] != clocks[at - 1] + 1)
    }

    /// Draws a clock signal. `top` is the vertical position of a high level.
    fn clock(&self, top: i32) -> String {
        let low = top + SWING;
        let mut d = format!("M{} {low}", self.left);
        for at in self.places.clone() {
            let (x, middle) = (self.x(at), self.x(at) + self.clock / 2);
            d += &format!("V{top}H{middle}V{low}H{}", x + self.clock);
        }
        d
    }

    /// Draws a signal of one bit. `top` is the vertical position of a high level.
    fn bit(&self, lane: &Lane, top: i32) -> String {
        let mut d = String::new();
        for (from, to) in segments(lane, self.places.clone()) {
            let high = lane.values[from].as_deref() == Some("1");
            let y = if high { top } else { top + SWING };
            let x = self.x(from);
            d += &if from == self.places.start {
                format!("M{x} {y}")
            } else {
                format!("L{} {y}", x + SLANT)
            };
            d += &format!("H{}", self.x(to));
        }
        d
    }

    fn room(&self, from: usize, to: usize) -> usize {
        (f64::from(self.x(to) - self.x(from) - 2 * SLANT) / (SIZE * 0.6)) as usize
    }

    /// Draws a frame with the value for each range of clocks in which the value stays the same.
    fn bus(&self, lane: &Lane, top: i32, items: &mut Vec<Item>) {
        let (middle, low) = (top + SWING / 2, top + SWING);
        let segments = segments(lane, self.places.clone());
        // If the names of microinstructions do not fit, their addresses are drawn.
        let mut all_fit = true;
        for &(from, to) in &segments {
            let text = lane.values[from].as_deref().unwrap_or_default();
            all_fit &= text.chars().count() <= self.room(from, to);
        }
        let addresses = lane.name == MICROINSTRUCTION && !all_fit;
        for (from, to) in segments {
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
            let room = self.room(from, to);
            let shown = if addresses {
                text.split(' ').next().unwrap_or_default().to_owned()
            } else if text.chars().count() > room {
                text.chars().take(room.saturating_sub(1)).chain(['…']).collect()
            } else {
                text.clone()
            };
            items.push(Item::text("tick", (x + end) / 2, low - 4, shown));
            items.push(Item::Close);
        }
    }
}
