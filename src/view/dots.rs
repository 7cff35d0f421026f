//! Points on the sheet.

use std::collections::HashSet;

use super::Fill;
use super::canvas::Canvas;
use super::layer::Thing;
use super::look::{Colours, Look};
use super::ramp::{Colour, hex};
use super::stage::Stage;
use super::svg;
use spmesh_model::bounds::Point;

/// Dots of marks are not drawn nearer to each other. Units: lengths of the picture.
const APART: f64 = 2.0;

/// More dots of marks than these are smaller.
const CROWD: usize = 500;

/// A point of a stream.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dot {
    /// Where it is in the world.
    pub(super) at: Point,
    /// How many points came before.
    pub(super) number: u64,
}

impl Thing for Dot {
    fn corners(&self) -> &[Point] {
        std::slice::from_ref(&self.at)
    }

    fn paint(&self, canvas: &mut Canvas, stage: &Stage, look: &Look) {
        let [x, y, _] = stage.view.place(self.at);
        canvas.point([x, y], look.value(look.point_fill(), self.at, self.number));
    }
}

/// The radius of dots: smaller where they are many.
fn radius(count: usize) -> f64 {
    if count <= 500 {
        2.5
    } else if count <= 5_000 {
        1.5
    } else {
        1.0
    }
}

/// Points as circles, in their colours, or all dark.
pub(super) fn vectors(dots: &[Dot], stage: &Stage, look: &Look, colours: Option<&Colours>) -> String {
    let fill = look.point_fill();
    let colours = colours.filter(|_| fill != Fill::None);
    // Dark dots stand on cells of any colour.
    let rim = if colours.is_none() { " stroke=\"#fff\" stroke-width=\"0.4\"" } else { "" };
    let mut text = format!("<g id=\"points\" fill=\"#24292f\"{rim}>\n");
    let radius = radius(dots.len());
    for dot in dots {
        let [x, y, _] = stage.view.place(dot.at);
        let [x, y] = [x, y].map(svg::length);
        let colour = colours.map_or_else(String::new, |colours| {
            format!(" fill=\"{}\"", hex(colours.of(look.value(fill, dot.at, dot.number), 1.0)))
        });
        text += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{colour}/>\n");
    }
    text + "</g>\n"
}

/// Places that are marked with dots of one colour; of those that are nearly at one place, one.
pub(super) fn marks(id: &str, colour: Colour, radius: f64, places: &[Point], stage: &Stage) -> String {
    let mut drawn = HashSet::new();
    let radius = if places.len() > CROWD { 0.5 * radius } else { radius };
    let mut text = format!("<g id=\"{id}\" fill=\"{}\">\n", hex(colour));
    for &at in places.iter().filter(|at| stage.may_show(&[**at])) {
        let [x, y, _] = stage.view.place(at);
        if drawn.insert([x, y].map(|length| (length / APART).round() as i64)) {
            let [x, y] = [x, y].map(svg::length);
            text += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>\n");
        }
    }
    text + "</g>\n"
}

/// Lines of one colour; those that are too short to be seen are left out.
pub(super) fn lines(id: &str, colour: Colour, lines: &[[Point; 2]], stage: &Stage) -> String {
    let mut path = String::new();
    for ends in lines.iter().filter(|ends| stage.may_show(*ends)) {
        let ends = ends.map(|end| stage.view.place(end)).map(|[x, y, _]| [x, y]);
        let [from, to] = ends.map(svg::place);
        if from != to {
            path += &svg::line(ends);
        }
    }
    format!(
        "<path id=\"{id}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" stroke-linecap=\"round\" \
         vector-effect=\"non-scaling-stroke\" d=\"{path}\"/>\n",
        hex(colour)
    )
}
