//! Breaklines: from lines in files to a planar network on the grid of a stream.
//!
//! Steps: `spmesh_formats` reads the lines; their systems are compared with that of the points; gaps in
//! elevations are filled and long parts divided (`prepare`); coordinates are rounded to the grid of the
//! stream (`grid`); and `spmesh_delaunay::noding` makes crossings and overlaps common vertices.

mod areas;
mod banks;
mod changes;
mod cut;
mod features;
mod grid;
mod layer;
mod levels;
mod numbered;
mod prepare;
mod reach;
mod report;
mod rivers;
mod sections;
mod stated;
mod stations;
mod water;

use std::borrow::Cow;
use std::sync::Arc;

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::{LINE_CROSSINGS_MAX, LINE_VERTEX_BYTES, check_line_vertices};
use spmesh_delaunay::network::{Network, NetworkVertex};
use spmesh_delaunay::noding::{LineVertex, Noded, NodingOptions, node_lines};
use spmesh_formats::source::{Breaklines, Description, Reading, name_of, read_breaklines};
use spmesh_stream::{Coordinates, Crs, Header};

use areas::Role;
pub use areas::{Areas, Sources};
pub use changes::{Change, ChangeKind, Changes};
use grid::Grid;
pub(crate) use layer::Layer;
pub use layer::Shore;
pub use levels::Levels;
pub(crate) use levels::{MEDIAN, Near};
use numbered::Bent;
use numbered::numbered;
pub use report::write_report;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;
pub use stated::{ABOUT_FAR, is_far};
pub(crate) use stations::project;
pub use water::{Water, WaterPolygon};

/// The stream that lines are for.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Encoding of its coordinates.
    pub coordinates: Coordinates,
    /// Its system.
    pub crs: Crs,
    /// Whether its points have elevations. If not, those of lines are ignored.
    pub has_elevation: bool,
}

impl Target {
    /// The target of lines for a stream with this header.
    pub fn of(header: &Header) -> Target {
        let Header { coordinates, has_elevation, ref crs, .. } = *header;
        Target { coordinates, crs: crs.clone(), has_elevation }
    }

    /// The target of lines for these points.
    pub(crate) fn of_points(points: &Description) -> Target {
        let Description { coordinates, has_elevation, ref crs, .. } = *points;
        Target { coordinates, crs: crs.clone(), has_elevation }
    }
}

/// How lines are read.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Longest part of a line, in world units; longer parts are divided evenly.
    pub densify: Option<f64>,
    /// Whether changes are listed, and not counted alone.
    pub lists_changes: bool,
    /// Name of a property of lines that states their elevation.
    pub elevation: Option<Arc<str>>,
    /// Whether points with elevations among the lines are taken, and no lines of one vertex.
    pub takes_points: bool,
    /// So many vertices memory has room for, in all files.
    pub vertices_max: usize,
    /// Only what decides the network and the water in this closed box is read. Units: those of the world.
    pub reach: Option<[Point2; 2]>,
}

impl Options {
    /// The same for memory of so many bytes.
    #[must_use]
    pub fn within(self, bytes: u64) -> Options {
        Options { vertices_max: Reading::within(bytes).vertices_max, ..self }
    }
}

impl Default for Options {
    fn default() -> Self {
        Options {
            densify: None,
            lists_changes: false,
            elevation: None,
            takes_points: false,
            vertices_max: usize::MAX,
            reach: None,
        }
    }
}

/// Lines, and what was made of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lines {
    /// All lines as one network.
    pub network: Network,
    /// Points among the lines, as stored, if they are asked for; the lowest one of each place.
    pub points: Vec<Point>,
    /// The polygons to cut the mesh with.
    pub areas: Areas,
    /// Lakes and rivers.
    pub water: Water,
    /// What was changed about lines.
    pub changes: Changes,
}

