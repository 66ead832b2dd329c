//! v2 of the format: a Parquet file for each component of each segment.
//!
//! Column names are those of the format's public component definitions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use occlabel_core::{Fault, SweepHeader, Timestamp};
use occlabel_disk as disk;

use super::calibration::LidarNumbers;
use super::component_images::POSES;
use super::layout::{VEHICLE_POSE, files};
use super::parquet_cursor::Cursors;
use super::parquet_table::Table;
use super::segment::{
    BoxLabel, CameraCalibration, Frame, Image, Inclinations, Lidar, LidarCalibration, Place,
    Segment, camera_name,
};
use crate::files::check_present;
use crate::transform::{A_POSE, pose_from_matrix};

const LIDAR: &str = "lidar";
const LIDAR_CALIBRATION: &str = "lidar_calibration";
pub(super) const TIME: &str = "key.frame_timestamp_micros";
pub(super) const LASER: &str = "key.laser_name";
pub(super) const CAMERA: &str = "key.camera_name";
pub(super) const IMAGES: &str = "camera_image";

/// A folder of components.
#[derive(Debug)]
pub(super) struct Components {
    pub(super) root: PathBuf,
    segments: Vec<String>,
    /// Columns of points, begun by earlier sweeps.
    pub(super) cursors: Cursors,
}

/// The file of a segment's component.
pub(super) fn file(component: &str, segment: &str) -> String {
    format!("{component}/{segment}.parquet")
}

impl Components {
    /// The segments whose vehicle has poses.
    ///
    /// # Errors
    /// If the folder cannot be listed.
    pub(super) fn open(root: &Path) -> Result<Self, Fault> {
        let names = files(&root.join(VEHICLE_POSE))?;
        let stem = |name: String| name.strip_suffix(".parquet").map(str::to_owned);
        let segments = names.into_iter().filter_map(stem).collect();
        Ok(Self { root: root.to_owned(), segments, cursors: Cursors::default() })
    }

    /// The segments' names.
    pub(super) fn names(&self) -> &[String] {
        &self.segments
    }

