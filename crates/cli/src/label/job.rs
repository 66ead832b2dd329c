//! A log, what decides its labels, and where messages go: what every part of the work needs.

use occlabel_dialects::Dialect;

use crate::args::{OnError, WorkArgs};
use crate::console::Console;
use crate::exit::Stop;
use crate::input::{Opened, Stead, open_with, published_grid};
use crate::label::targets::Targets;
use crate::threads::start_threads;

pub(crate) struct Job<'a> {
    pub(crate) args: &'a WorkArgs,
    pub(crate) console: &'a Console,
    pub(crate) opened: Opened,
    pub(crate) targets: Targets,
    pub(crate) threads: usize,
}

impl<'a> Job<'a> {
    /// Opens the log and resolves what decides its labels.
    pub(crate) fn open(args: &'a WorkArgs, console: &'a Console) -> Result<Self, Stop> {
        let threads = start_threads(args.jobs);
        let dialect = args.dialect.as_deref().map(Dialect::named);
        let dialect = dialect.transpose().map_err(Stop::usage)?;
        let grid = dialect.as_ref().map(published_grid).transpose()?;
        let opened = open_with(&args.log, &args.config, &Stead { grid, ..Stead::default() })?;
        let targets = Targets::new(&opened, dialect.as_ref(), &args.also).map_err(Stop::usage)?;
        Ok(Self { args, console, opened, targets, threads })
    }

    /// Whether what cannot be used is left out, rather than ending the run.
    pub(crate) fn skips(&self) -> bool {
        self.args.on_error == OnError::Skip
    }
}
