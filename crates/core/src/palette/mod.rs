//! Which colour a class has.

mod color_blind;
mod sight;
mod standard;

use color_blind::COLOR_BLIND;
use standard::STANDARD;

/// For which readers colours are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorSet {
    /// Those that readers know: of the nuScenes occupancy benchmarks, else of Cityscapes, else ours.
    #[default]
    Standard,
    /// Those that stay apart without the sense of red, of green or of blue.
    ColorBlind,
}

/// The names and colours of classes, in id order: red, green, blue.
#[derive(Clone, Debug)]
pub struct Palette {
    classes: Vec<(String, [u8; 3])>,
}

impl Palette {
    /// The standard colours of a taxonomy's names in id order.
    pub fn of(names: &[impl AsRef<str>]) -> Self {
        Self::with(names, ColorSet::Standard)
    }

    /// The colours of a taxonomy's names in id order.
    ///
    /// A known name has one colour in every taxonomy. The colour of any other name follows from the
    /// name, moved on until it is unlike all others.
    pub fn with(names: &[impl AsRef<str>], set: ColorSet) -> Self {
        let known = names.iter().map(|name| set.known(name.as_ref()));
        let mut colors: Vec<_> = known.collect();
        for (id, name) in names.iter().enumerate() {
            if colors[id].is_none() {
                let taken: Vec<_> = colors.iter().flatten().copied().collect();
                colors[id] = Some(set.unlike(&taken, hash(name.as_ref())));
            }
        }
        let named = names.iter().map(|name| name.as_ref().to_owned());
        Self { classes: named.zip(colors.into_iter().flatten()).collect() }
    }

    /// The same names in the colours of a set.
    pub fn recolored(&self, set: ColorSet) -> Self {
        let names: Vec<_> = self.classes.iter().map(|(name, _)| name).collect();
        Self::with(&names, set)
    }

    /// The colour of a class; of an id without a name, one that follows from the id.
    pub fn color(&self, id: u8) -> [u8; 3] {
        match self.classes.get(usize::from(id)) {
            Some((_, color)) => *color,
            None => hue(u32::from(id) * GOLDEN_ANGLE, 0),
        }
    }

    /// The name of a class.
    pub fn name(&self, id: u8) -> Option<&str> {
        self.classes.get(usize::from(id)).map(|(name, _)| name.as_str())
    }

    /// The name of a class, as a reader likes it.
    pub fn label(&self, id: u8) -> String {
        match self.classes.get(usize::from(id)) {
            Some((name, _)) => name.replace('_', " "),
            None => format!("class {id}"),
        }
    }
}

/// Degrees between neighbours of a circle on which no two of many ever crowd.
const GOLDEN_ANGLE: u32 = 137;

impl ColorSet {
    fn known(self, name: &str) -> Option<[u8; 3]> {
        let name = name.to_ascii_lowercase().replace(['_', '-'], " ");
        let table: &[(&str, [u8; 3])] = match self {
            Self::Standard => &STANDARD,
            Self::ColorBlind => &COLOR_BLIND,
        };
        let (_, color) = table.iter().find(|(known, _)| *known == name)?;
        Some(*color)
    }

    /// How far two colours are from each other.
    fn apart(self, a: [u8; 3], b: [u8; 3]) -> u32 {
        match self {
            Self::Standard => (0..3).map(|i| u32::from(a[i].abs_diff(b[i]))).sum(),
            Self::ColorBlind => sight::apart(a, b),
        }
    }

    /// From which distance two colours are unlike.
    fn enough(self) -> u32 {
        match self {
            Self::Standard => 60,
            Self::ColorBlind => 75,
        }
    }

    /// The first colour on the way around the circle that is unlike all taken ones, or else the one
    /// that is least like any.
    fn unlike(self, taken: &[[u8; 3]], start: u32) -> [u8; 3] {
        let nearest = |color: &[u8; 3]| taken.iter().map(|other| self.apart(*color, *other)).min();
        let way = || (0..72).map(|turn| hue(start % 360 + turn * GOLDEN_ANGLE, turn / 24));
        let clear = way().find(|color| nearest(color).is_none_or(|d| d >= self.enough()));
        let farthest = || way().max_by_key(nearest);
        clear.or_else(farthest).expect("a way of 72 colours")
    }
}

