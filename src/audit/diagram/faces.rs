//! The faces of one cell, from the vertex sets of its facets.

use super::violation::{Claim, Violation};

/// Lists of numbers, one after the other.
#[derive(Debug, Default)]
pub(super) struct Lists {
    items: Vec<u32>,
    ends: Vec<usize>,
}

impl Lists {
    pub(super) fn clear(&mut self) {
        self.items.clear();
        self.ends.clear();
    }

    pub(super) fn push(&mut self, list: impl IntoIterator<Item = u32>) {
        self.items.extend(list);
        self.ends.push(self.items.len());
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn get(&self, number: usize) -> &[u32] {
        let start = if number == 0 { 0 } else { self.ends[number - 1] };
        &self.items[start..self.ends[number]]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|number| self.get(number))
    }
}

/// Numbers that are in both of two increasing lists.
pub(super) fn common<'a>(one: &'a [u32], other: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let mut rest = other;
    one.iter().copied().filter(move |number| {
        while rest.first().is_some_and(|first| first < number) {
            rest = &rest[1..];
        }
        rest.first() == Some(number)
    })
}

/// Numbers of an increasing list that are not in another.
pub(super) fn without<'a>(one: &'a [u32], other: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let mut rest = other;
    one.iter().copied().filter(move |number| {
        while rest.first().is_some_and(|first| first < number) {
            rest = &rest[1..];
        }
        rest.first() != Some(number)
    })
}

/// Pairs of sets with enough numbers in common, with these numbers.
#[derive(Debug, Default)]
struct Meetings {
    sets_of: Vec<Vec<u32>>,
    /// How many numbers the current set shares with each.
    shared: Vec<u32>,
    met: Vec<u32>,
    pairs: Vec<[u32; 2]>,
    common: Lists,
}

impl Meetings {
    /// Finds the pairs that share at least `least` numbers. All numbers are below `end`.
    ///
    /// Cost: for each number in a set, the number of sets that contain it.
    fn find(&mut self, sets: &Lists, end: usize, least: u32) {
        self.pairs.clear();
        self.common.clear();
        self.sets_of.resize_with(end.max(self.sets_of.len()), Vec::new);
        self.sets_of[..end].iter_mut().for_each(Vec::clear);
        self.shared.clear();
        self.shared.resize(sets.len(), 0);
        for (i, set) in sets.iter().enumerate() {
            for &number in set {
                for &earlier in &self.sets_of[number as usize] {
                    if self.shared[earlier as usize] == 0 {
                        self.met.push(earlier);
                    }
                    self.shared[earlier as usize] += 1;
                }
                self.sets_of[number as usize].push(i as u32);
            }
            for earlier in self.met.drain(..) {
                if std::mem::take(&mut self.shared[earlier as usize]) >= least {
                    self.pairs.push([earlier, i as u32]);
                    self.common.push(common(sets.get(earlier as usize), set));
                }
            }
        }
    }
}

/// The faces of the current cell. Vertices are numbered by their place in the cell, facets by the place of
/// the neighbour across.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) facets: Lists,
    ridges: Meetings,
    edges: Meetings,
    /// Numbers of the ridges of each facet.
    around: Vec<Vec<u32>>,
    /// Vertices of the ridges of the current facet.
    polygons: Lists,
    /// Number of edges found of each ridge.
    found: Vec<usize>,
}

impl Faces {
    /// Proves that the facets are all facets of the cell, provided that each is a facet.
    ///
    /// Two facets share a ridge if they have at least three vertices in common. A ridge is a polygon, and has
    /// as many edges as vertices. If each of its edges is shared with another ridge of the facet, then the
    /// ridges of the facet are complete, because they are connected through edges. If all ridges of all
    /// facets are shared with another facet, then the facets are complete, because they are connected through
    /// ridges.
    ///
    /// Calls `edge` for each edge with the three facets that it was found in, possibly more than once.
    pub(super) fn check(
        &mut self,
        vertices: usize,
        mut edge: impl FnMut([u32; 2], [usize; 3]),
    ) -> Result<(), Fault> {
        self.ridges.find(&self.facets, vertices, 3);
        self.sort_ridges();
        for facet in 0..self.facets.len() {
            let around = &self.around[facet];
            self.polygons.clear();
            around
                .iter()
                .for_each(|&i| self.polygons.push(self.ridges.common.get(i as usize).iter().copied()));
            self.edges.find(&self.polygons, vertices, 2);
            self.found.clear();
            self.found.resize(around.len(), 0);
            for (pair, ends) in self.edges.pairs.iter().zip(self.edges.common.iter()) {
                let [one, other] = pair.map(|i| self.beyond(around[i as usize], facet));
                let &[p, q] = ends else { return Err(Fault { facets: vec![facet, one, other] }) };
                pair.iter().for_each(|&i| self.found[i as usize] += 1);
                edge([p, q], [facet, one, other]);
            }
            if around.is_empty() {
                return Err(Fault { facets: vec![facet] });
            }
            let is_open = |&i: &usize| self.found[i] != self.polygons.get(i).len();
            if let Some(open) = (0..around.len()).find(is_open) {
                return Err(Fault { facets: vec![facet, self.beyond(around[open], facet)] });
            }
        }
        Ok(())
    }

