//! The levels of rivers: elevations at stations, and at the vertices of shores.

use super::levels::{Given, Levels, MEDIAN, percentile_of, vertices};
use super::report::{Found, LevelRow};
use super::sections::Sections;
use super::stations::Stations;
use super::water::{Course, River, WaterPolygon};
use crate::polygons::{Polygons, Side};
use spmesh_base::error::Result;
use spmesh_delaunay::network::Network;
use spmesh_stream::model::points::Point2;

const NO_POINTS: &str = "no points are near the shore: state the elevations of the river as third \
                         coordinates of its centre line or banks, or look for points farther away with \
                         --shore-width";

/// Elevations that differ by more than this part of their magnitude count as different in streams of f64.
const F64_PART: f64 = 1e-9;

/// What is known at a station: its elevation, and how it was found.
type Known = Option<(f64, Found)>;

impl Levels {
    /// The levels of a river.
    pub(crate) fn river(&mut self, given: &Given, number: usize) -> Result<()> {
        let river = &given.water.rivers[number];
        let (mut stations, sections) = river.stations(given.network);
        let known = match river.is_hard {
            true => river.stated(given.network, sections.as_ref()),
            false => near(given, number, &stations),
        };
        if !river.is_hard {
            self.found += known.iter().flatten().count() as u64;
        }
        let elevations: Vec<Option<f64>> = known.iter().map(|known| known.map(|(z, _)| z)).collect();
        let lowered = stations.settle(&elevations).ok_or_else(|| river.position.fault(NO_POINTS))?;
        for ((&place, &known), &z) in stations.places().iter().zip(&known).zip(&stations.elevations) {
            self.rows.push(LevelRow::of_station(given, river, (place, known), z));
        }
        let moved = match (&river.course, &sections) {
            (Course::Banks { banks, ends }, Some(sections)) => {
                self.banks(given, (banks, ends), sections, &stations)
            }
            (Course::Centre(centre), _) => {
                let own = given.of_rivers[number].iter().map(|&polygon| &given.water.polygons[polygon]);
                own.for_each(|polygon| self.polygon(given, polygon, (centre, &stations)));
                lowered
            }
            _ => 0,
        };
        self.notices.extend(river.notice(given, &elevations, moved));
        Ok(())
    }

    /// The vertices of a river whose file states the elevation of each.
    pub(crate) fn own(&mut self, given: &Given, polygon: &WaterPolygon) {
        for vertex in vertices(given.network, polygon) {
            if let Some(z) = given.network.vertices[vertex as usize].z {
                self.take(given, vertex, z);
            }
        }
    }

    /// The vertices of a river by its centre line.
    fn polygon(&mut self, given: &Given, polygon: &WaterPolygon, (centre, stations): (&[u32], &Stations)) {
        let network = given.network;
        for vertex in vertices(network, polygon) {
            let station = stations.nearest(network.vertices[vertex as usize].place);
            self.take(given, vertex, stations.elevation(station));
        }
        let inside = Polygons::of_edges(polygon.edges(network).map(|edge| (0, edge)));
        for (&vertex, &z) in centre.iter().zip(&stations.elevations) {
            if inside.side(network.vertices[vertex as usize].place) != Side::Outside {
                self.take(given, vertex, z);
            }
        }
    }

    /// The vertices of a river by its banks. Returns how many of them state another elevation.
    fn banks(
        &mut self,
        given: &Given,
        (banks, ends): (&[Vec<u32>; 2], &[Vec<u32>; 2]),
        sections: &Sections,
        stations: &Stations,
    ) -> u64 {
        let mut moved = 0;
        for (bank, vertices) in banks.iter().enumerate() {
            let along = sections.stations(bank, &places(given.network, vertices), stations);
            for (&vertex, station) in vertices.iter().zip(along) {
                let z = stations.elevation(station);
                self.take(given, vertex, z);
                moved += u64::from(given.states_another(vertex, z));
            }
        }
        let last = stations.elevations.len() - 1;
        for (end, index) in ends.iter().zip([0, last]) {
            end.iter().for_each(|&vertex| self.take(given, vertex, stations.elevations[index]));
        }
        moved
    }

    /// Gives a vertex its elevation, unless another river is lower there.
    fn take(&mut self, given: &Given, vertex: u32, z: f64) {
        let own = self.elevations.entry(vertex).or_insert(f64::INFINITY);
        *own = own.min(given.target.coordinates.rounded(z));
    }
}

