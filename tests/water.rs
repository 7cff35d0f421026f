//! `spfinalize --flatten`: lakes are flat and rivers fall, in the mesh and in rasters of it.

use spmesh_base::random::Random;
use spmesh_stream::{Event, StreamReader};

use crate::programs::{Folder, assert_outcome, outcome, run, sample};

/// A lake with an island, and a river with its centre line.
const WATER: &str = r#"{"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"name":"lake"},"geometry":{"type":"Polygon","coordinates":[
 [[20,60],[45.5,58],[50,80.25],[35,90],[18,82],[20,60]],[[30,70],[36,70],[34,76],[30,70]]]}},
{"type":"Feature","geometry":{"type":"LineString","coordinates":[[2,20],[30,24],[60,18],[98,25]]},"properties":{"river":7}},
{"type":"Feature","geometry":{"type":"Polygon","coordinates":[
 [[2,18],[30,21],[60,15],[98,22],[98,28],[60,21],[30,27],[2,22],[2,18]]]},"properties":{"river":"7"}}]}"#;

const LAKE: [[f64; 2]; 5] = [[20.0, 60.0], [45.5, 58.0], [50.0, 80.25], [35.0, 90.0], [18.0, 82.0]];
const ISLAND: [[f64; 2]; 3] = [[30.0, 70.0], [36.0, 70.0], [34.0, 76.0]];
pub(crate) const SCALE: [&str; 2] = ["--scale", "0.01,0.01,0.01"];

/// Points in hundredths: a slope that falls to the right, with waves and noise.
pub(crate) fn points() -> Vec<[i64; 3]> {
    let mut random = Random::new(5);
    let mut points = Vec::new();
    for number in 0..6400 {
        let [x, y] = [number % 80, number / 80].map(|at| at * 127 + random.below(120) as i64);
        let wave = (x as f64 / 900.0).sin() * 150.0 + (y as f64 / 700.0).cos() * 90.0;
        points.push([x, y, 6000 - x / 10 + wave as i64 + random.below(40) as i64]);
    }
    points
}

pub(crate) fn text(points: &[[i64; 3]]) -> String {
    let line = |point: &[i64; 3]| {
        let [x, y, z] = point.map(|value| value as f64 / 100.0);
        format!("{x:.2} {y:.2} {z:.2}\n")
    };
    points.iter().map(line).collect()
}

