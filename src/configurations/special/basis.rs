//! Collects B-splines of degree 2 into functions (thesis 8.2.5 and 8.3.1).

use crate::knots::Knots;
use foldhash::{HashMap, HashSet};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_stream::model::configurations::{FARAWAY, Link, Links};
use spmesh_stream::model::functions::{Function, FunctionKind};
use std::collections::BTreeMap;

/// The special functions that B-splines are collected into.
#[derive(Debug, Clone, Default)]
pub(super) struct Collection {
    /// Faces with a box spline.
    pub(super) faces: Vec<[u32; 4]>,
    /// Creases with smooth ends: the two ends, and the knot between them.
    pub(super) creases: Vec<[u32; 3]>,
    /// Linear elements, by the first knots at their ends, with the lesser one first.
    pub(super) lines: HashSet<[u32; 2]>,
}

/// Knots by place.
struct Places {
    firsts: Vec<u32>,
    /// For each first knot of a place, whether the place has further knots.
    is_apart: Vec<bool>,
}

impl Places {
    fn of(knots: &Knots) -> Places {
        let firsts = distinct(knots.points());
        let mut is_apart = vec![false; firsts.len()];
        for (id, &first) in (0..).zip(&firsts) {
            is_apart[first as usize] |= id != first;
        }
        Places { firsts, is_apart }
    }

    /// The function that collects the B-spline of two knots because of coinciding knots, if any.
    fn kind(&self, [p, q]: [u32; 2]) -> Option<FunctionKind> {
        let [p, q] = [p, q].map(|id| self.firsts[id as usize]);
        if p == q {
            return Some(FunctionKind::Vertex(p));
        }
        let is_tent = self.is_apart[p as usize] || self.is_apart[q as usize];
        is_tent.then_some(FunctionKind::Tent([p.min(q), p.max(q)]))
    }

    /// Whether the B-spline of a link is zero everywhere. Infinite configurations and those whose knots are
    /// on one line add nothing to it, as on a straight border with clamped corners. Of the other
    /// configurations, the edges of the link cancel as directed edges between places, as for links of copies.
    fn is_zero(&self, knots: &Knots, link: &Link) -> bool {
        let finite = link.edges().filter(|edge| !edge.contains(&FARAWAY));
        let with_area = finite.filter(|&[a, b]| !knots.are_collinear(&[link.set, &[a, b]].concat()));
        let at_places = with_area.map(|edge| edge.map(|id| self.firsts[id as usize]));
        let mut edges: Vec<[u32; 2]> = at_places.filter(|[a, b]| a != b).collect();
        while let Some([a, b]) = edges.pop() {
            match edges.iter().position(|&edge| edge == [b, a]) {
                Some(back) => drop(edges.swap_remove(back)),
                None => return false,
            }
        }
        true
    }
}

impl Collection {
    pub(super) fn functions(&self, knots: &Knots, links: &Links) -> Result<Vec<Function>> {
        if links.size() != 2 {
            let what = format!("sets of {} knots: quadratic splines need links of pairs", links.size());
            return Err(Error::usage(what));
        }
        let places = Places::of(knots);
        let special = self.by_edge();
        let mut terms: BTreeMap<FunctionKind, Vec<([u32; 2], f64)>> = BTreeMap::new();
        for link in links.iter().filter(|link| !places.is_zero(knots, link)) {
            let edge = [link.set[0], link.set[1]];
            let mut add = |kind, share| terms.entry(kind).or_default().push((edge, share));
            if let Some(kind) = places.kind(edge) {
                self.shares_of(kind).into_iter().for_each(|(kind, share)| add(kind, share));
                continue;
            }
            match special.get(&edge).map(Vec::as_slice) {
                None | Some([]) => add(FunctionKind::Edge(edge), 1.0),
                Some(&[crease @ FunctionKind::Crease(_)]) => add(crease, 1.0),
                Some(&[face]) => [face, FunctionKind::Edge(edge)].into_iter().for_each(|kind| add(kind, 0.5)),
                Some(faces) => faces.iter().for_each(|&face| add(face, 0.5)),
            }
        }
        Ok(terms.into_iter().map(|(kind, terms)| Function { kind, terms }).collect())
    }

    /// The functions that share a function: half of a linear element's tent goes to each end (scenario 3).
    fn shares_of(&self, kind: FunctionKind) -> Vec<(FunctionKind, f64)> {
        match kind {
            FunctionKind::Tent(ends) if self.lines.contains(&ends) => {
                ends.map(|end| (FunctionKind::Vertex(end), 0.5)).to_vec()
            }
            _ => vec![(kind, 1.0)],
        }
    }

    /// Creases and faces by the edges whose B-splines they collect.
    fn by_edge(&self) -> HashMap<[u32; 2], Vec<FunctionKind>> {
        let mut special: HashMap<[u32; 2], Vec<FunctionKind>> = HashMap::default();
        let mut add = |[p, q]: [u32; 2], kind| special.entry([p.min(q), p.max(q)]).or_default().push(kind);
        for &crease in &self.creases {
            let [u, v, middle] = crease;
            [u, v].into_iter().for_each(|end| add([end, middle], FunctionKind::Crease(crease)));
        }
        for &face in &self.faces {
            (0..4).for_each(|i| add([face[i], face[(i + 1) % 4]], FunctionKind::Face(face)));
        }
        special
    }
}
