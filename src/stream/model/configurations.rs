//! Configurations of one degree, and links: flat arrays, grouped by sets of knots.

use spmesh_base::error::{Error, ErrorKind, Result};

/// The faraway point in boundaries and links (thesis 4.3): circles through it are lines. It is no knot's id.
pub const FARAWAY: u32 = u32::MAX;

/// What is known about configurations: the lift for which they are the lower side of a k-set polytope, if
/// any.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claim {
    /// Delaunay configurations.
    Delaunay,
    /// Projective configurations of the lift of the rule.
    Lifted,
    /// Results of link triangulation by any rule: nothing else is known.
    Any,
}

/// All configurations (B, I) of one degree k: three knots B, counterclockwise, and k knots I.
///
/// They are grouped by I. Interior sets are sorted, and groups are in lexicographic order of their sets.
/// Within a group, the configurations of three knots come first, each with its least knot first, in
/// lexicographic order. Then come the *infinite* ones `[p, q, FARAWAY]`: lines with I to the left of the
/// direction from p to q, and all other knots except p and q to the right. (A knot on the line counts as left
/// if it is between p and q, and as right otherwise.) Infinite configurations close all links; only the
/// others define splines. The one group of degree 0 is in the order of the triangulation.
///
/// Shape: 12 bytes per configuration, 4 (k + 1) per group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configurations {
    degree: usize,
    claim: Claim,
    /// Interior sets, concatenated.
    interiors: Vec<u32>,
    /// For each group, its first configuration; at the end, the number of configurations.
    offsets: Vec<u32>,
    boundaries: Vec<[u32; 3]>,
    /// Number of configurations without the infinite ones.
    finite: usize,
}

/// The configurations of one interior set, which triangulate its link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Group<'a> {
    /// The interior set, sorted.
    pub interior: &'a [u32],
    /// Boundary triples of knots, counterclockwise.
    pub triangles: &'a [[u32; 3]],
    /// Boundary triples with [`FARAWAY`] in the last place.
    pub infinite: &'a [[u32; 3]],
}

impl Configurations {
    fn empty(degree: usize, claim: Claim) -> Configurations {
        let offsets = vec![0];
        Configurations { degree, claim, interiors: Vec::new(), offsets, boundaries: Vec::new(), finite: 0 }
    }

    /// Degree 0: the triangles of a triangulation, infinite ones included, in any order. They keep their
    /// order, which should be local: triangles that are close in the list should be close in the plane.
    pub fn of_triangles(claim: Claim, mut triangles: Vec<[u32; 3]>) -> Configurations {
        triangles.iter_mut().for_each(|triangle| *triangle = normalised(*triangle));
        triangles.sort_by_key(|triangle| triangle[2] == FARAWAY);
        let finite = triangles.partition_point(|triangle| triangle[2] != FARAWAY);
        let offsets = vec![0, triangles.len() as u32];
        Configurations { degree: 0, claim, interiors: Vec::new(), offsets, boundaries: triangles, finite }
    }

    /// Sorts groups that were added in the sequence of `order` by their least knots. Domain: not degree 0.
    pub fn sort_groups(&mut self, order: &[u32]) {
        let mut firsts = vec![(0, 0); order.len()];
        let leasts = self.interiors.chunks_exact(self.degree).map(|interior| interior[0]);
        for (group, least) in (0u32..).zip(leasts) {
            let (first, count) = &mut firsts[least as usize];
            if *count == 0 {
                *first = group;
            }
            *count += 1;
        }
        let mut sorted = Configurations::empty(self.degree, self.claim);
        sorted.interiors.reserve_exact(self.interiors.len());
        sorted.offsets.reserve_exact(self.offsets.len());
        sorted.boundaries.reserve_exact(self.boundaries.len());
        for (first, count) in firsts {
            let (first, end) = (first as usize, first as usize + count);
            let start = self.offsets[first];
            let moved = sorted.boundaries.len() as u32;
            sorted.boundaries.extend_from_slice(&self.boundaries[start as usize..self.offsets[end] as usize]);
            sorted.interiors.extend_from_slice(&self.interiors[first * self.degree..end * self.degree]);
            sorted.offsets.extend(self.offsets[first + 1..=end].iter().map(|offset| offset - start + moved));
        }
        sorted.finite = self.finite;
        *self = sorted;
    }

