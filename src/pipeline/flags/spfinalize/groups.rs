//! Flags for polygons, for water and for weights.

use std::path::PathBuf;

use clap::Args;

use crate::finalize::{Flatten, Weighing};
use crate::lines::Shore;
use spmesh_base::error::{Error, Result, counted};
use spmesh_shell::parse_numbers;

/// Polygons that select points. They apply after the filters, and before points are thinned.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Polygons")]
pub(super) struct AreaFlags {
    /// Keep only points inside of these polygons or on their border: GeoJSON, Shapefile, GeoPackage
    /// (FILE.gpkg:LAYER for one layer) or WKT. May be given several times: one of the polygons must have
    /// the point
    #[arg(long, value_name = "FILE")]
    pub(super) clip: Vec<PathBuf>,

    /// Drop points inside of these polygons; those on a border stay, unless another polygon has them inside.
    /// May be given several times
    #[arg(long, value_name = "FILE")]
    pub(super) drop_inside: Vec<PathBuf>,
}

impl AreaFlags {
    /// All files of polygons.
    pub(super) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.clip.iter().chain(&self.drop_inside)
    }
}

/// Lakes and rivers.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Water")]
pub(super) struct WaterFlags {
    /// Make the lakes and rivers of this file flat: points in them and on their shores are dropped, and
    /// vertices of shores become points at the level of the water. Polygons are lakes; their level is that of
    /// their vertices, or the property level, or else that of points near the shore. Polygons with the
    /// property river are rivers; a line with the same one is their centre line, and leads downstream. Two
    /// lines with the same river, and with the property bank left and right, are a river without a polygon.
    /// GeoJSON, Shapefile or GeoPackage (FILE.gpkg:LAYER for one layer). May be given several times
    #[arg(long, value_name = "FILE")]
    flatten: Vec<PathBuf>,

    /// Take this percentile of the elevations of points near the shore as the level, where none is stated
    #[arg(long, value_name = "P", default_value_t = 10.0, value_parser = parse_percentile, requires = "flatten")]
    shore_percentile: f64,

    /// Take the median of the points of class 9, which are water, as the level of a lake or at a station of a
    /// river, where N of them at least are in the polygon, and else that of the shore. Takes one more pass
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), requires = "flatten")]
    water_points: Option<u32>,

    /// Points are near a shore up to this distance, in world units [default: 4 times the mean distance
    /// between points, which takes one more pass]
    #[arg(long, value_name = "W", value_parser = parse_width, requires = "flatten")]
    shore_width: Option<f64>,

    /// Raise points of the input that are at most --shore-width away from a shore and below the water: to the
    /// water at the nearest place of the shore
    #[arg(long, requires = "shore_width")]
    raise_shore: bool,

    /// Write the lakes and rivers with their levels into this file, and no points: GeoJSON, cut at the box of
    /// the points, for --flatten of other runs and plans, and for spconstrain
    #[arg(long, value_name = "FILE", requires = "flatten", conflicts_with_all = ["output", "plan", "files", "report", "salvage", "preserve", "radii", "weights", "thin", "raise_shore"])]
    pub(super) levels: Option<PathBuf>,

    /// With --levels: say which stated levels of lakes differ by more than this from those that points near
    /// the shore have, in the unit of elevations
    #[arg(long, value_name = "T", default_value_t = 1.0, value_parser = parse_tolerance, requires = "levels")]
    level_tolerance: f64,

    /// With --levels: fail if there are such levels
    #[arg(long, requires = "levels")]
    strict: bool,
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

fn parse_tolerance(text: &str) -> std::result::Result<f64, String> {
    let [tolerance] = parse_numbers(text)?;
    let is_sound = tolerance >= 0.0 && tolerance.is_finite();
    is_sound
        .then_some(tolerance)
        .ok_or_else(|| format!("{text} is no tolerance: expected a number from 0 on"))
}

impl WaterFlags {
    /// All files of water.
    pub(super) fn files(&self) -> &[PathBuf] {
        &self.flatten
    }

    /// What the flags ask for.
    pub(super) fn flatten(&self) -> Flatten {
        Flatten {
            files: self.flatten.clone(),
            percentile: self.shore_percentile,
            width: self.shore_width,
            raise: self.raise_shore,
            water_points: self.water_points.map(|count| count as usize),
            is_part: false,
        }
    }

    /// What is to be said about stated levels that differ from those of points.
    ///
    /// # Errors
    /// Malformed, if there are some and `--strict` is given.
    pub(super) fn check_levels(&self, shores: &[Shore]) -> Result<Vec<String>> {
        let differs = |shore: &&Shore| {
            let stated = shore.level.filter(|_| shore.is_stated);
            let pair = stated.zip(shore.measured);
            pair.is_some_and(|(level, measured)| (level - measured).abs() > self.level_tolerance)
        };
        let of = |shore: &Shore| {
            let [level, measured] = [shore.level, shore.measured].map(Option::unwrap_or_default);
            let points = counted(shore.points as u64, "point", "points");
            let place = if shore.are_in_water { "in the water" } else { "near the shore" };
            format!("{}: the level {level} is stated, but {points} {place} say {measured}", shore.feature)
        };
        let notices: Vec<String> = shores.iter().filter(differs).map(of).collect();
        match notices.first() {
            Some(first) if self.strict => {
                let all = counted(notices.len() as u64, "such lake", "such lakes");
                Err(Error::malformed(format!(
                    "{first}: correct it, or remove it so that points count ({all})"
                )))
            }
            _ => Ok(notices),
        }
    }
}

/// Weights of points of space.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Weights, for spdelaunay3d --weights")]
pub(super) struct WeightFlags {
    /// Weight = radius squared: the name of an attribute with radii, such as radius of a PLY file; for atoms,
    /// a table (protor, bondi, united, charmm, own) or a file of radii, as in tess3
    #[arg(long, value_name = "NAME|FILE", requires = "octree")]
    radii: Option<String>,

    /// Radius of a probe that is added to each radius, in units of the coordinates, for atoms Å [default: 0]
    #[arg(long, value_name = "RADIUS", requires = "radii", conflicts_with = "weights")]
    #[arg(allow_hyphen_values = true, value_parser = parse_probe)]
    probe: Option<f64>,

    /// The name of an attribute that holds the weights: for balls, the squares of radii
    #[arg(
        long,
        value_name = "NAME",
        requires = "octree",
        conflicts_with = "radii",
        allow_hyphen_values = true
    )]
    weights: Option<String>,
}

impl WeightFlags {
    /// What points are weighed by, if they are.
    pub(super) fn load(&self) -> Result<Option<Weighing>> {
        match (&self.weights, &self.radii) {
            (Some(attribute), _) => Ok(Some(Weighing::by_weights(attribute))),
            (None, Some(name)) => Weighing::by_radii(name, self.probe.unwrap_or(0.0)).map(Some),
            (None, None) => Ok(None),
        }
    }
}

fn parse_probe(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(probe) if probe.is_finite() && probe >= 0.0 => Ok(probe),
        _ => Err("expected a length from 0 on".into()),
    }
}
