//! Triangulates one link: infinite triangles first, then each bounded pocket by the rule. Required diagonals
//! cut it into pieces before.

use super::gathering::position;
use super::knots::Knots;
use super::plane::Plane;
use super::rule::Rule;
use super::special::Diagonals;
use super::start_check;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::LINK_VERTICES_MAX;
use spmesh_delaunay::predicates::{Predicates2, Sign};
use spmesh_stream::model::configurations::{Claim, FARAWAY};

/// Triangulates links; its buffers are reused.
pub(super) struct Triangulator<'a, P> {
    pub(super) plane: Plane<'a, P>,
    pub(super) rule: &'a Rule,
    /// Diagonals that links must have, whatever the rule.
    diagonals: &'a Diagonals,
    /// Whether the same lift made all degrees: then all diagonals are free.
    pub(super) is_regular: bool,
    /// The set that the link belongs to.
    pub(super) set: Vec<u32>,
    pub(super) polygon: Vec<u32>,
    /// For each pair of vertices, whether they see each other; `None` if unknown.
    pub(super) sight: Vec<Option<bool>>,
    pub(super) stack: Vec<(usize, usize)>,
    pub(super) out: Vec<[u32; 3]>,
}

impl<'a, P: Predicates2> Triangulator<'a, P> {
    pub(super) fn new(
        knots: &'a Knots,
        (rule, diagonals): (&'a Rule, &'a Diagonals),
        claim: Claim,
        predicates: &'a mut P,
    ) -> Self {
        let lift = if let Rule::Lifted(lift) = rule { Some(lift) } else { None };
        Triangulator {
            plane: Plane::new(knots, lift, predicates),
            rule,
            diagonals,
            is_regular: claim != Claim::Any,
            set: Vec::new(),
            polygon: Vec::new(),
            sight: Vec::new(),
            stack: Vec::new(),
            out: Vec::new(),
        }
    }

    /// Triangulates a link into `out`, which stays empty if the link is null.
    pub(super) fn triangulate(&mut self, set: &[u32], link: &[u32]) -> Result<()> {
        self.out.clear();
        if link.len() == 2 {
            return Ok(());
        }
        self.set.clear();
        self.set.extend_from_slice(set);
        match link.iter().position(|&v| v == FARAWAY) {
            None => {
                self.polygon.clear();
                self.polygon.extend_from_slice(link);
                self.require_simple(true)?;
                self.bounded()?;
            }
            Some(at) => {
                let mut chain: Vec<u32> = link[at + 1..].to_vec();
                chain.extend_from_slice(&link[..at]);
                self.unbounded(&chain)?;
            }
        }
        if self.out.len() != link.len() - 2 {
            return Err(self.failure("its triangulation has a wrong number of triangles"));
        }
        Ok(())
    }

    /// Triangulates a link through the faraway point; `chain` is the link without it.
    ///
    /// The hull of the other knots has a border path from the start to the end of the chain, with the set to
    /// its left. The edges of the path make the infinite triangles, whatever the rule: these are half-planes,
    /// which need no lift. Pockets lie between the path and the chain.
    fn unbounded(&mut self, chain: &[u32]) -> Result<()> {
        self.polygon.clear();
        self.polygon.extend_from_slice(chain);
        self.require_simple(false)?;
        let path = self.hull_path(chain)?;
        let mut start = 0;
        for pair in path.windows(2) {
            let [p, q] = [pair[0], pair[1]];
            let Some(end) = chain[start..].iter().position(|&v| v == q).map(|ahead| start + ahead) else {
                return Err(self.failure("it goes around knots that it should not"));
            };
            self.out.push([p, q, FARAWAY]);
            if end > start + 1 {
                self.polygon.clear();
                self.polygon.extend_from_slice(&chain[start..=end]);
                self.bounded()?;
            }
            start = end;
        }
        Ok(())
    }

