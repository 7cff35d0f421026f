//! Code shared by all peers in Rust: points in, triangles out. `native/points.hpp` does the same for C++.

pub mod random;

use std::fs::File;
use std::io::{BufWriter, Error, Read, Result, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::time::Instant;

const BUFFER_BYTES: usize = 1 << 20;

/// The files for a run of a peer.
pub struct Paths {
    /// The input.
    pub points: PathBuf,
    /// The output.
    pub triangles: PathBuf,
}

impl Paths {
    /// From the command line: PEER POINTS TRIANGLES.
    pub fn of_arguments() -> Result<Paths> {
        let mut words = std::env::args_os().skip(1).map(PathBuf::from);
        match (words.next(), words.next(), words.next()) {
            (Some(points), Some(triangles), None) => Ok(Paths { points, triangles }),
            _ => Err(Error::other("usage: PEER POINTS TRIANGLES")),
        }
    }

    /// Reads coordinates: the stored integers of an uncompressed LAS file, or pairs of little-endian f64.
    pub fn read_points(&self) -> Result<Vec<[f64; 2]>> {
        let mut file = File::open(&self.points)?;
        if self.points.extension().is_some_and(|ending| ending == "las") {
            return read_las(&mut file);
        }
        read_tuples(&mut file)
    }

    /// Writes three indices per triangle, and reports the counts and the seconds on stdout.
    pub fn write_triangles<Index: TryInto<u32>>(
        &self,
        points: usize,
        triangles: impl Iterator<Item = [Index; 3]>,
        seconds: f64,
    ) -> Result<()> {
        let mut file = BufWriter::with_capacity(BUFFER_BYTES, File::create(&self.triangles)?);
        let mut count = 0u64;
        for triangle in triangles {
            for index in triangle {
                let index = index.try_into().map_err(|_| Error::other("an index beyond 32 bits"))?;
                file.write_all(&index.to_le_bytes())?;
            }
            count += 1;
        }
        file.flush()?;
        println!("{{\"points\": {points}, \"triangles\": {count}, \"seconds\": {seconds:.6}}}");
        Ok(())
    }
}

/// Runs `work` and measures its time.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

/// The needed fields of a LAS header.
pub struct LasHeader {
    /// The whole header.
    pub bytes: Vec<u8>,
    /// Bytes of a point record.
    pub record_len: usize,
    /// Number of points.
    pub points: usize,
}

impl LasHeader {
    /// Reads everything before the points, and leaves the file position there.
    pub fn read(file: &mut File) -> Result<LasHeader> {
        let mut start = [0; 227];
        file.read_exact(&mut start)?;
        if &start[..4] != b"LASF" {
            return Err(Error::other("no LAS file"));
        }
        let number =
            |at: usize| u32::from_le_bytes(start[at..at + 4].try_into().expect("four bytes")) as usize;
        let mut bytes = vec![0; number(96)];
        file.seek(SeekFrom::Start(0))?;
        file.read_exact(&mut bytes)?;
        let record_len = usize::from(u16::from_le_bytes([start[105], start[106]]));
        Ok(LasHeader { bytes, record_len, points: number(107) })
    }
}

fn read_las(file: &mut File) -> Result<Vec<[f64; 2]>> {
    let header = LasHeader::read(file)?;
    let number = |bytes: &[u8]| f64::from(i32::from_le_bytes(bytes.try_into().expect("four bytes")));
    read_records(file, header.points, header.record_len, |record| {
        [number(&record[..4]), number(&record[4..8])]
    })
}

/// Tuples of little-endian f64 to the end of the file.
pub fn read_tuples<const DIMS: usize>(file: &mut File) -> Result<Vec<[f64; DIMS]>> {
    let count = file.metadata()?.len() as usize / (8 * DIMS);
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    read_records(file, count, 8 * DIMS, |record| {
        std::array::from_fn(|axis| number(&record[8 * axis..8 * axis + 8]))
    })
}

fn read_records<const DIMS: usize>(
    file: &mut File,
    count: usize,
    record_len: usize,
    point: impl Fn(&[u8]) -> [f64; DIMS],
) -> Result<Vec<[f64; DIMS]>> {
    let mut points = Vec::with_capacity(count);
    let mut block = vec![0; BUFFER_BYTES / record_len * record_len];
    while points.len() < count {
        let bytes = block.len().min((count - points.len()) * record_len);
        file.read_exact(&mut block[..bytes])?;
        points.extend(block[..bytes].chunks_exact(record_len).map(&point));
    }
    Ok(points)
}
