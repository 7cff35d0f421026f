//! The triangles of a level, by tiles.

use std::path::Path;

use foldhash::{HashMap, HashMapExt};

use super::clip::Knife;
use super::scheme::{Place, STEPS, Scheme, Tile};
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;

/// Steps of heights in a metre.
pub(super) const HEIGHT_STEPS: f64 = 1024.0;

/// Bytes that wait in memory.
const PENDING_MAX: usize = 1 << 25;
const RECORD_LEN: usize = 24;

/// A corner in a tile: steps to the east and to the north, and height in its steps.
pub(super) type Corner = [i32; 3];
pub(super) type Triangle = [Corner; 3];

/// What is in a tile.
#[derive(Debug, Default)]
struct Bucket {
    pending: Vec<u8>,
    /// Offsets and lengths in the temporary file.
    extents: Vec<(u64, u32)>,
    heights: Option<[i32; 2]>,
}

/// The triangles of a level.
///
/// Memory: 32 MiB, and some 100 bytes for each tile. Disk: 24 bytes for each part of a triangle in a tile.
pub(super) struct Buckets {
    scheme: Scheme,
    level: u32,
    tiles: HashMap<Tile, Bucket>,
    pending: usize,
    file: TemporaryFile,
    file_len: u64,
    knife: Knife,
    /// Working memory: corners of a part of a triangle.
    corners: Vec<Corner>,
}

impl Buckets {
    pub(super) fn new(scheme: Scheme, level: u32, folder: Option<&Path>) -> Result<Buckets> {
        let (tiles, file, corners) = (HashMap::new(), TemporaryFile::create(folder)?, Vec::new());
        Ok(Buckets { scheme, level, tiles, pending: 0, file, file_len: 0, knife: Knife::default(), corners })
    }

    /// Puts the parts of a triangle into their tiles.
    pub(super) fn add(&mut self, triangle: [Place; 3]) -> Result<()> {
        let longitudes = triangle.map(|place| place[0]);
        let is_across = |a: usize, b: usize| (longitudes[a] - longitudes[b]).abs() > 180.0;
        if is_across(0, 1) || is_across(1, 2) || is_across(2, 0) {
            return Err(Error::usage(
                "the mesh crosses longitude 180: cut it there, and make tiles of both parts",
            ));
        }
        let Buckets { scheme, level, tiles, pending, knife, corners, .. } = self;
        let mut is_low = true;
        knife.cut((*scheme, *level), triangle, |tile, polygon| {
            let sides = scheme.corners(*level, tile);
            corners.clear();
            corners.extend(polygon.iter().map(|place| steps(place, &sides)));
            is_low &= polygon.iter().all(|place| place[2].abs() < HEIGHT_MAX);
            let bucket = tiles.entry(tile).or_default();
            for &[_, _, height] in corners.iter() {
                let heights = bucket.heights.get_or_insert([height; 2]);
                *heights = [heights[0].min(height), heights[1].max(height)];
            }
            for pair in corners[1..].windows(2) {
                let part = [corners[0], pair[0], pair[1]];
                if is_triangle(&part) {
                    encode(&part, &mut bucket.pending);
                    *pending += RECORD_LEN;
                }
            }
        });
        if !is_low {
            return Err(Error::usage("the mesh has heights beyond 2,000 km: is their unit right?"));
        }
        if self.pending > PENDING_MAX { self.spill() } else { Ok(()) }
    }

    fn spill(&mut self) -> Result<()> {
        let mut all = Vec::with_capacity(self.pending);
        for bucket in self.tiles.values_mut().filter(|bucket| !bucket.pending.is_empty()) {
            bucket.extents.push((self.file_len + all.len() as u64, bucket.pending.len() as u32));
            all.append(&mut bucket.pending);
            bucket.pending.shrink_to_fit();
        }
        self.file.append("writing triangles", &all)?;
        self.file_len += all.len() as u64;
        self.pending = 0;
        Ok(())
    }

    /// The tiles in order, with the ranges of their heights.
    pub(super) fn tiles(&self) -> Vec<(Tile, [i32; 2])> {
        let mut tiles: Vec<_> =
            self.tiles.iter().filter_map(|(&tile, bucket)| Some((tile, bucket.heights?))).collect();
        tiles.sort_unstable();
        tiles
    }

    /// The triangles of a tile, in an order that follows from their set. Heights are rounded to multiples of
    /// a power of two.
    pub(super) fn triangles(&self, tile: Tile, power: u32) -> Result<Vec<Triangle>> {
        let Some(bucket) = self.tiles.get(&tile) else { return Ok(Vec::new()) };
        let mut bytes = Vec::new();
        for &(offset, len) in &bucket.extents {
            let start = bytes.len();
            bytes.resize(start + len as usize, 0);
            self.file.read_at("reading triangles", &mut bytes[start..], offset)?;
        }
        bytes.extend_from_slice(&bucket.pending);
        let decoded = bytes.chunks_exact(RECORD_LEN).map(|record| {
            let mut corners = decode(record).map(|[u, v, height]| [u, v, rounded(height, power)]);
            let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
            corners.rotate_left(first);
            corners
        });
        let mut triangles: Vec<Triangle> = decoded.filter(is_triangle).collect();
        triangles.sort_unstable();
        triangles.dedup();
        Ok(triangles)
    }
}

/// Heights fit in 31 bits of steps.
const HEIGHT_MAX: f64 = 2e6;

/// A height in steps as a multiple of a power of two, ties upwards.
pub(super) fn rounded(height: i32, power: u32) -> i32 {
    let half = if power == 0 { 0 } else { 1 << (power - 1) };
    ((height + half) >> power) << power
}

/// Only places on a border get its coordinate, so that neighbours have the same points there.
fn steps(place: &Place, [min, max]: &[[f64; 2]; 2]) -> Corner {
    let along = |axis: usize| {
        let (at, min, max) = (place[axis], min[axis], max[axis]);
        match at {
            at if at == min => 0,
            at if at == max => STEPS as i32,
            at => ((at - min) / (max - min) * STEPS as f64).round().clamp(1.0, (STEPS - 1) as f64) as i32,
        }
    };
    [along(0), along(1), (place[2] * HEIGHT_STEPS).round() as i32]
}

fn is_triangle([a, b, c]: &Triangle) -> bool {
    a != b && b != c && c != a
}

fn encode(triangle: &Triangle, bytes: &mut Vec<u8>) {
    for [u, v, height] in triangle {
        bytes.extend((*u as u16).to_le_bytes());
        bytes.extend((*v as u16).to_le_bytes());
        bytes.extend(height.to_le_bytes());
    }
}

fn decode(record: &[u8]) -> Triangle {
    [0, 8, 16].map(|at| {
        let short = |at: usize| i32::from(u16::from_le_bytes([record[at], record[at + 1]]));
        let height = record[at + 4..at + 8].try_into().expect("four bytes");
        [short(at), short(at + 2), i32::from_le_bytes(height)]
    })
}
