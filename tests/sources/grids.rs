//! The common grid of files whose scales and offsets differ.

use std::path::PathBuf;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Input, SourceOptions};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

use super::las_file::LasFile;
use super::{assert_fails, flat, pass, points, sample};
use crate::programs::{Folder, run};

/// Opens files with these scales and offsets and the same positions.
fn open(
    grids: &[([f64; 3], [f64; 3])],
    positions: &[[i32; 3]],
    options: &SourceOptions,
) -> Result<(Coordinates, Vec<Point>)> {
    let folder = Folder::new();
    let file = |(index, &(scale, offset)): (usize, &([f64; 3], [f64; 3]))| -> PathBuf {
        folder.file(&format!("{index}.las"), LasFile { scale, offset, ..LasFile::of(positions) }.bytes())
    };
    let paths: Vec<PathBuf> = grids.iter().enumerate().map(file).collect();
    let input = Input::open(&paths, options)?;
    Ok((input.description().coordinates, pass(&input)?))
}

#[test]
fn axes_of_geometry_get_one_quantum() {
    let grid = ([0.001, 0.00025, 0.01], [10.0, 20.0, 30.0]);
    let (coordinates, found) = open(&[grid], &[[3, 5, 7]], &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::I32 { scale: [0.00025, 0.00025, 0.01], offset: grid.1 });
    assert_eq!(found, [[12.0, 5.0, 7.0]]);
    let solid = SourceOptions { dims: 3, ..SourceOptions::default() };
    let (coordinates, found) = open(&[grid], &[[3, 5, 7]], &solid).unwrap();
    assert_eq!(coordinates, Coordinates::I32 { scale: [0.00025; 3], offset: grid.1 });
    assert_eq!(found, [[12.0, 5.0, 280.0]]);
}

#[test]
fn scales_of_halves_and_thirds_meet_in_sixths() {
    let (coordinates, found) = open(&[([0.03, 0.02, 0.01], [0.0; 3])], &[[1, 1, 1]], &flat()).unwrap();
    let Coordinates::I32 { scale, .. } = coordinates else { panic!("{coordinates:?}") };
    assert!((scale[0] - 0.01).abs() < 1e-12 && scale[0] == scale[1]);
    assert_eq!(found, [[3.0, 2.0, 1.0]]);
}

#[test]
fn axes_without_common_measure_become_world_coordinates() {
    let scale = [1.16451354e-6, 1.164510015e-6, 0.01];
    let (coordinates, found) = open(&[(scale, [5.0, 6.0, 7.0])], &[[10, 20, 30]], &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::F64);
    assert_eq!(found, [[10.0 * scale[0] + 5.0, 20.0 * scale[1] + 6.0, 30.0 * scale[2] + 7.0]]);
}

#[test]
fn axes_whose_common_grid_is_too_fine_become_world_coordinates() {
    let grid = ([1.0, 0.001, 0.01], [0.0; 3]);
    let (coordinates, _) = open(&[grid], &[[-2_000_000_000, 0, 0], [2_000_000_000, 1, 1]], &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::F64);
}

#[test]
fn files_meet_on_the_finest_grid() {
    let grids = [([0.01; 3], [100.0, 0.0, 0.0]), ([0.001; 3], [100.5, -3.0, 0.0])];
    let (coordinates, found) = open(&grids, &[[7, 8, 9]], &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::I32 { scale: [0.001; 3], offset: [100.0, 0.0, 0.0] });
    assert_eq!(found, [[70.0, 80.0, 90.0], [507.0, -2992.0, 9.0]]);
}

#[test]
fn an_offset_that_does_not_fit_is_moved_by_whole_steps() {
    let positions = [[2_000_000_000, 0, 0], [2_000_000_001, 5, 0]];
    let grids = [([0.01; 3], [0.0; 3]), ([0.01; 3], [10_000_000.0, 0.0, 0.0])];
    let (coordinates, found) = open(&grids, &positions, &flat()).unwrap();
    let Coordinates::I32 { offset, .. } = coordinates else { panic!("{coordinates:?}") };
    let world: Vec<f64> = found.iter().map(|point| coordinates.to_world(*point)[0]).collect();
    assert!(offset[0] > 0.0 && found.iter().all(|point| coordinates.can_store(point[0])));
    for (found, expected) in world.iter().zip([2e7, 2e7 + 0.01, 3e7, 3e7 + 0.01]) {
        assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
    }
}

