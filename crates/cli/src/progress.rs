//! Progress on stderr: a bar on a terminal, plain lines elsewhere, JSON for machines.

use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use occlabel_labels::Program;
use serde_json::{Value, json};

use crate::args::{LogFormat, ProgressArg};
use crate::console::Console;

/// Plain lines come no more often than this, so that logs of long runs stay short.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Shows how far a run has come, until it is dropped.
pub(crate) struct Progress<'a> {
    console: &'a Console,
    style: Style,
    scenes: usize,
    total: usize,
    started: Instant,
    state: Mutex<State>,
}

enum Style {
    Bar(ProgressBar),
    Plain,
    Json,
    None,
}

struct State {
    scenes: usize,
    /// Keyframes that are done, by this run or an earlier one.
    done: usize,
    /// Those of this run.
    labelled: usize,
    rays: u64,
    /// What was skipped or degraded.
    losses: usize,
    last_line: Instant,
}

impl<'a> Progress<'a> {
    /// Over so many keyframes in so many scenes.
    pub(crate) fn new(arg: ProgressArg, console: &'a Console, scenes: usize, total: usize) -> Self {
        let (style, started) = (style(arg, console, total), Instant::now());
        if let Style::Bar(bar) = &style {
            console.set_bar(Some(bar.clone()));
        }
        let state =
            State { scenes: 0, done: 0, labelled: 0, rays: 0, losses: 0, last_line: started };
        let progress = Self { console, style, scenes, total, started, state: Mutex::new(state) };
        let Program { name, version } = Program::current();
        progress.event(
            "start",
            || json!({ "program": name, "version": version, "scenes": scenes, "keyframes": total }),
        );
        progress
    }

    /// A scene is begun: so many keyframes are to be labelled, so many were by earlier runs.
    pub(crate) fn scene(&self, name: &str, due: usize, kept: usize) {
        let mut state = self.state();
        state.scenes += 1;
        state.done += kept;
        let place = format!("{name} ({} of {} scenes)", state.scenes, self.scenes);
        match &self.style {
            Style::Bar(bar) => {
                bar.set_message(occlabel_core::printable(&place));
                bar.inc(kept as u64);
            }
            Style::Plain if due > 0 => self.console.info(&format!("{place}: aggregating sweeps")),
            _ => self.event("scene", || json!({ "scene": name, "keyframes": due, "kept": kept })),
        }
    }

    /// A keyframe is done, and so many rays with it.
    pub(crate) fn keyframe(&self, scene: &str, token: &str, rays: u64) {
        let mut state = self.state();
        state.done += 1;
        state.labelled += 1;
        state.rays += rays;
        let rate = state.rays as f64 / self.seconds() / 1e6;
        match &self.style {
            Style::Bar(bar) => {
                bar.set_prefix(format!("{rate:.1} M rays/s"));
                bar.inc(1);
            }
            Style::Plain if state.last_line.elapsed() >= PLAIN_EVERY => {
                state.last_line = Instant::now();
                let (done, total, left) = (state.done, self.total, self.seconds_left(&state));
                self.console.info(&format!(
                    "{scene}: {done} of {total} keyframes, {rate:.1} M rays/s, {left:.0} s left"
                ));
            }
            _ => self.event("keyframe", || {
                json!({
                    "scene": scene, "keyframe": token, "rays": rays,
                    "done": state.done, "total": self.total, "seconds": self.seconds(),
                })
            }),
        }
    }

    /// All of a scene is done; so many things were skipped or degraded in the run until now.
    pub(crate) fn scene_done(&self, name: &str, counts: impl FnOnce() -> Value, losses: usize) {
        self.state().losses = losses;
        self.event(
            "scene_done",
            || json!({ "scene": name, "counts": counts(), "seconds": self.seconds() }),
        );
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no thread panics while it counts")
    }

    fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn seconds_left(&self, state: &State) -> f64 {
        let each = self.seconds() / state.labelled.max(1) as f64;
        each * self.total.saturating_sub(state.done) as f64
    }

    fn event(&self, name: &str, fields: impl FnOnce() -> Value) {
        if matches!(self.style, Style::Json) {
            self.console.event(name, fields());
        }
    }
}

impl Drop for Progress<'_> {
    /// The exit code comes last, after what went wrong was told.
    fn drop(&mut self) {
        match (&self.style, self.state.lock()) {
            (Style::Bar(bar), _) => {
                self.console.set_bar(None);
                bar.finish_and_clear();
            }
            (Style::Json, Ok(state)) => self.console.will_end(json!({
                "keyframes": state.done, "rays": state.rays,
                "skipped_or_degraded": state.losses, "seconds": self.seconds(),
            })),
            _ => {}
        }
    }
}

fn style(arg: ProgressArg, console: &Console, keyframes: usize) -> Style {
    match arg {
        _ if console.quiet => Style::None,
        ProgressArg::Auto if console.format == LogFormat::Json => Style::Json,
        ProgressArg::Auto if std::io::stderr().is_terminal() => Style::Bar(bar(keyframes)),
        ProgressArg::Bar => Style::Bar(bar(keyframes)),
        ProgressArg::Auto | ProgressArg::Plain => Style::Plain,
        ProgressArg::Json => Style::Json,
        ProgressArg::None => Style::None,
    }
}

fn bar(keyframes: usize) -> ProgressBar {
    let template = "{msg} {wide_bar} {pos}/{len} keyframes, {prefix}, {eta} left";
    let style = ProgressStyle::with_template(template).expect("a valid template");
    ProgressBar::new(keyframes as u64).with_style(style).with_prefix("0.0 M rays/s")
}
