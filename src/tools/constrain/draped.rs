//! Vertices of lines that took the elevation of the surface although the mesh has the line that they divide.

use foldhash::{HashMap, HashSet};
use spmesh_model::network::{Network, NetworkSegment};
use spmesh_model::points::Point2;

/// Steps of the grid that noding moves a vertex off its line and the ends of the line, together, at most.
const STEPS: f64 = 2.0;

/// A line, and a vertex on it.
type Visit = (u32, u32);

/// The number of `added` vertices without an elevation of their own that divide a straight part of a line
/// between two other vertices of the mesh. `is_in_mesh` says which vertices are in it now; `step` is that of
/// the grid of lines.
pub(super) fn count(network: &Network, mut added: Vec<u32>, is_in_mesh: &[bool], step: f64) -> u64 {
    added.sort_unstable();
    let is_added = |vertex: u32| added.binary_search(&vertex).is_ok();
    let is_known = |vertex: u32| is_in_mesh[vertex as usize] && !is_added(vertex);
    let near = STEPS * step;
    let mut beside: HashMap<Visit, Vec<u32>> = HashMap::default();
    let divided = || network.segments.iter().filter(|segment| segment.ends.into_iter().any(is_added));
    for &NetworkSegment { ends: [a, b], line, .. } in divided() {
        beside.entry((line, a)).or_default().push(b);
        beside.entry((line, b)).or_default().push(a);
    }
    let mut found: HashSet<u32> = HashSet::default();
    for &NetworkSegment { ends: [a, b], line, .. } in divided() {
        for [from, to] in [[a, b], [b, a]] {
            if !is_known(from) || !is_added(to) {
                continue;
            }
            let (mut chain, mut last, mut at) = (Vec::new(), from, to);
            while is_added(at)
                && let [one, other] = beside[&(line, at)][..]
            {
                chain.push(at);
                (last, at) = (at, if one == last { other } else { one });
            }
            let place = |vertex: u32| network.vertices[vertex as usize].place;
            let ends = [from, at].map(place);
            if is_known(at) {
                found.extend(chain.into_iter().filter(|&vertex| distance(ends, place(vertex)) < near));
            }
        }
    }
    found.len() as u64
}

/// The distance of a place from the straight line through two others.
fn distance([a, b]: [Point2; 2], place: Point2) -> f64 {
    let minus = |p: Point2| [p[0] - a[0], p[1] - a[1]];
    let (along, to) = (minus(b), minus(place));
    let length = along[0].hypot(along[1]);
    if length == 0.0 { to[0].hypot(to[1]) } else { (along[0] * to[1] - along[1] * to[0]).abs() / length }
}
