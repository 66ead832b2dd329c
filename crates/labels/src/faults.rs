//! Operations on files that fail on purpose: a test of what the program promises when they do.
//!
//! `OCCLABEL_FAULT=17:enospc` has the 17th operation of the process fail so, counted from 0. There are
//! `enospc`, `eio`, `eacces`; `short`, which writes a half first; and `kill`, which ends the process
//! there and then.

use std::io::{self, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Which operation fails, and how.
struct Plan {
    at: u64,
    how: How,
}

#[derive(Clone, Copy)]
enum How {
    /// With this number of errno(3).
    Error(i32),
    Short,
    Kill,
}

/// See errno(3).
const EIO: i32 = 5;
const EACCES: i32 = 13;
const ENOSPC: i32 = 28;

/// Fails if it is this operation's turn.
pub(crate) fn before(operation: &str) -> io::Result<()> {
    match turn(operation) {
        None => Ok(()),
        Some(How::Error(number)) => Err(io::Error::from_raw_os_error(number)),
        Some(How::Short) => Err(io::Error::from_raw_os_error(EIO)),
        Some(How::Kill) => std::process::abort(),
    }
}

/// The same before something is written: of which a half may be.
pub(crate) fn shorten(file: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    match turn("write") {
        None => Ok(()),
        Some(How::Error(number)) => Err(io::Error::from_raw_os_error(number)),
        Some(how) => {
            file.write_all(&bytes[..bytes.len() / 2])?;
            match how {
                How::Kill => std::process::abort(),
                _ => Err(io::Error::from_raw_os_error(ENOSPC)),
            }
        }
    }
}

fn turn(operation: &str) -> Option<How> {
    static PLAN: OnceLock<Option<Plan>> = OnceLock::new();
    static DONE: AtomicU64 = AtomicU64::new(0);
    let plan = PLAN.get_or_init(|| parse(&std::env::var("OCCLABEL_FAULT").ok()?)).as_ref()?;
    if DONE.fetch_add(1, Ordering::SeqCst) != plan.at {
        return None;
    }
    eprintln!("on purpose: `{operation}` fails");
    Some(plan.how)
}

fn parse(text: &str) -> Option<Plan> {
    let (at, how) = text.split_once(':')?;
    let how = match how {
        "enospc" => How::Error(ENOSPC),
        "eio" => How::Error(EIO),
        "eacces" => How::Error(EACCES),
        "short" => How::Short,
        "kill" => How::Kill,
        _ => return None,
    };
    Some(Plan { at: at.parse().ok()?, how })
}
