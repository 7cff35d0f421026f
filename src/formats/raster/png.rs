//! Pictures of a few colours as PNG. Source: Portable Network Graphics (PNG) Specification, third edition,
//! sections 5, 9 and 11.

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

use crate::raster::colour_map::Colour;
use spmesh_base::error::{Error, Result};
use spmesh_base::system::expect_deflate_memory;

/// First bytes of each file.
const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
/// Eight bits of a palette, and the only methods of compression, filters and order.
const INDEXED: [u8; 5] = [8, 3, 0, 0, 0];

/// A picture, row by row from the top, whose pixels are numbers of colours. The first colour is transparent.
///
/// Domain: at most 256 colours, of which all pixels are one; at least one pixel.
///
/// # Errors
/// If there is no memory to compress it.
pub fn png(width: u32, pixels: &[u8], colours: &[Colour]) -> Result<Vec<u8>> {
    let rows = pixels.chunks_exact(width as usize);
    let height = rows.len() as u32;
    expect_deflate_memory();
    let failed = |e| Error::io("compressing a picture", e);
    let mut data = ZlibEncoder::new(Vec::new(), Compression::default());
    for row in rows {
        // Rows of numbers that are no quantities have no filter.
        data.write_all(&[0]).and_then(|()| data.write_all(row)).map_err(failed)?;
    }
    let data = data.finish().map_err(failed)?;
    let head = [&width.to_be_bytes()[..], &height.to_be_bytes(), &INDEXED].concat();
    let mut bytes = MAGIC.to_vec();
    for (name, body) in [
        (b"IHDR", &head[..]),
        (b"PLTE", colours.as_flattened()),
        (b"tRNS", &[0]),
        (b"IDAT", &data),
        (b"IEND", &[]),
    ] {
        let mut sum = Crc::new();
        sum.update(name);
        sum.update(body);
        bytes.extend((body.len() as u32).to_be_bytes());
        bytes.extend(name);
        bytes.extend(body);
        bytes.extend(sum.sum().to_be_bytes());
    }
    Ok(bytes)
}
