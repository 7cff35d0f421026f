//! Lakes and rivers: polygons whose shores become flat, or fall downstream.
//!
//! Shores are noded with all other lines, so `spconstrain` finds the same vertices. The levels are found in
//! `levels`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::areas::odd;
use super::banks::check;
use super::features::{Feature, FeatureKind};
use super::grid::Grid;
use super::levels::vertices;
use super::numbered::Bent;
use spmesh_base::error::{Error, Result, counted_of};
use spmesh_delaunay::network::Network;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::model::points::Point2;

/// Polygons of water, and the courses of rivers, as parts of a network.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Water {
    /// The polygons, of which two banks make one.
    pub polygons: Vec<WaterPolygon>,
    /// The rivers, in the order of their names.
    pub(crate) rivers: Vec<River>,
}

/// A polygon of water.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WaterPolygon {
    /// The segments of its border.
    pub(crate) segments: Vec<u32>,
    /// Of a lake: its level, if the file states one.
    pub(crate) level: Option<Stated>,
    /// Of a river with a centre line or banks: its number.
    pub(crate) river: Option<usize>,
    /// Of a river without these: its name. The file states the elevation of each vertex of its shore.
    pub(crate) own: Option<String>,
    /// The vertices of its rings, in their order. The first one of a ring is also its last.
    pub(crate) rings: Vec<Vec<u32>>,
    /// Number of its first line.
    pub(crate) line: u32,
    /// Position in the file, for messages.
    pub(crate) position: Place,
}

/// A level that a file states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stated {
    /// As stored.
    pub(crate) level: f64,
    /// Whether a property states it, and not third coordinates.
    pub(crate) by_property: bool,
}

/// A river.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct River {
    pub(crate) name: String,
    pub(crate) course: Course,
    /// Whether the lines of its course state elevations.
    pub(crate) is_hard: bool,
    /// Number of the first of these lines.
    pub(crate) line: u32,
    pub(crate) position: Place,
}

/// What leads a river downstream, as vertices of the network.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Course {
    Centre(Vec<u32>),
    Banks {
        /// The left one and the right one.
        banks: [Vec<u32>; 2],
        /// What closes the river above and below, from left to right; empty where the banks meet.
        ends: [Vec<u32>; 2],
    },
}

/// A file and a position in it, for messages.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) file: String,
    pub(crate) position: Arc<str>,
}

impl Course {
    /// Its vertices.
    fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        let lines = match self {
            Course::Centre(line) => [&line[..], &[]],
            Course::Banks { banks: [left, right], .. } => [&left[..], &right[..]],
        };
        lines.into_iter().flatten().copied()
    }
}

impl Place {
    pub(crate) fn fault(&self, message: impl Into<String>) -> Error {
        Error::malformed(message).at(&*self.position).of_input(&self.file)
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.file, self.position)
    }
}

impl WaterPolygon {
    /// Whether its level must be found from points near its shore. `water` has the polygon.
    pub(crate) fn needs_points(&self, water: &Water) -> bool {
        match self.river {
            None => self.level.is_none() && self.own.is_none(),
            Some(river) => !water.rivers[river].is_hard,
        }
    }

    /// Whether it has one level.
    pub(crate) fn is_lake(&self) -> bool {
        self.river.is_none() && self.own.is_none()
    }

    /// The name of its river.
    pub(crate) fn river_name<'w>(&'w self, water: &'w Water) -> Option<&'w str> {
        self.own.as_deref().or_else(|| self.river.map(|river| &*water.rivers[river].name))
    }

    /// Whether its box, with so much around it, meets that of points.
    pub(crate) fn is_within(&self, width: f64, points: &Bounds, network: &Network) -> bool {
        (0..2).all(|axis| {
            let ends = || self.edges(network).flatten().map(|place| place[axis]);
            let (least, most) =
                (ends().fold(f64::INFINITY, f64::min), ends().fold(f64::NEG_INFINITY, f64::max));
            least - width <= points.max[axis] && most + width >= points.min[axis]
        })
    }

    /// Its segments, as places of their ends.
    pub(crate) fn edges<'n>(&'n self, network: &'n Network) -> impl Iterator<Item = [Point2; 2]> + 'n {
        self.segments.iter().map(|&segment| network.places(&network.segments[segment as usize]))
    }
}

