//! An index of the walls of space, to find them among the facets of tetrahedra.

/// Stands for the vertex of a point that is none, as it coincides with another.
const NO_VERTEX: u32 = u32::MAX;

/// Oriented triangles of vertices by their least corner: for most facets, one access to an array shows that
/// they are not walls.
#[derive(Debug, Default)]
pub(super) struct WallIndex {
    /// For each point, its place among the vertices.
    places: Vec<u32>,
    /// For each vertex, the end of the range of walls whose least corner it is. The range starts where the
    /// range of the vertex before ends.
    ends: Vec<u32>,
    /// The other two corners of each wall, in their order after the least one.
    others: Vec<[u32; 2]>,
}

impl WallIndex {
    /// Replaces the content by `walls` between so many points, of which `points` are the vertices.
    pub(super) fn fill(
        &mut self,
        walls: &[[u32; 3]],
        count: usize,
        points: impl ExactSizeIterator<Item = u32>,
    ) {
        self.ends.clear();
        self.ends.resize(points.len(), 0);
        self.places.clear();
        self.places.resize(count, NO_VERTEX);
        (0..).zip(points).for_each(|(place, point)| self.places[point as usize] = place);
        self.others.clear();
        self.others.resize(walls.len(), [0; 2]);
        let places = &self.places;
        let walls = walls.iter().map(|wall| turned(wall.map(|point| places[point as usize])));
        // One with a corner that is no vertex is no facet.
        let walls = walls.filter(|wall| !wall.contains(&NO_VERTEX));
        walls.clone().for_each(|[least, ..]| self.ends[least as usize] += 1);
        let mut next = 0;
        for end in &mut self.ends {
            next += std::mem::replace(end, next);
        }
        for [least, b, c] in walls {
            let end = &mut self.ends[least as usize];
            self.others[*end as usize] = [b, c];
            *end += 1;
        }
    }

    /// Whether a triangle is a wall, in this orientation.
    #[inline]
    pub(super) fn contains(&self, triangle: [u32; 3]) -> bool {
        let [least, b, c] = turned(triangle);
        let least = least as usize;
        let start = if least == 0 { 0 } else { self.ends[least - 1] };
        self.others[start as usize..self.ends[least] as usize].contains(&[b, c])
    }
}

/// The same triangle in the same orientation, its least corner first.
#[inline]
pub(super) fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_are_found_in_their_orientation_only() {
        let walls = [[0, 1, 2], [2, 0, 3], [5, 4, 3], [4, 1, 2], [0, 2, 1]];
        let mut index = WallIndex::default();
        index.fill(&[[1, 2, 3]], 9, 0..9);
        // Points 6 and 7 are no vertices, and the others are vertices from the last on.
        let of_points = walls.map(|wall| wall.map(|vertex| 5 - vertex));
        index.fill(&[&of_points[..], &[[0, 1, 6]]].concat(), 8, (0..6).rev());
        let mut count = 0;
        for a in 0..6 {
            for b in (0..6).filter(|&b| b != a) {
                for c in (0..6).filter(|&c| c != a && c != b) {
                    let expected = walls.contains(&[a, b, c])
                        || walls.contains(&[b, c, a])
                        || walls.contains(&[c, a, b]);
                    assert_eq!(index.contains([a, b, c]), expected, "{a} {b} {c}");
                    count += u32::from(expected);
                }
            }
        }
        assert_eq!(count, 15);
    }
}
