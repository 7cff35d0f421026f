//! An index of LAStools: which records are in each cell of a quadtree.
//!
//! Source: the files that lasindex writes, as read by LASzip (`lasindex`, `lasquadtree`, `lasinterval`). All
//! numbers are little-endian:
//!
//! | part | fields |
//! |---|---|
//! | `LASX` | version u32 |
//! | `LASS` | type u32, 0 for a quadtree |
//! | `LASQ` (absent in old files) | version u32 |
//! | | levels, level index, implicit levels u32; min x, max x, min y, max y f32 |
//! | `LASV` | version u32, number of cells u32 |
//! | per cell | number i32, intervals u32, points u32; per interval its first and last record u32 |
//!
//! A cell of a higher level stands for those below it. Intervals may hold records of other cells.

use std::ops::Range;

use crate::las::header::LasHeader;
use crate::las::index::lax_tree::{Rectangle, Tree};
use crate::las::index::parts::Part;
use crate::las::index::{meet, steps};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// How many steps of the file's grid a point may lie outside of its cell.
const SLACK: Point = [1.0, 1.0, 0.0];

/// The index of a file.
pub(crate) struct Lax {
    tree: Tree,
    cells: Vec<Cell>,
    /// Numbers of records, for one cell after the other.
    intervals: Vec<Range<u64>>,
}

struct Cell {
    place: Rectangle,
    /// Number of points.
    points: u64,
    /// Its place in `Lax::intervals`.
    intervals: Range<usize>,
}

impl Lax {
    /// Reads an index.
    pub(crate) fn read(bytes: &[u8]) -> Result<Lax> {
        let mut input = Words { rest: bytes };
        input.expect(*b"LASX")?;
        input.expect_zero("version")?;
        input.expect(*b"LASS")?;
        input.expect_zero("type")?;
        let tree = read_tree(&mut input)?;
        input.expect(*b"LASV")?;
        input.expect_zero("version of the intervals")?;
        let mut lax = Lax { tree, cells: Vec::new(), intervals: Vec::new() };
        for _ in 0..input.number()? {
            lax.read_cell(&mut input)?;
        }
        if !input.rest.is_empty() {
            return Err(Error::malformed(format!("{} bytes follow the last cell", input.rest.len())));
        }
        Ok(lax)
    }

    fn read_cell(&mut self, input: &mut Words) -> Result<()> {
        let number = i32::from_le_bytes(input.word()?);
        let place = self.tree.cell(number);
        let place =
            place.ok_or_else(|| Error::malformed(format!("cell {number}, which is not in the tree")))?;
        let (count, points) = (input.number()?, u64::from(input.number()?));
        let first = self.intervals.len();
        // Records up to the last interval, and in all intervals.
        let (mut before, mut records) = (0, 0);
        for _ in 0..count {
            let (start, end) = (u64::from(input.number()?), u64::from(input.number()?) + 1);
            if start < before || end <= start {
                return Err(Error::malformed(format!("records {start} to {} in cell {number}", end - 1)));
            }
            before = end;
            records += end - start;
            self.intervals.push(start..end);
        }
        if points > records {
            return Err(Error::malformed(format!("{points} points in {records} records of cell {number}")));
        }
        self.cells.push(Cell { place, points, intervals: first..self.intervals.len() });
        Ok(())
    }

    /// Checks that the index has all records of the file, and no others.
    pub(crate) fn check(&self, header: &LasHeader) -> Result<()> {
        let points: u64 = self.cells.iter().map(|cell| cell.points).sum();
        let covered = merged(self.intervals.clone());
        let covers = match &covered[..] {
            [all] => *all == (0..header.points),
            _ => false,
        };
        if points != header.points || !covers {
            return Err(Error::malformed(format!(
                "it is of {points} points in {} ranges of records, the file has {} points",
                covered.len(),
                header.points
            )));
        }
        let root = in_steps(&header.coordinates, &self.tree.root());
        match &header.bounds {
            Some(stated) if !(flat_contains(&root, stated.min) && flat_contains(&root, stated.max)) => {
                Err(Error::malformed("it is of another place than the file"))
            }
            _ => Ok(()),
        }
    }

