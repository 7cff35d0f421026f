//! Computes links from configurations: gathers the edges opposite to corners by set (thesis 7.4).
//!
//! The link of J has the edge (a, b) for each configuration (vab, I) such that J is the union of I and v. A
//! counting sort groups edges by the least knot of J. The few edges with the same least knot are then sorted
//! by the rest of J.

use super::knots::Knots;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::configurations::{Configurations, FARAWAY, Links};

/// A directed edge packed into one integer, with the start in the upper half; comparing one integer is faster
/// than comparing two.
type Edge = u64;

fn edge(from: u32, to: u32) -> Edge {
    u64::from(from) << 32 | u64::from(to)
}

fn ends(edge: Edge) -> [u32; 2] {
    [(edge >> 32) as u32, edge as u32]
}

/// Buffers for the sets with one least knot.
#[derive(Default)]
struct Bucket {
    /// The sets without their least knots, concatenated.
    keys: Vec<u32>,
    edges: Vec<Edge>,
    order: Vec<u32>,
    set: Vec<u32>,
    link: Vec<Edge>,
    polygon: Vec<u32>,
}

/// Calls `visit` with each set, sorted, and its link, a closed polygon of at least two vertices. Sets come in
/// the sequence of their least knots in `order`, a permutation of all knots, and then lexicographically.
///
/// Cost: O(c k log c) for c configurations. Memory: 16 bytes per configuration.
pub(super) fn for_each_link(
    knots: &Knots,
    configurations: &Configurations,
    order: &[u32],
    mut visit: impl FnMut(&[u32], &[u32]) -> Result<()>,
) -> Result<()> {
    debug_assert_eq!(order.len(), knots.len());
    let corners = Corners::of(order, configurations)?;
    let mut bucket = Bucket::default();
    for (place, &least) in order.iter().enumerate() {
        let range = corners.starts[place] as usize..corners.starts[place + 1] as usize;
        bucket.fill(configurations, &corners, &corners.records[range]);
        bucket.visit_links(configurations.degree(), least, &mut visit)?;
    }
    Ok(())
}

/// The links that configurations leave; see [`Links`].
///
/// # Errors
/// A link that is not a closed polygon; configurations of [`super::link_triangulate`] have none.
pub fn links(knots: &Knots, configurations: &Configurations) -> Result<Links> {
    let mut links = Links::new(configurations.degree() + 1);
    let order: Vec<u32> = (0..knots.len() as u32).collect();
    for_each_link(knots, configurations, &order, |set, polygon| {
        links.push(set, polygon);
        Ok(())
    })?;
    Ok(links)
}

/// Corners of configurations, sorted by when the least knot of their set is visited, so that they are read
/// sequentially.
struct Corners {
    /// Three times the number of the configuration, plus the place of the corner.
    records: Vec<u32>,
    /// For each visited knot, its first record.
    starts: Vec<u32>,
    /// Group of each configuration; empty for degree 0.
    groups: Vec<u32>,
}

impl Corners {
    fn of(order: &[u32], configurations: &Configurations) -> Result<Corners> {
        let boundaries = configurations.boundaries();
        if boundaries.len() > (u32::MAX / 3) as usize {
            let message =
                format!("{} configurations in one piece are too many: use fewer knots", boundaries.len());
            return Err(Error::new(ErrorKind::Memory, message));
        }
        let mut groups = Vec::new();
        if configurations.degree() > 0 {
            groups.reserve_exact(boundaries.len());
            for group in 0..configurations.group_count() {
                groups.resize(configurations.group_end(group), group as u32);
            }
        }
        let mut places = vec![0; order.len()];
        for (place, &knot) in (0u32..).zip(order) {
            places[knot as usize] = place;
        }
        let corners = Corners { records: Vec::new(), starts: Vec::new(), groups };
        let mut starts = vec![0; order.len() + 1];
        corners.for_each(configurations, |least, _| starts[places[least as usize] as usize] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut records = vec![0; sum as usize];
        corners.for_each(configurations, |least, record| {
            let start = &mut starts[places[least as usize] as usize];
            *start -= 1;
            records[*start as usize] = record;
        });
        Ok(Corners { records, starts, ..corners })
    }

    /// For each corner, calls `visit` with the least knot of its set, and the record of the corner.
    fn for_each(&self, configurations: &Configurations, mut visit: impl FnMut(u32, u32)) {
        for (number, boundary) in (0..).zip(configurations.boundaries()) {
            let of_interior = match self.interior(configurations, number).first() {
                Some(&least) => least,
                None => u32::MAX,
            };
            for (place, &v) in (0..).zip(boundary).filter(|&(_, &v)| v != FARAWAY) {
                visit(v.min(of_interior), 3 * number + place);
            }
        }
    }

    /// The interior set of a configuration.
    fn interior<'a>(&self, configurations: &'a Configurations, number: u32) -> &'a [u32] {
        self.groups.get(number as usize).map_or(&[], |&group| configurations.interior(group as usize))
    }
}

