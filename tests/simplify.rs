//! `spsimplify`: every vertex is near its result, by integers and without the engine.

use std::collections::{HashMap, HashSet};

use spmesh_base::random::Random;
use spmesh_pipeline::reduce::Duplicates;
use spmesh_stream::{Coordinates, Event, Header, Kind, StreamReader, StreamWriter};
use spmesh_terrain::meshing::Meshing;
use spmesh_terrain::simplify::{CELL_POINTS, Simplification};

use crate::programs::{Folder, assert_outcome, outcome, run};

type Place = [i64; 3];

/// A mesh of places with integer coordinates.
struct Surface {
    vertices: Vec<Place>,
    triangles: Vec<[Place; 3]>,
}

fn mesh_of(places: &[Place]) -> Vec<u8> {
    let text: String = places.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let points = run("spfinalize", &["-q", "--cell-points", "500", "-"], text.as_bytes());
    assert!(points.status.success(), "{:?}", outcome(&points));
    run("spdelaunay2d", &["-q"], &points.stdout).stdout
}

/// The results for some tolerances, coarsest first.
fn simplified(mesh: &[u8], tolerances: &[f64], cell_points: u64, threads: usize) -> Vec<Vec<u8>> {
    let meshing = Meshing { duplicates: Duplicates::Error, memory: 64 << 20, threads, temp_dir: None };
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let mut simplification = Simplification::read(&mut reader, meshing, cell_points, |_| {}).unwrap();
    let of_level = |&tolerance: &f64| {
        simplification.refine(tolerance, &mut |_, _| {}).unwrap();
        let mut output = Vec::new();
        simplification.write(false, &mut output).unwrap();
        output
    };
    tolerances.iter().map(of_level).collect()
}

fn surface(mesh: &[u8]) -> Surface {
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let (mut by_id, mut triangles) = (HashMap::new(), Vec::new());
    while let Some(event) = reader.next_event().unwrap() {
        let Event::Patch(patch) = event else { continue };
        let world =
            |point| reader.header().coordinates.to_decimal(point).map(|value: f64| value.round() as i64);
        by_id.extend(patch.new.iter().zip(patch.first_id..).map(|(&point, id)| (id, world(point))));
        triangles.extend(patch.triangles().map(|corners| corners.map(|local| by_id[&patch.id(local)])));
    }
    Surface { vertices: by_id.into_values().collect(), triangles }
}

/// Twice the area of a triangle in the plane.
fn area([a, b, c]: [Place; 3]) -> i128 {
    let [ux, uy, vx, vy] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]].map(i128::from);
    ux * vy - uy * vx
}

/// Checks that each vertex is in a triangle, and no farther from it than allowed. Units: tenths.
fn check(all: &Surface, simple: &Surface, tenths: i128) {
    let places: HashSet<Place> = all.vertices.iter().copied().collect();
    assert!(simple.vertices.iter().all(|vertex| places.contains(vertex)), "a vertex is none of the mesh");
    if all.triangles.is_empty() {
        return assert_eq!(simple.vertices.len(), all.vertices.len());
    }
    for &point in &all.vertices {
        let is_near = |&triangle: &[Place; 3]| {
            let is_beside = |axis: usize| {
                triangle.iter().all(|corner| corner[axis] < point[axis])
                    || triangle.iter().all(|corner| corner[axis] > point[axis])
            };
            if is_beside(0) || is_beside(1) {
                return None;
            }
            let shares = [0, 1, 2].map(|corner| {
                let mut other = triangle;
                other[corner] = point;
                area(other)
            });
            if shares.iter().any(|&share| share < 0) {
                return None;
            }
            let rise = |corner: usize| shares[corner] * i128::from(triangle[corner][2] - point[2]);
            Some(10 * (rise(0) + rise(1) + rise(2)).abs() <= tenths * area(triangle))
        };
        let found: Vec<bool> = simple.triangles.iter().filter_map(is_near).collect();
        assert!(!found.is_empty() && !found.contains(&false), "{point:?} is in {} triangles", found.len());
    }
}

