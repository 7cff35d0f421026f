//! Duplicates, and inputs that the reduction must refuse.

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::reduce::{Duplicates, Options, Part};
use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Header, Kind, Patch, StreamReader, StreamWriter};

use super::streams::{GRID, Tagging, read_mesh, stream, threads, triangulate};
use spmesh_reference::sets::Random;

#[test]
fn the_policy_chooses_the_elevation() {
    let corners: [Point; 3] = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];
    let same: [Point; 3] = [[30.0, 30.0, 8.0], [30.0, 30.0, 3.0], [30.0, 30.0, 9.0]];
    let points = [&corners[..], &same].concat();
    for (duplicates, elevation) in [
        (Duplicates::First, 8.0),
        (Duplicates::Lowest, 3.0),
        (Duplicates::Highest, 9.0),
        (Duplicates::Mean, 7.0),
    ] {
        let taggings = [Tagging::None, Tagging::Never, Tagging::Chunked(3), Tagging::Preserved(2)];
        for tagging in taggings {
            let input = stream(&points, GRID, tagging, &mut Random::new(5));
            let options = Options { duplicates, ..threads(2) };
            let (bytes, stats) = triangulate(&input, &options).unwrap();
            assert_eq!(stats.merged, 2);
            let mesh = read_mesh(&bytes);
            assert!(mesh.vertices.contains(&[30.0, 30.0, elevation]), "{duplicates:?}: {:?}", mesh.vertices);
            assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (4, 3));
        }
    }
    let input = stream(&points, GRID, Tagging::None, &mut Random::new(5));
    let options = Options { duplicates: Duplicates::Error, ..threads(1) };
    assert_eq!(triangulate(&input, &options).unwrap_err().kind(), ErrorKind::Malformed);
}

#[test]
fn coinciding_points_may_come_late_and_meet_residuals() {
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let points: Vec<Point> = (0..600)
            .map(|i| [random.integer(0, 15) as f64, random.integer(0, 15) as f64, f64::from(i)])
            .collect();
        let reference = stream(&points, GRID, Tagging::None, &mut random);
        let lowest = Options { duplicates: Duplicates::Lowest, ..threads(2) };
        let reference = read_mesh(&triangulate(&reference, &lowest).unwrap().0);
        for tagging in [Tagging::Ragged, Tagging::Forgetful(3), Tagging::Never] {
            let input = stream(&points, GRID, tagging, &mut random);
            let mesh = read_mesh(&triangulate(&input, &lowest).unwrap().0);
            assert_eq!(mesh.triangles, reference.triangles, "{tagging:?}, seed {seed}");
            let sorted = |mut vertices: Vec<Point>| {
                vertices.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
                vertices
            };
            assert_eq!(sorted(mesh.vertices), sorted(reference.vertices.clone()));
        }
    }
}

fn tagged_points() -> StreamWriter<Vec<u8>> {
    let mut header = Header::new(Kind::Points, GRID, 2, false);
    header.tree = CellTree::covering(&Bounds { min: [0.0; 3], max: [100.0; 3] }, 2, 2);
    StreamWriter::new(Vec::new(), header).unwrap()
}

