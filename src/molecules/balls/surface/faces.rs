//! The faces between cells as polygons, and their outlines: where sides enter and leave the disk.

use super::super::dual::Dual;
use super::super::tile::{Tile, with_all};
use super::super::{Balls, Contact};
use super::nodes::Nodes;
use super::{check_count, check_step};
use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::Ring;
use spmesh_delaunay::predicates::Point3;

/// Faces between cells, as convex polygons whose arcs are divided. Neighbours share vertices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faces {
    /// Vertices.
    pub points: Vec<Point3>,
    /// Corners of all polygons, counterclockwise seen from the greater ball.
    pub corners: Vec<u32>,
    /// For each polygon the end of its corners.
    pub ends: Vec<usize>,
    /// For each polygon its balls and its exact area, in the order of the balls.
    pub contacts: Vec<Contact>,
}

/// The faces that `is_wanted` accepts, as polygons. Neighbours on arcs are at most `step` apart.
///
/// # Errors
/// As [`super::surface`].
///
/// Cost and memory: those of the triangulation of all balls, on one thread.
pub fn faces(balls: Balls<'_>, step: f64, is_wanted: impl Fn(&Contact) -> bool) -> Result<Faces> {
    check_step(balls, step)?;
    with_all(balls, |tile| of_tile(tile, step, is_wanted))
}

fn of_tile(tile: &Tile<'_>, step: f64, is_wanted: impl Fn(&Contact) -> bool) -> Result<Faces> {
    let mut found = Vec::new();
    let dual = Dual::new(tile);
    let mut nodes = Nodes::new(&dual, step);
    let mut corners = vec![u32::MAX; tile.tetrahedra().len()];
    let mut steps = Vec::new();
    tile.for_each_pair(|ring, pair| {
        let [Some(first), Some(second)] = ring.ends.map(|v| tile.ball(v)) else { return };
        if !pair.has_disk() {
            return;
        }
        let area = tile.face(ring, pair, |_| ()).area;
        let contact = Contact { balls: [first.min(second), first.max(second)], area };
        if !tile.is_noise(&contact, pair) && is_wanted(&contact) {
            outline(&dual, ring, &mut steps);
            let mut polygon = Vec::new();
            if steps.is_empty() && nodes.is_whole(ring, pair) {
                polygon = nodes.whole_circle(ring, pair);
                polygon.pop();
            }
            for (at, &step) in steps.iter().enumerate() {
                match (step, steps[(at + 1) % steps.len()]) {
                    (Step::Leave(from), Step::Enter(to)) => {
                        let arc = nodes.arc(ring, pair, [from, to]);
                        polygon.extend(arc);
                        // The entry itself.
                        polygon.pop();
                    }
                    (Step::Leave(crossing) | Step::Enter(crossing), _) => polygon.push(nodes.node(crossing)),
                    (Step::Corner(t), _) => {
                        polygon.push(*numbered(&mut corners[t], &mut nodes, tile.centre(t)))
                    }
                }
            }
            if first > second {
                polygon.reverse();
            }
            found.push((contact, polygon));
        }
    });
    Faces::of(nodes, found)
}

/// The number of a vertex, made at first use.
fn numbered<'n>(number: &'n mut u32, nodes: &mut Nodes<'_>, at: Point3) -> &'n u32 {
    if *number == u32::MAX {
        *number = nodes.points.len() as u32;
        nodes.push(at);
    }
    number
}

impl Faces {
    fn of(mut nodes: Nodes<'_>, mut found: Vec<(Contact, Vec<u32>)>) -> Result<Faces> {
        check_count(&nodes.points)?;
        found.sort_by_key(|(contact, _)| contact.balls);
        let same = nodes.merged();
        let mut faces = Faces { points: nodes.points, ..Faces::default() };
        for (contact, mut polygon) in found {
            polygon.iter_mut().for_each(|node| *node = same[*node as usize]);
            polygon.dedup();
            if polygon.len() > 1 && polygon.first() == polygon.last() {
                polygon.pop();
            }
            if polygon.len() > 2 {
                faces.corners.extend(polygon);
                faces.ends.push(faces.corners.len());
                faces.contacts.push(contact);
            }
        }
        Ok(faces)
    }
}

/// A step on the way around a polygon, right-handed about the edge that is dual to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// The way enters the disk at a crossing.
    Enter(Crossing),
    /// The way leaves the disk: up to the next entry, the outline is an arc.
    Leave(Crossing),
    /// A corner in the disk: the orthocentre of a tetrahedron.
    Corner(usize),
}

/// Where an edge of the power diagram crosses the surface: the tetrahedron at its outer end, and the corner
/// opposite to the facet that is dual to the edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crossing {
    pub(super) tetrahedron: usize,
    pub(super) corner: usize,
}

/// The way around the polygon of a ring. Without steps, the whole polygon is outside of the disk, or the disk
/// in the polygon.
pub(super) fn outline(dual: &Dual<'_>, ring: &Ring, steps: &mut Vec<Step>) {
    steps.clear();
    let Some(&last) = ring.tetrahedra.back() else { return };
    let mut from = last as usize;
    for (&to, &third) in ring.tetrahedra.iter().zip(&ring.link) {
        let to = to as usize;
        let crossing = |tetrahedron: usize| {
            let vertices = dual.tile.tetrahedra()[tetrahedron].vertices;
            let is_apex = |v: &u32| !ring.ends.contains(v) && *v != third;
            Crossing { tetrahedron, corner: vertices.iter().position(is_apex).unwrap_or(0) }
        };
        match (dual.is_empty(from), dual.is_empty(to)) {
            (false, true) => steps.push(Step::Leave(crossing(to))),
            (true, false) => steps.push(Step::Enter(crossing(from))),
            (true, true) if dual.dips(to, crossing(to).corner) => {
                steps.extend([Step::Enter(crossing(from)), Step::Leave(crossing(to))]);
            }
            _ => {}
        }
        if !dual.is_empty(to) {
            steps.push(Step::Corner(to));
        }
        from = to;
    }
}
