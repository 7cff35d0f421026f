//! What a raster shows, and how it is drawn and written.

use std::sync::Arc;

use super::facet::out_of_range;
use super::surroundings::Surroundings;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::crs::{Horizontal, System};
use spmesh_formats::raster::{
    self, Differences, Gradient, Grid, RasterFile, RasterOptions, Reduction, Reference, Samples, Shading,
};
use spmesh_formats::source::Mask;
use spmesh_pipeline::finalize::Banks;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Crs, Header};

/// The equatorial radius of the Earth (WGS 84). Units: metres.
const EARTH_RADIUS: f64 = 6_378_137.0;

/// How values between vertices follow from those of the vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Linear in each triangle.
    Linear,
    /// The value of the nearest corner of the triangle; of several, the one with the least x, then the least
    /// y.
    Nearest,
}

/// The quantity that cells hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// The elevation at the centre.
    Elevation,
    /// The angle of the surface with the horizontal, in degrees.
    Slope,
    /// The direction of steepest descent, in degrees clockwise from north; no data where the surface is
    /// level.
    Aspect,
    /// The brightness of the surface in some light, as bytes from 1 to 255.
    Hillshade(Shading),
    /// The colour of the elevation, lit as a hillshade: red, green, blue and opacity. Colours span these
    /// elevations, or all that the header of the mesh states. It follows from cells whatever the method.
    ShadedRelief(Shading, Option<[f64; 2]>),
    /// An attribute of the points, as `spmesh_stream::model::attributes::Attributes::column` takes it.
    Attribute(String, Interpolation),
}

/// What of the surface over a cell its elevation is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sample {
    /// The elevation at the centre.
    #[default]
    Centre,
    /// The mean over the part of the cell that the mesh covers.
    Mean,
    /// The least one there.
    Min,
    /// The greatest one there.
    Max,
}

impl Sample {
    /// Whether the surface over the whole cell counts.
    pub fn is_whole(self) -> bool {
        self != Sample::Centre
    }
}

/// What slopes, aspects and hillshades are those of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The triangle at the centre of the cell.
    Triangle,
    /// The cells of the raster of elevations: of a cell and its eight neighbours. A cell without all of them
    /// has no value.
    Cells(Differences),
}

/// What is drawn, and the memory for it.
#[derive(Debug, Clone)]
pub struct Options {
    /// The quantity that cells hold.
    pub quantity: Quantity,
    /// What of the surface over a cell its value is. With any but [`Sample::Centre`], nothing is filled.
    pub sample: Sample,
    /// Whether elevations are interpolated by natural neighbours, and not linearly in triangles.
    pub natural: bool,
    /// What slopes, aspects and hillshades are those of.
    pub method: Method,
    /// How many units of x and y one unit of elevations is, for slopes; as the coordinate reference system
    /// states it if `None`.
    pub z_factor: Option<f64>,
    /// Triangles with a longer edge are left out. Units: those of the world.
    pub kill: Option<f64>,
    /// Triangles outside of the concave outline are left out: a chain of triangles leads to them from the
    /// convex hull in which every crossed edge is longer than this. Units: those of the world.
    pub concave: Option<f64>,
    /// Cells with centres outside of these polygons have no data.
    pub mask: Option<Arc<Mask>>,
    /// Cells hold how far the ground on shores is below the water, and not its elevation.
    pub banks: Option<Arc<Banks>>,
    /// Cells without data inside of the outline and the mask are filled from data at most this many cells
    /// away.
    pub fill: Option<u32>,
    /// Bytes for tiles, and for triangles that wait for the outline; others wait in temporary files.
    pub memory: u64,
    /// Bytes for vertices that are not final, beside these; unlimited if `None`.
    pub vertices_memory: Option<u64>,
    /// How the raster is written.
    pub raster: RasterOptions,
    /// The coordinate reference system, if not that of the mesh.
    pub crs: Option<Crs>,
}

impl Options {
    /// What the raster says of its coordinates.
    pub(super) fn reference(&self, crs: &Crs) -> Reference {
        Reference::of_crs(crs, self.quantity == Quantity::Elevation, self.raster.format)
    }

    /// How many units of x and y one unit of elevations is, for slopes in the mesh with this header.
    ///
    /// # Errors
    /// Usage, if slopes are drawn over angles, of which a unit has no length that is the same everywhere.
    pub(super) fn unit_of_z(&self, system: &System, header: &Header) -> Result<f64> {
        let stated = self.z_factor.or_else(|| system.vertical_ratio());
        let angular = system.horizontal.as_ref().filter(|known| known.is_angular());
        match angular {
            Some(horizontal) if stated.is_none() && self.quantity.is_derived() => {
                let metres = system.vertical.as_ref().map_or(1.0, |heights| heights.unit.size);
                Err(in_angles(horizontal, metres, header))
            }
            _ => Ok(stated.unwrap_or(1.0)),
        }
    }

    /// The closed box of the world whose triangles decide the raster, in a mesh of which only these may be
    /// read; `None` if all triangles do.
    ///
    /// A cell follows from the triangle at its centre, or from those over all of it; slopes and holes that
    /// are filled, from cells around it. `header` is that of the mesh.
    pub fn window(&self, grid: &Grid, header: &Header) -> Option<Bounds> {
        let grid = self.surroundings(grid, header).drawn;
        // The way of a concave outline begins at the border of the mesh, however far away that is. So large
        // may circles of triangles be.
        if self.concave.is_some() || self.natural {
            return None;
        }
        let reach = if self.sample.is_whole() { 0.5 * grid.step } else { 0.0 };
        let [left, bottom] = grid.center(0, grid.rows - 1).map(|centre| centre - reach);
        let [right, top] = grid.center(grid.columns - 1, 0).map(|centre| centre + reach);
        let cells = Bounds::over([left, bottom], [right, top]);
        // Elevations outside of the mask are taken away before slopes are found, and before holes are filled.
        let Some(mask) = self.mask.as_ref().and_then(|mask| mask.window(reach)) else { return Some(cells) };
        Some(Bounds {
            min: [0, 1, 2].map(|axis| cells.min[axis].max(mask.min[axis])),
            max: [0, 1, 2].map(|axis| cells.max[axis].min(mask.max[axis])),
        })
    }