    /// Finds the ridges of every facet.
    fn sort_ridges(&mut self) {
        let facets = self.facets.len();
        self.around.resize_with(facets.max(self.around.len()), Vec::new);
        self.around[..facets].iter_mut().for_each(Vec::clear);
        for (i, pair) in (0..).zip(&self.ridges.pairs) {
            pair.iter().for_each(|&facet| self.around[facet as usize].push(i));
        }
    }

    /// The facet on the other side of a ridge.
    fn beyond(&self, ridge: u32, facet: usize) -> usize {
        let [one, other] = self.ridges.pairs[ridge as usize].map(|i| i as usize);
        if one == facet { other } else { one }
    }

    /// Ridges of the cell, after [`Faces::check`]: the facets on both sides, and the vertices.
    pub(super) fn ridges(&self) -> impl Iterator<Item = ([usize; 2], &[u32])> {
        self.ridges
            .pairs
            .iter()
            .zip(self.ridges.common.iter())
            .map(|(pair, list)| (pair.map(|i| i as usize), list))
    }
}

/// Facets between which a face is missing.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) facets: Vec<usize>,
}

impl Fault {
    pub(super) fn violation(&self, cell: usize, neighbours: &[u32]) -> Violation {
        let beyond: Vec<usize> = self.facets.iter().map(|&facet| neighbours[facet] as usize).collect();
        let message = format!(
            "the facets of cell {cell} do not close up: a neighbour is missing at the facet to cell {}{}",
            beyond[0],
            match beyond.get(1) {
                Some(other) => format!(", near the one to cell {other}"),
                None => String::new(),
            }
        );
        Violation::new(Claim::Faces, message).of_cells(&[cell]).of_cells(&beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The facets of a simplex of four dimensions, of the cube, and of a prism over a square pyramid.
    fn polytopes() -> Vec<(usize, Vec<Vec<u32>>)> {
        let simplex = (0..5).map(|left| (0..5).filter(|&v| v != left).collect()).collect();
        let cube =
            (0..8).map(|facet| (0..16).filter(|v| v >> (facet / 2) & 1 == facet % 2).collect()).collect();
        let pyramid: [&[u32]; 5] = [&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[0, 3, 4]];
        let raised = |list: &[u32]| -> Vec<u32> { list.iter().map(|v| v + 5).collect() };
        let mut prism: Vec<Vec<u32>> =
            pyramid.iter().map(|list| [list.to_vec(), raised(list)].concat()).collect();
        prism.extend([vec![0, 1, 2, 3, 4], vec![5, 6, 7, 8, 9]]);
        vec![(5, simplex), (16, cube), (10, prism)]
    }

    fn check(vertices: usize, facets: &[Vec<u32>]) -> Result<[usize; 2], Fault> {
        let mut faces = Faces::default();
        facets.iter().for_each(|facet| faces.facets.push(facet.iter().copied()));
        let mut edges = Vec::new();
        faces.check(vertices, |edge, _| edges.push(edge))?;
        edges.sort_unstable();
        edges.dedup();
        Ok([faces.ridges().count(), edges.len()])
    }

    #[test]
    fn faces_of_whole_polytopes_are_found() {
        let found: Vec<_> = polytopes().iter().map(|(vertices, facets)| check(*vertices, facets)).collect();
        assert_eq!(found, [Ok([10, 10]), Ok([24, 32]), Ok([18, 21])]);
    }

    #[test]
    fn every_missing_facet_is_missed() {
        for (vertices, facets) in polytopes() {
            for left in 1..1u32 << facets.len() {
                let kept = (0..facets.len()).filter(|i| left >> i & 1 == 0);
                let some: Vec<Vec<u32>> = kept.map(|i| facets[i].clone()).collect();
                assert_eq!(check(vertices, &some).is_ok(), some.is_empty(), "{some:?}");
            }
        }
    }

    #[test]
    fn lists_meet_and_part() {
        let (one, other) = ([1, 3, 5, 9], [0, 3, 4, 9, 10]);
        assert_eq!(common(&one, &other).collect::<Vec<_>>(), [3, 9]);
        assert_eq!(without(&one, &other).collect::<Vec<_>>(), [1, 5]);
        assert_eq!(without(&one, &[]).collect::<Vec<_>>(), [1, 3, 5, 9]);
    }
}