    /// The lidars of the first segment that has a calibration.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn any_lidars(&self) -> Result<Vec<LidarCalibration>, Fault> {
        let mut fault = Fault::new("waymo-layout", VEHICLE_POSE, "a segment", "none");
        for segment in &self.segments {
            match self.check_components(segment).and_then(|()| self.lidars(segment)) {
                Ok(lidars) => return Ok(lidars),
                Err(broken) => fault = broken,
            }
        }
        Err(fault)
    }

    /// Small files, which say where and what everything was, of one segment.
    pub(super) fn tables(&self, segment: &str) -> impl Iterator<Item = String> {
        let components = [VEHICLE_POSE, LIDAR_CALIBRATION, "camera_calibration", "lidar_box"];
        let files = components.map(|component| file(component, segment));
        files.into_iter().filter(|file| disk::is_file(&self.root.join(file)))
    }

    /// Everything of a segment but its points; `None` if there is no such segment.
    ///
    /// # Errors
    /// If a file that it cannot do without is absent, or any is broken.
    pub(super) fn segment(&self, name: &str) -> Option<Result<Segment, Fault>> {
        self.segments.iter().any(|known| known == name).then(|| self.read_segment(name))
    }

    fn read_segment(&self, name: &str) -> Result<Segment, Fault> {
        let mut warnings = Vec::new();
        self.check_components(name)?;
        let lidars = self.lidars(name)?;
        let mut seen = self.lidar_rows(name, &mut warnings)?;
        let mut boxes = self.optional("lidar_box", name, &mut warnings, box_rows)?;
        let mut images = self.optional(IMAGES, name, &mut warnings, image_rows)?;
        let cameras = self.optional("camera_calibration", name, &mut warnings, cameras)?;
        let poses = self.table(VEHICLE_POSE, name)?;
        let transforms = poses.real_lists("[VehiclePoseComponent].world_from_vehicle.transform")?;
        let mut rows: Vec<_> = poses.integers(TIME)?.into_iter().zip(transforms).collect();
        rows.sort_by_key(|(micros, _)| *micros);
        let frame = |(micros, pose): (i64, Vec<f64>)| {
            let world_from_ego = pose_from_matrix(&pose).map_err(|found| {
                let expected = format!("a frame's pose of {A_POSE}");
                place(&poses, micros).fault("frame-pose", expected, found)
            })?;
            Ok(Frame {
                place: Place { file: file(LIDAR, name), ..place(&poses, micros) },
                time: Timestamp::from_micros(micros),
                world_from_ego,
                lidars: seen.remove(&micros).unwrap_or_default(),
                images: images.remove(&micros).unwrap_or_default(),
                boxes: boxes.remove(&micros).unwrap_or_default(),
            })
        };
        let frames = rows.into_iter().map(frame).collect();
        Ok(Segment { lidars, cameras, frames, warnings })
    }

    /// Whether the components that a segment cannot do without are there; the fault names all that are
    /// not, with the lidars' poses, which only some sweeps need.
    fn check_components(&self, segment: &str) -> Result<(), Fault> {
        let files = [LIDAR_CALIBRATION, LIDAR, VEHICLE_POSE, POSES];
        let files = files.map(|component| file(component, segment));
        check_present(&self.root, &files[..3]).or_else(|_| check_present(&self.root, &files))
    }

    /// A component's file, all its rows of this segment.
    ///
    /// # Errors
    /// If it is absent or broken, or a row is of another segment.
    pub(super) fn table(&self, component: &str, segment: &str) -> Result<Table, Fault> {
        let table = Table::open(&self.root, file(component, segment))?;
        let names = table.texts("key.segment_context_name")?;
        match names.into_iter().find(|name| name != segment) {
            None => Ok(table),
            Some(other) => {
                let expected = format!("rows of the segment `{segment}`");
                Err(Fault::new("segment-name", table.file, expected, format!("`{other}`")))
            }
        }
    }

    /// What a component says; nothing, and a warning, if its file is absent.
    fn optional<T: Default>(
        &self,
        component: &str,
        segment: &str,
        warnings: &mut Vec<Fault>,
        read: fn(&Table) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        match self.table(component, segment) {
            Ok(table) => read(&table),
            Err(absent) if absent.rule == "missing-file" => {
                warnings.push(Fault { rule: "component-absent", ..absent });
                Ok(T::default())
            }
            Err(fault) => Err(fault),
        }
    }

    /// By frame: the lidars that have a range image, each with whether it is labelled.
    fn lidar_rows(
        &self,
        segment: &str,
        warnings: &mut Vec<Fault>,
    ) -> Result<BTreeMap<i64, Vec<(Lidar, bool)>>, Fault> {
        let labelled = self.optional("lidar_segmentation", segment, warnings, laser_keys)?;
        let table = self.table(LIDAR, segment)?;
        let shapes = table.integer_lists("[LiDARComponent].range_image_return1.shape")?;
        let mut rows: BTreeMap<i64, Vec<(Lidar, bool)>> = BTreeMap::new();
        for (key, shape) in laser_keys(&table)?.into_iter().zip(shapes) {
            let (micros, number) = key;
            let Some(lidar) = Lidar::of_number(number).filter(|_| !shape.is_empty()) else {
                continue;
            };
            rows.entry(micros).or_default().push((lidar, labelled.contains(&key)));
        }
        Ok(rows)
    }

    /// The lidars' calibrations.
    fn lidars(&self, segment: &str) -> Result<Vec<LidarCalibration>, Fault> {
        const COMPONENT: &str = "[LiDARCalibrationComponent]";
        let table = self.table(LIDAR_CALIBRATION, segment)?;
        let column = |name: &str| format!("{COMPONENT}.{name}");
        let extrinsics = table.real_lists(&column("extrinsic.transform"))?;
        let least = table.reals(&column("beam_inclination.min"))?;
        let most = table.reals(&column("beam_inclination.max"))?;
        let each = column("beam_inclination.values");
        let each = if table.has(&each) { table.real_lists(&each)? } else { Vec::new() };
        let mut lidars = Vec::new();
        for (i, number) in table.integers(LASER)?.into_iter().enumerate() {
            let Some(lidar) = Lidar::of_number(number) else { continue };
            let inclinations = match each.get(i).filter(|each| !each.is_empty()) {
                Some(each) => Inclinations::Each(each.clone()),
                None => Inclinations::Between { min_rad: least[i], max_rad: most[i] },
            };
            let ego_from_lidar = extrinsics[i].clone();
            let numbers = LidarNumbers { lidar, ego_from_lidar, inclinations };
            lidars.push(numbers.check(&place_of(&table, lidar.name()))?);
        }
        Ok(lidars)
    }

    /// How the lidar of a sweep is calibrated.
    ///
    /// # Errors
    /// If it is not.
    pub(super) fn lidar(
        &self,
        segment: &str,
        lidar: Lidar,
        sweep: &SweepHeader,
    ) -> Result<LidarCalibration, Fault> {
        let mut lidars = self.lidars(segment)?.into_iter();
        lidars.find(|calibration| calibration.lidar == lidar).ok_or_else(|| {
            let expected = format!("a calibration of lidar {}", lidar.name());
            Fault::new("lidar-calibration", &sweep.file, expected, "none").record(&sweep.source_id)
        })
    }
}

