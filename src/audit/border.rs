//! The border of a triangle mesh that was cut: any number of cycles, which a sweep proves not to meet
//! themselves or each other.
//!
//! A line goes over the plane in the lexicographic order of points. It meets the edges of the border that are
//! under way from bottom to top. If these never meet but at common corners, and run to the right and to the
//! left in turns, beginning with one to the right, the border goes once around every point to the left of an
//! edge, and not at all around the others.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::constraints::Constraints;
use super::corner::name_corners;
use super::exact::plane::{Xy, is_longer, lexicographic, orientation};
use super::triangles::Corner;

/// An edge of the border, from left to right in lexicographic order.
#[derive(Debug, Clone, Copy)]
struct Edge {
    left: Corner,
    right: Corner,
    /// Whether its triangle is above it: it then runs from left to right.
    is_below_mesh: bool,
}

/// Proves that a border is one that cutting leaves. Of each of its `triangles` the edge from the first to the
/// second corner is on the border; `kill` is the kill length or 0.
///
/// Memory: the border. Cost: n log n for n edges, unless very many are under way at once.
pub(super) fn check(
    triangles: &[[Corner; 3]],
    constraints: &Constraints,
    kill: f64,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let edges: Vec<[Corner; 2]> = triangles.iter().map(|&[from, to, _]| [from, to]).collect();
    check_simple(&edges, ledger)?;
    if kill > 0.0 {
        return check_lengths(&edges, constraints, kill, ledger);
    }
    check_reasons(triangles, constraints, ledger)
}

/// Proves that the border does not meet itself, and that the mesh is to the left of its edges.
fn check_simple(edges: &[[Corner; 2]], ledger: &mut Ledger) -> Result<(), Violation> {
    let mut edges: Vec<Edge> = edges.iter().map(|&ends| Edge::of(ends)).collect();
    // All edges that start at a point come together, from bottom to top.
    edges.sort_by(|a, b| {
        let by_place = lexicographic(a.left.at, b.left.at).then(a.left.id.cmp(&b.left.id));
        by_place.then_with(|| orientation(a.left.at, b.right.at, a.right.at).sign)
    });
    let mut corners: Vec<Corner> = edges.iter().flat_map(|edge| [edge.left, edge.right]).collect();
    corners.sort_by(|a, b| lexicographic(a.at, b.at).then(a.id.cmp(&b.id)));
    corners.dedup_by_key(|corner| corner.id);
    if let Some(pair) = corners.windows(2).find(|pair| pair[0].at == pair[1].at) {
        let message = format!("vertices {} and {} of the border coincide", pair[0].id, pair[1].id);
        return Err(name_corners(Violation::new(Check::Border, message), pair));
    }
    let mut under_way: Vec<Edge> = Vec::new();
    let mut rest = &edges[..];
    for &corner in &corners {
        let starting = rest.partition_point(|edge| lexicographic(edge.left.at, corner.at).is_le());
        let (starts, later) = rest.split_at(starting);
        rest = later;
        let below = under_way.partition_point(|edge| edge.side_of(corner, ledger) == Ordering::Greater);
        let through = under_way[below..].iter();
        let through = through.take_while(|edge| edge.side_of(corner, ledger) == Ordering::Equal).count();
        if let Some(edge) = under_way[below..below + through].iter().find(|edge| edge.right.id != corner.id) {
            let message = format!("vertex {} is on the edge {}", corner.id, edge.name());
            let violation = Violation::new(Check::Border, message);
            return Err(name_corners(violation, &[corner, edge.left, edge.right]));
        }
        under_way.splice(below..below + through, starts.iter().copied());
        let new = below.saturating_sub(1)..(below + starts.len() + 1).min(under_way.len());
        for pair in under_way[new].windows(2) {
            pair[0].check_apart(&pair[1], ledger)?;
        }
        check_turns(&under_way, below, starts.len(), corner)?;
    }
    Ok(())
}

/// Proves that the edges around the place of a corner run to the right and to the left in turns.
fn check_turns(under_way: &[Edge], below: usize, starts: usize, corner: Corner) -> Result<(), Violation> {
    let is_below_mesh = |at: usize| under_way.get(at).map(|edge| edge.is_below_mesh);
    for at in below.saturating_sub(1)..=below + starts {
        let before = at.checked_sub(1).and_then(is_below_mesh);
        // Beyond the first and the last edge there is no mesh.
        if before.unwrap_or(false) == is_below_mesh(at).unwrap_or(true) {
            let message = format!("the triangles inside of the border overlap near vertex {}", corner.id);
            return Err(name_corners(Violation::new(Check::Border, message), &[corner]));
        }
    }
    Ok(())
}

