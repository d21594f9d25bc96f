//! A place in a file's bytes; what lies beyond the end is a damaged file.

use super::FORMAT;
use crate::air::grid::GridFault;

/// Bytes and a position.
#[derive(Debug, Clone, Copy)]
pub struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    /// At the beginning.
    pub fn new(all: &'a [u8]) -> Self {
        Self { all, at: 0 }
    }

    /// The same bytes at another position.
    pub fn at(&self, position: u64) -> Result<Self, GridFault> {
        match usize::try_from(position) {
            Ok(at) if at <= self.all.len() => Ok(Self { all: self.all, at }),
            _ => Err(GridFault::damaged(FORMAT, format!("it refers to byte {position} of {}", self.all.len()))),
        }
    }

    /// Where the next byte lies.
    pub fn position(&self) -> u64 {
        self.at as u64
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], GridFault> {
        let rest = &self.all[self.at..];
        let taken = rest.get(..count).ok_or_else(|| {
            GridFault::damaged(FORMAT, format!("it ends at byte {}, within its data", self.all.len()))
        })?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], GridFault> {
        Ok(self.take(N)?.try_into().expect("as many as asked for"))
    }

    pub fn u8(&mut self) -> Result<u8, GridFault> {
        self.array().map(|[byte]| byte)
    }

    pub fn u32(&mut self) -> Result<u32, GridFault> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, GridFault> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, GridFault> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, GridFault> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, GridFault> {
        self.array().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, GridFault> {
        self.array().map(f64::from_le_bytes)
    }

    /// A length and as many bytes of text.
    pub fn text(&mut self) -> Result<String, GridFault> {
        let length = self.u32()?;
        Ok(String::from_utf8_lossy(self.take(length as usize)?).into_owned())
    }
}
