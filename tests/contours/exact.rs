//! Lines of small meshes against lines that are made from all triangles and all levels in integers.
//!
//! Coordinates are multiples of a number that every difference of elevations divides, so lines cross edges at
//! integer coordinates.

use std::collections::{BTreeMap, HashMap};

use super::{Line, WHOLE, lines, options};
use crate::dem::Mesh;
use spmesh_reference::incremental;
use spmesh_reference::sets::{Random, degenerate, uniform};

/// Twice the least common multiple of the numbers up to 12.
const UNIT: i64 = 2 * 27_720;

/// Elevations are from 0 to this integer.
const HIGHEST: i64 = 12;

/// The Delaunay triangulation of points with given elevations. Coordinates are multiplied by `UNIT`.
fn mesh(points: &[[i64; 2]], elevation: impl FnMut([i64; 2]) -> i64) -> Mesh {
    let elevations = points.iter().copied().map(elevation).collect::<Vec<i64>>();
    let vertices = points.iter().zip(elevations);
    Mesh {
        points: vertices.map(|(p, z)| [(p[0] * UNIT) as f64, (p[1] * UNIT) as f64, z as f64]).collect(),
        triangles: incremental::triangles(points),
    }
}

/// Meshes with vertices on levels, level triangles, plateaus and saddles.
fn meshes(random: &mut Random) -> Vec<Mesh> {
    let mut meshes = Vec::new();
    for family in [0, 1, 3, 7, 9] {
        let points: Vec<[i64; 2]> = degenerate(random, family, 60)
            .into_iter()
            .filter(|p| p.iter().all(|c| c.abs() < 15_000))
            .collect();
        for highest in [1, 3, HIGHEST] {
            meshes.push(mesh(&points, |_| random.integer(0, highest)));
        }
    }
    let points = uniform(random, 70, 100);
    for highest in [2, 5, HIGHEST] {
        meshes.push(mesh(&points, |_| random.integer(0, highest)));
    }
    // Terraces, a saddle and a pass between two tops.
    let grid: Vec<[i64; 2]> = (0..81).map(|i| [i % 9, i / 9]).collect();
    meshes.push(mesh(&grid, |[x, _]| (x / 3) * 4));
    meshes.push(mesh(&grid, |[x, y]| ((x - 4) * (y - 4) / 2).clamp(-6, 6) + 6));
    meshes.push(mesh(&grid, |[x, y]| (12 - (x - 2).pow(2).min((x - 6).pow(2)) - (y - 4).pow(2)).max(0)));
    meshes.push(mesh(&grid, |_| 6));
    meshes
}

/// The point of an edge at an elevation of `level` halves.
fn place(p: [f64; 3], q: [f64; 3], level: i64) -> [i64; 2] {
    let [p, q] = [p, q].map(|point| point.map(|value| value as i64));
    let (numerator, denominator) = (level - 2 * p[2], 2 * (q[2] - p[2]));
    [0, 1].map(|axis| {
        let way = (q[axis] - p[axis]) * numerator;
        assert_eq!(way % denominator, 0);
        p[axis] + way / denominator
    })
}

