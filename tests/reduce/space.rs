//! The set of tetrahedra is that of the kernel over all points at once, however the input comes.

use spmesh_audit::{Audit, Given, PointSet, Standard};
use spmesh_base::error::ErrorKind;
use spmesh_pipeline::reduce::{Duplicates, Options};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, StreamReader};

use super::solids::{bits, every_node, expected, fits_a_grid, read_mesh, tetrahedralize};
use super::streams::{GRID, Tagging, stream_of};
use spmesh_reference::clouds::{FAMILIES, Family, mixture, of};
use spmesh_reference::sets::Random;

const TAGGINGS: [Tagging; 9] = [
    Tagging::None,
    Tagging::Never,
    Tagging::Chunked(0),
    Tagging::Chunked(1),
    Tagging::Chunked(2),
    Tagging::Chunked(3),
    Tagging::Ragged,
    Tagging::Preserved(2),
    Tagging::Forgetful(2),
];

/// Runs the exact audit, which uses neither the predicates nor the kernels.
pub fn assert_proven(mesh: &[u8], points: &[Point], coordinates: Coordinates) {
    let mut given = PointSet::new(coordinates, 3);
    given.extend(points);
    let given = given.finish(&coordinates).unwrap();
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let mut audit = Audit::new(reader.header(), Standard::Canonical, Some(Given::All(given))).unwrap();
    while let Some(event) = reader.next_event().unwrap() {
        audit.event(&event).unwrap();
    }
}

fn assert_same_set(points: &[Point], taggings: &[Tagging], random: &mut Random, what: &str) {
    let tetrahedra = expected(points);
    let mut distinct: Vec<_> = points.iter().map(|&point| bits(point)).collect();
    distinct.sort_unstable();
    distinct.dedup();
    for &tagging in taggings {
        let coordinates =
            if fits_a_grid(points) && tagging != Tagging::Ragged { GRID } else { Coordinates::F64 };
        let mut shuffled = points.to_vec();
        random.shuffle(&mut shuffled);
        let input = stream_of(3, &shuffled, coordinates, tagging, random);
        let (one, stats) = tetrahedralize(&input, &every_node(1)).unwrap();
        let (set, vertices) = read_mesh(&one);
        assert!(set == tetrahedra, "{what}, {tagging:?}: {} of {}", set.len(), tetrahedra.len());
        assert_eq!(vertices, distinct.len(), "{what}, {tagging:?}");
        assert_eq!(stats.vertices + stats.merged, points.len() as u64);
        assert_eq!(stats.simplices, tetrahedra.len() as u64);
        let (three, _) = tetrahedralize(&input, &every_node(3)).unwrap();
        assert!(one == three, "{what}, {tagging:?}: the stream depends on the number of threads");
        let lazy = Options { threads: 2, ..Options::default() };
        let (lazy, _) = tetrahedralize(&input, &lazy).unwrap();
        assert!(
            read_mesh(&lazy).0 == tetrahedra,
            "{what}, {tagging:?}, with nodes that pass their points up"
        );
        if !tetrahedra.is_empty() && points.len() < 60 {
            assert_proven(&one, points, coordinates);
        }
    }
}

#[test]
fn no_family_depends_on_cells() {
    for (number, family) in FAMILIES.into_iter().enumerate() {
        for count in [20, 90] {
            let mut random = Random::new((number * 1000 + count) as u64);
            let points = of(&mut random, family, count);
            assert_same_set(&points, &TAGGINGS, &mut random, &format!("{family:?} of {count}"));
        }
    }
}

#[test]
fn larger_sets_do_not_depend_on_cells() {
    let taggings = [Tagging::Chunked(2), Tagging::Ragged, Tagging::Forgetful(2)];
    for family in
        [Family::Uniform, Family::Cubic, Family::BodyCentered, Family::RoundedSphere, Family::Cluster]
    {
        let mut random = Random::new(family as u64);
        let points = of(&mut random, family, 2500);
        assert_same_set(&points, &taggings, &mut random, &format!("{family:?}"));
    }
}

#[test]
fn mixtures_equal_the_kernel() {
    for seed in 0..60 {
        let mut random = Random::new(7000 + seed);
        let points = mixture(&mut random, 10 + 4 * seed as usize);
        let tagging = [Tagging::Ragged, Tagging::Chunked(2), Tagging::Forgetful(3)][seed as usize % 3];
        assert_same_set(&points, &[tagging], &mut random, &format!("mixture {seed}"));
    }
}

#[test]
fn few_points_and_no_tetrahedra_are_valid_streams() {
    let sets: [&[Point]; 7] = [
        &[],
        &[[5.0, 5.0, 5.0]],
        &[[5.0, 5.0, 0.0], [7.0, 1.0, 3.0]],
        &[[0.0, 0.0, 1.0], [1.0, 1.0, 1.0], [2.0, 2.0, 1.0]],
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [8.0, 8.0, 0.0], [3.0, 3.0, 0.0]],
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0], [2.0, 2.0, 2.0]],
    ];
    for points in sets {
        assert_same_set(points, &TAGGINGS, &mut Random::new(1), &format!("{points:?}"));
    }
}