    /// Checks that the points of some records lie in cells that have these records. The records are in the order
    /// of the file, their coordinates as stored.
    pub(crate) fn test(&self, header: &LasHeader, records: &[(u64, Point)]) -> Result<()> {
        let mut is_found = vec![false; records.len()];
        for cell in &self.cells {
            let place = in_steps(&header.coordinates, &cell.place);
            for interval in &self.intervals[cell.intervals.clone()] {
                let index_of = |number| records.partition_point(|record| record.0 < number);
                for index in index_of(interval.start)..index_of(interval.end) {
                    is_found[index] |= flat_contains(&place, records[index].1);
                }
            }
        }
        match is_found.iter().position(|is_found| !is_found) {
            Some(index) => {
                let number = records[index].0;
                Err(Error::malformed(format!("record {number} is not in the cells that should have it")))
            }
            None => Ok(()),
        }
    }

    /// The records of the cells that have a point in common with `reach`, a box in steps of the file's grid.
    pub(crate) fn parts(&self, coordinates: &Coordinates, reach: &Bounds) -> Vec<Part> {
        let is_needed = |cell: &&Cell| meet(&in_steps(coordinates, &cell.place), reach);
        let needed = self.cells.iter().filter(is_needed);
        let intervals = needed.flat_map(|cell| &self.intervals[cell.intervals.clone()]).cloned().collect();
        merged(intervals).into_iter().map(|records| Part { records, within: None }).collect()
    }
}

/// The same numbers in ranges that are in order, and neither overlap nor touch.
fn merged(mut ranges: Vec<Range<u64>>) -> Vec<Range<u64>> {
    ranges.sort_unstable_by_key(|range| range.start);
    ranges.dedup_by(|next, last| {
        let touches = next.start <= last.end;
        if touches {
            last.end = last.end.max(next.end);
        }
        touches
    });
    ranges
}

/// A rectangle as a box in steps of the file's grid, without limits of z.
fn in_steps(coordinates: &Coordinates, Rectangle { min, max }: &Rectangle) -> Bounds {
    let bounds = Bounds { min: [min[0], min[1], f64::NEG_INFINITY], max: [max[0], max[1], f64::INFINITY] };
    steps::outward(coordinates, &bounds, SLACK)
}

fn flat_contains(bounds: &Bounds, [x, y, _]: Point) -> bool {
    bounds.contains([x, y, 0.0])
}

fn read_tree(input: &mut Words) -> Result<Tree> {
    let mut levels = input.word()?;
    if levels == *b"LASQ" {
        input.expect_zero("version of the tree")?;
        levels = input.word()?;
    }
    // Part of a larger tree: no program writes it.
    input.expect_zero("level index")?;
    // Without meaning if the level index is zero.
    input.word()?;
    let mut side = || input.word().map(f32::from_le_bytes);
    let (min_x, max_x, min_y, max_y) = (side()?, side()?, side()?, side()?);
    Tree::new(u32::from_le_bytes(levels), [min_x, min_y], [max_x, max_y])
}

/// Words of four bytes.
struct Words<'a> {
    rest: &'a [u8],
}

