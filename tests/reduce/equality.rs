//! The set of triangles is the same however the input comes.

use spmesh_pipeline::reduce::{Options, Part};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, StreamReader};

use super::streams::{GRID, Mesh, Tagging, read_mesh, stream, threads, triangulate};
use spmesh_reference::incremental;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate, uniform};

const TAGGINGS: [Tagging; 10] = [
    Tagging::None,
    Tagging::Never,
    Tagging::Chunked(0),
    Tagging::Chunked(1),
    Tagging::Chunked(3),
    Tagging::Chunked(5),
    Tagging::Ragged,
    Tagging::Preserved(2),
    Tagging::Preserved(4),
    Tagging::Forgetful(3),
];

fn elevated(points: &[[i64; 2]]) -> Vec<Point> {
    points.iter().map(|p| [p[0] as f64, p[1] as f64, (p[0] ^ p[1]) as f64]).collect()
}

fn expected(points: &[[i64; 2]]) -> Vec<[[i64; 2]; 3]> {
    let mut triangles: Vec<_> = incremental::triangles(points)
        .into_iter()
        .map(|t| t.map(|v| points[v as usize]))
        .map(|t| [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min().unwrap())
        .collect();
    triangles.sort_unstable();
    triangles
}

fn assert_same_set(points: &[[i64; 2]], random: &mut Random, what: &str) {
    let triangles = expected(points);
    for coordinates in [GRID, Coordinates::F64] {
        for tagging in TAGGINGS {
            let mut shuffled = elevated(points);
            random.shuffle(&mut shuffled);
            let input = stream(&shuffled, coordinates, tagging, random);
            let (one, stats) = triangulate(&input, &threads(1)).unwrap();
            let mesh = read_mesh(&one);
            assert_eq!(mesh.triangles, triangles, "{what}, {tagging:?}, {coordinates:?}");
            assert_eq!(mesh.vertices.len(), points.len(), "{what}, {tagging:?}");
            assert_eq!(stats.vertices + stats.merged, points.len() as u64);
            let (three, _) = triangulate(&input, &threads(3)).unwrap();
            assert!(one == three, "{what}, {tagging:?}: the stream depends on the number of threads");
        }
    }
}

#[test]
fn random_sets_do_not_depend_on_cells() {
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let (count, side) =
            [(3, 2), (9, 4), (60, 20), (500, 1000), (700, 40), (2000, 1 << 29)][seed as usize % 6];
        let points = uniform(&mut random, count, side);
        assert_same_set(&points, &mut random, &format!("uniform, seed {seed}"));
    }
}

#[test]
fn degenerate_sets_do_not_depend_on_cells() {
    for family in 0..DEGENERATE_FAMILIES {
        for count in [12, 150, 600] {
            let mut random = Random::new((family * 1000 + count) as u64);
            let points = degenerate(&mut random, family, count);
            assert_same_set(&points, &mut random, &format!("family {family} of {count}"));
        }
    }
}

/// Compares a hundred sets from `make`, cut up at random, with the independent reference.
fn assert_hundred_sets(make: impl Fn(&mut Random, usize, usize) -> Vec<[i64; 2]>) {
    for set in 0..100 {
        let mut random = Random::new(9000 + set as u64);
        let count = if set % 20 == 19 { 5000 } else { 3 + 8 * set };
        let points = make(&mut random, set, count);
        let tagging = [Tagging::Ragged, Tagging::Chunked(4), Tagging::Forgetful(3)][set % 3];
        let input = stream(&elevated(&points), GRID, tagging, &mut random);
        let (mesh, _) = triangulate(&input, &threads(2)).unwrap();
        assert_eq!(read_mesh(&mesh).triangles, expected(&points), "set {set}, {tagging:?}");
    }
}

#[test]
fn a_hundred_random_sets_equal_the_reference() {
    assert_hundred_sets(|random, set, count| uniform(random, count, [40, 1000, 1 << 20, 1 << 29][set % 4]));
}

#[test]
fn a_hundred_degenerate_sets_equal_the_reference() {
    assert_hundred_sets(|random, set, count| degenerate(random, set % DEGENERATE_FAMILIES, count));
}

