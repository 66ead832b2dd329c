//! Messages on stderr: text or JSON lines. Results go to stdout.

use std::io::{ErrorKind, Write};
use std::sync::Mutex;

use occlabel_core::{Fault, printable};
use serde_json::json;

use crate::args::LogFormat;

/// Where messages go, and how.
#[derive(Debug)]
pub(crate) struct Console {
    pub(crate) format: LogFormat,
    pub(crate) quiet: bool,
    /// What kept a result from being written, if anything did.
    refused: Mutex<Option<Fault>>,
}

impl Console {
    pub(crate) fn new(format: LogFormat, quiet: bool) -> Self {
        Self { format, quiet, refused: Mutex::default() }
    }

    /// What the user must know.
    pub(crate) fn error(&self, fault: &Fault) {
        self.write("error", fault);
    }

    /// What the user may want to know.
    pub(crate) fn warning(&self, scene: &str, fault: &Fault) {
        if !self.quiet {
            self.write_of("warning", Some(scene), fault);
        }
    }

    /// What is going on.
    pub(crate) fn info(&self, message: &str) {
        if !self.quiet {
            self.line(&match self.format {
                LogFormat::Text => printable(message),
                LogFormat::Json => {
                    json!({ "level": "info", "message": printable(message) }).to_string()
                }
            });
        }
    }

    /// A line of the result.
    pub(crate) fn result(&self, line: &str) {
        self.results(format!("{line}\n").as_bytes());
    }

    /// Bytes of the result. A reader that went away is no error; a full disk is, and is kept.
    pub(crate) fn results(&self, bytes: &[u8]) {
        let mut stdout = std::io::stdout();
        match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
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

    fn write(&self, level: &str, fault: &Fault) {
        self.write_of(level, None, fault);
    }

    fn write_of(&self, level: &str, scene: Option<&str>, fault: &Fault) {
        self.line(&match (self.format, scene) {
            (LogFormat::Text, Some(scene)) => format!("{level}: {}: {fault}", printable(scene)),
            (LogFormat::Text, None) => format!("{level}: {fault}"),
            (LogFormat::Json, scene) => fault_line(level, scene, fault),
        });
    }

    fn line(&self, line: &str) {
        let _ = writeln!(std::io::stderr(), "{line}");
    }
}

fn fault_line(level: &str, scene: Option<&str>, fault: &Fault) -> String {
    let mut line = fault_json(fault);
    escape(&mut line);
    line["level"] = json!(level);
    if let Some(scene) = scene {
        line["scene"] = json!(printable(scene));
    }
    line.to_string()
}

/// Escapes control characters in every text: JSON leaves some of them as they are.
pub(crate) fn escape(line: &mut serde_json::Value) {
    for value in line.as_object_mut().into_iter().flat_map(|fields| fields.values_mut()) {
        if let Some(text) = value.as_str() {
            *value = json!(printable(text));
        }
    }
}

/// A fault as fields.
pub(crate) fn fault_json(fault: &Fault) -> serde_json::Value {
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
