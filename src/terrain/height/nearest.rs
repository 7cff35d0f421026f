//! The place of the mesh nearest to a point outside of it.

use super::blocks::{Blocks, LoadedBlock, Triangle};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;

/// Blocks that are kept in memory: neighbouring points mostly need the same ones.
const KEPT_MAX: usize = 16;

/// Finds nearest places.
///
/// Memory: 16 blocks of triangles.
#[derive(Debug)]
pub(super) struct Nearest<'b> {
    blocks: &'b Blocks,
    /// The blocks used last, the newest at the end.
    kept: Vec<(usize, LoadedBlock)>,
}

/// A place and its squared distance.
#[derive(Debug, Clone, Copy)]
struct Place {
    distance2: f64,
    elevation: f64,
}

impl<'b> Nearest<'b> {
    pub(super) fn new(blocks: &'b Blocks) -> Nearest<'b> {
        Nearest { blocks, kept: Vec::new() }
    }

    /// The elevation of the mesh at the place nearest to a point outside of it; `None` if no triangle is
    /// within a distance.
    ///
    /// Cost: looks at the boxes of all groups of blocks, and at the triangles of a few blocks.
    pub(super) fn elevation(&mut self, point: &Point, within: f64) -> Result<Option<f64>> {
        let (blocks, within2) = (self.blocks, within * within);
        let Some(first) = blocks.closest(point, within2) else { return Ok(None) };
        let mut best = nearest_of(self.triangles(first)?, point);
        let mut nearer: Vec<usize> = blocks.that(|bounds| bounds.distance2(point) < best.distance2).collect();
        nearer.sort_by(|&p, &q| {
            let distance = |block| blocks.bounds(block).distance2(point);
            distance(p).total_cmp(&distance(q))
        });
        for block in nearer {
            if block != first && blocks.bounds(block).distance2(point) < best.distance2 {
                let other = nearest_of(self.triangles(block)?, point);
                best = if other.distance2 < best.distance2 { other } else { best };
            }
        }
        Ok((best.distance2 <= within2).then_some(best.elevation))
    }

    /// The triangles of a block.
    fn triangles(&mut self, block: usize) -> Result<impl Iterator<Item = Triangle>> {
        let at = match self.kept.iter().position(|(kept, _)| *kept == block) {
            Some(at) => at,
            None => {
                let is_full = self.kept.len() == KEPT_MAX;
                let mut loaded = if is_full { self.kept.remove(0).1 } else { LoadedBlock::default() };
                self.blocks.read(block, &mut loaded)?;
                self.kept.push((block, loaded));
                self.kept.len() - 1
            }
        };
        let last = self.kept.len() - 1;
        self.kept[at..].rotate_left(1);
        Ok(self.kept[last].1.triangles())
    }
}

/// The nearest place on the edges of triangles.
fn nearest_of(triangles: impl Iterator<Item = Triangle>, point: &Point) -> Place {
    let none = Place { distance2: f64::INFINITY, elevation: f64::NAN };
    let edges = triangles.flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    edges.fold(none, |best, (from, to)| {
        let place = nearest_on(&from, &to, point);
        if place.distance2 < best.distance2 { place } else { best }
    })
}

/// The nearest place on an edge.
fn nearest_on(from: &Point, to: &Point, point: &Point) -> Place {
    let [dx, dy, dz] = [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let [x, y] = [0, 1].map(|axis| point[axis] - from[axis]);
    let share = ((x * dx + y * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    let distance2 = (x - share * dx).powi(2) + (y - share * dy).powi(2);
    Place { distance2, elevation: if share == 1.0 { to[2] } else { from[2] + share * dz } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::height::block_writer::BlockWriter;
    use spmesh_base::random::Random;

    #[test]
    fn edges_and_their_ends_are_found() {
        let edge = [[0.0, 0.0, 5.0], [10.0, 0.0, 15.0]];
        for (at, distance2, elevation) in
            [([3.0, 2.0], 4.0, 8.0), ([-3.0, 4.0], 25.0, 5.0), ([13.0, -4.0], 25.0, 15.0)]
        {
            let place = nearest_on(&edge[0], &edge[1], &[at[0], at[1], 0.0]);
            assert_eq!((place.distance2, place.elevation), (distance2, elevation));
        }
    }

    #[test]
    fn blocks_are_searched_as_if_they_were_one() {
        let mut random = Random::new(3);
        let mut blocks = BlockWriter::new(false, None).unwrap();
        let mut all = Vec::new();
        for _ in 0..20_000 {
            let at: Point = [random.unit(), random.unit(), 0.0];
            let triangle = [0, 1, 2]
                .map(|_| [at[0] + 0.01 * random.unit(), at[1] + 0.01 * random.unit(), random.unit()]);
            all.push(triangle);
            blocks.add(triangle.into_iter(), [[0, 1, 2]].into_iter()).unwrap();
        }
        let blocks = blocks.finish().unwrap();
        assert!(blocks.that(|_| true).count() > 5);
        let mut nearest = Nearest::new(&blocks);
        for _ in 0..200 {
            let point = [4.0 * random.unit() - 2.0, 4.0 * random.unit() - 2.0, 0.0];
            let expected = nearest_of(all.iter().copied(), &point);
            assert_eq!(nearest.elevation(&point, f64::INFINITY).unwrap(), Some(expected.elevation));
            let is_near = expected.distance2 <= 0.25;
            assert_eq!(nearest.elevation(&point, 0.5).unwrap().is_some(), is_near);
        }
    }
}
