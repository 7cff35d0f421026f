//! Breaklines in a triangle mesh that streams: segments become edges, and the rest stays Delaunay.
//!
//! A triangle of the Delaunay triangulation that no segment divides, and whose circle contains no new vertex,
//! is a triangle of the constrained Delaunay triangulation, because its circle is empty of all vertices. Such
//! triangles pass at once. The others wait (`held`) until all that they are triangulated anew with have come
//! (`strip`).
//!
//! `near` says what of the lines a triangle meets, with the help of `cells`; `clip` ends lines at the border
//! of the mesh; `writing` makes patches.

mod cells;
mod circle;
mod clip;
mod cut;
mod divided;
mod held;
mod hull;
mod leaving;
mod near;
mod pyramid;
mod strip;
mod writing;

use std::io::{Read, Write};

use cut::Cut;
pub use cut::CutOptions;
use held::{Held, Holding};
use leaving::Rings;
use near::Lines;
use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_delaunay::network::Network;
use spmesh_pipeline::lines::{Areas, is_far};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{
    Constrained, Coordinates, Event, Header, LiveVertices, Patch, StreamReader, StreamWriter, check_surface,
};
use writing::Writing;

/// How the output is written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Compress blocks.
    pub compress: bool,
    /// How the border is cut.
    pub cut: CutOptions,
    /// For lines, vertices that are not final, and triangles that wait; unlimited if `None`. Units: bytes.
    pub memory: Option<u64>,
}

/// Counts of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stats {
    /// Triangles of the input, and of the output.
    pub triangles: [u64; 2],
    /// Segments of the network.
    pub segments: u64,
    /// Segments that are not wholly edges because they leave the mesh.
    pub open_segments: u64,
    /// Segments that were added beside these, since clipped parts of lines are off them by rounding.
    pub clipped: u64,
    /// Vertices that were added where segments leave the mesh.
    pub ends: u64,
    /// Other segments that are not wholly edges because the triangles on both sides were cut off.
    pub cut_segments: u64,
    /// Vertices of the network that the mesh had.
    pub found: u64,
    /// Vertices of the network that were added to the mesh.
    pub added: u64,
    /// Vertices of the network or on it whose stated elevation is far from that of the mesh.
    pub far: u64,
    /// Vertices of the network outside of the mesh.
    pub outside: u64,
    /// Vertices of the mesh that took the elevation of a line.
    pub raised: u64,
    /// Triangles that were cut off.
    pub removed: u64,
    /// Triangles that stay whole though the ring of an area divides them where it leaves the mesh.
    pub divided: u64,
    /// Triangles that waited.
    pub held: u64,
    /// Components of triangles that waited.
    pub strips: u64,
    /// The most triangles that waited at once.
    pub held_max: u64,
}

/// Makes the segments of `network` edges of a triangle mesh, and writes the mesh to `output`. Calls
/// `progress` with the number of vertices done.
///
/// Vertices of the network that the mesh does not have are added to it, if they are inside of its triangles.
/// Those without an elevation get that of the surface there. Vertices that the mesh has on a line, also amid
/// a segment, take the elevation of the line, if it states one.
///
/// Memory: the network and its cells, about 60 bytes for a segment; live vertices; and triangles that wait.
///
/// # Errors
/// Usage, if the input is no triangle mesh or is constrained already; malformed, if it breaks a rule, if a
/// triangle is not counterclockwise, or if segments cross; memory, if more is needed than `options` allow;
/// I/O.
pub fn constrain<R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    network: &Network,
    areas: &Areas,
    output: W,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(W, Stats)> {
    check(reader.header())?;
    let coordinates = reader.header().coordinates;
    let of_lines =
        VERTEX_BYTES * network.vertices.len() as u64 + SEGMENT_BYTES * network.segments.len() as u64;
    let memory = options.memory.map_or(u64::MAX, |memory| memory.saturating_sub(of_lines));
    let cut = Cut::new(network, areas, &coordinates, &options.cut);
    let (is_cut, kill) = cut.claim();
    let constrained = Some(Constrained { is_cut, kill });
    let compressed = options.compress;
    let header = Header { compressed, constrained, ..header_of(reader.header(), network) };
    let rings = Rings::new(areas, network.segments.len());
    let mut filter = Filter {
        lines: Lines::new(network, &rings, &areas.shores),
        holding: Holding::default(),
        live: LiveVertices::within(memory),
        memory,
        writing: Writing::new(StreamWriter::new(output, header)?, network, cut)?,
        coordinates,
        numbers: Vec::new(),
        open: Vec::new(),
        stats: Stats { segments: network.segments.len() as u64, ..Stats::default() },
    };
    while let Some(event) = reader.next_event()? {
        match event {
            Event::Patch(patch) => {
                filter.patch(patch, reader.rows()).map_err(|error| reader.locate(error))?;
                progress(reader.totals().vertices);
            }
            Event::End(totals) => return filter.end(totals.points, totals.merged),
            _ => return Err(reader.locate(Error::usage("expected a mesh of triangles only"))),
        }
    }
    Err(reader.locate(Error::malformed("the stream has no END")))
}

