//! `spdem --contours`: triangles in, contour lines out.
//!
//! `levels` numbers the elevations that have lines, and ranks each vertex among them. From the ranks,
//! `crossings` finds the edges of a triangle that a line passes, in integers; `places` computes where.
//! `open_lines` joins the pieces of adjacent triangles. `smooth` smooths complete lines on demand. A complete
//! line gets its canonical form from `canonical`; `clip` cuts it at a mask, and `geojson` writes it. `drain`
//! does all this. `decimals` computes with numbers as people write them.

mod canonical;
mod clip;
mod crossings;
mod decimals;
mod drain;
mod geojson;
mod levels;
mod open_lines;
mod places;
mod smooth;

use std::io::{Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

pub use geojson::LineFormat;
pub use levels::Levels;

use crate::surface::{check_input, is_counterclockwise};
use clip::Clipper;
use crossings::Side;
use drain::Drain;
use geojson::LineWriter;
use open_lines::OpenLines;
use places::{Elevations, Plane, Vertex};
use smooth::{Place, Slide};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{CONTOURS_PER_TRIANGLE_MAX, CONTOURS_PER_TRIANGLE_MEAN_MAX};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2};
use spmesh_formats::outline::{ConcaveOutline, EdgeLimit, Waiting};
use spmesh_formats::source::Mask;
use spmesh_stream::model::bounds::Bounds;
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
    /// Triangles outside of the concave outline are left out, as in `dem`. Units: those of the world.
    pub concave: Option<f64>,
    /// Bytes for triangles that wait for the outline; further ones wait in a temporary file.
    pub memory: u64,
    /// Bytes for live vertices and open lines, if there is a limit.
    pub lines_memory: Option<u64>,
    /// The folder of the temporary file.
    pub temp_dir: Option<PathBuf>,
    /// Lines are clipped to these polygons.
    pub mask: Option<Arc<Mask>>,
    /// Shorter lines are left out. Units: those of the world.
    pub min_length: Option<f64>,
    /// Every line at a multiple of this many intervals from the base is an index line.
    pub index: u32,
    /// Whether lines are smoothed.
    pub is_smooth: bool,
}

impl Options {
    /// Plain lines at some levels: all of them, with every fifth as index line.
    pub fn new(levels: Levels) -> Options {
        Options {
            levels,
            kill: None,
            points: None,
            concave: None,
            memory: 1 << 28,
            lines_memory: None,
            temp_dir: None,
            mask: None,
            min_length: None,
            index: 5,
            is_smooth: false,
            crs: None,
        }
    }

    /// The closed box of the world whose triangles decide the lines, in a mesh of which only these may be
    /// read; `None` if all triangles do.
    ///
    /// A line follows triangle by triangle, and is cut at the mask. What a smoothed line is like depends on
    /// all of its points, where it is cut on the order of all triangles, and a concave outline on the border
    /// of the mesh.
    pub fn window(&self) -> Option<Bounds> {
        let needs_all = self.is_smooth || self.points.is_some() || self.concave.is_some();
        self.mask.as_ref().filter(|_| !needs_all).and_then(|mask| mask.window(0.0))
    }
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
    /// Triangles outside of the concave outline.
    pub outside: u64,
    /// The high-water mark of live vertices.
    pub width: u64,
    /// Levels that have lines.
    pub levels: u64,
    /// Lines, rings included.
    pub lines: u64,
    /// Closed lines.
    pub rings: u64,
    /// Closed lines around lower ground.
    pub depressions: u64,
    /// Points of lines; the point at which a ring starts and ends counts once.
    pub points: u64,
    /// Lines left out because all of their points coincide.
    pub single_points: u64,
    /// Lines left out because they are short.
    pub short: u64,
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
/// Smoothed lines are within 0.45 intervals of their level, and cross neither each other nor themselves.
///
/// Memory: the live vertices, the open lines, 16 bytes for each point or 48 if lines are smoothed, and those
/// of [`ConcaveOutline`].
///
/// # Errors
/// If the input is not a triangle mesh with elevations, is malformed or truncated; if levels are too close to
/// each other; if vertices and lines exceed their memory; if writing fails.
pub fn contour<R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    output: W,
    format: LineFormat,
    options: &Options,
    progress: impl FnMut(u64),
) -> Result<Stats> {
    if options.is_smooth {
        contour_with::<Slide, _, _>(reader, output, format, options, progress)
    } else {
        contour_with::<Point2, _, _>(reader, output, format, options, progress)
    }
}

