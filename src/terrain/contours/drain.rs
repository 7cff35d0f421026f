//! Finishes complete lines and writes them.

use std::io::Write;

use foldhash::{HashSet, HashSetExt};

use super::canonical;
use super::clip::Clipper;
use super::geojson::LineWriter;
use super::open_lines::Contour;
use super::places::Plane;
use super::smooth::Place;
use super::{Options, Stats};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::Header;

/// Writes complete lines, and counts them.
pub(super) struct Drain<'a, W> {
    pub(super) writer: LineWriter<W>,
    options: &'a Options,
    plane: Plane,
    clipper: Option<Clipper>,
    pub(super) levels_with_lines: HashSet<i64>,
    pub(super) stats: Stats,
}

impl<'a, W: Write> Drain<'a, W> {
    pub(super) fn new(header: &Header, writer: LineWriter<W>, options: &'a Options) -> Drain<'a, W> {
        Drain {
            writer,
            options,
            plane: Plane::new(&header.coordinates),
            clipper: options.mask.as_ref().map(|mask| Clipper::new(mask)),
            levels_with_lines: HashSet::new(),
            stats: Stats::default(),
        }
    }

    /// The memory of the mask, and of levels that have lines.
    pub(super) fn bytes(&self) -> u64 {
        let of_mask = self.clipper.as_ref().map_or(0, Clipper::bytes);
        of_mask + 10 * self.levels_with_lines.capacity() as u64
    }

    /// Writes lines, and takes them from the list.
    pub(super) fn write<P: Place>(&mut self, complete: &mut Vec<Contour<P>>) -> Result<()> {
        for Contour { level, points, is_closed, is_depression } in complete.drain(..) {
            let mut points = P::line(points, is_closed, &self.plane);
            if !canonical::tidy(&mut points, is_closed) {
                self.stats.single_points += 1;
                continue;
            }
            points.iter_mut().for_each(|place| *place = self.plane.to_world(*place));
            match &self.clipper {
                None => self.line(level, &points, [is_closed, is_depression])?,
                Some(clipper) => {
                    for (part, is_closed) in clipper.clip(&points, is_closed) {
                        // Of a part, a mesh of its surroundings would not tell.
                        self.line(level, &part, [is_closed, is_closed && is_depression])?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Writes a line in world coordinates, unless it is short. It is closed or not, and a depression or not.
    fn line(&mut self, level: i64, points: &[Point2], [is_closed, is_depression]: [bool; 2]) -> Result<()> {
        if self.options.min_length.is_some_and(|least| length(points, is_closed) < least) {
            self.stats.short += 1;
            return Ok(());
        }
        self.levels_with_lines.insert(level);
        self.stats.lines += 1;
        self.stats.rings += u64::from(is_closed);
        self.stats.depressions += u64::from(is_depression);
        self.stats.points += points.len() as u64;
        let is_index = level.rem_euclid(i64::from(self.options.index.max(1))) == 0;
        let again = is_closed.then(|| points[0]);
        let places = points.iter().copied().chain(again);
        let truths = [("is_closed", is_closed), ("index", is_index), ("depression", is_depression)];
        self.writer.line(self.options.levels.elevation(level), truths, places)
    }
}

/// The length of a line; that of a ring includes the way back to its first point.
fn length(points: &[Point2], is_closed: bool) -> f64 {
    let distance = |p: Point2, q: Point2| (q[0] - p[0]).hypot(q[1] - p[1]);
    let back = if is_closed { distance(points[points.len() - 1], points[0]) } else { 0.0 };
    points.windows(2).map(|pair| distance(pair[0], pair[1])).sum::<f64>() + back
}
