//! Lakes and rivers: polygons whose shores become flat, or fall along a centre line.
//!
//! Shores are noded with all other lines, so `spconstrain` finds the same vertices. The levels are found in
//! `levels`.

use super::Target;
use super::areas::{Role, odd};
use super::numbered::{Bent, Numbered, numbered};
use super::polygons::check_ring;
use spmesh_core::error::{Error, Result};
use spmesh_io::source::{Breakline, Breaklines};
use spmesh_model::network::Network;
use spmesh_model::points::Point2;

/// Polygons of water, and the centre lines of rivers, as parts of a network.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Water {
    /// The polygons.
    pub polygons: Vec<WaterPolygon>,
    /// The centre lines.
    pub(crate) centres: Vec<Centre>,
}

/// A polygon of water.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WaterPolygon {
    /// The segments of its border.
    pub(crate) segments: Vec<u32>,
    /// Of a lake: its stored level, if the file states one.
    pub(crate) level: Option<f64>,
    /// Of a river: the number of its centre line.
    pub(crate) centre: Option<usize>,
    /// Position in the file, for messages.
    pub(crate) position: Place,
}

/// The centre line of a river.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Centre {
    /// Its vertices in the network, downstream.
    pub(crate) vertices: Vec<u32>,
    /// Whether it states elevations.
    pub(crate) is_hard: bool,
    pub(crate) position: Place,
}

/// A file and a position in it, for messages.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) file: String,
    pub(crate) position: String,
}

impl Place {
    pub(crate) fn fault(&self, message: impl Into<String>) -> Error {
        Error::malformed(message).at(&self.position).of_input(&self.file)
    }
}

impl WaterPolygon {
    /// Whether its level must be found from points near its shore. `water` has the polygon.
    pub(crate) fn needs_points(&self, water: &Water) -> bool {
        match self.centre {
            None => self.level.is_none(),
            Some(centre) => !water.centres[centre].is_hard,
        }
    }

    /// Its segments, as places of their ends.
    pub(crate) fn edges<'n>(&'n self, network: &'n Network) -> impl Iterator<Item = [Point2; 2]> + 'n {
        self.segments.iter().map(|&segment| network.places(&network.segments[segment as usize]))
    }
}

impl Water {
    /// The edges of all polygons, with their numbers.
    #[must_use]
    pub fn edges(&self, network: &Network) -> Vec<(u32, [Point2; 2])> {
        let numbered = (0..).zip(&self.polygons);
        numbered
            .flat_map(|(number, polygon)| polygon.edges(network).map(move |edge| (number, edge)))
            .collect()
    }

    /// Of each polygon, whether its level must be found from points near its shore.
    #[must_use]
    pub fn need_points(&self) -> Vec<bool> {
        self.polygons.iter().map(|polygon| polygon.needs_points(self)).collect()
    }

    /// Numbers of lakes and of rivers.
    #[must_use]
    pub fn counts(&self) -> [u64; 2] {
        let lakes = self.polygons.iter().filter(|polygon| polygon.centre.is_none()).count();
        [lakes as u64, self.centres.len() as u64]
    }
}

/// A feature of water before noding.
pub(crate) struct Feature {
    line: u32,
    /// Its polygon, over all files; `None` for a centre line.
    polygon: Option<u32>,
    level: Option<f64>,
    river: Option<String>,
    is_hard: bool,
    position: Place,
}

/// The features of water among the lines of files.
///
/// # Errors
/// Malformed, if a feature is neither a polygon nor a centre line, or its level makes no sense; usage, if
/// points have no elevation.
pub(crate) fn features(files: &[(Role, String, Breaklines)], target: &Target) -> Result<Vec<Feature>> {
    if files.iter().any(|(role, ..)| *role == Role::Water) && !target.has_elevation {
        return Err(Error::usage("points have no elevation: --flatten needs x, y and z"));
    }
    numbered(files).filter(|line| line.role == Role::Water).map(|line| feature(&line, target)).collect()
}

fn feature(&Numbered { file, number, polygon, line, .. }: &Numbered, target: &Target) -> Result<Feature> {
    let position = Place { file: file.to_string(), position: line.position.clone() };
    let level = level(line, target).map_err(|message| position.fault(message))?;
    let river = line.properties.river.clone();
    if polygon.is_none() && river.is_none() {
        return Err(position.fault("found a line, expected polygons, or lines with the property river"));
    }
    if polygon.is_some() {
        check_ring(line).map_err(|error| error.at(&line.position).of_input(file))?;
    }
    let is_hard = line.elevations.iter().any(Option::is_some);
    Ok(Feature { line: number, polygon, level, river, is_hard, position })
}

