//! Defines drawings as data (lines, boxes and text) and converts them to SVG. The style sheet of the page decides the colours.

use anyhow::Result;
use glint_base::fill;
use glint_base::template::Template;

/// A drawing of lines, boxes and text, in units of the page at full size. Each [`Item::Open`] must have an [`Item::Close`].
#[derive(Clone, Debug)]
#[glint_base::template::template("drawing.svg")]
pub struct Drawing {
    /// The identifier in HTML, which must be unique on the page.
    pub id: String,
    /// The title, which a screen reader reads.
    pub title: String,
    /// A description for screen readers.
    pub description: String,
    pub width: i32,
    pub height: i32,
    /// The parts in the order in which they are drawn.
    pub items: Vec<Item>,
}

/// A part of a drawing. Its class selects colours in the style sheet.
#[derive(Clone, Debug)]
pub enum Item {
    /// Lines, by SVG's path syntax.
    Path {
        class: &'static str,
        /// The attribute `d` of SVG. For example, `M0 0H10V5` draws a line 10 units to the right and 5 down.
        d: String,
    },
    Text {
        /// The class also decides the alignment.
        class: &'static str,
        /// The horizontal position at which the text starts, is centred or ends, as its class says.
        x: i32,
        /// The vertical position of the text's base line.
        y: i32,
        text: String,
    },
    /// Begins a group of items, which [`Item::Close`] ends.
    Open {
        class: &'static str,
        /// The tooltip of the group, a sentence.
        title: String,
    },
    Close,
}

impl Item {
    /// Makes a line of text; see [`Item::Text`].
    pub fn text(class: &'static str, x: i32, y: i32, text: impl Into<String>) -> Self {
        Self::Text { class, x, y, text: text.into() }
    }

    /// Makes lines; see [`Item::Path`].
    pub fn path(class: &'static str, d: impl Into<String>) -> Self {
        Self::Path { class, d: d.into() }
    }
}

impl Drawing {
    /// Returns the drawing as an `svg` element.
    ///
    /// # Errors
    ///
    /// Fails if the template cannot be printed.
    pub fn svg(&self) -> Result<String> {
        Ok(self.render()?)
    }

    /// Returns the drawing as an SVG file that ends with a newline.
    ///
    /// # Errors
    ///
    /// Fails if a template cannot be printed.
    pub fn file(&self) -> Result<String> {
        fill!("standalone.svg" {
            drawing: String = self.svg()?,
            width: i32 = self.width,
            height: i32 = self.height,
        })
    }
}

/// The font size of text in drawings, in units of the page.
pub const SIZE: f64 = 11.0;

/// Estimates a text's width: 10 characters are 66 units wide.
pub fn text_width(text: &str) -> i32 {
    (text.chars().count() as f64 * SIZE * 0.6).ceil() as i32
}
