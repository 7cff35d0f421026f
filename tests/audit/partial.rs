//! Partial meshes: the final triangles or tetrahedra of a region, its walls and its residual.

use spmesh_audit::{Audit, Check, PointSet, Report, Standard};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Event, Header, Kind, Patch, StreamWriter, Totals};

use super::reference::canonical_triangulation;
use super::solid::{Solid, cubic};
use super::{Verdict, assert_violates, audit, grid};

/// The parts of a partial mesh, correct until a test changes one.
#[derive(Debug, Clone)]
struct Partial<const D: usize> {
    points: Vec<[i32; D]>,
    region: Region<D>,
    patch: Patch,
    residual: Vec<(Option<u64>, Point)>,
    walls: Vec<[u32; D]>,
    merged: u64,
    input_points: u64,
}

/// A grid of 6 x 6 points whose triangles within the inner 4 x 4 are final. The inner points are the vertices
/// 0 to 15. The points 16 to 35, the rim, are written as residual points without ids.
fn plane() -> Partial<2> {
    let is_inner = |p: &[i32; 2]| p.iter().all(|c| (1..5).contains(c));
    let all = (0..36).map(|i| [i % 6, i / 6]);
    let (inner, rim): (Vec<[i32; 2]>, Vec<[i32; 2]>) = all.partition(is_inner);
    let points = [inner, rim].concat();
    let last: Vec<[usize; 3]> =
        canonical_triangulation(&points).into_iter().filter(|t| t.iter().all(|&v| v < 16)).collect();
    let edges: Vec<[usize; 2]> = last.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).collect();
    let open: Vec<[usize; 2]> = edges.iter().copied().filter(|[a, b]| !edges.contains(&[*b, *a])).collect();
    let region = Region { min: [0.0, f64::NEG_INFINITY], max: [6.0, 6.0] };
    Partial::of(points, 16, last.concat(), &open, region)
}

/// A lattice of 3 x 3 x 3 points in which the tetrahedra around the central point are final. The central
/// point is vertex 0.
fn space() -> Partial<3> {
    let cube = cubic(3);
    let star: Vec<[usize; 4]> =
        Solid::canonical(&cube).tetrahedra.into_iter().filter(|t| t.contains(&13)).collect();
    let mut order: Vec<usize> = (0..27).collect();
    order.sort_by_key(|v| (*v != 13, !star.iter().flatten().any(|used| used == v), *v));
    let place = |v: usize| order.iter().position(|&other| other == v).unwrap();
    let star: Vec<[usize; 4]> = star.into_iter().map(|t| t.map(place)).collect();
    let vertices = star.iter().flatten().max().unwrap() + 1;
    let opposite = |t: &[usize; 4]| match t.iter().position(|&v| v == 0).unwrap() {
        0 => [t[1], t[3], t[2]],
        1 => [t[0], t[2], t[3]],
        2 => [t[0], t[3], t[1]],
        _ => [t[0], t[1], t[2]],
    };
    let open: Vec<[usize; 3]> = star.iter().map(opposite).collect();
    let region = Region { min: [0.0, f64::NEG_INFINITY, 0.0], max: [3.0, f64::INFINITY, 3.0] };
    Partial::of(order.iter().map(|&v| cube[v]).collect(), vertices, star.concat(), &open, region)
}

fn point<const D: usize>(at: &[i32; D]) -> Point {
    std::array::from_fn(|axis| if axis < D { f64::from(at[axis]) } else { 0.0 })
}

impl<const D: usize> Partial<D> {
    /// Writes the first `vertices` points and the simplices, and makes the facets `open` around them walls.
    fn of(
        points: Vec<[i32; D]>,
        vertices: usize,
        simplices: Vec<usize>,
        open: &[[usize; D]],
        region: Region<D>,
    ) -> Self {
        let is_open = |v: usize| open.iter().flatten().any(|&corner| corner == v);
        let written = (0..vertices).filter(|&v| is_open(v));
        let mut residual: Vec<(Option<u64>, Point)> =
            written.map(|v| (Some(v as u64), point(&points[v]))).collect();
        let place = |v: usize| residual.iter().position(|(id, _)| *id == Some(v as u64)).unwrap() as u32;
        let walls = open.iter().map(|facet| facet.map(place)).collect();
        residual.extend(points[vertices..].iter().map(|p| (None, point(p))));
        let patch = Patch {
            new: points[..vertices].iter().map(point).collect(),
            simplices: simplices.iter().map(|&v| v as u32).collect(),
            finalized: (0..vertices as u32).filter(|&v| !is_open(v as usize)).collect(),
            ..Patch::default()
        };
        let input_points = points.len() as u64 + 2;
        Partial { points, region, patch, residual, walls, merged: 2, input_points }
    }

