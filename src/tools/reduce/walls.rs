//! An index of the walls of space, to find them among the facets of tetrahedra.

/// Oriented triangles by their least corner: for most facets, one access to an array shows that they are not
/// walls.
#[derive(Debug, Default)]
pub(super) struct WallIndex {
    /// For each point, the end of the range of walls whose least corner it is. The range starts where the
    /// range of the point before ends.
    ends: Vec<u32>,
    /// The other two corners of each wall, in their order after the least one.
    others: Vec<[u32; 2]>,
}

impl WallIndex {
    /// Replaces the content by `walls` between `points` points.
    pub(super) fn fill(&mut self, walls: &[[u32; 3]], points: usize) {
        self.ends.clear();
        self.ends.resize(points, 0);
        self.others.clear();
        self.others.resize(walls.len(), [0; 2]);
        walls.iter().for_each(|&wall| self.ends[turned(wall)[0] as usize] += 1);
        let mut next = 0;
        for end in &mut self.ends {
            next += std::mem::replace(end, next);
        }
        for &wall in walls {
            let [least, b, c] = turned(wall);
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
        index.fill(&[[1, 2, 3]], 9);
        index.fill(&walls, 6);
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
