//! Points, marked places and lines as SVG.

use std::collections::HashSet;

use super::canvas::Canvas;
use super::layer::Drawable;
use super::options::Fill;
use super::projection::Scene;
use super::style::{Colours, Style};
use super::svg;
use spmesh_formats::raster::colour_map::{Colour, hex};
use spmesh_stream::model::bounds::Point;

/// Marked places that are nearer to each other share a dot. Units: lengths of the picture.
const APART: f64 = 2.0;

/// Above this many marked places, dots are smaller.
const CROWD: usize = 500;

/// A point of a stream.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawnPoint {
    /// Its place in the world.
    pub(super) at: Point,
    /// The number of points before it.
    pub(super) number: u64,
}

impl Drawable for DrawnPoint {
    fn corners(&self) -> &[Point] {
        std::slice::from_ref(&self.at)
    }

    fn paint(&self, canvas: &mut Canvas, scene: &Scene, style: &Style) {
        let [x, y, _] = scene.view.place(self.at);
        canvas.point([x, y], style.value(style.point_fill(), self.at, self.number));
    }
}

/// The radius of points: the more points, the smaller.
fn radius(count: usize) -> f64 {
    if count <= 500 {
        2.5
    } else if count <= 5_000 {
        1.5
    } else {
        1.0
    }
}

/// Points as circles: coloured by value, or dark without `colours`.
pub(super) fn vectors(
    points: &[DrawnPoint],
    scene: &Scene,
    style: &Style,
    colours: Option<&Colours>,
) -> String {
    let fill = style.point_fill();
    let colours = colours.filter(|_| fill != Fill::None);
    // Dark points may lie on cells of any colour.
    let rim = if colours.is_none() { " stroke=\"#fff\" stroke-width=\"0.4\"" } else { "" };
    let mut text = format!("<g id=\"points\" fill=\"#24292f\"{rim}>\n");
    let radius = radius(points.len());
    for point in points {
        let [x, y, _] = scene.view.place(point.at);
        let [x, y] = [x, y].map(svg::length);
        let colour = colours.map_or_else(String::new, |colours| {
            format!(" fill=\"{}\"", hex(colours.of(style.value(fill, point.at, point.number), 1.0)))
        });
        text += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{colour}/>\n");
    }
    text + "</g>\n"
}

/// Dots of one colour at marked places; places closer than [`APART`] share one.
pub(super) fn marks(id: &str, colour: Colour, radius: f64, places: &[Point], scene: &Scene) -> String {
    let mut drawn = HashSet::new();
    let radius = if places.len() > CROWD { 0.5 * radius } else { radius };
    let mut text = format!("<g id=\"{id}\" fill=\"{}\">\n", hex(colour));
    for &at in places.iter().filter(|at| scene.may_show(&[**at])) {
        let [x, y, _] = scene.view.place(at);
        if drawn.insert([x, y].map(|length| (length / APART).round() as i64)) {
            let [x, y] = [x, y].map(svg::length);
            text += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>\n");
        }
    }
    text + "</g>\n"
}

/// Lines of one colour and width, in pixels, without those too short to be visible.
pub(super) fn lines(id: &str, colour: Colour, width: f64, lines: &[[Point; 2]], scene: &Scene) -> String {
    let mut path = String::new();
    for ends in lines.iter().filter(|ends| scene.may_show(*ends)) {
        let ends = ends.map(|end| scene.view.place(end)).map(|[x, y, _]| [x, y]);
        let [from, to] = ends.map(svg::place);
        if from != to {
            path += &svg::line(ends);
        }
    }
    format!(
        "<path id=\"{id}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linecap=\"round\" \
         vector-effect=\"non-scaling-stroke\" d=\"{path}\"/>\n",
        hex(colour)
    )
}