    fn header(&self) -> Header {
        let kind = if D == 2 { Kind::PartialTriangleMesh } else { Kind::PartialTetrahedralMesh };
        let region = Some(self.region.in_space());
        Header { region, ..Header::new(kind, grid(), D as u8, false) }
    }

    fn given(&self, points: usize) -> Option<PointSet> {
        let mut set = PointSet::new(grid(), D as u8);
        set.extend(&self.points[..points].iter().map(point).collect::<Vec<_>>());
        Some(set.finish(&grid()).unwrap())
    }

    /// Ids of the corners of a wall, in its order.
    fn ids(&self, wall: &[u32; D]) -> [u64; D] {
        wall.map(|corner| self.residual[corner as usize].0.unwrap())
    }

    fn stream(&self) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), self.header()).unwrap();
        writer.patch(&self.patch).unwrap();
        writer.residual_points(&self.residual).unwrap();
        writer.walls(self.walls.as_flattened()).unwrap();
        writer.end(self.input_points, self.merged).unwrap()
    }

    /// Passes the parts directly to the audit, because the reader refuses some faults itself.
    fn audit(&self) -> Result<Report, Verdict> {
        let mut audit = Audit::new(&self.header(), Standard::Canonical, None).unwrap();
        let totals = Totals { points: self.input_points, merged: self.merged, ..Totals::default() };
        let events = [
            Event::Patch(self.patch.clone()),
            Event::ResidualPoints(self.residual.clone()),
            Event::Walls(self.walls.concat()),
            Event::End(totals),
        ];
        events.iter().try_for_each(|event| audit.event(event)).map_err(Verdict::Violation)?;
        Ok(audit.report())
    }
}

/// Runs a test in the plane and in space.
macro_rules! in_plane_and_space {
    ($test:ident, $check:ident) => {
        #[test]
        fn $test() {
            $check(plane());
            $check(space());
        }
    };
}

in_plane_and_space!(correct_partial_mesh_passes, check_correct);
in_plane_and_space!(walls_must_be_the_open_facets, check_walls);
in_plane_and_space!(vertices_must_be_finalized_or_in_the_residual, check_vertices);
in_plane_and_space!(residual_points_stay_where_they_are, check_places);
in_plane_and_space!(points_lie_in_the_region, check_region);
in_plane_and_space!(no_point_is_lost, check_counts);
in_plane_and_space!(final_simplices_are_positive, check_orientation);
in_plane_and_space!(residual_points_lie_in_no_final_simplex, check_cover);
in_plane_and_space!(residual_points_lie_in_no_ball_of_a_wall, check_balls);

fn check_correct<const D: usize>(partial: Partial<D>) {
    assert!(!partial.patch.finalized.is_empty() && partial.walls.len() > 8);
    partial.audit().unwrap();
    let (stream, all) = (partial.stream(), partial.points.len());
    let report = audit(&stream, Standard::Canonical, None).unwrap();
    let walls = report.lines.iter().find(|line| line.check == Check::Walls).unwrap();
    assert_eq!(walls.tests, partial.walls.len() as u64);
    audit(&stream, Standard::Canonical, partial.given(all)).unwrap();
    assert_violates(audit(&stream, Standard::Canonical, partial.given(all - 1)), Check::Points, &[]);
}

fn check_walls<const D: usize>(partial: Partial<D>) {
    let mut missing = partial.clone();
    let wall = missing.walls.pop().unwrap();
    let mut ids = missing.ids(&wall);
    if D == 3 {
        // The audit names the open facet from its least corner on.
        let least = (0..D).min_by_key(|&i| ids[i]).unwrap();
        ids.rotate_left(least);
    }
    assert_violates(missing.audit(), Check::Walls, &ids);

    let mut reversed = partial.clone();
    reversed.walls[0].reverse();
    assert_violates(reversed.audit(), Check::Walls, &reversed.ids(&reversed.walls[0]));

    let mut twice = partial.clone();
    twice.walls.push(twice.walls[0]);
    assert!(matches!(twice.audit(), Err(Verdict::Violation(v)) if v.check == Check::Walls));

    let mut stray = partial;
    let len = stray.residual.len() as u32;
    stray.walls.push(std::array::from_fn(|i| len - 1 - i as u32));
    assert_violates(stray.audit(), Check::Walls, &[]);
}

