//! The images of v2: range images as rows of the components `lidar`, `lidar_pose` and
//! `lidar_segmentation`, JPEGs as rows of `camera_image`.

use occlabel_core::{Fault, SweepHeader, Timestamp};

use super::components::{CAMERA, Components, IMAGES, LASER, TIME, file, image_rows};
use super::matrix::Matrix;
use super::parquet_cursor::Cursors;
use super::parquet_table::{Row, Table};
use super::range_image::{LABEL, PIXEL, POSE, RangeImages, Return};
use super::segment::{Image, LidarCalibration, camera_number};
use super::sweep_id::SweepId;

pub(super) const POSES: &str = "lidar_pose";
const LABELS: &str = "lidar_segmentation";
const JPEG: &str = "[CameraImageComponent].image";

impl Components {
    /// The files that a sweep needs, its points first.
    pub(super) fn sweep_files(&self, id: &SweepId, sweep: &SweepHeader) -> Vec<String> {
        let labels = sweep.labelled.then(|| file(LABELS, &id.segment));
        [sweep.file.clone(), file(POSES, &id.segment)].into_iter().chain(labels).collect()
    }

    /// What a lidar saw in a sweep, and how it is calibrated.
    ///
    /// # Errors
    /// If a file is absent or broken, or its range images are none.
    pub(super) fn images(
        &self,
        id: &SweepId,
        sweep: &SweepHeader,
    ) -> Result<(RangeImages, LidarCalibration), Fault> {
        let calibration = self.lidar(&id.segment, id.lidar, sweep)?;
        let Some(points) = self.sweep_row("lidar", id)? else {
            let expected = "a row of that sweep";
            return Err(
                Fault::new("range-image", &sweep.file, expected, "none").record(&sweep.source_id)
            );
        };
        let labels = if sweep.labelled { self.sweep_row(LABELS, id)? } else { None };
        let mut returns = Vec::new();
        for number in [1, 2] {
            let column = format!("[LiDARComponent].range_image_return{number}");
            let Some(pixels) = points.floats(&column, PIXEL)? else { continue };
            let column = format!("[LiDARSegmentationLabelComponent].range_image_return{number}");
            let labels = labels.as_ref().map(|row| row.integers(&column, LABEL)).transpose()?;
            returns.push(Return { pixels, labels: labels.flatten() });
        }
        let poses = self.sweep_row(POSES, id)?;
        let column = "[LiDARPoseComponent].range_image_return1";
        let poses = poses.map(|row| row.floats(column, POSE)).transpose()?.flatten();
        Ok((RangeImages { returns, poses }, calibration))
    }

    /// The JPEG that a camera took at a time, if there is one.
    ///
    /// # Errors
    /// If its file is broken.
    pub(super) fn jpeg(
        &self,
        segment: &str,
        camera: &str,
        time: Timestamp,
    ) -> Result<Option<Vec<u8>>, Fault> {
        let table = match self.table(IMAGES, segment) {
            Err(absent) if absent.rule == "missing-file" => return Ok(None),
            table => table?,
        };
        let took = |(micros, images): &(&i64, &Vec<Image>)| {
            let of_frame = Timestamp::from_micros(**micros);
            images.iter().any(|image| image.camera == camera && image.exposed(of_frame) == time)
        };
        let frames = image_rows(&table)?;
        let (Some((micros, _)), Some(number)) = (frames.iter().find(took), camera_number(camera))
        else {
            return Ok(None);
        };
        match table.find([(TIME, *micros), (CAMERA, number)])? {
            Some(row) if table.has(JPEG) => {
                let bytes = table.bytes_at(&self.cursors, JPEG, row)?;
                Ok(Some(bytes).filter(|bytes| !bytes.is_empty()))
            }
            _ => Ok(None),
        }
    }

    /// A sweep's row of a component, if it has one.
    fn sweep_row(&self, component: &str, id: &SweepId) -> Result<Option<SweepRow<'_>>, Fault> {
        let table = self.table(component, &id.segment)?;
        let row = table.find([(TIME, id.micros), (LASER, id.lidar.number())])?;
        let (cursors, record) = (&self.cursors, id.to_string());
        Ok(row.map(|row| SweepRow { table, row, cursors, record }))
    }
}

/// The row of a sweep in a component.
struct SweepRow<'a> {
    table: Table,
    row: Row,
    cursors: &'a Cursors,
    record: String,
}

impl SweepRow<'_> {
    /// An image of numbers; `None` if there is none.
    fn floats(&self, column: &str, values: usize) -> Result<Option<Matrix<f32>>, Fault> {
        let Some(shape) = self.shape(column)? else { return Ok(None) };
        let column = format!("{column}.values");
        let data = self.table.floats_at(self.cursors, &column, self.row)?;
        self.matrix(&shape, values, data).map(Some)
    }

    /// An image of integers; `None` if there is none.
    fn integers(&self, column: &str, values: usize) -> Result<Option<Matrix<i32>>, Fault> {
        let Some(shape) = self.shape(column)? else { return Ok(None) };
        let column = format!("{column}.values");
        let data = self.table.integers_at(self.cursors, &column, self.row)?;
        let data = data.into_iter().map(|value| value as i32).collect();
        self.matrix(&shape, values, data).map(Some)
    }

    /// The shape of an image; `None` if there is no image.
    fn shape(&self, column: &str) -> Result<Option<Vec<i32>>, Fault> {
        let column = format!("{column}.shape");
        if !self.table.has(&column) {
            return Ok(None);
        }
        let sides = self.table.integers_at(self.cursors, &column, self.row)?;
        let side = |side: i64| i32::try_from(side).unwrap_or(-1);
        Ok((!sides.is_empty()).then(|| sides.into_iter().map(side).collect()))
    }

    fn matrix<T>(&self, shape: &[i32], values: usize, data: Vec<T>) -> Result<Matrix<T>, Fault> {
        Matrix::new(shape, values, data).map_err(|found| {
            let expected = format!("a range image of {values} values a pixel");
            Fault::new("range-image", &self.table.file, expected, found).record(&self.record)
        })
    }
}
