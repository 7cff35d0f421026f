//! The lines that decide the network and the water in a box, so that a job of many leaves the others out.
//!
//! These are all lines of features whose box meets it, for a polygon may surround it; the lines that come
//! near these, since common vertices move both, and those that come near them in turn; and all lines of their
//! polygons and rivers. The others are nowhere near any of these, so they change nothing about them.

use std::collections::HashMap;

use super::areas::Role;
use super::numbered::numbered;
use spmesh_formats::source::Breaklines;
use spmesh_stream::model::points::Point2;

/// Cells along the longer side of the box of all lines, at most.
const CELLS: f64 = 2048.0;

/// Steps of the grid by which lines that are apart cannot move to each other.
const APART: f64 = 4.0;

/// Leaves out the lines that do not decide what is in a closed box; `step` is that of the grid. Units: those
/// of the world.
pub(super) fn leave_out(files: &mut [(Role, String, Breaklines)], [min, max]: [Point2; 2], step: f64) {
    let mut groups = Groups::of(files);
    groups.join_near(files, step);
    let margin = APART * step;
    let meets = |vertices: &[Point2]| {
        let bounds = bounds(vertices.iter().copied());
        bounds.is_some_and(|(low, high)| {
            (0..2).all(|axis| low[axis] - margin <= max[axis] && high[axis] + margin >= min[axis])
        })
    };
    let mut is_kept = vec![false; groups.0.len()];
    for it in numbered(files).filter(|it| meets(&it.line.vertices)) {
        is_kept[groups.root(it.number) as usize] = true;
    }
    let mut number = 0;
    for (.., file) in files {
        file.lines.retain(|_| {
            number += 1;
            is_kept[groups.root(number - 1) as usize]
        });
    }
}

fn bounds(mut places: impl Iterator<Item = Point2>) -> Option<(Point2, Point2)> {
    let first = places.next()?;
    Some(places.fold((first, first), |(low, high), place| {
        ([0, 1].map(|axis| low[axis].min(place[axis])), [0, 1].map(|axis| high[axis].max(place[axis])))
    }))
}

/// Groups of lines, each by one of them.
struct Groups(Vec<u32>);

impl Groups {
    /// The lines of each polygon and of each river.
    fn of(files: &[(Role, String, Breaklines)]) -> Groups {
        let count = numbered(files).count() as u32;
        let mut groups = Groups((0..count).collect());
        let (mut polygons, mut rivers) = (HashMap::new(), HashMap::new());
        for it in numbered(files) {
            let of_polygon = it.polygon.map(|polygon| *polygons.entry(polygon).or_insert(it.number));
            let river = it.line.properties.river.as_deref();
            let of_river = river.map(|river| *rivers.entry(river).or_insert(it.number));
            of_polygon.into_iter().chain(of_river).for_each(|other| groups.join(it.number, other));
        }
        groups
    }

    fn root(&mut self, mut line: u32) -> u32 {
        while self.0[line as usize] != line {
            // Halves the way for the next time.
            let above = self.0[self.0[line as usize] as usize];
            self.0[line as usize] = above;
            line = above;
        }
        line
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// Joins lines that have parts in the same cell.
    ///
    /// Memory: about 60 bytes for each vertex, less than noding takes.
    fn join_near(&mut self, files: &[(Role, String, Breaklines)], step: f64) {
        let Some((low, high)) = bounds(numbered(files).flat_map(|it| it.line.vertices.iter().copied()))
        else {
            return;
        };
        let parts = || numbered(files).flat_map(|it| it.line.vertices.windows(2));
        let length: f64 = parts().map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1])).sum();
        let side = (high[0] - low[0]).max(high[1] - low[1]);
        // As many pieces as vertices, and those that long parts are cut into.
        let cell = (side / CELLS)
            .max(length / numbered(files).map(|it| it.line.vertices.len()).sum::<usize>() as f64);
        let cell = cell.max(4.0 * APART * step);
        let index = |axis: usize, value: f64| ((value - low[axis]) / cell).max(0.0) as u64;
        let mut entries: Vec<(u64, u32)> = Vec::new();
        for it in numbered(files) {
            let single = it.line.vertices.first().map(|&place| [place; 2]);
            for [from, to] in it.line.vertices.windows(2).map(|ends| [ends[0], ends[1]]).chain(single) {
                let pieces = ((to[0] - from[0]).hypot(to[1] - from[1]) / cell).ceil().max(1.0);
                let at = |piece: f64, axis: usize| from[axis] + (to[axis] - from[axis]) * (piece / pieces);
                for piece in (0..pieces as u32).map(f64::from) {
                    let [columns, rows] = [0, 1].map(|axis| {
                        let (a, b) = (at(piece, axis), at(piece + 1.0, axis));
                        index(axis, a.min(b) - APART * step)..=index(axis, a.max(b) + APART * step)
                    });
                    for column in columns {
                        for entry in rows.clone().map(|row| (column << 32 | row, it.number)) {
                            // Short parts are in the cell of the one before.
                            if entries.last() != Some(&entry) {
                                entries.push(entry);
                            }
                        }
                    }
                }
            }
        }
        entries.sort_unstable();
        for same in entries.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|&(_, line)| self.join(line, same[0].1));
        }
    }
}