fn check_vertices<const D: usize>(partial: Partial<D>) {
    let mut lost = partial.clone();
    let unfinalized = u64::from(lost.patch.finalized.pop().unwrap());
    assert_violates(lost.audit(), Check::Residual, &[unfinalized]);

    let mut both = partial.clone();
    let id = u64::from(both.patch.finalized[0]);
    both.residual.push((Some(id), both.patch.new[id as usize]));
    assert_violates(both.audit(), Check::Residual, &[id]);

    let mut early = partial;
    let id = early.residual[0].0.unwrap();
    early.patch.finalized.insert(0, id as u32);
    early.patch.finalized.sort_unstable();
    assert_violates(early.audit(), Check::Vertices, &[id]);
}

fn check_places<const D: usize>(partial: Partial<D>) {
    let mut moved = partial.clone();
    moved.residual[1].1[1] += 1.0;
    let id = moved.residual[1].0.unwrap();
    assert_violates(moved.audit(), Check::Residual, &[id, id]);

    let mut twice = partial.clone();
    twice.residual.push(twice.residual[0]);
    let id = twice.residual[0].0.unwrap();
    assert_violates(twice.audit(), Check::Residual, &[id]);

    let mut coincident = partial;
    coincident.residual.push(*coincident.residual.last().unwrap());
    assert_violates(coincident.audit(), Check::Residual, &[]);
}

fn check_region<const D: usize>(mut partial: Partial<D>) {
    partial.residual.last_mut().unwrap().1[D - 1] = partial.region.max[D - 1];
    assert_violates(partial.audit(), Check::Region, &[]);
}

fn check_counts<const D: usize>(mut partial: Partial<D>) {
    partial.residual.pop();
    assert_violates(partial.audit(), Check::Counts, &[]);
}

impl<const D: usize> Partial<D> {
    /// Adds a residual point that no vertex has been made of.
    fn with(mut self, at: Point) -> Self {
        self.residual.push((None, at));
        self.input_points += 1;
        self
    }
}

/// The points are near the centre of what is final, far from the balls of simplices at walls.
fn check_cover<const D: usize>(partial: Partial<D>) {
    let near = |middle: f64| {
        let at = std::array::from_fn(|axis| if axis < D { middle + 0.01 * axis as f64 } else { 0.0 });
        partial.clone().with(at).audit()
    };
    let middle = if D == 2 { 2.47 } else { 0.97 };
    assert!(
        matches!(near(middle), Err(Verdict::Violation(v)) if [Check::Residual, Check::Delaunay].contains(&v.check))
    );
}

/// Beyond each wall there is a point that no final simplex covers, but one has in its ball.
fn check_balls<const D: usize>(mut partial: Partial<D>) {
    partial.region = Region::EVERYTHING;
    for wall in &partial.walls {
        let corners = wall.map(|corner| partial.residual[corner as usize].1);
        let middle: Point =
            std::array::from_fn(|axis| corners.iter().map(|at| at[axis]).sum::<f64>() / D as f64);
        let centre = if D == 2 { [2.5, 2.5, 0.0] } else { [1.0; 3] };
        let beyond = std::array::from_fn(|axis| middle[axis] + (middle[axis] - centre[axis]) * 1e-3);
        let found = partial.clone().with(beyond).audit();
        let Err(Verdict::Violation(violation)) = found else { panic!("{beyond:?} passes") };
        assert_eq!(violation.check, Check::Delaunay, "{beyond:?}: {}", violation.message);
    }
}

fn check_orientation<const D: usize>(mut partial: Partial<D>) {
    partial.patch.simplices.swap(0, 1);
    assert!(matches!(partial.audit(), Err(Verdict::Violation(v)) if v.check == Check::Orientation));
}

/// Two points of the plane coincide if they agree in x and y, whatever their elevations.
#[test]
fn residual_points_of_the_plane_differ_in_x_or_y() {
    let mut partial = plane();
    let (_, [x, y, z]) = *partial.residual.last().unwrap();
    partial.residual.push((None, [x, y, z + 1.0]));
    assert_violates(partial.audit(), Check::Residual, &[]);
}