/// Whether a place is in a ring; places on it do not occur.
pub(crate) fn is_in(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut is_in = false;
    for (index, a) in ring.iter().enumerate() {
        let b = ring[(index + 1) % ring.len()];
        is_in ^= (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }
    is_in
}

fn in_lake(place: [f64; 2]) -> bool {
    is_in(&LAKE, place) && !is_in(&ISLAND, place)
}

pub(crate) fn distance(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let parts = (0..ring.len()).map(|index| [ring[index], ring[(index + 1) % ring.len()]]);
    let away = |[a, b]: [[f64; 2]; 2]| {
        let [u, v] = [b[0] - a[0], b[1] - a[1]];
        let along = (((x - a[0]) * u + (y - a[1]) * v) / (u * u + v * v)).clamp(0.0, 1.0);
        (x - a[0] - along * u).hypot(y - a[1] - along * v)
    };
    parts.map(away).fold(f64::INFINITY, f64::min)
}

/// The level of the lake in hundredths, by a search of all points.
fn level(points: &[[i64; 3]], width: f64, percentile: f64) -> i64 {
    let river = [
        [2.0, 18.0],
        [30.0, 21.0],
        [60.0, 15.0],
        [98.0, 22.0],
        [98.0, 28.0],
        [60.0, 21.0],
        [30.0, 27.0],
        [2.0, 22.0],
    ];
    let is_near = |point: &&[i64; 3]| {
        let place = [point[0] as f64 / 100.0, point[1] as f64 / 100.0];
        let is_near = distance(&LAKE, place) <= width || distance(&ISLAND, place) <= width;
        is_near && !in_lake(place) && !is_in(&river, place)
    };
    let mut heights: Vec<i64> = points.iter().filter(is_near).map(|point| point[2]).collect();
    heights.sort_unstable();
    assert!(heights.len() > 50);
    heights[((percentile / 100.0 * heights.len() as f64).ceil() as usize).max(1) - 1]
}

/// The constrained mesh, and the messages of `spfinalize`.
pub(crate) fn flattened(folder: &Folder, water: &str, flags: &[&str]) -> (Vec<u8>, String) {
    let file = folder.write("water.geojson", water);
    let arguments = [&SCALE[..], &["--flatten", &file, "--stats=json"], flags, &["-"]].concat();
    let output = run("spfinalize", &arguments, text(&points()).as_bytes());
    let (code, messages) = outcome(&output);
    assert_eq!(code, Some(0), "{flags:?}: {messages}");
    let mesh = run("spdelaunay2d", &[], &output.stdout);
    let densify = flags.iter().position(|flag| *flag == "--densify").map_or(&[][..], |at| &flags[at..at + 2]);
    let constrained = run("spconstrain", &[&["--lines", &file], densify].concat(), &mesh.stdout);
    assert_eq!(outcome(&constrained).0, Some(0), "{:?}", outcome(&constrained));
    let (code, message) = outcome(&run("spinfo", &["--audit", "-"], &constrained.stdout));
    assert_eq!(code, Some(0), "{message}");
    (constrained.stdout, messages)
}

/// The vertices of a mesh, in hundredths.
pub(crate) fn vertices(mesh: &[u8]) -> Vec<[i64; 3]> {
    let mut reader = StreamReader::new(mesh, "test").expect("a stream");
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().expect("a sound stream") {
        if let Event::Patch(patch) = event {
            found.extend(patch.new.iter().map(|point| point.map(|value| value as i64)));
        }
    }
    found
}

/// Elevation of a vertex at a place in hundredths.
pub(crate) fn at(vertices: &[[i64; 3]], place: [i64; 2]) -> i64 {
    vertices.iter().find(|[x, y, _]| [*x, *y] == place).unwrap_or_else(|| panic!("no vertex at {place:?}"))[2]
}

#[test]
fn lakes_are_flat_at_the_percentile_of_their_shore() {
    let folder = Folder::new();
    let points = points();
    for (percentile, width) in [(10.0, 3.0), (0.0, 2.0), (50.0, 4.5), (100.0, 1.5)] {
        let [p, w] = [percentile, width].map(|value: f64| value.to_string());
        let flags = ["--shore-percentile", &p, "--shore-width", &w];
        let (mesh, messages) = flattened(&folder, WATER, &flags);
        let expected = level(&points, width, percentile);
        let found = vertices(&mesh);
        for [x, y] in LAKE.iter().chain(&ISLAND) {
            assert_eq!(at(&found, [x * 100.0, y * 100.0].map(|value| value.round() as i64)), expected);
        }
        // No point is left inside.
        let inside = found.iter().filter(|[x, y, _]| in_lake([*x as f64 / 100.0, *y as f64 / 100.0]));
        assert!(inside.filter(|vertex| vertex[2] != expected).count() == 0);
        let dem = folder.path("dem.asc");
        let (code, message) = outcome(&run("spdem", &["--step", "0.5", "-o", &dem], &mesh));
        assert_eq!(code, Some(0), "{message}");
        let cells = cells(&std::fs::read_to_string(&dem).expect("a raster"));
        let flat: Vec<f64> =
            cells.iter().filter(|cell| in_lake([cell[0], cell[1]])).map(|cell| cell[2]).collect();
        assert!(flat.len() > 2000, "{}", flat.len());
        let step = |z: &f64| (z - expected as f64 / 100.0).abs() < 1e-4;
        assert!(flat.iter().all(step), "{expected}: {:?}", flat.iter().find(|z| !step(z)));
        assert!(messages.contains("\"water\":{\"lakes\":1,"), "{messages}");
    }
    // Threads, the order of points and spools change nothing.
    let flags = ["--shore-width", "3"];
    let (mesh, _) = flattened(&folder, WATER, &flags);
    for more in [["--threads", "1"], ["--spool", "always"]] {
        assert!(flattened(&folder, WATER, &[&flags[..], &more].concat()).0 == mesh, "{more:?}");
    }
    flattened(&folder, WATER, &[]);
}

/// x, y and z of the cells of an ESRI grid that have data.
pub(crate) fn cells(text: &str) -> Vec<[f64; 3]> {
    let mut words = text.split_ascii_whitespace();
    let mut header = std::collections::HashMap::new();
    let mut next = words.next();
    while let Some(name) = next.filter(|word| word.starts_with(|first: char| first.is_ascii_alphabetic())) {
        header.insert(
            name.to_ascii_lowercase(),
            words.next().expect("a value").parse::<f64>().expect("a number"),
        );
        next = words.next();
    }
    let values: Vec<f64> =
        next.into_iter().chain(words).map(|word| word.parse().expect("a number")).collect();
    let of = |name: &str| header[name];
    let [columns, rows] = [of("ncols") as usize, of("nrows") as usize];
    assert_eq!(values.len(), columns * rows);
    let cell = |(number, &z): (usize, &f64)| {
        let [column, row] = [number % columns, rows - 1 - number / columns];
        let size = of("cellsize");
        let place =
            [of("xllcorner") + (column as f64 + 0.5) * size, of("yllcorner") + (row as f64 + 0.5) * size];
        (z != of("nodata_value")).then_some([place[0], place[1], z])
    };
    values.iter().enumerate().filter_map(cell).collect()
}

#[test]
fn rivers_fall_and_are_level_across() {
    let folder = Folder::new();
    let (mesh, messages) = flattened(&folder, WATER, &["--shore-width", "3", "--densify", "4"]);
    assert!(messages.contains("\"rivers\":1") && !messages.contains("must lead downstream"), "{messages}");
    let dem = folder.path("dem.asc");
    let (code, message) = outcome(&run("spdem", &["--step", "0.25", "-o", &dem], &mesh));
    assert_eq!(code, Some(0), "{message}");
    let cells = cells(&std::fs::read_to_string(&dem).expect("a raster"));
    let size = 0.25;
    let nearest = |place: [f64; 2]| {
        let is_here = |cell: &&[f64; 3]| {
            (cell[0] - place[0]).abs() <= size / 2.0 + 1e-9 && (cell[1] - place[1]).abs() <= size / 2.0 + 1e-9
        };
        cells.iter().find(is_here).expect("a cell")[2]
    };
    // Vertices of the centre line fall.
    let centre = [[2, 20], [30, 24], [60, 18], [98, 25]];
    let found = vertices(&mesh);
    let heights: Vec<i64> = centre.iter().map(|[x, y]| at(&found, [x * 100, y * 100])).collect();
    assert!(heights.is_sorted_by(|a, b| a >= b) && heights[0] > heights[3] + 300, "{heights:?}");
    // So do samples along it, by no more than one cell of a raster rises across the line.
    let mut before = f64::INFINITY;
    for [a, b] in [[centre[0], centre[1]], [centre[1], centre[2]], [centre[2], centre[3]]] {
        for step in 1..20 {
            let part = f64::from(step) / 20.0;
            let place = [0, 1].map(|axis| a[axis] as f64 + part * (b[axis] - a[axis]) as f64);
            let z = nearest(place);
            assert!(z <= before + 0.05, "{place:?}: {z} after {before}");
            before = z;
        }
    }
}

#[test]
fn stated_levels_and_rivers_count() {
    let folder = Folder::new();
    let lake = |properties: &str, z: &str| {
        let at = ["40,40", "60,40", "60,60", "40,60", "40,40"].map(|place| format!("[{place}{z}]")).join(",");
        format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{{{properties}}},"geometry":
            {{"type":"Polygon","coordinates":[[{at}]]}}}}]}}"#
        )
    };
    for text in [lake("", ",12.34"), lake(r#""level":12.34"#, ""), lake(r#""Level":"12.34""#, ",12.34")] {
        let (mesh, messages) = flattened(&folder, &text, &[]);
        assert_eq!(at(&vertices(&mesh), [6000, 4000]), 1234);
        assert!(messages.contains("\"levels_found\":0"), "{messages}");
    }
    let river = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"river":"a"},"geometry":{"type":"LineString","coordinates":
         [[10,50,30],[40,50,20],[60,50,25],[90,50,10]]}},
        {"type":"Feature","properties":{"river":"a"},"geometry":{"type":"Polygon","coordinates":
         [[[10,45],[25,45],[50,45],[90,45],[90,55],[75,55],[10,55],[10,45]]]}}]}"#;
    let file = folder.write("river.geojson", river);
    let arguments = [&SCALE[..], &["--flatten", &file, "-"]].concat();
    let output = run("spfinalize", &arguments, text(&points()).as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 vertices of the centre line were lowered"), "{message}");
    let mut reader = StreamReader::new(&output.stdout[..], "test").expect("a stream");
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().expect("a sound stream") {
        if let Event::Points(points) = event {
            found.extend(points.iter().map(|point| point.map(|value| value as i64)));
        }
    }
    for (place, z) in [
        ([1000, 4500], 3000),
        ([2500, 4500], 2500),
        ([5000, 4500], 2000),
        ([7500, 5500], 1500),
        ([6000, 5000], 2000),
        ([9000, 5000], 1000),
    ] {
        assert_eq!(at(&found, place), z, "{place:?}");
    }
}