#[test]
fn coinciding_points_are_one_vertex_or_an_error() {
    let mut random = Random::new(4);
    let integer = |random: &mut Random| random.integer(0, 4) as f64;
    let points: Vec<Point> = (0..300).map(|_| [(); 3].map(|()| integer(&mut random))).collect();
    assert_same_set(&points, &TAGGINGS, &mut random, "a crowded grid");
    let equal = vec![[4.0, 2.0, 1.0]; 50];
    let input = stream_of(3, &equal, GRID, Tagging::Chunked(2), &mut random);
    let (bytes, stats) = tetrahedralize(&input, &every_node(2)).unwrap();
    assert_eq!((stats.vertices, stats.merged, stats.simplices), (1, 49, 0));
    assert_eq!(read_mesh(&bytes).1, 1);
    for every_node in [false, true] {
        let input = stream_of(3, &points, GRID, Tagging::Chunked(2), &mut random);
        let options = Options { duplicates: Duplicates::Error, threads: 2, every_node, ..Options::default() };
        let failure = tetrahedralize(&input, &options).unwrap_err();
        assert_eq!(failure.kind(), ErrorKind::Malformed);
        assert!(failure.to_string().contains("several points at x "), "{failure}");
    }
}

#[test]
fn memory_follows_the_faces_of_cells() {
    let mut random = Random::new(3);
    let points = of(&mut random, Family::Uniform, 40_000);
    let input = stream_of(3, &points, Coordinates::F64, Tagging::Chunked(2), &mut random);
    let (_, stats) = tetrahedralize(&input, &every_node(1)).unwrap();
    assert_eq!(stats.untagged, 0);
    assert!(stats.held_max < 1000, "held {} points", stats.held_max);
    assert!(stats.residual_max < 30_000, "{} residual points waited", stats.residual_max);
}

#[test]
fn damaged_streams_are_refused() {
    let mut random = Random::new(11);
    let points = of(&mut random, Family::Integers, 700);
    let input = stream_of(3, &points, GRID, Tagging::Chunked(2), &mut random);
    for threads in [1, 3] {
        for part in 1..16 {
            let at = input.len() * part / 16;
            let cut = tetrahedralize(&input[..at], &every_node(threads)).unwrap_err();
            assert_eq!(cut.kind(), ErrorKind::Malformed, "{threads} threads, cut at {at}: {cut}");
            let mut damaged = input.clone();
            damaged[at] ^= 1;
            let flipped = tetrahedralize(&damaged, &every_node(threads)).unwrap_err();
            assert_eq!(flipped.kind(), ErrorKind::Malformed, "{threads} threads, bit at {at}: {flipped}");
        }
    }
    let planar = stream_of(2, &points, GRID, Tagging::None, &mut random);
    let refused = tetrahedralize(&planar, &every_node(1)).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Usage);
    assert!(refused.to_string().contains("with --octree"), "{refused}");
}

/// All points wait for the root, which several threads triangulate: there are enough for three.
#[test]
fn a_shared_root_has_the_same_bytes() {
    let mut random = Random::new(7);
    let points = of(&mut random, Family::Uniform, 75_000);
    let input = stream_of(3, &points, Coordinates::F64, Tagging::None, &mut random);
    let (one, _) = tetrahedralize(&input, &every_node(1)).unwrap();
    assert_eq!(read_mesh(&one).0, expected(&points));
    for threads in [2, 3] {
        let (shared, _) = tetrahedralize(&input, &every_node(threads)).unwrap();
        assert!(one == shared, "{threads} threads");
    }
}

/// Two boxes with wavy sheets, each a node, in a cube that is far larger than they are.
#[test]
fn points_on_surfaces_wait_for_the_root_if_there_is_memory() {
    let mut random = Random::new(8);
    let mut points: Vec<Point> = vec![[0.0; 3], [3.9; 3]];
    for column in [1.0, 2.0] {
        points.extend((0..55_000).map(|i| {
            let [x, y] = [random.unit(), random.unit()];
            let wave = 0.4 * (7.0 * x).sin() * (9.0 * y).sin();
            [column + x, 1.0 + y, 1.0 + (f64::from(i % 4) + 0.5 + wave) / 4.0]
        }));
    }
    let input = stream_of(3, &points, Coordinates::F64, Tagging::Chunked(2), &mut random);
    let run = |threads, megabytes: Option<u64>| {
        let memory = megabytes.map(|megabytes| megabytes << 20);
        tetrahedralize(&input, &Options { threads, memory, ..Options::default() }).unwrap()
    };
    let (whole, stats) = run(1, None);
    assert_eq!(stats.root_points, points.len() as u64);
    assert!(whole == run(3, None).0, "the bytes depend on threads");
    let (parts, stats) = run(1, Some(80));
    assert!(stats.root_points < points.len() as u64 * 9 / 10, "{} points waited", stats.root_points);
    let tetrahedra = expected(&points);
    assert!(read_mesh(&whole).0 == tetrahedra && read_mesh(&parts).0 == tetrahedra);
}
