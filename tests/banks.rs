//! Rivers by two banks in `spfinalize --flatten`, and the levels in its report.

use std::fmt::Write;

use crate::programs::{Folder, assert_outcome, outcome, run};
use crate::water::{SCALE, at, distance, flattened, is_in, points, text, vertices};

type Line = Vec<[f64; 2]>;

/// Half of the width of rivers.
const HALF: f64 = 3.0;

/// A bend of a river that flows to the right: its middle at `x`, and the direction there.
fn middle(x: f64) -> ([f64; 2], [f64; 2]) {
    let slope = 8.0 / 15.0 * (x / 15.0).cos();
    let length = slope.hypot(1.0);
    ([x, 50.0 + 8.0 * (x / 15.0).sin()], [1.0 / length, slope / length])
}

/// A bank of the bend, `side` being 1 for the left one: vertices at steps along x, in hundredths.
fn bank(side: f64, step: f64) -> Line {
    let count = (80.0 / step).round() as u32;
    let vertex = |number: u32| {
        let ([x, y], [u, v]) = middle(10.0 + 80.0 * f64::from(number) / f64::from(count));
        [x - side * HALF * v, y + side * HALF * u].map(|value| (value * 100.0).round() / 100.0)
    };
    (0..=count).map(vertex).collect()
}

fn line(properties: &str, vertices: &[[f64; 2]], z: impl Fn([f64; 2]) -> Option<f64>) -> String {
    let vertex = |&[x, y]: &[f64; 2]| match z([x, y]) {
        Some(z) => format!("[{x},{y},{z}]"),
        None => format!("[{x},{y}]"),
    };
    let all: Vec<String> = vertices.iter().map(vertex).collect();
    let geometry = format!(r#"{{"type":"LineString","coordinates":[{}]}}"#, all.join(","));
    format!(r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{geometry}}}"#)
}

fn soft(properties: &str, vertices: &[[f64; 2]]) -> String {
    line(properties, vertices, |_| None)
}

