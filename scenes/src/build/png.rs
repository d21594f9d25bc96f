//! A PNG writer that stores pixels uncompressed: its bytes can never depend on a compressor's version.

/// An image of 8-bit RGBA texels, row-major from the top.
#[derive(Debug, Clone)]
pub struct Pixels {
    /// Texels across.
    pub width: u32,
    /// Colour (sRGB) and alpha (linear) of each texel.
    pub rgba: Vec<[u8; 4]>,
}

impl Pixels {
    /// The image as a PNG file. At most 65535 bytes of rows, so that one stored block holds them.
    pub fn png(&self) -> Vec<u8> {
        let height = self.rgba.len() as u32 / self.width;
        let mut header = [self.width.to_be_bytes(), height.to_be_bytes()].concat();
        header.extend([8, 6, 0, 0, 0]);
        let rows = self.rgba.chunks(self.width as usize);
        let data: Vec<u8> = rows.flat_map(|row| std::iter::once(0).chain(row.iter().flatten().copied())).collect();
        let length = u16::try_from(data.len()).expect("small image");
        let mut zlib = vec![0x78, 0x01, 1];
        zlib.extend(length.to_le_bytes());
        zlib.extend((!length).to_le_bytes());
        zlib.extend(&data);
        zlib.extend(adler32(&data).to_be_bytes());
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        for (kind, content) in [(b"IHDR", header), (b"IDAT", zlib), (b"IEND", vec![])] {
            file.extend((content.len() as u32).to_be_bytes());
            let checked = [kind.as_slice(), &content].concat();
            file.extend(&checked);
            file.extend(crc32(&checked).to_be_bytes());
        }
        file
    }
}

/// Checksum of a zlib stream (RFC 1950).
fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}

/// Checksum of a PNG chunk (PNG specification, annex D), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| bit(crc)))
}
