//! The label sets that a run writes: the one that is asked for, and others of the same aggregation.
//!
//! ```text
//!   OUTPUT/                 the main set, in the configuration's grid
//!   OUTPUT/at-0.8m/         its labels pooled into voxels of 0.8 m
//!   OUTPUT/in-fine/         labels in the grid of `fine.toml`
//!   OUTPUT/in-surroundocc/  labels in the grid and the files of a dialect
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{Blocks, Fault, GridSpec, OccupancyLabels, Scene};
use occlabel_dialects::{Dialect, KeyframeInfo, scene_infos};
use occlabel_disk as disk;
use occlabel_labels::{FileRecord, TreePath, evidence_npz, labels_npz};
use occlabel_pipeline::{Config, GridFrame, GridTable, Rules};
use occlabel_voxelize::pool;

use crate::input::{Opened, grid_of_file, published_grid};
use crate::label::target_dialect::{Source, TargetDialect};

/// The label sets that a run writes, by the grids that are labelled.
pub(crate) struct Targets {
    /// The configuration's grid first.
    pub(crate) grids: Vec<LabelledGrid>,
}

/// The files of a keyframe.
pub(crate) type KeyframeFiles = Vec<(TreePath, Vec<u8>)>;

/// A grid that is labelled, and what is written of it.
pub(crate) struct LabelledGrid {
    pub(crate) rules: Rules,
    pub(crate) config: Config,
    pub(crate) targets: Vec<Target>,
}

/// Labels that are written into a folder of their own.
pub(crate) struct Target {
    /// Below the output; none is the output itself.
    pub(crate) folder: Option<String>,
    pooled: Option<Blocks>,
    /// None is our own layout.
    dialect: Option<TargetDialect>,
    /// What the arrays do not say.
    pub(crate) notes: Vec<String>,
}

impl Targets {
    /// The main set and those of `--also`: voxel sizes in metres to pool into, dialects, and files
    /// with a `[grid]` to label in.
    ///
    /// # Errors
    /// If a size makes no whole blocks of voxels, a file has no grid, or two would share a folder.
    pub(crate) fn new(
        opened: &Opened,
        dialect: Option<&Dialect>,
        also: &[String],
    ) -> Result<Self, Fault> {
        let mut targets = Self { grids: Vec::new() };
        targets.add_grid(opened, opened.config.grid.clone(), None, dialect.cloned())?;
        for text in also {
            match text.parse::<f64>() {
                Ok(size_m) => targets.add_pooled(text, size_m)?,
                Err(_) => targets.add_named(opened, text)?,
            }
        }
        targets.check_folders()?;
        Ok(targets)
    }

    fn add_pooled(&mut self, text: &str, size_m: f64) -> Result<(), Fault> {
        let fine = &self.grids[0].rules.spec;
        let blocks = Blocks::of(fine, [size_m; 3]).map_err(|fault| of_also(fault, text))?;
        let folder = Some(format!("at-{size_m}m"));
        let size = fine.size_m();
        let notes = vec![format!("pooled from voxels of {} x {} x {} m", size.x, size.y, size.z)];
        let target = Target { folder, pooled: Some(blocks), dialect: None, notes };
        self.grids[0].targets.push(target);
        Ok(())
    }

    /// A dialect, or a file with a grid.
    fn add_named(&mut self, opened: &Opened, text: &str) -> Result<(), Fault> {
        if Dialect::names().contains(&text) {
            let dialect = Dialect::named(text)?;
            let grid = published_grid(&dialect)?;
            return self.add_grid(opened, grid, Some(format!("in-{text}")), Some(dialect));
        }
        let file = Path::new(text);
        if !disk::is_file(file) {
            let expected = format!(
                "a voxel size in metres, a file with a [grid], or one of {}",
                Dialect::names().join(", ")
            );
            return Err(Fault::new("also", "--also", expected, format!("`{text}`")));
        }
        let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let folder = format!("in-{}", stem.unwrap_or_default());
        self.add_grid(opened, grid_of_file(file)?, Some(folder), None)
    }

    fn add_grid(
        &mut self,
        opened: &Opened,
        grid: GridTable,
        folder: Option<String>,
        dialect: Option<Dialect>,
    ) -> Result<(), Fault> {
        folder.as_ref().map(TreePath::new).transpose()?;
        let config = Config { grid, ..opened.config.clone() };
        let taxonomy = &opened.rules.taxonomy;
        let rules = Rules::new(&config, taxonomy.clone())?;
        let dialect = dialect.map(|dialect| TargetDialect::new(dialect, taxonomy)).transpose()?;
        let notes = dialect.as_ref().map_or(Ok(Vec::new()), |dialect| dialect.notes(&rules))?;
        let targets = vec![Target { folder, pooled: None, dialect, notes }];
        self.grids.push(LabelledGrid { rules, config, targets });
        Ok(())
    }

    fn check_folders(&self) -> Result<(), Fault> {
        let mut seen = BTreeSet::new();
        let folders = self.all().filter_map(|(_, target)| target.folder.as_ref());
        match folders.into_iter().find(|folder| !seen.insert(*folder)) {
            None => Ok(()),
            Some(twice) => {
                Err(Fault::new("also", "--also", "each grid once", format!("`{twice}` twice")))
            }
        }
    }

