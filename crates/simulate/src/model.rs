//! Models: what several entries of a world file share.

use occlabel_core::Fault;
use toml::{Table, Value};

/// The lists whose entries may have a model.
const LISTS: [&str; 2] = ["static", "mover"];

/// A world file without its `[model.NAME]` tables: each entry with `model = "NAME"` has got the keys
/// of the model that it does not state itself.
///
/// # Errors
/// If an entry names a model that is not there.
pub(crate) fn with_models(mut world: Table) -> Result<Table, Fault> {
    let models = match world.remove("model") {
        None => Table::new(),
        Some(Value::Table(models)) => models,
        Some(other) => return Err(fault("model", "tables [model.NAME]", &other)),
    };
    for list in LISTS {
        let Some(Value::Array(entries)) = world.get_mut(list) else { continue };
        for (at, entry) in entries.iter_mut().enumerate() {
            let Value::Table(entry) = entry else { continue };
            fill(entry, &models, &format!("{list}[{at}].model"))?;
        }
    }
    Ok(world)
}

fn fill(entry: &mut Table, models: &Table, key: &str) -> Result<(), Fault> {
    let Some(name) = entry.remove("model") else { return Ok(()) };
    let Some(Value::Table(model)) = name.as_str().and_then(|name| models.get(name)) else {
        let known: Vec<&str> = models.keys().map(String::as_str).collect();
        return Err(fault(key, &format!("a model: {}", known.join(", ")), &name));
    };
    for (key, value) in model {
        entry.entry(key.clone()).or_insert_with(|| value.clone());
    }
    Ok(())
}

fn fault(key: &str, expected: &str, found: &Value) -> Fault {
    Fault::new("world", key, expected, found.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORLD: &str = r#"
        model.car = { size_m = 4, lift_m = 1 }
        [[mover]]
        name = "a"
        model = "car"
        lift_m = 2
        [[mover]]
        name = "b"
    "#;

    #[test]
    fn an_entry_has_its_own_keys_before_those_of_its_model() {
        let expected = "mover = [{ name = 'a', size_m = 4, lift_m = 2 }, { name = 'b' }]";
        let found = with_models(WORLD.parse().unwrap()).unwrap();
        assert_eq!(found, expected.parse::<Table>().unwrap());
    }

    #[test]
    fn an_unknown_model_is_refused_by_its_key() {
        let text = WORLD.replace("model = \"car\"", "model = \"bus\"");
        let fault = with_models(text.parse().unwrap()).unwrap_err();
        assert_eq!((fault.place.as_str(), fault.found.as_str()), ("mover[0].model", "\"bus\""));
    }
}
