//! Nothing fails on purpose.

use std::io::{self, Write};

use crate::Operation;

pub(crate) fn before(_operation: Operation) -> io::Result<()> {
    Ok(())
}

pub(crate) fn before_read(bytes: &mut [u8]) -> io::Result<&mut [u8]> {
    Ok(bytes)
}

pub(crate) fn before_write(_file: &mut impl Write, _bytes: &[u8]) -> io::Result<()> {
    Ok(())
}