    /// Every set with its grid, the main one first.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&LabelledGrid, &Target)> {
        self.grids.iter().flat_map(|grid| grid.targets.iter().map(move |target| (grid, target)))
    }

    /// The grid of most voxels: what memory is planned by.
    pub(crate) fn largest(&self) -> &GridSpec {
        let specs = self.grids.iter().map(|grid| &grid.rules.spec);
        specs.max_by_key(|spec| spec.len()).expect("a main grid")
    }

    /// Whether a set says what only evidence knows.
    pub(crate) fn need_evidence(&self) -> bool {
        self.grids.iter().any(LabelledGrid::needs_evidence)
    }

    /// What a list of keyframes says of a scene; nothing if no set has such a list.
    pub(crate) fn infos(&self, scene: &Scene) -> Result<BTreeMap<String, KeyframeInfo>, Fault> {
        let lists = self.all().filter_map(|(_, target)| target.dialect());
        let listing = lists.into_iter().find(|dialect| dialect.annotations.is_some());
        listing.map_or(Ok(BTreeMap::new()), |dialect| {
            scene_infos(scene, |token| dialect.semantics_path(&scene.name, token))
        })
    }

    /// Files without which a keyframe is not finished.
    pub(crate) fn paths(
        &self,
        scene: &str,
        token: &str,
        evidence: bool,
    ) -> Result<Vec<TreePath>, Fault> {
        let paths = self.all().map(|(_, target)| target.paths(scene, token, evidence));
        Ok(paths.collect::<Result<Vec<_>, _>>()?.concat())
    }
}

impl LabelledGrid {
    /// Whether a set says what only evidence knows.
    pub(crate) fn needs_evidence(&self) -> bool {
        let dialects = self.targets.iter().filter_map(|target| target.dialect.as_ref());
        dialects.into_iter().any(TargetDialect::needs_evidence)
    }

    /// The grid's frame as manifests name it.
    pub(crate) fn frame(&self) -> &'static str {
        frame_name(self.rules.frame)
    }
}

impl Target {
    /// The grid of its arrays.
    pub(crate) fn spec<'a>(&'a self, grid: &'a LabelledGrid) -> &'a GridSpec {
        self.pooled.as_ref().map_or(&grid.rules.spec, Blocks::coarse)
    }

    /// The name, without ending, of the file that lists all keyframes, if the dialect has one.
    pub(crate) fn list_stem(&self) -> Option<&str> {
        self.dialect()?.annotations.as_deref()?.strip_suffix(".json")
    }

    /// The record of a file as the set's own manifest has it; none if it is of another set.
    pub(crate) fn own_record(&self, file: &FileRecord) -> Option<FileRecord> {
        Some(FileRecord { path: self.own(&file.path)?, keyframe: None, ..file.clone() })
    }

    /// The dialect's name; none of our own layout.
    pub(crate) fn dialect(&self) -> Option<&Dialect> {
        self.dialect.as_ref().map(|target| &target.dialect)
    }

    /// The files of a keyframe, in the order of writing; evidence if it is written beside labels.
    pub(crate) fn files(
        &self,
        source: &Source,
        labels: &OccupancyLabels,
        evidence: bool,
    ) -> Result<KeyframeFiles, Fault> {
        let files = match &self.dialect {
            Some(dialect) => dialect.encode(source, labels)?.files,
            None => self.own_files(source, labels, evidence)?,
        };
        files.into_iter().map(|(path, bytes)| Ok((self.place(path)?, bytes))).collect()
    }

    fn own_files(
        &self,
        source: &Source,
        labels: &OccupancyLabels,
        evidence: bool,
    ) -> Result<KeyframeFiles, Fault> {
        let (scene, token) = (&source.scene.name, &source.keyframe.token);
        let taxonomy = &source.rules.taxonomy;
        let pooled = self.pooled.as_ref();
        let pooled = pooled.map(|blocks| pool(labels, blocks, taxonomy.free, &taxonomy.rank));
        let labels = pooled.as_ref().unwrap_or(labels);
        let evidence = labels.evidence.as_ref().filter(|_| evidence).map(evidence_npz);
        let evidence = evidence.map(|bytes| Ok((TreePath::evidence(scene, token)?, bytes)));
        let labels = Ok((TreePath::labels(scene, token)?, labels_npz(labels)));
        evidence.into_iter().chain([labels]).collect()
    }

    /// Files without which a keyframe is not finished.
    fn paths(&self, scene: &str, token: &str, evidence: bool) -> Result<Vec<TreePath>, Fault> {
        let paths = match &self.dialect {
            Some(dialect) => vec![dialect.dialect.semantics_path(scene, token)?],
            None if evidence => {
                vec![TreePath::evidence(scene, token)?, TreePath::labels(scene, token)?]
            }
            None => vec![TreePath::labels(scene, token)?],
        };
        paths.into_iter().map(|path| self.place(path)).collect()
    }

    /// Where a file of the set stands in the output.
    fn place(&self, path: TreePath) -> Result<TreePath, Fault> {
        match &self.folder {
            None => Ok(path),
            Some(folder) => TreePath::new(format!("{folder}/{path}")),
        }
    }

    /// A file of the output as a file of the set; none if it is of another.
    fn own(&self, path: &TreePath) -> Option<TreePath> {
        let own = match &self.folder {
            None => path.as_str(),
            Some(folder) => path.as_str().strip_prefix(folder.as_str())?.strip_prefix('/')?,
        };
        TreePath::new(own).ok()
    }
}

/// A frame as manifests name it.
pub(crate) fn frame_name(frame: GridFrame) -> &'static str {
    match frame {
        GridFrame::Ego => "ego",
        GridFrame::Lidar => "lidar",
    }
}

fn of_also(fault: Fault, text: &str) -> Fault {
    Fault { place: "--also".to_owned(), ..fault }.record(text)
}
