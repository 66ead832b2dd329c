//! The table files of a log, written row by row: however large they grow, none is held in memory.

use crate::tables::{
    Attribute, CalibratedSensor, Category, EgoPose, Instance, Lidarseg, Log, Map, Sample,
    SampleAnnotation, SampleData, Scene, Sensor, Visibility,
};
use serde::Serialize;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::marker::PhantomData;
use std::path::Path;

/// One JSON array of rows, a row a line.
pub(crate) struct Table<Row> {
    file: BufWriter<File>,
    separator: &'static str,
    row: PhantomData<Row>,
}

impl<Row: Serialize> Table<Row> {
    fn create(directory: &Path, name: &str) -> io::Result<Self> {
        let file = BufWriter::new(File::create(directory.join(format!("{name}.json")))?);
        Ok(Self { file, separator: "[\n", row: PhantomData })
    }

    pub(crate) fn push(&mut self, row: &Row) -> io::Result<()> {
        self.file.write_all(self.separator.as_bytes())?;
        self.separator = ",\n";
        Ok(serde_json::to_writer(&mut self.file, row)?)
    }

    pub(crate) fn extend(&mut self, rows: impl IntoIterator<Item = Row>) -> io::Result<()> {
        rows.into_iter().try_for_each(|row| self.push(&row))
    }

    fn finish(mut self) -> io::Result<()> {
        let end = if self.separator == "[\n" { "[]\n" } else { "\n]\n" };
        self.file.write_all(end.as_bytes())?;
        self.file.flush()
    }
}

/// All tables of a log.
pub(crate) struct TableSet {
    pub(crate) attribute: Table<Attribute>,
    pub(crate) calibrated_sensor: Table<CalibratedSensor>,
    pub(crate) category: Table<Category>,
    pub(crate) ego_pose: Table<EgoPose>,
    pub(crate) instance: Table<Instance>,
    /// nuScenes' own add-on: there is none in a log without point labels.
    pub(crate) lidarseg: Option<Table<Lidarseg>>,
    pub(crate) log: Table<Log>,
    pub(crate) map: Table<Map>,
    pub(crate) sample: Table<Sample>,
    pub(crate) sample_annotation: Table<SampleAnnotation>,
    pub(crate) sample_data: Table<SampleData>,
    pub(crate) scene: Table<Scene>,
    pub(crate) sensor: Table<Sensor>,
    pub(crate) visibility: Table<Visibility>,
}

impl TableSet {
    pub(crate) fn create(directory: &Path, labels: bool) -> io::Result<Self> {
        std::fs::create_dir_all(directory)?;
        Ok(Self {
            attribute: Table::create(directory, "attribute")?,
            calibrated_sensor: Table::create(directory, "calibrated_sensor")?,
            category: Table::create(directory, "category")?,
            ego_pose: Table::create(directory, "ego_pose")?,
            instance: Table::create(directory, "instance")?,
            lidarseg: labels.then(|| Table::create(directory, "lidarseg")).transpose()?,
            log: Table::create(directory, "log")?,
            map: Table::create(directory, "map")?,
            sample: Table::create(directory, "sample")?,
            sample_annotation: Table::create(directory, "sample_annotation")?,
            sample_data: Table::create(directory, "sample_data")?,
            scene: Table::create(directory, "scene")?,
            sensor: Table::create(directory, "sensor")?,
            visibility: Table::create(directory, "visibility")?,
        })
    }

    pub(crate) fn finish(self) -> io::Result<()> {
        self.attribute.finish()?;
        self.calibrated_sensor.finish()?;
        self.category.finish()?;
        self.ego_pose.finish()?;
        self.instance.finish()?;
        self.lidarseg.map_or(Ok(()), Table::finish)?;
        self.log.finish()?;
        self.map.finish()?;
        self.sample.finish()?;
        self.sample_annotation.finish()?;
        self.sample_data.finish()?;
        self.scene.finish()?;
        self.sensor.finish()?;
        self.visibility.finish()
    }
}