/// Reads the lines of files as one network. Lines are numbered over all files, in their order. Rings of
/// areas, shores, banks and centre lines are lines, too. Between the ends of two banks of a river are lines
/// behind all others.
///
/// The network depends on the set of lines alone, but for the numbers of lines. Its coordinates are those
/// that the stream stores. If these are f64, they are rounded to decimals: as many places as leave fewer than
/// 2^42 steps up to the greatest magnitude of the lines, 6 for coordinates in millions.
///
/// # Errors
/// Those of reading; usage, if the system of a file differs from that of the stream, a coordinate is beyond
/// the grid of the stream, or there is water and points have no elevation; memory, if there are more vertices
/// than `options` allow; malformed, if there are too many vertices or crossings, an area has no polygon, a
/// feature of water is neither a polygon nor the centre line or a bank of a river, or banks bound no area.
pub fn read(sources: &Sources, target: &Target, options: &Options) -> Result<Lines> {
    if options.densify.is_some_and(|longest| !(longest > 0.0 && longest.is_finite())) {
        return Err(Error::usage("--densify, the longest part of a line, must be a positive number"));
    }
    let mut changes = Changes::new(options.lists_changes);
    let (mut files, mut left) = (Vec::new(), options.vertices_max);
    for (role, path) in sources.files() {
        let elevation = options.elevation.clone().filter(|_| role == Role::Lines);
        let mut file = read_breaklines(path, &Reading { vertices_max: left, elevation, label: None })?;
        left -= file.lines.iter().map(|line| line.vertices.len()).sum::<usize>().min(left);
        let name = name_of(path);
        changes.notices.extend(file.system.check(&name, &target.crs)?);
        changes.notices.extend(file.layers.clone());
        if role == Role::Water {
            file.check_properties().map_err(|error| error.of_input(&name))?;
        }
        if !target.has_elevation {
            file.lines.iter_mut().for_each(|line| line.elevations.fill(None));
        }
        files.push((role, name, file));
    }
    check_elevations(&files, options.elevation.as_deref())?;
    banks::close(&mut files);
    let grid = Grid::of(target, files.iter().flat_map(|(_, _, file)| &file.lines));
    changes.notices.extend(grid.notice());
    if let Some(reach) = options.reach {
        reach::leave_out(&mut files, reach, world_step(target, &grid));
    }
    let noting = |error| files.iter().fold(error, |error, (_, _, file)| file.noting_layers(error));
    let rings = areas::rings(&files).map_err(noting)?;
    let shores = areas::shores(&files);
    let features = features::features(&files, target).map_err(noting)?;
    let points = if options.takes_points { mass_points(&files, &grid, &mut changes)? } else { Vec::new() };
    let files = files.into_iter().map(|(_, name, file)| (name, file)).collect();
    let (vertices, starts) = stored(files, &grid, options, &mut changes)?;
    let noding = noding(target, options.vertices_max.saturating_sub(vertices.len()));
    let mut note = |change, line, place| changes.note(ChangeKind::of(change), line, || grid.world(place));
    if rings.is_empty() && features.is_empty() {
        let noded = node_lines(Cow::Owned(vertices), &starts, &noding, &mut note).map_err(refused)?;
        let areas = Areas { shores, ..Areas::default() };
        return Ok(Lines { network: network(noded, &grid), points, areas, changes, ..Lines::default() });
    }
    let noded = node_lines(Cow::Borrowed(&vertices), &starts, &noding, &mut note).map_err(refused)?;
    let bent = Bent::new(&noded, &vertices, &starts);
    let (mut areas, water) = (areas::areas(&rings, &bent)?, water::water(&features, &bent, &grid)?);
    areas.shores = shores;
    Ok(Lines { network: network(noded, &grid), points, areas, water, changes })
}

/// The step of the grid in the world.
fn world_step(target: &Target, grid: &Grid) -> f64 {
    match target.coordinates {
        Coordinates::I32 { scale, .. } => scale[0].max(scale[1]),
        Coordinates::F64 => grid.step(),
    }
}

