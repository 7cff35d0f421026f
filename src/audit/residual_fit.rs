//! Proof that the residual of a partial mesh fits its final simplices, so that other programs can complete the
//! mesh: no residual point lies in the ball of a final simplex, and none is covered by final simplices.
//!
//! # Why balls at walls are enough
//! Let every facet between two final simplices be locally Delaunay, and let a residual point p that no final
//! simplex covers lie in the ball of one of them. Walk from there straight to p. The power of p with respect
//! to the balls falls from each simplex to the next one, so p is in all of their balls. The walk leaves the
//! final simplices through a wall, so p is in the ball of the simplex at this wall.
//!
//! # How covering simplices are counted
//! A ray from next to p goes in the direction of [`super::winding`], in which no facet lies. The number of
//! simplices that cover its start is the number of walls where the ray leaves final simplices, less the number
//! where it enters them. If p is a vertex, its own simplices cover the start as often as its star says.
//! Everything else covers it twice.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::corner::{Corner, name_corners, named};
use super::exact::Decided;
use super::partial::FinalSimplices;
use super::point_tree::PointTree;
use super::triangles::Standard;
use spmesh_stream::model::bounds::Point;

/// A wall with the final simplex at it.
pub(super) struct Wall<const D: usize> {
    /// Numbers of its corners in the residual.
    pub(super) numbers: [u32; D],
    /// Its corners in the order of the stream. With the apex behind them they are a positive simplex.
    pub(super) corners: [Corner<D>; D],
    /// The other corner of the simplex.
    pub(super) apex: Corner<D>,
}

/// The geometry of walls in D dimensions.
pub(super) trait WallGeometry<const D: usize> {
    /// Name of the ball around a simplex in messages.
    const BALL: &'static str;

    /// Whether `at` lies in the ball of the simplex at a wall: `Greater` if it does.
    fn in_ball(wall: [[f64; D]; D], apex: [f64; D], at: [f64; D]) -> Decided;

    /// The same for a point on the ball, after the symbolic perturbation.
    fn in_raised_ball(wall: [[f64; D]; D], apex: [f64; D], at: [f64; D]) -> Ordering;

    /// Centre and radius of a ball that contains the ball of the simplex; `None` if rounding hides it.
    fn enclosing_ball(wall: [[f64; D]; D], apex: [f64; D]) -> Option<([f64; D], f64)>;

    /// 1 if the ray from next to `at` leaves final simplices through the wall, -1 if it enters them, else 0.
    fn crossing(wall: [[f64; D]; D], at: [f64; D]) -> i64;

    /// Box of all places from which the ray may meet the wall.
    fn shadow(wall: [[f64; D]; D]) -> [[f64; D]; 2];
}

/// Checks all residual points against all walls. `ahead` says how many simplices of its own a residual point
/// has in the direction of the ray.
pub(super) fn check<S: FinalSimplices<D>, const D: usize>(
    residual: &[(Option<u64>, Point)],
    walls: &[Wall<D>],
    standard: Standard,
    ahead: impl Fn(u64) -> u16,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let places = residual.iter().map(|(_, at)| std::array::from_fn(|axis| at[axis]));
    let tree = PointTree::new(places);
    for wall in walls {
        check_ball::<S, D>(wall, &tree, residual, standard, ledger)?;
    }
    check_cover::<S, D>(walls, &tree, residual, ahead, ledger)
}

fn check_ball<S: FinalSimplices<D>, const D: usize>(
    wall: &Wall<D>,
    tree: &PointTree<D>,
    residual: &[(Option<u64>, Point)],
    standard: Standard,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let (corners, apex) = (wall.corners.map(|corner| corner.at), wall.apex.at);
    let ball = S::enclosing_ball(corners, apex);
    let [low, high] = match ball {
        Some((centre, radius)) => [-radius, radius].map(|r| centre.map(|middle| middle + r)),
        None => [[f64::NEG_INFINITY; D], [f64::INFINITY; D]],
    };
    tree.in_box(low, high, |at, number| {
        let (id, point) = residual[number as usize];
        let is_corner = wall.numbers.contains(&number) || id == Some(wall.apex.id);
        if is_corner || ball.is_some_and(|(centre, radius)| is_far(at, centre, radius)) {
            return Ok(());
        }
        let place = S::in_ball(corners, apex, at);
        ledger.count(Check::Delaunay, place.exactly);
        let check = match place.sign {
            Ordering::Less => return Ok(()),
            Ordering::Greater => Check::Delaunay,
            Ordering::Equal if standard == Standard::Delaunay => return Ok(()),
            Ordering::Equal => {
                ledger.count(Check::Canonical, true);
                if S::in_raised_ball(corners, apex, at) == Ordering::Less {
                    return Ok(());
                }
                Check::Canonical
            }
        };
        let all = [&wall.corners[..], &[wall.apex]].concat();
        let where_ = if check == Check::Delaunay { "in" } else { "on, and for canonical ties in," };
        let message = format!(
            "a residual point lies {where_} the {} of the final {} {}",
            S::BALL,
            S::NAMES[0],
            named(&all)
        );
        Err(name_corners(Violation::new(check, message).with(id, point), &all))
    })
}

/// Whether a point is certainly outside of a ball.
fn is_far<const D: usize>(at: [f64; D], centre: [f64; D], radius: f64) -> bool {
    let distance: f64 = (0..D).map(|axis| (at[axis] - centre[axis]).powi(2)).sum();
    distance > radius * radius * (1.0 + 1e-9)
}

fn check_cover<S: FinalSimplices<D>, const D: usize>(
    walls: &[Wall<D>],
    tree: &PointTree<D>,
    residual: &[(Option<u64>, Point)],
    ahead: impl Fn(u64) -> u16,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let mut covers = vec![0i64; residual.len()];
    for wall in walls {
        let corners = wall.corners.map(|corner| corner.at);
        let [low, high] = S::shadow(corners);
        tree.in_box(low, high, |at, number| {
            if !wall.numbers.contains(&number) {
                covers[number as usize] += S::crossing(corners, at);
            }
            Ok(())
        })?;
    }
    ledger.add(Check::Residual, residual.len() as u64);
    let own = |&(id, _): &(Option<u64>, Point)| id.map_or(0, |id| i64::from(ahead(id)));
    match residual.iter().zip(&covers).find(|(point, covers)| own(point) != **covers) {
        None => Ok(()),
        Some((&(id, at), _)) => {
            let message = format!("a residual point lies inside of a final {}", S::NAMES[0]);
            Err(Violation::new(Check::Residual, message).with(id, at))
        }
    }
}
