//! GLB framing: finds the JSON and the binary chunk. Everything else is taken as plain JSON.

use super::error::Fault;
use std::ops::Range;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// Where the parts of a file lie.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parts {
    /// The JSON text.
    pub json: Range<usize>,
    /// The binary chunk of a GLB.
    pub bin: Option<Range<usize>>,
}

/// Splits a .glb; a file that does not begin with the GLB magic is taken to be JSON.
pub(super) fn split(bytes: &[u8]) -> Result<Parts, Fault> {
    let refuse = |why: String| Err(Fault::Container(why));
    if !bytes.starts_with(MAGIC) {
        return match bytes.iter().find(|b| !b.is_ascii_whitespace()) {
            Some(b'{') => Ok(Parts { json: 0..bytes.len(), bin: None }),
            Some(0xEF) => refuse("it starts with a byte order mark, which glTF forbids".into()),
            Some(_) => refuse("it starts neither with `glTF` nor with `{`".into()),
            None => refuse("it is empty".into()),
        };
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return refuse(format!("a GLB header takes 12 bytes, the file has {}", bytes.len()));
    };
    if version != 2 {
        return refuse(format!("GLB version {version}, allowed is 2"));
    }
    if length as usize != bytes.len() {
        return refuse(format!("the GLB header says {length} bytes, the file has {}", bytes.len()));
    }
    let (kind, json) = chunk(bytes, 12)?;
    if kind != JSON {
        return refuse(format!("the first GLB chunk is of type {kind:#010x}, allowed is JSON ({JSON:#010x})"));
    }
    let bin = match next_chunk(&json) {
        at if at >= bytes.len() => None,
        at => Some(chunk(bytes, at)?).filter(|(kind, _)| *kind == BIN).map(|(_, range)| range),
    };
    check_rest(bytes, next_chunk(bin.as_ref().unwrap_or(&json)))?;
    Ok(Parts { json, bin })
}

/// Chunks after the known ones may be anything but JSON or BIN, and must be whole.
fn check_rest(bytes: &[u8], mut at: usize) -> Result<(), Fault> {
    while at < bytes.len() {
        let (kind, range) = chunk(bytes, at)?;
        if kind == JSON || kind == BIN {
            return Err(Fault::Container(format!("a JSON or BIN chunk out of place at byte {at}")));
        }
        at = next_chunk(&range);
    }
    Ok(())
}

fn next_chunk(range: &Range<usize>) -> usize {
    range.end.next_multiple_of(4)
}

/// Type and content of the chunk whose header lies at `at`.
fn chunk(bytes: &[u8], at: usize) -> Result<(u32, Range<usize>), Fault> {
    let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Err(Fault::Container(format!("the chunk header at byte {at} is cut short")));
    };
    let start = at + 8;
    let end = start + length as usize;
    if end > bytes.len() {
        let left = bytes.len() - start;
        return Err(Fault::Container(format!("the chunk at byte {at} says {length} bytes, {left} are left")));
    }
    Ok((kind, start..end))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, content) in chunks {
            out.extend((content.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend(*content);
        }
        let length = out.len() as u32;
        out[8..12].copy_from_slice(&length.to_le_bytes());
        out
    }

    fn refusal(bytes: &[u8]) -> String {
        split(bytes).expect_err("must be refused").to_string()
    }

    #[test]
    fn finds_json_and_bin() {
        let parts = split(&glb(&[(JSON, b"{}  "), (BIN, b"abcd")])).expect("a sound file");
        assert_eq!(parts, Parts { json: 20..24, bin: Some(32..36) });
        assert_eq!(split(b" {}").expect("plain JSON").bin, None);
    }

    #[test]
    fn unknown_chunks_are_skipped() {
        assert!(split(&glb(&[(JSON, b"{}  "), (BIN, b"abcd"), (7, b"wxyz")])).is_ok());
        assert_eq!(split(&glb(&[(JSON, b"{}  "), (7, b"wxyz")])).expect("sound").bin, None);
    }

    #[test]
    fn damaged_framing_is_refused_with_the_numbers() {
        assert!(refusal(b"").contains("empty"));
        assert!(refusal(b"PK").contains("neither"));
        assert!(refusal(b"glTF\x02\0\0\0").contains("12 bytes"));
        let mut old = glb(&[(JSON, b"{}  ")]);
        old[4] = 1;
        assert!(refusal(&old).contains("version 1"));
        let mut long = glb(&[(JSON, b"{}  ")]);
        long[12] = 200;
        assert!(refusal(&long).contains("200 bytes, 4 are left"));
        let mut cut = glb(&[(JSON, b"{}  ")]);
        cut.truncate(22);
        assert!(refusal(&cut).contains("header says 24 bytes, the file has 22"));
        assert!(refusal(&glb(&[(BIN, b"abcd")])).contains("first GLB chunk"));
        assert!(refusal(&glb(&[(JSON, b"{}  "), (BIN, b"abcd"), (BIN, b"abcd")])).contains("out of place"));
    }
}
