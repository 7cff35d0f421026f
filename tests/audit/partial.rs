//! Partial meshes: the final triangles of a region, its walls and its residual.

use spmesh::audit::{Audit, Check, Report, Standard};
use spmesh::bounds::{Point, Region};
use spmesh::stream::{Event, Header, Kind, Patch, StreamWriter, Totals};

use super::reference::canonical_triangulation;
use super::{Verdict, assert_violates, audit, given, grid, point};

/// The parts of a partial mesh, correct until a test changes one.
#[derive(Debug, Clone)]
struct Partial {
    points: Vec<[i32; 2]>,
    patch: Patch,
    residual: Vec<(Option<u64>, Point)>,
    walls: Vec<[u32; 2]>,
    merged: u64,
    input_points: u64,
}

/// A grid of 6 x 6 points whose triangles within the inner 4 x 4 are final. Those inner points are the
/// vertices 0 to 15; 16 to 35 are the rim, which is written as residual points without ids.
fn partial() -> Partial {
    let is_inner = |p: &[i32; 2]| p.iter().all(|c| (1..5).contains(c));
    let all = (0..36).map(|i| [i % 6, i / 6]);
    let (inner, rim): (Vec<[i32; 2]>, Vec<[i32; 2]>) = all.partition(is_inner);
    let points = [inner.clone(), rim.clone()].concat();
    let triangles = canonical_triangulation(&points);
    let last: Vec<[usize; 3]> = triangles.into_iter().filter(|t| t.iter().all(|&v| v < 16)).collect();
    let edges: Vec<[usize; 2]> = last.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).collect();
    let open: Vec<[usize; 2]> = edges.iter().copied().filter(|[a, b]| !edges.contains(&[*b, *a])).collect();
    let is_open = |v: usize| open.iter().flatten().any(|&end| end == v);
    let written = (0..16).filter(|&v| is_open(v));
    let mut residual: Vec<(Option<u64>, Point)> =
        written.map(|v| (Some(v as u64), point(&points[v]))).collect();
    let place = |v: usize| residual.iter().position(|(id, _)| *id == Some(v as u64)).unwrap() as u32;
    let walls = open.iter().map(|edge| edge.map(place)).collect();
    residual.extend(rim.iter().map(|p| (None, point(p))));
    Partial {
        patch: Patch {
            new: inner.iter().map(point).collect(),
            simplices: last.iter().flatten().map(|&v| v as u32).collect(),
            finalized: (0..16).filter(|&v| !is_open(v as usize)).collect(),
            ..Patch::default()
        },
        points,
        residual,
        walls,
        merged: 2,
        input_points: 38,
    }
}

impl Partial {
    fn header() -> Header {
        let region = Some(Region { min: [0.0, f64::NEG_INFINITY], max: [6.0, 6.0] });
        Header { region, ..Header::new(Kind::PartialTriangleMesh, grid(), 2, false) }
    }

    fn stream(&self) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), Partial::header()).unwrap();
        writer.patch(&self.patch).unwrap();
        writer.residual_points(&self.residual).unwrap();
        writer.walls(&self.walls).unwrap();
        writer.end(self.input_points, self.merged).unwrap()
    }

    /// Gives the parts to the audit directly, past the reader, which refuses some faults itself.
    fn audit(&self) -> Result<Report, Verdict> {
        let mut audit = Audit::new(&Partial::header(), Standard::Canonical, None).unwrap();
        let totals = Totals { points: self.input_points, merged: self.merged, ..Totals::default() };
        let events = [
            Event::Patch(self.patch.clone()),
            Event::ResidualPoints(self.residual.clone()),
            Event::Walls(self.walls.clone()),
            Event::End(totals),
        ];
        events.iter().try_for_each(|event| audit.event(event)).map_err(Verdict::Violation)?;
        Ok(audit.report())
    }
}

#[test]
fn correct_partial_mesh_passes() {
    let partial = partial();
    partial.audit().unwrap();
    audit(&partial.stream(), Standard::Canonical, None).unwrap();
    audit(&partial.stream(), Standard::Canonical, Some(given(&partial.points))).unwrap();
    let fewer = Some(given(&partial.points[..35]));
    assert_violates(audit(&partial.stream(), Standard::Canonical, fewer), Check::Points, &[]);
}

#[test]
fn walls_must_be_the_open_edges() {
    let mut missing = partial();
    let wall = missing.walls.pop().unwrap();
    let ends = wall.map(|end| missing.residual[end as usize].0.unwrap());
    assert_violates(missing.audit(), Check::Walls, &ends);

    let mut reversed = partial();
    reversed.walls[0].reverse();
    let ends = reversed.walls[0].map(|end| reversed.residual[end as usize].0.unwrap());
    assert_violates(reversed.audit(), Check::Walls, &ends);

    let mut twice = partial();
    twice.walls.push(twice.walls[0]);
    assert!(matches!(twice.audit(), Err(Verdict::Violation(v)) if v.check == Check::Walls));

    let mut stray = partial();
    let len = stray.residual.len() as u32;
    stray.walls.push([len - 2, len - 1]);
    assert_violates(stray.audit(), Check::Walls, &[]);
}

#[test]
fn vertices_must_be_finalized_or_in_the_residual() {
    let mut lost = partial();
    let unfinalized = u64::from(lost.patch.finalized.pop().unwrap());
    assert_violates(lost.audit(), Check::Residual, &[unfinalized]);

    let mut both = partial();
    let id = u64::from(both.patch.finalized[0]);
    both.residual.push((Some(id), both.patch.new[id as usize]));
    assert_violates(both.audit(), Check::Residual, &[id]);

    let mut early = partial();
    let id = early.residual[0].0.unwrap();
    early.patch.finalized.insert(0, id as u32);
    early.patch.finalized.sort_unstable();
    assert_violates(early.audit(), Check::Vertices, &[id]);
}

#[test]
fn residual_points_stay_where_they_are() {
    let mut moved = partial();
    moved.residual[1].1[1] += 1.0;
    let id = moved.residual[1].0.unwrap();
    assert_violates(moved.audit(), Check::Residual, &[id, id]);

    let mut twice = partial();
    twice.residual.push(twice.residual[0]);
    let id = twice.residual[0].0.unwrap();
    assert_violates(twice.audit(), Check::Residual, &[id]);

    let mut coincident = partial();
    coincident.residual.push(*coincident.residual.last().unwrap());
    assert_violates(coincident.audit(), Check::Residual, &[]);
}

#[test]
fn points_lie_in_the_region() {
    let mut outside = partial();
    outside.residual.last_mut().unwrap().1[0] = 6.0;
    assert_violates(outside.audit(), Check::Region, &[]);
}

#[test]
fn no_point_is_lost() {
    let mut lost = partial();
    lost.residual.pop();
    assert_violates(lost.audit(), Check::Counts, &[]);
}

#[test]
fn final_triangles_are_canonical() {
    let mut bad = partial();
    bad.patch.simplices.swap(0, 1);
    assert!(matches!(bad.audit(), Err(Verdict::Violation(v)) if v.check == Check::Orientation));
}
