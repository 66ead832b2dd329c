//! Messages on stderr: text or JSON lines. Results go to stdout.

use std::io::{ErrorKind, Write};
use std::sync::Mutex;

use indicatif::ProgressBar;
use occlabel_core::{Fault, printable};
use serde_json::{Value, json};

use crate::args::LogFormat;
use crate::exit::outcome_name;

/// The version of the JSON lines on stderr, which `docs/logging.md` describes.
const SCHEMA: u64 = 1;

/// Where messages go, and how. Every line is one write, whichever thread it comes from.
#[derive(Debug)]
pub(crate) struct Console {
    pub(crate) format: LogFormat,
    pub(crate) quiet: bool,
    /// What kept a result from being written, if anything did.
    refused: Mutex<Option<Fault>>,
    /// What lines must not cut through.
    bar: Mutex<Option<ProgressBar>>,
    /// What the last event says beside the exit code, once there was a first.
    ending: Mutex<Option<Value>>,
}

impl Console {
    pub(crate) fn new(format: LogFormat, quiet: bool) -> Self {
        let (refused, bar, ending) = <_>::default();
        Self { format, quiet, refused, bar, ending }
    }

    /// What the user must know.
    pub(crate) fn error(&self, fault: &Fault) {
        self.fault("error", None, fault);
    }

    /// What the user may want to know.
    pub(crate) fn warning(&self, scene: &str, fault: &Fault) {
        if !self.quiet {
            self.fault("warning", Some(scene), fault);
        }
    }

    /// What is going on.
    pub(crate) fn info(&self, message: &str) {
        match self.format {
            _ if self.quiet => {}
            LogFormat::Text => self.line(printable(message)),
            LogFormat::Json => self.event("note", json!({ "level": "info", "message": message })),
        }
    }

    /// A line for machines, as JSON in either format.
    pub(crate) fn event(&self, name: &str, mut fields: Value) {
        escape(&mut fields);
        fields["schema"] = json!(SCHEMA);
        fields["event"] = json!(name);
        self.line(fields.to_string());
    }

    /// There will be an event `end`, and it will say this.
    pub(crate) fn will_end(&self, fields: Value) {
        *self.ending.lock().expect("no thread panics while it prints") = Some(fields);
    }

    /// The program ends.
    pub(crate) fn end(&self, code: u8) {
        let ending = self.ending.lock().expect("no thread panics while it prints").take();
        if let Some(mut fields) = ending {
            fields["exit_code"] = json!(code);
            fields["outcome"] = json!(outcome_name(code));
            self.event("end", fields);
        }
    }

    /// Keeps lines from cutting through a bar, from now on or no longer.
    pub(crate) fn set_bar(&self, bar: Option<ProgressBar>) {
        *self.bar.lock().expect("no thread panics while it prints") = bar;
    }

    /// A line of the result.
    pub(crate) fn result(&self, line: &str) {
        self.results(format!("{line}\n").as_bytes());
    }

    /// Bytes of the result. A reader that went away is no error; a full disk is, and is kept.
    pub(crate) fn results(&self, bytes: &[u8]) {
        let mut stdout = std::io::stdout();
        match self.beside_bar(|| stdout.write_all(bytes).and_then(|()| stdout.flush())) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                let fault =
                    Fault::new("stdout", "stdout", "to write the result", error.to_string());
                *self.refused.lock().expect("no thread panics while it prints") = Some(fault);
            }
            _ => {}
        }
    }

    /// What kept a result from being written, if anything did.
    pub(crate) fn refused(&self) -> Option<Fault> {
        self.refused.lock().expect("no thread panics while it prints").take()
    }

    fn fault(&self, level: &str, scene: Option<&str>, fault: &Fault) {
        match (self.format, scene) {
            (LogFormat::Text, Some(scene)) => {
                self.line(format!("{level}: {}: {fault}", printable(scene)));
            }
            (LogFormat::Text, None) => self.line(format!("{level}: {fault}")),
            (LogFormat::Json, scene) => {
                let mut fields = fault_json(fault);
                (fields["level"], fields["scene"]) = (json!(level), json!(scene));
                self.event("fault", fields);
            }
        }
    }

    /// Writes a line to stderr. A reader that went away is no error.
    fn line(&self, mut line: String) {
        line.push('\n');
        let _ = self.beside_bar(|| std::io::stderr().write_all(line.as_bytes()));
    }

    fn beside_bar<R>(&self, write: impl FnOnce() -> R) -> R {
        let bar = self.bar.lock().expect("no thread panics while it prints");
        match &*bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}

/// Escapes control characters in every text: JSON leaves some of them as they are.
pub(crate) fn escape(line: &mut Value) {
    for value in line.as_object_mut().into_iter().flat_map(|fields| fields.values_mut()) {
        if let Some(text) = value.as_str() {
            *value = json!(printable(text));
        }
    }
}

/// A fault as fields.
pub(crate) fn fault_json(fault: &Fault) -> Value {
    json!({
        "rule": fault.rule,
        "place": fault.place,
        "record": fault.record,
        "offset": fault.offset,
        "expected": fault.expected,
        "found": fault.found,
        "hint": fault.hint,
    })
}
