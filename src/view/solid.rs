//! Pictures of surfaces in space, seen by parallel projection from any side.

use super::canvas::{Canvas, Paint};
use super::picture::Picture;
use super::projection::PAD;
use super::sheet::{Furniture, Sheet};
use super::shown::{pack, unpack};
use super::svg;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::colour_map::{Colour, lit, mix};
use spmesh_formats::source::Surface;
use spmesh_stream::model::bounds::{Bounds, Point};

/// The colour of triangles without one.
const PLAIN: Colour = [190, 195, 205];

/// Where the light comes from: right, up and towards the eye.
const LIGHT: Point = [-0.42, 0.55, 0.72];

/// The brightness of a surface without shine.
const LEVEL: f64 = 0.85;

/// How much of the colour of the back of a triangle is black, and of what is farthest away white.
const BACK: f64 = 0.3;
const HAZE: f64 = 0.4;

/// The difference of depths that gets an outline, as a part of the width of the map.
const STEP: f64 = 0.02;

/// How a surface is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidOptions {
    /// The title.
    pub name: String,
    /// Width of the picture. Units: pixels.
    pub width: u32,
    /// Where the eye is: degrees counterclockwise from the x axis, and above the plane of x and y.
    pub eye: [f64; 2],
}

/// Draws a surface: shaded, with hidden parts left out and outlines of what is in front.
///
/// Memory: that of the surface, and 68 bytes for each pixel.
///
/// # Errors
/// Usage, if the surface has no triangles, or its coordinates are too large to be drawn.
pub fn draw_solid(surface: &Surface, options: &SolidOptions) -> Result<Picture> {
    let eye = Eye::at(options.eye);
    let seen: Vec<Point> = surface.points.iter().map(|&point| eye.turned(point)).collect();
    let corners = surface.triangles.iter().flatten().map(|&corner| seen[corner as usize]);
    let Some(bounds) = corners.map(Bounds::of_point).reduce(Bounds::union) else {
        return Err(Error::usage("the surface has no triangles"));
    };
    let flat = |[x, y, _]: Point| [x, y];
    let (sheet, frame) = Sheet::of(flat(bounds.min), flat(bounds.max), PAD, options.width)?;
    let place = |[x, y, near]: Point| {
        let [x, y] = frame.place([x, y]);
        [x, y, (bounds.max[2] - near) / frame.unit]
    };
    let mut canvas = Canvas::new(sheet.corner, sheet.size, true);
    let range = bounds.max[2] - bounds.min[2];
    for (triangle, colour) in surface.triangles.iter().zip(&surface.colours) {
        let corners = triangle.map(|corner| seen[corner as usize]);
        let facet = normal(corners);
        let side = if facet[2] < 0.0 { -1.0 } else { 1.0 };
        let shades = triangle.map(|corner| {
            let own = surface.normals.get(corner as usize).map(|&normal| eye.direction(normal));
            shade(own.unwrap_or(facet).map(|c| c * side))
        });
        let nearness = corners.iter().map(|corner| corner[2]).sum::<f64>() / 3.0 - bounds.min[2];
        let haze = if range > 0.0 { HAZE * (1.0 - nearness / range) } else { 0.0 };
        let bare = mix(colour.unwrap_or(PLAIN), [0; 3], if side < 0.0 { BACK } else { 0.0 });
        let value = pack(mix(bare, [255; 3], haze).map(f64::from));
        canvas.triangle(corners.map(place), Paint { values: [value; 3], shades });
    }
    canvas.outline((STEP * sheet.size[0] as f64) as f32);
    let pixels = canvas.pixels(|value, shade| lit(unpack(value), shade, LEVEL))?;
    let furniture = Furniture { title: &options.name, legend: None, marks: &[], unit: None };
    let svg = sheet.svg(&svg::image(sheet.corner, &pixels), &furniture);
    Ok(Picture { title: options.name.clone(), svg, frame: None })
}

/// The directions right, up and towards the eye.
struct Eye([Point; 3]);

impl Eye {
    fn at([azimuth, altitude]: [f64; 2]) -> Eye {
        let ((y, x), (z, flat)) = (azimuth.to_radians().sin_cos(), altitude.to_radians().sin_cos());
        Eye([[-y, x, 0.0], [-z * x, -z * y, flat], [flat * x, flat * y, z]])
    }

    fn turned(&self, at: Point) -> Point {
        self.0.map(|direction| dot(direction, at))
    }

    /// A normal as the eye sees it, of length 1.
    fn direction(&self, normal: Point) -> Point {
        unit(self.turned(normal))
    }
}

/// The brightness of a surface with some normal, from 0 to 1.
fn shade(normal: Point) -> f64 {
    let shade = dot(normal, unit(LIGHT));
    if shade.is_nan() { 0.0 } else { (0.5 + 0.5 * shade).powi(2).clamp(0.0, 1.0) }
}

fn normal([a, b, c]: [Point; 3]) -> Point {
    let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
    unit([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
}

fn unit(p: Point) -> Point {
    let length = dot(p, p).sqrt();
    p.map(|c| c / length)
}

fn dot(p: Point, q: Point) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}
