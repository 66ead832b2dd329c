//! Other people's servers, as `tests/outside/install` leaves them.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A server that ends when it is dropped, or when the tests end.
pub(crate) struct Server {
    process: Child,
    pub(crate) port: u16,
}

impl Server {
    /// Starts a script of `tests/outside`; none, with a printed reason, if what it needs is not installed.
    pub(crate) fn start(script: &str, args: &[&str]) -> Option<Self> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside");
        let python = folder.join("python/bin/python");
        let is_required = std::env::var("OCCLABEL_OUTSIDE").is_ok_and(|value| value == "required");
        if !python.exists() {
            assert!(!is_required, "there is no {}: tests/outside/install", python.display());
            println!("skipped: there is no server; tests/outside/install brings it");
            return None;
        }
        let mut command = Command::new(python);
        command.arg(folder.join(script)).args(args).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.stderr(Stdio::null()).spawn().expect("Python");
        let mut line = String::new();
        let output = process.stdout.take().expect("a pipe");
        BufReader::new(output).read_line(&mut line).expect("a line");
        let port = line.trim().parse().ok();
        assert!(port.is_some() || !is_required, "{script} does not start: tests/outside/install");
        match port {
            Some(port) => Some(Self { process, port }),
            None => {
                println!("skipped: {script} does not start; tests/outside/install brings it");
                let _ = process.wait();
                None
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