/// The parts of a run over `tiles x tiles` half-open tiles, merged.
fn tiled(points: &[Point], input: &[u8], borders: &[Vec<f64>; 2], in_rows: bool) -> Mesh {
    let partial = |region: Region| {
        let part = Some(Part::Region(region));
        let (bytes, stats) = triangulate(input, &Options { threads: 2, part, ..Options::default() }).unwrap();
        let inside = points.iter().filter(|&&point| region.contains(point)).count() as u64;
        assert_eq!((stats.points, stats.outside), (inside, points.len() as u64 - inside));
        assert_eq!(read_mesh(&bytes).residual as u64, stats.residual);
        bytes
    };
    let merge = |parts: &[Vec<u8>], region: Option<Region>| {
        let readers = parts.iter().map(|bytes| StreamReader::new(&bytes[..], "part").unwrap()).collect();
        spmesh_pipeline::reduce::merge_triangles(
            readers,
            Vec::new(),
            &Options { part: region.map(Part::Region), ..Options::default() },
            |_| (),
        )
        .unwrap()
        .0
    };
    let mut parts = Vec::new();
    for y in borders[1].windows(2) {
        let tiles = borders[0].windows(2).map(|x| partial(Region { min: [x[0], y[0]], max: [x[1], y[1]] }));
        let tiles: Vec<Vec<u8>> = tiles.collect();
        if in_rows {
            let row = Region { min: [f64::NEG_INFINITY, y[0]], max: [f64::INFINITY, y[1]] };
            parts.push(merge(&tiles, Some(row)));
        } else {
            parts.extend(tiles);
        }
    }
    read_mesh(&merge(&parts, None))
}

#[test]
fn tiles_merge_to_the_same_set() {
    for seed in 0..8 {
        let mut random = Random::new(seed);
        let points = match seed {
            0 => uniform(&mut random, 1500, 1 << 20),
            1 => uniform(&mut random, 900, 32),
            2 => degenerate(&mut random, 0, 1600),
            3 => degenerate(&mut random, 5, 100),
            _ => degenerate(&mut random, seed as usize, 400),
        };
        let elevated = elevated(&points);
        let tagging = [Tagging::None, Tagging::Chunked(3), Tagging::Preserved(2)][seed as usize % 3];
        let input = stream(&elevated, GRID, tagging, &mut random);
        // Borders through points, so that the half-open rule matters.
        let borders: [Vec<f64>; 2] = [0, 1].map(|axis| {
            let mut values: Vec<f64> = (0..3).map(|i| elevated[i * 7 % elevated.len()][axis]).collect();
            values.extend([f64::NEG_INFINITY, f64::INFINITY]);
            values.sort_unstable_by(f64::total_cmp);
            values.dedup();
            values
        });
        for in_rows in [false, true] {
            let mesh = tiled(&elevated, &input, &borders, in_rows);
            assert_eq!(mesh.triangles, expected(&points), "seed {seed}");
            assert_eq!(mesh.vertices.len(), points.len());
        }
    }
}

#[test]
fn cells_of_the_tree_are_tiles_too() {
    let mut random = Random::new(77);
    let points = uniform(&mut random, 800, 1000);
    let input = stream(&elevated(&points), GRID, Tagging::Chunked(4), &mut random);
    let cells = (0..16).map(|i| Part::Cell { level: 2, at: [i % 4, i / 4] });
    let parts: Vec<Vec<u8>> = cells
        .map(|part| {
            triangulate(&input, &Options { threads: 1, part: Some(part), ..Options::default() }).unwrap().0
        })
        .collect();
    let readers = parts.iter().map(|bytes| StreamReader::new(&bytes[..], "part").unwrap()).collect();
    let (bytes, stats) =
        spmesh_pipeline::reduce::merge_triangles(readers, Vec::new(), &Default::default(), |_| ()).unwrap();
    assert_eq!(read_mesh(&bytes).triangles, expected(&points));
    assert_eq!(stats.points, points.len() as u64);
}

#[test]
fn few_points_and_no_triangles_are_valid_streams() {
    let sets: [&[[i64; 2]]; 6] = [
        &[],
        &[[5, 5]],
        &[[5, 5], [7, 1]],
        &[[0, 0], [1, 1], [2, 2]],
        &[[3, 0], [3, 9], [3, 4]],
        &[[1, 0], [5, 0]],
    ];
    for points in sets {
        let mut random = Random::new(1);
        assert_same_set(points, &mut random, &format!("{points:?}"));
    }
    let equal = vec![[4.0, 2.0, 1.0]; 50];
    let input = stream(&equal, GRID, Tagging::Chunked(2), &mut Random::new(2));
    let (bytes, stats) = triangulate(&input, &threads(2)).unwrap();
    assert_eq!((stats.vertices, stats.merged, stats.simplices), (1, 49, 0));
    assert_eq!(read_mesh(&bytes).vertices, [[4.0, 2.0, 1.0]]);
}

#[test]
fn memory_follows_the_width_of_a_chunked_stream() {
    let mut random = Random::new(3);
    let points = elevated(&uniform(&mut random, 40_000, 1 << 28));
    let input = stream(&points, GRID, Tagging::Chunked(3), &mut random);
    let (_, stats) = triangulate(&input, &threads(1)).unwrap();
    assert_eq!(stats.untagged, 0);
    assert!(stats.held_max < 2000, "held {} points", stats.held_max);
    assert!(stats.residual_max < 12_000, "{} residual points waited", stats.residual_max);
}