    /// Makes the boundaries after the last group the group of `interior`, which must be greater than all
    /// interior sets before. Adds no group if there are no boundaries.
    pub fn close_group(&mut self, interior: &[u32]) {
        debug_assert_eq!(interior.len(), self.degree);
        let start = self.offsets[self.offsets.len() - 1] as usize;
        let group = &mut self.boundaries[start..];
        if group.is_empty() {
            return;
        }
        group.iter_mut().for_each(|triangle| *triangle = normalised(*triangle));
        group.sort_unstable_by_key(|&[a, b, c]| (c == FARAWAY, a, b, c));
        self.finite += group.iter().take_while(|triangle| triangle[2] != FARAWAY).count();
        self.interiors.extend_from_slice(interior);
        self.offsets.push(self.boundaries.len() as u32);
    }

    /// Appends boundaries to the group that the next call of [`Configurations::close_group`] ends.
    pub fn push(&mut self, boundaries: &[[u32; 3]]) {
        self.boundaries.extend_from_slice(boundaries);
    }

    /// Boundaries of all groups, concatenated.
    pub fn boundaries(&self) -> &[[u32; 3]] {
        &self.boundaries
    }

    /// The interior set of group `index`.
    pub fn interior(&self, index: usize) -> &[u32] {
        &self.interiors[index * self.degree..][..self.degree]
    }

    /// The number of the first boundary after group `index`.
    pub fn group_end(&self, index: usize) -> usize {
        self.offsets[index + 1] as usize
    }

    /// An empty list, to be filled with [`Configurations::extend`].
    pub fn new(degree: usize, claim: Claim) -> Configurations {
        Configurations::empty(degree, claim)
    }

    /// Appends configurations with one interior set; they join the last group if it has the same set.
    ///
    /// Domain: groups, and boundaries in a group, come in the order and the form that [`Configurations`]
    /// documents. Nothing is checked.
    ///
    /// # Errors
    /// Too many configurations.
    pub fn extend(&mut self, interior: &[u32], boundaries: &[[u32; 3]]) -> Result<()> {
        debug_assert_eq!(interior.len(), self.degree);
        let Ok(end) = u32::try_from(self.boundaries.len() + boundaries.len()) else {
            let message = "2^32 configurations of one degree or more cannot be held: use fewer knots";
            return Err(Error::new(ErrorKind::Memory, message));
        };
        let groups = self.group_count();
        if groups > 0 && self.interiors[(groups - 1) * self.degree..] == *interior {
            self.offsets[groups] = end;
        } else {
            self.interiors.extend_from_slice(interior);
            self.offsets.push(end);
        }
        self.finite += boundaries.iter().filter(|boundary| boundary[2] != FARAWAY).count();
        self.boundaries.extend_from_slice(boundaries);
        Ok(())
    }

    /// The claim; it follows from the way the configurations were made.
    pub fn claim(&self) -> Claim {
        self.claim
    }

    /// The degree k: the size of interior sets.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of configurations, without the infinite ones.
    pub fn len(&self) -> usize {
        self.finite
    }

    /// Whether there are no configurations but infinite ones.
    pub fn is_empty(&self) -> bool {
        self.finite == 0
    }

    /// Number of infinite configurations, that is, of directed lines through two knots with k knots to their
    /// left.
    pub fn infinite_len(&self) -> usize {
        self.boundaries.len() - self.finite
    }

