//! The makers' flow labels say where each point of the first sweep stands at the second one's time:
//! what rigid boxes and the vehicle's poses say.

use std::fs::File;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float32Type;
use arrow_ipc::reader::FileReader;
use nalgebra::{Point3, Vector3};
use occlabel_core::{BoxGrowth, GrownBox, Scene, SweepHeader, Timestamp};
use occlabel_logs::{Argoverse2Log, ReadOptions, SceneSource};

use crate::{WHOLE, data, options};

/// The makers take the points of boxes that are 0.2 m longer, wider and higher.
const GROWTH: BoxGrowth = BoxGrowth { scale: 1.0, margin_m: 0.1 };
/// A point that lands as near as this lands well, metres.
const NEAR_M: f64 = 0.05;

/// Flow of each point in the ego frame, metres, and whether it moves by itself.
fn flow_labels(file: File) -> (Vec<Vector3<f64>>, Vec<bool>) {
    let batches: Vec<RecordBatch> =
        FileReader::try_new(file, None).unwrap().collect::<Result<_, _>>().unwrap();
    let (mut flow, mut dynamic) = (Vec::new(), Vec::new());
    for batch in batches {
        let axis = |name: &str| {
            let column = batch.column_by_name(name).unwrap().as_primitive::<Float32Type>();
            column.values().iter().map(|metres| f64::from(*metres)).collect::<Vec<_>>()
        };
        let [x, y, z] = ["flow_tx_m", "flow_ty_m", "flow_tz_m"].map(axis);
        flow.extend((0..x.len()).map(|i| Vector3::new(x[i], y[i], z[i])));
        let moves = batch.column_by_name("dynamic").unwrap().as_boolean();
        dynamic.extend(moves.iter().map(|moves| moves == Some(true)));
    }
    (flow, dynamic)
}

/// Where a point in world goes from one time to another: with the smallest box around it, if there is
/// one.
fn moved(
    scene: &Scene,
    p_world: &Point3<f64>,
    (from, to): (Timestamp, Timestamp),
) -> Option<Point3<f64>> {
    let at = |boxes: &[(Timestamp, occlabel_core::Box3)], time| {
        boxes.iter().find(|(at, _)| *at == time).map(|(_, boxed)| boxed.clone())
    };
    let mut held = Vec::new();
    for track in &scene.tracks {
        let Some(now) = at(&track.boxes, from) else { continue };
        let p_box = now.world_from_box.inverse() * p_world;
        if GrownBox::new(&now.size_m, &GROWTH).contains(&p_box) {
            let area_m2 = now.size_m.x * now.size_m.y;
            held.push((area_m2, at(&track.boxes, to).map(|next| next.world_from_box * p_box)));
        }
    }
    let smallest = held.into_iter().min_by(|(a, _), (b, _)| a.total_cmp(b));
    smallest.map_or(Some(*p_world), |(_, moved)| moved)
}

/// Points that land near, and points.
fn share(
    scene: &Scene,
    [first, second]: [&SweepHeader; 2],
    points: impl Iterator<Item = (Point3<f64>, Vector3<f64>)>,
) -> (usize, usize) {
    let (mut near, mut all) = (0, 0);
    for (p_ego, flow) in points {
        let p_world = first.world_from_ego * p_ego;
        let landed = moved(scene, &p_world, (first.time, second.time));
        let landed = landed.map(|p_world| second.world_from_ego.inverse() * p_world);
        let off_m = landed.map(|landed| (landed - (p_ego + flow)).norm());
        near += usize::from(off_m.is_some_and(|off_m| off_m <= NEAR_M));
        all += 1;
    }
    (near, all)
}

#[test]
fn points_moved_by_boxes_and_poses_land_where_the_flow_labels_say() {
    let Some(data) = data() else { return };
    let wanted = ReadOptions { scenes: Some([WHOLE.to_owned()].into()), ..options() };
    let log = Argoverse2Log::open(&data, wanted).unwrap();
    let scene = log.load(WHOLE).unwrap();
    let sweeps = [&scene.sweeps[0], &scene.sweeps[1]];
    let cloud = log.read_sweep(sweeps[0]).unwrap().cloud;
    let file = File::open(data.join("sensor/val").join(WHOLE).join("flow_labels.feather")).unwrap();
    let (flow, dynamic) = flow_labels(file);
    assert_eq!((flow.len(), cloud.len()), (99_229, 99_229));
    let p_ego = |i: usize| sweeps[0].ego_from_lidar * cloud.positions[i];
    let movers = (0..flow.len()).filter(|&i| dynamic[i]).map(|i| (p_ego(i), flow[i]));
    let (near, all) = share(&scene, sweeps, movers);
    println!("{near} of {all} points that move land within {NEAR_M} m");
    assert!(all == 2037 && near * 100 >= all * 95, "{near} of {all}");
    let rest = (0..flow.len()).filter(|&i| !dynamic[i]).map(|i| (p_ego(i), flow[i]));
    let (near, all) = share(&scene, sweeps, rest);
    println!("{near} of {all} others");
    assert!(near * 100 >= all * 95, "{near} of {all}");
}
