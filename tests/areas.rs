//! `spfinalize --clip` and `--drop-inside` against a search of all edges in integers.

use spmesh_base::random::Random;
use spmesh_stream::{Event, StreamReader};

use crate::programs::{Folder, assert_outcome, outcome, run, sample};

type Place = [i64; 2];
type Rings = Vec<Vec<Place>>;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd)]
enum Side {
    Outside,
    Border,
    Inside,
}

/// Where a place lies. The ray goes up, an edge has its left end and not its right one.
fn side(polygon: &Rings, [x, y]: Place) -> Side {
    let mut is_inside = false;
    for ring in polygon {
        for (index, &a) in ring.iter().enumerate() {
            let b = ring[(index + 1) % ring.len()];
            let wide = |value: i64| i128::from(value);
            let turn = wide(b[0] - a[0]) * wide(y - a[1]) - wide(b[1] - a[1]) * wide(x - a[0]);
            let between =
                |axis: usize, value: i64| a[axis].min(b[axis]) <= value && value <= a[axis].max(b[axis]);
            if turn == 0 && between(0, x) && between(1, y) {
                return Side::Border;
            }
            // The edge is above the place: the place is on its right if it leads to the right.
            let is_above = if a[0] < b[0] { turn < 0 } else { turn > 0 };
            is_inside ^= (a[0] <= x) != (b[0] <= x) && is_above;
        }
    }
    if is_inside { Side::Inside } else { Side::Outside }
}

fn union(polygons: &[Rings], place: Place) -> Side {
    let sides = polygons.iter().map(|polygon| side(polygon, place));
    sides.fold(Side::Outside, |most, side| if side > most { side } else { most })
}

/// Polygons of random vertices, which cross themselves, lie in each other and share vertices and edges.
fn polygons(random: &mut Random, extent: u64) -> Vec<Rings> {
    let place = |random: &mut Random| [0; 2].map(|_: i64| random.below(extent) as i64);
    let mut polygons: Vec<Rings> = Vec::new();
    for number in 0..12 {
        let ring = |random: &mut Random| (0..3 + number % 5).map(|_| place(random)).collect::<Vec<_>>();
        let mut rings = vec![ring(random)];
        if number % 3 == 0 {
            rings.push(ring(random));
        }
        let [x, y] = place(random);
        let size = 1 + random.below(extent / 8) as i64;
        let square =
            |x: i64, y: i64, size: i64| vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]];
        let framed = vec![square(x, y, 3 * size), square(x + size, y + size, size)];
        polygons.extend([rings, framed, vec![square(x + 3 * size, y, size)]]);
    }
    polygons
}

/// Points at vertices, on edges and anywhere.
fn points(random: &mut Random, polygons: &[Rings], extent: u64) -> Vec<Place> {
    let mut points: Vec<Place> = polygons.iter().flatten().flatten().copied().collect();
    for ring in polygons.iter().flatten() {
        for (index, a) in ring.iter().enumerate() {
            let b = ring[(index + 1) % ring.len()];
            points.push([0, 1].map(|axis| (a[axis] + b[axis]).div_euclid(2)));
        }
    }
    points.extend((0..4000).map(|_| [0; 2].map(|_: i64| random.below(extent + extent / 4) as i64)));
    points.sort_unstable();
    points.dedup();
    points
}

