//! Names that come near a mistyped one.

/// So many names are offered at most.
const OFFERED: usize = 3;

/// The names that take the fewest edits to become `name`, nearest first.
pub(crate) fn nearest_names<'a>(name: &str, known: &[&'a str]) -> Vec<&'a str> {
    let mut ranked: Vec<(usize, &str)> =
        known.iter().map(|known| (edits(name, known), *known)).collect();
    ranked.sort_unstable();
    ranked.into_iter().take(OFFERED).map(|(_, known)| known).collect()
}

/// The names as one text.
pub(crate) fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// Fewest bytes to insert, delete or replace (Levenshtein 1966).
fn edits(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.bytes().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_counted() {
        let cases = [("", "", 0), ("abc", "abc", 0), ("", "abc", 3), ("kitten", "sitting", 3)];
        for (a, b, expected) in cases {
            assert_eq!((edits(a, b), edits(b, a)), (expected, expected), "{a} {b}");
        }
    }

    #[test]
    fn the_nearest_names_come_first() {
        let known = ["scene-0061", "scene-0103", "other", "scene-0553"];
        let near = nearest_names("scene-061", &known);
        assert_eq!(quoted(&near), "`scene-0061`, `scene-0103`, `scene-0553`");
    }
}
