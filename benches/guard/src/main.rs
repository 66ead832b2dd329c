//! Counts the instructions of each stage on a small fixed drive, under valgrind's callgrind, and
//! holds them to `expected.json`: a stage may cost 2 % more, no further.
//!
//! ```text
//! benches/guard/run          count, and fail where a stage costs more than it may
//! benches/guard/run --pin    count, and write what was counted to expected.json
//! ```
//!
//! Instructions, unlike seconds, are the same on a busy machine. They are those of one compiler and
//! of a processor with AVX2 (callgrind has no AVX-512): with others there is nothing to compare, and
//! the guard says so and passes.

mod callgrind;
mod drive;
mod expected;
mod prepared;
mod stages;
mod street;
mod watched;

use std::process::ExitCode;

use rayon::ThreadPoolBuilder;

use crate::expected::{Counts, Verdict};
use crate::stages::STAGES;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => judge(),
        ["--pin"] => pin(),
        ["stage", name] => stage(name),
        _ => {
            eprintln!("usage: occlabel-guard [--pin]");
            ExitCode::from(2)
        }
    }
}

/// Runs one stage, as callgrind watches: on one thread, for others would not be counted.
fn stage(name: &str) -> ExitCode {
    let Some(stage) = STAGES.iter().find(|stage| stage.name == name) else {
        return ExitCode::from(2);
    };
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(stage.run);
    ExitCode::SUCCESS
}

fn pin() -> ExitCode {
    match count().and_then(|counted| counted.write()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => skipped(&reason),
    }
}

fn judge() -> ExitCode {
    let (expected, counted) = match Counts::read().and_then(|expected| {
        expected.fits_here()?;
        Ok((expected, count()?))
    }) {
        Ok(both) => both,
        Err(reason) => return skipped(&reason),
    };
    let verdicts = expected.judge(&counted);
    verdicts.iter().for_each(|verdict| println!("{verdict}"));
    ExitCode::from(u8::from(verdicts.iter().any(Verdict::is_too_much)))
}

fn count() -> Result<Counts, String> {
    let instructions = STAGES
        .iter()
        .map(|stage| Ok((stage.name.to_owned(), callgrind::instructions(stage)?)))
        .collect::<Result<_, String>>()?;
    Counts::here(instructions)
}

fn skipped(reason: &str) -> ExitCode {
    println!("instruction counts not judged: {reason}");
    ExitCode::SUCCESS
}
