//! ROS messages, encoded as their definitions say and decoded.

use occlabel_core::Timestamp;

use super::messages::{Boxes, Cloud, Link, NumberKind, Optics, RawPose};
use super::ros::{self, Layout, MarkerParts, Reader};
use super::ros_writer::Writer;

const TIME: Timestamp = Timestamp(12_000_000_034);
const BOTH: [Layout; 2] = [Layout::Cdr, Layout::Ros1];

/// Decodes a message whole, and checks that none of its beginnings panics.
fn decode<T>(
    writer: &Writer,
    decode: impl Fn(&mut Reader<'_>) -> Result<T, super::messages::Defect>,
) -> T {
    let bytes = writer.finish();
    let read = |bytes: &[u8]| Reader::new(bytes, writer.layout).and_then(|mut r| decode(&mut r));
    (0..bytes.len()).for_each(|length| drop(read(&bytes[..length])));
    read(&bytes).unwrap()
}

#[test]
fn clouds() {
    for layout in BOTH {
        let mut writer = Writer::new(layout);
        writer.header("/lidar").u32(1).u32(2).u32(2);
        writer.text("x").u32(0).u8(7).u32(1).text("label").u32(5).u8(4).u32(1);
        writer.u8(0).u32(7).u32(14).blob(&[9; 14]).u8(1);
        let cloud: Cloud = decode(&writer, ros::cloud);
        assert_eq!((cloud.header.time, cloud.header.frame.as_str()), (TIME, "lidar"));
        assert_eq!((cloud.rows, cloud.width, cloud.point_step, cloud.row_step), (1, 2, 7, 14));
        let label = &cloud.fields[1];
        assert_eq!((label.name.as_str(), label.offset, label.kind), ("label", 5, NumberKind::U16));
        assert_eq!((cloud.data.len(), cloud.big_endian), (14, false));
    }
}

#[test]
fn transforms() {
    for layout in BOTH {
        let mut writer = Writer::new(layout);
        writer.u32(2);
        for child in ["a", "roof"] {
            writer.header("map").text(child).f64s(&[1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8]);
        }
        let links: Vec<Link> = decode(&writer, ros::links);
        assert_eq!((links.len(), links[1].child.as_str()), (2, "roof"));
        let pose = RawPose { translation: [1.0, 2.0, 3.0], rotation: [0.0, 0.6, 0.0, 0.8] };
        assert!(links.iter().all(|link| link.parent_from_child == pose));
    }
}

#[test]
fn optics() {
    for layout in BOTH {
        let mut writer = Writer::new(layout);
        writer.header("cam").u32(480).u32(640).text("plumb_bob").u32(5);
        writer.f64s(&[0.1, 0.2, 0.3, 0.4, 0.5]);
        writer.f64s(&[500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0]);
        let optics: Optics = decode(&writer, ros::optics);
        assert_eq!((optics.width, optics.height, optics.model.as_str()), (640, 480, "plumb_bob"));
        assert_eq!((optics.distortion[4], optics.matrix[2]), (0.5, 320.0));
    }
}

#[test]
fn detections_take_the_best_hypothesis() {
    let mut writer = Writer::new(Layout::Cdr);
    writer.header("map").u32(1).header("").u32(2);
    for (class, score) in [("car", 0.4), ("truck", 0.6)] {
        writer.text(class).f64s(&[score]).f64s(&[0.0; 43]);
    }
    writer.f64s(&[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 4.0, 2.0, 1.5]).text("t7");
    let Boxes { cubes, cleared } = decode(&writer, ros::detections);
    let cube = &cubes[0];
    assert_eq!((cube.track.as_str(), cube.category.as_str()), ("t7", "truck"));
    assert_eq!((cube.size_m, cube.header.frame.as_str()), ([4.0, 2.0, 1.5], "map"));
    assert_eq!(cleared, [TIME]);
}

#[test]
fn markers_are_boxes_if_they_are_added_cubes() {
    for (layout, schema) in
        [(Layout::Cdr, "string texture_resource\nMeshFile mesh_file"), (Layout::Ros1, "")]
    {
        let mut writer = Writer::new(layout);
        writer.u32(3);
        for (kind, action) in [(1, 0), (2, 0), (1, 3)] {
            writer.header("map").text("car").u32(5).u32(kind).u32(action);
            writer.f64s(&[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 4.0, 2.0, 1.5]);
            writer.u32(0).u32(0).u32(0).u32(0);
            writer.u32(0).u32(0).u8(0).u32(1).f64s(&[0.0; 3]).u32(1);
            writer.u32(0).u32(0).u32(0).u32(0);
            if layout == Layout::Cdr {
                writer.text("").header("").text("").blob(&[1, 2]).u32(1).u32(0).u32(0);
            }
            writer.text("").text("");
            if layout == Layout::Cdr {
                writer.text("").blob(&[3]);
            }
            writer.u8(0);
        }
        let parts = MarkerParts::of_schema(schema.as_bytes());
        let boxes: Boxes = decode(&writer, |reader| ros::markers(reader, parts));
        assert_eq!((boxes.cubes.len(), boxes.cleared.as_slice()), (1, &[TIME][..]));
        let cube = &boxes.cubes[0];
        assert_eq!((cube.track.as_str(), cube.category.as_str()), ("car/5", "car"));
        assert_eq!((cube.size_m, cube.pose.translation), ([4.0, 2.0, 1.5], [1.0, 2.0, 3.0]));
    }
}

#[test]
fn other_encodings_of_ros_2_are_refused() {
    assert!(Reader::new(&[0, 3, 0, 0], Layout::Cdr).is_err());
    assert!(Reader::new(&[0, 1], Layout::Cdr).is_err());
}
