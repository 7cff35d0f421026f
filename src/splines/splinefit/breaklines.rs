//! Breaklines and corners: turns polylines in world coordinates into knots with features between them.

use super::fit::KNOTS_MAX;
use super::given_knots::without_copies;
use super::options::Options;
use crate::fitting::SplineSpace;
use spmesh_base::error::{Error, Result};
use spmesh_configurations::special::{Crease, Features};
use spmesh_delaunay::delaunay2;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::source::{Polyline, PolylineKind};

/// Places nearer to a polyline than this part of the usual distance of knots are left out: they would form
/// slivers.
const NEAR: f64 = 0.35;

/// The spline space over places, with features along polylines, both in world coordinates.
///
/// Segments that are longer than the usual distance of knots are divided, so that splines can bend along
/// them. Places near segments are left out, except those on the border of the convex hull.
///
/// # Errors
/// Usage, if polylines lie far from the places, need too many knots, cross where they have no common vertex,
/// touch the border in ways that [`SplineSpace::with_features`] refuses, or are too near to each other.
pub(super) fn space(places: &[Point2], options: &Options) -> Result<SplineSpace> {
    of_polylines(places, options).map_err(|error| error.of_input(&options.polylines_name))
}

fn of_polylines(places: &[Point2], options: &Options) -> Result<SplineSpace> {
    let polylines = &options.polylines[..];
    check_area(places, polylines)?;
    let distance = usual_distance(places)?;
    check_count(options, distance, places.len())?;
    let divided: Vec<Vec<Point2>> = polylines.iter().map(|polyline| divide(polyline, distance)).collect();
    let far = far_places(places, &divided, NEAR * distance)?;
    let mut knots = Knots { places: without_copies(&far), ids: foldhash::HashMap::default() };
    knots.number();
    let mut features = Features::default();
    for (polyline, vertices) in polylines.iter().zip(&divided) {
        let ids: Vec<u32> = vertices.iter().map(|&vertex| knots.id(vertex)).collect();
        match polyline.kind {
            PolylineKind::Corner => features.corners.extend(ids),
            PolylineKind::Crease => features.creases.push(Crease { knots: ids, has_sharp_ends: true }),
            PolylineKind::SmoothCrease => {
                features.creases.push(Crease { knots: ids, has_sharp_ends: false });
            }
            PolylineKind::Linear => features.lines.push(ids),
        }
    }
    SplineSpace::with_features(knots.places, features)
}

/// Checks that all vertices lie in the box of the places, or outside of it by no more than its longer side:
/// knots far from all points would only stretch the domain.
fn check_area(places: &[Point2], polylines: &[Polyline]) -> Result<()> {
    let range = |axis: usize| {
        let coordinates = places.iter().map(|place| place[axis]);
        coordinates.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
    };
    let [x, y] = [range(0), range(1)];
    let margin = (x[1] - x[0]).max(y[1] - y[0]);
    let is_near = |[low, high]: [f64; 2], at: f64| low - margin <= at && at <= high + margin;
    for polyline in polylines {
        let far = polyline.vertices.iter().find(|at| !is_near(x, at[0]) || !is_near(y, at[1]));
        if let Some([at_x, at_y]) = far {
            let message = format!(
                "the vertex {at_x:?} {at_y:?} is far from the points, which lie between {:?} {:?} and {:?} {:?}: clip \
                 features to this box, for example with ogr2ogr -clipsrc",
                x[0], y[0], x[1], y[1]
            );
            return Err(Error::usage(message).at(&polyline.position));
        }
    }
    Ok(())
}

/// Checks the number of knots along polylines, which are added to `places` others.
fn check_count(options: &Options, distance: f64, places: usize) -> Result<()> {
    let most = options.max_knots.unwrap_or(KNOTS_MAX.max(places));
    let parts = |polyline: &Polyline| -> f64 {
        let edges = polyline.vertices.windows(2).map(|edge| [edge[0], edge[1]]);
        match polyline.kind {
            PolylineKind::Corner => polyline.vertices.len() as f64,
            _ => 1.0 + edges.map(|edge| parts_of(edge, distance)).sum::<f64>(),
        }
    };
    let knots: f64 = options.polylines.iter().map(parts).sum();
    if knots > most as f64 {
        let flag = match (options.step, options.max_knots) {
            (Some(_), _) => ", or take a larger --step",
            (None, Some(_)) => ", or raise --max-knots",
            (None, None) => "",
        };
        return Err(Error::usage(format!(
            "the features need {knots} knots, at most {most} may be: simplify or clip them{flag}"
        )));
    }
    Ok(())
}

/// The number of parts of an edge, so that none is longer than the usual distance of knots.
fn parts_of(edge: [Point2; 2], distance: f64) -> f64 {
    (length(edge) / distance).ceil().max(1.0)
}

