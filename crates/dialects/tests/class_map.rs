//! The map between the classes of any two label sets, for all that ship.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use occlabel_dialects::{Class, ClassMap, ClassTable, Concepts, IGNORED, Reason, RemarkKind};

/// The classes of every taxonomy and every dialect that ships, by file name.
fn tables() -> Vec<(String, ClassTable)> {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
    let files = |folder: &str| fs::read_dir(configs.join(folder)).unwrap();
    let files = files("taxonomies").chain(files("dialects")).map(|file| file.unwrap().path());
    let mut tables: Vec<_> = files.filter_map(|file| Some((name(&file), table(&file)?))).collect();
    tables.sort_by(|a, b| a.0.cmp(&b.0));
    tables
}

fn name(file: &Path) -> String {
    let parts = file.components().rev().take(2).map(|part| part.as_os_str().to_str().unwrap());
    let parts: Vec<_> = parts.collect();
    format!("{}/{}", parts[1], parts[0].trim_end_matches(".toml"))
}

/// The classes that a file lists; `None` for the tree of concepts.
fn table(file: &Path) -> Option<ClassTable> {
    let text: toml::Table = fs::read_to_string(file).unwrap().parse().unwrap();
    match text.get("classes")? {
        toml::Value::Array(names) => {
            let names: Vec<_> = names.iter().map(|name| name.as_str().unwrap()).collect();
            Some(named(&names))
        }
        classes => Some(classes.clone().try_into().unwrap()),
    }
}

fn named(names: &[&str]) -> ClassTable {
    let class = |(id, name): (usize, &&str)| Class {
        id: id as u16,
        name: (*name).to_owned(),
        ..Class::default()
    };
    let list = names.iter().enumerate().map(class).collect();
    ClassTable { free: 1000, no_label: Some(255), list }
}

fn of(name: &str) -> ClassTable {
    let found = tables().into_iter().find(|(known, _)| known == name);
    found.unwrap_or_else(|| panic!("no table {name}")).1
}

fn map(from: &str, to: &str) -> ClassMap {
    ClassMap::between(&of(from), &of(to), &[]).unwrap()
}

fn lines(map: &ClassMap) -> Vec<String> {
    map.remarks().iter().map(ToString::to_string).collect()
}

#[test]
fn every_class_that_ships_means_a_concept() {
    let mut found = 0;
    for (place, table) in tables() {
        for class in &table.list {
            let meaning = class.concept.as_ref().unwrap_or(&class.name);
            assert!(Concepts::shipped().named(meaning).is_some(), "{place}: {meaning}");
            found += 1;
        }
    }
    assert!(found > 100, "{found}");
}

#[test]
fn what_does_not_come_back_is_what_the_remarks_say_is_lost() {
    let (tables, mut pairs, mut lost_classes) = (tables(), 0, 0);
    for (from_name, from) in &tables {
        for (to_name, to) in &tables {
            let there = ClassMap::between(from, to, &[]).unwrap();
            let back = ClassMap::between(to, from, &[]).unwrap();
            let comes_back = |class: &usize| {
                let becomes = there.table()[*class];
                let is_said = becomes != IGNORED || to.no_label.is_some();
                is_said && back.table()[usize::from(becomes)] == *class as u8
            };
            let gone = (0..from.list.len()).filter(|class| !comes_back(class));
            let gone: BTreeSet<_> = gone.map(|class| from.list[class].name.clone()).collect();
            let told = there.remarks().iter().flat_map(|remark| remark.lost.clone());
            assert_eq!(told.collect::<BTreeSet<_>>(), gone, "{from_name} to {to_name}");
            assert_eq!(there.is_lossless(), gone.is_empty());
            pairs += 1;
            lost_classes += gone.len();
        }
    }
    assert_eq!(pairs, tables.len() * tables.len());
    assert!(lost_classes > 100, "{lost_classes}");
}

