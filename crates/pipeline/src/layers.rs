//! Layers of configuration, each laid over the ones before.

use occlabel_core::Fault;

/// The tables of a base, with those of a file and single settings `table.key=VALUE` over it.
pub(crate) fn merge(
    place: &str,
    base: &str,
    file: Option<&str>,
    settings: &[String],
) -> Result<toml::Table, Fault> {
    let mut table = parse_table(base, place)?;
    if let Some(text) = file {
        overlay(place, "", &mut table, parse_table(text, place)?)?;
    }
    for setting in settings {
        overlay("--set", "", &mut table, parse_setting(setting)?)?;
    }
    Ok(table)
}

fn parse_table(text: &str, place: &str) -> Result<toml::Table, Fault> {
    text.parse().map_err(|error: toml::de::Error| {
        let fault = Fault::new("config", place, "TOML", error.message());
        match error.span() {
            Some(span) => fault.offset(span.start as u64),
            None => fault,
        }
    })
}

/// Lays `upper` over `lower`, table by table. Every key must be there already, under its path, but
/// for the tables of readers, which no base states.
fn overlay(
    place: &str,
    path: &str,
    lower: &mut toml::Table,
    upper: toml::Table,
) -> Result<(), Fault> {
    for (key, value) in upper {
        let name = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        match (lower.get_mut(&key), value) {
            (Some(toml::Value::Table(under)), toml::Value::Table(over)) if !is_corners(&over) => {
                overlay(place, &name, under, over)?;
            }
            (Some(under), value) => *under = value,
            (None, value) if is_optional(&name) => drop(lower.insert(key, value)),
            (None, _) => return Err(unknown_key(place, path, lower, &name)),
        }
    }
    Ok(())
}

fn is_optional(name: &str) -> bool {
    name == "reader" || name.starts_with("reader.")
}

fn unknown_key(place: &str, path: &str, known: &toml::Table, name: &str) -> Fault {
    let known: Vec<&str> = known.keys().map(String::as_str).collect();
    let kind =
        if path.is_empty() { "one of the tables".into() } else { format!("a key of [{path}]:") };
    Fault::new("config", place, format!("{kind} {}", known.join(", ")), format!("`{name}`"))
}

/// A pair of corners is a value: it replaces another pair as a whole.
fn is_corners(table: &toml::Table) -> bool {
    table.contains_key("min") && table.contains_key("max")
}

/// `table.key=VALUE` as nested tables. VALUE is TOML, or else a string.
fn parse_setting(setting: &str) -> Result<toml::Table, Fault> {
    let usage = || Fault::new("config", "--set", "table.key=VALUE", format!("`{setting}`"));
    let (path, text) = setting.split_once('=').ok_or_else(usage)?;
    let path: Vec<&str> = path.split('.').map(str::trim).collect();
    if path.len() < 2 || path.iter().any(|key| key.is_empty()) {
        return Err(usage());
    }
    let mut value = parse_value(text);
    for key in path.into_iter().rev() {
        value = toml::Value::Table(toml::Table::from_iter([(key.to_owned(), value)]));
    }
    match value {
        toml::Value::Table(table) => Ok(table),
        _ => Err(usage()),
    }
}

fn parse_value(text: &str) -> toml::Value {
    let parsed = format!("value = {text}").parse::<toml::Table>();
    match parsed {
        Ok(mut table) if table.len() == 1 => table.remove("value").expect("the one key"),
        _ => toml::Value::String(text.to_owned()),
    }
}
