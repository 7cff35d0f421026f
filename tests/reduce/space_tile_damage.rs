//! Merging refuses partial meshes of space that are damaged or do not fit together.

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::reduce::{Options, Part};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamReader, StreamWriter};

use super::solids::{expected, read_mesh, tetrahedralize};
use super::space_tiles::{merge, partial};
use super::streams::{GRID, Tagging, stream_of};
use spmesh_reference::clouds::{Family, of};
use spmesh_reference::sets::Random;

const HALVES: [Region<3>; 2] = [
    Region { min: [f64::NEG_INFINITY; 3], max: [0.0, f64::INFINITY, f64::INFINITY] },
    Region { min: [0.0, f64::NEG_INFINITY, f64::NEG_INFINITY], max: [f64::INFINITY; 3] },
];

fn points() -> Vec<Point> {
    of(&mut Random::new(11), Family::Integers, 400)
}

/// The parts left and right of x = 0.
fn halves(points: &[Point], coordinates: Coordinates) -> [Vec<u8>; 2] {
    let input = stream_of(3, points, coordinates, Tagging::Chunked(1), &mut Random::new(2));
    let options = Options { threads: 1, every_node: true, ..Options::default() };
    HALVES.map(|region| partial(&input, Part::Region(region), &options).0)
}

/// A partial mesh taken apart.
#[derive(Clone)]
struct Pieces {
    header: Header,
    patches: Vec<Patch>,
    residual: Vec<(Option<u64>, Point)>,
    walls: Vec<[u32; 3]>,
    points: u64,
    merged: u64,
}

impl Pieces {
    fn of(bytes: &[u8]) -> Pieces {
        let mut reader = StreamReader::new(bytes, "part").unwrap();
        let mut pieces = Pieces {
            header: reader.header().clone(),
            patches: Vec::new(),
            residual: Vec::new(),
            walls: Vec::new(),
            points: 0,
            merged: 0,
        };
        while let Some(event) = reader.next_event().unwrap() {
            match event {
                Event::Patch(patch) => pieces.patches.push(patch),
                Event::ResidualPoints(points) => pieces.residual.extend(points),
                Event::Walls(walls) => pieces.walls.extend_from_slice(walls.as_chunks().0),
                Event::End(totals) => (pieces.points, pieces.merged) = (totals.points, totals.merged),
                other => panic!("{other:?} in a partial mesh"),
            }
        }
        pieces
    }

    /// The stream of the pieces, with checksums that fit.
    fn stream(&self) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), self.header.clone()).unwrap();
        self.patches.iter().for_each(|patch| writer.patch(patch).unwrap());
        writer.residual_points(&self.residual).unwrap();
        writer.walls(self.walls.as_flattened()).unwrap();
        writer.end(self.points, self.merged).unwrap()
    }
}