/// Checks that some line has the property of elevations: its name may be misspelt.
fn check_elevations(files: &[(Role, String, Breaklines)], name: Option<&str>) -> Result<()> {
    let Some(name) = name else { return Ok(()) };
    let states = |(.., file): &(Role, String, Breaklines)| {
        file.lines.iter().any(|line| line.properties.elevation.is_some())
    };
    if files.iter().any(states) {
        return Ok(());
    }
    let message = format!("no line has the property {name:?} of --z-field");
    Err(Error::usage(message).of_input(files.first().map_or("", |(_, file, _)| file)))
}

/// The points of `--lines` that have an elevation, as stored, by place; the lowest of each place.
fn mass_points(
    files: &[(Role, String, Breaklines)],
    grid: &Grid,
    changes: &mut Changes,
) -> Result<Vec<Point>> {
    let mut points = Vec::new();
    for it in numbered(files).filter(|it| it.role == Role::Lines && it.line.is_point) {
        if let Some(z) = it.line.elevations[0] {
            let vertex = grid.vertex(it.line.vertices[0], Some(z), it.number, changes);
            let vertex = vertex.map_err(|error| error.at(&*it.line.position).of_input(it.file))?;
            let [x, y] = grid.stored(vertex.place);
            points.push([x, y, vertex.z.unwrap_or(z)]);
        }
    }
    points.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup_by_key(|point| [point[0].to_bits(), point[1].to_bits()]);
    Ok(points)
}

/// How lines are noded, in memory that has room for so many more vertices.
fn noding(target: &Target, vertices_left: usize) -> NodingOptions {
    NodingOptions {
        round_elevations: matches!(target.coordinates, Coordinates::I32 { .. }),
        crossings_max: LINE_CROSSINGS_MAX,
        bytes_max: LINE_VERTEX_BYTES.saturating_mul(vertices_left as u64),
    }
}

/// Lines that cannot be noded.
fn refused(cause: spmesh_delaunay::Error) -> Error {
    let error = Error::of_computation(cause);
    if error.kind() == ErrorKind::Memory {
        error.noting("raise --memory, or give fewer lines at once")
    } else {
        error
    }
}

/// The vertices of all lines on the grid, and the number of the first one of each line.
fn stored(
    files: Vec<(String, Breaklines)>,
    grid: &Grid,
    options: &Options,
    changes: &mut Changes,
) -> Result<(Vec<LineVertex>, Vec<u32>)> {
    let (mut vertices, mut starts) = (Vec::new(), Vec::new());
    for (name, file) in files {
        for line in file.lines {
            let number = starts.len() as u32;
            starts.push(vertices.len() as u32);
            if options.takes_points && line.is_point && line.elevations[0].is_some() {
                continue;
            }
            let position = line.position.clone();
            let fault = |error: Error| error.at(&*position).of_input(name.clone());
            let line = prepare::prepare(line, number, options, changes).map_err(fault)?;
            check_line_vertices(vertices.len() + line.len(), options.vertices_max).map_err(|error| {
                match options.densify {
                    Some(_) => fault(error.noting("divide parts less: --densify")),
                    None => fault(error),
                }
            })?;
            let first = vertices.len();
            for &(place, z) in &line {
                vertices.push(grid.vertex(place, z, number, changes).map_err(fault)?);
            }
            grid.check_length(&line, &vertices[first..]).map_err(fault)?;
        }
    }
    Ok((vertices, starts))
}

fn network(noded: Noded, grid: &Grid) -> Network {
    let vertex = |vertex: LineVertex| NetworkVertex { place: grid.stored(vertex.place), z: vertex.z };
    let vertices = noded.vertices.into_iter().map(vertex).collect();
    Network { vertices, segments: noded.segments, step: grid.step() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noding itself is tested with fewer crossings, at both sides.
    #[test]
    fn crossings_are_limited() {
        let target = Target { coordinates: Coordinates::F64, crs: Crs::Unknown, has_elevation: true };
        assert_eq!(noding(&target, 0).crossings_max, LINE_CROSSINGS_MAX);
    }

    #[test]
    fn memory_has_room_for_vertices() {
        assert_eq!(Options::default().within(8 * LINE_VERTEX_BYTES - 1).vertices_max, 7);
    }
}
