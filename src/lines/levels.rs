//! The levels of lakes and rivers at the vertices of their shores.

use std::collections::BTreeMap;

use super::Target;
use super::stations::Stations;
use super::water::{Water, WaterPolygon};
use spmesh_core::error::{Error, Result};
use spmesh_geometry::polygons::{Polygons, Side};
use spmesh_model::bounds::Point;
use spmesh_model::network::Network;
use spmesh_stream::Coordinates;

/// The levels of water.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Levels {
    /// Stored elevations of vertices of the network that are on shores or on centre lines inside of their
    /// river.
    pub elevations: BTreeMap<u32, f64>,
    /// Levels that were found from points.
    pub found: u64,
    /// Messages for the user.
    pub notices: Vec<String>,
}

impl Levels {
    /// Finds the levels. `shores` are the points near the shore of each polygon that needs them, and
    /// `percentile` of their elevations counts: the least one such that this part of all, in percent, is not
    /// above it.
    ///
    /// Lakes come before rivers: a vertex of a river at the shore of a lake or inside of it takes the level
    /// of the lake. Of several rivers, the lowest counts.
    ///
    /// # Errors
    /// Malformed, with the position, if a polygon needs points and has none, or lakes of different levels
    /// meet.
    pub fn find(
        network: &Network,
        water: &Water,
        shores: Vec<Vec<Point>>,
        percentile: f64,
        target: &Target,
    ) -> Result<Levels> {
        let mut levels = Levels::default();
        let mut shores = shores;
        shores.resize(water.polygons.len(), Vec::new());
        let rivers = levels.rivers(network, water, &shores, percentile, target)?;
        for polygon in &water.polygons {
            if let Some(centre) = polygon.centre {
                levels.river(network, water, polygon, (centre, &rivers[centre]), target);
            }
        }
        levels.lakes(network, water, shores, percentile)?;
        Ok(levels)
    }

    /// The centre lines with their elevations.
    fn rivers(
        &mut self,
        network: &Network,
        water: &Water,
        shores: &[Vec<Point>],
        percentile: f64,
        target: &Target,
    ) -> Result<Vec<Stations>> {
        let mut rivers = Vec::new();
        for (number, centre) in water.centres.iter().enumerate() {
            let mut stations = Stations::new(centre, network);
            let mut known = vec![None; centre.vertices.len()];
            if centre.is_hard {
                let stated = centre.vertices.iter().map(|&vertex| network.vertices[vertex as usize].z);
                known = stated.collect();
            } else {
                let mut near = vec![Vec::new(); known.len()];
                for (polygon, points) in water.polygons.iter().zip(shores) {
                    if polygon.centre == Some(number) {
                        for &[x, y, z] in points {
                            near[stations.nearest([x, y]).vertex()].push(z);
                        }
                    }
                }
                for (known, near) in known.iter_mut().zip(near) {
                    *known = percentile_of(near, percentile);
                    self.found += u64::from(known.is_some());
                }
            }
            let ends = [known.iter().flatten().next(), known.iter().flatten().next_back()];
            let is_upstream = matches!(ends, [Some(first), Some(last)] if first < last);
            let lowered = stations.settle(&known).ok_or_else(|| centre.position.fault(NO_SHORE))?;
            let place = || format!("{}: {}", centre.position.file, centre.position.position);
            if is_upstream {
                let world =
                    |z: Option<&f64>| target.coordinates.to_decimal([0.0, 0.0, *z.unwrap_or(&0.0)])[2];
                let [first, last] = ends.map(world);
                self.notices.push(format!(
                    "{}: the river rises from {first} to {last}: its centre line must lead downstream",
                    place()
                ));
            } else if centre.is_hard && lowered > 0 {
                self.notices.push(format!(
                    "{}: {lowered} vertices of the centre line were lowered to those upstream: give spconstrain \
                     lines without these elevations",
                    place()
                ));
            }
            rivers.push(stations);
        }
        Ok(rivers)
    }

