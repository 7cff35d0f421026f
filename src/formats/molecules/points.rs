//! Points without names: every input of `spfinalize`, and the vertices of meshes.

use std::io::{Cursor, Read};
use std::path::Path;

use crate::detect::{TESS3, detect};
use crate::drivers::{Events, Format, OpenEvents};
use crate::molecules::assemblies::Assemblies;
use crate::molecules::model::{Model, Structure};
use crate::molecules::names::Names;
use crate::source::input::Input;
use crate::source::options::SourceOptions;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Kind, Totals};

/// Reads the points of a file that can be read several times.
pub(crate) fn read_file(path: &Path) -> Result<Structure> {
    read_input(&Input::open(&[path.to_path_buf()], &options())?)
}

/// Reads the points of `input`, which is copied to an unlinked temporary file. Messages call it `name`.
pub(crate) fn read_copy(input: impl Read, name: &str) -> Result<Structure> {
    read_input(&Input::copied(input, name, &options())?)
}

fn options() -> SourceOptions {
    SourceOptions { reader: &TESS3, dims: 3, holds_points: true, ..SourceOptions::default() }
}

fn read_input(input: &Input) -> Result<Structure> {
    let mut reader = input.read()?;
    let (mut points, mut batch) = (Vec::new(), Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        points.extend_from_slice(&batch);
    }
    let coordinates = input.description().coordinates;
    let mut warnings = input.notices().to_vec();
    warnings.extend(input.withheld_notice());
    if coordinates == Coordinates::F64
        && let Some(last) = numbered(&points)
    {
        warnings.push(format!(
            "x is every whole number up to {last} once: if these are numbers of points, cut them off first"
        ));
    }
    structure(points, coordinates, &input.name(), warnings)
}

/// The last number, if the first coordinates look like a column of point numbers before the coordinates: all
/// integers from 0 or 1 without a gap, in any order.
fn numbered(points: &[Point]) -> Option<usize> {
    const FEWEST: usize = 8;
    let first = points.iter().map(|point| point[0]).fold(f64::INFINITY, f64::min);
    if points.len() < FEWEST || (first != 0.0 && first != 1.0) {
        return None;
    }
    let mut has = vec![false; points.len()];
    let is_next = |point: &Point| {
        let place = point[0] - first;
        place.fract() == 0.0 && has.get_mut(place as usize).is_some_and(|has| !std::mem::replace(has, true))
    };
    points.iter().all(is_next).then(|| first as usize + points.len() - 1)
}

/// What opens an input that starts with `head` as events, if it is a tetrahedral mesh of this project.
pub(crate) fn mesh(head: &[u8]) -> Option<OpenEvents> {
    let format = detect(head).ok().filter(|format| matches!(format, Format::Stream | Format::Twin))?;
    let open = format.events()?;
    let events = open(Box::new(Cursor::new(head.to_vec())), "", 3).ok()?;
    (events.header().kind == Kind::TetrahedralMesh).then_some(open)
}

/// Reads the points or vertices of an input of events, with labels if it has any.
pub(crate) fn read_events(mut source: Events, name: &str) -> Result<Structure> {
    let coordinates = source.header().coordinates;
    let (mut all, mut labels, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    while let Some(event) = source.next_event()? {
        match event {
            Event::Points(points) => all.extend(points),
            Event::Patch(patch) => all.extend(patch.new),
            Event::Labels(next) => labels.extend(next),
            Event::End(Totals { merged: merged @ 1.., .. }) => {
                warnings.push(format!("{merged} coinciding points are one with others in the mesh"));
            }
            _ => {}
        }
    }
    // Notices of events concern the finalization of vertices, which does not matter here.
    let mut structure = structure(all, coordinates, name, warnings)?;
    structure.models[0].labels = labels;
    Ok(structure)
}

/// A structure of points without names. Messages call it `name`.
pub(crate) fn structure(
    points: Vec<Point>,
    coordinates: Coordinates,
    name: &str,
    warnings: Vec<String>,
) -> Result<Structure> {
    if points.is_empty() {
        return Err(Error::malformed("found no point").of_input(name));
    }
    Ok(Structure {
        name: name.to_string(),
        coordinates,
        models: vec![Model { number: 1, points, ..Model::default() }],
        residues: Vec::new(),
        names: Names::default(),
        assemblies: Assemblies::default(),
        space_group: None,
        warnings,
    })
}