impl Words<'_> {
    fn word(&mut self) -> Result<[u8; 4]> {
        let (word, rest) = self.rest.split_first_chunk().ok_or_else(|| Error::malformed("it is cut off"))?;
        self.rest = rest;
        Ok(*word)
    }

    fn number(&mut self) -> Result<u32> {
        self.word().map(u32::from_le_bytes)
    }

    fn expect(&mut self, signature: [u8; 4]) -> Result<()> {
        let found = self.word()?;
        if found == signature {
            return Ok(());
        }
        let [found, expected] = [found, signature].map(|word| word.escape_ascii().to_string());
        Err(Error::malformed(format!("it has {found} in the place of {expected}")))
    }

    fn expect_zero(&mut self, what: &str) -> Result<()> {
        match self.number()? {
            0 => Ok(()),
            other => Err(Error::malformed(format!("{what} {other}, expected 0"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An index of a tree over 0 to 4 in x and y; cells are their numbers, points and intervals.
    fn index(cells: &[(i32, u32, &[[u32; 2]])]) -> Vec<u8> {
        let mut bytes: Vec<u8> = b"LASX\0\0\0\0LASS\0\0\0\0LASQ\0\0\0\0".to_vec();
        bytes.extend([2u32, 0, 0].iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0f32, 4.0, 0.0, 4.0].iter().flat_map(|side| side.to_le_bytes()));
        bytes.extend(b"LASV\0\0\0\0");
        bytes.extend((cells.len() as u32).to_le_bytes());
        for (number, points, intervals) in cells {
            bytes.extend(number.to_le_bytes());
            bytes.extend((intervals.len() as u32).to_le_bytes());
            bytes.extend(points.to_le_bytes());
            bytes.extend(intervals.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes
    }

    fn ranges(lax: &Lax, min: [f64; 2], max: [f64; 2]) -> Vec<[u64; 2]> {
        let coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] };
        let reach = Bounds { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] };
        let reach = steps::outward(&coordinates, &reach, [0.0; 3]);
        let parts = lax.parts(&coordinates, &reach);
        parts.iter().map(|part| [part.records.start, part.records.end]).collect()
    }

    #[test]
    fn records_of_the_cells_in_a_box_are_found() {
        // The lower left quarter as a whole, and a cell of the next level in the upper right quarter.
        let cells: [(i32, u32, &[[u32; 2]]); 2] = [(1, 3, &[[0, 1], [5, 6]]), (17, 4, &[[2, 4], [7, 8]])];
        let new = index(&cells);
        let old = [&new[..16], &new[24..]].concat();
        for bytes in [new, old] {
            let lax = Lax::read(&bytes).unwrap();
            assert_eq!(ranges(&lax, [-9.0, 0.0], [1.0, 1.0]), [[0, 2], [5, 7]]);
            assert_eq!(ranges(&lax, [2.5, 2.5], [9.0, 9.0]), [[2, 5], [7, 9]]);
            assert_eq!(ranges(&lax, [2.0, 2.0], [2.0, 2.0]), [[0, 9]]);
            assert_eq!(ranges(&lax, [3.5, 3.5], [9.0, 9.0]), [[0u64; 2]; 0]);
        }
    }

    #[test]
    fn damage_is_an_error() {
        let whole = index(&[(5, 3, &[[0, 1], [5, 6]]), (0, 2, &[[2, 4]])]);
        assert!(Lax::read(&whole).is_ok());
        for len in 0..whole.len() {
            assert!(Lax::read(&whole[..len]).is_err(), "{len}");
        }
        let fails = |bytes: &[u8], what: &str| {
            let message = Lax::read(bytes).map(|_| ()).expect_err(what).to_string();
            assert!(message.contains(what), "{what}: {message}");
        };
        fails(&[&whole[..], &[0]].concat(), "1 bytes follow");
        fails(&index(&[(-1, 1, &[[0, 0]])]), "cell -1");
        fails(&index(&[(21, 1, &[[0, 0]])]), "cell 21");
        fails(&index(&[(0, 1, &[[2, 1]])]), "records 2 to 1");
        fails(&index(&[(0, 1, &[[0, 4], [4, 5]])]), "records 4 to 5");
        fails(&index(&[(0, 3, &[[0, 0], [4, 4]])]), "3 points in 2 records");
        for (at, what) in [(0, "LASX"), (4, "version"), (12, "type"), (20, "version of the tree")] {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            fails(&bytes, what);
        }
        // A count of cells that the bytes cannot hold.
        let count = whole.windows(4).position(|word| word == b"LASV").unwrap() + 8;
        let mut bytes = whole;
        bytes[count..count + 4].fill(255);
        fails(&bytes, "cut off");
    }

    #[test]
    fn ranges_merge() {
        assert_eq!(merged(vec![5..7, 0..2, 2..4, 6..6, 1..3, 9..10]), [0..4, 5..7, 9..10]);
    }
}