    /// Number of interior sets that have a configuration, finite or infinite.
    pub fn group_count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Group `index` of the order of interior sets.
    pub fn group(&self, index: usize) -> Group<'_> {
        let all = &self.boundaries[self.offsets[index] as usize..self.offsets[index + 1] as usize];
        let (triangles, infinite) = all.split_at(all.partition_point(|triangle| triangle[2] != FARAWAY));
        Group { interior: &self.interiors[index * self.degree..][..self.degree], triangles, infinite }
    }

    /// All groups, in order.
    pub fn groups(&self) -> impl ExactSizeIterator<Item = Group<'_>> {
        (0..self.group_count()).map(|index| self.group(index))
    }

    /// All configurations (B, I), without the infinite ones.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; 3], &[u32])> {
        self.groups()
            .flat_map(|group| group.triangles.iter().map(move |&boundary| (boundary, group.interior)))
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.interiors.capacity() + self.offsets.capacity()) + 12 * self.boundaries.capacity()
    }
}

/// The same triangle with the least vertex first; an infinite triangle stays as it is.
fn normalised([a, b, c]: [u32; 3]) -> [u32; 3] {
    if c == FARAWAY {
        return [a, b, c];
    }
    if a == FARAWAY || (b != FARAWAY && b < a && b < c) {
        return [b, c, a];
    }
    if b == FARAWAY || (c < a && c < b) {
        return [c, a, b];
    }
    [a, b, c]
}

/// The links of all sets of one size k (k-sets): the closed polygons around these sets that configurations of
/// degree k - 1 leave and configurations of degree k triangulate.
///
/// Sorted by set. Shape: 4 bytes per vertex, 4 (k + 1) per set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Links {
    size: usize,
    sets: Vec<u32>,
    offsets: Vec<u32>,
    vertices: Vec<u32>,
}

/// The link of a set of knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Link<'a> {
    /// The set, sorted.
    pub set: &'a [u32],
    /// The polygon, counterclockwise, the least vertex first; [`FARAWAY`] is a vertex where the set is on the
    /// border of all knots. The edges go from each vertex to the next, and from the last to the first.
    pub polygon: &'a [u32],
}

impl Link<'_> {
    /// Whether the link bounds a null polygon: two edges, back and forth.
    pub fn is_null(&self) -> bool {
        self.polygon.len() == 2
    }

    /// Whether the link goes through the faraway point, where B-splines are not defined.
    pub fn is_infinite(&self) -> bool {
        self.polygon.contains(&FARAWAY)
    }

    /// The directed edges.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let ends = self.polygon.iter().cycle().skip(1);
        self.polygon.iter().zip(ends).map(|(&a, &b)| [a, b])
    }
}

impl Links {
    /// An empty list for links of sets of this size.
    pub fn new(size: usize) -> Links {
        Links { size, sets: Vec::new(), offsets: vec![0], vertices: Vec::new() }
    }

    /// Appends the link of a sorted set, which must be greater than all sets before.
    pub fn push(&mut self, set: &[u32], polygon: &[u32]) {
        debug_assert_eq!(set.len(), self.size);
        self.sets.extend_from_slice(set);
        self.vertices.extend_from_slice(polygon);
        self.offsets.push(self.vertices.len() as u32);
    }

    /// Size of the sets: one more than the degree of the configurations.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Number of links.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no link.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Link `index` in the order of sets.
    pub fn link(&self, index: usize) -> Link<'_> {
        Link {
            set: &self.sets[index * self.size..][..self.size],
            polygon: &self.vertices[self.offsets[index] as usize..self.offsets[index + 1] as usize],
        }
    }

    /// All links, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Link<'_>> {
        (0..self.len()).map(|index| self.link(index))
    }

    /// Index of the link of a sorted set. Cost: a binary search.
    pub fn find(&self, set: &[u32]) -> Option<usize> {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low.midpoint(high);
            match self.link(middle).set.cmp(set) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
                std::cmp::Ordering::Equal => return Some(middle),
            }
        }
        None
    }
}
