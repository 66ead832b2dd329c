//! The page's own scripts, put together.

/// Modules in an order in which each stands behind those that it imports.
const MODULES: [&str; 19] = [
    include_str!("../../page/decode.js"),
    include_str!("../../page/keyframes.js"),
    include_str!("../../page/voxels.js"),
    include_str!("../../page/faces.js"),
    include_str!("../../page/pick.js"),
    include_str!("../../page/colors.js"),
    include_str!("../../page/cubes.js"),
    include_str!("../../page/slice.js"),
    include_str!("../../page/points.js"),
    include_str!("../../page/arrows.js"),
    include_str!("../../page/surroundings.js"),
    include_str!("../../page/controls.js"),
    include_str!("../../page/labels.js"),
    include_str!("../../page/facts.js"),
    include_str!("../../page/panel.js"),
    include_str!("../../page/hash.js"),
    include_str!("../../page/keys.js"),
    include_str!("../../page/play.js"),
    include_str!("../../page/main.js"),
];

/// All modules as one: what they import from each other stands in it already.
pub(crate) fn script() -> String {
    let lines = MODULES.iter().flat_map(|module| module.lines());
    let kept = lines.filter(|line| !line.starts_with("import "));
    let bare = kept.map(|line| line.strip_prefix("export ").unwrap_or(line));
    bare.flat_map(|line| [line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_are_put_together_without_imports_and_exports() {
        let script = script();
        assert!(script.contains("\nfunction ") && script.contains("\nclass "));
        for line in script.lines() {
            assert!(!line.starts_with("import") && !line.starts_with("export"), "{line}");
        }
    }

    #[test]
    fn no_script_ends_the_element_that_holds_it() {
        for text in [script().as_str(), include_str!("../../page/vendor/three.min.js")] {
            let text = text.to_ascii_lowercase();
            assert!(!text.contains("</script") && !text.contains("<!--"));
        }
    }
}
