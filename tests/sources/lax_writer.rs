//! Writes indices as LAStools does, independently of the reader.

use std::collections::BTreeMap;

/// How an index is laid out.
#[derive(Clone, Copy)]
pub struct Layout {
    pub levels: u32,
    /// Cells with fewer points are merged with the three beside them, if all four are there.
    pub points_min: usize,
    /// Records between two intervals of a cell that make them one.
    pub gap: u32,
}

/// The quadtree over a rectangle.
struct Tree {
    levels: u32,
    min: [f32; 2],
    max: [f32; 2],
}

impl Tree {
    /// The path of a point to its cell, of two bits per level.
    fn place(&self, point: [f64; 2]) -> u32 {
        let (mut min, mut max, mut place) = (self.min, self.max, 0);
        for _ in 0..self.levels {
            place <<= 2;
            for axis in 0..2 {
                let middle = (min[axis] + max[axis]) / 2.0;
                if point[axis] < f64::from(middle) {
                    max[axis] = middle;
                } else {
                    min[axis] = middle;
                    place |= 1 << axis;
                }
            }
        }
        place
    }
}

/// The number of the first cell of a level.
fn first_of(level: u32) -> u32 {
    (0..level).map(|above| 1 << (2 * above)).sum()
}

/// The index of points, in the order of their records, over a rectangle.
pub fn index(points: &[[f64; 2]], min: [f32; 2], max: [f32; 2], layout: Layout) -> Vec<u8> {
    let tree = Tree { levels: layout.levels, min, max };
    let mut cells: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    for (number, point) in (0..).zip(points) {
        cells.entry((layout.levels, tree.place(*point))).or_default().push(number);
    }
    for level in (1..=layout.levels).rev() {
        coarsen(&mut cells, level, layout.points_min);
    }
    let mut bytes = b"LASX\0\0\0\0LASS\0\0\0\0LASQ\0\0\0\0".to_vec();
    bytes.extend([layout.levels, 0, 0].map(u32::to_le_bytes).as_flattened());
    bytes.extend([min[0], max[0], min[1], max[1]].map(f32::to_le_bytes).as_flattened());
    bytes.extend(b"LASV\0\0\0\0");
    bytes.extend((cells.len() as u32).to_le_bytes());
    for ((level, place), mut records) in cells {
        records.sort_unstable();
        let intervals = intervals(&records, layout.gap);
        let head = [first_of(level) + place, intervals.len() as u32, records.len() as u32];
        bytes.extend(head.map(u32::to_le_bytes).as_flattened());
        intervals.as_flattened().iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    bytes
}

/// Replaces four cells of a level by the one above them, where they have few points.
fn coarsen(cells: &mut BTreeMap<(u32, u32), Vec<u32>>, level: u32, points_min: usize) {
    let parents: Vec<u32> = cells.keys().filter(|cell| cell.0 == level).map(|cell| cell.1 / 4).collect();
    for parent in parents {
        let four = [0, 1, 2, 3].map(|quarter| (level, 4 * parent + quarter));
        let counts = four.map(|cell| cells.get(&cell).map_or(0, Vec::len));
        if counts.iter().all(|&count| count > 0) && counts.iter().sum::<usize>() < points_min {
            let records = four.iter().flat_map(|cell| cells.remove(cell).unwrap_or_default()).collect();
            cells.insert((level - 1, parent), records);
        }
    }
}

fn intervals(records: &[u32], gap: u32) -> Vec<[u32; 2]> {
    let mut found: Vec<[u32; 2]> = Vec::new();
    for &number in records {
        match found.last_mut().filter(|last| number - last[1] <= gap) {
            Some(last) => last[1] = number,
            None => found.push([number, number]),
        }
    }
    found
}

/// The file with an index in an extended record, of which its header of LAS 1.4 tells.
pub fn embedded(mut file: Vec<u8>, index: &[u8]) -> Vec<u8> {
    let start = file.len() as u64;
    file[235..243].copy_from_slice(&start.to_le_bytes());
    file[243..247].copy_from_slice(&1u32.to_le_bytes());
    file.extend(record(index));
    file
}

/// The LAZ file with an index in a record after its end, of which the laszip record tells.
pub fn appended(mut file: Vec<u8>, index: &[u8]) -> Vec<u8> {
    let start = file.len() as i64;
    let name = b"laszip encoded";
    let user = file.windows(name.len()).position(|bytes| bytes == name).expect("a LAZ file");
    let laszip = user + 52;
    file[laszip + 16..laszip + 24].copy_from_slice(&1i64.to_le_bytes());
    file[laszip + 24..laszip + 32].copy_from_slice(&start.to_le_bytes());
    file.extend(record(index));
    file
}

fn record(index: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0, 0];
    bytes.extend(b"LAStools\0\0\0\0\0\0\0\0");
    bytes.extend(30u16.to_le_bytes());
    bytes.extend((index.len() as u64).to_le_bytes());
    bytes.resize(60, 0);
    bytes.extend(index);
    bytes
}