    /// The border of the convex hull of a chain, clockwise from its first to its last vertex, including all
    /// knots on it.
    fn hull_path(&mut self, chain: &[u32]) -> Result<Vec<u32>> {
        if chain.len() == 2 {
            return Ok(chain.to_vec());
        }
        let mut sorted = chain.to_vec();
        sorted.sort_unstable_by(|&a, &b| self.plane.knots.order(a, b));
        let mut hull: Vec<u32> = Vec::with_capacity(2 * chain.len());
        let backwards: Vec<u32> = sorted.iter().rev().copied().collect();
        for half in [&sorted, &backwards] {
            let base = hull.len();
            for &v in half {
                while let [.., a, b] = hull[base..] {
                    if !self.plane.is_left(a, b, v) {
                        break;
                    }
                    hull.pop();
                }
                hull.push(v);
            }
            hull.pop();
        }
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        let mut path: Vec<u32> = Vec::new();
        if let Some(at) = hull.iter().position(|&v| v == first) {
            for &v in hull[at..].iter().chain(&hull[..at]) {
                path.push(v);
                if v == last {
                    return Ok(path);
                }
            }
        }
        Err(self.failure("it does not end on the border of the knots around it"))
    }

    /// Triangulates the polygon, by the rule.
    fn bounded(&mut self) -> Result<()> {
        let diagonals: Vec<[u32; 2]> = self.diagonals.of(&self.set).collect();
        if !diagonals.is_empty() {
            return self.by_diagonals(diagonals);
        }
        let count = self.polygon.len();
        if count == 3 {
            return self.emit(0, 1, 2);
        }
        if self.fan_from_copy() {
            return Ok(());
        }
        let by_circle = matches!(self.rule, Rule::Delaunay | Rule::Lifted(_)) && self.is_regular;
        if !by_circle && count > LINK_VERTICES_MAX {
            let message = format!(
                "it has {count} vertices; rules other than that of the start take at most {LINK_VERTICES_MAX}: use `delaunay`"
            );
            return Err(Error::usage(message).at(position(&self.set)));
        }
        self.sight.clear();
        if !by_circle {
            self.sight.resize(count * count, None);
        }
        self.by_rule()
    }

    /// Outputs the triangle of three places of the polygon.
    pub(super) fn emit(&mut self, i: usize, j: usize, k: usize) -> Result<()> {
        let [a, b, c] = [i, j, k].map(|place| self.polygon[place]);
        if !self.plane.is_left(a, b, c) {
            return Err(self.failure("a triangle in it is flat or clockwise"));
        }
        self.out.push([a, b, c]);
        Ok(())
    }

    /// If a link of a single knot contains another knot at the same place, triangulates it by diagonals from
    /// that knot (thesis, figure 8.7), whatever the rule. Returns whether that was possible. Delaunay
    /// configurations have these diagonals anyway, except for ties.
    fn fan_from_copy(&mut self) -> bool {
        let &[v] = &self.set[..] else { return false };
        if self.is_regular || !self.plane.knots.has_copies() {
            return false;
        }
        let at = self.plane.knots.at(v);
        let mut copies = (0..self.polygon.len()).filter(|&i| self.plane.knots.at(self.polygon[i]) == at);
        let (Some(copy), None) = (copies.next(), copies.next()) else { return false };
        let count = self.polygon.len();
        let triangles =
            (1..count - 1).map(|i| [copy, copy + i, copy + i + 1].map(|place| self.polygon[place % count]));
        let triangles: Vec<[u32; 3]> = triangles.collect();
        if !triangles.iter().all(|&[a, b, c]| self.plane.is_left(a, b, c)) {
            return false;
        }
        self.out.extend(triangles);
        true
    }

