//! The templates of everything that Glint writes, for the crates that fill them.
//!
//! Askama looks for templates in the directory of the crate that derives `Template`. The templates of Glint are filled by several
//! crates, each of which may stand anywhere: in this checkout, below a checkout of another project, or in Cargo's
//! registry. This crate knows where it stands itself, and gives Askama whole paths.

use std::path::Path;

use proc_macro::{Group, Span, TokenStream, TokenTree};

/// Derives `askama::Template` for a structure from a file of this crate: `#[template("bench.v")]`.
///
/// The escaping follows from the file's extension, by `askama.toml` beside it. The crate needs `glint-base` among its dependencies.
///
/// # Errors
/// A file that is not there, as an error of the compiler with its path.
#[proc_macro_attribute]
pub fn template(name: TokenStream, structure: TokenStream) -> TokenStream {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = here.join(name.to_string().trim_matches('"'));
    // Askama takes the file in which the derivation stands for the one in which its code ends up. With a macro between them that
    // is so where the derivation has the place of the name, which stands where the macro is called.
    let place = name.into_iter().next().map(|token| token.span());
    let at_place = |code: String| moved(code.parse().expect("code"), place);
    if !path.is_file() {
        let message = format!("there is no template {}", path.display());
        return at_place(format!("compile_error!({message:?});"));
    }
    let config = here.join("askama.toml");
    let mut derived = at_place(format!(
        "#[derive(glint_base::template::askama::Template)] #[template(path = {path:?}, config = {config:?}, askama = glint_base::template::askama)]"
    ));
    derived.extend(structure);
    derived
}

/// Gives all tokens a place.
fn moved(code: TokenStream, place: Option<Span>) -> TokenStream {
    let one = |mut token: TokenTree| {
        if let TokenTree::Group(group) = &token {
            token = Group::new(group.delimiter(), moved(group.stream(), place)).into();
        }
        place.inspect(|place| token.set_span(*place));
        token
    };
    code.into_iter().map(one).collect()
}
