//! Facet matching between the configurations of two degrees.

use super::{Configurations, FARAWAY};
use spmesh_base::error::{Error, ErrorKind, Result};

/// Facets (F, J) by the three cases of proposition 6.2.1; the number of edge configurations is their sum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FacetCounts {
    /// Two configurations of the lower degree, on opposite sides: the links of null polygons among others.
    pub both_lower: usize,
    /// One of each degree, on the same side: the edges of links.
    pub one_each: usize,
    /// Two of the higher degree, on opposite sides: diagonals.
    pub both_upper: usize,
}

/// The facets (F, J) of degree k + 1 that configurations of degrees k and k + 1 have. Each is one row: J
/// sorted, F sorted, whether the facet is from the higher degree, and whether it runs from the lesser to the
/// greater end.
struct Rows {
    width: usize,
    words: Vec<u32>,
}

/// Checks that every facet of `lower` and `upper`, of degrees k and k + 1, has exactly two configurations, in
/// one of the three ways of proposition 6.2.1. Facets with the faraway point count like others.
///
/// Cost: a sort of 3 (c_k + c_(k+1)) rows of k + 4 words, held in memory.
///
/// # Errors
/// Degrees that are not consecutive; the first facet that violates it (kind [`ErrorKind::Audit`]).
pub fn check_facets(lower: &Configurations, upper: &Configurations) -> Result<FacetCounts> {
    if upper.degree() != lower.degree() + 1 {
        let (low, high) = (lower.degree(), upper.degree());
        return Err(Error::usage(format!("facets are shared by degrees k and k + 1, not {low} and {high}")));
    }
    let mut rows = Rows { width: upper.degree() + 3, words: Vec::new() };
    for group in lower.groups() {
        for &[a, b, c] in group.boundaries {
            for [v, p, q] in [[a, b, c], [b, c, a], [c, a, b]] {
                if v != FARAWAY {
                    rows.push(group.interior, Some(v), [p, q], 0)?;
                }
            }
        }
    }
    rows.push_upper(upper)?;
    rows.count()
}

/// Checks the facets of degree 0 alone: every edge has a triangle on each side.
///
/// # Errors
/// If the degree is not 0; the first edge that violates it (kind [`ErrorKind::Audit`]).
pub fn check_start(start: &Configurations) -> Result<FacetCounts> {
    if start.degree() != 0 {
        return Err(Error::usage(format!("degree {} is not that of a triangulation", start.degree())));
    }
    let mut rows = Rows { width: 3, words: Vec::new() };
    rows.push_upper(start)?;
    rows.count()
}

impl Rows {
    fn push_upper(&mut self, upper: &Configurations) -> Result<()> {
        for group in upper.groups() {
            for &[a, b, c] in group.boundaries {
                for edge in [[a, b], [b, c], [c, a]] {
                    self.push(group.interior, None, edge, 2)?;
                }
            }
        }
        Ok(())
    }

    fn push(&mut self, interior: &[u32], also: Option<u32>, [p, q]: [u32; 2], from_upper: u32) -> Result<()> {
        let start = self.words.len();
        self.words.extend_from_slice(interior);
        self.words.extend(also);
        self.words[start..].sort_unstable();
        let set = &self.words[start..];
        if set.windows(2).any(|pair| pair[0] == pair[1]) || set.contains(&p) || set.contains(&q) || p == q {
            let what = format!("a configuration repeats a knot: boundary edge {p}-{q}, others {set:?}");
            return Err(Error::new(ErrorKind::Audit, what));
        }
        self.words.extend([p.min(q), p.max(q), from_upper + u32::from(p < q)]);
        Ok(())
    }

    fn count(&self) -> Result<FacetCounts> {
        let row = |at: usize| &self.words[at * self.width..][..self.width];
        let facet = |at: usize| &row(at)[..self.width - 1];
        let mut order: Vec<usize> = (0..self.words.len() / self.width).collect();
        order.sort_unstable_by_key(|&at| row(at));
        let mut counts = FacetCounts::default();
        for pair in order.chunk_by(|&a, &b| facet(a) == facet(b)) {
            let kinds: Vec<u32> = pair.iter().map(|&at| row(at)[self.width - 1]).collect();
            match kinds[..] {
                [0, 1] => counts.both_lower += 1,
                [0, 2] | [1, 3] => counts.one_each += 1,
                [2, 3] => counts.both_upper += 1,
                _ => return Err(violation(facet(pair[0]), &kinds)),
            }
        }
        Ok(counts)
    }
}

fn violation(facet: &[u32], kinds: &[u32]) -> Error {
    let (interior, edge) = facet.split_at(facet.len() - 2);
    let name = |v: u32| if v == FARAWAY { "infinity".to_string() } else { v.to_string() };
    let of = |kind: &u32| {
        let degree = if kind & 2 == 0 { "lower" } else { "higher" };
        let (from, to) = if kind & 1 == 1 { (edge[0], edge[1]) } else { (edge[1], edge[0]) };
        format!("{degree} degree from {} to {}", name(from), name(to))
    };
    let found: Vec<String> = kinds.iter().map(of).collect();
    let what = format!("not two configurations as proposition 6.2.1 has them, but: {}", found.join(", "));
    let at = format!("facet {}-{} with interior {interior:?}", name(edge[0]), name(edge[1]));
    Error::new(ErrorKind::Audit, what).at(at)
}