/// The usual distance of knots: the side of a square whose area is the mean area per place.
fn usual_distance(places: &[Point2]) -> Result<f64> {
    let mesh = delaunay2::triangulate(places).map_err(Error::of_computation)?;
    let twice_area = |[a, b, c]: [Point2; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let corners = |vertices: [u32; 3]| vertices.map(|id| places[id as usize]);
    let area: f64 =
        mesh.triangles().iter().map(|triangle| 0.5 * twice_area(corners(triangle.vertices))).sum();
    if area <= 0.0 {
        return Err(Error::usage(format!(
            "{} knots on one line: three that are not are needed",
            places.len()
        )));
    }
    Ok((area / places.len() as f64).sqrt())
}

fn length([p, q]: [Point2; 2]) -> f64 {
    ((q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)).sqrt()
}

/// The vertices of a polyline, with further vertices on long segments.
fn divide(polyline: &Polyline, distance: f64) -> Vec<Point2> {
    if polyline.kind == PolylineKind::Corner {
        return polyline.vertices.clone();
    }
    let mut divided = vec![polyline.vertices[0]];
    for edge in polyline.vertices.windows(2) {
        let [p, q] = [edge[0], edge[1]];
        let parts = parts_of([p, q], distance);
        let between = (1..parts as usize).map(|part| {
            let part = part as f64 / parts;
            [0, 1].map(|axis| p[axis] + part * (q[axis] - p[axis]))
        });
        divided.extend(between);
        divided.push(q);
    }
    divided
}

/// Places that are not near any segment, and those on the border.
fn far_places(places: &[Point2], divided: &[Vec<Point2>], near: f64) -> Result<Vec<Point2>> {
    let mut is_kept = vec![true; places.len()];
    let cells = Cells::of(places, near);
    for polyline in divided {
        // A corner is a segment of no length.
        let single = [[polyline[0]; 2]];
        let edges = polyline.windows(2).map(|edge| [edge[0], edge[1]]);
        for edge in edges.chain(single) {
            cells.for_each_near(edge, |place| {
                is_kept[place as usize] &= distance_to(edge, places[place as usize]) >= near;
            });
        }
    }
    delaunay2::triangulate(places)
        .map_err(Error::of_computation)?
        .arrays()
        .hull
        .iter()
        .for_each(|&id| is_kept[id as usize] = true);
    Ok(places.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(&place, _)| place).collect())
}

fn distance_to([p, q]: [Point2; 2], x: Point2) -> f64 {
    let along = [q[0] - p[0], q[1] - p[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = ((x[0] - p[0]) * along[0] + (x[1] - p[1]) * along[1]) / square;
    let part = if square > 0.0 { part.clamp(0.0, 1.0) } else { 0.0 };
    length([[p[0] + part * along[0], p[1] + part * along[1]], x])
}

/// Places by the square cells that contain them.
struct Cells {
    side: f64,
    places: foldhash::HashMap<[i64; 2], Vec<u32>>,
}

impl Cells {
    fn of(places: &[Point2], near: f64) -> Cells {
        let mut cells = Cells { side: 4.0 * near, places: foldhash::HashMap::default() };
        for (id, &place) in (0..).zip(places) {
            cells.places.entry(cells.cell(place)).or_default().push(id);
        }
        cells
    }

    fn cell(&self, x: Point2) -> [i64; 2] {
        x.map(|coordinate| (coordinate / self.side).floor() as i64)
    }

    /// Calls `visit` with all places in cells around the bounding box of a segment, which spans at most a few
    /// cells.
    fn for_each_near(&self, [p, q]: [Point2; 2], mut visit: impl FnMut(u32)) {
        let ([a, b], [c, d]) = (self.cell(p), self.cell(q));
        for column in a.min(c) - 1..=a.max(c) + 1 {
            for row in b.min(d) - 1..=b.max(d) + 1 {
                self.places.get(&[column, row]).into_iter().flatten().for_each(|&id| visit(id));
            }
        }
    }
}

/// Knots, found by place.
struct Knots {
    places: Vec<Point2>,
    ids: foldhash::HashMap<[u64; 2], u32>,
}

impl Knots {
    /// The bits of the coordinates, with -0 as +0.
    fn key(place: Point2) -> [u64; 2] {
        place.map(|coordinate| (coordinate + 0.0).to_bits())
    }

    fn number(&mut self) {
        self.ids = (0..).zip(&self.places).map(|(id, &place)| (Knots::key(place), id)).collect();
    }

    /// The knot at a place; adds one if there is none.
    fn id(&mut self, place: Point2) -> u32 {
        let next = self.places.len() as u32;
        let id = *self.ids.entry(Knots::key(place)).or_insert(next);
        if id == next {
            self.places.push(place);
        }
        id
    }
}