impl Edge {
    fn of([from, to]: [Corner; 2]) -> Edge {
        match lexicographic(from.at, to.at) {
            Ordering::Less => Edge { left: from, right: to, is_below_mesh: true },
            _ => Edge { left: to, right: from, is_below_mesh: false },
        }
    }

    /// Whether a point is above the edge (`Greater`), below, or on its line.
    fn side_of(&self, corner: Corner, ledger: &mut Ledger) -> Ordering {
        let turn = orientation(self.left.at, self.right.at, corner.at);
        ledger.count(Check::Border, turn.exactly);
        turn.sign
    }

    /// Proves that the edge and one next above it meet at a common corner at most.
    fn check_apart(&self, above: &Edge, ledger: &mut Ledger) -> Result<(), Violation> {
        let sides = [
            self.side_of(above.left, ledger),
            self.side_of(above.right, ledger),
            above.side_of(self.left, ledger).reverse(),
            above.side_of(self.right, ledger).reverse(),
        ];
        let lies_above =
            |sides: [Ordering; 2]| sides.iter().all(|side| side.is_ge()) && sides != [Ordering::Equal; 2];
        // Of two edges that do not cross, one lies on one side of the line of the other.
        if lies_above([sides[0], sides[1]]) || lies_above([sides[2], sides[3]]) {
            return Ok(());
        }
        let message = format!("the edges {} and {} of the border meet", self.name(), above.name());
        let corners = [self.left, self.right, above.left, above.right];
        Err(name_corners(Violation::new(Check::Border, message), &corners))
    }

    fn name(&self) -> String {
        format!("{} to {}", self.left.id, self.right.id)
    }
}

/// Proves that each edge of the border is on a segment, or is not longer than `kill`.
fn check_lengths(
    edges: &[[Corner; 2]],
    constraints: &Constraints,
    kill: f64,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let free = edges.iter().filter(|[a, b]| constraints.of_border([a.id, b.id]).is_none());
    let too_long = |[a, b]: &&[Corner; 2]| {
        ledger.add(Check::Border, 1);
        is_longer([a.at, b.at], kill)
    };
    let Some([a, b]) = free.filter(too_long).min_by_key(|[a, b]| [a.id, b.id]) else { return Ok(()) };
    let message = format!(
        "the edge {} to {} of the border is on no segment and longer than {kill}, the kill length (both in \
         stored units)",
        a.id, b.id
    );
    Err(name_corners(Violation::new(Check::Border, message), &[*a, *b]))
}

/// Proves that each edge of the border is on a segment, or on the convex hull of all vertices, or that an
/// open segment crosses its triangle.
fn check_reasons(
    triangles: &[[Corner; 3]],
    constraints: &Constraints,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    let mut corners: Vec<Xy> = triangles.iter().map(|[from, ..]| from.at).collect();
    corners.sort_by(|&p, &q| lexicographic(p, q));
    corners.dedup();
    // The hull from left to right below, from right to left above, with all points on its sides.
    let mut hull = side_of_hull(corners.iter().copied(), ledger);
    hull.extend(side_of_hull(corners.iter().rev().copied(), ledger));
    hull.sort_by(compare);
    let is_on_hull = |ends: [Xy; 2]| hull.binary_search_by(|side| compare(side, &ends)).is_ok();
    let free = triangles.iter().filter(|[a, b, _]| constraints.of_border([a.id, b.id]).is_none());
    let inner = free.filter(|[a, b, _]| !is_on_hull([a.at, b.at]));
    let wrong = inner.filter(|corners| !constraints.has_open_in(corners.map(|it| it.at), ledger));
    let Some([a, b, _]) = wrong.min_by_key(|[a, b, _]| [a.id, b.id]) else { return Ok(()) };
    let message = format!(
        "the edge {} to {} of the border is neither on a segment nor on the hull, and no open segment \
         crosses its triangle",
        a.id, b.id
    );
    Err(name_corners(Violation::new(Check::Border, message), &[*a, *b]))
}

/// Pairs of neighbours on the lower side of the convex hull of sorted points; on the upper side, if they are
/// in decreasing order.
fn side_of_hull(points: impl Iterator<Item = Xy>, ledger: &mut Ledger) -> Vec<[Xy; 2]> {
    let mut chain: Vec<Xy> = Vec::new();
    for point in points {
        while let [.., before, last] = chain[..] {
            let turn = orientation(before, last, point);
            ledger.count(Check::Border, turn.exactly);
            if turn.sign != Ordering::Less {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn compare(a: &[Xy; 2], b: &[Xy; 2]) -> Ordering {
    lexicographic(a[0], b[0]).then_with(|| lexicographic(a[1], b[1]))
}