    /// What is drawn for a raster of the mesh with this header.
    pub(super) fn surroundings(&self, grid: &Grid, header: &Header) -> Surroundings {
        let is_derived = self.quantity.is_derived() && (self.fill.is_some() || self.differences().is_some());
        let reach = self.fill.unwrap_or(0).saturating_add(is_derived.into());
        Surroundings::new(grid, reach, super::window(header).ok())
    }

    /// What of the raster needs the triangles around a triangle, so that it is wrong at the border of a part
    /// of a mesh; `None` if rasters of parts are parts of one raster.
    pub fn beyond(&self) -> Option<&'static str> {
        if self.differences().is_some() {
            return Some("a value that follows from neighbouring cells");
        }
        if self.fill.is_some() {
            return Some("a hole that is filled");
        }
        if self.concave.is_some() {
            return Some("a concave outline");
        }
        if self.natural {
            return Some("a value of natural neighbours");
        }
        self.sample.is_whole().then_some("the surface over a whole cell")
    }

    /// The raster file.
    pub(super) fn file<'a>(&'a self, grid: Grid, reference: &'a Reference) -> RasterFile<'a> {
        // Directions have no mean: that of north-east and north-west would be south. Nor have classes.
        let reduction = match self.quantity {
            Quantity::Aspect | Quantity::Attribute(_, Interpolation::Nearest) => Reduction::First,
            _ => Reduction::Mean,
        };
        // Holes are filled from tiles that are already written, so these must be readable.
        let is_staged = self.fill.is_some();
        let samples = match self.quantity {
            Quantity::Hillshade(_) => Samples::Bytes,
            Quantity::ShadedRelief(..) => Samples::Colours,
            _ => Samples::Floats,
        };
        RasterFile { options: &self.raster, grid, reference, reduction, samples, is_staged }
    }

    /// The quantity that is drawn from triangles.
    pub(super) fn drawn(&self) -> Quantity {
        if self.differences().is_some() { Quantity::Elevation } else { self.quantity.clone() }
    }

    /// How the quantity follows from cells of elevations, if it does.
    pub(super) fn differences(&self) -> Option<Differences> {
        match (self.method, &self.quantity) {
            (Method::Cells(differences), quantity) if quantity.is_derived() => Some(differences),
            (Method::Triangle, Quantity::ShadedRelief(..)) => Some(Differences::Horn),
            _ => None,
        }
    }
}

/// The error of slopes over angles. It names the factor for slopes to east and west in the middle of the
/// mesh, as programs of ESRI take it; `metres` is the unit of elevations.
fn in_angles(horizontal: &Horizontal, metres: f64, header: &Header) -> Error {
    let latitude = header.bounds.map(|bounds| {
        let [south, north] = [bounds.min, bounds.max].map(|corner| header.coordinates.to_world(corner)[1]);
        0.5 * (south + north) * horizontal.unit.size
    });
    let example = latitude.filter(|angle| angle.abs() < 1.5).map_or(String::new(), |angle| {
        let factor = metres / (EARTH_RADIUS * horizontal.unit.size * angle.cos());
        format!(", which is about {factor:.3e} for slopes to east and west here")
    });
    Error::usage(format!(
        "x and y are angles, over which slopes are not those of the ground: project the points first, or give --z-factor, \
         the part of a unit of x that one of z is long{example}"
    ))
}

impl Quantity {
    /// How values vary in a triangle.
    pub(super) fn interpolation(&self) -> Interpolation {
        match self {
            Quantity::Attribute(_, interpolation) => *interpolation,
            _ => Interpolation::Linear,
        }
    }

    /// Whether it follows from the gradient of elevations.
    pub(super) fn is_derived(&self) -> bool {
        matches!(
            self,
            Quantity::Slope | Quantity::Aspect | Quantity::Hillshade(_) | Quantity::ShadedRelief(..)
        )
    }

    /// The value of a whole plane, from its gradient, in which all coordinates have one unit; `None` if it
    /// varies.
    pub(super) fn of_plane(&self, gradient: Point2) -> Result<Option<f32>> {
        let value = match self {
            Quantity::Elevation | Quantity::Attribute(..) => return Ok(None),
            _ if !gradient.iter().all(|part| part.is_finite()) => return Err(out_of_range()),
            Quantity::Slope => raster::slope(gradient) as f32,
            Quantity::Aspect => raster::rounded_aspect(gradient),
            Quantity::Hillshade(shading) | Quantity::ShadedRelief(shading, _) => {
                shading.byte(gradient).into()
            }
        };
        Ok(Some(value))
    }

    /// The value of a cell from its elevation and those of its eight neighbours.
    #[inline]
    pub(super) fn of_cells(&self, gradient: &Gradient, cells: &[f32; 9]) -> Result<f32> {
        let gradient = match self {
            Quantity::Hillshade(Shading::One(_)) => gradient.of_pairs(cells),
            _ => gradient.at(cells),
        };
        Ok(self.of_plane(gradient)?.unwrap_or(f32::NAN))
    }
}
