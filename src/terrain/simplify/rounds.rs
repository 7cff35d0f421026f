//! Rounds: the chosen points are triangulated, and where others are too far from this surface, more are
//! chosen.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;

use super::cells::{Cell, Cells};
use super::greedy::{self, Limit};
use super::vertices::Vertices;
use crate::height::{Box2, Ground, Triangle};
use crate::meshing::Meshing;
use foldhash::HashSet;
use spmesh_base::error::Result;
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::lexicographic;
use spmesh_stream::model::bounds::Point;

/// As long as a round has chosen at most so many points, the next one looks at triangles with one of them
/// alone.
///
/// Memory: 17 bytes for each, or twice as much.
const NEWS_MAX: usize = 1 << 20;

/// What a run works with.
pub(super) struct Work<'w> {
    pub(super) cells: &'w Cells,
    pub(super) limit: Limit,
    pub(super) meshing: &'w Meshing,
}

/// The places of the points that the last round has chosen.
#[derive(Debug, Default)]
struct News(HashSet<[u64; 2]>);

impl News {
    fn key(&[x, y, _]: &Point) -> [u64; 2] {
        // There is one zero.
        [x, y].map(|value| (value + 0.0).to_bits())
    }

    fn has(&self, point: &Point) -> bool {
        self.0.contains(&News::key(point))
    }
}

impl Work<'_> {
    fn threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.meshing.threads).unwrap_or(NonZeroUsize::MIN)
    }

    /// Chooses points until all others are near the surface of the chosen ones. Calls `progress` with the
    /// number of points looked at, round by round. Returns the number of rounds.
    pub(super) fn choose(&self, chosen: &mut Vertices, progress: &mut dyn FnMut(u64, u64)) -> Result<u64> {
        if self.cells.corners.len() < 3 {
            // There is no surface.
            let rest = if chosen.len() == 0 { &self.cells.cells[..] } else { &[] };
            return rest.iter().try_for_each(|cell| chosen.append(&self.cells.read(cell)?)).map(|()| 0);
        }
        if chosen.len() == 0 {
            chosen.append(&self.cells.corners)?;
            let found = greedy::choose(&self.cells.corners, &self.cells.sample, self.limit)?;
            chosen.append(&found)?;
        }
        let mut news = None;
        for round in 1.. {
            let surface = self.surface(chosen)?;
            let before = chosen.len();
            news = self.round(&surface, news.as_ref(), chosen, |points| progress(round, points))?;
            if chosen.len() == before {
                return Ok(round);
            }
        }
        unreachable!("a round that chooses nothing comes once all points are chosen")
    }

    /// The triangulation of the chosen points.
    fn surface(&self, chosen: &Vertices) -> Result<Ground> {
        let mut mesh = self.meshing.mesh(chosen, "simplified mesh")?;
        Ground::read(&mut mesh, self.meshing.temp_dir.as_deref(), self.meshing.memory, |_| {})
    }

    /// Chooses points of each cell as if those of all others were final. Returns which ones, if they are few.
    fn round(
        &self,
        surface: &Ground,
        news: Option<&News>,
        chosen: &mut Vertices,
        mut progress: impl FnMut(u64),
    ) -> Result<Option<News>> {
        let (threads, mut next, mut done) = (self.threads(), Some(News::default()), 0);
        for cells in self.cells.cells.chunks(4 * threads.get()) {
            let found = parallel::map(threads, cells, |cell| self.in_cell(surface, news, cell))?;
            for points in found {
                chosen.append(&points)?;
                if let Some(News(places)) = &mut next {
                    places.extend(points.iter().map(News::key));
                    next = next.filter(|News(places)| places.len() <= NEWS_MAX);
                }
            }
            done += cells.iter().map(Cell::len).sum::<u64>();
            progress(done);
        }
        Ok(next)
    }

    /// Chooses points of a cell.
    fn in_cell(&self, surface: &Ground, news: Option<&News>, cell: &Cell) -> Result<Vec<Point>> {
        let mut changed = Cover::new(cell.bounds);
        surface.for_each_near(&cell.bounds, |triangle| {
            if news.is_none_or(|news| triangle.iter().any(|corner| news.has(corner))) {
                changed.add(&triangle);
            }
        })?;
        if changed.is_empty() {
            return Ok(Vec::new());
        }
        let mut points = self.cells.read(cell)?;
        points.retain(|point| changed.has(point));
        // Triangles near these are Delaunay also among their corners alone.
        let mut seeds: HashSet<[u64; 3]> = HashSet::default();
        surface.for_each_near(&cell.bounds, |triangle| {
            if changed.meets(&triangle) {
                seeds.extend(triangle.map(|corner| corner.map(f64::to_bits)));
            }
        })?;
        let mut seeds: Vec<Point> = seeds.into_iter().map(|corner| corner.map(f64::from_bits)).collect();
        seeds.sort_unstable_by(|a, b| lexicographic(*a, *b));
        greedy::choose(&seeds, &points, self.limit)
    }
}