/// A colour by its angle in degrees, in one of three strengths.
fn hue(degrees: u32, strength: u32) -> [u8; 3] {
    let (low, high) = [(70, 235), (30, 170), (130, 250)][strength as usize % 3];
    let sixth = degrees % 360;
    let ramp = |d: u32| low + (high - low) * (d % 60) / 60;
    let (up, down) = (ramp(sixth), low + high - ramp(sixth));
    let channels = [
        [high, up, low],
        [down, high, low],
        [low, high, up],
        [low, down, high],
        [up, low, high],
        [high, low, down],
    ][(sixth / 60) as usize];
    channels.map(|channel| channel as u8)
}

/// FNV-1a, 32 bits.
fn hash(name: &str) -> u32 {
    let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    name.bytes().fold(0x811c_9dc5, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_name_has_its_color_however_it_is_spelt() {
        let palette = Palette::of(&["car", "driveable_surface", "Traffic Light", "traffic_cone"]);
        let colors: Vec<_> = (0..4).map(|id| palette.color(id)).collect();
        assert_eq!(colors, [[0, 150, 245], [255, 0, 255], [250, 170, 30], [255, 240, 150]]);
        assert_eq!(palette.label(1), "driveable surface");
    }

    #[test]
    fn an_unknown_name_has_a_color_of_its_own() {
        let names: Vec<_> = (0..20).map(|i| format!("thing {i}")).collect();
        let (one, two) = (Palette::of(&names), Palette::of(&names));
        let mut pairs = 0;
        for a in 0..20 {
            assert_eq!(one.color(a), two.color(a));
            for b in 0..a {
                let d = ColorSet::Standard.apart(one.color(a), one.color(b));
                assert!(d >= ColorSet::Standard.enough(), "{a} and {b}");
                pairs += 1;
            }
        }
        assert_eq!(pairs, 190);
    }

    #[test]
    fn a_color_stays_when_another_name_comes_after() {
        let (one, two) = (Palette::of(&["hovercraft"]), Palette::of(&["hovercraft", "kite"]));
        assert_eq!(one.color(0), two.color(0));
    }

    #[test]
    fn the_classes_of_a_shipped_taxonomy_are_told_apart() {
        for (set, enough) in [(ColorSet::Standard, 55), (ColorSet::ColorBlind, 75)] {
            for (name, classes) in shipped() {
                let palette = Palette::with(&classes, set);
                for (a, b) in pairs(classes.len()) {
                    let d = set.apart(palette.color(a as u8), palette.color(b as u8));
                    assert!(d >= enough, "{name}: {} and {} differ by {d}", classes[a], classes[b]);
                }
                let known = |class: &String| set.known(class).is_some();
                assert!(classes.iter().all(known), "{name}");
            }
        }
    }

    /// The standard colours cannot do it, or there would be no need for the others.
    #[test]
    fn some_standard_colors_are_one_to_the_color_blind() {
        let nearest = |(_, classes): (String, Vec<String>)| {
            let palette = Palette::of(&classes);
            let d = |(a, b)| sight::apart(palette.color(a as u8), palette.color(b as u8));
            pairs(classes.len()).map(d).min()
        };
        assert!(shipped().into_iter().filter_map(nearest).min().unwrap() < 10);
    }

    fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
        (0..n).flat_map(|a| (0..a).map(move |b| (a, b)))
    }

    fn shipped() -> Vec<(String, Vec<String>)> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs/taxonomies");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let read = |path: std::path::PathBuf| {
            let text = std::fs::read_to_string(&path).unwrap();
            let list = text.split_once("classes = [").unwrap().1.split_once(']').unwrap().0;
            let classes = list.split('"').skip(1).step_by(2).map(str::to_owned).collect();
            (path.display().to_string(), classes)
        };
        let taxonomies: Vec<_> = files.map(read).collect();
        assert!(taxonomies.len() >= 4);
        taxonomies
    }
}