    /// The vertices of a river.
    fn river(
        &mut self,
        network: &Network,
        water: &Water,
        polygon: &WaterPolygon,
        (centre, stations): (usize, &Stations),
        target: &Target,
    ) {
        let round = |z: f64| match target.coordinates {
            Coordinates::I32 { .. } => z.round(),
            Coordinates::F64 => z,
        };
        let mut take = |vertex: u32, z: f64| {
            let own = self.elevations.entry(vertex).or_insert(f64::INFINITY);
            *own = own.min(round(z));
        };
        for vertex in vertices(network, polygon) {
            let station = stations.nearest(network.vertices[vertex as usize].place);
            take(vertex, stations.elevation(station));
        }
        let inside = Polygons::of_edges(polygon.edges(network).map(|edge| (0, edge)));
        for (&vertex, &z) in water.centres[centre].vertices.iter().zip(&stations.elevations) {
            if inside.side(network.vertices[vertex as usize].place) != Side::Outside {
                take(vertex, z);
            }
        }
    }

    /// The vertices of lakes, and those of rivers in them.
    fn lakes(
        &mut self,
        network: &Network,
        water: &Water,
        shores: Vec<Vec<Point>>,
        percentile: f64,
    ) -> Result<()> {
        let mut levels = vec![None; water.polygons.len()];
        let mut of_lakes: BTreeMap<u32, (f64, usize)> = BTreeMap::new();
        for (number, (polygon, points)) in water.polygons.iter().zip(shores).enumerate() {
            if polygon.centre.is_some() {
                continue;
            }
            let level = match polygon.level {
                Some(level) => level,
                None => {
                    self.found += 1;
                    let heights = points.iter().map(|point| point[2]).collect();
                    percentile_of(heights, percentile).ok_or_else(|| polygon.position.fault(NO_SHORE))?
                }
            };
            levels[number] = Some(level);
            for vertex in vertices(network, polygon) {
                let (known, _) = *of_lakes.entry(vertex).or_insert((level, number));
                if known != level {
                    return Err(in_conflict(polygon));
                }
            }
        }
        let is_lake = |number: u32| levels[number as usize].is_some();
        let edges = water.edges(network).into_iter().filter(|&(number, _)| is_lake(number));
        let lakes = Polygons::of_edges(edges);
        for (&vertex, &(level, number)) in &of_lakes {
            let mut is_same = true;
            lakes.for_each_around(network.vertices[vertex as usize].place, |around| {
                is_same &= levels[around as usize] == Some(level);
            });
            if !is_same {
                return Err(in_conflict(&water.polygons[number]));
            }
        }
        for (&vertex, z) in &mut self.elevations {
            lakes.for_each_around(network.vertices[vertex as usize].place, |around| {
                *z = levels[around as usize].unwrap_or(*z);
            });
        }
        self.elevations.extend(of_lakes.into_iter().map(|(vertex, (level, _))| (vertex, level)));
        Ok(())
    }
}

const NO_SHORE: &str = "no points are near the shore: state its level (property level, or third coordinates), or look \
                        for points farther away with --shore-width";

fn in_conflict(polygon: &WaterPolygon) -> Error {
    polygon
        .position
        .fault("the lake meets another one of a different level: join them, or state one level for both")
}

/// The vertices of the border of a polygon, each once.
fn vertices(network: &Network, polygon: &WaterPolygon) -> Vec<u32> {
    let ends = polygon.segments.iter().flat_map(|&segment| network.segments[segment as usize].ends);
    let mut vertices: Vec<u32> = ends.collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// The least of the values such that `percent` of all, at least, are not above it; `None` of none.
fn percentile_of(mut values: Vec<f64>, percent: f64) -> Option<f64> {
    let rank = ((percent * values.len() as f64 / 100.0).ceil() as usize).clamp(1, values.len().max(1));
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(rank - 1, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values() {
        let of = |percent: f64| percentile_of(vec![5.0, 1.0, 3.0, 3.0], percent).unwrap();
        assert_eq!([0.0, 25.0, 26.0, 75.0, 75.1, 100.0].map(of), [1.0, 1.0, 3.0, 3.0, 5.0, 5.0]);
        assert_eq!(percentile_of(Vec::new(), 10.0), None);
    }
}
