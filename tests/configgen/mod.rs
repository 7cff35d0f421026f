//! `configgen`: centroid triangulations and counts for given knots, against definitions.

mod failures;
mod special;
mod streams;

use serde_json::Value;

use crate::programs::{outcome, run};
use spmesh_reference::configurations::by_definition;
use spmesh_reference::sets::{self, Random};

/// The output of `configgen`, which must succeed.
fn output(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run("configgen", arguments, input);
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The counts that `configgen` reports.
fn counts(arguments: &[&str], input: &[u8]) -> Value {
    let all = [&["--stats=json", "--centroids", "-q"], arguments].concat();
    let output = run("configgen", &all, input);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    serde_json::from_str(&message).unwrap()
}

fn total(counts: &Value, degree: usize, key: &str) -> u64 {
    counts["degrees"][degree][key].as_u64().unwrap()
}

/// Triangles of a mesh stream as sorted sets of the positions of their corners in the plane.
fn plane(stream: &[u8]) -> Vec<Vec<Vec<f64>>> {
    let mut all = triangles(stream);
    all.iter_mut().flatten().for_each(|corner| corner.truncate(2));
    all
}

/// The triangles of `plane` with coordinates times the order, which are integers.
fn sums(stream: &[u8], order: usize) -> Vec<Vec<Vec<f64>>> {
    let mut all = plane(stream);
    for x in all.iter_mut().flatten().flatten() {
        let sum = *x * order as f64;
        assert!((sum - sum.round()).abs() < 1e-4, "{sum} is no sum of {order} knots");
        *x = sum.round();
    }
    all
}

/// Triangles of a mesh stream as sorted sets of the positions of their corners: x, y, elevation.
fn triangles(stream: &[u8]) -> Vec<Vec<Vec<f64>>> {
    let text = text(stream);
    let numbers =
        |line: &str| -> Vec<f64> { line.split(' ').skip(1).map_while(|word| word.parse().ok()).collect() };
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for line in text.lines() {
        match line.split(' ').next() {
            Some("v") => vertices.push(numbers(line)),
            Some("f") => {
                let corner = |id: &f64| vertices[*id as usize - 1].clone();
                let mut corners: Vec<Vec<f64>> = numbers(line).iter().take(3).map(corner).collect();
                corners.sort_by(|p, q| p.partial_cmp(q).unwrap());
                triangles.push(corners);
            }
            _ => {}
        }
    }
    triangles.sort_by(|p, q| p.partial_cmp(q).unwrap());
    triangles
}

fn text(stream: &[u8]) -> String {
    let text = run("spconvert", &["--to", "text"], stream);
    assert!(text.status.success(), "{:?}", outcome(&text));
    String::from_utf8(text.stdout).unwrap()
}

fn lines<const N: usize>(points: &[[i64; N]]) -> Vec<u8> {
    let line = |point: &[i64; N]| point.map(|x| x.to_string()).join(" ") + "\n";
    points.iter().map(line).collect::<String>().into_bytes()
}

fn scattered(seed: u64, count: usize) -> Vec<[i64; 2]> {
    sets::uniform(&mut Random::new(seed), count, 1 << 20)
}

/// The triangles of the centroid triangulation by the definition of configurations. Corners are sums of
/// knots: centroids times the order.
fn sums_by_definition(points: &[[i64; 2]], order: usize) -> Vec<Vec<Vec<f64>>> {
    let degrees = by_definition(&sets::as_floats(points), order - 1);
    let sum = |sets: [&[u32]; 2]| -> Vec<f64> {
        let ids = || sets.into_iter().flatten();
        (0..2).map(|axis| ids().map(|&id| points[id as usize][axis] as f64).sum()).collect()
    };
    let mut all: Vec<Vec<Vec<f64>>> = Vec::new();
    for ([a, b, c], interior) in &degrees[order - 1] {
        all.push([a, b, c].map(|&v| sum([&[v], interior])).to_vec());
    }
    if order > 1 {
        for ([a, b, c], interior) in &degrees[order - 2] {
            all.push([[*a, *b], [*b, *c], [*c, *a]].map(|pair| sum([&pair, interior])).to_vec());
        }
    }
    all.iter_mut().for_each(|corners| corners.sort_by(|p, q| p.partial_cmp(q).unwrap()));
    all.sort_by(|p, q| p.partial_cmp(q).unwrap());
    all
}

#[test]
fn centroid_triangulations_are_those_of_the_definition() {
    let points = scattered(1, 14);
    for order in 1..=4 {
        let degree = (order - 1).to_string();
        let expected = sums_by_definition(&points, order);
        let grid = run("spfinalize", &["--scale", "1,1,1", "-"], &lines(&points)).stdout;
        let whole = output(&["--centroids", "--degree", &degree], &grid);
        assert_eq!(sums(&whole, order), expected, "order {order}, on a grid");
        let scale = (1.0 / order as f64).to_string();
        let header = format!("#spmesh scale {scale} {scale} {scale}");
        assert!(text(&whole).lines().any(|line| line == header), "{header}");
        let mut means = expected;
        means.iter_mut().flatten().flatten().for_each(|x| *x /= order as f64);
        let float = output(&["--centroids", "--degree", &degree], &lines(&points));
        assert_eq!(plane(&float), means, "order {order}");
    }
}

#[test]
fn grids_beyond_32_bits_move_their_origin() {
    let far = scattered(2, 9).iter().map(|[x, y]| [x + 2_000_000_000, y - 2_000_000_000]).collect::<Vec<_>>();
    let grid = run("spfinalize", &["--scale", "1,1,1", "-"], &lines(&far)).stdout;
    let stream = output(&["--centroids", "--degree", "2"], &grid);
    assert_eq!(sums(&stream, 3), sums_by_definition(&far, 3));
    let [x, y] = [0, 1].map(|axis| far.iter().map(|point| point[axis]).min().unwrap());
    let offset = format!("#spmesh offset {x} {y} 0");
    assert!(text(&stream).lines().any(|line| line == offset), "{offset}");
}

#[test]
fn elevations_of_centroids_are_means() {
    let stream = output(&["--centroids", "--degree", "2"], b"0 0 3\n9 0 6\n0 9 9\n2 2 30\n4 1 0\n");
    let all = triangles(&stream);
    assert!(!all.is_empty());
    let points = [[0.0, 0.0, 3.0], [9.0, 0.0, 6.0], [0.0, 9.0, 9.0], [2.0, 2.0, 30.0], [4.0, 1.0, 0.0]];
    for corner in all.iter().flatten() {
        let is_mean = |left_out: [usize; 2]| {
            let of_axis = |axis: usize| {
                let kept = (0..5).filter(|id| !left_out.contains(id));
                kept.map(|id| points[id][axis]).sum::<f64>() / 3.0
            };
            (0..3).all(|axis| (of_axis(axis) - corner[axis]).abs() < 1e-12)
        };
        assert!((0..5).any(|i| (i + 1..5).any(|j| is_mean([i, j]))), "{corner:?}");
    }
}

#[test]
fn counts_obey_the_identity_of_degrees() {
    for n in [5, 9, 13] {
        let counts = counts(&["--degree", &(n - 3).to_string()], &lines(&scattered(n as u64, n)));
        assert_eq!((&counts["points"], &counts["own_start"]), (&(n as u64).into(), &0.into()));
        for k in 0..=n - 3 {
            let both = total(&counts, k, "configurations") + total(&counts, n - 3 - k, "configurations");
            assert_eq!(both, 2 * (k as u64 + 1) * (n as u64 - 2 - k as u64), "n = {n}, k = {k}");
            assert_eq!(total(&counts, k, "flat"), 0);
        }
        // The infinite configurations of all degrees are the directed lines through two knots, but not those
        // with all n - 2 other knots on the left. These are the reversed lines of degree 0.
        let lines: u64 = (0..=n - 3).map(|k| total(&counts, k, "infinite")).sum();
        assert_eq!(lines + total(&counts, 0, "infinite"), (n * (n - 1)) as u64, "n = {n}");
    }
}

#[test]
fn links_of_degree_0_are_those_of_knots() {
    // A hexagon around a knot: the link of the knot is bounded and has six vertices; the six other links are
    // unbounded.
    let hexagon = b"0 0\n4 0\n2 4\n-2 4\n-4 1\n-2 -4\n3 -4\n";
    let counts = counts(&["--degree", "1"], hexagon);
    let of = |key: &str| total(&counts, 0, key);
    assert_eq!([of("configurations"), of("infinite"), of("interior_sets")], [6, 6, 1]);
    assert_eq!([of("links"), of("null_links"), of("infinite_links"), of("link_vertices_max")], [1, 0, 6, 6]);
    assert!(total(&counts, 1, "configurations") >= 4, "the hexagon without its centre");
}

#[test]
fn borders_and_pulled_knots_get_copies() {
    let points = b"0 0\n8 0\n8 8\n0 8\n3 4\n5 3\n4 0\n";
    for (arguments, knots) in [
        (&["--degree", "2"][..], 7),
        (&["--degree", "2", "--boundary", "clamped"], 15),
        (&["--degree", "1", "--boundary", "pulled-apart"], 12),
        (&["--degree", "1", "--pull-apart", "boundary"], 12),
        (&["--degree", "1", "--pull-apart", "all"], 14),
        (&["--degree", "1", "--pull-apart", "4,5,4"], 9),
        (&["--degree", "1", "--boundary", "pulled-apart", "--pull-apart", "4"], 13),
    ] {
        let counts = counts(arguments, points);
        assert_eq!(counts["knots"], knots, "{arguments:?}");
        assert_eq!(counts["repeated"], 0, "{arguments:?}");
        assert_eq!(total(&counts, 0, "flat") > 0, knots > 7, "{arguments:?}");
    }
    let (code, message) =
        outcome(&run("configgen", &["--centroids", "-o", "/dev/null"], b"0 0\n4 0\n0 4\n0 0\n"));
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 of 4 points is a repeated knot"), "{message}");
}

#[test]
fn rules_and_flips_depend_on_their_seeds_only() {
    let input = lines(&scattered(5, 40));
    let centroids =
        |arguments: &[&str]| output(&[&["--centroids", "--degree", "2"], arguments].concat(), &input);
    let delaunay = centroids(&[]);
    for rule in ["min-weight", "ear", "fan", "aligned:30", "random"] {
        let found = centroids(&["--rule", rule]);
        assert!(found == centroids(&["--rule", rule]), "{rule}");
        assert_eq!(triangles(&found).len(), triangles(&delaunay).len(), "{rule}");
        assert!(found != delaunay, "{rule}");
    }
    assert!(centroids(&["--rule", "random"]) == centroids(&["--rule", "random", "--seed", "1"]));
    assert!(centroids(&["--rule", "random"]) != centroids(&["--rule", "random", "--seed", "2"]));
    assert!(centroids(&["--flip", "random:9", "--seed", "4"]) == centroids(&["--flip", "random:9:4"]));
    assert!(centroids(&["--flip", "random:9:5"]) != centroids(&["--flip", "random:9:4"]));
    let stats = counts(&["--flip", "random:9:4"], &input);
    assert_eq!((&stats["flips"], &stats["seed"]), (&9.into(), &Value::Null));
    assert_eq!(counts(&["--rule", "random", "--seed", "8"], &input)["seed"], 8);
    assert!(counts(&["--flip", "aligned:90"], &input)["flips"].as_u64() > Some(0));
    let (_, message) =
        outcome(&run("configgen", &["--centroids", "--flip", "random:5", "-d0"], b"0 0\n4 0\n0 4\n"));
    assert!(message.contains("0 flips instead of 5"), "{message}");
}

#[test]
fn lifts_are_elevations_or_values() {
    let points = scattered(6, 30);
    let input = lines(&points);
    let lifted: Vec<[i64; 3]> = points.iter().map(|&[x, y]| [x, y, x * x + y * y]).collect();
    let flat: Vec<[i64; 3]> = points.iter().map(|&[x, y]| [x, y, 5]).collect();
    let expected = plane(&output(&["--centroids", "--degree", "2"], &input));
    for (rule, points) in [("lifted:heights", &lifted), ("lifted:weights", &flat)] {
        let found = output(&["--centroids", "--degree", "2", "--rule", rule], &lines(points));
        assert_eq!(plane(&found), expected, "{rule}");
    }
    let folder = crate::programs::Folder::new();
    let values =
        folder.write("values.txt", lifted.iter().map(|point| format!("{}\n", point[2])).collect::<String>());
    let arguments = ["--centroids", "--degree", "2", "--rule", "lifted:heights", "--values", &values];
    assert_eq!(plane(&output(&arguments, &input)), expected);
    let (code, message) = outcome(&run("configgen", &arguments, &lines(&points[..15])));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("stdin: 30 values for 15 knots"), "{message}");
}