/// Time and lidar of every row.
fn laser_keys(table: &Table) -> Result<Vec<(i64, i64)>, Fault> {
    Ok(table.integers(TIME)?.into_iter().zip(table.integers(LASER)?).collect())
}

/// The boxes of each frame.
fn box_rows(table: &Table) -> Result<BTreeMap<i64, Vec<BoxLabel>>, Fault> {
    let column = |name: &str| table.reals(&format!("[LiDARBoxComponent].box.{name}"));
    let [x, y, z] = [column("center.x")?, column("center.y")?, column("center.z")?];
    let [length, width, height] = [column("size.x")?, column("size.y")?, column("size.z")?];
    let heading = column("heading")?;
    let kinds = table.integers("[LiDARBoxComponent].type")?;
    let tracks = table.texts("key.laser_object_id")?;
    let mut rows: BTreeMap<i64, Vec<BoxLabel>> = BTreeMap::new();
    for (i, micros) in table.integers(TIME)?.into_iter().enumerate() {
        rows.entry(micros).or_default().push(BoxLabel {
            place: place(table, micros),
            track: tracks[i].clone(),
            kind: kinds[i],
            center_m: Vector3::new(x[i], y[i], z[i]),
            size_m: Vector3::new(length[i], width[i], height[i]),
            heading_rad: heading[i],
        });
    }
    Ok(rows)
}

/// The images of each frame.
pub(super) fn image_rows(table: &Table) -> Result<BTreeMap<i64, Vec<Image>>, Fault> {
    let column = |name: &str| format!("[CameraImageComponent].{name}");
    let shutter = |name: &str| table.reals(&column(&format!("rolling_shutter_params.{name}")));
    let poses = table.real_lists(&column("pose.transform"))?;
    let times = table.reals(&column("pose_timestamp"))?;
    let exposed = shutter("shutter")?;
    let [begun, done] = [shutter("camera_trigger_time")?, shutter("camera_readout_done_time")?];
    let cameras = table.integers(CAMERA)?;
    let mut rows: BTreeMap<i64, Vec<Image>> = BTreeMap::new();
    for (i, micros) in table.integers(TIME)?.into_iter().enumerate() {
        let Some(camera) = camera_name(cameras[i]) else { continue };
        rows.entry(micros).or_default().push(Image {
            place: place(table, micros),
            camera,
            world_from_ego: poses[i].clone(),
            time_s: times[i],
            readout_s: done[i] - begun[i] - exposed[i],
            jpeg: None,
        });
    }
    Ok(rows)
}

/// The cameras' calibrations.
fn cameras(table: &Table) -> Result<Vec<CameraCalibration>, Fault> {
    const LENS: [&str; 9] = ["f_u", "f_v", "c_u", "c_v", "k1", "k2", "p1", "p2", "k3"];
    let column = |name: &str| format!("[CameraCalibrationComponent].{name}");
    let lens = |name: &&str| table.reals(&column(&format!("intrinsic.{name}")));
    let lens = LENS.iter().map(lens).collect::<Result<Vec<_>, _>>()?;
    let extrinsics = table.real_lists(&column("extrinsic.transform"))?;
    let sides = [table.integers(&column("width"))?, table.integers(&column("height"))?];
    let directions = table.integers(&column("rolling_shutter_direction"))?;
    let mut cameras = Vec::new();
    for (i, number) in table.integers(CAMERA)?.into_iter().enumerate() {
        let Some(name) = camera_name(number) else { continue };
        cameras.push(CameraCalibration {
            name,
            intrinsic: lens.iter().map(|numbers| numbers[i]).collect(),
            ego_from_camera: extrinsics[i].clone(),
            width: sides[0][i],
            height: sides[1][i],
            shutter_direction: directions[i],
            place: place_of(table, name),
        });
    }
    Ok(cameras)
}

fn place(table: &Table, micros: i64) -> Place {
    place_of(table, &format!("frame {micros}"))
}

fn place_of(table: &Table, record: &str) -> Place {
    Place { file: table.file.clone(), record: record.into(), offset: None }
}
