//! Puts cells in an order that depends on the diagram only.

use spmesh_stream::model::cells4::{Cell4, Cells4};

/// Sorts cells, finite ones first, each kind by vertices, and renumbers neighbours.
///
/// Domain: vertices in increasing order, neighbours in any order.
pub(super) fn canonical(unordered: &Cells4) -> Cells4 {
    let order = order(unordered);
    let mut places = vec![0; order.len()];
    for (place, &number) in (0u32..).zip(&order) {
        places[number as usize] = place;
    }
    let mut cells = Cells4::default();
    let mut neighbours = Vec::new();
    for &number in &order {
        let cell = unordered.get(number as usize);
        neighbours.clear();
        neighbours.extend(cell.neighbours.iter().map(|&other| places[other as usize]));
        neighbours.sort_unstable();
        cells.push(Cell4 { neighbours: &neighbours, ..cell });
    }
    cells
}

fn order(cells: &Cells4) -> Vec<u32> {
    // Keys hold the kind and the first vertices, which decide most comparisons without access to the cells:
    // three vertices if 21 bits suffice, otherwise two of 31 bits. The comparison of whole cells makes up for
    // the dropped last bit.
    let greatest = cells.iter().filter_map(|cell| cell.vertices.last().copied()).max().unwrap_or_default();
    let is_narrow = greatest < 1 << 21;
    let key = |number: u32| {
        let cell = cells.get(number as usize);
        let vertex = |i: usize| u64::from(cell.vertices[i]);
        let first = if is_narrow {
            vertex(0) << 42 | vertex(1) << 21 | vertex(2)
        } else {
            vertex(0) << 31 | vertex(1) >> 1
        };
        (u64::from(cell.is_infinite) << 63 | first, number)
    };
    let mut keys: Vec<(u64, u32)> = (0..cells.len() as u32).map(key).collect();
    let vertices = |number: u32| cells.get(number as usize).vertices;
    keys.sort_unstable_by(|&(key, a), &(other, b)| {
        key.cmp(&other).then_with(|| vertices(a).cmp(vertices(b)))
    });
    keys.into_iter().map(|(_, number)| number).collect()
}