#[test]
fn a_set_maps_to_itself_without_a_remark() {
    for (name, table) in tables() {
        let map = ClassMap::between(&table, &table, &[]).unwrap();
        assert!(map.is_lossless() && map.remarks().is_empty(), "{name}");
        let free = table.free_index();
        let unchanged: Vec<u8> = (0..=free).collect();
        assert_eq!(map.table()[..unchanged.len()], unchanged, "{name}");
        let is_noise = |class: &Class| class.concept() == Some("noise") && table.no_label.is_none();
        let no_label = table.list.iter().position(is_noise).map_or(IGNORED, |at| at as u8);
        assert_eq!(map.table()[255], no_label, "{name}");
    }
}

#[test]
fn free_becomes_free_and_no_label_no_label() {
    let map = map("taxonomies/occ3d-nuscenes", "taxonomies/occ3d-waymo");
    let mut semantics = [4, 17, 255, 11];
    map.apply(&mut semantics);
    assert_eq!(semantics, [1, 15, 255, 13]);
}

#[test]
fn nuscenes_becomes_waymo_with_what_is_lost_told() {
    let map = map("taxonomies/occ3d-nuscenes", "taxonomies/occ3d-waymo");
    let told = [
        "bus, car, construction_vehicle, trailer, truck become vehicle: not told apart afterwards",
        "other_flat, sidewalk, terrain become walkable: not told apart afterwards",
        "manmade is taken as building",
        "barrier has no class there: general_object",
    ];
    assert_eq!(lines(&map), told);
    assert!(!map.is_lossless());
    let lost: Vec<_> = map.remarks().iter().map(|remark| remark.lost.join(" ")).collect();
    assert_eq!(lost[..2], ["bus construction_vehicle trailer truck", "other_flat terrain"]);
    assert_eq!(lost[2..], ["", "barrier"]);
}

#[test]
fn waymo_becomes_nuscenes_by_the_usual_and_the_wider() {
    let map = map("taxonomies/occ3d-waymo", "taxonomies/occ3d-nuscenes");
    let told = [
        "sign, traffic_light, pole, building become manmade: not told apart afterwards",
        "cyclist, bicycle become bicycle: not told apart afterwards",
        "vegetation, tree_trunk become vegetation: not told apart afterwards",
        "vehicle is taken as car",
        "walkable is taken as sidewalk",
    ];
    assert_eq!(lines(&map), told);
    assert_eq!(map.reasons()[..2], [Reason::Same, Reason::Usual]);
}

#[test]
fn what_has_no_like_and_no_class_for_the_rest_is_dropped() {
    let map = map("taxonomies/mobileocc", "taxonomies/panommocc");
    let dropped = map.remarks().iter().find(|remark| remark.kind == RemarkKind::Dropped).unwrap();
    assert_eq!(dropped.classes, ["sky"]);
    let told = "sky has no class there, nor is there one for the rest: no label";
    assert_eq!(dropped.to_string(), told);
    assert_eq!(map.table()[10], IGNORED);
}

#[test]
fn noise_is_nothing_and_no_other_object() {
    let noisy = named(&["noise", "car"]);
    let map = ClassMap::between(&noisy, &of("taxonomies/occ3d-nuscenes"), &[]).unwrap();
    assert_eq!(map.table()[..2], [IGNORED, 4]);
}

#[test]
fn a_word_that_means_another_thing_goes_by_its_concept() {
    let mut from = named(&["car", "terrain"]);
    from.list[1].concept = Some("vegetation".to_owned());
    let map = ClassMap::between(&from, &of("taxonomies/occ3d-nuscenes"), &[]).unwrap();
    assert_eq!(map.table()[..2], [4, 16]);
}

#[test]
fn a_name_that_nobody_knows_goes_to_the_rest_or_to_its_namesake() {
    let (from, to) = (named(&["gizmo"]), of("taxonomies/occ3d-nuscenes"));
    let map = ClassMap::between(&from, &to, &[]).unwrap();
    assert_eq!(lines(&map), ["gizmo has no class there: others"]);
    let same = ClassMap::between(&from, &named(&["others", "Gizmo"]), &[]).unwrap();
    assert_eq!(same.table()[0], 1);
}

