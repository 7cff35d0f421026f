//! How many points of a LAZ file that was cut off are in whole chunks.

use laz::DecompressionSelection;

use crate::las::header::{LasHeader, Laszip};
use crate::las::laz::Streamed;
use crate::las::laz_chunks::{Chunk, Chunks};
use crate::las::laz_codec::Codec;
use crate::source::origin::FileView;
use spmesh_base::error::{ErrorKind, Result};

/// The number of points in the chunks before the first one that is not whole. Cost: decompresses these chunks,
/// unless the chunk table is there: then nothing is missing.
pub(crate) fn whole_points(file: &FileView, header: &LasHeader, laszip: &Laszip) -> Result<u64> {
    let codec = Codec::new(laszip.vlr.clone(), header, DecompressionSelection::all())?;
    let Chunks::Unknown { start, points_per_chunk } = Chunks::find(file, header, laszip)? else {
        return Ok(header.points);
    };
    let len = header.points_end.saturating_sub(start);
    let chunk = Chunk { start, len, points: header.points, first: 0, within: None };
    let per_chunk = laszip.is_chunked.then_some(points_per_chunk);
    let mut records = Vec::new();
    let (mut whole, mut done) = (0, 0);
    let mut read = || -> Result<()> {
        let mut streamed = Streamed::new(file, &codec, &chunk, per_chunk)?;
        loop {
            let count = streamed.next_records(file, &codec, &mut records)?;
            if count == 0 {
                return Ok(());
            }
            done += count;
            if streamed.is_between_chunks() {
                whole = done;
            }
        }
    };
    match read() {
        // The cut.
        Err(error) if error.kind() != ErrorKind::Malformed => Err(error),
        _ => Ok(whole),
    }
}
