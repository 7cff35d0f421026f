//! Sharp corners, creases and linear elements of splines that are smooth elsewhere (thesis 8.3.1).

use super::Special;
use super::basis::Collection;
use super::constrained::{Constrained, segment, through};
use crate::knots::Knots;
use crate::special::constrained::Diagonals;
use crate::surface::Start;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::FiniteFloatPredicates;

/// A polyline of knots along which splines have a crease.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crease {
    /// Ids of at least two knots along the crease.
    pub knots: Vec<u32>,
    /// Whether the crease is sharp up to its ends. If so, all its knots are pulled apart, and splines
    /// interpolate there. Otherwise each edge has a further knot in its middle, and no knot is pulled apart.
    pub has_sharp_ends: bool,
}

/// Sharp features, by ids of knots.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Features {
    /// Sharp corners (scenario 1): splines interpolate there.
    pub corners: Vec<u32>,
    /// Creases (scenario 2).
    pub creases: Vec<Crease>,
    /// Linear elements (scenario 3): splines interpolate values along these polylines linearly. A closed
    /// polyline without knots inside makes a linear triangle if it has three edges, or a polygon.
    pub lines: Vec<Vec<u32>>,
}

/// Configurations for features: knots of sharp features are pulled apart, and segments are edges.
///
/// All functions sum to one, so one of them alone cannot be sharp. At a crease with smooth ends, the
/// B-splines of the middle knot with the knots opposite to the edge are sharp, too, and the sum of all three
/// functions is smooth. (The thesis has one sharp function.)
///
/// Copies are numbered after the given knots. After the copies follows one knot for each edge of creases with
/// smooth ends, in their order: the middle of the edge, as exactly as f64 allows. Its link has the edge
/// itself as a diagonal.
///
/// Unknown knots; polylines of fewer than two knots; segments that cross, have other knots on them, or have
/// no length; creases with smooth ends at knots that are pulled apart, or on the border. The error names the
/// polyline and the segment.
pub fn features(knots: &Knots, features: &Features) -> Result<Special> {
    features.check(knots)?;
    let apart = knots.pull_apart(&features.sharp_knots())?;
    let firsts = distinct(apart.points());
    let mut predicates = FiniteFloatPredicates::default();
    let mut mesh = Constrained::new(&apart, Start::delaunay(&apart)?, &mut predicates);
    fix_copies(&mut mesh, &firsts)?;
    for (what, polyline) in features.polylines() {
        for edge in polyline.windows(2) {
            fix(&mut mesh, &firsts, [edge[0], edge[1]].map(|id| firsts[id as usize]))
                .map_err(|e| e.of_input(&what))?;
        }
    }
    let start = mesh.into_start();
    let mut collection = Collection::default();
    for edge in features.lines.iter().flat_map(|line| line.windows(2)) {
        let [p, q] = [edge[0], edge[1]].map(|id| firsts[id as usize]);
        collection.lines.insert([p.min(q), p.max(q)]);
    }
    smooth_creases(features, apart, start, collection)
}

impl Features {
    /// All polylines with their names.
    fn polylines(&self) -> impl Iterator<Item = (String, &[u32])> {
        let creases = self.creases.iter().map(|crease| &crease.knots[..]).enumerate();
        let creases = creases.map(|(number, knots)| (format!("crease {number}"), knots));
        let lines = self.lines.iter().enumerate();
        creases.chain(lines.map(|(number, knots)| (format!("linear element {number}"), &knots[..])))
    }

    fn check(&self, knots: &Knots) -> Result<()> {
        let corners = std::iter::once(("corners".to_string(), &self.corners[..]));
        for (what, polyline) in corners.chain(self.polylines()) {
            if let Some(unknown) = polyline.iter().find(|&&id| id as usize >= knots.len()) {
                let found = format!("unknown knot {unknown}: there are {}", knots.len());
                return Err(Error::usage(found).of_input(what));
            }
        }
        for (what, polyline) in self.polylines() {
            if polyline.len() < 2 {
                let found = format!("{} knots: a polyline needs two at least", polyline.len());
                return Err(Error::usage(found).of_input(what));
            }
            let is_point = |edge: &&[u32]| knots.at(edge[0]) == knots.at(edge[1]);
            if let Some(edge) = polyline.windows(2).find(is_point) {
                let error = Error::usage("it has no length: both knots are at one place");
                return Err(error.at(segment([edge[0], edge[1]])).of_input(what));
            }
        }
        Ok(())
    }