#[test]
fn what_one_is_told_goes_before_the_rule() {
    let (from, to) = (of("taxonomies/occ3d-nuscenes"), of("taxonomies/mobileocc"));
    let told = |pairs: &[(&str, &str)]| {
        let pairs: Vec<_> = pairs.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        ClassMap::between(&from, &to, &pairs)
    };
    let map = told(&[("bus", "truck"), ("others", "free"), ("barrier", "ignored")]).unwrap();
    assert_eq!([map.table()[3], map.table()[0], map.table()[1]], [14, 19, IGNORED]);
    assert_eq!(map.reasons()[3], Reason::Told);
    assert!(lines(&map).iter().any(|line| line.contains("bus") && line.contains("truck")));
    let fault = told(&[("bus", "lorry")]).unwrap_err().to_string();
    assert!(fault.contains("one of road") && fault.contains("`lorry`"), "{fault}");
    assert!(told(&[("lorry", "bus")]).unwrap_err().expected.contains("one of others, barrier"));
}

/// `learning_map` of semantic-kitti.yaml, where it leads to a class: raw name and training name.
const LEARNING_MAP: [(&str, &str); 30] = [
    ("car", "car"),
    ("bicycle", "bicycle"),
    ("bus", "other-vehicle"),
    ("motorcycle", "motorcycle"),
    ("on-rails", "other-vehicle"),
    ("truck", "truck"),
    ("other-vehicle", "other-vehicle"),
    ("person", "person"),
    ("bicyclist", "bicyclist"),
    ("motorcyclist", "motorcyclist"),
    ("road", "road"),
    ("parking", "parking"),
    ("sidewalk", "sidewalk"),
    ("other-ground", "other-ground"),
    ("building", "building"),
    ("fence", "fence"),
    ("lane-marking", "road"),
    ("vegetation", "vegetation"),
    ("trunk", "trunk"),
    ("terrain", "terrain"),
    ("pole", "pole"),
    ("traffic-sign", "traffic-sign"),
    ("moving-car", "car"),
    ("moving-bicyclist", "bicyclist"),
    ("moving-person", "person"),
    ("moving-motorcyclist", "motorcyclist"),
    ("moving-on-rails", "other-vehicle"),
    ("moving-bus", "other-vehicle"),
    ("moving-truck", "truck"),
    ("moving-other-vehicle", "other-vehicle"),
];

#[test]
fn semantickittis_raw_names_become_what_its_own_map_says() {
    let (raw, training) = (LEARNING_MAP.map(|pair| pair.0), of("taxonomies/semantickitti"));
    let map = ClassMap::between(&named(&raw), &training, &[]).unwrap();
    for (at, (raw, expected)) in LEARNING_MAP.iter().enumerate() {
        let found = &training.list[usize::from(map.table()[at])].name;
        assert_eq!(found, expected, "{raw}");
    }
}

/// A heading `### FROM to TO` of docs/convert.md, and the lines of the block below it.
fn documented() -> Vec<([String; 2], Vec<String>)> {
    let page = include_str!("../../../docs/convert.md");
    let sections = page.split("\n### ").skip(1);
    let section = |text: &str| {
        let (heading, rest) = text.split_once('\n').unwrap();
        let names = heading.split_once(" to ").unwrap();
        let block = rest.split("```").nth(1).unwrap();
        let lines = block.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect();
        ([names.0.trim_matches('`').to_owned(), names.1.trim_matches('`').to_owned()], lines)
    };
    sections.map(section).collect()
}

#[test]
fn the_documents_lines_are_those_of_the_program() {
    let documented = documented();
    assert!(documented.len() >= 8, "{}", documented.len());
    for ([from, to], told) in documented {
        let map = map(&format!("dialects/{from}"), &format!("dialects/{to}"));
        assert_eq!(lines(&map), told, "{from} to {to}");
    }
}
