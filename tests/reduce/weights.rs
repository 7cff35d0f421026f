//! Weighted points: the set of tetrahedra is the regular one of all points, however the input comes.

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::reduce::{Duplicates, Options, Part};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Event, Header, StreamReader, StreamWriter, Weighted};

use super::balls::{Balls, audit, expected, options, weighted};
use super::solids::{Corners, bits, every_node, fits_a_grid, read_mesh, tetrahedralize};
use super::streams::{GRID, Tagging, stream_of};
use spmesh_reference::clouds::{FAMILIES, Family, of};
use spmesh_reference::sets::Random;
use spmesh_reference::tetrahedra::regular;

const TAGGINGS: [Tagging; 6] = [
    Tagging::None,
    Tagging::Chunked(1),
    Tagging::Chunked(2),
    Tagging::Ragged,
    Tagging::Preserved(2),
    Tagging::Forgetful(2),
];

/// Checks all runs over some balls; returns how many of them are hidden.
fn assert_regular(balls: &Balls, what: &str) -> usize {
    let (tetrahedra, hidden) = expected(balls);
    let (one, stats) = tetrahedralize(&balls.stream, &options(1)).unwrap();
    let (set, vertices) = read_mesh(&one);
    assert!(set == tetrahedra, "{what}: {} of {}", set.len(), tetrahedra.len());
    assert_eq!(vertices as u64 + stats.merged, balls.points.len() as u64, "{what}");
    let (three, _) = tetrahedralize(&balls.stream, &options(3)).unwrap();
    assert!(one == three, "{what}: the stream depends on the number of threads");
    let lazy = Options { every_node: false, ..options(2) };
    let (lazy, _) = tetrahedralize(&balls.stream, &lazy).unwrap();
    assert!(read_mesh(&lazy).0 == tetrahedra, "{what}, with nodes that pass their points up");
    for mesh in [&one, &lazy] {
        audit(mesh).unwrap_or_else(|violation| panic!("{what}: {violation}"));
    }
    hidden
}

/// Weights of some kind for points that are about `apart` from each other.
fn weigh(random: &mut Random, kind: usize, apart: f64) -> f64 {
    let unit = |random: &mut Random| random.integer(0, 1 << 30) as f64 / f64::from(1 << 30);
    let weight = match kind {
        // Few are hidden, many, or nearly all.
        0 => 0.5 * unit(random),
        1 => 4.0 * unit(random) - 2.0,
        2 => 1e3 * unit(random) * unit(random),
        // Many ties.
        3 => [0.0, 1.0, 2.0][random.integer(0, 2) as usize],
        _ => 0.0,
    };
    let weight = weight * apart * apart;
    match weight.is_finite() {
        true if apart >= 1.0 => weight.round(),
        true => weight,
        // Of points too far apart for squares.
        false => 0.0,
    }
}

