//! Pictures of control meshes: seen from above one side, as SVG.

use std::io::Write;

use super::control::ControlMesh;
use crate::error::{Error, Result};
use crate::predicates::Point2;

/// Width of pictures. Units: pixels, as all lengths here.
const WIDTH: f64 = 800.0;
/// Around everything.
const MARGIN: f64 = 16.0;
/// How far the mesh is turned, and from how far above the horizon it is seen. Units: radians.
const TURN: f64 = 0.5;
const ABOVE: f64 = 0.65;
/// The range of elevations is drawn as high as this part of the diagonal of the plan.
const HEIGHT: f64 = 0.25;
/// Colours from the least elevation to the greatest, of even steps for the eye and in order of lightness (viridis, CC0).
const COLOURS: [[f64; 3]; 5] =
    [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [253.0, 231.0, 37.0]];

/// Draws the triangles of a control mesh, those behind first, in colours of their elevations; with the range of these.
///
/// # Errors
/// If writing fails.
pub(super) fn draw(mesh: &ControlMesh, output: &mut impl Write) -> Result<()> {
    let view = View::of(mesh);
    let corners = |triangle: &[u32; 3]| triangle.map(|id| mesh.points[id as usize]);
    let mut order: Vec<&[u32; 3]> = mesh.triangles.iter().collect();
    let nearness = |triangle: &[u32; 3]| corners(triangle).iter().map(|&at| view.depth(at)).sum::<f64>();
    order.sort_by(|a, b| nearness(b).total_cmp(&nearness(a)));
    let mut text = view.head();
    for triangle in order {
        let corners = corners(triangle);
        let mean = corners.iter().map(|corner| corner[2]).sum::<f64>() / 3.0;
        let [a, b, c] = corners.map(|at| view.place(at)).map(|[x, y]| format!("{x:.2} {y:.2}"));
        text += &format!("<path d=\"M{a}L{b}L{c}Z\" fill=\"{}\"/>\n", colour(view.part(mean)));
    }
    text += &view.legend();
    text += "</svg>\n";
    output.write_all(text.as_bytes()).map_err(|error| Error::io("writing the picture", error))
}

/// From world coordinates to the picture.
struct View {
    /// The middle of the plan.
    middle: Point2,
    /// Least and greatest elevation.
    range: [f64; 2],
    /// Units of the plan for one of the elevations.
    lift: f64,
    scale: f64,
    /// Where the middle of the plan is drawn.
    origin: Point2,
    height: f64,
}

impl View {
    fn of(mesh: &ControlMesh) -> View {
        let bound = |axis: usize| {
            let numbers = mesh.points.iter().map(|point| point[axis]);
            numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
        };
        let [x, y, range] = [bound(0), bound(1), bound(2)];
        let diagonal = (x[1] - x[0]).hypot(y[1] - y[0]);
        let rise = range[1] - range[0];
        let lift = if rise > 0.0 { HEIGHT * diagonal / rise } else { 0.0 };
        let middle = [x[0].midpoint(x[1]), y[0].midpoint(y[1])];
        let mut view = View { middle, range, lift, scale: 1.0, origin: [0.0; 2], height: 0.0 };
        let drawn: Vec<Point2> = mesh.points.iter().map(|&at| view.place(at)).collect();
        let [min, max] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|pick| [0, 1].map(|axis| drawn.iter().map(|at| at[axis]).reduce(pick).unwrap_or(0.0)));
        view.scale = (WIDTH - 2.0 * MARGIN) / (max[0] - min[0]);
        view.origin = min.map(|least| MARGIN - view.scale * least);
        view.height = 4.0 * MARGIN + view.scale * (max[1] - min[1]);
        view
    }

    /// Coordinates of the plan after the turn: to the right, and away from the eye.
    fn turned(&self, [x, y, _]: [f64; 3]) -> Point2 {
        let ([x, y], (sine, cosine)) = ([x - self.middle[0], y - self.middle[1]], TURN.sin_cos());
        [cosine * x - sine * y, sine * x + cosine * y]
    }

    fn depth(&self, at: [f64; 3]) -> f64 {
        self.turned(at)[1]
    }

    fn place(&self, at: [f64; 3]) -> Point2 {
        let [right, away] = self.turned(at);
        let up = away * ABOVE.sin() + self.lift * (at[2] - self.range[0]) * ABOVE.cos();
        [self.origin[0] + self.scale * right, self.origin[1] - self.scale * up]
    }

    /// How far up the range an elevation is.
    fn part(&self, elevation: f64) -> f64 {
        let [least, greatest] = self.range;
        if greatest > least { ((elevation - least) / (greatest - least)).clamp(0.0, 1.0) } else { 0.5 }
    }

    fn head(&self) -> String {
        let height = self.height;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.1}\" width=\"{WIDTH}\" height=\"{height:.1}\">\n\
             <style>path {{ stroke: #fff; stroke-width: 0.5; stroke-linejoin: round; stroke-opacity: 0.6 }} \
             text {{ font: 13px sans-serif; fill: #7d8590 }}</style>\n"
        )
    }

    /// A ramp of colours between the least elevation and the greatest.
    fn legend(&self) -> String {
        const STEPS: usize = 32;
        let ([least, greatest], side, top) = (self.range, 5.0, self.height - 1.5 * MARGIN);
        let cells = (0..STEPS).map(|step| {
            let (left, fill) = (MARGIN + side * step as f64, colour(step as f64 / (STEPS - 1) as f64));
            format!("<rect x=\"{left}\" y=\"{top:.1}\" width=\"{side}\" height=\"8\" fill=\"{fill}\"/>")
        });
        let right = 2.0 * MARGIN + side * STEPS as f64;
        let label =
            format!("<text x=\"{right}\" y=\"{:.1}\">{least:.6} to {greatest:.6}</text>\n", top + 8.0);
        cells.chain([label]).collect()
    }
}

/// The colour of a part between zero and one.
fn colour(part: f64) -> String {
    let place = part * (COLOURS.len() - 1) as f64;
    let first = (place as usize).min(COLOURS.len() - 2);
    let [r, g, b] = [0, 1, 2].map(|channel| {
        let [from, to] = [COLOURS[first][channel], COLOURS[first + 1][channel]];
        (from + (place - first as f64) * (to - from)).round() as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}