impl Water {
    /// The edges of all polygons, with their numbers.
    pub fn edges(&self, network: &Network) -> Vec<(u32, [Point2; 2])> {
        let numbered = (0..).zip(&self.polygons);
        numbered
            .flat_map(|(number, polygon)| polygon.edges(network).map(move |edge| (number, edge)))
            .collect()
    }

    /// Of each polygon, whether its level must be found from points near its shore.
    pub fn need_points(&self) -> Vec<bool> {
        self.polygons.iter().map(|polygon| polygon.needs_points(self)).collect()
    }

    /// A polygon whose level must be found from points.
    pub(crate) fn without_level(&self) -> Option<&WaterPolygon> {
        self.polygons.iter().find(|polygon| polygon.needs_points(self))
    }

    /// The vertices of the network on shores whose elevations follow from what files state.
    pub(crate) fn stated_vertices(&self, network: &Network) -> BTreeSet<u32> {
        let stated = self.polygons.iter().filter(|polygon| !polygon.needs_points(self));
        stated.flat_map(|polygon| vertices(network, polygon)).collect()
    }

    /// Numbers of lakes and of rivers.
    pub fn counts(&self) -> [u64; 2] {
        let lakes = self.polygons.iter().filter(|polygon| polygon.is_lake()).count();
        let own: BTreeSet<&str> = self.polygons.iter().filter_map(|polygon| polygon.own.as_deref()).collect();
        [lakes as u64, (self.rivers.len() + own.len()) as u64]
    }

    /// What is to be said about the polygons that are left out, as `far` says.
    pub(crate) fn about_far(&self, far: &[bool]) -> Option<String> {
        let count = far.iter().filter(|&&is_far| is_far).count();
        let first = &self.polygons[far.iter().position(|&is_far| is_far)?].position;
        Some(format!(
            "{} left out, as no points are in the water or near its shore; the first is {first}. --shore-width \
             looks for points farther away",
            counted_of(
                count as u64,
                far.len() as u64,
                ["polygon of water", "polygons of water"],
                ["is", "are"]
            )
        ))
    }

    /// The numbers of the polygons of each river.
    pub(crate) fn of_rivers(&self) -> Vec<Vec<usize>> {
        let mut found = vec![Vec::new(); self.rivers.len()];
        for (number, polygon) in self.polygons.iter().enumerate() {
            if let Some(river) = polygon.river {
                found[river].push(number);
            }
        }
        found
    }

    /// Leaves out the polygons that `far` says, and the rivers that lose all of theirs. Returns the vertices
    /// of the network that only these have.
    pub(crate) fn leave_out(&mut self, far: &[bool], network: &Network) -> BTreeSet<u32> {
        let is_lost: Vec<bool> =
            self.of_rivers().into_iter().map(|polygons| polygons.into_iter().all(|it| far[it])).collect();
        let [mut left, mut kept] = [BTreeSet::new(), BTreeSet::new()];
        for (polygon, &is_far) in self.polygons.iter().zip(far) {
            if is_far { &mut left } else { &mut kept }.extend(vertices(network, polygon));
        }
        for (river, &is_lost) in self.rivers.iter().zip(&is_lost) {
            if is_lost { &mut left } else { &mut kept }.extend(river.course.vertices());
        }
        // Vertices that other lines lead to are theirs, too.
        let others = network.segments.iter().filter(|it| !it.ends.iter().all(|end| left.contains(end)));
        kept.extend(others.flat_map(|segment| segment.ends));
        let mut far = far.iter();
        self.polygons.retain(|_| far.next() == Some(&false));
        let lost_before: Vec<usize> = is_lost
            .iter()
            .scan(0, |lost, &is_lost| Some(std::mem::replace(lost, *lost + usize::from(is_lost))))
            .collect();
        let number = |river: usize| river - lost_before[river];
        self.polygons.iter_mut().for_each(|polygon| polygon.river = polygon.river.map(number));
        let mut lost = is_lost.iter();
        self.rivers.retain(|_| lost.next() == Some(&false));
        left.retain(|vertex| !kept.contains(vertex));
        left
    }

