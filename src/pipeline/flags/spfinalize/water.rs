//! Flags for lakes and rivers.

use std::path::PathBuf;

use clap::Args;

use crate::finalize::{Areas, Observer, Passes, Selected, Shores, shore_width};
use crate::lines::{Levels, Target, Water};
use spmesh_base::error::Result;
use spmesh_delaunay::network::Network;
use spmesh_shell::parse_numbers;
use spmesh_stream::Coordinates;

/// Lakes and rivers.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Water")]
pub(super) struct WaterFlags {
    /// Make the lakes and rivers of this file flat: points in them and on their shores are dropped, and
    /// vertices of shores become points at the level of the water. Polygons are lakes; their level is that of
    /// their vertices, or the property level, or else that of points near the shore. Polygons with the
    /// property river are rivers; a line with the same one is their centre line, and leads downstream. Two
    /// lines with the same river, and with the property bank left and right, are a river without a polygon.
    /// GeoJSON, Shapefile or GeoPackage. May be given several times
    #[arg(long, value_name = "FILE")]
    flatten: Vec<PathBuf>,

    /// Take this percentile of the elevations of points near the shore as the level, where none is stated
    #[arg(long, value_name = "P", default_value_t = 10.0, value_parser = parse_percentile, requires = "flatten")]
    shore_percentile: f64,

    /// Points are near a shore up to this distance, in world units [default: 4 times the mean distance
    /// between points, which takes one more pass]
    #[arg(long, value_name = "W", value_parser = parse_width, requires = "flatten")]
    shore_width: Option<f64>,
}

fn parse_percentile(text: &str) -> std::result::Result<f64, String> {
    let [percent] = parse_numbers(text)?;
    let is_sound = (0.0..=100.0).contains(&percent);
    is_sound.then_some(percent).ok_or_else(|| format!("{text} is no percentile: expected 0 to 100"))
}

fn parse_width(text: &str) -> std::result::Result<f64, String> {
    let [width] = parse_numbers(text)?;
    let is_sound = width > 0.0 && width.is_finite();
    is_sound.then_some(width).ok_or_else(|| format!("{text} is no width: expected a positive number"))
}

impl WaterFlags {
    /// All files of water.
    pub(super) fn files(&self) -> &[PathBuf] {
        &self.flatten
    }

    /// Finds the levels, from points of `input` that `areas` select if none are stated; the points in water
    /// are then dropped, too.
    pub(super) fn levels<P: Passes>(
        &self,
        (network, water): (&Network, &Water),
        (input, areas): (&P, Areas),
        target: &Target,
        observer: &mut dyn Observer,
    ) -> Result<(Areas, Levels)> {
        if water.polygons.is_empty() {
            return Ok((areas, Levels::default()));
        }
        let (edges, needed) = (water.edges(network), water.need_points());
        let mut shores = Vec::new();
        if needed.contains(&true) {
            let points = Selected::new(input, &areas);
            let width = match (self.shore_width, target.coordinates) {
                (Some(width), Coordinates::I32 { scale, .. }) => Some(width / scale[0]),
                (Some(width), Coordinates::F64) => Some(width),
                (None, _) => shore_width(&points, observer)?,
            };
            let near = Shores::new(edges.clone(), &needed, width.unwrap_or(1.0));
            shores = near.collect(&points, observer)?;
        }
        let levels = Levels::find(network, water, shores, self.shore_percentile, target)?;
        Ok((areas.with_water(edges.into_iter()), levels))
    }

    /// Lakes, rivers, and levels that were found from points; `None` without water.
    pub(super) fn counts(&self, water: &Water, levels: &Levels) -> Option<[u64; 3]> {
        let [lakes, rivers] = water.counts();
        (!self.flatten.is_empty()).then_some([lakes, rivers, levels.found])
    }
}