/// As [`contour`], with points of some kind.
fn contour_with<P: Place, R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    output: W,
    format: LineFormat,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    check_input(&header, true).map_err(|e| e.of_input(reader.name()))?;
    let lines_memory = options.lines_memory.unwrap_or(u64::MAX);
    options.mask.as_ref().map_or(Ok(()), |mask| Clipper::check(mask, lines_memory))?;
    let mut tracer = Tracer::<P>::new(&header, options);
    let crs = options.crs.as_ref().unwrap_or(&header.crs);
    let mut drain = Drain::new(&header, LineWriter::new(output, format, crs), options);
    let mut live = LiveVertices::within(lines_memory);
    while let Some(event) = reader.next_event()? {
        if let Event::Patch(patch) = event {
            tracer.lines.bytes_max = lines_memory.saturating_sub(live.bytes() + drain.bytes());
            let triangles = tracer.corners(&patch, &mut live).map_err(|error| reader.locate(error))?;
            for triangle in triangles {
                tracer.take(triangle).map_err(|error| reader.locate(error))?;
                drain.write(&mut tracer.lines.complete)?;
            }
            if tracer.lines.is_sweep_due() {
                let outline = tracer.outline.as_ref();
                let is_waiting = |vertex| outline.is_some_and(|outline| outline.holds(vertex));
                tracer.lines.finish_ended(|vertex| live.contains(vertex) || is_waiting(vertex));
                drain.write(&mut tracer.lines.complete)?;
            }
            progress(reader.totals().vertices);
        }
    }
    if let Some(outline) = tracer.outline.take() {
        let mut inside = outline.finish()?;
        tracer.outside = inside.outside;
        while let Some(triangle) = inside.next_triangle()? {
            tracer.trace_again(&triangle)?;
            drain.write(&mut tracer.lines.complete)?;
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
        outside: tracer.outside,
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
struct Tracer<P> {
    levels: Levels,
    plane: Plane,
    to_world: Elevations,
    long_edges: EdgeLimit,
    predicates: FiniteFloatPredicates,
    lines: OpenLines<P>,
    /// Finds the triangles outside of the concave outline.
    outline: Option<ConcaveOutline>,
    killed: u64,
    outside: u64,
    /// Triangles and pieces of lines so far.
    triangles: u64,
    pieces: u64,
    elevations: Option<[f64; 2]>,
}

impl<P: Place> Tracer<P> {
    fn new(header: &Header, options: &Options) -> Tracer<P> {
        Tracer {
            levels: options.levels,
            plane: Plane::new(&header.coordinates),
            to_world: Elevations::new(&header.coordinates),
            long_edges: EdgeLimit::new(options.kill, &header.coordinates),
            predicates: FiniteFloatPredicates::default(),
            lines: OpenLines::new(options.points.map_or(usize::MAX, |points| points.max(2))),
            outline: options.concave.map(|length| {
                let temp_dir = options.temp_dir.as_deref();
                ConcaveOutline::new(length, &header.coordinates, options.memory, temp_dir).with_vertices()
            }),
            killed: 0,
            outside: 0,
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
    ) -> Result<impl Iterator<Item = [&'a Vertex; 3]> + use<'a, P>> {
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
            None => Ok(patch.triangles().map(|triangle| triangle.map(|local| &vertices[local as usize].1))),
        }
    }

    /// Adds the pieces of all lines in a triangle, or keeps it if it may be outside of the outline.
    fn take(&mut self, corners: [&Vertex; 3]) -> Result<()> {
        if self.outline.is_some() && self.keeps(corners)? { Ok(()) } else { self.trace(corners) }
    }

    /// Keeps a triangle if it may be outside of the outline, and returns whether it did.
    fn keeps(&mut self, corners: [&Vertex; 3]) -> Result<bool> {
        let Some(outline) = &mut self.outline else { return Ok(false) };
        let triangle = Waiting {
            ids: corners.map(|corner| corner.id),
            corners: corners.map(|&Vertex { at: [x, y], elevation, .. }| [x, y, elevation]),
            number: 0,
        };
        outline.take(corners.map(|corner| corner.at), triangle)
    }

    /// Adds the pieces in a triangle that was kept.
    fn trace_again(&mut self, Waiting { ids, corners, .. }: &Waiting) -> Result<()> {
        let vertex = |i: usize| {
            let [x, y, elevation] = corners[i];
            let rank = self.levels.rank(elevation)?;
            Ok(Vertex { id: ids[i], at: [x, y], elevation, rank })
        };
        let corners = [vertex(0)?, vertex(1)?, vertex(2)?];
        self.trace(corners.each_ref())
    }

    /// Adds the pieces of all lines in a triangle.
    fn trace(&mut self, corners: [&Vertex; 3]) -> Result<()> {
        let places = || corners.map(|corner| corner.at);
        self.triangles += 1;
        if self.long_edges.is_limited() && self.long_edges.is_exceeded(places()) {
            self.killed += 1;
            return Ok(());
        }
        let levels = crossings::levels(corners);
        if levels.is_empty() {
            return Ok(());
        }
        self.count_pieces(levels.end().abs_diff(*levels.start()).saturating_add(1))?;
        // A triangle that is degenerate in the plane still passes lines on, so only the error matters.
        is_counterclockwise(places(), &mut self.predicates)?;
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
    fn add(&mut self, corners: [&Vertex; 3], level: i64) -> Result<()> {
        let piece = crossings::piece(corners, level);
        let edges = [piece.from, piece.to].map(|edge| crossings::ends(corners, edge));
        let elevation = self.levels.elevation(level);
        let place = |side: usize| P::of(&self.plane, edges[side], elevation, self.levels.interval());
        let least = Side::least(corners, level);
        self.lines.add(edges.map(|edge| crossings::crossing(edge, level)), least, place)
    }
}