/// Hills with noise; distinct places.
fn rough(random: &mut Random, count: usize, side: u64) -> Vec<Place> {
    let mut seen = HashSet::new();
    let mut places = Vec::new();
    while places.len() < count {
        let [x, y] = [0, 1].map(|_| random.below(side) as f64);
        let z = 20.0 * (x / 97.0).sin() * (y / 71.0).cos() + random.below(4) as f64;
        let place = [x, y, z].map(|value| value as i64);
        if seen.insert([place[0], place[1]]) {
            places.push(place);
        }
    }
    places
}

/// Sets with and without order, with ties of all kinds.
fn sets() -> Vec<Vec<Place>> {
    let mut random = Random::new(7);
    let grid: Vec<Place> =
        (0..900i64).map(|i| [i % 30, i / 30, (i % 30 - 12).abs() + (i / 30 % 7)]).collect();
    let level = (0..900).map(|i| [i % 30, i / 30, 5]).collect();
    let circle = (0..1200)
        .map(|i| [i % 40 - 20, i / 40 - 15, i % 7])
        .filter(|[x, y, _]| x * x + y * y == 65 || x * x + y * y == 25);
    let line: Vec<Place> = (0..40).map(|i| [3 * i, 2 * i, i * i % 5]).collect();
    let mut far = rough(&mut random, 900, 300);
    far.push([1 << 28, -(1 << 27), 900]);
    let mut twice = rough(&mut random, 600, 30);
    twice.extend(rough(&mut random, 600, 30));
    let few: Vec<_> = (1..6).map(|count| rough(&mut random, count, 9)).collect();
    let mut sets = vec![grid, level, circle.collect(), line, far, twice, rough(&mut random, 1500, 500)];
    sets.extend(few);
    sets
}

#[test]
fn every_vertex_is_near_the_result() {
    for (number, places) in sets().iter().enumerate() {
        let mesh = mesh_of(places);
        let all = surface(&mesh);
        for (tolerance, tenths) in [(0.0, 0), (0.5, 5), (3.0, 30)] {
            for cell_points in [CELL_POINTS, 200] {
                let simple = &simplified(&mesh, &[tolerance], cell_points, 2)[0];
                println!("set {number}, tolerance {tolerance}, {cell_points} points a cell");
                check(&all, &surface(simple), tenths);
                let audit = run("spinfo", &["-q", "--audit"], simple);
                assert!(audit.status.success(), "{:?}", outcome(&audit));
            }
        }
    }
}

#[test]
fn an_empty_mesh_stays_empty() {
    let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true);
    let mesh = StreamWriter::new(Vec::new(), header).unwrap().end(0, 0).unwrap();
    assert!(surface(&simplified(&mesh, &[1.0], 200, 1)[0]).vertices.is_empty());
}

/// Triangles so flat in the plane that nothing is known of their slopes, and coordinates beyond products.
#[test]
fn what_rounding_hides_stays() {
    let mut random = Random::new(17);
    let mut sets = vec![
        (0..500)
            .map(|i| [0.1 * f64::from(i), 1e-13 * f64::from(i % 2) + 0.3 * f64::from(i), f64::from(i % 3)])
            .collect::<Vec<_>>(),
    ];
    for size in [1e-160, 1.0, 1e160] {
        sets.push(
            (0..500).map(|_| [size * random.unit(), size * random.unit(), 10.0 * random.unit()]).collect(),
        );
    }
    sets[2].push([1e30, -1e12, 1.0]);
    let folder = Folder::new();
    for points in sets {
        let text: String = points.iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}\n")).collect();
        let points = run("spfinalize", &["-q", "-"], text.as_bytes()).stdout;
        let mesh = folder.write("mesh.spm", run("spdelaunay2d", &["-q"], &points).stdout);
        for tolerance in ["0", "3"] {
            let simple = folder.path("simple.spm");
            assert_outcome("spsimplify", &["-q", "--tolerance", tolerance, &mesh, "-o", &simple], &[], 0, "");
            let audit = ["-q", "--audit", "--within", tolerance, "--points", &mesh, &simple];
            assert_outcome("spinfo", &audit, &[], 0, "");
        }
    }
}