    /// The knots that are pulled apart.
    fn sharp_knots(&self) -> Vec<u32> {
        let sharp = self.creases.iter().filter(|crease| crease.has_sharp_ends).map(|crease| &crease.knots);
        [&self.corners].into_iter().chain(sharp).chain(&self.lines).flatten().copied().collect()
    }
}

/// Fixes the edge between the first two knots at each place.
fn fix_copies(mesh: &mut Constrained, firsts: &[u32]) -> Result<()> {
    let mut has_second = vec![false; firsts.len()];
    for (id, &first) in (0..).zip(firsts).filter(|&(id, &first)| id != first) {
        if !std::mem::replace(&mut has_second[first as usize], true) {
            mesh.fix(first, id)?;
        }
    }
    Ok(())
}

/// Fixes a segment, and checks that no knots are between its ends except copies of them.
fn fix(mesh: &mut Constrained, firsts: &[u32], ends: [u32; 2]) -> Result<()> {
    let path = mesh.fix(ends[0], ends[1])?;
    match path.iter().map(|&knot| firsts[knot as usize]).find(|knot| !ends.contains(knot)) {
        Some(between) => Err(through(ends, between)),
        None => Ok(()),
    }
}

/// Adds a knot in each edge of creases with smooth ends.
fn smooth_creases(
    features: &Features,
    apart: Knots,
    start: Start,
    mut collection: Collection,
) -> Result<Special> {
    let smooth = features.creases.iter().enumerate().filter(|(_, crease)| !crease.has_sharp_ends);
    let mut edges: Vec<(usize, [u32; 2])> = smooth
        .flat_map(|(at, crease)| crease.knots.windows(2).map(move |edge| (at, [edge[0], edge[1]])))
        .collect();
    let unordered = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut seen = foldhash::HashSet::default();
    edges.retain(|&(_, edge)| seen.insert(unordered(edge)));
    let mut points = apart.points().to_vec();
    points.extend(edges.iter().map(|&(_, edge)| middle(edge.map(|id| apart.at(id)))));
    let firsts = distinct(apart.points());
    let mut is_apart = vec![false; firsts.len()];
    (0..).zip(&firsts).filter(|&(id, &first)| id != first).for_each(|(id, &first)| {
        is_apart[first as usize] = true;
        is_apart[id as usize] = true;
    });
    let first_middle = apart.len() as u32;
    let knots = Knots::new(points)?.displaced(apart.displacement());
    let mut predicates = FiniteFloatPredicates::default();
    let mut mesh = Constrained::new(&knots, start, &mut predicates);
    let mut rows = Vec::new();
    for (middle, &(at, edge)) in (first_middle..).zip(&edges) {
        let name = |error: Error| error.of_input(format!("crease {at}"));
        if let Some(end) = edge.iter().find(|&&end| is_apart[end as usize]) {
            let what = format!("knot {end} is pulled apart: a crease that ends there must have sharp ends");
            return Err(name(Error::usage(what).at(segment(edge))));
        }
        if knots.rank(middle) > 0 {
            let what = "a knot is at its middle, as far as numbers can tell: leave one of them out";
            return Err(name(Error::usage(what).at(segment(edge))));
        }
        mesh.split(edge, middle).map_err(name)?;
        rows.push((middle, edge));
        collection.creases.push([edge[0], edge[1], middle]);
    }
    let start = mesh.into_start();
    Ok(Special { knots, start, diagonals: Diagonals::new(rows), collection })
}

fn middle([p, q]: [[f64; 2]; 2]) -> [f64; 2] {
    [0, 1].map(|axis| p[axis].midpoint(q[axis]))
}
