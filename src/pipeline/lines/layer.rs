//! Water with its levels, as a layer for other runs and for a GIS.

use std::io::{self, Write};

use serde_json::Value;

use super::Target;
use super::cut::cut;
use super::levels::{Levels, Near, percentile_of};
use super::report::Found;
use super::stations::Stations;
use super::water::{Stated, Water, WaterPolygon};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::network::Network;
use spmesh_formats::source::{collection_head, epsg_code};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::decimal::Decimal;

/// The parts of the elevations of points near a shore, in percent, between which is their spread.
const SPREAD: [f64; 2] = [10.0, 90.0];

/// What a layer is made of.
pub(crate) struct Layer<'a> {
    pub(crate) network: &'a Network,
    pub(crate) water: &'a Water,
    pub(crate) levels: &'a Levels,
    /// Of each polygon, the points near its shore and in it.
    pub(crate) near: &'a [Near],
    /// The box of all points.
    pub(crate) bounds: Bounds,
    pub(crate) percentile: f64,
    pub(crate) target: &'a Target,
}

/// What points near its shore say of a polygon, in the units of the world.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shore {
    /// Name of the file of the polygon, and position in it.
    pub feature: String,
    /// Name of its river.
    pub river: Option<String>,
    /// Level of a lake.
    pub level: Option<f64>,
    /// Where the level is from: `property`, `coordinates`, `points` near the shore, or those of `water`.
    pub source: &'static str,
    /// Whether the file states the level.
    pub is_stated: bool,
    /// Number of points that say the level.
    pub points: usize,
    /// Whether these are points of water, and not those near the shore.
    pub are_in_water: bool,
    /// The percentile of their elevations by which a level is found.
    pub measured: Option<f64>,
    /// The difference between the elevations with 10 % and with 90 % of all at or below them.
    pub spread: Option<f64>,
    /// Number of points near the shore that are below the water at its nearest place.
    pub below: usize,
}

impl Layer<'_> {
    /// Writes the layer as GeoJSON: each polygon with its level as third coordinates, cut at the box of the
    /// points. Returns what is said of each.
    ///
    /// # Errors
    /// If writing fails.
    pub(crate) fn write(&self, output: &mut dyn Write) -> Result<Vec<Shore>> {
        let mut shores = Vec::new();
        for (number, polygon) in self.water.polygons.iter().enumerate() {
            let level = self.levels.of_lakes.get(&number).copied();
            let rings: Vec<Vec<Point>> = polygon.rings.iter().map(|ring| self.ring(ring, level)).collect();
            let parts = cut(&rings, &self.bounds, &self.target.coordinates);
            if !parts.is_empty() {
                shores.push((self.shore(number, level, &rings), parts));
            }
        }
        self.features(&shores, output).map_err(|e| Error::io("writing the levels", e))?;
        Ok(shores.into_iter().map(|(shore, _)| shore).collect())
    }

    /// The vertices of a ring at the level of the water, in stored coordinates. Those of parts that bound no
    /// water, as a ring has them twice, may have none.
    fn ring(&self, ring: &[u32], level: Option<f64>) -> Vec<Point> {
        let vertex = |vertex: &u32| {
            let [x, y] = self.network.vertices[*vertex as usize].place;
            [x, y, level.or(self.levels.elevations.get(vertex).copied()).unwrap_or_default()]
        };
        ring.iter().map(vertex).collect()
    }

    fn shore(&self, number: usize, level: Option<f64>, rings: &[Vec<Point>]) -> Shore {
        let (polygon, near) = (&self.water.polygons[number], &self.near[number]);
        let (points, percentile) = near.counting(self.percentile);
        let found = source(polygon, self.water, near);
        let world = |z: f64| self.target.coordinates.to_decimal([0.0, 0.0, z])[2];
        let at = |percent: f64| percentile_of(points.iter().map(|point| point[2]).collect(), percent);
        let [low, high] = SPREAD.map(at);
        Shore {
            feature: polygon.position.to_string(),
            river: polygon.river_name(self.water).map(str::to_string),
            level: level.map(world),
            source: found.name(),
            is_stated: matches!(found, Found::Property | Found::Coordinates),
            points: points.len(),
            are_in_water: !near.in_water.is_empty(),
            measured: at(percentile).map(world),
            spread: low.zip(high).map(|(low, high)| world(high) - world(low)),
            below: match level {
                Some(level) => near.points.iter().filter(|point| point[2] < level).count(),
                None => below(rings, &near.points),
            },
        }
    }

    fn features(&self, shores: &[(Shore, Vec<Vec<Vec<Point>>>)], output: &mut dyn Write) -> io::Result<()> {
        output.write_all(collection_head(epsg_code(&self.target.crs)).as_bytes())?;
        for (number, (shore, parts)) in shores.iter().enumerate() {
            output.write_all(if number > 0 { b",\n" } else { b"\n" })?;
            let properties = shore.properties();
            let of_part = |rings: &Vec<Vec<Point>>| {
                let rings: Vec<String> = rings.iter().map(|ring| self.coordinates(ring)).collect();
                format!("[{}]", rings.join(","))
            };
            let (kind, coordinates) = match &parts[..] {
                [part] => ("Polygon", of_part(part)),
                parts => {
                    ("MultiPolygon", format!("[{}]", parts.iter().map(of_part).collect::<Vec<_>>().join(",")))
                }
            };
            write!(
                output,
                r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
            )?;
        }
        output.write_all(b"\n]}\n")?;
        output.flush()
    }

    fn coordinates(&self, ring: &[Point]) -> String {
        let vertex = |&place: &Point| {
            let [x, y, z] = self.target.coordinates.to_decimal(place).map(|number| Decimal(number + 0.0));
            format!("[{x},{y},{z}]")
        };
        format!("[{}]", ring.iter().map(vertex).collect::<Vec<_>>().join(","))
    }
}

impl Shore {
    fn properties(&self) -> Value {
        let mut properties = serde_json::Map::new();
        let mut enter = |name: &str, value: Value| _ = properties.insert(name.to_string(), value);
        match &self.river {
            Some(river) => enter("river", Value::from(&**river)),
            None => enter("level", self.level.into()),
        }
        enter("measured", self.measured.into());
        enter("spread", self.spread.into());
        enter("points", self.points.into());
        enter("below", self.below.into());
        enter("source", self.source.into());
        enter("feature", Value::from(&*self.feature));
        Value::Object(properties)
    }
}

/// How the levels of a polygon are found.
fn source(polygon: &WaterPolygon, water: &Water, near: &Near) -> Found {
    match polygon.level {
        Some(Stated { by_property: true, .. }) => Found::Property,
        None if polygon.needs_points(water) => near.found(0),
        _ => Found::Coordinates,
    }
}

/// How many points are below the water at the place of the shore that is nearest to each.
fn below(rings: &[Vec<Point>], points: &[Point]) -> usize {
    let shores: Vec<Stations> =
        rings.iter().filter(|ring| ring.len() > 1).map(|ring| Stations::of(ring)).collect();
    let level = |place| {
        let nearest = shores.iter().map(|shore| shore.nearest_level(place));
        nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, level)| level)
    };
    points.iter().filter(|&&[x, y, z]| level([x, y]).is_some_and(|level| z < level)).count()
}
