//! Checks that circles contain the right knots.

use std::cmp::Ordering;

use num_bigint::BigInt;

use super::disk::Disk;
use super::planar::Tree;
use super::{Configurations, Knots};
use crate::exact::dyadic::integers;
use crate::exact::plane::{in_circle, in_raised_circle, orientation};
use spmesh_base::error::{Error, ErrorKind, Result};

/// Checks that the circle of every boundary has its interior set inside, and no other knot; ties are broken
/// as the canonical triangulation does, and the j-th knot at a place is taken to be at `p + e (j, j * j)` for
/// a small number e.
///
/// Infinite configurations are not checked.
///
/// Cost: for each configuration, the knots in boxes of a tree that its circle meets.
///
/// # Errors
/// The first violation (kind [`ErrorKind::Audit`]).
pub fn check_circles(knots: &Knots, configurations: &Configurations) -> Result<()> {
    let tree = Tree::of(knots.points());
    for (boundary, interior) in configurations.finite() {
        let fail = |what: String| {
            Err(Error::new(ErrorKind::Audit, what).at(format!("configuration {boundary:?}, {interior:?}")))
        };
        if boundary.iter().chain(interior).any(|&id| id as usize >= knots.len()) {
            return fail("a knot is unknown".into());
        }
        if turn(knots, boundary) != Ordering::Greater {
            return fail("the boundary is not counterclockwise".into());
        }
        let (mut inside, mut excess) = (0, None);
        tree.for_each_in(&Disk::of(knots, boundary), |id| {
            if !boundary.contains(&id) && is_inside(knots, boundary, id) {
                match interior.binary_search(&id) {
                    Ok(_) => inside += 1,
                    Err(_) => excess = Some(id),
                }
            }
            excess.is_none()
        });
        if let Some(id) = excess {
            return fail(format!("knot {id} is inside of the circle"));
        }
        if inside != interior.len() {
            return fail(format!("of the {} knots inside, only {inside} are", interior.len()));
        }
    }
    Ok(())
}

pub(super) fn turn(knots: &Knots, ids: [u32; 3]) -> Ordering {
    let [a, b, c] = ids.map(|id| knots.points()[id as usize]);
    match orientation(a, b, c).sign {
        Ordering::Equal => turn_of(&moved(knots, ids), [0, 1, 2]),
        sign => sign,
    }
}

fn is_inside(knots: &Knots, [a, b, c]: [u32; 3], d: u32) -> bool {
    let ids = [a, b, c, d];
    let [p, q, r, s] = ids.map(|id| knots.points()[id as usize]);
    let sign = match in_circle(p, q, r, s).sign {
        Ordering::Equal if ids.iter().any(|&id| knots.rank(id) > 0) => circle_of(&moved(knots, ids)),
        Ordering::Equal => in_raised_circle(p, q, r, s),
        sign => sign,
    };
    sign == Ordering::Greater
}

/// Positions scaled to integers, with e = 2^-shift: 1 / e exceeds all coefficients of a determinant of these
/// points, which are less than 2^(4 bits + 16) with ranks counted.
pub(super) fn moved<const N: usize>(knots: &Knots, ids: [u32; N]) -> [[BigInt; 2]; N] {
    let points = integers(ids.map(|id| knots.points()[id as usize]));
    let bits = points.as_flattened().iter().map(BigInt::bits).max().unwrap_or(0).max(64);
    let shift = 6 * bits + 400;
    std::array::from_fn(|i| {
        let rank = BigInt::from(knots.rank(ids[i]));
        [(&points[i][0] << shift) + &rank, (&points[i][1] << shift) + &rank * &rank]
    })
}

fn area<const N: usize>(points: &[[BigInt; 2]; N], [i, j, k]: [usize; 3]) -> BigInt {
    let [p, q, r] = [&points[i], &points[j], &points[k]];
    (&q[0] - &p[0]) * (&r[1] - &p[1]) - (&q[1] - &p[1]) * (&r[0] - &p[0])
}

fn turn_of<const N: usize>(points: &[[BigInt; 2]; N], places: [usize; 3]) -> Ordering {
    area(points, places).cmp(&BigInt::ZERO)
}

/// Side of the last point against the circle of the others, counterclockwise; by ranks if it is on it.
fn circle_of(points: &[[BigInt; 2]; 4]) -> Ordering {
    let coefficients = [[3, 1, 2], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
    let lift = |p: &[BigInt; 2]| &p[0] * &p[0] + &p[1] * &p[1];
    let sum: BigInt = (0..4).map(|i| lift(&points[i]) * area(points, coefficients[i])).sum();
    let mut ranked = [0, 1, 2, 3];
    ranked.sort_by(|&i, &j| points[j].cmp(&points[i]));
    let ties = ranked.iter().map(|&i| turn_of(points, coefficients[i]));
    let mut signs = std::iter::once(sum.cmp(&BigInt::ZERO)).chain(ties);
    signs.find(|&sign| sign != Ordering::Equal).unwrap_or(Ordering::Equal)
}
