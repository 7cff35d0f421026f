//! Vertices in no tetrahedron of a mesh with weights: their cells in the power diagram must be empty.

use std::cmp::Ordering;

use super::Corner;
use crate::Standard;
use crate::check::{Check, Ledger, Violation};
use crate::corner::{name_corners, named};
use crate::exact::power::{in_orthosphere, in_raised_orthosphere};
use crate::exact::space::orientation;
use crate::point_tree::PointTree;

/// Hidden vertices that wait for the tetrahedron that holds them.
///
/// The convex function of the whole mesh, whose graph has the lifted vertices, has one value at a hidden
/// vertex, whichever of the tetrahedra that touch it says so. So the first one is enough: the vertex must not
/// lie below.
///
/// Memory: the hidden vertices that wait.
#[derive(Default)]
pub(super) struct Hidden {
    /// Those of the patches since the last tetrahedron.
    fresh: Vec<Corner>,
    /// The others, in sets of which each is more than twice as large as the next.
    sets: Vec<Waiting>,
    seen: u64,
}

/// Some waiting vertices.
struct Waiting {
    corners: Vec<Corner>,
    is_held: Vec<bool>,
    left: usize,
    tree: PointTree<3>,
}

impl Waiting {
    fn of(corners: Vec<Corner>) -> Waiting {
        let (is_held, left) = (vec![false; corners.len()], corners.len());
        Waiting { tree: PointTree::new(corners.iter().map(|corner| corner.at)), corners, is_held, left }
    }

    fn into_left(self) -> impl Iterator<Item = Corner> {
        self.corners.into_iter().zip(self.is_held).filter(|(_, is_held)| !is_held).map(|(corner, _)| corner)
    }
}

impl Hidden {
    pub(super) fn add(&mut self, corner: Corner) {
        self.seen += 1;
        self.fresh.push(corner);
    }

    /// The vertices, if there was no tetrahedron.
    pub(super) fn into_corners(self) -> Vec<Corner> {
        self.fresh
    }

    /// Number of hidden vertices so far.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }

    /// Takes a positive tetrahedron, and checks the vertices in it.
    pub(super) fn tetrahedron(
        &mut self,
        corners: &[Corner; 4],
        standard: Standard,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        self.sort();
        let side = |pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|axis| {
                corners[1..].iter().map(|p| p.at[axis]).fold(corners[0].at[axis], pick)
            })
        };
        let (low, high) = (side(f64::min), side(f64::max));
        for Waiting { corners: waiting, is_held, left, tree } in &mut self.sets {
            tree.in_box(low, high, |at, number| {
                let number = number as usize;
                if is_held[number] || !holds(corners, at) {
                    return Ok(());
                }
                is_held[number] = true;
                *left -= 1;
                check_hidden(corners, waiting[number], standard, ledger)
            })?;
        }
        self.sets.retain(|set| set.left > 0);
        Ok(())
    }

    /// Proves that no vertex waits any more.
    pub(super) fn check_held(&mut self) -> Result<(), Violation> {
        self.sort();
        let waiting = self.sets.drain(..).flat_map(Waiting::into_left);
        let Some(corner) = waiting.min_by_key(|corner| corner.id) else { return Ok(()) };
        let message = format!("no tetrahedron has vertex {}, and none that follows holds it", corner.id);
        Err(name_corners(Violation::new(Check::Hidden, message), &[corner]))
    }

    /// Puts new vertices into sets.
    fn sort(&mut self) {
        if self.fresh.is_empty() {
            return;
        }
        let mut corners = std::mem::take(&mut self.fresh);
        while let Some(set) = self.sets.pop_if(|set| set.left <= 2 * corners.len()) {
            corners.extend(set.into_left());
        }
        self.sets.push(Waiting::of(corners));
    }
}

/// Whether the closed tetrahedron holds a place.
fn holds([a, b, c, d]: &[Corner; 4], at: [f64; 3]) -> bool {
    let [a, b, c, d] = [a.at, b.at, c.at, d.at];
    [[at, b, c, d], [a, at, c, d], [a, b, at, d], [a, b, c, at]]
        .into_iter()
        .all(|[p, q, r, s]| orientation(p, q, r, s).sign != Ordering::Less)
}

/// Checks that a vertex in a tetrahedron is hidden by it.
fn check_hidden(
    corners: &[Corner; 4],
    vertex: Corner,
    standard: Standard,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    if let Some(other) = corners.iter().find(|corner| corner.at == vertex.at) {
        let message = format!("vertices {} and {} coincide", other.id, vertex.id);
        return Err(name_corners(Violation::new(Check::Vertices, message), &[*other, vertex]));
    }
    let (four, fifth) = (corners.map(Corner::weighted), vertex.weighted());
    let place = in_orthosphere(four, fifth);
    ledger.count(Check::Hidden, place.exactly);
    let is_hidden = match place.sign {
        Ordering::Less => true,
        Ordering::Greater => false,
        Ordering::Equal => {
            standard == Standard::Delaunay || in_raised_orthosphere(four, fifth) == Ordering::Less
        }
    };
    if is_hidden {
        return Ok(());
    }
    let message = format!(
        "no tetrahedron has vertex {}, but its weight is too great for the tetrahedron {} around it",
        vertex.id,
        named(corners)
    );
    Err(name_corners(name_corners(Violation::new(Check::Hidden, message), &[vertex]), corners))
}