#[test]
fn files_without_a_common_grid_are_named() {
    let expected = ["0.las", "1.las", "--scale", "--offset"];
    let offsets = [([0.01; 3], [0.0; 3]), ([0.01; 3], [0.00512345678, 0.0, 0.0])];
    assert_fails(open(&offsets, &[[1, 1, 1]], &flat()), ErrorKind::Usage, &expected);
    let scales = [([0.01; 3], [0.0; 3]), ([0.01000000001; 3], [0.0; 3])];
    assert_fails(open(&scales, &[[1, 1, 1]], &flat()), ErrorKind::Usage, &expected);
    let options = SourceOptions { grid: Some(([0.001; 3], [0.0; 3])), ..flat() };
    let (_, found) = open(&offsets, &[[1, 1, 1]], &options).unwrap();
    assert_eq!(found, [[10.0, 10.0, 10.0], [15.0, 10.0, 10.0]]);
}

#[test]
fn offsets_between_grid_points_make_a_finer_grid() {
    let grids = [([0.01; 3], [0.0; 3]), ([0.01; 3], [0.005, 0.0, 0.0]), ([0.01; 3], [1e6, 4e6, 0.002])];
    let (coordinates, found) = open(&grids, &[[1, 1, 1]], &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::I32 { scale: [0.005, 0.005, 0.002], offset: [0.0; 3] });
    assert_eq!(found, [[2.0, 2.0, 5.0], [3.0, 2.0, 5.0], [200_000_002.0, 800_000_002.0, 6.0]]);
    let solid = SourceOptions { dims: 3, ..SourceOptions::default() };
    let (coordinates, _) = open(&grids, &[[1, 1, 1]], &solid).unwrap();
    // 4,000,000 metres are too many millimetres for 32 bits: the grid has its origin in the middle.
    assert_eq!(
        coordinates,
        Coordinates::I32 { scale: [0.001; 3], offset: [500_000.01, 2_000_000.01, 0.011] }
    );
}

#[test]
fn of_many_files_those_that_conflict_are_named() {
    let far = [[2_000_000_000, 0, 0]];
    // The third and the fourth lie too far apart for a common grid; the others go with each of them.
    let near = ([0.01; 3], [0.0; 3]);
    let grids = [near, near, ([0.01; 3], [-4e7, 0.0, 0.0]), ([0.01; 3], [4e7, 0.0, 0.0]), near];
    let error = open(&grids, &far, &flat());
    assert_fails(error, ErrorKind::Usage, &["2.las and ", "3.las have no common grid", "--scale"]);
    // Each two of these have a common grid, the third with the first in steps of 0.0001.
    let wide = [[2_000_000_000, 0, 0], [-2_000_000_000, 0, 0]];
    let offsets = [0.0, 0.01, 0.02].map(|x| ([0.01; 3], [x, 0.0, 0.0]));
    assert!(open(&offsets, &wide, &flat()).is_ok());
}

#[test]
fn scales_count_as_equal_only_if_no_point_moves_for_it() {
    let grids = |error: f64| [([0.01; 3], [0.0; 3]), ([0.01 * (1.0 + error); 3], [0.0; 3])];
    let far = [[i32::MAX, i32::MIN, 7]];
    let (coordinates, found) = open(&grids(1e-13), &far, &flat()).unwrap();
    assert_eq!(found[0], found[1]);
    assert!((coordinates.to_world(found[1])[0] - f64::from(i32::MAX) * grids(1e-13)[1].0[0]).abs() < 1e-4);
    assert_fails(open(&grids(1e-11), &far, &flat()), ErrorKind::Usage, &["0.las", "1.las", "--scale"]);
    let uneven = [0.01, 0.01 * (1.0 + 1e-11), 0.01];
    let (coordinates, _) = open(&[(uneven, [0.0; 3])], &far, &flat()).unwrap();
    assert_eq!(coordinates, Coordinates::F64);
}

