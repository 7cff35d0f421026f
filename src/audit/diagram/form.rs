//! Checks without geometry: the order of points and cells, ranges of numbers, mutual neighbours; faces
//! counted once.

use super::Proof;
use super::violation::{Claim, Violation};
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};

/// Proves that points are finite and in strictly increasing order.
pub(super) fn check_points(points: &[Point4]) -> Result<(), Violation> {
    check_finite(points)?;
    for (i, pair) in points.windows(2).enumerate() {
        if pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less) {
            let fault = if pair[0] == pair[1] { "coincide" } else { "are out of order" };
            let message = format!("points {i} and {} {fault}", i + 1);
            return Err(Violation::new(Claim::Points, message).at(points, &[i as u32, i as u32 + 1]));
        }
    }
    Ok(())
}

/// Proves that all coordinates are finite, and that 32 bits number the points.
pub(super) fn check_finite(points: &[Point4]) -> Result<(), Violation> {
    if u32::try_from(points.len()).is_err() {
        let message = format!("{} points, but numbers have 32 bits", points.len());
        return Err(Violation::new(Claim::Points, message));
    }
    let Some(i) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) else { return Ok(()) };
    let message = format!("point {i} is not finite");
    Err(Violation::new(Claim::Points, message).at(points, &[i as u32]))
}

/// Proves that the lists of cells are well formed, that the cells are in order and that neighbours are
/// mutual. Returns the number of finite cells.
pub(super) fn check_cells(points: &[Point4], cells: &Cells4) -> Result<usize, Violation> {
    if u32::try_from(cells.len()).is_err() {
        return Err(Violation::new(Claim::Cells, "more cells than 32 bits number"));
    }
    let finite = cells.iter().position(|cell| cell.is_infinite).unwrap_or(cells.len());
    for (number, cell) in cells.iter().enumerate() {
        let refuse = |claim, message: String| {
            Err(Violation::new(claim, message).of_cells(&[number]).at(points, cell.vertices))
        };
        if let Err(message) = check_lists(cell, points.len(), cells.len()) {
            return refuse(Claim::Cells, format!("cell {number}: {message}"));
        }
        if number > 0 && !is_in_order(cells.get(number - 1), cell) {
            return refuse(Claim::Order, format!("cells {} and {number} are out of order", number - 1));
        }
        if cell.is_infinite {
            let of_finite = cell.neighbours.partition_point(|&neighbour| (neighbour as usize) < finite);
            if of_finite != 1 {
                let message =
                    format!("infinite cell {number} has {of_finite} finite neighbours, expected one");
                return refuse(Claim::Neighbours, message);
            }
        }
        for &neighbour in cell.neighbours {
            let back = cells.get(neighbour as usize).neighbours;
            if neighbour as usize == number || back.binary_search(&(number as u32)).is_err() {
                let message =
                    format!("cell {number} names cell {neighbour} as neighbour, which does not name it");
                return refuse(Claim::Neighbours, message);
            }
        }
    }
    Ok(finite)
}

/// Whether a cell follows the previous one: finite cells come first, then vertices decide, and no two cells
/// are equal.
fn is_in_order(previous: Cell4, cell: Cell4) -> bool {
    (previous.is_infinite, previous.vertices) < (cell.is_infinite, cell.vertices)
}

/// Checks that numbers are in range and increasing, and at least as many as any cell has.
fn check_lists(cell: Cell4, points: usize, cells: usize) -> Result<(), String> {
    check_list("vertices", cell.vertices, points, if cell.is_infinite { 4 } else { 5 })?;
    check_list("neighbours", cell.neighbours, cells, 5)
}

fn check_list(name: &str, list: &[u32], end: usize, least: usize) -> Result<(), String> {
    if list.len() < least {
        return Err(format!("{} {name}, expected at least {least}", list.len()));
    }
    if let Some(pair) = list.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(format!("its {name} {} and {} are out of order", pair[0], pair[1]));
    }
    match list.last() {
        Some(&last) if last as usize >= end => Err(format!("number {last} in its {name}, of {end}")),
        _ => Ok(()),
    }
}

/// Proves that each point is a vertex of one of these lists.
pub(super) fn check_vertices<'a>(
    points: &[Point4],
    lists: impl Iterator<Item = &'a [u32]>,
) -> Result<(), Violation> {
    let mut is_used = vec![false; points.len()];
    lists.flatten().for_each(|&vertex| is_used[vertex as usize] = true);
    let Some(unused) = is_used.iter().position(|&is_used| !is_used) else { return Ok(()) };
    let message = format!("no cell has the vertex {unused}");
    Err(Violation::new(Claim::Vertices, message).at(points, &[unused as u32]))
}

/// Counts distinct keys, in a buffer of twice as many.
///
/// Cost: a sort whenever the buffer is full, so that a key is sorted a few times.
///
/// Memory: 8 N bytes per distinct key.
#[derive(Debug, Default)]
pub(super) struct Distinct<const N: usize> {
    keys: Vec<[u32; N]>,
    limit: usize,
}

/// Least capacity of the buffer, in keys.
const BUFFER_MIN: usize = 1 << 12;

impl<const N: usize> Distinct<N> {
    pub(super) fn add(&mut self, key: [u32; N]) {
        if self.keys.len() >= self.limit.max(BUFFER_MIN) {
            let distinct = self.count();
            self.limit = 2 * distinct;
        }
        self.keys.push(key);
    }

    /// Number of distinct keys so far.
    pub(super) fn count(&mut self) -> usize {
        self.keys.sort_unstable();
        self.keys.dedup();
        self.keys.len()
    }
}

/// Proves Euler's relation of a ball.
pub(super) fn check_euler(proof: &Proof) -> Result<(), Violation> {
    let Proof { vertices, edges, polygons, facets, cells, .. } = *proof;
    if vertices + polygons + cells == edges + facets + 1 {
        return Ok(());
    }
    let message = format!(
        "{vertices} vertices - {edges} edges + {polygons} polygons - {facets} facets + {cells} cells is not 1"
    );
    Err(Violation::new(Claim::Euler, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_count_once_across_sorts() {
        let mut distinct = Distinct::default();
        (0..3 * BUFFER_MIN as u32).for_each(|i| distinct.add([i % 5_000, i % 2]));
        assert_eq!(distinct.count(), 5_000);
        (0..40_000).for_each(|i| distinct.add([i % 20_000, i % 2]));
        assert_eq!(distinct.count(), 20_000);
    }
}
