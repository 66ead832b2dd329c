//! Progress on stderr: a bar on a terminal, plain lines elsewhere, JSON for machines.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::args::{LogFormat, ProgressArg};
use crate::console::Console;

/// Plain lines come no more often than this, so that logs of long runs stay short.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Shows how far a run has come.
pub(crate) struct Progress {
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
    keyframes: usize,
    rays: u64,
    last_line: Instant,
}

impl Progress {
    /// Over so many keyframes in so many scenes.
    pub(crate) fn new(
        arg: ProgressArg,
        console: &Console,
        scenes: usize,
        keyframes: usize,
    ) -> Self {
        let style = match arg {
            _ if console.quiet => Style::None,
            ProgressArg::Auto if console.format == LogFormat::Json => Style::Json,
            ProgressArg::Auto if std::io::stderr().is_terminal() => Style::Bar(bar(keyframes)),
            ProgressArg::Bar => Style::Bar(bar(keyframes)),
            ProgressArg::Auto | ProgressArg::Plain => Style::Plain,
            ProgressArg::Json => Style::Json,
            ProgressArg::None => Style::None,
        };
        let now = Instant::now();
        let state = Mutex::new(State { scenes: 0, keyframes: 0, rays: 0, last_line: now });
        let progress = Self { style, scenes, total: keyframes, started: now, state };
        progress.event(json!({ "event": "start", "scenes": scenes, "keyframes": keyframes }));
        progress
    }

    /// A scene's sweeps are being read.
    pub(crate) fn scene(&self, name: &str) {
        let mut state = self.state.lock().expect("no thread panics while it counts");
        state.scenes += 1;
        let place = format!("{name} ({} of {} scenes)", state.scenes, self.scenes);
        match &self.style {
            Style::Bar(bar) => bar.set_message(place),
            Style::Plain => line(&format!("{place}: aggregating sweeps")),
            Style::Json => self.event(json!({ "event": "scene", "scene": name })),
            Style::None => {}
        }
    }

    /// A keyframe is done, and so many rays with it.
    pub(crate) fn keyframe(&self, scene: &str, token: &str, rays: u64) {
        let mut state = self.state.lock().expect("no thread panics while it counts");
        state.keyframes += 1;
        state.rays += rays;
        let rate = state.rays as f64 / self.started.elapsed().as_secs_f64() / 1e6;
        match &self.style {
            Style::Bar(bar) => {
                bar.set_prefix(format!("{rate:.1} M rays/s"));
                bar.inc(1);
            }
            Style::Plain if state.last_line.elapsed() >= PLAIN_EVERY => {
                state.last_line = Instant::now();
                let (done, left) = (state.keyframes, self.seconds_left(state.keyframes));
                line(&format!(
                    "{scene}: {done} of {} keyframes, {rate:.1} M rays/s, {left:.0} s left",
                    self.total
                ));
            }
            Style::Json => self.event(json!({
                "event": "keyframe", "scene": scene, "keyframe": token,
                "done": state.keyframes, "total": self.total,
            })),
            Style::Plain | Style::None => {}
        }
    }

    /// Writes a message so that it does not cut through the bar.
    pub(crate) fn suspend(&self, write: impl FnOnce()) {
        match &self.style {
            Style::Bar(bar) => bar.suspend(write),
            _ => write(),
        }
    }

    /// The run is over.
    pub(crate) fn finish(&self) {
        if let Style::Bar(bar) = &self.style {
            bar.finish_and_clear();
        }
        self.event(json!({ "event": "end" }));
    }

    fn seconds_left(&self, done: usize) -> f64 {
        let each = self.started.elapsed().as_secs_f64() / done.max(1) as f64;
        each * self.total.saturating_sub(done) as f64
    }

    fn event(&self, event: serde_json::Value) {
        if matches!(self.style, Style::Json) {
            line(&event.to_string());
        }
    }
}

fn bar(keyframes: usize) -> ProgressBar {
    let template = "{msg} {wide_bar} {pos}/{len} keyframes, {prefix}, {eta} left";
    let style = ProgressStyle::with_template(template).expect("a valid template");
    ProgressBar::new(keyframes as u64).with_style(style).with_prefix("0.0 M rays/s")
}

fn line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
