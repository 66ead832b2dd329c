//! Operations on files that fail on purpose: a test of what the program promises when they do.
//!
//! `OCCLABEL_FAULT=17:enospc` has the 17th operation of the process that can fail so do it, counted from
//! 0. There are `enospc`, of operations that take room; `eio`, of any; `eacces`, of those that name a
//! path; `short`, which writes a half before there is no room, or reads a half, which is no error;
//! and `kill`, which ends the process before it changes anything, or has half written it.

use std::io::{self, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::Operation;

/// Which operation fails, and how.
struct Plan {
    at: u64,
    how: How,
}

#[derive(Clone, Copy)]
enum How {
    NoSpace,
    Io,
    Access,
    Short,
    Kill,
}

/// See errno(3).
const EIO: i32 = 5;
const EACCES: i32 = 13;
const ENOSPC: i32 = 28;

/// Fails if it is this operation's turn.
pub(crate) fn before(operation: Operation) -> io::Result<()> {
    turn(operation).map_or(Ok(()), |how| Err(how.error()))
}

/// The same before something is read into `bytes`: gives those that may be filled.
pub(crate) fn before_read(bytes: &mut [u8]) -> io::Result<&mut [u8]> {
    match turn(Operation::Read) {
        None => Ok(bytes),
        Some(How::Short) => {
            let half = bytes.len().div_ceil(2);
            Ok(&mut bytes[..half])
        }
        Some(how) => Err(how.error()),
    }
}

/// The same before something is written: of which a half may be.
pub(crate) fn before_write(file: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let Some(how) = turn(Operation::Write) else { return Ok(()) };
    if matches!(how, How::Short | How::Kill) {
        file.write_all(&bytes[..bytes.len() / 2])?;
    }
    Err(how.error())
}

impl How {
    /// Whether an operation can fail so.
    fn befalls(self, operation: Operation) -> bool {
        use Operation::{Create, CreateFolder, List, Look, Open, Read, Rename, Sync, Write};
        match self {
            Self::NoSpace => matches!(operation, Create | Write | Sync | Rename | CreateFolder),
            Self::Io => true,
            Self::Access => !matches!(operation, Read | Write | Sync),
            Self::Short => matches!(operation, Read | Write),
            Self::Kill => !matches!(operation, Open | Look | List | Read),
        }
    }

    /// What the system says of it, if the process lives to hear it.
    fn error(self) -> io::Error {
        io::Error::from_raw_os_error(match self {
            Self::NoSpace | Self::Short => ENOSPC,
            Self::Io => EIO,
            Self::Access => EACCES,
            Self::Kill => std::process::abort(),
        })
    }
}

fn turn(operation: Operation) -> Option<How> {
    static PLAN: OnceLock<Option<Plan>> = OnceLock::new();
    static DONE: AtomicU64 = AtomicU64::new(0);
    let plan = PLAN.get_or_init(|| parse(&std::env::var("OCCLABEL_FAULT").ok()?)).as_ref()?;
    if !plan.how.befalls(operation) || DONE.fetch_add(1, Ordering::SeqCst) != plan.at {
        return None;
    }
    eprintln!("on purpose: {operation:?} fails");
    Some(plan.how)
}

fn parse(text: &str) -> Option<Plan> {
    let (at, how) = text.split_once(':')?;
    let how = match how {
        "enospc" => How::NoSpace,
        "eio" => How::Io,
        "eacces" => How::Access,
        "short" => How::Short,
        "kill" => How::Kill,
        _ => return None,
    };
    Some(Plan { at: at.parse().ok()?, how })
}
