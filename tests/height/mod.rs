//! `spheight`: heights against exact arithmetic on all triangles, and all other bytes of the files.

pub(crate) mod batches;
mod failures;
mod files;
mod heights;
mod text;

use laz::record::{RecordDecompressor, SequentialPointRecordDecompressor};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, StreamReader};

use crate::programs::{Folder, outcome, run};
use crate::sources::las_file::LasFile;

/// A LAS file that is taken apart by the offsets in the specification.
pub struct Parts {
    pub header: Vec<u8>,
    /// User, number and body of each record before the points.
    vlrs: Vec<(String, u16, Vec<u8>)>,
    pub record_len: usize,
    records: Vec<u8>,
    /// All that follows the points.
    pub tail: Vec<u8>,
}

impl Parts {
    pub fn of(file: &[u8]) -> Parts {
        let (header_len, start) = (u16_at(file, 94).into(), u32_at(file, 96) as usize);
        let record_len = usize::from(u16_at(file, 105));
        let count = match u32_at(file, 107) {
            0 if file[25] >= 4 => u64_at(file, 247) as usize,
            count => count as usize,
        };
        let mut vlrs = Vec::new();
        let mut at: usize = header_len;
        for _ in 0..u32_at(file, 100) {
            let end = at + 54 + usize::from(u16_at(file, at + 20));
            let user = String::from_utf8_lossy(&file[at + 2..at + 18]).trim_end_matches('\0').to_string();
            vlrs.push((user, u16_at(file, at + 18), file[at + 54..end].to_vec()));
            at = end;
        }
        let header = file[..header_len].to_vec();
        let (records, tail) = match header[104] & 0x80 {
            0 => {
                let end = start + count * record_len;
                (file[start..end].to_vec(), file[end..].to_vec())
            }
            _ => {
                let laszip =
                    vlrs.iter().find(|(user, ..)| user == "laszip encoded").expect("LAZ has its record");
                let vlr = laz::LazVlr::from_buffer(&laszip.2).expect("a laszip record");
                let mut source = std::io::Cursor::new(file);
                source.set_position(start as u64);
                let mut records = vec![0; count * record_len];
                if laszip.2[0] == 1 {
                    // Old files have all points in one piece.
                    let mut decompressor = SequentialPointRecordDecompressor::new(source);
                    decompressor.set_fields_from(vlr.items()).expect("items");
                    decompressor.decompress_many(&mut records).expect("points");
                } else {
                    let mut decompressor = laz::LasZipDecompressor::new(source, vlr).expect("a decompressor");
                    decompressor.decompress_many(&mut records).expect("points");
                }
                let evlrs = if file[25] >= 4 { u64_at(file, 235) as usize } else { 0 };
                (records, if evlrs > start { file[evlrs..].to_vec() } else { Vec::new() })
            }
        };
        Parts { header, vlrs, record_len, records, tail }
    }

    pub fn records(&self) -> std::slice::ChunksExact<'_, u8> {
        self.records.chunks_exact(self.record_len)
    }

    /// The integers at the end of each record.
    fn heights(&self) -> Vec<i32> {
        self.records().map(|record| i32::from_le_bytes(*record.last_chunk().unwrap())).collect()
    }

    fn points(&self) -> Vec<[i32; 3]> {
        self.records().map(|record| [0, 4, 8].map(|at| u32_at(record, at) as i32)).collect()
    }

    /// Records before the points without those that must change.
    pub fn kept(&self) -> Vec<&(String, u16, Vec<u8>)> {
        let changes = |user: &str, number: u16| {
            user == "laszip encoded" || user == "copc" || (user, number) == ("LASF_Spec", 4)
        };
        self.vlrs.iter().filter(|(user, number, _)| !changes(user, *number)).collect()
    }
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

/// The mesh stream of a file of points.
fn mesh_of(file: &[u8]) -> Vec<u8> {
    let points = run("spfinalize", &["-q", "-"], file);
    let mesh = run("spdelaunay2d", &["-q"], &points.stdout);
    assert!(mesh.status.success(), "{:?} {:?}", outcome(&points), outcome(&mesh));
    mesh.stdout
}

/// The triangles of a mesh stream, in stored coordinates.
pub fn triangles_of(mesh: &[u8]) -> Vec<[Point; 3]> {
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Patch(patch) = event {
            vertices.extend_from_slice(&patch.new);
            let corner = |local: u32| vertices[patch.id(local) as usize];
            triangles.extend(patch.triangles().map(|triangle| triangle.map(corner)));
        }
    }
    triangles
}

/// Runs the program on a mesh and a file, both in files, and returns the output called `output`.
fn heights_in(folder: &Folder, mesh: &[u8], file: &[u8], output: &str, flags: &[&str]) -> Vec<u8> {
    folder.file("ground.spm", mesh);
    folder.file("points.las", file);
    let (ground, points, path) = (folder.path("ground.spm"), folder.path("points.las"), folder.path(output));
    let arguments = [&["--ground", &ground, &points, "-o", &path], flags].concat();
    let found = run("spheight", &arguments, &[]);
    assert!(found.status.success(), "{arguments:?}: {:?}", outcome(&found));
    std::fs::read(path).unwrap()
}

/// A file of random points in a square of `size` steps.
fn scattered(count: usize, size: u64, seed: u64) -> LasFile {
    let mut random = spmesh_base::random::Random::new(seed);
    let mut axis = |size| random.below(size) as i32;
    let positions: Vec<[i32; 3]> = (0..count).map(|_| [axis(size), axis(size), axis(1000)]).collect();
    LasFile::of(&positions)
}