#[test]
fn a_point_in_a_final_cell_is_refused() {
    let mut writer = tagged_points();
    let cell = writer.header().tree.unwrap().cell_of([1.0, 1.0, 0.0], 2);
    writer.cells(&[cell]).unwrap();
    writer.points(&[[1.0, 1.0, 0.0]]).unwrap();
    let error = triangulate(&writer.end(0, 0).unwrap(), &threads(1)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
    assert!(error.to_string().contains("block 1 at byte"), "{error}");
}

#[test]
fn a_cell_is_final_once() {
    let mut writer = tagged_points();
    writer.cells(&[CellCode::ROOT, CellCode::ROOT]).unwrap();
    let error = triangulate(&writer.end(0, 0).unwrap(), &threads(1)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
}

#[test]
fn input_without_end_gives_no_end() {
    let input = stream(&[[0.0; 3], [1.0, 5.0, 0.0]], GRID, Tagging::None, &mut Random::new(1));
    let error = triangulate(&input[..input.len() - 1], &threads(2)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
}

#[test]
fn other_kinds_are_refused_with_a_remedy() {
    let space = StreamWriter::new(Vec::new(), Header::new(Kind::Points, GRID, 3, false)).unwrap();
    let mesh = StreamWriter::new(Vec::new(), Header::new(Kind::TriangleMesh, GRID, 2, false)).unwrap();
    for (bytes, remedy) in
        [(space.end(0, 0).unwrap(), "--octree"), (mesh.end(0, 0).unwrap(), "expected points")]
    {
        let error = triangulate(&bytes, &threads(1)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains(remedy), "{error}");
    }
}

#[test]
fn a_residual_point_in_a_hole_is_refused() {
    let region = Region { min: [-100.0; 2], max: [100.0; 2] };
    let mut header = Header::new(Kind::PartialTriangleMesh, GRID, 2, false);
    header.region = Some(region.in_space());
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
    let patch = Patch { new: corners.clone(), simplices: vec![0, 1, 2], ..Patch::default() };
    writer.patch(&patch).unwrap();
    let mut residual: Vec<_> = corners.iter().enumerate().map(|(i, &p)| (Some(i as u64), p)).collect();
    residual.push((None, [2.0, 2.0, 0.0]));
    writer.residual_points(&residual).unwrap();
    writer.walls(&[0, 1, 1, 2, 2, 0]).unwrap();
    let error = merge(&[&writer.end(4, 0).unwrap()]).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
    assert!(error.to_string().contains("inside of a final triangle"), "{error}");
}

#[test]
fn walls_are_the_border_of_what_is_final() {
    let region = Region { min: [-100.0; 2], max: [100.0; 2] };
    let mut header = Header::new(Kind::PartialTriangleMesh, GRID, 2, false);
    header.region = Some(region.in_space());
    let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
    let walls: [&[u32]; 6] =
        [&[0, 1, 1, 2, 2, 0], &[], &[0, 1, 1, 2], &[1, 0, 2, 1, 0, 2], &[0, 1], &[0, 1, 1, 2, 2, 1]];
    for (number, walls) in walls.into_iter().enumerate() {
        let mut writer = StreamWriter::new(Vec::new(), header.clone()).unwrap();
        let patch = Patch { new: corners.clone(), simplices: vec![0, 1, 2], ..Patch::default() };
        writer.patch(&patch).unwrap();
        let residual: Vec<_> = (0..).zip(&corners).map(|(id, &at)| (Some(id), at)).collect();
        writer.residual_points(&residual).unwrap();
        writer.walls(walls).unwrap();
        let merged = merge(&[&writer.end(3, 0).unwrap()]);
        match number {
            0 => assert_eq!(read_mesh(&merged.unwrap()).triangles.len(), 1),
            _ => assert!(merged.unwrap_err().to_string().contains("are not the border"), "{walls:?}"),
        }
    }
}

#[test]
fn the_plane_as_the_region_is_a_partial_run_too() {
    let points: Vec<Point> = (0..60).map(|i| [f64::from(i % 8), f64::from(i * i % 61), 0.0]).collect();
    let part = tile(&points, Region::PLANE);
    assert!(read_mesh(&part).residual > 2);
    let whole = stream(&points, GRID, Tagging::None, &mut Random::new(1));
    let whole = read_mesh(&triangulate(&whole, &threads(1)).unwrap().0);
    assert_eq!(read_mesh(&merge(&[&part]).unwrap()).triangles, whole.triangles);
}

fn tile(points: &[Point], region: Region) -> Vec<u8> {
    let input = stream(points, GRID, Tagging::None, &mut Random::new(1));
    let options = Options { part: Some(Part::Region(region)), ..threads(1) };
    triangulate(&input, &options).unwrap().0
}

fn merge(parts: &[&[u8]]) -> spmesh_base::error::Result<Vec<u8>> {
    let readers = parts.iter().map(|part| StreamReader::new(*part, "part")).collect::<Result<_, _>>()?;
    spmesh_pipeline::reduce::merge_triangles(readers, Vec::new(), &Default::default(), |_| ())
        .map(|(bytes, _)| bytes)
}

#[test]
fn a_point_on_a_border_belongs_to_the_upper_tile() {
    // -2345602.11 / 0.01 is not exactly an integer.
    let scale = [0.01; 3];
    let grid = Coordinates::I32 { scale, offset: [0.0; 3] };
    let x = -234_560_211.0;
    let points: Vec<Point> = [[x, 0.0], [x - 5.0, 3.0], [x + 5.0, 7.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
    let input = stream(&points, grid, Tagging::None, &mut Random::new(1));
    let upper = Region { min: [-2_345_602.11, -100.0], max: [f64::INFINITY, 100.0] };
    let lower = Region { min: [f64::NEG_INFINITY, -100.0], max: [-2_345_602.11, 100.0] };
    for (region, expected) in [(upper, 2), (lower, 1)] {
        let options = Options { part: Some(Part::Region(region)), ..threads(1) };
        assert_eq!(triangulate(&input, &options).unwrap().1.points, expected);
    }
}

#[test]
fn tiles_that_overlap_or_are_damaged_are_refused() {
    let points: Vec<Point> = (0..100).map(|i| [f64::from(i % 10), f64::from(i * i % 97), 0.0]).collect();
    let left = tile(&points, Region { min: [-1.0, -1.0], max: [5.0, 100.0] });
    let right = tile(&points, Region { min: [5.0, -1.0], max: [10.0, 100.0] });
    let wide = tile(&points, Region { min: [4.0, -1.0], max: [10.0, 100.0] });
    assert!(merge(&[&left, &right]).is_ok());
    assert_eq!(merge(&[&left, &wide]).unwrap_err().kind(), ErrorKind::Usage);
    assert_eq!(merge(&[&left, &right[..right.len() - 3]]).unwrap_err().kind(), ErrorKind::Malformed);
    assert_eq!(merge(&[]).unwrap_err().kind(), ErrorKind::Usage);
}
