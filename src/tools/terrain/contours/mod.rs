//! `spdem --contours`: triangles in, contour lines out.
//!
//! `levels` numbers the elevations that have lines, and ranks each vertex among them. From the ranks,
//! `crossings` finds the edges of a triangle that a line passes, in integers; `places` computes where.
//! `open_lines` joins the pieces of adjacent triangles. A complete line gets its canonical form from
//! `canonical`, and `geojson` writes it. `decimals` computes with numbers as people write them.

mod canonical;
mod crossings;
mod decimals;
mod geojson;
mod levels;
mod open_lines;
mod places;

use std::io::{Read, Write};

use foldhash::{HashSet, HashSetExt};

pub use geojson::{LineFormat, epsg_code};
pub use levels::Levels;

use crate::surface::{LongEdges, check_input, is_counterclockwise};
use geojson::LineWriter;
use open_lines::{Contour, OpenLines};
use places::{Elevations, Plane, Vertex};
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::{CONTOURS_PER_TRIANGLE_MAX, CONTOURS_PER_TRIANGLE_MEAN_MAX};
use spmesh_geometry::predicates::FiniteFloatPredicates;
use spmesh_stream::{Crs, Event, Header, LiveVertices, Patch, StreamReader};

/// The lines to make.
#[derive(Debug, Clone)]
pub struct Options {
    /// The elevations that have lines.
    pub levels: Levels,
    /// Triangles with a longer edge are left out. Units: those of the world.
    pub kill: Option<f64>,
    /// An incomplete line with this many points, at least two, is cut: it is written, and a new line starts
    /// at its ends. Lines are not cut if `None`.
    pub points: Option<usize>,
    /// The coordinate reference system, if not that of the mesh.
    pub crs: Option<Crs>,
}

/// Counts of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stats {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles left out because of a long edge.
    pub killed: u64,
    /// The high-water mark of live vertices.
    pub width: u64,
    /// Levels that have lines.
    pub levels: u64,
    /// Lines, rings included.
    pub lines: u64,
    /// Closed lines.
    pub rings: u64,
    /// Points of lines; the point at which a ring starts and ends counts once.
    pub points: u64,
    /// Lines left out because all of their points coincide.
    pub single_points: u64,
    /// Number of cuts.
    pub cuts: u64,
    /// The high-water mark of points of open lines.
    pub open_points: u64,
    /// The high-water mark of open ends.
    pub open_ends: u64,
    /// Bytes read.
    pub input_bytes: u64,
    /// The least and the greatest elevation, if there are vertices.
    pub elevations: Option<[f64; 2]>,
}

/// Writes the contour lines of a triangle mesh with elevations; calls `progress` with the number of vertices
/// read.
///
/// A vertex on a level counts as above it. So a line passes two edges of a triangle or none, and lines end
/// only at the border of the mesh. A flat region on a level has no line inside; a line runs along it where
/// the ground beyond is lower. Higher ground is on the left of a line.
///
/// Unless lines are cut, each is the same for any order of triangles, bit for bit. Lines are written in the
/// order in which they become complete. Coordinates are those of the world; integer coordinates get two
/// digits more than their step. Successive equal points are merged.
///
/// Memory: the live vertices, and the open lines, 16 bytes for each point.
///
/// # Errors
/// If the input is not a triangle mesh with elevations, is malformed or truncated; if levels are too close to
/// each other; if writing fails.
pub fn contour<R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    output: W,
    format: LineFormat,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    check_input(&header, true).map_err(|e| e.of_input(reader.name()))?;
    let mut tracer = Tracer::new(&header, options);
    let crs = options.crs.as_ref().unwrap_or(&header.crs);
    let mut drain = Drain::new(&header, LineWriter::new(output, format, crs), options.levels);
    let mut live = LiveVertices::new();
    while let Some(event) = reader.next_event()? {
        if let Event::Patch(patch) = event {
            let triangles = tracer.corners(&patch, &mut live).map_err(|error| reader.locate(error))?;
            for triangle in triangles {
                tracer.trace(&triangle).map_err(|error| reader.locate(error))?;
                drain.write(&mut tracer.lines.complete)?;
            }
            if tracer.lines.is_sweep_due() {
                tracer.lines.finish_ended(|vertex| live.contains(vertex));
                drain.write(&mut tracer.lines.complete)?;
            }
            progress(reader.totals().vertices);
        }
    }
    tracer.lines.finish_ended(|_| false);
    drain.write(&mut tracer.lines.complete)?;
    drain.writer.end()?;
    let totals = reader.totals();
    Ok(Stats {
        vertices: totals.vertices,
        triangles: totals.simplices,
        killed: tracer.killed,
        width: live.live_max() as u64,
        levels: drain.levels_with_lines.len() as u64,
        cuts: tracer.lines.cuts,
        open_points: tracer.lines.points_max as u64,
        open_ends: tracer.lines.ends_max as u64,
        input_bytes: reader.bytes_read(),
        elevations: tracer.elevations,
        ..drain.stats
    })
}