    /// Enters a river, and its polygon if it has banks.
    fn enter(&mut self, name: &str, lines: &Lines, bent: &Bent, grid: &Grid) -> Result<()> {
        let banks = lines.banks(name)?;
        let of_banks = banks.map(|banks| of_banks(banks, &lines.ends, bent, grid)).transpose()?;
        let (course, border) = of_banks.unzip();
        let (course, leading) = lines.course(name, course.zip(banks), bent)?;
        let Feature { line, ref position, .. } = *leading[0];
        if let Some(Border { segments, ring }) = border {
            let (river, position, rings) = (Some(self.rivers.len()), position.clone(), vec![ring]);
            self.polygons.push(WaterPolygon { segments, river, line, position, rings, ..Default::default() });
        }
        let (name, is_hard) = (name.to_string(), leading.iter().any(|line| line.is_hard));
        self.rivers.push(River { name, course, is_hard, line, position: position.clone() });
        Ok(())
    }
}

/// Water after noding.
pub(crate) fn water(features: &[Feature], bent: &Bent, grid: &Grid) -> Result<Water> {
    let mut rivers: BTreeMap<&str, Lines> = BTreeMap::new();
    for feature in features {
        if let Some(river) = feature.river() {
            rivers.entry(river).or_default().enter(feature)?;
        }
    }
    let own: BTreeSet<&str> =
        rivers.iter().filter(|(_, lines)| lines.are_own()).map(|(&name, _)| name).collect();
    rivers.retain(|name, _| !own.contains(name));
    let mut water = Water::default();
    for (name, lines) in &rivers {
        water.enter(name, lines, bent, grid)?;
    }
    let rings: Vec<&Feature> = features.iter().filter(|feature| feature.polygon().is_some()).collect();
    let numbers: BTreeMap<&str, usize> = rivers.keys().copied().zip(0..).collect();
    for same in rings.chunk_by(|a, b| a.polygon() == b.polygon()) {
        let number = |river: &str| numbers.get(river).copied();
        let river = same[0].river();
        let own = river.filter(|river| own.contains(river)).map(str::to_string);
        water.polygons.push(WaterPolygon { own, ..polygon(same, river.and_then(number), bent)? });
    }
    Ok(water)
}

/// The features of a river.
#[derive(Default)]
struct Lines<'f> {
    centre: Option<&'f Feature>,
    banks: [Option<&'f Feature>; 2],
    ends: Vec<&'f Feature>,
    /// A polygon of it.
    polygon: Option<&'f Feature>,
    /// Whether a vertex of its polygons has no elevation.
    lacks_elevations: bool,
}

impl<'f> Lines<'f> {
    fn enter(&mut self, feature: &'f Feature) -> Result<()> {
        let (own, what) = match feature.kind {
            FeatureKind::Ring(_) => {
                self.polygon.get_or_insert(feature);
                self.lacks_elevations |= !feature.is_complete;
                return Ok(());
            }
            FeatureKind::End => {
                self.ends.push(feature);
                return Ok(());
            }
            FeatureKind::Centre => (&mut self.centre, "centre line"),
            FeatureKind::Bank(bank) => {
                (&mut self.banks[bank as usize], ["left bank", "right bank"][bank as usize])
            }
        };
        if own.replace(feature).is_some() {
            let name = feature.river().unwrap_or_default();
            let message = format!("the river {name:?} has a second {what}, expected one: join them");
            return Err(feature.position.fault(message));
        }
        Ok(())
    }

    /// Whether polygons alone state the elevations of the river, at each vertex.
    fn are_own(&self) -> bool {
        self.polygon.is_some()
            && self.centre.is_none()
            && self.banks.iter().all(Option::is_none)
            && !self.lacks_elevations
    }

    /// Both banks; `None` if the river has a polygon.
    fn banks(&self, name: &str) -> Result<Option<[&'f Feature; 2]>> {
        match (self.banks, self.polygon) {
            ([Some(bank), _] | [_, Some(bank)], Some(_)) => Err(bank.position.fault(format!(
                "the river {name:?} has a polygon and a bank: remove its polygons, or its banks"
            ))),
            ([Some(left), Some(right)], None) => Ok(Some([left, right])),
            ([Some(bank), None] | [None, Some(bank)], None) => {
                let is_left = self.banks[0].is_some();
                let (own, other) = if is_left { ("left", "right") } else { ("right", "left") };
                Err(bank.position.fault(format!(
                    "the river {name:?} has a {own} bank alone: add a line of this river with bank {other:?}"
                )))
            }
            ([None, None], _) => Ok(None),
        }
    }

