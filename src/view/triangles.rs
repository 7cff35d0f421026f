//! Triangles as SVG.

use foldhash::{HashSet, HashSetExt};

use super::canvas::Canvas;
use super::depth_sort::{Turned, back_to_front};
use super::layer::Drawable;
use super::options::Fill;
use super::projection::Scene;
use super::style::{Colours, Style};
use super::svg;
use spmesh_formats::raster::colour_map::hex;
use spmesh_stream::model::bounds::Point;

/// A triangle of a stream.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// The ids of its vertices.
    pub(super) ids: [u64; 3],
    /// Their places in the world.
    pub(super) corners: [Point; 3],
    /// The number of triangles before it.
    pub(super) number: u64,
}

impl Drawable for Triangle {
    fn corners(&self) -> &[Point] {
        &self.corners
    }

    fn paint(&self, canvas: &mut Canvas, scene: &Scene, style: &Style) {
        let places = self.corners.map(|corner| scene.view.place(corner));
        canvas.triangle(places, style.paint(style.fill(true), &self.corners, self.number));
        if style.has_edges(true) {
            let [a, b, c] = places;
            [[a, b], [b, c], [c, a]].into_iter().for_each(|ends| canvas.edge(ends));
        }
    }
}

/// The values of the corners of a triangle, each with a third of its area.
pub(super) fn weighted(triangle: &Triangle) -> impl Iterator<Item = (f64, f64)> + use<> {
    let [a, b, c] = triangle.corners;
    let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
    [a, b, c].into_iter().map(move |corner| (corner[2], area / 3.0))
}

/// Triangles as paths; in an oblique view, those behind come first.
pub(super) fn vectors(triangles: &[Triangle], scene: &Scene, style: &Style, colours: &Colours) -> String {
    let turn = scene.view.turn();
    let is_oblique = turn.is_some();
    let order = match turn {
        Some(turn) => {
            let turned =
                |triangle: &Triangle| Turned { ids: triangle.ids, places: triangle.corners.map(&turn) };
            back_to_front(&triangles.iter().map(turned).collect::<Vec<Turned>>())
        }
        None => (0..triangles.len()).collect(),
    };
    let has_edges = style.has_edges(false);
    let fill = style.fill(false);
    let mut text = String::new();
    // Where one triangle may hide another, each is drawn with its own edges.
    if fill != Fill::None || is_oblique {
        text += if is_oblique && has_edges {
            "<g fill=\"currentColor\" stroke=\"#000\" stroke-opacity=\"0.4\" stroke-width=\"0.5\" stroke-linejoin=\"round\">\n"
        } else {
            // A border of the same colour closes the white gaps between neighbours.
            "<g fill=\"currentColor\" stroke=\"currentColor\" stroke-width=\"0.6\" stroke-linejoin=\"round\">\n"
        };
        for triangle in order.into_iter().map(|number| &triangles[number]) {
            let paint = style.paint(fill, &triangle.corners, triangle.number);
            let value = paint.values.iter().map(|value| value / 3.0).sum();
            let colour = hex(colours.of(value, paint.shades[0]));
            text += &format!(
                "<path color=\"{colour}\" vector-effect=\"non-scaling-stroke\" d=\"{}\"/>\n",
                ring(triangle, scene)
            );
        }
        text += "</g>\n";
    }
    if has_edges && !is_oblique {
        text += &edges(triangles, scene, if fill == Fill::None { 0.75 } else { 0.35 });
    }
    text
}

fn ring(triangle: &Triangle, scene: &Scene) -> String {
    svg::ring(&triangle.corners.map(|corner| scene.view.place(corner)).map(|[x, y, _]| [x, y]))
}

/// All edges, each drawn once.
fn edges(triangles: &[Triangle], scene: &Scene, opacity: f64) -> String {
    let mut drawn = HashSet::new();
    let mut path = String::new();
    for Triangle { ids, corners, .. } in triangles {
        for [from, to] in [[0, 1], [1, 2], [2, 0]] {
            if drawn.insert((ids[from].min(ids[to]), ids[from].max(ids[to]))) {
                let ends = [from, to].map(|end| scene.view.place(corners[end])).map(|[x, y, _]| [x, y]);
                path += &svg::line(ends);
            }
        }
    }
    format!(
        "<path id=\"edges\" fill=\"none\" stroke=\"#24292f\" stroke-opacity=\"{opacity}\" \
         stroke-width=\"0.6\" \
         stroke-linejoin=\"round\" vector-effect=\"non-scaling-stroke\" d=\"{path}\"/>\n"
    )
}
