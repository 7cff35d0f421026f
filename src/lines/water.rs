//! Lakes and rivers: polygons whose shores become flat, or fall along a centre line.
//!
//! Shores are noded with all other lines, so `spconstrain` finds the same vertices. The levels are found in
//! `levels`.

use super::Target;
use super::areas::{Role, odd};
use spmesh_core::error::{Error, Result};
use spmesh_geometry::noding::{Chains, LineVertex, Noded};
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
    let (mut features, mut line, mut polygons) = (Vec::new(), 0, 0);
    for (role, name, file) in files {
        if *role == Role::Water && !target.has_elevation {
            return Err(Error::usage("points have no elevation: --flatten needs x, y and z"));
        }
        for breakline in &file.lines {
            if *role == Role::Water {
                let position = Place { file: name.clone(), position: breakline.position.clone() };
                let level = level(breakline, target).map_err(|message| position.fault(message))?;
                let river = breakline.properties.river.clone();
                if breakline.polygon.is_none() && river.is_none() {
                    return Err(
                        position.fault("found a line, expected polygons, or lines with the property river")
                    );
                }
                let (first, last) = (breakline.vertices.first(), breakline.vertices.last());
                if breakline.polygon.is_some() && first != last {
                    return Err(position.fault("a ring is not closed: repeat its first position at the end"));
                }
                features.push(Feature {
                    line,
                    polygon: breakline.polygon.map(|polygon| polygons + polygon),
                    level,
                    is_hard: breakline.elevations.iter().any(Option::is_some),
                    river,
                    position,
                });
            }
            line += 1;
        }
        polygons += 1 + file.lines.iter().filter_map(|line| line.polygon).max().unwrap_or(0);
    }
    Ok(features)
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
        return Err(format!("the level {level} is beyond the grid of the points"));
    }
    Ok(Some(stored))
}

/// Water after noding; `starts` are the numbers of the first vertices of lines.
///
/// # Errors
/// Malformed, if a river has no centre line or several, or a centre line no river.
pub(crate) fn water(
    features: &[Feature],
    noded: &Noded,
    vertices: &[LineVertex],
    starts: &[u32],
) -> Result<Water> {
    let mut water = Water::default();
    if features.is_empty() {
        return Ok(water);
    }
    let chains = Chains::new(noded);
    let mut names: Vec<&str> = Vec::new();
    for feature in features.iter().filter(|feature| feature.polygon.is_none()) {
        let name = feature.river.as_deref().unwrap_or_default();
        if names.contains(&name) {
            let message = format!("the river {name:?} has a second centre line, expected one: join them");
            return Err(feature.position.fault(message));
        }
        names.push(name);
        let segments = segments(feature, &chains, vertices, starts)?;
        let Some(first) =
            noded.vertices.binary_search_by_key(&start(feature, vertices, starts), |v| v.place).ok()
        else {
            return Err(feature.position.fault("the centre line was lost"));
        };
        let mut path = vec![first as u32];
        for segment in segments {
            let [a, b] = noded.segments[segment as usize].ends;
            path.push(if path[path.len() - 1] == a { b } else { a });
        }
        if path.len() < 2 {
            return Err(feature
                .position
                .fault("a centre line is at one place of the grid, expected two at least"));
        }
        let (is_hard, position) = (feature.is_hard, feature.position.clone());
        water.centres.push(Centre { vertices: path, is_hard, position });
    }
    let rings: Vec<&Feature> = features.iter().filter(|feature| feature.polygon.is_some()).collect();
    let mut is_used = vec![false; names.len()];
    for same in rings.chunk_by(|a, b| a.polygon == b.polygon) {
        let mut border = Vec::new();
        for ring in same {
            border.extend(segments(ring, &chains, vertices, starts)?);
        }
        let position = same[0].position.clone();
        let centre = match &same[0].river {
            None => None,
            Some(river) => Some(names.iter().position(|name| name == river).ok_or_else(|| {
                position.fault(format!(
                    "the river {river:?} has no centre line: add a line with the property river {river:?}"
                ))
            })?),
        };
        if let Some(centre) = centre {
            is_used[centre] = true;
        }
        let level = same[0].level;
        if let Some(other) = same.iter().find(|ring| ring.level != level) {
            return Err(other
                .position
                .fault("the shores of islands have another elevation than that of the lake"));
        }
        water.polygons.push(WaterPolygon { segments: odd(border), level, centre, position });
    }
    if let Some(unused) = is_used.iter().position(|is_used| !is_used) {
        let message = format!("the river {:?} has no polygon", names[unused]);
        return Err(water.centres[unused].position.fault(message));
    }
    Ok(water)
}

fn start(feature: &Feature, vertices: &[LineVertex], starts: &[u32]) -> [i64; 2] {
    vertices[starts[feature.line as usize] as usize].place
}

/// The segments of a line, in its order.
fn segments(feature: &Feature, chains: &Chains, vertices: &[LineVertex], starts: &[u32]) -> Result<Vec<u32>> {
    let line = feature.line as usize;
    let end = starts.get(line + 1).map_or(vertices.len(), |&end| end as usize);
    let mut segments = Vec::new();
    for part in vertices[starts[line] as usize..end].windows(2) {
        if !chains.of_part(part[0].place, part[1].place, |segment| segments.push(segment)) {
            return Err(feature.position.fault("the line was lost"));
        }
    }
    Ok(segments)
}