#[test]
fn weights_are_in_world_units() {
    let mut random = Random::new(7);
    let mut near = |site: i64| 1000 * site + random.integer(-200, 200);
    let mut points: Vec<[i64; 3]> = (0..36).map(|i| [near(i % 6), near(i / 6), 0]).collect();
    // Weights are below the square of any distance, so that no knot is hidden.
    points.iter_mut().for_each(|point| point[2] = 4 * random.integer(0, 80_000));
    let arguments = ["--centroids", "--degree", "0", "--rule", "lifted:weights"];
    let expected = plane(&output(&arguments, &lines(&points)));
    assert_ne!(expected, plane(&output(&arguments[..3], &lines(&points))), "the weights make a difference");
    let grid = run("spfinalize", &["--scale", "0.5,0.5,4", "-"], &lines(&points)).stdout;
    assert_eq!(plane(&output(&arguments, &grid)), expected);
}

#[test]
fn edges_follow_level_lines() {
    // A square with extreme values along one diagonal: the rule takes that diagonal, whichever is Delaunay.
    let around = "0 9 0\n9 -9 0\n-9 -9 0\n";
    for (level, values) in [("--rule=data", [1, 5, 1, 8]), ("--rule=data", [1, 5, 7, 5])] {
        let square = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        let corners: String = square.iter().zip(values).map(|([x, y], z)| format!("{x} {y} {z}\n")).collect();
        let input = format!("0 0 4\n{corners}{around}");
        let stream = output(&["--centroids", "--degree", "1", level], input.as_bytes());
        // The link of the centre is the square. Its triangles, averaged with the centre, have corners at half
        // of the square's corners.
        let has = |p: [f64; 2], q: [f64; 2]| {
            let half = |corner: &Vec<f64>, p: [f64; 2]| [corner[0] * 2.0, corner[1] * 2.0] == p;
            triangles(&stream).iter().any(|corners| {
                corners.iter().any(|corner| half(corner, p)) && corners.iter().any(|corner| half(corner, q))
            })
        };
        let is_along_x = values[0] == values[2];
        assert_eq!(has([1.0, 0.0], [-1.0, 0.0]), is_along_x, "{values:?}");
        assert_eq!(has([0.0, 1.0], [0.0, -1.0]), !is_along_x, "{values:?}");
    }
}