/// The stored level that a ring of a lake states.
fn level(line: &Breakline, target: &Target) -> std::result::Result<Option<f64>, String> {
    if line.polygon.is_none() || line.properties.river.is_some() {
        return Ok(None);
    }
    let mut stated: Option<f64> = None;
    for &z in line.elevations.iter().flatten() {
        match stated {
            Some(known) if known != z => {
                let remedy = "write it without elevations, for example with ogr2ogr -dim XY";
                return Err(format!(
                    "a shore of a lake has the elevations {known} and {z}, expected one: {remedy}"
                ));
            }
            _ => stated = Some(z),
        }
    }
    if let Some(text) = &line.properties.level {
        let level: Option<f64> = text.trim().parse().ok().filter(|level: &f64| level.is_finite());
        let level = level.ok_or_else(|| format!("the property level is {text:?}, expected a number"))?;
        if stated.is_some_and(|stated| stated != level) {
            return Err(format!("the property level is {text}, but the shore has another elevation"));
        }
        stated = Some(level);
    }
    let Some(level) = stated else { return Ok(None) };
    let stored = target.coordinates.to_stored([0.0, 0.0, level])[2];
    if !target.coordinates.can_store(stored) {
        return Err(format!("the level {level:?} is beyond the grid of the points"));
    }
    Ok(Some(stored))
}

/// Water after noding.
///
/// # Errors
/// Malformed, if a river has no centre line or several, or a centre line no river.
pub(crate) fn water(features: &[Feature], bent: &Bent) -> Result<Water> {
    let (mut names, mut water) = (Vec::new(), Water::default());
    for feature in features.iter().filter(|feature| feature.polygon.is_none()) {
        let name = feature.river.as_deref().unwrap_or_default();
        if names.contains(&name) {
            let message = format!("the river {name:?} has a second centre line, expected one: join them");
            return Err(feature.position.fault(message));
        }
        names.push(name);
        water.centres.push(centre(feature, bent)?);
    }
    let rings: Vec<&Feature> = features.iter().filter(|feature| feature.polygon.is_some()).collect();
    for same in rings.chunk_by(|a, b| a.polygon == b.polygon) {
        water.polygons.push(polygon(same, &names, bent)?);
    }
    let is_used = |centre: &usize| water.polygons.iter().any(|polygon| polygon.centre == Some(*centre));
    if let Some(unused) = (0..names.len()).find(|centre| !is_used(centre)) {
        let message = format!("the river {:?} has no polygon", names[unused]);
        return Err(water.centres[unused].position.fault(message));
    }
    Ok(water)
}

/// The centre line of a river.
fn centre(feature: &Feature, bent: &Bent) -> Result<Centre> {
    let segments = segments(feature, bent)?;
    let start = bent.vertices(feature.line)[0].place;
    let Ok(first) = bent.noded.vertices.binary_search_by_key(&start, |vertex| vertex.place) else {
        return Err(feature.position.fault("the centre line was lost"));
    };
    let mut vertices = vec![first as u32];
    for segment in segments {
        let [a, b] = bent.noded.segments[segment as usize].ends;
        vertices.push(if vertices[vertices.len() - 1] == a { b } else { a });
    }
    if vertices.len() < 2 {
        let message = "a centre line is at one place of the grid, expected two at least";
        return Err(feature.position.fault(message));
    }
    Ok(Centre { vertices, is_hard: feature.is_hard, position: feature.position.clone() })
}

/// The polygon of some rings; `names` are those of rivers, in the order of their centre lines.
fn polygon(rings: &[&Feature], names: &[&str], bent: &Bent) -> Result<WaterPolygon> {
    let mut border = Vec::new();
    for ring in rings {
        border.extend(segments(ring, bent)?);
    }
    let Feature { level, river, position, .. } = rings[0];
    let centre_of = |river: &String| {
        names.iter().position(|name| name == river).ok_or_else(|| {
            position.fault(format!(
                "the river {river:?} has no centre line: add a line with the property river {river:?}"
            ))
        })
    };
    let centre = river.as_ref().map(centre_of).transpose()?;
    if let Some(other) = rings.iter().find(|ring| ring.level != *level) {
        let message = "the shores of islands have another elevation than that of the lake";
        return Err(other.position.fault(message));
    }
    Ok(WaterPolygon { segments: odd(border), level: *level, centre, position: position.clone() })
}

/// The segments of a line, in its order.
fn segments(feature: &Feature, bent: &Bent) -> Result<Vec<u32>> {
    bent.segments(feature.line).map_err(|_| feature.position.fault("the line was lost"))
}