impl Bucket {
    fn fill(&mut self, configurations: &Configurations, corners: &Corners, records: &[u32]) {
        self.keys.clear();
        self.edges.clear();
        for &record in records {
            let (number, place) = (record / 3, record as usize % 3);
            let boundary = &configurations.boundaries()[number as usize];
            self.edges.push(edge(boundary[(place + 1) % 3], boundary[(place + 2) % 3]));
            let interior = corners.interior(configurations, number);
            if interior.is_empty() {
                continue;
            }
            let at = interior.partition_point(|&knot| knot < boundary[place]);
            let key = interior[..at].iter().chain(&boundary[place..=place]).chain(&interior[at..]);
            self.keys.extend(key.skip(1));
        }
    }

    /// Sorts edges by set, and visits the link of each set.
    fn visit_links(
        &mut self,
        width: usize,
        least: u32,
        visit: &mut impl FnMut(&[u32], &[u32]) -> Result<()>,
    ) -> Result<()> {
        if width == 0 {
            self.set.clear();
            self.set.push(least);
            return match self.edges.is_empty() {
                true => Ok(()),
                false => visit_chained(&self.set, &mut self.edges, &mut self.polygon, visit),
            };
        }
        let key = |at: u32| &self.keys[at as usize * width..][..width];
        self.order.clear();
        self.order.extend(0..self.edges.len() as u32);
        if width == 1 {
            self.order.sort_unstable_by_key(|&at| self.keys[at as usize]);
        } else {
            self.order.sort_unstable_by_key(|&at| key(at));
        }
        for run in self.order.chunk_by(|&a, &b| key(a) == key(b)) {
            self.set.clear();
            self.set.push(least);
            self.set.extend_from_slice(key(run[0]));
            self.link.clear();
            self.link.extend(run.iter().map(|&at| self.edges[at as usize]));
            visit_chained(&self.set, &mut self.link, &mut self.polygon, visit)?;
        }
        Ok(())
    }
}

fn visit_chained(
    set: &[u32],
    edges: &mut [Edge],
    polygon: &mut Vec<u32>,
    visit: &mut impl FnMut(&[u32], &[u32]) -> Result<()>,
) -> Result<()> {
    if !chain(edges, polygon) {
        return Err(not_closed(set, edges));
    }
    visit(set, polygon)
}

/// Sorts directed edges into one closed polygon without repeated vertices; returns whether that is possible.
fn chain(edges: &mut [Edge], polygon: &mut Vec<u32>) -> bool {
    edges.sort_unstable();
    polygon.clear();
    let [start, mut to] = ends(edges[0]);
    polygon.push(start);
    while to != start && polygon.len() < edges.len() {
        let next = edges.partition_point(|&edge| ends(edge)[0] < to);
        match edges.get(next).map(|&edge| ends(edge)) {
            Some([from, end]) if from == to => to = end,
            _ => return false,
        }
        polygon.push(ends(edges[next])[0]);
    }
    to == start && polygon.len() == edges.len() && polygon.len() >= 2
}

#[cold]
fn not_closed(set: &[u32], edges: &[Edge]) -> Error {
    let edges: Vec<[u32; 2]> = edges.iter().map(|&edge| ends(edge)).collect();
    Error::new(ErrorKind::Audit, format!("its link is no closed polygon; it has the edges {edges:?}"))
        .at(position(set))
}

/// Names a link in error messages.
pub(super) fn position(set: &[u32]) -> String {
    let knots: Vec<String> = set.iter().map(u32::to_string).collect();
    format!("link of knots {}", knots.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_a_polygon_only_if_they_make_one_cycle() {
        let mut polygon = Vec::new();
        let chain = |edges: &mut [[u32; 2]], polygon: &mut Vec<u32>| {
            let mut edges: Vec<Edge> = edges.iter().map(|&[a, b]| edge(a, b)).collect();
            super::chain(&mut edges, polygon)
        };
        assert!(chain(&mut [[4, 2], [2, 9], [9, 4]], &mut polygon));
        assert_eq!(polygon, [2, 9, 4]);
        assert!(chain(&mut [[4, 2], [2, 4]], &mut polygon));
        assert_eq!(polygon, [2, 4]);
        assert!(!chain(&mut [[4, 2], [2, 9]], &mut polygon), "open");
        assert!(!chain(&mut [[1, 2], [2, 3], [3, 1], [4, 5], [5, 4]], &mut polygon), "two cycles");
        assert!(!chain(&mut [[1, 2], [2, 3], [3, 2], [2, 1]], &mut polygon), "a vertex twice");
        assert!(!chain(&mut [[1, 2], [2, 3], [3, 4], [4, 2]], &mut polygon), "a loop with a tail");
        assert!(!chain(&mut [[1, 1]], &mut polygon), "an edge without length");
    }
}
