//! `spdem --bends`: places in flat areas at bends of contour lines, with elevations.
//!
//! In a mesh of contour lines, a triangle with three corners on one line is flat. A flat area is a set of
//! such triangles that share sides off the lines. Its other sides off the lines are exits: beyond each is a
//! triangle with one corner at another elevation. If all exits of an area lead to one elevation, the area is
//! a bend of the line around a valley or a ridge, whose ground lies between the two elevations. `skeleton`
//! finds the middle of the bend and the elevations along it.
//!
//! Each flat triangle of a bend has a side off the lines, and the middle of this side is strictly inside of
//! its circle. So with these places as further vertices, no triangle of the mesh has its corners on one line
//! there: it would have been a triangle before, with an empty circle.

mod skeleton;

use std::io::{Read, Write};

use foldhash::{HashMap, HashMapExt};

use crate::surface::check_input;
use skeleton::{Area, Exit, elevations};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::source::{collection_head, epsg_code};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::{Crs, Event, LiveVertices, StreamReader};

/// Bytes of a flat triangle with its sides, and of an exit.
const TRIANGLE_BYTES: u64 = 600;

/// A side of triangles, by the ids of its ends, the lesser first.
type Side = [u64; 2];

/// Counts of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Flat ones.
    pub flat: u64,
    /// Those in bends.
    pub in_bends: u64,
    /// Bends.
    pub bends: u64,
    /// Flat areas without exits, or whose exits lead to several elevations.
    pub left: u64,
    /// Places that were written.
    pub places: u64,
}

/// A flat triangle, with the sides that are off the lines; side i is opposite to corner i.
#[derive(Debug, Clone, Copy)]
struct Flat {
    corners: [Point; 3],
    sides: [Option<Side>; 3],
}

/// Flat triangles, and the exits of flat areas.
#[derive(Default)]
struct Found {
    flat: Vec<Flat>,
    /// By their sides: the corner beyond.
    exits: HashMap<Side, Point>,
}

/// Writes places in flat areas as GeoJSON; calls `progress` with the number of vertices read. Flat triangles
/// may take `memory` bytes.
///
/// # Errors
/// If the input is not a constrained mesh with elevations, is malformed or truncated; memory, if too many
/// triangles are flat; if writing fails.
pub fn write_bends<R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    mut output: W,
    crs: &Crs,
    memory: u64,
    progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    check_input(&header, true).map_err(|e| e.of_input(reader.name()))?;
    if header.constrained.is_none() {
        let what = "the mesh does not say which edges are on lines: make it with spconstrain --lines";
        return Err(Error::usage(what).of_input(reader.name()));
    }
    let Found { flat, exits } = read(reader, memory, progress)?;
    let mut stats =
        Stats { triangles: reader.totals().simplices, flat: flat.len() as u64, ..Stats::default() };
    let failed = |e| Error::io("writing", e);
    output.write_all(collection_head(epsg_code(crs)).as_bytes()).map_err(failed)?;
    for area in areas(&flat) {
        let triangles: Vec<Flat> = area.iter().map(|&number| flat[number]).collect();
        let places = elevations(&area_of(&triangles, &exits), &header.coordinates);
        let Some(places) = places else {
            stats.left += 1;
            continue;
        };
        stats.bends += 1;
        stats.in_bends += triangles.len() as u64;
        for place in places {
            let [x, y, z] = header.coordinates.to_decimal(place).map(|number| Decimal(number + 0.0));
            let comma = if stats.places > 0 { "," } else { "" };
            stats.places += 1;
            write!(
                output,
                "{comma}\n{{\"type\":\"Feature\",\"properties\":{{\"elevation\":{z}}},\"geometry\":{{\"type\":\"Point\",\
                 \"coordinates\":[{x},{y},{z}]}}}}"
            )
            .map_err(failed)?;
        }
    }
    output.write_all(b"\n]}\n").and_then(|()| output.flush()).map_err(failed)?;
    Ok(stats)
}

/// Finds flat triangles and exits.
fn read<R: Read>(reader: &mut StreamReader<R>, memory: u64, mut progress: impl FnMut(u64)) -> Result<Found> {
    let mut found = Found::default();
    let mut live = LiveVertices::within(memory / 2);
    let most = memory / 2 / TRIANGLE_BYTES;
    while let Some(event) = reader.next_event()? {
        let Event::Patch(patch) = event else { continue };
        let vertices = live.enter(&patch, |_, point: Point| point).map_err(|error| reader.locate(error))?;
        let mut on_lines = patch.sides.iter().peekable();
        for (triangle, number) in patch.triangles().zip(0..) {
            let corners = triangle.map(|local| vertices[local as usize]);
            let mut is_free = [true; 3];
            while let Some([_, corner, _]) = on_lines.next_if(|side| side[0] == number) {
                is_free[*corner as usize] = false;
            }
            found.enter(corners, is_free);
        }
        if (found.flat.len() + found.exits.len()) as u64 > most {
            return Err(full(found.flat.len()));
        }
        progress(reader.totals().vertices);
    }
    Ok(found)
}

fn full(flat: usize) -> Error {
    let message = format!("{flat} triangles are flat so far, and --memory has no room for more: raise it");
    Error::new(ErrorKind::Memory, message)
}

impl Found {
    fn enter(&mut self, corners: [(u64, Point); 3], is_free: [bool; 3]) {
        let side = |opposite: usize| {
            let [p, q] = [corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]];
            (is_free[opposite] && p.1[2] == q.1[2]).then_some([p.0.min(q.0), p.0.max(q.0)])
        };
        let sides = [0, 1, 2].map(side);
        let places = corners.map(|(_, place)| place);
        if places.iter().all(|place| place[2] == places[0][2]) {
            self.flat.push(Flat { corners: places, sides });
            return;
        }
        // At most one side of a triangle that is not flat is level.
        for (side, place) in sides.into_iter().zip(places) {
            if let Some(side) = side {
                self.exits.insert(side, place);
            }
        }
    }
}

/// The flat areas, as numbers of triangles.
fn areas(flat: &[Flat]) -> Vec<Vec<usize>> {
    let mut at: HashMap<Side, Vec<usize>> = HashMap::new();
    for (number, triangle) in flat.iter().enumerate() {
        triangle.sides.iter().flatten().for_each(|&side| at.entry(side).or_default().push(number));
    }
    let (mut is_seen, mut areas) = (vec![false; flat.len()], Vec::new());
    for first in 0..flat.len() {
        if std::mem::replace(&mut is_seen[first], true) {
            continue;
        }
        let (mut area, mut next) = (vec![first], 0);
        while let Some(&number) = area.get(next) {
            next += 1;
            for &other in flat[number].sides.iter().flatten().flat_map(|side| &at[side]) {
                if !std::mem::replace(&mut is_seen[other], true) {
                    area.push(other);
                }
            }
        }
        areas.push(area);
    }
    areas
}

/// An area with its exits.
fn area_of<'a>(triangles: &'a [Flat], exits: &HashMap<Side, Point>) -> Area<'a> {
    let mut of_area = Vec::new();
    for triangle in triangles {
        for (opposite, side) in triangle.sides.iter().enumerate() {
            if let Some((&side, &beyond)) = side.as_ref().and_then(|side| exits.get_key_value(side)) {
                let ends = [1, 2].map(|step| triangle.corners[(opposite + step) % 3]);
                of_area.push(Exit { side, ends, beyond });
            }
        }
    }
    Area { triangles, exits: of_area }
}
