//! Vertices that took the elevation of the surface although the mesh has the shore that they divide.

use super::near::foot;
use foldhash::{HashMap, HashSet};
use spmesh_delaunay::network::{Network, NetworkSegment};

/// Steps of the grid that noding moves a vertex off its line and the ends of the line, together, at most.
const STEPS: f64 = 2.0;

/// A line, and a vertex on it.
type Visit = (u32, u32);

/// The number of `added` vertices without an elevation of their own that divide a straight part of a shore
/// between two other vertices of the mesh, and are higher or lower than both. `elevations` are NaN for
/// vertices that are not in the mesh now; `shores` are the numbers of lines that may be shores, in order.
pub(super) fn count(network: &Network, mut added: Vec<u32>, elevations: &[f64], shores: &[u32]) -> u64 {
    added.sort_unstable();
    let is_added = |vertex: u32| added.binary_search(&vertex).is_ok();
    let known = |vertex: u32| {
        let z = elevations[vertex as usize];
        (!z.is_nan() && !is_added(vertex)).then_some(z)
    };
    let near = STEPS * network.step;
    let mut beside: HashMap<Visit, Vec<u32>> = HashMap::default();
    let is_divided = |segment: &&NetworkSegment| {
        segment.ends.into_iter().any(is_added) && shores.binary_search(&segment.line).is_ok()
    };
    let divided = || network.segments.iter().filter(is_divided);
    for &NetworkSegment { ends: [a, b], line, .. } in divided() {
        beside.entry((line, a)).or_default().push(b);
        beside.entry((line, b)).or_default().push(a);
    }
    let mut found: HashSet<u32> = HashSet::default();
    for &NetworkSegment { ends: [a, b], line, .. } in divided() {
        for [from, to] in [[a, b], [b, a]] {
            let Some(first) = known(from).filter(|_| is_added(to)) else { continue };
            let (mut chain, mut last, mut at) = (Vec::new(), from, to);
            while is_added(at)
                && let [one, other] = beside[&(line, at)][..]
            {
                chain.push(at);
                (last, at) = (at, if one == last { other } else { one });
            }
            let place = |vertex: u32| network.vertices[vertex as usize].place;
            let ends = [from, at].map(place);
            let Some(last) = known(at) else { continue };
            let is_between = |z: f64| first.min(last) <= z && z <= first.max(last);
            let is_off = |vertex: &u32| !is_between(elevations[*vertex as usize]);
            let is_straight = |vertex: &u32| foot(ends, place(*vertex), near).is_some();
            found.extend(chain.into_iter().filter(is_off).filter(is_straight));
        }
    }
    found.len() as u64
}
