//! Vertices of lines that took the elevation of the surface although the mesh has the line that they divide.

use super::near::foot;
use foldhash::{HashMap, HashSet};
use spmesh_delaunay::network::{Network, NetworkSegment};

/// Steps of the grid that noding moves a vertex off its line and the ends of the line, together, at most.
const STEPS: f64 = 2.0;

/// A line, and a vertex on it.
type Visit = (u32, u32);

/// The number of `added` vertices without an elevation of their own that divide a straight part of a line
/// between two other vertices of the mesh. `is_in_mesh` says which vertices are in it now.
pub(super) fn count(network: &Network, mut added: Vec<u32>, is_in_mesh: &[bool]) -> u64 {
    added.sort_unstable();
    let is_added = |vertex: u32| added.binary_search(&vertex).is_ok();
    let is_known = |vertex: u32| is_in_mesh[vertex as usize] && !is_added(vertex);
    let near = STEPS * network.step;
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
                found.extend(chain.into_iter().filter(|&vertex| foot(ends, place(vertex), near).is_some()));
            }
        }
    }
    found.len() as u64
}
