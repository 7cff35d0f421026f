//! The values and colours of triangles and points.

use super::canvas::Paint;
use super::options::{Fill, Options, When};
use super::sheet::{Legend, Units};
use super::shown::{self, Shown};
use spmesh_formats::raster::Light;
use spmesh_formats::raster::colour_map::{self, BATLOW, Colour, ColourMap, VIK, VIRIDIS};
use spmesh_stream::model::bounds::Point;

/// The colour of triangles that show nothing.
const BARE: Colour = [255; 3];

/// What triangles and points show.
#[derive(Debug, Clone)]
pub(super) struct Style {
    fill: Option<Fill>,
    edges: When,
    light: Light,
    range: Option<[f64; 2]>,
    stretch: Option<[f64; 2]>,
    middle: Option<f64>,
    /// Whether vertices have elevations.
    has_elevation: bool,
    /// Units of x and y that one unit of elevation is.
    unit_of_z: f64,
    /// The plural of the counted items.
    unit: &'static str,
    /// What values are called, if they are not times.
    label: String,
}

/// The map from values to colours, when the range of values is known.
#[derive(Debug, Clone)]
pub(super) struct Colours {
    fill: Fill,
    colour_map: &'static ColourMap,
    range: [f64; 2],
    /// The range of all values.
    all: [f64; 2],
    /// The brightness of level ground.
    level: f64,
    has_middle: bool,
    unit: &'static str,
    label: String,
}

impl Style {
    pub(super) fn of(
        options: &Options,
        shown: &Shown,
        units: &Units,
        has_elevation: bool,
        unit: &'static str,
    ) -> Style {
        let Options { fill, edges, light, range, stretch, middle, .. } = *options;
        let (fill, label) = (shown.fill().or(fill), shown.label(units));
        let unit_of_z = units.of_heights;
        Style { fill, edges, light, range, stretch, middle, has_elevation, unit_of_z, unit, label }
    }

    /// What triangles show. By default, the relief if they have elevations; otherwise nothing but edges, or
    /// the time where painted triangles are too many for edges.
    pub(super) fn fill(&self, is_painted: bool) -> Fill {
        let flat = if is_painted { Fill::Time } else { Fill::None };
        self.fill.unwrap_or(if self.has_elevation { Fill::Relief } else { flat })
    }

    /// What points show.
    pub(super) fn point_fill(&self) -> Fill {
        self.fill.unwrap_or(Fill::Time)
    }

    /// Whether edges of triangles are drawn.
    pub(super) fn has_edges(&self, is_painted: bool) -> bool {
        match self.edges {
            When::Always => true,
            When::Never => false,
            When::Auto => !is_painted || self.fill(is_painted) == Fill::None,
        }
    }

    /// The values and brightness of a triangle with corners in the world; `number` is the number of triangles
    /// before it.
    pub(super) fn paint(&self, fill: Fill, corners: &[Point; 3], number: u64) -> Paint {
        let values = match fill {
            Fill::Elevation | Fill::Relief | Fill::Attribute => corners.map(|corner| corner[2]),
            Fill::Colour => [shown::mean(corners.map(|corner| corner[2])); 3],
            Fill::Time => [number as f64; 3],
            Fill::Hillshade | Fill::None => [0.0; 3],
        };
        let is_lit = matches!(fill, Fill::Hillshade | Fill::Relief);
        let shade = if is_lit {
            colour_map::shade(&self.light, gradient(corners).map(|part| part * self.unit_of_z))
        } else {
            1.0
        };
        Paint { values, shades: [shade; 3] }
    }

    /// The value of a point; `number` is the number of points before it.
    pub(super) fn value(&self, fill: Fill, at: Point, number: u64) -> f64 {
        match fill {
            Fill::Elevation | Fill::Attribute | Fill::Colour => at[2],
            _ => number as f64,
        }
    }

    /// The colours of a range of elevations, or of times up to `count`; `percentiles` finds those of the
    /// values.
    pub(super) fn colours(
        &self,
        fill: Fill,
        all: [f64; 2],
        count: u64,
        percentiles: impl FnOnce([f64; 2]) -> Option<[f64; 2]>,
    ) -> Colours {
        let shows_elevation = matches!(fill, Fill::Elevation | Fill::Relief | Fill::Attribute);
        let stretch = self.stretch.filter(|_| shows_elevation && self.range.is_none());
        let stretched = stretch.and_then(|percents| {
            let [low, high] = percentiles(percents)?;
            // Samples of a picture may miss the ends.
            Some([
                if percents[0] > 0.0 { low } else { all[0] },
                if percents[1] < 100.0 { high } else { all[1] },
            ])
        });
        let elevations = self.range.or(stretched).unwrap_or(all);
        let (colour_map, range, all) = match self.middle {
            _ if !shows_elevation => (&VIRIDIS, [0.0, count as f64], [0.0, count as f64]),
            None => (&BATLOW, elevations, all),
            Some(middle) => {
                let reach = elevations.map(|elevation| (elevation - middle).abs());
                let reach = reach[0].max(reach[1]);
                (&VIK, [middle - reach, middle + reach], all)
            }
        };
        let level = colour_map::shade(&self.light, [0.0; 2]).clamp(0.05, 0.95);
        let (has_middle, unit, label) = (self.middle.is_some(), self.unit, self.label.clone());
        Colours { fill, colour_map, range, all, level, has_middle, unit, label }
    }
}

impl Colours {
    /// The colour of a value on a surface of some brightness.
    pub(super) fn of(&self, value: f64, shade: f64) -> Colour {
        match self.fill {
            Fill::None => BARE,
            Fill::Hillshade => colour_map::grey(shade),
            Fill::Colour => shown::unpack(value),
            Fill::Elevation | Fill::Time | Fill::Attribute => self.colour_map.at(self.part(value)),
            Fill::Relief => colour_map::lit(self.colour_map.at(self.part(value)), shade, self.level),
        }
    }

    /// The legend of the colours, if they show values.
    pub(super) fn legend(&self) -> Option<Legend> {
        let label = match self.fill {
            Fill::None | Fill::Hillshade | Fill::Colour => return None,
            Fill::Time => format!("Position in the stream ({})", self.unit),
            _ if self.has_middle => format!("{}, below and above the middle", self.label),
            Fill::Elevation | Fill::Relief | Fill::Attribute => self.label.clone(),
        };
        let is_count = self.fill == Fill::Time;
        Some(Legend { label, colour_map: self.colour_map, range: self.range, all: self.all, is_count })
    }

    /// The position of a value in the range, from 0 to 1. Halves first: the differences themselves may
    /// overflow.
    fn part(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if high > low { (0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low) } else { 0.5 }
    }
}

/// The gradient of the plane through three points.
fn gradient([a, b, c]: &[Point; 3]) -> [f64; 2] {
    let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
    let determinant = u[0] * v[1] - u[1] * v[0];
    [(u[2] * v[1] - u[1] * v[2]) / determinant, (u[0] * v[2] - u[2] * v[0]) / determinant]
}
