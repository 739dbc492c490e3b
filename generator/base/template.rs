//! Fills in a template of the crate `glint-templates` with the macro [`fill!`](crate::fill), and returns the text.

use anyhow::Result;
pub use askama;
pub use askama::Template;
pub use glint_templates::template;

/// Returns a filled template's text, with the final newline that Askama drops. Fails if a value cannot be printed.
pub fn render(template: &impl Template) -> Result<String> {
    let mut text = template.render()?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

/// Fills a template and returns its text with a final newline. The arguments are the template's path, and its fields with their
/// types. A field takes the stated value, or without a value the variable of the same name.
#[macro_export]
macro_rules! fill {
    ($path:tt { $($field:ident: $kind:ty $(= $value:expr)?),* $(,)? }) => {{
        #[$crate::template::template($path)]
        struct TemplateFields<'a> {
            $($field: $kind,)*
            lifetime: std::marker::PhantomData<&'a ()>,
        }
        $crate::template::render(&TemplateFields {
            $($field: $crate::fill!(@value $field $($value)?),)*
            lifetime: std::marker::PhantomData,
        })
    }};
    (@value $field:ident) => { $field };
    (@value $field:ident $value:expr) => { $value };
}
