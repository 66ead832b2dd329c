//! What a world file may say: refusals that name the key.

use occlabel_core::Fault;

/// No coordinate and no length of a world is larger, metres.
const LARGEST_M: f64 = 1e6;

/// Refuses a key whose value does not hold what is needed.
pub(crate) fn need(
    key: &str,
    holds: bool,
    expected: &str,
    found: impl ToString,
) -> Result<(), Fault> {
    if holds { Ok(()) } else { Err(Fault::new("world", key, expected, found.to_string())) }
}

/// A raw name that the taxonomy lacks, with those that it has.
pub(crate) fn unknown<'a>(
    key: &str,
    expected: &str,
    known: impl Iterator<Item = &'a String>,
    raw: &str,
) -> Fault {
    let known: Vec<&str> = known.map(String::as_str).collect();
    let expected = format!("{expected}: {}", known.join(", "));
    Fault::new("world", key, expected, format!("`{raw}`"))
}

/// Refuses what is not a number between two limits, both allowed.
pub(crate) fn within(key: &str, value: f64, low: f64, high: f64) -> Result<(), Fault> {
    need(key, (low..=high).contains(&value), &format!("{low} to {high}"), value)
}

/// Refuses coordinates that are not finite or absurdly far away.
pub(crate) fn metres(key: &str, values: &[f64]) -> Result<(), Fault> {
    values.iter().try_for_each(|&value| within(key, value, -LARGEST_M, LARGEST_M))
}

/// Refuses lengths that are not above a micrometre, or absurdly large.
pub(crate) fn lengths(key: &str, values: &[f64]) -> Result<(), Fault> {
    values.iter().try_for_each(|&value| within(key, value, 1e-6, LARGEST_M))
}

/// Refuses angles and rates that are not finite or above a million.
pub(crate) fn angles(key: &str, values: &[f64]) -> Result<(), Fault> {
    values.iter().try_for_each(|&value| within(key, value, -1e6, 1e6))
}

/// The fault of a key, told of the file that it stands in.
pub(crate) fn in_file(file: &str, fault: Fault) -> Fault {
    let key = fault.place.clone();
    Fault { place: file.to_owned(), ..fault }.record(key)
}

/// Puts the key of the table before the key that a fault names.
pub(crate) fn inside<T>(table: &str, result: Result<T, Fault>) -> Result<T, Fault> {
    result.map_err(|fault| Fault { place: format!("{table}.{}", fault.place), ..fault })
}

/// Puts the place of an entry of a list before the key that a fault names.
pub(crate) fn each<F, T>(
    list: &str,
    entries: impl IntoIterator<Item = F>,
    mut check: impl FnMut(F) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let numbered = entries.into_iter().enumerate();
    numbered.map(|(at, entry)| inside(&format!("{list}[{at}]"), check(entry))).collect()
}
