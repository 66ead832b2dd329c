//! Labels as one HTML file that shows them: no server, no network, nothing beside it.
//!
//! The page's own scripts stand in `page/`, a concept a file; `page/vendor` has the renderer. What comes
//! from a log (names of scenes, classes, tracks) is data, never markup: it stands in JSON without a `<`,
//! and the scripts write it as text only.

mod bits;
mod counts;
mod deflate;
mod flow;
mod keyframe;
mod planes;
mod script;

use occlabel_core::ColorSet;
use serde_json::{Value, json};

pub use keyframe::PageKeyframe;

use crate::ShownScene;

/// Where the parts of the page go, in their order.
const TEMPLATE: &str = include_str!("../../page/index.html");

/// The page of a scene, UTF-8. `about` tells of the labels' making, as names and values.
pub fn page(scene: &ShownScene, about: &[(String, String)], keyframes: &[PageKeyframe]) -> String {
    let scene = json_text(&scene_value(scene, about, keyframes));
    let data = keyframes.iter().enumerate().map(|(at, keyframe)| array_elements(at, keyframe));
    let parts = [
        ("STYLE", include_str!("../../page/style.css")),
        ("LICENSE", include_str!("../../page/vendor/three.LICENSE")),
        ("THREE", include_str!("../../page/vendor/three.min.js")),
        ("SCRIPT", &script::script()),
        ("SCENE", &scene),
        ("ARRAYS", &data.collect::<String>()),
    ];
    filled(&parts)
}

/// The template with each `{{NAME}}` replaced. What was put in is not searched again.
fn filled(parts: &[(&str, &str)]) -> String {
    let mut rest = TEMPLATE;
    let mut page = String::with_capacity(parts.iter().map(|(_, text)| text.len()).sum());
    for (name, text) in parts {
        let (before, after) = rest.split_once(&format!("{{{{{name}}}}}")).expect("in the template");
        page.push_str(before);
        page.push_str(text);
        rest = after;
    }
    page + rest
}

fn scene_value(
    scene: &ShownScene,
    about: &[(String, String)],
    keyframes: &[PageKeyframe],
) -> Value {
    let set = |set: ColorSet| scene.palette.recolored(set);
    let (standard, color_blind) = (set(ColorSet::Standard), set(ColorSet::ColorBlind));
    let ids = || 0..scene.free;
    let colors = |palette: &occlabel_core::Palette| ids().map(|id| palette.color(id)).collect();
    let [chosen, standard, color_blind]: [Vec<_>; 3] =
        [&scene.palette, &standard, &color_blind].map(colors);
    let track = |track: &crate::ShownTrack| json!([track.index, track.id, track.category]);
    json!({
        "name": scene.name,
        "frame": scene.frame,
        "free": scene.free,
        "classes": ids().map(|id| scene.palette.label(id)).collect::<Vec<_>>(),
        "colors": { "standard": standard, "color-blind": color_blind },
        "chosen": if chosen == standard { "standard" } else { "color-blind" },
        "cameras": scene.cameras,
        "tracks": scene.tracks.iter().map(track).collect::<Vec<_>>(),
        "about": about,
        "keyframes": keyframes.iter().map(|keyframe| &keyframe.about).collect::<Vec<_>>(),
    })
}

fn array_elements(at: usize, keyframe: &PageKeyframe) -> String {
    let element = |(name, text): (&str, String)| {
        format!("<script type=\"text/plain\" id=\"{at}/{name}\">{text}</script>\n")
    };
    keyframe.texts().map(element).collect()
}

/// JSON that may stand in a `script` element, whatever is in its strings.
fn json_text(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_string_of_a_log_ends_the_element_that_holds_it() {
        let text = json_text(&json!(["</script><script>alert(1)</script>", "<!--"]));
        assert!(!text.contains('<'));
        let back: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back[0], "</script><script>alert(1)</script>");
    }
}
