//! Simplicial complexes that claim to be Delaunay: the same proof, but ties between cospherical points may be
//! resolved in any way.

use std::cmp::Ordering;

use super::Proof;
use super::covering::Covering;
use super::faces::without;
use super::form::{Distinct, check_euler, check_finite, check_vertices};
use super::sites::Sites;
use super::space::{Facet, Roundness, Separation, Sphere};
use super::violation::{Claim, Violation};
use spmesh_stream::model::cells4::Point4;

/// Proves that simplices tile the convex hull of points, all of which are vertices, and that their spheres
/// are empty.
///
/// A simplex `a`, `b`, `c`, `d`, `e` is positive if det(b - a, c - a, d - a, e - a) is. Ties are allowed:
/// points may be on the spheres of simplices that do not have them. The proof is the proof for diagrams (see
/// the module), where "strictly convex" becomes "convex".
///
/// Domain: any points and simplices, however wrong. If all points lie in a hyperplane there are no simplices.
///
/// Cost: as for diagrams, and a sort of the facets.
///
/// Memory: 100 bytes per simplex, and as for diagrams.
///
/// # Errors
/// The first violation that was met.
pub fn check_simplices(points: &[Point4], simplices: &[[u32; 5]]) -> Result<Proof, Violation> {
    check_finite(points)?;
    check_distinct(points)?;
    let mut audit =
        SimplicesAudit { points, simplices, sites: Sites::new(points), covering: Covering::default() };
    if simplices.is_empty() {
        Covering::check_flat(&mut audit.sites, points)?;
        return Ok(Proof { vertices: points.len(), questions: audit.sites.asked, ..Proof::default() });
    }
    audit.check_numbers()?;
    check_vertices(points, simplices.iter().map(<[u32; 5]>::as_slice))?;
    audit.check_orientation()?;
    let middle = simplices.len() / 2;
    audit.covering = Covering::new(simplices.len(), &mut audit.sites, points, &simplices[middle], middle)?;
    let facets = audit.check_facets()?;
    audit.covering.check(points, |number| &simplices[number])?;
    let [edges, polygons] = audit.count();
    let proof = Proof {
        vertices: points.len(),
        edges,
        polygons,
        facets: facets.inner + facets.boundary,
        cells: simplices.len(),
        infinite: facets.boundary,
        simplices: simplices.len(),
        largest: 5,
        questions: audit.sites.asked,
        exactly: audit.sites.exactly,
    };
    check_euler(&proof)?;
    Ok(proof)
}

fn check_distinct(points: &[Point4]) -> Result<(), Violation> {
    let mut order: Vec<u32> = (0..).take(points.len()).collect();
    let at = |number: &u32| points[*number as usize];
    order.sort_unstable_by(|p, q| at(p).partial_cmp(&at(q)).unwrap_or(Ordering::Equal));
    match order.windows(2).find(|pair| at(&pair[0]) == at(&pair[1])) {
        Some(pair) => {
            let message = format!("points {} and {} coincide", pair[0], pair[1]);
            Err(Violation::new(Claim::Points, message).at(points, pair))
        }
        None => Ok(()),
    }
}

struct SimplicesAudit<'a> {
    points: &'a [Point4],
    simplices: &'a [[u32; 5]],
    sites: Sites<'a>,
    covering: Covering,
}

struct FacetCounts {
    inner: usize,
    boundary: usize,
}

/// Vertices of a facet, increasing, and the simplex that has it.
type Side = ([u32; 4], u32);

