//! Joins cospherical neighbouring simplices to cells, in an order that depends on the diagram only.

mod borders;
mod classes;
mod lists;
mod marks;
mod order;
mod ranks;

use super::Stats;
use super::simplices::{Coefficient, Complex};
use borders::Borders;
use classes::Classes;
use spmesh_model::cells4::{Cell4, Cells4};

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed
/// points), so each cell is a union of its simplices, and two simplices at a facet are in one cell exactly if
/// the vertex of one is on the sphere of the other. A facet of the diagram on the hull is the union of those
/// facets of simplices of one cell that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells<C: Coefficient>(complex: Complex<C>, stats: &mut Stats) -> Cells4 {
    let borders = Borders::of(&complex);
    let Complex { simplices, order: sites, spheres, .. } = complex;
    // Free the spheres, a third of the memory or more.
    drop(spheres);
    let classes = Classes::new(&simplices, &sites, borders);
    drop(sites);
    (stats.simplices, stats.infinite_simplices) = classes.simplices();
    let neighbours = classes.neighbours(&simplices);
    drop(simplices);
    let Classes { vertices, finite, .. } = classes;
    let order = order::canonical(&vertices, finite);
    let mut places = vec![0; order.len()];
    for (place, &class) in (0u32..).zip(&order) {
        places[class as usize] = place;
    }
    let mut cells = Cells4::with_capacity(order.len(), vertices.numbers() + neighbours.numbers());
    let mut renumbered = Vec::new();
    for (number, &class) in order.iter().enumerate() {
        if let Some(&later) = order.get(number + AHEAD) {
            vertices.fetch(later as usize);
            neighbours.fetch(later as usize);
        }
        let class = class as usize;
        renumbered.clear();
        renumbered.extend(neighbours.get(class).iter().map(|&other| places[other as usize]));
        ranks::sort_distinct(&mut renumbered);
        let is_infinite = class >= finite;
        cells.push(Cell4 { is_infinite, vertices: vertices.get(class), neighbours: &renumbered });
    }
    cells
}

/// Simplices or cells to prefetch ahead.
const AHEAD: usize = 8;
