//! What differs between two records, key by key.

use serde_json::{Map, Value};

/// How many differences are told; of the others only how many they are.
const MAX_TOLD: usize = 12;

/// The keys under which two values differ, as `a.b: 1 before, 2 now`, in order of the keys.
pub(crate) fn differences(before: &Value, now: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect("", Some(before), Some(now), &mut found);
    found
}

/// The differences in one line.
pub(crate) fn in_one_line(differences: &[String]) -> String {
    let more = differences.len().saturating_sub(MAX_TOLD);
    let told = differences[..differences.len() - more].join("; ");
    if more == 0 { told } else { format!("{told}; and {more} more") }
}

fn collect(key: &str, before: Option<&Value>, now: Option<&Value>, found: &mut Vec<String>) {
    match (before, now) {
        (before, now) if before == now => {}
        (Some(Value::Object(before)), Some(Value::Object(now))) => {
            for name in names(before, now) {
                let inner = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                collect(&inner, before.get(name), now.get(name), found);
            }
        }
        (before, now) => found.push(format!("{key}: {} before, {} now", text(before), text(now))),
    }
}

fn names<'a>(before: &'a Map<String, Value>, now: &'a Map<String, Value>) -> Vec<&'a String> {
    let mut names: Vec<_> = before.keys().chain(now.keys()).collect();
    names.sort();
    names.dedup();
    names
}

fn text(value: Option<&Value>) -> String {
    value.map_or_else(|| "absent".to_owned(), Value::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn fault_40_the_differing_keys_are_told_with_both_values() {
        let before = json!({"a": {"b": 1, "same": [1, 2]}, "gone": true});
        let now = json!({"a": {"b": 2, "same": [1, 2], "new": "x"}});
        let expected = [
            "a.b: 1 before, 2 now",
            "a.new: absent before, \"x\" now",
            "gone: true before, absent now",
        ];
        assert_eq!(differences(&before, &now), expected);
        assert!(differences(&before, &before).is_empty());
    }

    #[test]
    fn many_differences_stay_one_line() {
        let now: Map<String, Value> = (0..100).map(|i| (format!("k{i:03}"), json!(i))).collect();
        let line = in_one_line(&differences(&json!({}), &Value::Object(now)));
        assert!(line.starts_with("k000: absent before, 0 now; k001"), "{line}");
        assert!(line.ends_with("k011: absent before, 11 now; and 88 more"), "{line}");
    }
}