    /// Whether the diagonal between two places lies inside the polygon, or is an edge.
    pub(super) fn sees(&mut self, i: usize, j: usize) -> bool {
        let count = self.polygon.len();
        let (i, j) = (i.min(j), i.max(j));
        if j == i + 1 || (i == 0 && j == count - 1) {
            return true;
        }
        if let Some(known) = self.sight[i * count + j] {
            return known;
        }
        let sees = self.is_in_cone(i, j) && self.is_free(i, j);
        self.sight[i * count + j] = Some(sees);
        sees
    }

    /// Whether the direction from place `i` to place `j` is inside the polygon near `i`.
    fn is_in_cone(&mut self, i: usize, j: usize) -> bool {
        let count = self.polygon.len();
        let [at, to, before, after] =
            [i, j, (i + count - 1) % count, (i + 1) % count].map(|p| self.polygon[p]);
        if self.plane.orient(before, at, after) == Sign::Positive {
            return self.plane.is_left(at, to, before) && self.plane.is_left(to, at, after);
        }
        let outside = self.plane.orient(at, to, after) != Sign::Negative
            && self.plane.orient(to, at, before) != Sign::Negative;
        !outside
    }

    /// Whether no edge meets the diagonal except at its ends.
    fn is_free(&mut self, i: usize, j: usize) -> bool {
        let count = self.polygon.len();
        let diagonal = [i, j].map(|place| self.polygon[place]);
        (0..count).all(|place| {
            let next = (place + 1) % count;
            if [place, next].iter().any(|&end| end == i || end == j) {
                return true;
            }
            let edge = [place, next].map(|place| self.polygon[place]);
            !self.plane.do_meet(diagonal, edge)
        })
    }

    /// Asserts thesis 7.4: a polygon, or an open chain, is simple. Links of single knots need no test: in a
    /// triangulation they are star-shaped.
    fn require_simple(&mut self, is_closed: bool) -> Result<()> {
        if self.set.len() == 1 {
            return Ok(());
        }
        match start_check::crossing(&mut self.plane, &self.polygon, is_closed) {
            None => Ok(()),
            Some([[a, b], [c, d]]) => {
                Err(self.failure(&format!("it is not simple: edges {a}-{b} and {c}-{d} meet")))
            }
        }
    }

    #[cold]
    pub(super) fn failure(&self, what: &str) -> Error {
        Error::new(ErrorKind::Audit, what).at(position(&self.set))
    }
}

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates the polygon such that the given diagonals are edges.
    pub(super) fn by_diagonals(&mut self, diagonals: Vec<[u32; 2]>) -> Result<()> {
        let mut pieces = vec![self.polygon.clone()];
        for [p, q] in diagonals {
            let place = |piece: &[u32], v| piece.iter().position(|&other| other == v);
            let holds = |piece: &Vec<u32>| place(piece, p).is_some() && place(piece, q).is_some();
            let Some(mut piece) = pieces.iter().position(holds).map(|at| pieces.swap_remove(at)) else {
                return Err(self.no_diagonal([p, q]));
            };
            let start = place(&piece, p).unwrap_or(0);
            piece.rotate_left(start);
            let end = place(&piece, q).unwrap_or(0);
            self.take(&piece);
            if end < 2 || end + 1 >= piece.len() || !self.sees(0, end) {
                return Err(self.no_diagonal([p, q]));
            }
            pieces.push(piece[..=end].to_vec());
            pieces.push([&piece[end..], &piece[..1]].concat());
        }
        for piece in pieces {
            self.take(&piece);
            if piece.len() == 3 { self.emit(0, 1, 2)? } else { self.by_rule()? }
        }
        Ok(())
    }

    /// Makes a piece the polygon.
    fn take(&mut self, piece: &[u32]) {
        self.polygon.clear();
        self.polygon.extend_from_slice(piece);
        self.sight.clear();
        self.sight.resize(piece.len() * piece.len(), None);
    }

    #[cold]
    fn no_diagonal(&self, [p, q]: [u32; 2]) -> Error {
        self.failure(&format!("the edge from {p} to {q} that it should have is no diagonal of it"))
    }
}