/// Asserts that merging the pieces with the other half fails as malformed, with these words.
#[track_caller]
fn assert_malformed(pieces: &Pieces, other: &[u8], words: &str) {
    let error = merge(&[pieces.stream(), other.to_vec()], None).map(drop).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

#[test]
fn cut_and_changed_streams_are_refused() {
    let [left, right] = halves(&points(), GRID);
    for part in 0..64 {
        let at = left.len() * part / 64;
        let cut = merge(&[left[..at].to_vec(), right.clone()], None).map(drop).unwrap_err();
        assert_eq!(cut.kind(), ErrorKind::Malformed, "cut at {at}: {cut}");
        let mut damaged = right.clone();
        damaged[right.len() * part / 64] ^= 1 << (part % 8);
        let flipped = merge(&[left.clone(), damaged], None).map(drop).unwrap_err();
        assert_eq!(flipped.kind(), ErrorKind::Malformed, "bit of part {part}: {flipped}");
    }
}

#[test]
fn walls_must_close_around_what_is_final() {
    let [left, right] = halves(&points(), GRID);
    let whole = Pieces::of(&left);
    assert!(whole.walls.len() > 20 && merge(&[whole.stream(), right.clone()], None).is_ok());
    for missing in 0..whole.walls.len() {
        let mut pieces = whole.clone();
        pieces.walls.remove(missing);
        assert_malformed(&pieces, &right, "are not the border");
    }
    let mut none = whole.clone();
    none.walls.clear();
    assert_malformed(&none, &right, "are not the border");
    let mut reversed = whole.clone();
    reversed.walls.iter_mut().for_each(|wall| wall.reverse());
    assert_malformed(&reversed, &right, "are not the border");
    let mut twice = whole.clone();
    twice.walls.extend_from_within(..);
    assert_malformed(&twice, &right, "are not the border");
    let mut lost = whole.clone();
    let patch = lost.patches.iter_mut().find(|patch| patch.simplices.len() > 4).unwrap();
    patch.simplices.truncate(patch.simplices.len() - 4);
    assert_malformed(&lost, &right, "are not the border");
}

/// Changing corners of walls gives an error or does not change the mesh.
#[test]
fn changed_walls_make_no_other_mesh() {
    let points = points();
    let (tetrahedra, [left, right]) = (expected(&points), halves(&points, GRID));
    let whole = Pieces::of(&left);
    let mut random = Random::new(3);
    let mut below = |count: usize| random.integer(0, count as i64 - 1) as usize;
    let mut refused = 0;
    for _ in 0..200 {
        let mut pieces = whole.clone();
        for _ in 0..=below(3) {
            let (wall, corner) = (below(whole.walls.len()), below(3));
            let other = below(whole.residual.len()) as u32;
            if !pieces.walls[wall].contains(&other) {
                pieces.walls[wall][corner] = other;
            }
        }
        match merge(&[pieces.stream(), right.clone()], None) {
            Ok((mesh, _)) => assert!(read_mesh(&mesh).0 == tetrahedra),
            Err(error) => {
                assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 150, "{refused} of 200 were refused");
}

#[test]
fn residual_points_must_be_what_is_left() {
    let [left, right] = halves(&points(), GRID);
    let whole = Pieces::of(&left);
    let named = whole.residual.iter().position(|(id, _)| id.is_some()).unwrap();

    let mut moved = whole.clone();
    moved.residual[named].1[1] += 1.0;
    assert_malformed(&moved, &right, "is not where vertex");

    let mut nowhere = whole.clone();
    nowhere.residual[named].0 = None;
    nowhere.points += 1;
    assert_malformed(&nowhere, &right, "were finalized or handed to the residual");

    let mut outside = whole.clone();
    outside.residual.push((None, [0.0, 3.0, 4.0]));
    outside.points += 1;
    assert_malformed(&outside, &right, "outside of");

    let mut twice = whole.clone();
    twice.residual.push((None, whole.residual[0].1));
    twice.points += 1;
    assert_malformed(&twice, &right, "coincides with");
}

#[test]
fn a_residual_point_in_a_final_tetrahedron_is_refused() {
    let region = Some(Region { min: [-100.0; 3], max: [100.0; 3] });
    let mut header = Header::new(Kind::PartialTetrahedralMesh, GRID, 3, false);
    header.region = region;
    let corners = vec![[0.0; 3], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]];
    let mut residual: Vec<_> = (0..).zip(&corners).map(|(id, &at)| (Some(id), at)).collect();
    residual.push((None, [5.0, 5.0, 5.0]));
    let patch = Patch { new: corners, simplices: vec![0, 1, 2, 3], ..Patch::default() };
    let walls = vec![[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];
    let mut pieces = Pieces { header, patches: vec![patch], residual, walls, points: 5, merged: 0 };
    let error = merge(&[pieces.stream()], None).map(drop).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
    pieces.residual.pop();
    pieces.points = 4;
    let (mesh, _) = merge(&[pieces.stream()], None).unwrap();
    assert_eq!(read_mesh(&mesh).0.len(), 1);
}

#[test]
fn parts_that_do_not_go_together_are_refused() {
    let points = points();
    let [left, right] = halves(&points, GRID);
    let usage = |parts: &[Vec<u8>], region: Option<Region<3>>, words: &str| {
        let error = merge(parts, region).map(drop).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
        assert!(error.to_string().contains(words), "{error}");
    };
    usage(&[], None, "nothing to merge");
    usage(&[left.clone(), left.clone()], None, "overlap");
    usage(&[left.clone(), right.clone()], Some(HALVES[0]), "is not inside of the given one");
    let empty = Region { min: [0.0, 0.0, 1.0], max: [1.0; 3] };
    usage(std::slice::from_ref(&left), Some(empty), "the region is empty");
    usage(
        &[left.clone(), halves(&points, Coordinates::F64)[1].clone()],
        None,
        "differ in their coordinate grid",
    );
    let whole = stream_of(3, &points, GRID, Tagging::None, &mut Random::new(1));
    usage(std::slice::from_ref(&whole), None, "--merge takes results of --partial");

    let plane = stream_of(2, &points, GRID, Tagging::None, &mut Random::new(1));
    let options = Options { part: Some(Part::Region(Region::PLANE)), ..super::streams::threads(1) };
    let (plane, _) = super::streams::triangulate(&plane, &options).unwrap();
    usage(std::slice::from_ref(&plane), None, "merge it with spdelaunay2d");
    let readers = vec![StreamReader::new(&left[..], "part").unwrap()];
    let error = spmesh_pipeline::reduce::merge_triangles(readers, Vec::new(), &Default::default(), |_| ())
        .map(drop)
        .unwrap_err();
    assert!(error.to_string().contains("merge it with spdelaunay3d"), "{error}");
    let again = tetrahedralize(&left, &Options { threads: 1, ..Options::default() }).unwrap_err();
    assert!(again.to_string().contains("use --merge to finish it"), "{again}");
}