impl SimplicesAudit<'_> {
    fn check_numbers(&self) -> Result<(), Violation> {
        if u32::try_from(self.simplices.len()).is_err() {
            return Err(Violation::new(Claim::Cells, "more simplices than 32 bits number"));
        }
        for (number, simplex) in self.simplices.iter().enumerate() {
            if let Some(vertex) = simplex.iter().find(|&&vertex| vertex as usize >= self.points.len()) {
                let message = format!("simplex {number} has the vertex {vertex}, of {}", self.points.len());
                return Err(self.violation(Claim::Cells, message, &[number]));
            }
        }
        Ok(())
    }

    fn check_orientation(&mut self) -> Result<(), Violation> {
        for (number, simplex) in self.simplices.iter().enumerate() {
            let fault = match self.sites.ask(simplex, &Sphere { own: 4 }) {
                Roundness::Round { turn: Ordering::Greater, .. } => continue,
                Roundness::Round { .. } => "is negative",
                _ => "is flat",
            };
            return Err(self.violation(Claim::Cells, format!("simplex {number} {fault}"), &[number]));
        }
        Ok(())
    }

    /// Checks that every facet belongs to two simplices and is locally Delaunay, or is on the boundary.
    /// Checks that the boundary is convex.
    fn check_facets(&mut self) -> Result<FacetCounts, Violation> {
        let mut sides: Vec<Side> = Vec::with_capacity(5 * self.simplices.len());
        for (number, simplex) in (0..).zip(self.simplices) {
            let mut vertices = *simplex;
            vertices.sort_unstable();
            sides.extend((0..5).map(|left| {
                let [p, q, r, s] = [0, 1, 2, 3].map(|i| vertices[if i < left { i } else { i + 1 }]);
                ([p, q, r, s], number)
            }));
        }
        sides.sort_unstable();
        let mut boundary: Vec<Side> = Vec::new();
        let mut inner = 0;
        for facet in sides.chunk_by(|one, other| one.0 == other.0) {
            match facet {
                [] => (),
                [one] => boundary.push(*one),
                [(facet, one), (_, other)] => {
                    self.check_inner(facet, *one as usize, *other as usize)?;
                    inner += 1;
                }
                [(facet, one), (_, other), (_, third), ..] => {
                    let message =
                        format!("facet {facet:?} belongs to the simplices {one}, {other} and {third}");
                    let cells = [*one, *other, *third].map(|number| number as usize);
                    return Err(self.violation(Claim::Facets, message, &cells));
                }
            }
        }
        drop(sides);
        self.check_boundary(&boundary)?;
        Ok(FacetCounts { inner, boundary: boundary.len() })
    }

    fn check_inner(&mut self, facet: &[u32; 4], one: usize, other: usize) -> Result<(), Violation> {
        let [near, far] = [one, other].map(|number| self.apex(number, facet));
        let asked = [&facet[..], &[near, far], &self.covering.inside()].concat();
        match self.sites.ask(&asked, &Facet { on: 3, near: 1, far: 1, around: 0 }) {
            Separation::Good { is_near } => {
                self.covering.pass(one, Some(other), is_near, self.points, facet)?;
            }
            _ => {
                let message = format!("simplices {one} and {other} are on the same side of {facet:?}");
                return Err(self.violation(Claim::Facets, message, &[one, other]));
            }
        }
        let asked = [&self.simplices[one][..], &[far]].concat();
        match self.sites.ask(&asked, &Sphere { own: 4 }) {
            Roundness::Round { others: Ordering::Greater | Ordering::Equal, .. } => Ok(()),
            _ => {
                let message =
                    format!("vertex {far} of simplex {other} is inside of the sphere of simplex {one}");
                Err(self.violation(Claim::Delaunay, message, &[one, other]))
            }
        }
    }

    /// Checks that every ridge of the boundary is between two facets of it, and not concave.
    fn check_boundary(&mut self, boundary: &[Side]) -> Result<(), Violation> {
        let mut ridges: Vec<([u32; 3], usize)> = Vec::with_capacity(4 * boundary.len());
        for (i, ([p, q, r, s], _)) in boundary.iter().enumerate() {
            let around = [[*p, *q, *r], [*p, *q, *s], [*p, *r, *s], [*q, *r, *s]];
            ridges.extend(around.map(|ridge| (ridge, i)));
        }
        ridges.sort_unstable();
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); boundary.len()];
        for ridge in ridges.chunk_by(|one, other| one.0 == other.0) {
            let &[(ends, one), (_, other)] = ridge else {
                let message =
                    format!("ridge {:?} belongs to {} facets of the boundary", ridge[0].0, ridge.len());
                let cells: Vec<usize> = ridge.iter().map(|&(_, i)| boundary[i].1 as usize).collect();
                return Err(self.violation(Claim::Boundary, message, &cells));
            };
            around[one].extend(without(&boundary[other].0, &ends));
            around[other].extend(without(&boundary[one].0, &ends));
        }
        boundary.iter().zip(&around).try_for_each(|(side, around)| self.check_outer(side, around))
    }

    fn check_outer(&mut self, (facet, number): &Side, around: &[u32]) -> Result<(), Violation> {
        let number = *number as usize;
        let asked = [&facet[..], &[self.apex(number, facet)], around, &self.covering.inside()].concat();
        match self.sites.ask(&asked, &Facet { on: 3, near: 1, far: 0, around: around.len() }) {
            Separation::Good { is_near } => self.covering.pass(number, None, is_near, self.points, facet),
            Separation::Concave(i) => {
                let vertex = asked[i + 1];
                let message = format!(
                    "the boundary is concave at {facet:?} of simplex {number}: vertex {vertex} is beyond it"
                );
                Err(self.violation(Claim::Boundary, message, &[number]).at(self.points, &[vertex]))
            }
            _ => Err(self.violation(Claim::Facets, format!("simplex {number} is flat"), &[number])),
        }
    }

    /// The vertex of a simplex that is not on its facet.
    fn apex(&self, number: usize, facet: &[u32; 4]) -> u32 {
        let apex = self.simplices[number].iter().find(|vertex| !facet.contains(vertex));
        *apex.expect("five different vertices, because the simplex is not flat")
    }

    /// Numbers of edges and triangles.
    fn count(&self) -> [usize; 2] {
        let (mut edges, mut triangles) = (Distinct::<2>::default(), Distinct::<3>::default());
        for simplex in self.simplices {
            let mut vertices = *simplex;
            vertices.sort_unstable();
            for (i, &p) in vertices.iter().enumerate() {
                for (j, &q) in vertices.iter().enumerate().skip(i + 1) {
                    edges.add([p, q]);
                    vertices[j + 1..].iter().for_each(|&r| triangles.add([p, q, r]));
                }
            }
        }
        [edges.count(), triangles.count()]
    }

    fn violation(&self, claim: Claim, message: String, cells: &[usize]) -> Violation {
        let vertices: Vec<u32> = cells.iter().flat_map(|&cell| self.simplices[cell]).collect();
        Violation::new(claim, message).of_cells(cells).at(self.points, &vertices)
    }
}