fn check(header: &Header) -> Result<()> {
    check_surface(header, false)?;
    if header.constrained.is_some() {
        let message = "the mesh is constrained or cut already: give all lines and areas at once, to the \
                       mesh without them";
        return Err(Error::usage(message));
    }
    Ok(())
}

/// The header of the output. Elevations of lines may be outside of the box of the mesh.
fn header_of(header: &Header, network: &Network) -> Header {
    let elevations = network.vertices.iter().filter_map(|vertex| vertex.z);
    let bounds = header.bounds.map(|mut bounds| {
        if header.has_elevation {
            elevations.for_each(|z| {
                bounds.min[2] = bounds.min[2].min(z);
                bounds.max[2] = bounds.max[2].max(z);
            });
        }
        bounds
    });
    Header { bounds, points: None, tree: None, ..header.clone() }
}

/// A vertex of the network, and a segment with the cells that list it.
const VERTEX_BYTES: u64 = 40;
const SEGMENT_BYTES: u64 = 80;

/// A new vertex of a component that is triangulated anew, with its triangles and parts of segments.
const NEW_BYTES: u64 = 400;

struct Filter<'n, W: Write> {
    lines: Lines<'n>,
    holding: Holding,
    live: LiveVertices<Point>,
    /// For live vertices, and for triangles that wait. Units: bytes.
    memory: u64,
    writing: Writing<W>,
    coordinates: Coordinates,
    stats: Stats,
    /// For each local vertex of a patch its number in `holding`.
    numbers: Vec<Option<u32>>,
    /// Segments that are not wholly edges.
    open: Vec<u32>,
}

