//! Reading a file that a medium names.

use std::io::{Error, ErrorKind};
use std::path::Path;

/// Reads a regular file of at most `most` bytes; pipes and devices, which may never end, are refused.
pub fn read(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let data = std::fs::metadata(path)?;
    if !data.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "not a regular file"));
    }
    if data.len() > most {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("{} bytes, more than {most}", data.len())));
    }
    std::fs::read(path)
}