/// The orientation of three points.
fn turn([p, q, r]: [[i64; 2]; 3]) -> i128 {
    let [p, q, r] = [p, q, r].map(|point| point.map(i128::from));
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

type Edge = [u32; 2];

/// The edges where the line of a level enters and leaves a triangle. The corners below the level are on the
/// right of the line.
fn passage(mesh: &Mesh, triangle: [u32; 3], level: i64) -> Option<[Edge; 2]> {
    let at = |vertex: u32| mesh.points[vertex as usize];
    let is_above = |vertex: &u32| 2 * at(*vertex)[2] as i64 >= level;
    let (above, below): (Vec<u32>, Vec<u32>) = triangle.iter().partition(|vertex| is_above(vertex));
    let edges: Vec<Edge> =
        above.iter().flat_map(|&a| below.iter().map(move |&b| [a.min(b), a.max(b)])).collect();
    let [p, q] = edges.try_into().ok()?;
    // Both crossings may be at one point, so the sides are found with the midpoints of the edges.
    let middle = |[u, v]: Edge| [0, 1].map(|axis| ((at(u)[axis] + at(v)[axis]) / 2.0) as i64);
    let corner = |vertex: u32| [0, 1].map(|axis| at(vertex)[axis] as i64);
    let side = turn([middle(p), middle(q), corner(below[0])]);
    assert_ne!(side, 0);
    Some(if side < 0 { [p, q] } else { [q, p] })
}

/// All lines. Levels are integers, in units of half an elevation; each line is traced from crossing to
/// crossing.
fn expected(mesh: &Mesh, levels: impl Iterator<Item = i64>) -> Vec<Line> {
    let mut all = Vec::new();
    for level in levels {
        let mut next: BTreeMap<Edge, Edge> = BTreeMap::new();
        let mut before: HashMap<Edge, Edge> = HashMap::new();
        for [from, to] in mesh.triangles.iter().filter_map(|&triangle| passage(mesh, triangle, level)) {
            assert!(next.insert(from, to).is_none() && before.insert(to, from).is_none());
        }
        let starts: Vec<Edge> = next.keys().copied().filter(|edge| !before.contains_key(edge)).collect();
        for start in starts {
            all.extend(follow(mesh, level, &mut next, start));
        }
        while let Some(start) = next.keys().next().copied() {
            all.extend(follow(mesh, level, &mut next, start));
        }
    }
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

/// Removes the line that starts at an edge from `next`; `None` if the line is a single point.
fn follow(mesh: &Mesh, level: i64, next: &mut BTreeMap<Edge, Edge>, start: Edge) -> Option<Line> {
    let (mut edges, mut is_closed) = (vec![start], false);
    while let Some(edge) = next.remove(edges.last().unwrap()) {
        is_closed = edge == start;
        edges.push(edge);
    }
    let is_depression = is_closed && surrounds_lower(mesh, &edges);
    let place = |[u, v]: Edge| place(mesh.points[u as usize], mesh.points[v as usize], level);
    let mut points: Vec<[i64; 2]> = edges.into_iter().map(place).collect();
    points.dedup();
    if points.len() < 2 {
        return None;
    }
    if is_closed {
        points.pop();
        let rotations = (0..points.len()).map(|start| [&points[start..], &points[..start]].concat());
        points = rotations.min()?;
    }
    let points = points.into_iter().map(|point| point.map(|value| value as f64)).collect();
    Some(Line { elevation: level as f64 / 2.0, is_closed, is_depression, points })
}

/// Whether a ring that passes edges of a mesh is clockwise, so that its left side, where it is higher, is
/// outside. Crossings may be at one point, so it is the ring through the midpoints that is looked at.
fn surrounds_lower(mesh: &Mesh, edges: &[Edge]) -> bool {
    let at = |vertex: u32| mesh.points[vertex as usize];
    let middle = |&[u, v]: &Edge| [0, 1].map(|axis| ((at(u)[axis] + at(v)[axis]) / 2.0) as i128);
    let middles: Vec<[i128; 2]> = edges.iter().map(middle).collect();
    let area: i128 = middles.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum();
    assert_ne!(area, 0);
    area < 0
}

/// Intervals and bases of levels, and the levels in units of half an elevation.
fn choices() -> [([f64; 2], Vec<i64>); 4] {
    let at = |first: usize, step: usize| {
        (first..=2 * HIGHEST as usize).step_by(step).map(|level| level as i64).collect()
    };
    [([1.0, 0.0], at(2, 2)), ([0.5, -7.0], at(1, 1)), ([5.0, 0.5], at(1, 10)), ([3.0, 12.0], at(6, 6))]
}

#[test]
fn lines_are_those_of_whole_numbers() {
    let mut random = Random::new(1);
    let [mut found, mut depressions] = [0; 2];
    for (number, mesh) in meshes(&mut random).into_iter().enumerate() {
        for ([interval, base], levels) in choices() {
            let expected = expected(&mesh, levels.into_iter());
            let lines = lines(&mesh.stream(WHOLE), &options(interval, base));
            assert_eq!(lines, expected, "mesh {number}, every {interval} from {base}");
            found += lines.len();
            depressions += lines.iter().filter(|line| line.is_depression).count();
        }
    }
    assert!(found > 1000 && depressions > 100, "{found} {depressions}");
}

#[test]
fn lines_do_not_depend_on_the_order_of_triangles() {
    let mut random = Random::new(2);
    for mesh in meshes(&mut random) {
        // The levels are multiples of 1/3, which are rounded.
        let options = options(1.0 / 3.0, 0.1);
        let expected = lines(&mesh.stream(WHOLE), &options);
        for _ in 0..4 {
            assert_eq!(lines(&mesh.shuffled(&mut random).stream(WHOLE), &options), expected);
        }
    }
}

#[test]
fn lines_that_are_cut_have_the_same_segments() {
    let mut random = Random::new(3);
    let sorted = |lines: &[Line]| {
        let of =
            |line: &Line| -> Vec<_> { line.segments().map(|segment| (line.elevation, segment)).collect() };
        let mut all: Vec<(f64, [[f64; 2]; 2])> = lines.iter().flat_map(of).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    for mesh in meshes(&mut random) {
        let stream = mesh.shuffled(&mut random).stream(WHOLE);
        let whole = sorted(&lines(&stream, &options(1.0, 0.5)));
        for points in [2, 3, 7] {
            let options = spmesh_terrain::contours::Options { points: Some(points), ..options(1.0, 0.5) };
            let parts = lines(&stream, &options);
            assert_eq!(sorted(&parts), whole);
            // Two pieces of up to `points` points may be joined.
            assert!(parts.iter().all(|line| line.points.len() <= 2 * points), "{points}");
        }
    }
}

#[test]
fn lines_of_a_level_do_not_cross() {
    let mut random = Random::new(4);
    for mesh in meshes(&mut random) {
        let mut by_level: BTreeMap<i64, Vec<[[i64; 2]; 2]>> = BTreeMap::new();
        for line in lines(&mesh.stream(WHOLE), &options(1.0, 0.5)) {
            let whole = |segment: [[f64; 2]; 2]| segment.map(|point| point.map(|value| value as i64));
            by_level.entry((2.0 * line.elevation) as i64).or_default().extend(line.segments().map(whole));
        }
        for segments in by_level.values() {
            for (i, &[p, q]) in segments.iter().enumerate() {
                for &[r, s] in &segments[..i] {
                    let sides = [turn([p, q, r]), turn([p, q, s]), turn([r, s, p]), turn([r, s, q])]
                        .map(i128::signum);
                    let is_crossing = sides[0] * sides[1] < 0 && sides[2] * sides[3] < 0;
                    assert!(!is_crossing, "{:?} and {:?}", [p, q], [r, s]);
                }
            }
        }
    }
}