#[test]
fn a_level_surface_keeps_its_corners_alone() {
    let mesh = mesh_of(&sets()[1]);
    assert_eq!(surface(&simplified(&mesh, &[0.0], 200, 1)[0]).vertices.len(), 4);
}

#[test]
fn order_and_threads_make_no_difference() {
    let mut random = Random::new(11);
    let mut places = rough(&mut random, 3000, 4000);
    let all = simplified(&mesh_of(&places), &[2.0, 0.5], 300, 1);
    for threads in 1..4 {
        for at in (1..places.len()).rev() {
            places.swap(at, random.below(at as u64 + 1) as usize);
        }
        assert!(simplified(&mesh_of(&places), &[2.0, 0.5], 300, threads) == all, "{threads} threads");
    }
}

#[test]
fn finer_levels_have_the_vertices_of_coarser_ones() {
    let places = rough(&mut Random::new(3), 3000, 800);
    let mesh = mesh_of(&places);
    let levels: Vec<Surface> =
        simplified(&mesh, &[3.0, 1.0, 0.3, 0.0], 400, 2).iter().map(|level| surface(level)).collect();
    let all = surface(&mesh);
    for (level, tenths) in levels.iter().zip([30, 10, 3, 0]) {
        check(&all, level, tenths);
    }
    for pair in levels.windows(2) {
        let finer: HashSet<Place> = pair[1].vertices.iter().copied().collect();
        assert!(pair[0].vertices.iter().all(|vertex| finer.contains(vertex)));
        assert!(pair[0].vertices.len() < finer.len());
    }
}

/// The program, its messages, and the audit of what it wrote.
#[test]
fn the_audit_finds_vertices_that_are_too_far() {
    let folder = Folder::new();
    let places = rough(&mut Random::new(5), 1500, 300);
    let mesh = folder.write("mesh.spm", mesh_of(&places));
    let simple = folder.path("simple.spm");
    assert_outcome("spsimplify", &["-q", "--tolerance", "2", &mesh, "-o", &simple], &[], 0, "");
    let audit =
        |within: &str| ["-q", "--audit", "--within", within, "--points", &mesh, &simple].map(str::to_string);
    for (within, code, part) in [("2", 0, ""), ("1.5", 4, "within check failed"), ("nan", 2, "from 0 on")] {
        let arguments = audit(within);
        assert_outcome("spinfo", &arguments.each_ref().map(String::as_str), &[], code, part);
    }
    let others = folder.write("others.spm", mesh_of(&rough(&mut Random::new(6), 1500, 300)));
    let arguments = ["--audit", "--within", "9", "--points", &others, &simple];
    assert_outcome("spinfo", &arguments, &[], 4, "points check failed");

    let levels = folder.path("levels");
    assert_outcome("spsimplify", &["-q", "--levels", "1,0.5,3", &mesh, "--out-dir", &levels], &[], 0, "");
    assert_eq!(folder.names("levels"), ["0.5.spm", "1.spm", "3.spm"]);
    let cases: [(&[&str], &str); 4] = [
        (&["--tolerance", "-1", &mesh], "from 0 on"),
        (&["--tolerance", "nan", &mesh], "from 0 on"),
        (&["--levels", "1,1", "--out-dir", &levels, &mesh], "twice"),
        (&[&mesh], "--tolerance"),
    ];
    for (arguments, part) in cases {
        assert_outcome("spsimplify", arguments, &[], 2, part);
    }
    let cut = run("spconstrain", &["-q", "--kill", "9", &mesh], &[]).stdout;
    assert_outcome(
        "spsimplify",
        &["--tolerance", "1"],
        &cut,
        2,
        "simplify the mesh that spdelaunay2d writes",
    );
    let whole = std::fs::read(&mesh).unwrap();
    assert_outcome("spsimplify", &["--tolerance", "1"], &whole[..whole.len() / 2], 3, "");
}
