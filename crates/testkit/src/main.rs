//! `make-log`: writes a simulated drive in the nuScenes format.

use occlabel_testkit::{LogSpec, write_log};
use std::path::PathBuf;
use std::process::ExitCode;

const USAGE: &str = "\
usage: make-log nano|full|tables --output DIR [options]

  nano      3 keyframes, a few hundred kilobytes (the fixture in tests/fixtures/nano)
  full      40 keyframes, 400 sweeps of some 33,000 points, 270 MB
  tables    tables as large as nuScenes' trainval; 870 MB; scene-0426 has its points

  --scenes N        number of scenes (nano, full: each with points)
  --keyframes N     keyframes per scene
  --sweeps N        sweeps per keyframe
  --annotations N   annotations in all
  --no-cameras  --no-labels  --no-boxes";

fn main() -> ExitCode {
    match parse(std::env::args().skip(1)) {
        Ok((output, spec)) => write(output, &spec),
        Err(message) => {
            eprintln!("make-log: {message}\n\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn write(output: PathBuf, spec: &LogSpec) -> ExitCode {
    match write_log(&output, spec) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("make-log: {}: {error}", output.display());
            ExitCode::FAILURE
        }
    }
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<(PathBuf, LogSpec), String> {
    let mut spec = preset(&arguments.next().ok_or("what log?")?)?;
    let mut output = None;
    while let Some(flag) = arguments.next() {
        if !switch_off(&mut spec, &flag) {
            let value = arguments.next().ok_or_else(|| format!("{flag}: unknown, or no value"))?;
            match flag.as_str() {
                "--output" => output = Some(PathBuf::from(value)),
                _ => set_count(&mut spec, &flag, &value)?,
            }
        }
    }
    Ok((output.ok_or("--output is missing")?, spec))
}

fn preset(name: &str) -> Result<LogSpec, String> {
    match name {
        "nano" => Ok(LogSpec::nano()),
        "full" => Ok(LogSpec::full()),
        "tables" => Ok(LogSpec::tables()),
        _ => Err(format!("{name}: no such log")),
    }
}

fn switch_off(spec: &mut LogSpec, flag: &str) -> bool {
    match flag {
        "--no-cameras" => spec.cameras = false,
        "--no-labels" => spec.labels = false,
        "--no-boxes" => spec.boxes = false,
        _ => return false,
    }
    true
}

fn set_count(spec: &mut LogSpec, flag: &str, value: &str) -> Result<(), String> {
    let count: usize = value.parse().map_err(|error| format!("{flag} {value}: {error}"))?;
    if count == 0 {
        return Err(format!("{flag} {value}: must be 1 or more"));
    }
    match flag {
        "--scenes" => *spec = spec.clone().with_scenes(count),
        "--keyframes" => spec.keyframes = count,
        "--sweeps" => spec.sweeps_per_keyframe = count,
        "--annotations" => spec.annotations = Some(count),
        _ => return Err(format!("{flag}: unknown")),
    }
    Ok(())
}
