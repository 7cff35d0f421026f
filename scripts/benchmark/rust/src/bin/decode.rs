//! Decodes a LAZ file once with the `laz` crate and drops the records, on THREADS threads: `decode FILE
//! THREADS`.

use std::fs::File;
use std::io::{Error, Result};

use laz::{LazVlr, ParLasZipDecompressor};
use spmesh_bench::{LasHeader, timed};

/// Points that each thread decodes in one batch.
const POINTS_PER_THREAD: usize = 4 * 50_000;
const HEADER_LEN_AT: usize = 94;
const VLR_HEADER_LEN: usize = 54;

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [path, threads] = &words[..] else { return Err(Error::other("usage: decode FILE THREADS")) };
    let threads: usize = threads.parse().map_err(Error::other)?;
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(Error::other)?;
    let (points, seconds) = timed(|| decode(path, threads));
    println!("{{\"points\": {}, \"seconds\": {seconds:.6}}}", points?);
    Ok(())
}

fn decode(path: &str, threads: usize) -> Result<usize> {
    let mut file = File::open(path)?;
    let header = LasHeader::read(&mut file)?;
    let vlr = LazVlr::from_buffer(laszip_record(&header.bytes)?).map_err(Error::other)?;
    let mut decompressor = ParLasZipDecompressor::new(file, vlr).map_err(Error::other)?;
    let mut records = vec![0; threads * POINTS_PER_THREAD * header.record_len];
    let mut left = header.points * header.record_len;
    while left > 0 {
        let bytes = left.min(records.len());
        decompressor.decompress_many(&mut records[..bytes]).map_err(Error::other)?;
        left -= bytes;
    }
    Ok(header.points)
}

/// The record after the header that describes how points are compressed.
fn laszip_record(bytes: &[u8]) -> Result<&[u8]> {
    let short = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let mut at = short(HEADER_LEN_AT);
    while at + VLR_HEADER_LEN <= bytes.len() {
        let data = at + VLR_HEADER_LEN..at + VLR_HEADER_LEN + short(at + 20);
        if bytes[at + 2..].starts_with(b"laszip encoded") {
            return bytes.get(data).ok_or_else(|| Error::other("the laszip record ends too early"));
        }
        at = data.end;
    }
    Err(Error::other("no laszip record: not compressed"))
}
