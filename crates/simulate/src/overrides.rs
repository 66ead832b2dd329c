//! Single values of a world file, set from outside.

use occlabel_core::Fault;
use toml::{Table, Value};

/// The text of a world file with settings `key.path=VALUE` laid over it, one after the other.
///
/// VALUE is TOML, and what is no TOML is a string. An element of a list is named by its `name`, by
/// its number from 0, or `*` for all of them: `lidar.*.range_noise_m=0.02`. Tables that are not
/// there are made. Whether a key is known is told when the world is parsed.
///
/// # Errors
/// If the text is no TOML, a setting is not of that form, or its path names no element of a list or
/// goes through a value.
pub fn world_text_with(text: &str, sets: &[String]) -> Result<String, Fault> {
    if sets.is_empty() {
        return Ok(text.to_owned());
    }
    let mut world: Table = text.parse().map_err(|error: toml::de::Error| {
        Fault::new("world", "the file", "TOML", error.message())
    })?;
    for set in sets {
        let (path, value) = parse(set)?;
        put(&mut world, &path, &value).map_err(|fault| fault.record(set.clone()))?;
    }
    Ok(world.to_string())
}

/// `key.path=VALUE`, taken apart.
fn parse(set: &str) -> Result<(Vec<&str>, Value), Fault> {
    let usage = || Fault::new("world", "--set", "key.path=VALUE", format!("`{set}`"));
    let (path, text) = set.split_once('=').ok_or_else(usage)?;
    let path: Vec<&str> = path.split('.').map(str::trim).collect();
    if path.iter().any(|key| key.is_empty()) {
        return Err(usage());
    }
    let parsed = format!("value = {text}").parse::<Table>().ok();
    let value = parsed.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    Ok((path, value.unwrap_or_else(|| Value::String(text.to_owned()))))
}

fn put(table: &mut Table, path: &[&str], value: &Value) -> Result<(), Fault> {
    let [key, rest @ ..] = path else { return Ok(()) };
    if rest.is_empty() {
        table.insert((*key).to_owned(), value.clone());
        return Ok(());
    }
    let under = table.entry(*key).or_insert_with(|| Value::Table(Table::new()));
    put_under(under, key, rest, value)
}

fn put_under(under: &mut Value, key: &str, rest: &[&str], value: &Value) -> Result<(), Fault> {
    match under {
        Value::Table(table) => put(table, rest, value),
        Value::Array(list) => put_in_list(list, key, rest, value),
        other => Err(Fault::new("world", key, "a table or a list", other.to_string())),
    }
}

fn put_in_list(list: &mut [Value], key: &str, path: &[&str], value: &Value) -> Result<(), Fault> {
    let [name, rest @ ..] = path else { return Ok(()) };
    let chosen: Vec<usize> = (0..list.len()).filter(|&at| is_named(&list[at], at, name)).collect();
    if chosen.is_empty() {
        let known: Vec<&str> = list.iter().filter_map(name_of).collect();
        let expected = format!("one of {}: {}, or *", list.len(), known.join(", "));
        return Err(Fault::new("world", key, expected, format!("`{name}`")));
    }
    for at in chosen {
        match rest {
            [] => list[at] = value.clone(),
            rest => put_under(&mut list[at], name, rest, value)?,
        }
    }
    Ok(())
}

fn is_named(element: &Value, at: usize, name: &str) -> bool {
    name == "*" || name_of(element) == Some(name) || name.parse() == Ok(at)
}

fn name_of(element: &Value) -> Option<&str> {
    element.get("name")?.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORLD: &str = r#"
        duration_s = 2.0
        [[lidar]]
        name = "TOP"
        position_m = [1.0, 2.0, 3.0]
        [[lidar]]
        name = "REAR"
    "#;

    fn with(sets: &[&str]) -> Result<Table, Fault> {
        let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
        world_text_with(WORLD, &sets).map(|text| text.parse().expect("TOML"))
    }

    #[test]
    fn values_are_set_by_name_by_number_and_for_all() {
        let found = with(&[
            "duration_s=9.5",
            "lidar.TOP.rolling=true",
            "lidar.1.rate_hz=20.0",
            "lidar.TOP.position_m.2=4.5",
            "lidar.*.range_noise_m=0.02",
            "annotator.missing_boxes=0.1",
            "taxonomy=my own",
        ]);
        let expected = r#"
            duration_s = 9.5
            taxonomy = "my own"
            annotator.missing_boxes = 0.1
            [[lidar]]
            name = "TOP"
            position_m = [1.0, 2.0, 4.5]
            rolling = true
            range_noise_m = 0.02
            [[lidar]]
            name = "REAR"
            rate_hz = 20.0
            range_noise_m = 0.02
        "#;
        assert_eq!(found.unwrap(), expected.parse().unwrap());
    }

    #[test]
    fn the_text_is_kept_where_nothing_is_set() {
        assert_eq!(world_text_with(WORLD, &[]).unwrap(), WORLD);
    }

    #[test]
    fn what_names_nothing_is_refused() {
        for (set, found) in [
            ("duration_s", "`duration_s`"),
            ("lidar..x=1", "`lidar..x=1`"),
            ("lidar.FRONT.rate_hz=1.0", "`FRONT`"),
            ("lidar.2.rate_hz=1.0", "`2`"),
            ("duration_s.x=1", "2.0"),
        ] {
            assert_eq!(with(&[set]).unwrap_err().found, found, "{set}");
        }
    }
}