/// Some of the squares of a raster over a cell.
struct Cover {
    bounds: Box2,
    /// Columns of each row.
    rows: [u64; 64],
}

impl Cover {
    fn new(bounds: Box2) -> Cover {
        Cover { bounds, rows: [0; 64] }
    }

    fn is_empty(&self) -> bool {
        self.rows == [0; 64]
    }

    /// Column and row of a place, or of the nearest one in the cell. They grow with the coordinates.
    fn square(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis| {
            let (min, max) = (self.bounds.min[axis], self.bounds.max[axis]);
            // Conversions saturate, and NaN, of a cell without extent, becomes 0.
            (((at[axis] - min) / (max - min) * 64.0) as usize).min(63)
        })
    }

    /// The rows of the squares that the box of a triangle meets, and their columns.
    fn squares(&self, triangle: &Triangle) -> (RangeInclusive<usize>, u64) {
        let Box2 { min, max } = Box2::of(triangle);
        let ([left, low], [right, high]) = (self.square(min), self.square(max));
        (low..=high, (u64::MAX >> (63 - (right - left))) << left)
    }

    /// Adds the squares that the box of a triangle meets.
    fn add(&mut self, triangle: &Triangle) {
        let (rows, columns) = self.squares(triangle);
        self.rows[rows].iter_mut().for_each(|row| *row |= columns);
    }

    /// Whether one of the squares meets the box of a triangle: so if it contains one of their points.
    fn meets(&self, triangle: &Triangle) -> bool {
        let (rows, columns) = self.squares(triangle);
        self.rows[rows].iter().any(|row| row & columns != 0)
    }

    fn has(&self, &[x, y, _]: &Point) -> bool {
        let [column, row] = self.square([x, y]);
        self.rows[row] >> column & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cover_has_what_is_in_its_triangles() {
        let mut cover = Cover::new(Box2 { min: [0.0, 0.0], max: [10.0, 20.0] });
        assert!(cover.is_empty());
        cover.add(&[[2.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 30.0, 0.0]]);
        assert!(!cover.meets(&[[5.0, 3.0, 0.0], [9.0, 3.0, 0.0], [6.0, 30.0, 0.0]]));
        assert!(cover.meets(&[[-5.0, 3.0, 0.0], [3.0, 3.0, 0.0], [6.0, 30.0, 0.0]]));
        assert!(cover.has(&[2.0, 3.0, 0.0]) && cover.has(&[4.0, 20.0, 0.0]) && !cover.has(&[5.0, 5.0, 0.0]));
        cover.add(&[[-1.0, -1.0, 0.0], [11.0, -1.0, 0.0], [0.0, 21.0, 0.0]]);
        assert!(cover.has(&[10.0, 20.0, 0.0]) && cover.has(&[5.0, 5.0, 0.0]));
    }
}
