//! Joins cospherical neighbouring simplices to cells, in an order that depends on the diagram only.

mod borders;
mod classes;
mod marks;
mod order;
mod ranks;

use super::Stats;
use super::simplices::{Coefficient, Complex};
use borders::Borders;
use classes::Classes;
use spmesh_model::cells4::{Cells4, Lists4};

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed
/// points), so each cell is a union of its simplices, and two simplices at a facet are in one cell exactly if
/// the vertex of one is on the sphere of the other. A facet of the diagram on the hull is the union of those
/// facets of simplices of one cell that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells<C: Coefficient>(complex: Complex<C>, stats: &mut Stats) -> Cells4 {
    let borders = Borders::of(&complex);
    let Complex { simplices, order: sites, spheres, near, .. } = complex;
    // Free the spheres, a third of the memory or more.
    drop((spheres, near));
    let classes = Classes::new(&simplices, &sites, borders);
    drop(sites);
    (stats.simplices, stats.infinite_simplices) = classes.simplices();
    let finite = classes.finite;
    let (vertices, mut neighbours) = classes.lists(&simplices);
    drop(simplices);
    let order = order::canonical(&vertices, finite);
    renumber(&mut neighbours, &order);
    Cells4::from_lists(vertices, neighbours, &order, finite)
}

/// Replaces classes by their places in an order, and sorts each list.
fn renumber(neighbours: &mut Lists4, order: &[u32]) {
    let mut places = vec![0; order.len()];
    for (place, &class) in (0u32..).zip(order) {
        places[class as usize] = place;
    }
    for class in 0..neighbours.len() {
        let list = neighbours.get_mut(class);
        list.iter_mut().for_each(|other| *other = places[*other as usize]);
        ranks::sort_distinct(list);
    }
}

/// Simplices or cells to prefetch ahead.
const AHEAD: usize = 8;