fn collection(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

/// The ring around two banks.
fn ring(left: &Line, right: &Line) -> Line {
    left.iter().chain(right.iter().rev()).copied().collect()
}

/// The place along a line that is nearest to another place, as a length from its start, and how near it is.
fn along(line: &[[f64; 2]], [x, y]: [f64; 2]) -> (f64, f64) {
    let (mut best, mut start) = ((f64::INFINITY, 0.0), 0.0);
    for part in line.windows(2) {
        let [[ax, ay], [bx, by]] = [part[0], part[1]];
        let length = (bx - ax).hypot(by - ay);
        let step = (((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length).clamp(0.0, length);
        let away = (x - ax - step * (bx - ax) / length).hypot(y - ay - step * (by - ay) / length);
        if away < best.0 {
            best = (away, start + step);
        }
        start += length;
    }
    (best.1, best.0)
}

/// Vertices of a mesh on a line: the length from its start, and the elevation, in order.
fn on_line(found: &[[i64; 3]], line: &[[f64; 2]]) -> Vec<(f64, i64)> {
    let places = found.iter().map(|&[x, y, z]| (along(line, [x as f64 / 100.0, y as f64 / 100.0]), z));
    let mut on: Vec<(f64, i64)> =
        places.filter(|((_, away), _)| *away < 1e-6).map(|((length, _), z)| (length, z)).collect();
    on.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    on
}

/// The edges on lines in a mesh, without the numbers of lines.
fn edges(folder: &Folder, mesh: &[u8]) -> Vec<[[f64; 2]; 2]> {
    let path = folder.path("edges.geojson");
    let (code, message) = outcome(&run("spconvert", &["--to", "geojson", "-o", &path], mesh));
    assert_eq!(code, Some(0), "{message}");
    let text = std::fs::read_to_string(&path).expect("edges");
    let edges: serde_json::Value = serde_json::from_str(&text).expect("GeoJSON");
    let edge = |feature: &serde_json::Value| {
        let at = |end: usize, axis: usize| {
            feature["geometry"]["coordinates"][end][axis].as_f64().expect("a coordinate")
        };
        [0, 1].map(|end| [0, 1].map(|axis| at(end, axis)))
    };
    edges["features"].as_array().expect("features").iter().map(edge).collect()
}

fn length([[x, y], [u, v]]: [[f64; 2]; 2]) -> f64 {
    (u - x).hypot(v - y)
}

#[test]
fn banks_fall_and_are_level_across() {
    let folder = Folder::new();
    for [left_step, right_step] in [[4.0, 4.0], [2.0, 5.0], [8.0, 1.6]] {
        let (left, right) = (bank(1.0, left_step), bank(-1.0, right_step));
        let features =
            [soft(r#""river":1,"bank":"left""#, &left), soft(r#""river":1,"bank":"right""#, &right)];
        let (mesh, messages) = flattened(&folder, &collection(&features), &["--shore-width", "3"]);
        assert!(messages.contains("\"lakes\":0") && messages.contains("\"rivers\":1}"), "{messages}");
        let found = vertices(&mesh);
        let river = ring(&left, &right);
        let is_inside = |place: [f64; 2]| is_in(&river, place) && distance(&river, place) > 1e-6;
        let count = |points: &[[i64; 3]]| {
            points.iter().filter(|[x, y, _]| is_inside([*x as f64 / 100.0, *y as f64 / 100.0])).count()
        };
        assert!(count(&points()) > 200 && count(&found) == 0, "{} points stay", count(&found));
        let [of_left, of_right] = [&left, &right].map(|bank| on_line(&found, bank));
        assert!(of_left.len() >= left.len() && of_right.len() >= right.len());
        for bank in [&of_left, &of_right] {
            assert!(bank.is_sorted_by(|a, b| a.1 >= b.1), "a bank rises: {bank:?}");
        }
        // The level opposite, up to the distance between vertices of both banks.
        let slack = 1.5 * (left_step + right_step);
        for &[x, y, z] in
            found.iter().filter(|[x, y, _]| along(&left, [*x as f64 / 100.0, *y as f64 / 100.0]).1 < 1e-6)
        {
            let (place, away) = along(&right, [x as f64 / 100.0, y as f64 / 100.0]);
            assert!(away < 2.0 * HALF + 0.1);
            let above = of_right.iter().rfind(|(length, _)| *length <= place - slack);
            let below = of_right.iter().find(|(length, _)| *length >= place + slack);
            assert!(above.is_none_or(|(_, above)| z <= *above), "{z} at {place}: {above:?}");
            assert!(below.is_none_or(|(_, below)| z >= *below), "{z} at {place}: {below:?}");
        }
        // Ends are level, and the fall of the ground is that of the river.
        let [first, last] = [0, of_left.len() - 1].map(|at| of_left[at].1);
        assert_eq!([first, last], [of_right[0].1, of_right[of_right.len() - 1].1]);
        assert!(first - last > 300, "{first} to {last}");
        let around: f64 = river.iter().zip(river.iter().cycle().skip(1)).map(|(a, b)| length([*a, *b])).sum();
        let edges: f64 = edges(&folder, &mesh).into_iter().map(length).sum();
        assert!((edges - around).abs() < 0.1, "{edges} of {around} are edges");
    }
}

#[test]
fn stated_elevations_of_banks_stay_if_they_are_sound() {
    let folder = Folder::new();
    // A plane that falls along an oblique channel of different steps on both sides.
    let place =
        |along: f64, across: f64| [10.0 + 0.8 * along - 0.6 * across, 10.0 + 0.6 * along + 0.8 * across];
    let left: Line = (0..=16).map(|step| place(f64::from(step * 5), 4.0)).collect();
    let right: Line = (0..=4).map(|step| place(f64::from(step * 20), -4.0)).collect();
    let level = |[x, y]: [f64; 2]| ((0.8 * (x - 10.0) + 0.6 * (y - 10.0)) * -10.0).round() / 100.0 + 20.0;
    let bank = |name: &str, vertices: &Line| {
        line(&format!(r#""River":"a","BANK":"{name}""#), vertices, |place| Some(level(place)))
    };
    let features = [bank("Left", &left), bank("RIGHT", &right)];
    for densify in [&[][..], &["--densify", "2.5"]] {
        let (mesh, messages) = flattened(&folder, &collection(&features), densify);
        assert!(messages.contains("\"levels_found\":0") && !messages.contains("took another"), "{messages}");
        let found = vertices(&mesh);
        for [x, y] in left.iter().chain(&right) {
            let place = [x * 100.0, y * 100.0].map(|value: f64| value.round() as i64);
            assert_eq!(at(&found, place), (level([*x, *y]) * 100.0).round() as i64, "{x}, {y}");
        }
    }
    // A bank that is a metre higher: the level is between both, and a notice says so.
    let higher = line(r#""river":"a","bank":"left""#, &left, |place| Some(level(place) + 1.0));
    let file = folder.write("higher.geojson", collection(&[higher, bank("right", &right)]));
    let arguments = [&SCALE[..], &["--flatten", &file, "-"]].concat();
    let part = "22 vertices of banks took another elevation";
    assert_outcome("spfinalize", &arguments, text(&points()).as_bytes(), 0, part);
    // A centre line of the same river states the levels.
    let centre: Line = (0..=4).map(|step| place(f64::from(step * 20), 0.0)).collect();
    let deep = line(r#""river":"a""#, &centre, |place| Some(level(place) - 2.0));
    let banks =
        [soft(r#""river":"a","bank":"left""#, &left), soft(r#""river":"a","bank":"right""#, &right), deep];
    let found = vertices(&flattened(&folder, &collection(&banks), &[]).0);
    for [x, y] in left.iter().chain(&right).chain(&centre) {
        let place = [x * 100.0, y * 100.0].map(|value: f64| value.round() as i64);
        assert_eq!(at(&found, place), (level([*x, *y]) * 100.0).round() as i64 - 200, "{x}, {y}");
    }
}

#[test]
fn the_order_of_features_and_files_changes_nothing() {
    let folder = Folder::new();
    let shifted = |line: Line, y: f64| -> Line { line.into_iter().map(|[x, old]| [x, old + y]).collect() };
    let features = [
        soft(r#""river":"n","bank":"left""#, &shifted(bank(1.0, 4.0), 25.0)),
        soft(r#""river":"s","bank":"right""#, &shifted(bank(-1.0, 2.0), -25.0)),
        soft(r#""river":"n","bank":"right""#, &shifted(bank(-1.0, 5.0), 25.0)),
        soft(r#""river":"s","bank":"left""#, &shifted(bank(1.0, 5.0), -25.0)),
    ];
    let of = |files: &[Vec<usize>]| {
        let paths: Vec<String> = (0..)
            .zip(files)
            .map(|(number, file)| {
                let own: Vec<String> = file.iter().map(|&feature| features[feature].clone()).collect();
                folder.write(&format!("{number}.geojson"), collection(&own))
            })
            .collect();
        let flags = |flag: &'static str| paths.iter().flat_map(move |path| [flag, &path[..]]);
        let arguments: Vec<&str> =
            SCALE.into_iter().chain(["--shore-width", "3"]).chain(flags("--flatten")).chain(["-"]).collect();
        let points = run("spfinalize", &arguments, text(&points()).as_bytes());
        assert_eq!(outcome(&points).0, Some(0), "{:?}", outcome(&points));
        let mesh = run("spdelaunay2d", &[], &points.stdout);
        let constrained = run("spconstrain", &flags("--lines").collect::<Vec<_>>(), &mesh.stdout);
        assert_eq!(outcome(&constrained).0, Some(0), "{:?}", outcome(&constrained));
        (points.stdout, vertices(&constrained.stdout), edges(&folder, &constrained.stdout))
    };
    let expected = of(&[vec![0, 1, 2, 3]]);
    for files in [&[vec![3, 2, 1, 0]][..], &[vec![0, 1], vec![2, 3]], &[vec![2], vec![3, 1], vec![0]]] {
        let found = of(files);
        assert!(found.0 == expected.0, "the points differ: {files:?}");
        assert!(found.1 == expected.1 && found.2 == expected.2, "the meshes differ: {files:?}");
    }
}

#[test]
fn bad_banks_are_refused() {
    let folder = Folder::new();
    let input = text(&points());
    let fails = |features: &[String], part: &str| {
        let file = folder.write("bad.geojson", collection(features));
        let flags = [&SCALE[..], &["--flatten", &file, "--shore-width", "3", "-"]].concat();
        assert_outcome("spfinalize", &flags, input.as_bytes(), 3, part);
    };
    let [left, right] = [r#""river":1,"bank":"left""#, r#""river":1,"bank":"right""#];
    let north = [[10.0, 50.0], [40.0, 50.0], [70.0, 50.0]];
    let south = [[10.0, 40.0], [40.0, 40.0], [70.0, 40.0]];
    let of = |a: &[[f64; 2]], b: &[[f64; 2]]| [soft(left, a), soft(right, b)];
    let back = |line: [[f64; 2]; 3]| [line[2], line[1], line[0]];
    fails(&[soft(left, &north)], "feature 0: the river \"1\" has a left bank alone: add a line");
    fails(&[soft(right, &north)], "bank \"left\"");
    let [a, b] = of(&north, &south);
    fails(&[a.clone(), a.clone(), b.clone()], "feature 1: the river \"1\" has a second left bank");
    fails(&[a.clone(), b.clone(), b.clone()], "feature 2: the river \"1\" has a second right bank");
    fails(&of(&north, &back(south)), "feature 1: the banks lead in opposite directions: reverse one");
    fails(&of(&back(north), &back(south)), "feature 0: the left bank is on the right");
    fails(&of(&south, &north), "exchange left and right");
    let across = [[10.0, 40.0], [40.0, 40.0], [50.0, 60.0], [70.0, 40.0]];
    fails(&of(&north, &across), "feature 1: the banks cross or touch each other at 45, 50");
    let touching = [[10.0, 40.0], [40.0, 50.0], [70.0, 40.0]];
    fails(&of(&north, &touching), "the banks cross or touch each other at 40, 50");
    let looped = [[10.0, 50.0], [40.0, 50.0], [40.0, 60.0], [30.0, 60.0], [30.0, 45.0], [70.0, 45.0]];
    fails(&of(&looped, &south), "feature 0: the left bank crosses or touches itself at 30, 50");
    let hooked = [[10.0, 40.0], [40.0, 40.0], [75.0, 40.0], [75.0, 45.0], [65.0, 46.0], [68.0, 42.0]];
    fails(&of(&north, &hooked), "the line between the ends of the banks crosses or touches a bank");
    let named = |word: &str| soft(&format!(r#""river":1,"bank":"{word}""#), &north);
    fails(&[named("north")], "feature 0: the property bank is \"north\", expected left or right");
    fails(&[soft(r#""bank":"left""#, &north)], "a bank has no property river");
    let polygon = |properties: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"Polygon","coordinates":
            [[[10,20],[20,20],[20,30],[10,20]]]}}}}"#
        )
    };
    fails(&[polygon(left)], "feature 0: a polygon has the property bank, expected a line");
    fails(
        &[a.clone(), b.clone(), polygon(r#""river":1"#)],
        "feature 0: the river \"1\" has a polygon and a bank",
    );
    let around = [250.0, -150.0].map(|y| [[-150.0, y], [250.0, y]]);
    fails(&of(&around[0], &around[1]), "feature 0: no points are near the shore");
    fails(&of(&[[10.0, 50.0], [10.001, 50.0]], &south), "a bank is at one place of the grid");
    // Lines of another meaning are no banks.
    let file = folder.write("roads.geojson", collection(&[named("north"), soft(left, &south)]));
    let flags = [&SCALE[..], &["--lines", &file, "-"]].concat();
    assert_outcome("spfinalize", &flags, input.as_bytes(), 0, "");
}

/// The rows of a report, as fields.
fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().map(|line| line.split('\t').collect()).collect()
}

#[test]
fn the_report_says_how_levels_were_found() {
    let folder = Folder::new();
    let polygon = |properties: &str, [x, y]: [f64; 2], z: &str| {
        let at = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [0.0, 0.0]];
        let at = at.map(|[u, v]| format!("[{},{}{z}]", x + u, y + v)).join(",");
        let geometry = format!(r#"{{"type":"Polygon","coordinates":[[{at}]]}}"#);
        format!(r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{geometry}}}"#)
    };
    let (left, right) = (bank(1.0, 2.0), bank(-1.0, 5.0));
    let features = [
        polygon("", [10.0, 10.0], ",12.5"),
        polygon(r#""level":"8.25""#, [30.0, 10.0], ""),
        polygon("", [60.0, 10.0], ""),
        soft(r#""river":"tab\there","bank":"left""#, &left),
        soft(r#""river":"tab\there","bank":"right""#, &right),
    ];
    let report = folder.path("report.tsv");
    let flags = ["--shore-width", "3", "--shore-percentile", "0", "--report", &report];
    let (mesh, _) = flattened(&folder, &collection(&features), &flags);
    let found = vertices(&mesh);
    let report = std::fs::read_to_string(&report).expect("a report");
    let mut rows = rows(&report);
    let names = ["kind", "line", "x", "y", "level", "measured", "found", "points", "river", "feature"];
    assert_eq!(rows.remove(0), names);
    assert!(rows.iter().all(|row| row.len() == names.len()), "{report}");
    // Elevations of points near a ring, lowest first, by a search of all points.
    let near = |ring: &[[f64; 2]]| {
        let is_near = |point: &[i64; 3]| {
            let place = [point[0] as f64 / 100.0, point[1] as f64 / 100.0];
            distance(ring, place) <= 3.0 && !is_in(ring, place)
        };
        let mut heights: Vec<i64> = points().into_iter().filter(is_near).map(|point| point[2]).collect();
        heights.sort_unstable();
        heights
    };
    let lakes: Vec<_> = rows.iter().filter(|row| row[0] == "lake").collect();
    assert_eq!(lakes[0][4..9], ["12.5", "12.5", "coordinates", "", ""]);
    assert_eq!(lakes[1][4..9], ["8.25", "8.25", "property", "", ""]);
    let heights = near(&[[60.0, 10.0], [69.0, 10.0], [69.0, 19.0], [60.0, 19.0]]);
    let (level, count) = ((heights[0] as f64 / 100.0).to_string(), heights.len().to_string());
    assert_eq!(lakes[2][4..9], [&level, &level, "points", &count, ""]);
    assert!(lakes[2][1] == "2" && lakes[2][9].ends_with("water.geojson: feature 2"), "{:?}", lakes[2]);
    assert_eq!(lakes.len(), 3);
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let stations: Vec<_> = rows.iter().filter(|row| row[0] == "station").collect();
    assert_eq!(stations.len(), left.len() + right.len() - 1);
    let levels: Vec<f64> = stations.iter().map(|row| number(row[4])).collect();
    assert!(levels.is_sorted_by(|a, b| a >= b), "{levels:?}");
    let heights = near(&ring(&left, &right));
    let measured = || stations.iter().filter(|row| row[6] == "points");
    assert_eq!(measured().map(|row| number(row[7])).sum::<f64>(), heights.len() as f64);
    let lowest = measured().map(|row| number(row[5])).fold(f64::INFINITY, f64::min);
    assert_eq!((lowest * 100.0).round() as i64, heights[0]);
    for row in &stations {
        let is_sound = if row[6] == "points" {
            number(row[4]) <= number(row[5])
        } else {
            row[5..8] == ["", "interpolated", ""]
        };
        assert!(is_sound && row[8] == "tab here" && row[1] == "3", "{row:?}");
        assert!(
            is_in(&ring(&left, &right), [number(row[2]), number(row[3])])
                || distance(&ring(&left, &right), [number(row[2]), number(row[3])]) < 0.02
        );
    }
    // The ends of the banks have the first and the last of these levels.
    let mut ends = String::new();
    for [x, y] in [left[0], left[left.len() - 1]] {
        let place = [x * 100.0, y * 100.0].map(|value: f64| value.round() as i64);
        write!(ends, "{} ", at(&found, place)).expect("text");
    }
    let [first, last] = [levels[0], levels[levels.len() - 1]].map(|z| (z * 100.0).round());
    assert_eq!(ends, format!("{first} {last} "));
    // Without water, the table has four columns.
    let file = folder.write("lines.txt", "soft 20 20 40 40\nsoft 20 40 40 20\n");
    let path = folder.path("plain.tsv");
    let flags = [&SCALE[..], &["--lines", &file, "--report", &path, "-"]].concat();
    assert_outcome("spfinalize", &flags, text(&points()).as_bytes(), 0, "");
    assert_eq!(std::fs::read_to_string(&path).expect("a report"), "kind\tline\tx\ty\ncrossing\t0\t30\t30\n");
}