#[test]
fn bad_water_is_refused_or_right() {
    let folder = Folder::new();
    let input = text(&points());
    let feature = |properties: &str, kind: &str, coordinates: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
        )
    };
    let square = |x: f64, y: f64, z: &str| {
        let at = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [0.0, 0.0]];
        let at = at.map(|[u, v]| format!("[{},{}{z}]", x + u, y + v)).join(",");
        format!("[[{at}]]")
    };
    let fails = |features: &[String], code: i32, part: &str| {
        let all = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
        let file = folder.write("bad.geojson", all);
        let flags = [&SCALE[..], &["--flatten", &file, "--shore-width", "3", "-"]].concat();
        assert_outcome("spfinalize", &flags, input.as_bytes(), code, part);
    };
    let polygon = |properties: &str, rings: String| feature(properties, "Polygon", &rings);
    let line = |properties: &str| feature(properties, "LineString", "[[10,10],[50,10]]");
    // All points are inside of it.
    let around = "[[[-50,-50],[150,-50],[150,150],[-50,150],[-50,-50]]]";
    let message = "bad.geojson: feature 0: no points are near the shore: state its level";
    fails(&[polygon("", around.into())], 3, message);
    fails(&[polygon(r#""river":1"#, square(20.0, 20.0, ""))], 3, "the river \"1\" has no centre line");
    fails(&[line(r#""river":1"#)], 3, "the river \"1\" has no polygon");
    fails(&[line("")], 3, "feature 0: found a line, expected polygons");
    let again = [line(r#""river":1"#), line(r#""river":1"#)];
    fails(&again, 3, "feature 1: the river \"1\" has a second centre line");
    fails(&[polygon(r#""level":"high""#, square(20.0, 20.0, ""))], 3, "\"high\", expected a number");
    fails(&[polygon(r#""level":4"#, square(20.0, 20.0, ",5"))], 3, "the shore has another elevation");
    fails(&[polygon(r#""level":1e9"#, square(20.0, 20.0, ""))], 3, "beyond the grid");
    let mixed = "[[[20,20,1],[30,20,2],[30,30,1],[20,20,1]]]";
    fails(&[polygon("", mixed.into())], 3, "has the elevations 1 and 2, expected one");
    fails(
        &[polygon("", "[[[20,20],[30,20],[30,30],[21,20]]]".into())],
        3,
        "ends at 21, 20: repeat its first",
    );
    fails(&[polygon("", "[[[20,20],[null,20],[30,30],[20,20]]]".into())], 3, "vertex 1 is at NaN");
    let two = |z: [&str; 2]| [polygon("", square(20.0, 20.0, z[0])), polygon("", square(25.0, 25.0, z[1]))];
    fails(&two([",5", ",6"]), 3, "the lake meets another one of a different level");
    fails(&two([",5", ",5"]), 0, "");
    // A ring that crosses itself counts by the even-odd rule.
    fails(&[polygon("", "[[[20,20],[40,40],[40,20],[20,40],[20,20]]]".into())], 0, "");
    let file = folder.write("line.txt", "soft 0 0 1 1\n");
    let flat = folder.write("flat.txt", "0 0\n1 0\n0 1\n");
    assert_outcome("spfinalize", &["--flatten", &file, &flat], b"", 2, "points have no elevation");
    assert_outcome(
        "spfinalize",
        &["--flatten", &file, "--octree", "-"],
        input.as_bytes(),
        2,
        "leave out --octree",
    );
    assert_outcome("spfinalize", &["--shore-width", "3", &flat], b"", 2, "--flatten");
    let wrong = ["--flatten", &file, "--shore-percentile", "101", &flat];
    assert_outcome("spfinalize", &wrong, b"", 2, "expected 0 to 100");
}

#[test]
fn all_formats_state_the_same_water() {
    let of = |files: &[&str]| {
        let files: Vec<String> = files.iter().map(|file| sample(file)).collect();
        let flags = files.iter().flat_map(|file| ["--flatten", file]);
        let laz = sample("lareunion.laz");
        let arguments: Vec<&str> = flags.chain(["--stats=json", &laz]).collect();
        let output = run("spfinalize", &arguments, b"");
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{files:?}: {message}");
        assert!(message.contains("\"lakes\":1") && message.contains("\"rivers\":1"), "{files:?}: {message}");
        output.stdout
    };
    let expected = of(&["water.geojson"]);
    assert!(of(&["water.gpkg"]) == expected);
    assert!(of(&["water.shp", "water_lines.shp"]) == expected);
    assert!(of(&["water_lines.shp", "water.shp"]) == expected);
}

#[test]
fn tables_that_were_cut_off_are_errors() {
    let folder = Folder::new();
    let bytes = |name: &str| std::fs::read(sample(name)).expect("a sample");
    let [shapes, table] = ["water_lines.shp", "water_lines.dbf"].map(bytes);
    let file = folder.write("water.shp", shapes);
    for len in [0, 31, 60, 97, 98, 115] {
        folder.write("water.dbf", &table[..len]);
        let arguments = ["--flatten", &file[..], &sample("lareunion.laz")];
        assert_outcome("spfinalize", &arguments, b"", 3, "the table of attributes is cut off");
    }
}

#[test]
fn shapefiles_have_all_attributes_where_these_decide() {
    let folder = Folder::new();
    let read = |name: &str| std::fs::read(sample(name)).expect("a sample");
    let [shapes, table] = ["water_lines.shp", "water_lines.dbf"].map(read);
    let (file, laz) = (folder.write("water.shp", shapes), sample("lareunion.laz"));
    let lines = ["--lines", &file, &laz, "-o", "/dev/null"];
    let water = ["--flatten", &file, &laz];
    assert_outcome("spfinalize", &water, b"", 3, "water.shp: found no table of attributes beside it (.dbf)");
    assert_outcome("spfinalize", &lines, b"", 0, "");
    assert_outcome("splinefit", &["fit", "--features", &file, &laz], b"", 3, "found no table of attributes");
    for rows in [0, table[4] - 1, table[4] + 1] {
        let mut other = table.clone();
        other[4] = rows;
        other.extend(vec![b' '; 1000]);
        folder.write("water.dbf", other);
        assert_outcome("spfinalize", &water, b"", 3, &format!("found {rows} rows of attributes (.dbf) for"));
        assert_outcome("spfinalize", &lines, b"", 0, "");
    }
    // Programs mark records as deleted, and leave their shapes where they are.
    let mut deleted = table;
    let (start, len) = (usize::from(deleted[8]), usize::from(deleted[10]));
    (0..usize::from(deleted[4])).for_each(|row| deleted[start + row * len] = b'*');
    folder.write("water.dbf", deleted);
    assert_outcome("spfinalize", &water, b"", 3, "water.shp: found no lines");
}

#[test]
fn points_on_shores_are_dropped_too() {
    let folder = Folder::new();
    let square = "[[[5,5],[15,5],[15,15],[5,15],[5,5]]]";
    let lake = format!(
        r#"{{"type":"Feature","properties":{{"level":3}},"geometry":{{"type":"Polygon","coordinates":{square}}}}}"#
    );
    let file = folder.write("lake.geojson", lake);
    let points: String = (0..441).map(|number| format!("{} {} 7\n", number % 21, number / 21)).collect();
    let output = run("spfinalize", &["--flatten", &file, "--stats=json", "-"], points.as_bytes());
    let (code, messages) = outcome(&output);
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("\"flatten\":121,") && messages.contains("\"points\":324,"), "{messages}");
    let mesh = run("spdelaunay2d", &[], &output.stdout).stdout;
    let constrained = run("spconstrain", &["--lines", &file], &mesh).stdout;
    let is_in = |vertex: &&[i64; 3]| vertex[..2].iter().all(|value| (5..=15).contains(value));
    let found = vertices(&constrained);
    let inside: Vec<i64> = found.iter().filter(is_in).map(|vertex| vertex[2]).collect();
    assert_eq!(inside, [3; 4]);
}

#[test]
fn rings_across_a_shore_are_level_with_it() {
    let folder = Folder::new();
    let water = folder.write("water.geojson", WATER);
    let ring = "[[5,40],[33,40],[33,66],[45,95],[5,95],[5,40]]";
    let hull = folder.write("hull.geojson", format!(r#"{{"type":"Polygon","coordinates":[{ring}]}}"#));
    let all = points();
    let points = text(&all);
    // How far vertices of the shore are above its level.
    let run_with = |more: &[&str], densify: &[&str]| {
        let flags = [&SCALE[..], &["--flatten", &water, "--quiet"], more, &["-"]].concat();
        let stream = run("spfinalize", &flags, points.as_bytes()).stdout;
        let mesh = run("spdelaunay2d", &[], &stream).stdout;
        let arguments = [&["--lines", &water, "--hull", &hull], densify].concat();
        let constrained = run("spconstrain", &arguments, &mesh);
        let (code, messages) = outcome(&constrained);
        assert_eq!(code, Some(0), "{messages}");
        let places = vertices(&constrained.stdout);
        let lake = at(&places, [2000, 6000]);
        let is_point = |place: &[i64; 3]| all.iter().any(|point| point[..2] == place[..2]);
        let is_shore = |place: &&[i64; 3]| {
            distance(&LAKE, [place[0] as f64 / 100.0, place[1] as f64 / 100.0]) < 0.02 && !is_point(place)
        };
        places.iter().filter(is_shore).map(|place| place[2] - lake).collect::<Vec<i64>>()
    };
    for (more, densify) in [(&[][..], &[][..]), (&[], &["--densify", "3"]), (&["--lines", &hull], &[])] {
        let shore = run_with(more, densify);
        assert!(shore.len() > LAKE.len() && shore.iter().all(|&above| above == 0), "{shore:?}");
    }
}
