//! Which colour a class has.

/// The names and colours of classes, in id order: red, green, blue.
#[derive(Clone, Debug)]
pub struct Palette {
    classes: Vec<(String, [u8; 3])>,
}

impl Palette {
    /// The palette of a taxonomy's names in id order.
    ///
    /// A known name has one colour in every taxonomy: that of the nuScenes occupancy benchmarks, else
    /// that of Cityscapes, else one of ours. The colour of any other name follows from the name,
    /// moved on until it is unlike all others.
    pub fn of(names: &[impl AsRef<str>]) -> Self {
        let known = names.iter().map(|name| known_color(name.as_ref()));
        let mut colors: Vec<_> = known.collect();
        for (id, name) in names.iter().enumerate() {
            if colors[id].is_none() {
                let taken: Vec<_> = colors.iter().flatten().copied().collect();
                colors[id] = Some(unlike(&taken, hash(name.as_ref())));
            }
        }
        let named = names.iter().map(|name| name.as_ref().to_owned());
        Self { classes: named.zip(colors.into_iter().flatten()).collect() }
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

/// Not the benchmarks' own: `others`, black there, on which no shade would show; and Cityscapes' greys
/// and near-black blues.
const KNOWN: [(&str, [u8; 3]); 49] = [
    ("others", [172, 160, 132]),
    ("other", [172, 172, 120]),
    ("background", [172, 172, 120]),
    ("general object", [172, 160, 132]),
    ("barrier", [255, 120, 50]),
    ("bicycle", [255, 192, 203]),
    ("bus", [255, 255, 0]),
    ("car", [0, 150, 245]),
    ("vehicle", [0, 150, 245]),
    ("large vehicle", [160, 32, 240]),
    ("wheeled device", [255, 110, 255]),
    ("construction vehicle", [0, 255, 255]),
    ("motorcycle", [200, 180, 0]),
    ("pedestrian", [255, 0, 0]),
    ("person", [255, 0, 0]),
    ("cyclist", [255, 100, 160]),
    ("rider", [255, 100, 160]),
    ("bicyclist", [255, 100, 160]),
    ("motorcyclist", [140, 0, 70]),
    ("traffic cone", [255, 240, 150]),
    ("construction cone", [255, 240, 150]),
    ("construction object", [255, 240, 150]),
    ("trailer", [135, 60, 0]),
    ("truck", [160, 32, 240]),
    ("train", [0, 80, 100]),
    ("other vehicle", [0, 80, 100]),
    ("driveable surface", [255, 0, 255]),
    ("road", [128, 64, 128]),
    ("other flat", [139, 137, 137]),
    ("other ground", [139, 137, 137]),
    ("parking", [255, 150, 255]),
    ("sidewalk", [75, 0, 75]),
    ("walkable", [244, 35, 232]),
    ("terrain", [150, 240, 80]),
    ("manmade", [230, 230, 250]),
    ("building", [226, 200, 168]),
    ("wall", [102, 102, 156]),
    ("fence", [190, 153, 153]),
    ("pillar", [110, 190, 200]),
    ("pole", [190, 198, 210]),
    ("sign", [220, 220, 0]),
    ("traffic sign", [220, 220, 0]),
    ("traffic light", [250, 170, 30]),
    ("vegetation", [0, 175, 0]),
    ("tree trunk", [140, 90, 50]),
    ("trunk", [140, 90, 50]),
    ("sky", [70, 130, 180]),
    ("animal", [255, 150, 130]),
    ("debris", [120, 110, 60]),
];

/// Degrees between neighbours of a circle on which no two of many ever crowd.
const GOLDEN_ANGLE: u32 = 137;
/// Two colours at least so far apart in red, green and blue together are told apart.
const UNLIKE: u32 = 60;

fn known_color(name: &str) -> Option<[u8; 3]> {
    let name = name.to_ascii_lowercase().replace(['_', '-'], " ");
    let (_, color) = KNOWN.iter().find(|(known, _)| *known == name)?;
    Some(*color)
}

/// The first colour on the way around the circle that is unlike all taken ones, or else the one that
/// is least like any.
fn unlike(taken: &[[u8; 3]], start: u32) -> [u8; 3] {
    let nearest = |color: &[u8; 3]| taken.iter().map(|other| apart(*color, *other)).min();
    let way = || (0..72).map(|turn| hue(start % 360 + turn * GOLDEN_ANGLE, turn / 24));
    let clear = way().find(|color| nearest(color).is_none_or(|d| d >= UNLIKE));
    let farthest = || way().max_by_key(nearest);
    clear.or_else(farthest).expect("a way of 72 colours")
}

fn apart(a: [u8; 3], b: [u8; 3]) -> u32 {
    (0..3).map(|i| u32::from(a[i].abs_diff(b[i]))).sum()
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
                assert!(apart(one.color(a), one.color(b)) >= UNLIKE, "{a} and {b}");
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
        for (name, classes) in shipped() {
            let palette = Palette::of(&classes);
            for a in 0..classes.len() {
                for b in 0..a {
                    let d = apart(palette.color(a as u8), palette.color(b as u8));
                    assert!(d >= 55, "{name}: {} and {} differ by {d}", classes[a], classes[b]);
                }
                assert!(known_color(&classes[a]).is_some(), "{name}: {}", classes[a]);
            }
        }
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
