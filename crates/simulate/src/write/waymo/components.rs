//! v2: a Parquet file for each component.

use std::collections::BTreeMap;

use occlabel_core::Fault;

use crate::write::files::Output;

use super::component_columns::COMPONENTS;
use super::frame::{BoxLabel, Frame, Image};
use super::message::{matrix_numbers, shutter_times};
use super::parquet_table::{Cell, Table};
use super::range_image::{LABEL, PIXEL, POSE, RangeImage};
use super::rig::{Rig, RigLidar};
use super::rig_camera::RigCamera;

/// The component without which no frame has a place.
pub(super) const VEHICLE_POSE: &str = "vehicle_pose";

/// The components of a scene.
pub(super) struct Components {
    scene: String,
    tables: BTreeMap<&'static str, Table>,
}

impl Components {
    /// Begins all files.
    pub(super) fn create(scene: &str, output: &Output) -> Result<Self, Fault> {
        let table = |(component, columns)| {
            let file = output.stream(&format!("{component}/{scene}.parquet"))?;
            Ok((component, Table::create(file, columns)?))
        };
        let tables = COMPONENTS.into_iter().map(table).collect::<Result<_, Fault>>()?;
        Ok(Self { scene: scene.to_owned(), tables })
    }

    /// Tells the sensors.
    pub(super) fn calibrations(&mut self, rig: &Rig) {
        for lidar in &rig.lidars {
            self.push("lidar_calibration", vec![byte(lidar.number)], lidar_cells(lidar));
        }
        for camera in &rig.cameras {
            self.push("camera_calibration", vec![byte(camera.number)], camera_cells(camera));
        }
    }

    /// Adds a frame. Its range images are written, all else is kept until the end.
    pub(super) fn frame(&mut self, rig: &Rig, frame: &Frame) -> Result<(), Fault> {
        let time = || Cell::Long(frame.time.0 / 1000);
        let pose = Cell::Reals(matrix_numbers(&frame.world_from_ego));
        self.push(VEHICLE_POSE, vec![time()], vec![pose]);
        for label in &frame.boxes {
            let key = vec![time(), Cell::Text(label.track.to_owned())];
            self.push("lidar_box", key, box_cells(label));
        }
        for image in &frame.images {
            let camera = &rig.cameras[image.camera];
            let key = vec![time(), byte(camera.number)];
            self.push("camera_image", key, image_cells(camera, image));
        }
        frame.lidars.iter().for_each(|image| self.range_image(time, image));
        let mut large = ["lidar", "lidar_pose", "lidar_segmentation"].into_iter();
        large.try_for_each(|component| self.table(component).flush())
    }

    fn range_image(&mut self, time: impl Fn() -> Cell, image: &RangeImage) {
        let key = || vec![time(), byte(image.lidar)];
        self.push("lidar", key(), range_cells(image));
        if let Some(poses) = &image.poses {
            self.push("lidar_pose", key(), matrix(image, POSE, Cell::Floats(poses.clone())));
        }
        if let Some(labels) = &image.labels {
            self.push("lidar_segmentation", key(), label_cells(image, labels));
        }
    }

    /// Writes what was kept.
    pub(super) fn finish(self) -> Result<(), Fault> {
        self.tables.into_values().try_for_each(Table::finish)
    }

    fn push(&mut self, component: &str, key: Vec<Cell>, cells: Vec<Cell>) {
        let scene = Cell::Text(self.scene.clone());
        self.table(component).push([scene].into_iter().chain(key).chain(cells).collect());
    }

    fn table(&mut self, component: &str) -> &mut Table {
        self.tables.get_mut(component).expect("a component that is listed")
    }
}

fn byte(number: u64) -> Cell {
    Cell::Integer(number as i32)
}

fn lidar_cells(lidar: &RigLidar) -> Vec<Cell> {
    let [min_rad, max_rad] = lidar.span_rad();
    let extrinsic = Cell::Reals(matrix_numbers(&lidar.ego_from_format));
    let inclinations = Cell::Reals(lidar.inclinations_rad.clone());
    vec![extrinsic, Cell::Real(min_rad), Cell::Real(max_rad), inclinations]
}

fn camera_cells(camera: &RigCamera) -> Vec<Cell> {
    let extrinsic = Cell::Reals(matrix_numbers(&camera.ego_from_format));
    let size = camera.size.map(|side| Cell::Integer(side as i32));
    let lens = camera.intrinsic.map(Cell::Real);
    lens.into_iter().chain([extrinsic]).chain(size).chain([byte(camera.shutter.0)]).collect()
}

fn box_cells(label: &BoxLabel) -> Vec<Cell> {
    let numbers = label.center_m.iter().chain(&label.size_m).chain([&label.heading_rad]);
    numbers.map(|number| Cell::Real(*number)).chain([byte(label.kind)]).collect()
}

fn image_cells(camera: &RigCamera, image: &Image) -> Vec<Cell> {
    let [trigger_s, done_s] = shutter_times(camera, image);
    let times = [image.time_s, 0.0, trigger_s, done_s].map(Cell::Real);
    [Cell::Reals(matrix_numbers(&image.world_from_ego))].into_iter().chain(times).collect()
}

fn range_cells(image: &RangeImage) -> Vec<Cell> {
    let [first, second] = [image.pixels.clone(), image.second_pixels()];
    let images = [first, second].map(|pixels| matrix(image, PIXEL, Cell::Floats(pixels)));
    images.into_iter().flatten().collect()
}

fn label_cells(image: &RangeImage, labels: &[i32]) -> Vec<Cell> {
    let images = [labels.to_vec(), vec![0; labels.len()]];
    let images = images.map(|labels| matrix(image, LABEL, Cell::Integers(labels)));
    images.into_iter().flatten().collect()
}

/// Values, so many a pixel, and their shape.
fn matrix(image: &RangeImage, depth: usize, values: Cell) -> Vec<Cell> {
    let [rows, columns] = image.size;
    vec![values, Cell::Integers([rows, columns, depth].map(|side| side as i32).to_vec())]
}
