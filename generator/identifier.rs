pub fn check(name: &str) -> Result<(), String> { if name.is_empty() { Err("empty".into()) } else { Ok(()) } }