    /// What leads the river downstream, and the features of it: the centre line, or else the banks.
    fn course(
        &self,
        name: &str,
        banks: Option<(Course, [&'f Feature; 2])>,
        bent: &Bent,
    ) -> Result<(Course, Vec<&'f Feature>)> {
        let fault = |feature: &Feature, message: String| Err(feature.position.fault(message));
        match (self.centre, banks, self.polygon) {
            (Some(centre), None, None) => {
                fault(centre, format!("the river {name:?} has no polygon: add one, or its two banks"))
            }
            (Some(centre), ..) => {
                let (vertices, _) = chain(centre, bent)?;
                if vertices.len() < 2 {
                    let message = "a centre line is at one place of the grid, expected two at least";
                    return fault(centre, message.into());
                }
                Ok((Course::Centre(vertices), vec![centre]))
            }
            (None, Some((course, banks)), _) => Ok((course, banks.to_vec())),
            (None, None, Some(polygon)) => fault(
                polygon,
                format!(
                    "the river {name:?} has no centre line: add a line with the property river {name:?}, or third \
                     coordinates at all vertices of its polygons"
                ),
            ),
            (None, None, None) => Err(Error::malformed(format!("the river {name:?} was lost"))),
        }
    }
}

/// What bounds a river between two banks: segments, and vertices in turn.
struct Border {
    segments: Vec<u32>,
    ring: Vec<u32>,
}

/// The course along two banks, and the border of the river. `closing` are the lines between their ends.
fn of_banks(
    features: [&Feature; 2],
    closing: &[&Feature],
    bent: &Bent,
    grid: &Grid,
) -> Result<(Course, Border)> {
    let [(left, mut segments), (right, of_right)] = [chain(features[0], bent)?, chain(features[1], bent)?];
    segments.extend(of_right);
    let mut ends = [Vec::new(), Vec::new()];
    for end in closing {
        let (vertices, of_end) = chain(end, bent)?;
        segments.extend(of_end);
        let is_lower = vertices[0] != left[0];
        ends[usize::from(is_lower)] = vertices;
    }
    let place = |vertex: u32| bent.noded.vertices[vertex as usize].place;
    check([&left, &right], ends.each_ref().map(|end| &end[..]), place, |place| grid.world(place))
        .map_err(|(bank, message)| features[bank as usize].position.fault(message))?;
    let [above, below] = &ends;
    let back = right.iter().rev().chain(above.iter().rev());
    let mut ring: Vec<u32> = left.iter().chain(below).chain(back).chain(&left[..1]).copied().collect();
    ring.dedup();
    Ok((Course::Banks { banks: [left, right], ends }, Border { segments: odd(segments), ring }))
}

/// The vertices and the segments of a line, in its order.
fn chain(feature: &Feature, bent: &Bent) -> Result<(Vec<u32>, Vec<u32>)> {
    let lost = || feature.position.fault("the line was lost");
    let segments = bent.segments(feature.line).map_err(|_| lost())?;
    let start = bent.vertices(feature.line)[0].place;
    let Ok(first) = bent.noded.vertices.binary_search_by_key(&start, |vertex| vertex.place) else {
        return Err(lost());
    };
    let mut vertices = vec![first as u32];
    for &segment in &segments {
        let [a, b] = bent.noded.segments[segment as usize].ends;
        vertices.push(if vertices[vertices.len() - 1] == a { b } else { a });
    }
    Ok((vertices, segments))
}

/// The polygon of some rings.
fn polygon(rings: &[&Feature], river: Option<usize>, bent: &Bent) -> Result<WaterPolygon> {
    let (mut border, mut vertices) = (Vec::new(), Vec::new());
    for ring in rings {
        let (ring, segments) = chain(ring, bent)?;
        border.extend(segments);
        vertices.push(ring);
    }
    let &Feature { level, line, ref position, .. } = rings[0];
    if let Some(other) =
        rings.iter().find(|ring| ring.level.map(|own| own.level) != level.map(|own| own.level))
    {
        let message = "the shores of islands have another elevation than that of the lake";
        return Err(other.position.fault(message));
    }
    let (segments, position) = (odd(border), position.clone());
    Ok(WaterPolygon { segments, level, river, line, position, rings: vertices, own: None })
}