fn geojson(polygons: &[Rings], world: impl Fn(i64) -> f64) -> String {
    let ring = |ring: &Vec<Place>| {
        let places = ring.iter().chain(ring.first());
        let places: Vec<String> = places.map(|&[x, y]| format!("[{:?},{:?}]", world(x), world(y))).collect();
        format!("[{}]", places.join(","))
    };
    let polygon = |rings: &Rings| format!("[{}]", rings.iter().map(ring).collect::<Vec<_>>().join(","));
    let all: Vec<String> = polygons.iter().map(polygon).collect();
    format!(r#"{{"type":"MultiPolygon","coordinates":[{}]}}"#, all.join(","))
}

/// The stored x and y of the points of a stream, sorted.
fn stored(stream: &[u8]) -> Vec<[f64; 2]> {
    let mut reader = StreamReader::new(stream, "test").expect("a stream");
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().expect("a stream") {
        if let Event::Points(points) = event {
            found.extend(points.iter().map(|&[x, y, _]| [x, y]));
        }
    }
    found.sort_unstable_by(|a, b| a.partial_cmp(b).expect("finite"));
    found
}

/// Runs `spfinalize`; the stream, and the counts of points dropped by polygons.
fn finalized(arguments: &[&str], input: &[u8]) -> (Vec<u8>, [u64; 2]) {
    let output = run("spfinalize", &[&["--stats=json"], arguments].concat(), input);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    let stats = message.lines().find(|line| line.starts_with('{')).expect("JSON");
    let stats: serde_json::Value = serde_json::from_str(stats).expect("JSON");
    let count = |name: &str| stats["dropped"][name].as_u64().expect("a count");
    (output.stdout, [count("clip"), count("drop_inside")])
}

/// Compares the points that are kept with those of the search. `bytes` is the input, `world` a coordinate in
/// the file of polygons, `stored_of` one in the stream.
fn compare(
    seed: u64,
    extent: u64,
    flags: &[&str],
    bytes: impl Fn(&[Place]) -> Vec<u8>,
    world: impl Fn(i64) -> f64 + Copy,
    stored_of: impl Fn(i64) -> f64,
) {
    let mut random = Random::new(seed);
    let polygons = polygons(&mut random, extent);
    let points = points(&mut random, &polygons, extent);
    let (clip, drop) = polygons.split_at(polygons.len() / 2);
    let folder = Folder::new();
    let clip_file = folder.write("clip.geojson", geojson(clip, world));
    let drop_file = folder.write("drop.geojson", geojson(drop, world));
    let is_clipped = |place: Place| union(clip, place) == Side::Outside;
    let is_dropped = |place: Place| union(drop, place) == Side::Inside;
    let (mut kept, mut counts) = (Vec::new(), [0, 0]);
    for &place in &points {
        match (is_clipped(place), is_dropped(place)) {
            (true, _) => counts[0] += 1,
            (_, true) => counts[1] += 1,
            _ => kept.push(place.map(&stored_of)),
        }
    }
    assert!(counts.iter().all(|&count| count > 100) && kept.len() > 100, "seed {seed}: {counts:?}");
    let arguments = [flags, &["--clip", &clip_file, "--drop-inside", &drop_file]].concat();
    let input = bytes(&points);
    let (stream, found) = finalized(&arguments, &input);
    assert_eq!(stored(&stream), kept, "seed {seed}");
    assert_eq!(found, counts, "seed {seed}");
    for more in [["--threads", "1"], ["--spool", "always"], ["--memory", "64M"]] {
        assert!(finalized(&[&arguments[..], &more].concat(), &input).0 == stream, "seed {seed}: {more:?}");
    }
    // The order of points changes their order within cells alone.
    let mut reversed = points.clone();
    reversed.reverse();
    assert_eq!(stored(&finalized(&arguments, &bytes(&reversed)).0), kept, "seed {seed}");
}

#[test]
fn points_of_a_grid_are_selected_exactly() {
    let text = |points: &[Place]| {
        let line = |&[x, y]: &Place| format!("{:.2} {:.2} 1\n", x as f64 / 100.0, y as f64 / 100.0);
        points.iter().map(line).collect::<String>().into_bytes()
    };
    for seed in 0..4 {
        let extent = [40, 300, 10_000, 1_000_000][seed as usize];
        let flags = ["--scale", "0.01,0.01,0.01"];
        compare(seed, extent, &flags, text, |value| value as f64 / 100.0, |value| value as f64);
    }
}

#[test]
fn huge_coordinates_are_selected_exactly() {
    for (seed, power) in [(10, 40), (11, 900), (12, -1000)] {
        let world = |value: i64| value as f64 * 2f64.powi(power);
        let raw = |points: &[Place]| {
            let of = |&[x, y]: &Place| [world(x), world(y), 1.0].map(f64::to_le_bytes).concat();
            points.iter().flat_map(of).collect::<Vec<u8>>()
        };
        compare(seed, 1 << 20, &["--raw", "f64le"], raw, world, world);
    }
}

#[test]
fn files_of_any_format_are_clipped() {
    let laz = sample("lareunion.laz");
    let all = stored(&finalized(&[&laz], b"").0);
    let mut reader_bytes = finalized(&[&laz], b"").0;
    let header = StreamReader::new(&reader_bytes[..], "test").expect("a stream").header().clone();
    reader_bytes.clear();
    let middle = |axis: usize| (all.iter().map(|place| place[axis]).sum::<f64>() / all.len() as f64).round();
    let [x, y] = [middle(0), middle(1)];
    let corners = [[x - 900.0, y - 1500.0], [x + 1200.0, y - 300.0], [x + 100.0, y + 1800.0]];
    let ring: Vec<Place> = corners.iter().map(|corner| corner.map(|value| value as i64)).collect();
    let expected = |wanted: &dyn Fn(Side) -> bool| {
        let is_kept = |place: &&[f64; 2]| wanted(side(&vec![ring.clone()], place.map(|value| value as i64)));
        all.iter().filter(is_kept).copied().collect::<Vec<_>>()
    };
    let world = corners.map(|[x, y]| header.coordinates.to_decimal([x, y, 0.0]));
    let text: Vec<String> =
        world.iter().chain([&world[0]]).map(|[x, y, _]| format!("{x:?} {y:?} 7")).collect();
    let folder = Folder::new();
    let wkt = folder.write("area.wkt", format!("\u{feff} polygon z (({}))", text.join(",")));
    let (clipped, [outside, _]) = finalized(&["--clip", &wkt, &laz], b"");
    let inside = expected(&|side| side != Side::Outside);
    assert!(inside.len() > 1000 && all.len() - inside.len() > 1000, "{}", inside.len());
    assert_eq!(stored(&clipped), inside);
    assert_eq!(outside as usize, all.len() - inside.len());
    let (dropped, _) = finalized(&["--drop-inside", &wkt, &laz], b"");
    assert_eq!(stored(&dropped), expected(&|side| side != Side::Inside));
    let (both, [_, count]) = finalized(&["--clip", &wkt, "--drop-inside", &wkt, &laz], b"");
    assert_eq!(stored(&both), expected(&|side| side == Side::Border));
    assert_eq!(count as usize, expected(&|side| side == Side::Inside).len());
    // Attributes stay with their points: the lines of text are some of those of all points.
    let attributes = ["--attributes", "intensity,gps_time"];
    let rows = |arguments: &[&str]| {
        let (stream, _) = finalized(&[&attributes[..], arguments].concat(), b"");
        let text = run("spconvert", &["--to", "text"], &stream).stdout;
        let text = String::from_utf8(text).expect("text");
        text.lines().filter(|line| line.starts_with('v')).map(str::to_string).collect::<Vec<_>>()
    };
    let known: std::collections::HashSet<String> = rows(&[&laz]).into_iter().collect();
    let found = rows(&["--clip", &wkt, &laz]);
    assert!(found.len() == inside.len() && found.iter().all(|row| known.contains(row)));
}

#[test]
fn what_cannot_select_points_is_refused() {
    let folder = Folder::new();
    let points = folder.write("points.txt", "0 0 0\n1 0 0\n0 1 0\n");
    let line = folder.write("line.txt", "line 0 0 1 1 1 2\n");
    let open =
        folder.write("open.geojson", r#"{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[5,6]]]}"#);
    let nan = folder.write("nan.wkt", "POLYGON((0 0,1 nan,1 1,0 0))");
    assert_outcome(
        "spfinalize",
        &["--clip", &line, &points],
        b"",
        3,
        "line 1: found a line, expected polygons",
    );
    assert_outcome(
        "spfinalize",
        &["--clip", &open, &points],
        b"",
        3,
        "a ring starts at 0, 0 and ends at 5, 6",
    );
    assert_outcome("spfinalize", &["--drop-inside", &nan, &points], b"", 3, "nan.wkt: line 1: found \"nan\"");
    assert_outcome("spfinalize", &["--clip", "-", "-"], b"", 2, "only one of");
    assert_outcome("spfinalize", &["--clip", "none.shp", &points], b"", 1, "none.shp");
    let lines = sample("lines.gpkg");
    let crs = ["--crs", "EPSG:25833"];
    assert_outcome("spfinalize", &[&crs[..], &["--clip", &lines, &points]].concat(), b"", 2, "EPSG:25833");
    let far = folder.write("far.wkt", "POLYGON((90 90,91 90,91 91,90 90))");
    assert_outcome("spfinalize", &["--clip", &far, &points], b"", 0, "no points: the input has none");
    let both = [&["--clip", &far, "--lines", &line, "--stats=json"][..], &[&points]].concat();
    assert_outcome("spfinalize", &both, b"", 0, "\"points\":2,");
}