#[test]
fn a_given_grid_rounds_to_nearest_and_refuses_what_it_cannot_hold() {
    let folder = Folder::new();
    let path = folder.file("a.xyz", "1.24 -1.26 3\n5e9 0 0\n");
    let options = SourceOptions { grid: Some(([0.5; 3], [0.0; 3])), ..flat() };
    let path = std::slice::from_ref(&path);
    assert_fails(points(path, &options), ErrorKind::Usage, &["a.xyz", "line 2", "beyond 32 bits"]);
    let bounds = Some(Bounds { min: [-10.0; 3], max: [10.0; 3] });
    assert_eq!(points(path, &SourceOptions { bounds, ..options }).unwrap(), [[2.0, -3.0, 6.0]]);
    let uneven = SourceOptions { grid: Some(([0.5, 0.25, 1.0], [0.0; 3])), ..flat() };
    assert_fails(points(path, &uneven), ErrorKind::Usage, &["must be equal"]);
}

#[test]
fn streams_are_sources_with_their_own_coordinates() {
    let folder = Folder::new();
    let coordinates = Coordinates::I32 { scale: [0.25; 3], offset: [1.0, 2.0, 3.0] };
    let header = Header::new(Kind::Points, coordinates, 2, true);
    let expected = [[4.0, 5.0, 6.0], [-7.0, 8.0, 9.0]];
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.points(&expected).unwrap();
    let bytes = writer.end(0, 0).unwrap();
    let path = folder.file("a.spm", &bytes);
    let input = Input::open(&[path], &flat()).unwrap();
    assert_eq!(input.description().coordinates, coordinates);
    assert_eq!(pass(&input).unwrap(), expected);
    let cut = folder.file("cut.spm", &bytes[..bytes.len() - 1]);
    assert_fails(points(&[cut], &flat()), ErrorKind::Malformed, &["cut.spm", "truncated"]);
}

#[test]
fn text_twins_are_streams_too() {
    let folder = Folder::new();
    let tile = sample("hextest.las");
    let stream = run("spfinalize", &["--cell-points", "3", tile.to_str().unwrap()], &[]).stdout;
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], &stream).stdout).unwrap();
    assert!(twin.starts_with("#spmesh version 2\n"), "{twin}");
    let (stream, whole) = (folder.file("a.spm", &stream), folder.file("a.txt", &twin));
    let [a, b] = [&stream, &whole].map(|path| Input::open(std::slice::from_ref(path), &flat()).unwrap());
    assert_eq!(a.description().coordinates, b.description().coordinates);
    assert_eq!(a.description().crs, b.description().crs);
    assert_eq!(a.description().stated_points, b.description().stated_points);
    assert_eq!(pass(&a).unwrap(), pass(&b).unwrap());
    for (at, _) in twin.match_indices('\n').filter(|&(at, _)| at + 1 < twin.len()) {
        let cut = folder.file("cut.txt", &twin[..=at]);
        assert_fails(points(&[cut], &flat()), ErrorKind::Malformed, &["cut.txt"]);
    }
    let mesh = run("spdelaunay2d", &[stream.to_str().unwrap()], &[]).stdout;
    let converted = |format: &str| folder.file("mesh", run("spconvert", &["--to", format], &mesh).stdout);
    assert_fails(points(&[converted("text")], &flat()), ErrorKind::Usage, &["mesh: is a"]);
    // The points of a mesh file are its vertices.
    for format in ["obj", "sma", "ply"] {
        assert_eq!(points(&[converted(format)], &flat()).unwrap().len(), 8, "{format}");
    }
}

/// A file without points has a grid that no point needs.
#[test]
fn files_without_points_need_no_common_grid() {
    let folder = Folder::new();
    let grid = |scale: f64, offset: f64| LasFile {
        scale: [scale; 3],
        offset: [offset, 0.0, 0.0],
        ..LasFile::of(&[[1, 1, 1]])
    };
    let points = folder.file("points.las", grid(0.01, 0.0).bytes());
    let nothing = LasFile { records: Vec::new(), ..grid(0.001, 0.00512345678) };
    let nothing = folder.file("nothing.las", nothing.bytes());
    for paths in [[&points, &nothing], [&nothing, &points]] {
        let input = Input::open(&paths.map(Clone::clone), &flat()).unwrap();
        let expected = Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] };
        assert_eq!(input.description().coordinates, expected);
        assert_eq!(pass(&input).unwrap(), [[1.0; 3]]);
    }
    let input = Input::open(&[nothing.clone(), nothing], &flat()).unwrap();
    assert!(pass(&input).unwrap().is_empty());
}
