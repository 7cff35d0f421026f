//! Checks each finite cell of a diagram: its sphere, its facets, that they close up, and its part of the
//! boundary.

use std::cmp::Ordering;

use super::Proof;
use super::covering::Covering;
use super::faces::{Faces, common, without};
use super::form::Distinct;
use super::sites::Sites;
use super::space::{Facet, Roundness, Separation, Sphere};
use super::violation::{Claim, Violation};
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};

/// The audit of cells whose lists are well formed.
pub(super) struct CellsAudit<'a> {
    points: &'a [Point4],
    cells: &'a Cells4,
    finite: usize,
    sites: Sites<'a>,
    covering: Covering,
    faces: Faces,
    edges: Distinct<2>,
    polygons: Distinct<3>,
    proof: Proof,
}

impl<'a> CellsAudit<'a> {
    pub(super) fn new(points: &'a [Point4], cells: &'a Cells4, finite: usize) -> Self {
        let proof = Proof {
            vertices: points.len(),
            cells: finite,
            infinite: cells.len() - finite,
            ..Proof::default()
        };
        CellsAudit {
            points,
            cells,
            finite,
            sites: Sites::new(points),
            covering: Covering::default(),
            faces: Faces::default(),
            edges: Distinct::default(),
            polygons: Distinct::default(),
            proof,
        }
    }

    /// Proves all that is claimed of cells.
    pub(super) fn check(mut self) -> Result<Proof, Violation> {
        if self.finite == 0 {
            Covering::check_flat(&mut self.sites, self.points)?;
        } else {
            let inside = self.cells.get(self.finite / 2).vertices;
            self.covering =
                Covering::new(self.finite, &mut self.sites, self.points, inside, self.finite / 2)?;
        }
        for number in 0..self.finite {
            let cell = self.cells.get(number);
            self.check_sphere(number, cell)?;
            for &neighbour in cell.neighbours.iter().filter(|&&neighbour| neighbour as usize > number) {
                self.check_facet(number, neighbour as usize)?;
            }
            self.check_faces(number, cell)?;
            let boundary = (0..).zip(cell.neighbours).filter(|&(_, &beyond)| beyond as usize >= self.finite);
            boundary.clone().try_for_each(|(facet, &beyond)| self.check_boundary(facet, beyond as usize))?;
            self.proof.facets += boundary.count();
            self.proof.largest = self.proof.largest.max(cell.vertices.len());
            self.proof.simplices += usize::from(cell.vertices.len() == 5);
        }
        self.covering.check(self.points, |number| self.cells.get(number).vertices)?;
        Ok(self.finish())
    }

    fn finish(mut self) -> Proof {
        self.proof.edges = self.edges.count();
        self.proof.polygons = self.polygons.count();
        self.proof.questions = self.sites.asked;
        self.proof.exactly = self.sites.exactly;
        self.proof
    }

    /// Checks that the vertices are on one sphere, and that neighbours with greater numbers lie outside; one
    /// vertex of each neighbour is enough.
    fn check_sphere(&mut self, number: usize, cell: Cell4) -> Result<(), Violation> {
        let mut asked = cell.vertices.to_vec();
        let later = cell.neighbours.iter().map(|&neighbour| neighbour as usize);
        let later: Vec<usize> = later.filter(|&beyond| beyond > number && beyond < self.finite).collect();
        for &beyond in &later {
            let Some(other) = without(self.cells.get(beyond).vertices, cell.vertices).next() else {
                let message = format!("cell {beyond} has no vertex that cell {number} has not");
                return Err(self.violation(Claim::Facets, message, &[number, beyond]));
            };
            asked.push(other);
        }
        let own = cell.vertices.len() - 1;
        match self.sites.ask(&asked, &Sphere { own }) {
            Roundness::Round { others: Ordering::Greater, .. } => Ok(()),
            Roundness::Round { others, worst, .. } => {
                let (vertex, place) =
                    (asked[own + 1 + worst], if others.is_lt() { "inside of" } else { "on" });
                let message = format!(
                    "vertex {vertex} of cell {} is {place} the sphere of cell {number}",
                    later[worst]
                );
                let violation = self.violation(Claim::Delaunay, message, &[number, later[worst]]);
                Err(violation.at(self.points, &[vertex]))
            }
            Roundness::Flat => {
                let message = format!("all vertices of cell {number} lie in a hyperplane");
                Err(self.violation(Claim::Spheres, message, &[number]))
            }
            Roundness::Off(i) => {
                let message =
                    format!("vertex {} of cell {number} is not on the sphere of the others", asked[i + 1]);
                Err(self.violation(Claim::Spheres, message, &[number]))
            }
        }
    }

