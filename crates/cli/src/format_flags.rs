//! Flags that only one format reads.

use clap::ValueEnum;
use occlabel_core::Fault;

use crate::args::{ConfigArgs, Format, LogArgs};

/// Refuses a flag that the log's format would not use.
pub(crate) fn check_flags(log: &LogArgs, config: &ConfigArgs) -> Result<(), Fault> {
    let flags = [
        ("--version", log.version.is_some(), Format::Nuscenes),
        ("--quat-order", log.quat_order.is_some(), Format::Nuscenes),
        ("--columns", log.columns.is_some(), Format::Nuscenes),
        ("--time-source", log.time_source.is_some(), Format::Mcap),
        ("--recover", log.recover, Format::Mcap),
        ("--set reader.mcap", config.sets_reader("mcap"), Format::Mcap),
        ("--set reader.cloud", config.sets_reader("cloud"), Format::Cloud),
    ];
    let is_unused = |(_, is_given, format): &(_, bool, Format)| *is_given && *format != log.format;
    match flags.into_iter().find(is_unused) {
        None => Ok(()),
        Some((flag, _, format)) => {
            let expected = format!("`--format {}`, which alone reads it", name(format));
            Err(Fault::new("unused-flag", flag, expected, format!("`{}`", name(log.format))))
        }
    }
}

impl ConfigArgs {
    /// Whether a setting `table.key=VALUE` is one of `[reader.FORMAT]`.
    fn sets_reader(&self, format: &str) -> bool {
        let path = |setting: &str| setting.split('=').next().unwrap_or_default().to_owned();
        let mut paths = self.settings.iter().map(|setting| path(setting));
        paths.any(|path| path.split('.').map(str::trim).take(2).eq(["reader", format]))
    }
}

/// A format as it is written on the command line.
pub(crate) fn name(format: Format) -> String {
    let value = format.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}