/// The mean distance of points, roughly.
fn distance(points: &[Point]) -> f64 {
    let side = |axis: usize| {
        let all = points.iter().map(|point| point[axis]);
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    side(0).max(side(1)).max(side(2)) / (points.len() as f64).cbrt()
}

/// Points in a stream with weights of a kind, and the distance that they are about apart.
fn balls_of(
    random: &mut Random,
    points: &[Point],
    (coordinates, tagging): (Coordinates, Tagging),
    kind: usize,
) -> (Balls, f64) {
    let stream = stream_of(3, points, coordinates, tagging, random);
    let apart = distance(points);
    (weighted(&stream, |_| weigh(random, kind, apart)), apart)
}

#[test]
fn no_family_depends_on_cells() {
    let mut hidden = [0; 5];
    for (number, family) in FAMILIES.into_iter().enumerate() {
        for (kind, hidden) in hidden.iter_mut().enumerate() {
            let mut random = Random::new((number * 10 + kind) as u64);
            let points = of(&mut random, family, 90);
            let tagging = TAGGINGS[(number + kind) % TAGGINGS.len()];
            let coordinates =
                if fits_a_grid(&points) && tagging != Tagging::Ragged { GRID } else { Coordinates::F64 };
            let (balls, _) = balls_of(&mut random, &points, (coordinates, tagging), kind);
            *hidden += assert_regular(&balls, &format!("{family:?}, {tagging:?}, weights {kind}"));
        }
    }
    assert!(hidden[1] > 100 && hidden[2] > 300 && hidden[3] > 100, "{hidden:?}");
    assert_eq!(hidden[4], 0, "equal weights hide none");
}

#[test]
fn small_sets_are_those_of_the_definition() {
    for seed in 0..60 {
        let mut random = Random::new(500 + seed);
        let place = |random: &mut Random| random.integer(0, 3) as f64;
        let points: Vec<Point> = (0..14).map(|_| [(); 3].map(|()| place(&mut random))).collect();
        let tagging = TAGGINGS[seed as usize % TAGGINGS.len()];
        let coordinates = if tagging == Tagging::Ragged { Coordinates::F64 } else { GRID };
        let stream = stream_of(3, &points, coordinates, tagging, &mut random);
        let balls = weighted(&stream, |_| random.integer(-3, 6) as f64);
        let (mesh, _) = tetrahedralize(&balls.stream, &options(1)).unwrap();
        // The definition wants different points: of equal ones the heaviest.
        let mut heaviest: Vec<(Point, f64)> = Vec::new();
        for (&point, &weight) in balls.points.iter().zip(&balls.weights) {
            match heaviest.iter_mut().find(|(other, _)| *other == point) {
                Some((_, other)) => *other = other.max(weight),
                None => heaviest.push((point, weight)),
            }
        }
        let (points, weights): (Vec<Point>, Vec<f64>) = heaviest.into_iter().unzip();
        let mut set: Vec<Corners> = regular(&points, &weights)
            .into_iter()
            .map(|t| {
                let mut corners = t.map(|v| bits(points[v as usize]));
                corners.sort_unstable();
                corners
            })
            .collect();
        set.sort_unstable();
        assert_eq!(read_mesh(&mesh).0, set, "seed {seed}");
    }
}

#[test]
fn larger_sets_do_not_depend_on_cells() {
    for (kind, family) in
        [Family::Uniform, Family::Cubic, Family::BodyCentered, Family::Cluster].into_iter().enumerate()
    {
        let mut random = Random::new(family as u64);
        let points = of(&mut random, family, 2500);
        let (balls, _) = balls_of(&mut random, &points, (Coordinates::F64, Tagging::Chunked(2)), kind);
        assert_regular(&balls, &format!("{family:?}"));
    }
}

#[test]
fn memory_follows_the_faces_of_cells() {
    let mut random = Random::new(3);
    let points = of(&mut random, Family::Uniform, 40_000);
    let (balls, _) = balls_of(&mut random, &points, (Coordinates::F64, Tagging::Chunked(2)), 0);
    let (mesh, stats) = tetrahedralize(&balls.stream, &options(1)).unwrap();
    assert!(stats.residual_max < 32_000, "{} residual points waited", stats.residual_max);
    audit(&mesh).unwrap();
}

#[test]
fn of_coinciding_points_the_heaviest_is_the_vertex() {
    let mut random = Random::new(5);
    let place = |random: &mut Random| random.integer(0, 3) as f64;
    let points: Vec<Point> = (0..400).map(|_| [(); 3].map(|()| place(&mut random))).collect();
    for tagging in TAGGINGS {
        let coordinates = if tagging == Tagging::Ragged { Coordinates::F64 } else { GRID };
        let stream = stream_of(3, &points, coordinates, tagging, &mut random);
        let balls = weighted(&stream, |_| random.integer(0, 9) as f64);
        let (mesh, stats) = tetrahedralize(&balls.stream, &options(2)).unwrap();
        assert_eq!((stats.vertices, stats.merged), (64, 336), "{tagging:?}");
        let mut reader = StreamReader::new(&mesh[..], "mesh").unwrap();
        while let Some(event) = reader.next_event().unwrap() {
            let Event::Patch(patch) = event else { continue };
            let weights = reader.header().weights().expect("a mesh with weights").read(reader.rows());
            for (vertex, weight) in patch.new.iter().zip(weights) {
                let all = balls.points.iter().zip(&balls.weights).filter(|(point, _)| *point == vertex);
                assert_eq!(weight, all.map(|(_, &weight)| weight).fold(0.0, f64::max), "{tagging:?}");
            }
        }
    }
}

/// More coinciding points in one cell than are merged before the cell is complete.
#[test]
fn crowds_at_few_places_keep_the_heaviest() {
    let mut random = Random::new(6);
    let count = (1 << 18) + 1000;
    let points: Vec<Point> =
        (0..count).map(|i| [f64::from(i % 5), f64::from(i % 3), f64::from(i % 2)]).collect();
    let stream = stream_of(3, &points, GRID, Tagging::Chunked(0), &mut random);
    let mut next = 0;
    let balls = weighted(&stream, |_| {
        next += 1;
        f64::from(next % 1009)
    });
    let (mesh, stats) = tetrahedralize(&balls.stream, &options(1)).unwrap();
    assert_eq!((stats.vertices, stats.merged), (30, count as u64 - 30));
    assert_eq!(read_mesh(&mesh).0, expected(&balls).0);
}

#[test]
fn planted_faults_are_found() {
    let mut random = Random::new(8);
    let points = of(&mut random, Family::Uniform, 500);
    let (balls, apart) = balls_of(&mut random, &points, (Coordinates::F64, Tagging::Chunked(1)), 1);
    let (mesh, _) = tetrahedralize(&balls.stream, &options(1)).unwrap();
    // Another weight in any one row.
    let with_weight = |which: usize, change: f64| {
        let mut reader = StreamReader::new(&mesh[..], "mesh").unwrap();
        let header = Header { weighted: Some(Weighted { greatest: 1e9 }), ..reader.header().clone() };
        let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
        let mut first = 0;
        while let Some(event) = reader.next_event().unwrap() {
            match event {
                Event::Patch(patch) => {
                    let mut rows = reader.rows().to_vec();
                    if let Some(row) =
                        which.checked_sub(first).and_then(|row| rows.chunks_exact_mut(9).nth(row))
                    {
                        let weight = f64::from_le_bytes(row[1..].try_into().unwrap()) + change;
                        row[1..].copy_from_slice(&weight.to_le_bytes());
                    }
                    first += patch.new.len();
                    writer.patch_with_rows(&patch, &rows).unwrap();
                }
                Event::End(totals) => return writer.end(totals.points, totals.merged).unwrap(),
                other => panic!("{other:?} in a mesh"),
            }
        }
        panic!("a mesh without an end");
    };
    assert_eq!(audit(&with_weight(0, 0.0)), Ok(()));
    let great = 40.0 * apart * apart;
    let found = |change: f64| (0..500).filter(|&which| audit(&with_weight(which, change)).is_err()).count();
    assert_eq!(found(great), 500, "each vertex that is much heavier takes others' cells");
    // A lighter one stays right if it was hidden before.
    let hidden = expected(&balls).1;
    assert!(hidden > 20);
    assert_eq!(found(-great), 500 - hidden);
}

#[test]
fn runs_without_weights_are_refused() {
    let mut random = Random::new(9);
    let points = of(&mut random, Family::Uniform, 50);
    let stream = stream_of(3, &points, Coordinates::F64, Tagging::None, &mut random);
    let refused = tetrahedralize(&stream, &options(1)).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Usage);
    assert!(refused.to_string().contains("have no weights"), "{refused}");
    let balls = weighted(&stream, |_| 1.0);
    let part = Some(Part::Region(Region { min: [0.0; 3], max: [1.0; 3] }));
    let refused = tetrahedralize(&balls.stream, &Options { part, ..options(1) }).unwrap_err();
    assert!(refused.to_string().contains("--partial"), "{refused}");
    let (plain, _) = tetrahedralize(&balls.stream, &every_node(1)).unwrap();
    assert!(StreamReader::new(&plain[..], "mesh").unwrap().header().weights().is_none());
    let twice: Vec<Point> = points.iter().chain(&points).copied().collect();
    let stream = stream_of(3, &twice, Coordinates::F64, Tagging::None, &mut random);
    let options = Options { duplicates: Duplicates::Error, ..options(1) };
    let refused = tetrahedralize(&weighted(&stream, |_| 1.0).stream, &options).unwrap_err();
    assert!(refused.to_string().contains("several points at x "), "{refused}");
}