    /// Checks that the cell and a neighbour share a facet of both, and lie on opposite sides of it.
    fn check_facet(&mut self, number: usize, beyond: usize) -> Result<(), Violation> {
        let (cell, other) = (self.cells.get(number), self.cells.get(beyond));
        let mut asked: Vec<u32> = common(cell.vertices, other.vertices).collect();
        let on = asked.len();
        if on < 4 || other.is_infinite && on < other.vertices.len() {
            let message = format!("cells {number} and {beyond} share no facet, but are neighbours");
            return Err(self.violation(Claim::Facets, message, &[number, beyond]));
        }
        let facet = asked.clone();
        asked.extend(without(cell.vertices, &facet));
        let near = asked.len() - on;
        asked.extend(without(other.vertices, &facet));
        let far = asked.len() - on - near;
        if other.is_infinite {
            let around = other.neighbours[1..].iter().map(|&next| self.cells.get(next as usize));
            around.for_each(|next| asked.extend(without(next.vertices, &facet)));
        }
        let around = asked.len() - on - near - far;
        asked.extend(self.covering.inside());
        let fault = match self.sites.ask(&asked, &Facet { on: on - 1, near, far, around }) {
            Separation::Good { is_near } => {
                let beyond = (!other.is_infinite).then_some(beyond);
                return self.covering.pass(number, beyond, is_near, self.points, &facet);
            }
            fault => fault,
        };
        let (claim, message) = match fault {
            Separation::Bent(_) => (Claim::Facets, "is not in one hyperplane".to_string()),
            Separation::Crossed(i) => {
                (Claim::Facets, format!("does not support cell {number} at vertex {}", asked[i + 1]))
            }
            Separation::SameSide(i) => (
                Claim::Facets,
                format!("does not separate them: vertex {} is on the side of cell {number}", asked[i + 1]),
            ),
            Separation::Concave(i) => (
                Claim::Boundary,
                format!("is at a concave part of the boundary: vertex {} is beyond it", asked[i + 1]),
            ),
            _ => (Claim::Facets, "has less than three dimensions".to_string()),
        };
        let message = format!("what cells {number} and {beyond} share {message}");
        Err(self.violation(claim, message, &[number, beyond]))
    }

    /// Checks that the facets close up. Counts ridges and edges, except those that a neighbour with a lower
    /// number has counted.
    fn check_faces(&mut self, number: usize, cell: Cell4) -> Result<(), Violation> {
        self.faces.facets.clear();
        for &beyond in cell.neighbours {
            let facet = places(cell.vertices, self.cells.get(beyond as usize).vertices);
            self.faces.facets.push(facet);
        }
        let is_first = |facet: usize| cell.neighbours[facet] as usize > number;
        let edges = &mut self.edges;
        let checked = self.faces.check(cell.vertices.len(), |ends, facets| {
            if facets.into_iter().all(is_first) {
                edges.add(ends.map(|place| cell.vertices[place as usize]));
            }
        });
        checked.map_err(|fault| fault.violation(number, cell.neighbours).at(self.points, cell.vertices))?;
        for (facets, list) in self.faces.ridges() {
            if facets.into_iter().all(is_first) {
                self.polygons.add([0, 1, 2].map(|i| cell.vertices[list[i] as usize]));
            }
        }
        self.proof.facets += cell.neighbours.iter().filter(|&&beyond| (beyond as usize) < number).count();
        Ok(())
    }

    /// Checks that the neighbours of the infinite cell at a facet of the current cell are those across the
    /// ridges of the facet.
    fn check_boundary(&self, facet: usize, beyond: usize) -> Result<(), Violation> {
        let cell = self.cells.get(beyond);
        let (finite, around) = (self.cells.get(cell.neighbours[0] as usize), &cell.neighbours[1..]);
        let ridges = self.faces.ridges().filter(|(facets, _)| facets.contains(&facet));
        let mut expected: Vec<Vec<u32>> = ridges
            .map(|(_, list)| list.iter().map(|&place| finite.vertices[place as usize]).collect())
            .collect();
        expected.sort_unstable();
        let share = |next: u32| common(cell.vertices, self.cells.get(next as usize).vertices).collect();
        let mut found: Vec<(Vec<u32>, u32)> = around.iter().map(|&next| (share(next), next)).collect();
        found.sort_unstable();
        if expected.iter().eq(found.iter().map(|(ridge, _)| ridge)) {
            return Ok(());
        }
        if let Some((_, next)) = found.iter().find(|(ridge, _)| expected.binary_search(ridge).is_err()) {
            let message = format!("infinite cells {beyond} and {next} share no ridge, but are neighbours");
            return Err(self.violation(Claim::Boundary, message, &[beyond, *next as usize]));
        }
        let message = format!(
            "infinite cell {beyond} has {} ridges, but neighbours across {} of them",
            expected.len(),
            found.len()
        );
        Err(self.violation(Claim::Boundary, message, &[beyond]))
    }

    fn violation(&self, claim: Claim, message: String, cells: &[usize]) -> Violation {
        let vertices: Vec<u32> =
            cells.iter().flat_map(|&cell| self.cells.get(cell).vertices).copied().collect();
        Violation::new(claim, message).of_cells(cells).at(self.points, &vertices)
    }
}

/// Places in a list of the vertices that are in another list too.
fn places<'a>(list: &'a [u32], other: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let mut rest = other;
    (0..).zip(list).filter_map(move |(place, vertex)| {
        while rest.first().is_some_and(|first| first < vertex) {
            rest = &rest[1..];
        }
        (rest.first() == Some(vertex)).then_some(place)
    })
}
