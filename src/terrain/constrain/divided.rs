//! New vertices on shores between vertices of the mesh that have the elevations of the shore.
//!
//! A line that `spfinalize` did not have divides shores at vertices that are not in the mesh. Between them
//! the shore is no edge yet, so the surface is not level there.

use super::near::{Lines, foot};
use foldhash::HashMap;
use spmesh_delaunay::network::elevation_at;

/// Steps of the grid that noding moves a vertex off its line and the ends of the line, together, at most.
const STEPS: f64 = 2.0;

/// The elevations of vertices of `segments` without one that divide a straight part of a shore between two
/// vertices that have one. Where several shores meet, the lowest counts.
pub(super) fn elevations(lines: &Lines, segments: &[u32]) -> HashMap<u32, f64> {
    let mut beside: HashMap<(u32, u32), Vec<u32>> = HashMap::default();
    for segment in segments.iter().map(|&number| &lines.network.segments[number as usize]) {
        let [a, b] = segment.ends;
        let is_divided = [a, b].into_iter().any(|end| lines.elevation(end).is_none());
        if is_divided && lines.shores.binary_search(&segment.line).is_ok() {
            beside.entry((segment.line, a)).or_default().push(b);
            beside.entry((segment.line, b)).or_default().push(a);
        }
    }
    let mut found: HashMap<u32, f64> = HashMap::default();
    for (&(line, from), others) in &beside {
        let Some(first) = lines.elevation(from) else { continue };
        for &to in others {
            let (mut chain, mut last, mut at) = (Vec::new(), from, to);
            while lines.elevation(at).is_none()
                && let Some(&[one, other]) = beside.get(&(line, at)).map(Vec::as_slice)
            {
                chain.push(at);
                (last, at) = (at, if one == last { other } else { one });
            }
            // The same from both ends.
            let Some(end) = lines.elevation(at).filter(|_| from < at) else { continue };
            let place = |vertex: u32| lines.network.vertices[vertex as usize].place;
            for vertex in chain {
                let part = foot([from, at].map(place), place(vertex), STEPS * lines.network.step);
                if let Some(z) = part.map(|part| elevation_at(part, [first, end])) {
                    found.entry(vertex).and_modify(|lowest| *lowest = lowest.min(z)).or_insert(z);
                }
            }
        }
    }
    found
}
