//! Placement of knots: on grids as fine as observations are dense, and next to residuals.
//!
//! Inner knots are moved at random, with a fixed seed, so that no three are on a line and splines are smooth.
//! Knots of the border are pulled apart, so that splines could fold along *border chords*: inner edges that
//! join two knots of the border. Each border chord gets a knot, too.

use super::blocks::Observations;
use super::mesh::Mesh;
use spmesh_base::error::{Error, Result};
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Point2;

/// Cells along the longer side of the box in the first round.
const CELLS_FIRST: usize = 4;
/// How far knots are moved, in cells.
pub(super) const MOVED: f64 = 0.2;
/// Least number of knots: those of the first grid, and one for each corner that an edge may cut off.
pub const KNOTS_MIN: usize = (CELLS_FIRST + 1) * (CELLS_FIRST + 1) + 4;
/// Most cells of a grid.
const EVEN_MAX: f64 = 5e7;
/// Attempts to place knots without border chords.
const ATTEMPTS: usize = 4;

/// Knots on a grid over the box of all observations, with cells of about this side. Inner knots are moved a
/// little.
///
/// # Errors
/// A side that is not above zero or makes more than 50 million cells; observations that span no area; those
/// of the source.
pub fn grid_knots<O: Observations + ?Sized>(observations: &O, side: f64) -> Result<Vec<Point2>> {
    if side.is_nan() || side <= 0.0 {
        return Err(Error::usage(format!("cells of {side}: expected a number above zero")));
    }
    let [lower, upper] = bounds(observations)?;
    let cells = [0, 1].map(|axis| ((upper[axis] - lower[axis]) / side).round().max(2.0));
    if cells[0] * cells[1] > EVEN_MAX {
        let what = format!("cells of {side} are {:.0} by {:.0}: take larger ones", cells[0], cells[1]);
        return Err(Error::usage(what));
    }
    let places = grid([lower, upper], cells.map(|count| count as usize));
    let middles = break_border_chords(&places, Vec::new(), usize::MAX)?;
    Ok([places, middles].concat())
}

