//! The label sets that a run writes: the one that is asked for, and others of the same aggregation.
//!
//! ```text
//!   OUTPUT/            the main set, in the configuration's grid
//!   OUTPUT/at-0.8m/    its labels pooled into voxels of 0.8 m
//!   OUTPUT/in-fine/    labels in the grid of `fine.toml`
//! ```

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::{Blocks, Fault, GridSpec, OccupancyLabels};
use occlabel_labels::{TreePath, evidence_npz, labels_npz};
use occlabel_pipeline::{Config, GridFrame, Rules};
use occlabel_voxelize::pool;

use crate::input::{Opened, grid_of_file};

/// The label sets that a run writes, by the grids that are labelled.
pub(crate) struct Targets {
    /// The configuration's grid first.
    pub(crate) grids: Vec<LabelledGrid>,
}

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
}

impl Targets {
    /// The main set and those of `--also`: voxel sizes in metres to pool into, and files with a
    /// `[grid]` to label in.
    ///
    /// # Errors
    /// If a size makes no whole blocks of voxels, a file has no grid, or two would share a folder.
    pub(crate) fn new(opened: &Opened, also: &[String]) -> Result<Self, Fault> {
        let main = LabelledGrid {
            rules: opened.rules.clone(),
            config: opened.config.clone(),
            targets: vec![Target { folder: None, pooled: None }],
        };
        let mut targets = Self { grids: vec![main] };
        for text in also {
            match text.parse::<f64>() {
                Ok(size_m) => targets.add_pooled(text, size_m)?,
                Err(_) => targets.add_grid(opened, Path::new(text))?,
            }
        }
        targets.check_folders()?;
        Ok(targets)
    }

    fn add_pooled(&mut self, text: &str, size_m: f64) -> Result<(), Fault> {
        let fine = &self.grids[0].rules.spec;
        let blocks = Blocks::of(fine, [size_m; 3]).map_err(|fault| of_also(fault, text))?;
        let folder = Some(format!("at-{size_m}m"));
        self.grids[0].targets.push(Target { folder, pooled: Some(blocks) });
        Ok(())
    }

    fn add_grid(&mut self, opened: &Opened, file: &Path) -> Result<(), Fault> {
        let mut config = opened.config.clone();
        config.grid = grid_of_file(file)?;
        let rules = Rules::new(&config, opened.rules.taxonomy.clone())?;
        let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let folder = format!("in-{}", stem.unwrap_or_default());
        TreePath::new(&folder)?;
        let targets = vec![Target { folder: Some(folder), pooled: None }];
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

    /// The files of a keyframe.
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
    /// The grid's frame as manifests name it.
    pub(crate) fn frame(&self) -> &'static str {
        match self.rules.frame {
            GridFrame::Ego => "ego",
            GridFrame::Lidar => "lidar",
        }
    }
}

impl Target {
    /// The grid of its arrays.
    pub(crate) fn spec<'a>(&'a self, grid: &'a LabelledGrid) -> &'a GridSpec {
        self.pooled.as_ref().map_or(&grid.rules.spec, Blocks::coarse)
    }

    /// What the arrays do not say.
    pub(crate) fn notes(&self, grid: &LabelledGrid) -> Vec<String> {
        let size = grid.rules.spec.size_m();
        let pooled = self.pooled.iter();
        pooled
            .map(|_| format!("pooled from voxels of {} x {} x {} m", size.x, size.y, size.z))
            .collect()
    }

    /// The files of a keyframe, in the order of writing.
    pub(crate) fn files(
        &self,
        grid: &LabelledGrid,
        labels: &OccupancyLabels,
        scene: &str,
        token: &str,
    ) -> Result<Vec<(TreePath, Vec<u8>)>, Fault> {
        let taxonomy = &grid.rules.taxonomy;
        let pooled = self.pooled.as_ref();
        let pooled = pooled.map(|blocks| pool(labels, blocks, taxonomy.free, &taxonomy.rank));
        let labels = pooled.as_ref().unwrap_or(labels);
        let evidence = labels.evidence.as_ref().map(evidence_npz);
        let bytes = evidence.into_iter().chain([labels_npz(labels)]);
        let paths = self.paths(scene, token, labels.evidence.is_some())?;
        Ok(paths.into_iter().zip(bytes).collect())
    }

    fn paths(&self, scene: &str, token: &str, evidence: bool) -> Result<Vec<TreePath>, Fault> {
        let evidence = evidence.then(|| TreePath::evidence(scene, token));
        let paths = evidence.into_iter().chain([TreePath::labels(scene, token)]);
        paths.map(|path| self.place(path?)).collect()
    }

    /// Where a file of the set stands in the output.
    fn place(&self, path: TreePath) -> Result<TreePath, Fault> {
        match &self.folder {
            None => Ok(path),
            Some(folder) => TreePath::new(format!("{folder}/{path}")),
        }
    }

    /// A file of the output as a file of the set; none if it is of another.
    pub(crate) fn own(&self, path: &TreePath) -> Option<TreePath> {
        let own = match &self.folder {
            None => path.as_str(),
            Some(folder) => path.as_str().strip_prefix(folder.as_str())?.strip_prefix('/')?,
        };
        TreePath::new(own).ok()
    }
}

fn of_also(fault: Fault, text: &str) -> Fault {
    Fault { place: "--also".to_owned(), ..fault }.record(text)
}
