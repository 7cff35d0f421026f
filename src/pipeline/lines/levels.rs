//! The levels of lakes and rivers at the vertices of their shores.

use std::collections::{BTreeMap, BTreeSet};

use super::Target;
use super::report::{Found, LevelRow};
use super::water::{Stated, Water, WaterPolygon};
use crate::polygons::Polygons;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::network::Network;
use spmesh_stream::model::bounds::Point;

/// The levels of water.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Levels {
    /// Stored elevations of vertices of the network that are on shores or on centre lines inside of their
    /// river.
    pub elevations: BTreeMap<u32, f64>,
    /// Stored levels of lakes, by the numbers of their polygons.
    pub(crate) of_lakes: BTreeMap<usize, f64>,
    /// Vertices of the network that only water has that was left out.
    pub(crate) left_out: BTreeSet<u32>,
    /// Levels that were found from points.
    pub found: u64,
    /// Messages for the user.
    pub notices: Vec<String>,
    /// Lakes and stations of rivers, for the report.
    pub(crate) rows: Vec<LevelRow>,
}

/// Points that say the level of a polygon of water.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Near {
    /// Those near the shore.
    pub(crate) points: Vec<Point>,
    /// Those of water in the polygon, where they are enough.
    pub(crate) in_water: Vec<Point>,
}

impl Near {
    /// Takes points of water, if there are `enough`.
    pub(crate) fn take_water(&mut self, points: Vec<Point>, enough: usize) {
        if points.len() >= enough {
            self.in_water = points;
        }
    }

    /// The points that count, and the percentile of their elevations that is the level, where `percentile` is
    /// that for points near shores.
    pub(crate) fn counting(&self, percentile: f64) -> (&[Point], f64) {
        if self.in_water.is_empty() { (&self.points, percentile) } else { (&self.in_water, MEDIAN) }
    }

    /// How a level from these is found: by so many of them.
    pub(crate) fn found(&self, count: usize) -> Found {
        if self.in_water.is_empty() { Found::Points(count) } else { Found::WaterPoints(count) }
    }
}

/// The percentile of points of water that is a level.
pub(crate) const MEDIAN: f64 = 50.0;

/// What levels are found from.
pub(crate) struct Given<'a> {
    pub(crate) network: &'a Network,
    pub(crate) water: &'a Water,
    /// Of each polygon, the points that say its level.
    pub(crate) near: &'a [Near],
    pub(crate) percentile: f64,
    pub(crate) target: &'a Target,
    /// The numbers of the polygons of each river.
    pub(crate) of_rivers: Vec<Vec<usize>>,
}

impl Levels {
    /// Finds the levels. `near` are the points near the shore of each polygon, where it needs them, and
    /// `percentile` of their elevations counts: the least one such that this part of all, in percent, is not
    /// above it.
    ///
    /// Lakes come before rivers: a vertex of a river at the shore of a lake or inside of it takes the level
    /// of the lake. Of several rivers, the lowest counts.
    ///
    /// # Errors
    /// Malformed, with the position, if a polygon needs points and has none, or lakes of different levels
    /// meet.
    pub(crate) fn find(
        network: &Network,
        water: &Water,
        near: &[Near],
        percentile: f64,
        target: &Target,
    ) -> Result<Levels> {
        let given = Given { network, water, near, percentile, target, of_rivers: water.of_rivers() };
        let mut levels = Levels::default();
        for number in 0..water.rivers.len() {
            levels.river(&given, number)?;
        }
        water.polygons.iter().filter(|it| it.own.is_some()).for_each(|it| levels.own(&given, it));
        levels.lakes(&given)?;
        Ok(levels)
    }

    /// The vertices of lakes, and those of rivers in them.
    fn lakes(&mut self, given: &Given) -> Result<()> {
        let &Given { network, water, .. } = given;
        let mut of_lakes: BTreeMap<u32, (f64, usize)> = BTreeMap::new();
        for (number, polygon) in water.polygons.iter().enumerate() {
            if !polygon.is_lake() {
                continue;
            }
            let level = self.lake(given, number)?;
            self.of_lakes.insert(number, level);
            for vertex in vertices(network, polygon) {
                let (known, _) = *of_lakes.entry(vertex).or_insert((level, number));
                if known != level {
                    return Err(in_conflict(polygon));
                }
            }
        }
        let edges = water.edges(network).into_iter();
        let edges = edges.filter(|(number, _)| water.polygons[*number as usize].is_lake());
        let lakes = Polygons::of_edges(edges);
        for (&vertex, &(level, number)) in &of_lakes {
            let mut is_same = true;
            lakes.for_each_around(network.vertices[vertex as usize].place, |around| {
                is_same &= self.of_lakes.get(&(around as usize)) == Some(&level);
            });
            if !is_same {
                return Err(in_conflict(&water.polygons[number]));
            }
        }
        for (&vertex, z) in &mut self.elevations {
            lakes.for_each_around(network.vertices[vertex as usize].place, |around| {
                *z = self.of_lakes.get(&(around as usize)).copied().unwrap_or(*z);
            });
        }
        self.elevations.extend(of_lakes.into_iter().map(|(vertex, (level, _))| (vertex, level)));
        Ok(())
    }

    /// The level of a lake.
    fn lake(&mut self, given: &Given, number: usize) -> Result<f64> {
        let polygon = &given.water.polygons[number];
        let (level, found) = match polygon.level {
            Some(Stated { level, by_property: true }) => (level, Found::Property),
            Some(Stated { level, by_property: false }) => (level, Found::Coordinates),
            None => {
                self.found += 1;
                let near = &given.near[number];
                let (points, percentile) = near.counting(given.percentile);
                let level = percentile_of(points.iter().map(|point| point[2]).collect(), percentile);
                (level.ok_or_else(|| polygon.position.fault(NO_SHORE))?, near.found(points.len()))
            }
        };
        self.rows.push(LevelRow::of_lake(given, polygon, level, found));
        Ok(level)
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
pub(crate) fn vertices(network: &Network, polygon: &WaterPolygon) -> Vec<u32> {
    let ends = polygon.segments.iter().flat_map(|&segment| network.segments[segment as usize].ends);
    let mut vertices: Vec<u32> = ends.collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// The least of the values such that `percent` of all, at least, are not above it; `None` of none.
pub(crate) fn percentile_of(mut values: Vec<f64>, percent: f64) -> Option<f64> {
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