/// Follows lines through triangles.
struct Tracer {
    levels: Levels,
    plane: Plane,
    to_world: Elevations,
    long_edges: LongEdges,
    predicates: FiniteFloatPredicates,
    lines: OpenLines,
    killed: u64,
    /// Triangles and pieces of lines so far.
    triangles: u64,
    pieces: u64,
    elevations: Option<[f64; 2]>,
}

impl Tracer {
    fn new(header: &Header, options: &Options) -> Tracer {
        Tracer {
            levels: options.levels,
            plane: Plane::new(&header.coordinates),
            to_world: Elevations::new(&header.coordinates),
            long_edges: LongEdges::new(options.kill, &header.coordinates),
            predicates: FiniteFloatPredicates::default(),
            lines: OpenLines::new(options.points.map_or(usize::MAX, |points| points.max(2))),
            killed: 0,
            triangles: 0,
            pieces: 0,
            elevations: None,
        }
    }

    /// The corners of the triangles of a patch.
    fn corners<'a>(
        &mut self,
        patch: &'a Patch,
        live: &'a mut LiveVertices<Vertex>,
    ) -> Result<impl Iterator<Item = [Vertex; 3]> + use<'a>> {
        let mut failure = None;
        let vertices = live.enter(patch, |id, [x, y, z]| {
            let elevation = self.to_world.to_world(z);
            let [least, greatest] = self.elevations.unwrap_or([elevation; 2]);
            self.elevations = Some([least.min(elevation), greatest.max(elevation)]);
            let rank = self.levels.rank(elevation).unwrap_or_else(|error| {
                failure.get_or_insert(error);
                0
            });
            Vertex { id, at: [x, y], elevation, rank }
        })?;
        match failure {
            Some(error) => Err(error),
            None => Ok(patch.triangles().map(|triangle| triangle.map(|local| vertices[local as usize].1))),
        }
    }

    /// Adds the pieces of all lines in a triangle.
    fn trace(&mut self, corners: &[Vertex; 3]) -> Result<()> {
        let places = corners.map(|corner| corner.at);
        self.triangles += 1;
        if self.long_edges.are_in(places) {
            self.killed += 1;
            return Ok(());
        }
        let levels = crossings::levels(corners);
        if levels.is_empty() {
            return Ok(());
        }
        self.count_pieces(levels.end().abs_diff(*levels.start()).saturating_add(1))?;
        // A triangle that is degenerate in the plane still passes lines on, so only the error matters.
        is_counterclockwise(places, &mut self.predicates)?;
        levels.into_iter().try_for_each(|level| self.add(corners, level))
    }

    /// Counts the levels that pass through a triangle.
    fn count_pieces(&mut self, count: u64) -> Result<()> {
        if count > CONTOURS_PER_TRIANGLE_MAX {
            return Err(Error::usage(format!(
                "{count} levels pass through one triangle, at most {CONTOURS_PER_TRIANGLE_MAX} may: take a \
                 larger distance"
            )));
        }
        self.pieces += count;
        if self.pieces > CONTOURS_PER_TRIANGLE_MAX + CONTOURS_PER_TRIANGLE_MEAN_MAX * self.triangles {
            return Err(Error::usage(format!(
                "{} pieces of lines in the first {} triangles, at most {CONTOURS_PER_TRIANGLE_MEAN_MAX} per \
                 triangle may be there on average: take a larger distance",
                self.pieces, self.triangles
            )));
        }
        Ok(())
    }

    /// Adds the piece of the line of a level in a triangle.
    fn add(&mut self, corners: &[Vertex; 3], level: i64) -> Result<()> {
        let piece = crossings::piece(corners, level);
        let edges = [piece.from, piece.to].map(|edge| crossings::ends(corners, edge));
        let elevation = self.levels.elevation(level);
        let place = |side: usize| {
            let [p, q] = edges[side];
            self.plane.place(p, q, elevation)
        };
        self.lines.add(edges.map(|edge| crossings::crossing(edge, level)), place)
    }
}

/// Writes complete lines, and counts them.
struct Drain<W> {
    writer: LineWriter<W>,
    levels: Levels,
    plane: Plane,
    levels_with_lines: HashSet<i64>,
    stats: Stats,
}

impl<W: Write> Drain<W> {
    fn new(header: &Header, writer: LineWriter<W>, levels: Levels) -> Drain<W> {
        let plane = Plane::new(&header.coordinates);
        Drain { writer, levels, plane, levels_with_lines: HashSet::new(), stats: Stats::default() }
    }

    fn write(&mut self, complete: &mut Vec<Contour>) -> Result<()> {
        for Contour { level, mut points, is_closed } in complete.drain(..) {
            if !canonical::tidy(&mut points, is_closed) {
                self.stats.single_points += 1;
                continue;
            }
            self.levels_with_lines.insert(level);
            self.stats.lines += 1;
            self.stats.rings += u64::from(is_closed);
            self.stats.points += points.len() as u64;
            let again = is_closed.then(|| points[0]);
            let places = points.iter().copied().chain(again).map(|place| self.plane.to_world(place));
            self.writer.line(self.levels.elevation(level), is_closed, places)?;
        }
        Ok(())
    }
}
