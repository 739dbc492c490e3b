//! Fills in a template of the crate `glint-templates` by the macro [`fill!`](crate::fill), and returns the text.

use anyhow::Result;
pub use askama;
pub use askama::Template;
pub use glint_templates::template;

/// Returns the text of a filled template. Askama drops the newline at the end of a template; the returned text always has it.
///
/// # Errors
/// Fails if a value cannot be printed.
pub fn render(template: &impl Template) -> Result<String> {
    let mut text = template.render()?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

/// Returns the text of a template: its fields with their types and, where no variable has the name of the field, their values.
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
