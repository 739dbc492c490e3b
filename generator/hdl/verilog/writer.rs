//! Writes the frames of Verilog modules, instances and blocks around lines of text.

/// Returns a Verilog file with the module `name`, behind the comment `header`.
pub fn module(
    header: Vec<String>,
    name: &str,
    parameters: &[String],
    ports: Vec<String>,
    body: Vec<String>,
) -> String {
    let start = ["", "`default_nettype none", ""].map(str::to_owned);
    let head = head(0, &format!("module {name}"), parameters, "", ports);
    let lines = [header, start.into(), head, body].concat();
    format!("{}\nendmodule\n\n`default_nettype wire\n", lines.join("\n"))
}

/// Each text in `parameters` and `connections` must include its comma.
pub fn instance(
    module: &str,
    parameters: &[String],
    name: &str,
    connections: &[String],
) -> Vec<String> {
    let indented = connections.iter().map(|it| format!("        {it}")).collect();
    head(4, module, parameters, name, indented)
}

/// Returns the first lines of a module or an instance: `before`, the parameters in parentheses if there are any, `name`, and the
/// list of ports. The texts in `ports` must be indented already.
fn head(
    indent: usize,
    before: &str,
    parameters: &[String],
    name: &str,
    ports: Vec<String>,
) -> Vec<String> {
    let margin = " ".repeat(indent);
    let mut lines = Vec::new();
    let mut open = format!("{margin}{before}");
    if !parameters.is_empty() {
        lines.push(format!("{open} #("));
        lines.extend(parameters.iter().map(|it| format!("{margin}    {it}")));
        open = format!("{margin})");
    }
    let space = if name.is_empty() { "" } else { " " };
    lines.push(format!("{open}{space}{name} ("));
    lines.extend(ports);
    lines.push(format!("{margin});"));
    lines
}

/// Puts lines under a comment with the title, with an empty line above. Returns nothing for no lines.
pub fn section(title: &str, lines: Vec<String>) -> Vec<String> {
    let title = format!("    // {title}");
    if lines.is_empty() { lines } else { [vec![String::new(), title], lines].concat() }
}

/// Puts lines between `begin` and `end`, with an empty line above. Returns nothing for no lines.
pub fn block(begin: &str, lines: Vec<String>, end: &str) -> Vec<String> {
    match lines.is_empty() {
        true => lines,
        false => [vec![String::new(), begin.to_owned()], lines, vec![end.to_owned()]].concat(),
    }
}
