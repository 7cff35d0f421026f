//! Triangles on the sheet.

use foldhash::{HashSet, HashSetExt};

use super::Fill;
use super::canvas::Canvas;
use super::hiding::back_to_front;
use super::layer::Thing;
use super::look::{Colours, Look};
use super::ramp::hex;
use super::stage::Stage;
use super::svg;
use spmesh_model::bounds::Point;

/// A triangle of a stream.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// Its vertices.
    pub(super) ids: [u64; 3],
    /// Where they are in the world.
    pub(super) corners: [Point; 3],
    /// How many triangles came before.
    pub(super) number: u64,
}

impl Thing for Triangle {
    fn corners(&self) -> &[Point] {
        &self.corners
    }

    fn paint(&self, canvas: &mut Canvas, stage: &Stage, look: &Look) {
        let places = self.corners.map(|corner| stage.view.place(corner));
        canvas.triangle(places, look.paint(look.fill(true), &self.corners, self.number));
        if look.has_edges(true) {
            let [a, b, c] = places;
            [[a, b], [b, c], [c, a]].into_iter().for_each(|ends| canvas.edge(ends));
        }
    }
}

/// Triangles as paths; seen from one side, those behind first.
pub(super) fn vectors(triangles: &[Triangle], stage: &Stage, look: &Look, colours: &Colours) -> String {
    let turn = stage.view.turn();
    let is_oblique = turn.is_some();
    let order = match turn {
        Some(turn) => back_to_front(triangles, turn),
        None => (0..triangles.len()).collect(),
    };
    let has_edges = look.has_edges(false);
    let fill = look.fill(false);
    let mut text = String::new();
    // Edges belong to what they are the edges of, where one triangle may hide another.
    if fill != Fill::None || is_oblique {
        text += if is_oblique && has_edges {
            "<g fill=\"currentColor\" stroke=\"#000\" stroke-opacity=\"0.4\" stroke-width=\"0.5\" stroke-linejoin=\"round\">\n"
        } else {
            // With a border of its own colour, no white shows between a triangle and the next one.
            "<g fill=\"currentColor\" stroke=\"currentColor\" stroke-width=\"0.6\" stroke-linejoin=\"round\">\n"
        };
        for triangle in order.into_iter().map(|number| &triangles[number]) {
            let paint = look.paint(fill, &triangle.corners, triangle.number);
            let value = paint.values.iter().map(|value| value / 3.0).sum();
            let colour = hex(colours.of(value, f64::from(paint.shade)));
            text += &format!(
                "<path color=\"{colour}\" vector-effect=\"non-scaling-stroke\" d=\"{}\"/>\n",
                ring(triangle, stage)
            );
        }
        text += "</g>\n";
    }
    if has_edges && !is_oblique {
        text += &edges(triangles, stage, if fill == Fill::None { 0.75 } else { 0.35 });
    }
    text
}

fn ring(triangle: &Triangle, stage: &Stage) -> String {
    svg::ring(&triangle.corners.map(|corner| stage.view.place(corner)).map(|[x, y, _]| [x, y]))
}

/// All edges, each once.
fn edges(triangles: &[Triangle], stage: &Stage, opacity: f64) -> String {
    let mut drawn = HashSet::new();
    let mut path = String::new();
    for Triangle { ids, corners, .. } in triangles {
        for [from, to] in [[0, 1], [1, 2], [2, 0]] {
            if drawn.insert((ids[from].min(ids[to]), ids[from].max(ids[to]))) {
                let ends = [from, to].map(|end| stage.view.place(corners[end])).map(|[x, y, _]| [x, y]);
                path += &svg::line(ends);
            }
        }
    }
    format!(
        "<path id=\"edges\" fill=\"none\" stroke=\"#24292f\" stroke-opacity=\"{opacity}\" stroke-width=\"0.6\" \
         stroke-linejoin=\"round\" vector-effect=\"non-scaling-stroke\" d=\"{path}\"/>\n"
    )
}