impl<W: Write> Filter<'_, W> {
    /// Passes on what no line changes, and writes the components that are whole now.
    fn patch(&mut self, mut patch: Patch, rows: &[u8]) -> Result<()> {
        self.stats.triangles[0] += patch.simplices.len() as u64 / 3;
        self.raise(&mut patch);
        self.numbers.clear();
        self.numbers.resize(patch.new.len(), None);
        self.numbers.extend(patch.imported.iter().map(|&id| self.holding.number(id)));
        self.divide(&mut patch)?;
        let mut finalized = std::mem::take(&mut patch.finalized);
        finalized.retain(|&local| {
            let number = self.numbers[local as usize];
            number.into_iter().for_each(|number| self.holding.finalize(number));
            number.is_none() && !self.writing.holds(patch.id(local))
        });
        patch.finalized = finalized;
        self.writing.patch(patch, rows)?;
        while let Some(triangles) = self.holding.take_whole() {
            self.strip(&triangles)?;
        }
        self.writing.flush()
    }

    /// Gives new vertices on lines the elevation of the line.
    fn raise(&mut self, patch: &mut Patch) {
        self.lines.clear();
        for point in &mut patch.new {
            let place = [point[0], point[1]];
            if !self.lines.look(place) {
                continue;
            }
            let z = match self.lines.vertex_at(place) {
                Some(vertex) => {
                    self.stats.found += 1;
                    let z = self.lines.network.vertices[vertex as usize].z;
                    self.lines.find(vertex, z.unwrap_or(point[2]));
                    z
                }
                None => self.lines.elevation_near(place).map(|z| self.coordinates.rounded(z)),
            };
            if let Some(z) = z.filter(|&z| z != point[2]) {
                self.stats.far += u64::from(is_far(&self.coordinates, z, [point[2]; 2]));
                point[2] = z;
                self.stats.raised += 1;
            }
        }
    }

    /// Takes the triangles that lines change out of a patch, and those that are cut off. Notes the sides of
    /// the others that are on segments.
    fn divide(&mut self, patch: &mut Patch) -> Result<()> {
        let locals = self.live.enter(patch, |_, point| point)?;
        self.lines.enter(locals.iter().map(|(_, [x, y, _])| [*x, *y]));
        let mut kept = 0;
        for first in (0..patch.simplices.len()).step_by(3) {
            let corners = [0, 1, 2].map(|corner| patch.simplices[first + corner]);
            let places = corners.map(|local| {
                let [x, y, _] = locals[local as usize].1;
                [x, y]
            });
            let mut on = [None; 3];
            // Most triangles are small and far from lines.
            if !self.lines.is_far(corners, places)
                && let Some(meeting) = self.lines.meeting(places)?
            {
                if meeting.changes() {
                    let numbers = corners.map(|local| {
                        let (id, point) = locals[local as usize];
                        *self.numbers[local as usize].get_or_insert_with(|| self.holding.enter(id, point))
                    });
                    self.holding.hold(numbers, meeting);
                    self.stats.held += 1;
                    if self.holding.bytes() > self.memory {
                        return Err(self.too_many(&[], 0));
                    }
                    continue;
                }
                on = meeting.on;
            }
            let ids = || corners.map(|local| locals[local as usize].0);
            if !self.writing.keeps(places, on, ids)? {
                continue;
            }
            if on != [None; 3] {
                let sides = (0..).zip(on);
                patch.sides.extend(sides.filter_map(|(place, on)| Some([kept as u32 / 3, place, on?])));
            }
            patch.simplices[kept..kept + 3].copy_from_slice(&corners);
            kept += 3;
        }
        patch.simplices.truncate(kept);
        Ok(())
    }

    /// Triangles that wait, and a component of these that is triangulated, take too much.
    fn too_many(&self, component: &[Held], new: u64) -> Error {
        let waiting = (self.holding.len() + component.len()) as u64;
        let waiting = counted(waiting, "triangle waits", "triangles wait");
        let new = counted(new, "vertex of lines is", "vertices of lines are");
        let new =
            if component.is_empty() { String::new() } else { format!(" {new} new in one part of the mesh,") };
        let room = self.memory >> 10;
        let message =
            format!("{waiting} for others that lines change,{new} and --memory has room for {room} KiB");
        Error::new(
            ErrorKind::Memory,
            format!("{message} of them: raise it, or give spfinalize the same lines"),
        )
    }

    /// Triangulates a component anew.
    fn strip(&mut self, triangles: &[Held]) -> Result<()> {
        // A vertex is listed by all triangles whose circles contain it.
        let listed: usize = triangles.iter().map(|held| held.vertices.len()).sum();
        let new = listed.min(self.lines.network.vertices.len()) as u64;
        let waiting = self.holding.bytes() + triangles.iter().map(Held::bytes).sum::<u64>();
        if waiting + NEW_BYTES * new > self.memory {
            return Err(self.too_many(triangles, new));
        }
        let first_clipped = (self.stats.segments + self.stats.clipped) as u32;
        let (lines, coordinates) = (&mut self.lines, &self.coordinates);
        let strip = strip::triangulate(triangles, &self.holding, lines, coordinates, first_clipped)?;
        self.stats.clipped += strip.clipped.len() as u64;
        self.stats.strips += 1;
        self.stats.added += strip.new.len() as u64;
        self.stats.far += strip.far;
        self.open.extend(&strip.open);
        self.stats.ends += strip.new.iter().filter(|(vertex, _)| vertex.is_none()).count() as u64;
        let ids: Vec<u64> = strip.corners.iter().map(|&corner| self.holding.vertex(corner).id).collect();
        let mut finalized = Vec::new();
        for corner in triangles.iter().flat_map(|held| held.corners) {
            let id = self.holding.vertex(corner).id;
            if self.holding.release(corner) {
                finalized.push(id);
            }
        }
        self.writing.add(&ids, &finalized, &strip);
        Ok(())
    }

    /// Ends the stream.
    fn end(mut self, points: u64, merged: u64) -> Result<(W, Stats)> {
        if !self.holding.is_empty() {
            return Err(Error::malformed("vertices of the mesh are not finalized at its end"));
        }
        let network = self.lines.network;
        let is_outside = |vertex: u32| !self.lines.is_found(vertex);
        // Without triangles, no segment has an edge, also between vertices of the mesh.
        let is_empty = self.stats.triangles[0] == 0;
        let is_open = |ends: [u32; 2]| is_empty || ends.into_iter().any(is_outside);
        let outside = (0..).zip(&network.segments).filter(|(_, segment)| is_open(segment.ends));
        self.open.extend(outside.map(|(number, _)| number));
        self.stats.outside =
            network.vertices.len() as u64 + self.stats.ends - self.stats.found - self.stats.added;
        self.stats.held_max = self.holding.triangles_max as u64;
        self.writing.end(self.open, points + self.stats.added, merged, self.stats)
    }
}