/// The bounding box of all observations, those of weight zero included.
///
/// # Errors
/// Observations that span no area; those of the source.
pub fn bounds<O: Observations + ?Sized>(observations: &O) -> Result<[Point2; 2]> {
    let (mut lower, mut upper) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (mut reader, mut batch, mut index) = (observations.read()?, Vec::new(), 0u64);
    loop {
        batch.clear();
        reader.append(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        for one in &batch {
            one.check(index)?;
            index += 1;
            lower = [0, 1].map(|axis| lower[axis].min(one.point[axis]));
            upper = [0, 1].map(|axis| upper[axis].max(one.point[axis]));
        }
    }
    check_area([lower, upper], index)?;
    Ok([lower, upper])
}

/// Refuses a box of observations that has no area.
pub(super) fn check_area([lower, upper]: [Point2; 2], count: u64) -> Result<()> {
    if count == 0 {
        return Err(Error::usage("no observations: nothing can be fitted"));
    }
    if !(lower[0] < upper[0] && lower[1] < upper[1]) {
        return Err(Error::usage(format!(
            "all observations have the same x or y: {:?} {:?} to {:?} {:?}, which is no area",
            lower[0], lower[1], upper[0], upper[1]
        )));
    }
    Ok(())
}

/// The grid of the first round, with cells that are about square.
pub(super) fn first_grid([lower, upper]: [Point2; 2]) -> Vec<Point2> {
    let sides = [0, 1].map(|axis| upper[axis] - lower[axis]);
    let longest = sides[0].max(sides[1]);
    grid([lower, upper], sides.map(|side| ((side / longest * CELLS_FIRST as f64).round() as usize).max(2)))
}

/// The grid points of a box: exact on its border, moved at random inside.
fn grid([lower, upper]: [Point2; 2], cells: [usize; 2]) -> Vec<Point2> {
    let mut random = Random::new(1);
    let mut places = Vec::with_capacity((cells[0] + 1) * (cells[1] + 1));
    for (i, j) in (0..=cells[1]).flat_map(|j| (0..=cells[0]).map(move |i| (i, j))) {
        let step = [i, j];
        let is_inside = (0..2).all(|axis| step[axis] > 0 && step[axis] < cells[axis]);
        places.push([0, 1].map(|axis| {
            let by = unit(&mut random);
            let place = step[axis] as f64 + if is_inside { MOVED * by } else { 0.0 };
            between(lower[axis], upper[axis], place / cells[axis] as f64)
        }));
    }
    places
}

/// A random number between -1 and 1.
pub(super) fn unit(random: &mut Random) -> f64 {
    2.0 * (random.bits() as f64 / u64::MAX as f64) - 1.0
}

/// Linear interpolation; exact at parts zero and one.
pub(super) fn between(from: f64, to: f64, part: f64) -> f64 {
    if part == 1.0 { to } else { from + part * (to - from) }
}

/// Adds knots near the middles of border chords while at most `added_max` knots are added; beyond, drops the
/// knots that cause border chords.
///
/// New knots never create edges between known ones, so at least one end of each chord is new, except at the
/// very start.
pub(super) fn break_border_chords(
    known: &[Point2],
    mut added: Vec<Point2>,
    added_max: usize,
) -> Result<Vec<Point2>> {
    for attempt in 0.. {
        let mesh = Mesh::of([known, &added].concat())?;
        let (ends, middles): (Vec<[u32; 2]>, Vec<Point2>) = border_chords(&mesh).into_iter().unzip();
        let is_new = |knot: u32| knot as usize >= known.len();
        if middles.is_empty() {
            break;
        }
        if attempt < ATTEMPTS && added.len() + middles.len() <= added_max {
            added.extend(middles);
            continue;
        }
        let before = added.len();
        let dropped: Vec<usize> =
            ends.iter().flatten().filter(|&&end| is_new(end)).map(|&end| end as usize).collect();
        let mut id = known.len()..;
        added.retain(|_| id.next().is_none_or(|id| !dropped.contains(&id)));
        if added.len() == before {
            break;
        }
    }
    Ok(added)
}

/// Border chords, each with a place near its middle. Exactly at the middle, knots would be on a line, which
/// makes splines less smooth.
fn border_chords(mesh: &Mesh) -> Vec<([u32; 2], Point2)> {
    let mut is_border = vec![false; mesh.points().len()];
    mesh.hull().iter().for_each(|&knot| is_border[knot as usize] = true);
    let mut found = Vec::new();
    for triangle in 0..mesh.triangles_len() as u32 {
        let (vertices, corners) = (mesh.vertices(triangle), mesh.corners(triangle));
        for [from, to] in mesh.inner_edges(triangle) {
            let ends = [vertices[from], vertices[to]];
            // Each inner edge belongs to two triangles: count it once.
            if ends[0] < ends[1] && ends.iter().all(|&end| is_border[end as usize]) {
                let (p, q, apex) = (corners[from], corners[to], corners[3 - from - to]);
                found.push((ends, [0, 1].map(|axis| 0.9 * p[axis].midpoint(q[axis]) + 0.1 * apex[axis])));
            }
        }
    }
    found
}

/// The knot for a residual in a triangle: about halfway between the residual and the middle of the triangle.
/// Exactly halfway, knots of several rounds for one residual would be on a line with a corner.
pub(super) fn knot_for_residual(mesh: &Mesh, triangle: u32, worst: Point2, random: &mut Random) -> Point2 {
    let corners = mesh.corners(triangle);
    let mut share = || 1.0 + MOVED * unit(random);
    let shares = [share(), share(), share(), 3.0 * share()];
    let whole: f64 = shares.iter().sum();
    let places = corners.into_iter().chain([worst]).zip(shares);
    let knot = places
        .fold([0.0; 2], |sum, (place, share)| [0, 1].map(|axis| sum[axis] + share / whole * place[axis]));
    // In the diametral circle of a border edge, a knot would make a flat triangle (Ruppert 1995).
    let is_near = |&[p, q]: &[Point2; 2]| {
        (p[0] - knot[0]) * (q[0] - knot[0]) + (p[1] - knot[1]) * (q[1] - knot[1]) <= 0.0
    };
    match mesh.border_edges(triangle).find(is_near) {
        Some([p, q]) => [0, 1].map(|axis| p[axis].midpoint(q[axis])),
        None => knot,
    }
}
