//! How the area and the volume of a union change when balls move.
//!
//! *Volume.* Where a ball moves, its exposed part sweeps a volume. The normals of the border of its cell add
//! up to zero, so those of the exposed part are those of the faces, with the opposite sign.
//!
//! *Area.* On each of two spheres that meet, the exposed part ends at arcs of their circle. Let u and v be
//! the normals of the two spheres at a point of an arc, and w the motion of the second ball against the
//! first. In the frame of the first, its border moves by -v·w / |u × v|, and that of the second by u·w / |u ×
//! v|; so the area grows by the integral of (u - v)·w / |u × v| along the arcs. |u × v| is the same all
//! around, and u - v is a constant along the axis and, if the radii differ, a multiple of the direction from
//! the axis.
//!
//! Source: the derivatives are those of Bryant, Edelsbrunner, Koehl and Levitt, "The area derivative of a
//! space-filling diagram", 2004; here they are sums over the arcs of each circle.

use super::face::{Pair, Side};
use super::tile::Tile;
use super::tiles::{Members, TILE_MAX, cut};
use super::{Balls, check};
use spmesh_base::error::Result;
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use std::num::NonZeroUsize;

/// The derivatives of the area and the volume of a union by the centre of one ball.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gradient {
    /// Of the exposed area of all balls.
    pub area: Point3,
    /// Of the volume of the union.
    pub volume: Point3,
}

/// The derivatives for each ball.
///
/// Where a ball begins to touch another, or three circles meet, the area has no derivative; there one of
/// those on either side is found.
///
/// # Errors
/// As [`super::measure`].
pub fn gradients(balls: Balls<'_>, threads: NonZeroUsize) -> Result<Vec<Gradient>> {
    check(balls)?;
    let tiles = cut(balls, TILE_MAX);
    let found = parallel::map(threads, tiles.iter(), |members| of_tile(balls, members))?;
    let mut gradients = vec![Gradient::default(); balls.centres.len()];
    for (members, part) in tiles.iter().zip(found) {
        for (&ball, gradient) in members.core.iter().zip(part) {
            gradients[ball as usize] = gradient;
        }
    }
    Ok(gradients)
}

fn of_tile(balls: Balls<'_>, members: &Members) -> Result<Vec<Gradient>> {
    let tile = Tile::new(balls, members)?;
    let mut gradients = vec![Gradient::default(); members.core.len()];
    tile.for_each_pair(|ring, pair| {
        let places = ring.ends.map(|v| tile.place_in_core(v));
        if !pair.has_disk() || places == [None, None] {
            return;
        }
        let mut lean = [0.0; 3];
        let face = tile.face(ring, pair, |side| add_arcs(pair, side, &mut lean));
        let (normal, radius) = pair.circle();
        let radii = ring.ends.map(|v| tile.radius(v));
        let distance = pair.heights[0] + pair.heights[1];
        let scale = radii[0] * radii[1] / distance;
        let along = (pair.heights[0] / radii[0] + pair.heights[1] / radii[1]) * face.arc;
        let across = (1.0 / radii[0] - 1.0 / radii[1]) * radius;
        for (place, sign) in places.into_iter().zip([-1.0, 1.0]) {
            let Some(place) = place else { continue };
            for axis in 0..3 {
                gradients[place].area[axis] += sign * scale * (along * normal[axis] + across * lean[axis]);
                gradients[place].volume[axis] += sign * face.area * normal[axis];
            }
        }
    });
    Ok(gradients)
}

/// Adds the integrals of the direction from the axis, over the arcs of the circle under one side of the
/// polygon.
fn add_arcs(pair: &Pair, side: Side, lean: &mut Point3) {
    let Side { offset, from, to, frame: [away, along] } = side;
    let (_, radius) = pair.circle();
    let half_chord = ((radius - offset) * (radius + offset)).max(0.0).sqrt();
    let mut add = |from: f64, to: f64| {
        // Of the angle from `away` the cosine and the sine.
        let [p, q] = [from, to].map(|at| (offset / offset.hypot(at), at / offset.hypot(at)));
        if p.0.is_finite() && q.0.is_finite() {
            (0..3).for_each(|axis| lean[axis] += (q.1 - p.1) * away[axis] + (p.0 - q.0) * along[axis]);
        }
    };
    if to <= -half_chord || from >= half_chord {
        add(from, to);
        return;
    }
    if from < -half_chord {
        add(from, -half_chord);
    }
    if to > half_chord {
        add(half_chord, to);
    }
}