impl Given<'_> {
    /// Whether a vertex of the network has another elevation than `z`.
    fn states_another(&self, vertex: u32, z: f64) -> bool {
        let Some(stated) = self.network.vertices[vertex as usize].z else { return false };
        let difference = (self.target.coordinates.rounded(stated) - self.target.coordinates.rounded(z)).abs();
        difference > F64_PART * stated.abs().max(1.0)
    }
}

impl River {
    /// Its stations: the vertices of the centre line, or the middles of sections between the banks.
    fn stations(&self, network: &Network) -> (Stations, Option<Sections>) {
        match &self.course {
            Course::Centre(centre) => (Stations::new(places(network, centre)), None),
            Course::Banks { banks, .. } => {
                let [left, right] = [0, 1].map(|bank: usize| places(network, &banks[bank]));
                let sections = Sections::new([&left, &right]);
                let middle = |[a, b]: [usize; 2]| [0, 1].map(|axis| (left[a][axis] + right[b][axis]) / 2.0);
                (Stations::new(sections.iter().map(middle).collect()), Some(sections))
            }
        }
    }

    /// The elevations that lines state at stations: of a section, the mean of its ends.
    fn stated(&self, network: &Network, sections: Option<&Sections>) -> Vec<Known> {
        let z = |vertex: u32| network.vertices[vertex as usize].z;
        let known = |z: Option<f64>| z.map(|z| (z, Found::Coordinates));
        match (&self.course, sections) {
            (Course::Banks { banks, .. }, Some(sections)) => {
                let mean = |[a, b]: [usize; 2]| match [z(banks[0][a]), z(banks[1][b])] {
                    [Some(left), Some(right)] => Some((left + right) / 2.0),
                    [left, right] => left.or(right),
                };
                sections.iter().map(mean).map(known).collect()
            }
            (Course::Centre(vertices) | Course::Banks { banks: [vertices, _], .. }, _) => {
                vertices.iter().map(|&vertex| known(z(vertex))).collect()
            }
        }
    }

    /// What is to be said about elevations; `moved` vertices of its lines did not keep theirs.
    fn notice(&self, given: &Given, known: &[Option<f64>], moved: u64) -> Option<String> {
        let mut ends = known.iter().flatten();
        let first = *ends.next()?;
        let last = *ends.next_back().unwrap_or(&first);
        let lines = match self.course {
            Course::Centre(_) => "its centre line",
            Course::Banks { .. } => "its banks",
        };
        if first < last {
            let [first, last] = [first, last].map(|z| given.target.coordinates.to_decimal([0.0, 0.0, z])[2]);
            return Some(format!(
                "{}: the river rises from {first} to {last}, and is at most {first} everywhere now: {lines} \
                 must lead downstream",
                self.position
            ));
        }
        let what = match self.course {
            Course::Centre(_) => "vertices of the centre line were lowered to those upstream",
            Course::Banks { .. } => {
                "vertices of banks took another elevation, so that the river is level across and falls"
            }
        };
        (self.is_hard && moved > 0).then(|| {
            format!("{}: {moved} {what}: give spconstrain lines without these elevations", self.position)
        })
    }
}

/// The percentile of the points near the shores of a river, or of those in its water, at the stations that
/// are nearest to them.
fn near(given: &Given, number: usize, stations: &Stations) -> Vec<Known> {
    let mut at = vec![[Vec::new(), Vec::new()]; stations.places().len()];
    for near in given.of_rivers[number].iter().map(|&polygon| &given.near[polygon]) {
        for (kind, points) in [&near.points, &near.in_water].into_iter().enumerate() {
            points.iter().for_each(|&[x, y, z]| at[stations.nearest([x, y]).vertex()][kind].push(z));
        }
    }
    let known = |[shore, water]: [Vec<f64>; 2]| {
        let (points, percentile, found): (_, _, fn(usize) -> Found) = match water.is_empty() {
            true => (shore, given.percentile, Found::Points),
            false => (water, MEDIAN, Found::WaterPoints),
        };
        let found = found(points.len());
        percentile_of(points, percentile).map(|z| (z, found))
    };
    at.into_iter().map(known).collect()
}

fn places(network: &Network, vertices: &[u32]) -> Vec<Point2> {
    vertices.iter().map(|&vertex| network.vertices[vertex as usize].place).collect()
}
