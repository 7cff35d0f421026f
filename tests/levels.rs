//! `spfinalize --levels`: the levels of a whole layer of water, found once, on which all runs then agree.

use std::collections::BTreeMap;
use std::fs;
use std::process::Output;

use serde_json::{Value, json};
use spmesh_base::random::Random;

use crate::las_file::LasFile;
use crate::programs::{Folder, assert_outcome, outcome, run};
use crate::water::{cells, distance, is_in, vertices};

type Place = [f64; 2];

/// Points within this distance of a shore count.
const WIDTH: f64 = 4.0;

/// A block of 2 by 2 tiles of 100 m, with ground and with points of water in the pond.
pub(crate) struct Block {
    pub(crate) folder: Folder,
    pub(crate) tiles: Vec<String>,
    /// Hundredths of metres.
    ground: Vec<[i32; 3]>,
    pond: Vec<i32>,
}

fn lake_in_four_tiles() -> Vec<Place> {
    (0..24)
        .map(|it| f64::from(it) * std::f64::consts::TAU / 24.0)
        .map(|it| [rounded(100.0 + 17.0 * it.cos()), rounded(100.0 + 11.0 * it.sin())])
        .collect()
}

fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// Half of it is outside of the block, and a corner of the block is in it.
const AT_CORNER: [Place; 4] = [[180.0, 185.0], [230.0, 180.0], [235.0, 240.0], [178.0, 232.0]];
const POND: [Place; 4] = [[20.0, 150.0], [35.0, 151.0], [36.0, 163.0], [21.0, 164.0]];
const STATED: [Place; 4] = [[150.0, 120.0], [162.0, 121.0], [160.0, 133.0], [151.0, 131.0]];
const BY_BANKS: [[Place; 3]; 2] =
    [[[10.0, 78.0], [60.0, 80.0], [320.0, 59.0]], [[10.0, 72.0], [60.0, 74.0], [320.0, 50.0]]];
const CENTRE: [Place; 4] = [[-400.0, 30.0], [40.0, 30.0], [130.0, 44.0], [700.0, 30.0]];
const RIVER: [Place; 8] = [
    [-400.0, 33.0],
    [40.0, 33.0],
    [130.0, 47.0],
    [700.0, 33.0],
    [700.0, 27.0],
    [130.0, 41.0],
    [40.0, 27.0],
    [-400.0, 27.0],
];

/// The layer of a country, most of which is away from the block.
fn country() -> String {
    let closed = |ring: &[Place]| [ring, &ring[..1]].concat();
    let feature = |geometry: &str, coordinates: Value, properties: Value| json!({"type": "Feature", "properties": properties, "geometry": {"type": geometry, "coordinates": coordinates}});
    let lake = |ring: &[Place], properties: Value| feature("Polygon", json!([closed(ring)]), properties);
    let at = |x: f64, y: f64| [[x, y], [x + 20.0, y], [x + 20.0, y + 20.0], [x, y + 20.0]];
    let mut features = vec![
        lake(&lake_in_four_tiles(), json!({})),
        lake(&AT_CORNER, json!({})),
        lake(&POND, json!({})),
        lake(&STATED, json!({"level": 48.5})),
        lake(&RIVER, json!({"river": "Aare"})),
        feature("LineString", json!(CENTRE), json!({"river": "Aare"})),
        feature("LineString", json!(BY_BANKS[0]), json!({"river": "Inn", "bank": "left"})),
        feature("LineString", json!(BY_BANKS[1]), json!({"river": "Inn", "bank": "right"})),
    ];
    for far in 0..20 {
        let level = if far % 2 == 0 { json!({}) } else { json!({"level": 7.0}) };
        features.push(lake(&at(5000.0 + 100.0 * f64::from(far), -3000.0), level));
    }
    json!({"type": "FeatureCollection", "features": features}).to_string()
}

impl Block {
    pub(crate) fn new() -> Block {
        let folder = Folder::new();
        let mut random = Random::new(3);
        let (mut ground, mut pond) = (Vec::new(), Vec::new());
        let mut tiles = vec![(Vec::new(), Vec::new()); 4];
        for number in 0..14400 {
            let [x, y] = [number % 120, number / 120].map(|at| at * 166 + random.below(160) as i32);
            let z = 6000 - x / 20 + y / 50 + random.below(60) as i32;
            let tile = &mut tiles[(x / 10000 + 2 * (y / 10000)) as usize];
            if is_in(&POND, [x, y].map(|at| f64::from(at) / 100.0)) {
                tile.1.push([x, y, 5500 + z % 7]);
                pond.push(5500 + z % 7);
            } else {
                tile.0.push([x, y, z]);
                ground.push([x, y, z]);
            }
        }
        let write = |(number, (ground, water)): (usize, (Vec<_>, Vec<_>))| {
            let mut las = LasFile { scale: [0.01; 3], ..LasFile::of(&[&ground[..], &water[..]].concat()) };
            las.records.iter_mut().for_each(|record| record.class = 2);
            las.records[ground.len()..].iter_mut().for_each(|record| record.class = 9);
            folder.write(&format!("tile{number}.las"), las.bytes())
        };
        let tiles = tiles.into_iter().enumerate().map(write).collect();
        folder.write("country.geojson", country());
        Block { folder, tiles, ground, pond }
    }

    /// Writes the layer of levels, and returns its features by what they are of, and messages.
    pub(crate) fn levels(&self, flags: &[&str]) -> (BTreeMap<String, Value>, String) {
        let [country, levels] = ["country.geojson", "levels.geojson"].map(|name| self.folder.path(name));
        let own = ["--flatten", &country, "--levels", &levels, "--keep-class", "2", "--shore-width", "4"];
        let tiles: Vec<&str> = self.tiles.iter().map(String::as_str).collect();
        let (code, messages) = outcome(&run("spfinalize", &[&own, flags, &tiles].concat(), &[]));
        assert_eq!(code, Some(0), "{messages}");
        let layer: Value = serde_json::from_slice(&fs::read(levels).unwrap()).unwrap();
        let name = |feature: &Value| {
            let properties = &feature["properties"];
            properties["river"]
                .as_str()
                .or(properties["feature"].as_str())
                .unwrap()
                .rsplit(": ")
                .next()
                .unwrap()
                .to_string()
        };
        let features = layer["features"].as_array().unwrap();
        (features.iter().map(|feature| (name(feature), feature.clone())).collect(), messages)
    }

    /// The mesh of these tiles with the levels as edges, and the messages.
    pub(crate) fn mesh(&self, tiles: &[String]) -> Vec<u8> {
        let levels = self.folder.path("levels.geojson");
        let flags = ["--flatten", &levels, "--keep-class", "2", "--shore-width", "4"];
        let tiles: Vec<&str> = tiles.iter().map(String::as_str).collect();
        let points = run("spfinalize", &[&flags[..], &tiles].concat(), &[]);
        assert_eq!(outcome(&points).0, Some(0), "{}", outcome(&points).1);
        run("spdelaunay2d", &[], &points.stdout).stdout
    }

    fn constrained(&self, mesh: &[u8]) -> Vec<u8> {
        let output = run("spconstrain", &["--lines", &self.folder.path("levels.geojson")], mesh);
        assert_eq!(outcome(&output).0, Some(0), "{}", outcome(&output).1);
        output.stdout
    }

    /// The raster of a mesh.
    fn raster(&self, mesh: &str) -> String {
        let raster = self.folder.path("dem.asc");
        succeed(&run("spdem", &["--step", "1", "-o", &raster, mesh], &[]));
        fs::read_to_string(raster).unwrap()
    }

    /// The ground near a shore and outside of all water, in hundredths.
    fn near(&self, ring: &[Place]) -> Vec<[i32; 3]> {
        let lake = lake_in_four_tiles();
        let banks = [BY_BANKS[0].to_vec(), BY_BANKS[1].iter().rev().copied().collect()].concat();
        let water: [&[Place]; 6] = [&lake, &AT_CORNER, &POND, &STATED, &RIVER, &banks];
        let is_near = |[x, y, _]: &&[i32; 3]| {
            let place = [*x, *y].map(|at| f64::from(at) / 100.0);
            distance(ring, place) <= WIDTH && !water.iter().any(|ring| is_in(ring, place))
        };
        self.ground.iter().filter(is_near).copied().collect()
    }
}

fn hundredths(value: &Value) -> i32 {
    (value.as_f64().unwrap() * 100.0).round() as i32
}

fn ring(feature: &Value) -> Vec<[f64; 3]> {
    let vertices = feature["geometry"]["coordinates"][0].as_array().unwrap();
    vertices.iter().map(|vertex| [0, 1, 2].map(|axis| vertex[axis].as_f64().unwrap())).collect()
}

/// The least of values such that so much of all, in percent, is not above it.
fn percentile(mut values: Vec<i32>, percent: usize) -> i32 {
    values.sort_unstable();
    values[(percent * values.len()).div_ceil(100).max(1) - 1]
}

#[test]
fn levels_are_those_of_all_points_and_end_at_the_block() {
    let block = Block::new();
    let (features, messages) = block.levels(&["--water-points", "20"]);
    assert!(messages.contains("20 of 26 polygons of water are left out"), "{messages}");
    assert!(messages.contains("feature 3: the level 48.5 is stated, but"), "{messages}");
    assert_eq!(
        features.keys().collect::<Vec<_>>(),
        ["Aare", "Inn", "feature 0", "feature 1", "feature 2", "feature 3"]
    );
    for feature in features.values() {
        assert!(ring(feature).iter().all(|place| (0..2).all(|axis| (0.0..=200.0).contains(&place[axis]))));
    }
    let lake = lake_in_four_tiles();
    for (name, shore) in [("feature 0", &lake[..]), ("feature 1", &AT_CORNER), ("feature 3", &STATED)] {
        let (near, properties) = (block.near(shore), &features[name]["properties"]);
        let heights: Vec<i32> = near.iter().map(|point| point[2]).collect();
        let (expected, spread) = (
            percentile(heights.clone(), 10),
            percentile(heights.clone(), 90) - percentile(heights.clone(), 10),
        );
        assert_eq!(properties["points"], near.len(), "{name}");
        assert_eq!(
            [hundredths(&properties["measured"]), hundredths(&properties["spread"])],
            [expected, spread],
            "{name}"
        );
        let (level, source) = if name == "feature 3" { (4850, "property") } else { (expected, "points") };
        assert_eq!(
            (hundredths(&properties["level"]), &properties["source"]),
            (level, &json!(source)),
            "{name}"
        );
        assert_eq!(properties["below"], heights.iter().filter(|&&z| z < level).count(), "{name}");
        assert!(
            ring(&features[name]).iter().all(|place| (place[2] * 100.0).round() as i32 == level),
            "{name}"
        );
    }
    let pond = &features["feature 2"]["properties"];
    assert_eq!(
        (hundredths(&pond["level"]), &pond["source"]),
        (percentile(block.pond.clone(), 50), &json!("water"))
    );
    // The corner of the block is in the lake, and so a vertex of what is left of it.
    let reach = |axis: usize| block.ground.iter().map(|point| point[axis]).max().unwrap();
    let corner = [reach(0), reach(1)].map(|at| f64::from(at) / 100.0);
    assert!(ring(&features["feature 1"]).iter().any(|place| [place[0], place[1]] == corner));
}

#[test]
fn all_runs_agree_on_levels() {
    let block = Block::new();
    let (features, _) = block.levels(&[]);
    let whole = block.mesh(&block.tiles);
    let plan = block.folder.path("plan.json");
    let levels = block.folder.path("levels.geojson");
    let flags = [
        "--plan",
        &plan,
        "--leaf-points",
        "900",
        "--keep-class",
        "2",
        "--flatten",
        &levels,
        "--shore-width",
        "4",
    ];
    let tiles: Vec<&str> = block.tiles.iter().map(String::as_str).collect();
    succeed(&run("spfinalize", &[&flags[..], &tiles].concat(), &[]));
    let [parts, manifest] = ["parts", "mesh.json"].map(|name| block.folder.path(name));
    let nodes = String::from_utf8(run("spnode", &["list", &plan], &[]).stdout).unwrap();
    let nodes: Vec<&str> = nodes.lines().map(|line| line.split('\t').next().unwrap()).collect();
    assert!(nodes.len() > 8);
    succeed(&run("spnode", &[&["run", "-d", &parts, &plan], &nodes[..]].concat(), &[]));
    succeed(&run("spnode", &["collect", &plan, "-d", &parts, "-o", &manifest], &[]));
    let of_whole = block.folder.write("whole.spm", &whole);
    assert!(block.raster(&manifest) == block.raster(&of_whole), "rasters of parts and of one pipe differ");
    // Every tile alone has the same levels.
    let stated: BTreeMap<[i64; 2], i64> = features
        .values()
        .flat_map(ring)
        .map(|place| place.map(|at| (at * 100.0).round() as i64))
        .map(|[x, y, z]| ([x, y], z))
        .collect();
    for tile in &block.tiles {
        let alone = vertices(&block.mesh(std::slice::from_ref(tile)));
        let on_shores = alone.iter().filter_map(|&[x, y, z]| Some((z, *stated.get(&[x, y])?)));
        let mut count = 0;
        on_shores.for_each(|(found, expected)| {
            assert_eq!(found, expected);
            count += 1;
        });
        assert!(count > 10, "{count}");
    }
    // Lakes are flat in every cell, and the river falls from one shore vertex to the next.
    let raster = cells(&block.raster(&block.folder.write("edges.spm", block.constrained(&whole))));
    for (name, shore) in [("feature 0", lake_in_four_tiles()), ("feature 1", AT_CORNER.to_vec())] {
        let level = features[name]["properties"]["level"].as_f64().unwrap();
        let inside = raster.iter().filter(|[x, y, _]| is_in(&shore, [*x, *y]));
        assert!(inside.clone().count() > 200);
        inside
            .for_each(|[x, y, z]| assert!((z - level).abs() < 1e-9, "{name} at {x}, {y}: {z}, not {level}"));
    }
    for bank in [33.0, 27.0] {
        let is_of_bank = |place: &[f64; 3]| [33.0, 47.0, 45.3].contains(&place[1]) == (bank == 33.0);
        let mut along: Vec<[f64; 3]> = ring(&features["Aare"]).into_iter().filter(is_of_bank).collect();
        along.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(along.windows(2).all(|pair| pair[1][2] <= pair[0][2]), "{along:?}");
        assert!(along[0][2] > along[along.len() - 1][2] + 3.0);
    }
}

#[test]
fn shores_are_raised_to_the_water() {
    let block = Block::new();
    block.levels(&["--shore-percentile", "50"]);
    let levels = block.folder.path("levels.geojson");
    let flags =
        ["--flatten", &levels, "--keep-class", "2", "--shore-width", "4", "--raise-shore", "--stats=json"];
    let tiles: Vec<&str> = block.tiles.iter().map(String::as_str).collect();
    let points = run("spfinalize", &[&flags[..], &tiles].concat(), &[]);
    let (code, messages) = outcome(&points);
    assert_eq!(code, Some(0), "{messages}");
    let found = vertices(&run("spdelaunay2d", &[], &points.stdout).stdout);
    let (features, _) = block.levels(&["--shore-percentile", "50"]);
    let lake = lake_in_four_tiles();
    let level = hundredths(&features["feature 0"]["properties"]["level"]);
    let near = block.near(&lake);
    let at: BTreeMap<[i64; 2], i64> = found.into_iter().map(|[x, y, z]| ([x, y], z)).collect();
    assert!(near.iter().filter(|point| point[2] < level).count() > 20);
    for [x, y, z] in near {
        assert_eq!(at[&[x.into(), y.into()]], i64::from(z.max(level)));
    }
    assert!(!messages.contains("\"raised\":0"), "{messages}");
}

#[test]
fn levels_that_make_no_sense_are_refused() {
    let block = Block::new();
    let [country, levels] = ["country.geojson", "out.geojson"].map(|name| block.folder.path(name));
    let tile = &block.tiles[3];
    let strict = ["--flatten", &country, "--levels", &levels, "--strict", "--keep-class", "2", tile];
    assert_outcome("spfinalize", &strict, b"", 3, "feature 3: the level 48.5 is stated");
    assert!(!fs::exists(&levels).unwrap());
    let plan = ["--flatten", &country, "--plan", &levels.replace(".geojson", ".json"), tile];
    assert_outcome("spfinalize", &plan, b"", 2, "write all levels first, with --levels");
    let nothing = ["--flatten", &country, "--levels", &levels, "--keep-class", "77", tile];
    assert_outcome("spfinalize", &nothing, b"", 2, "no points");
    // A river whose polygon lacks an elevation needs a centre line.
    let ring = |z: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"river\":\"Inn\"}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[[110,110,9],[120,110,9],[120,120{z}],[110,110,9]]]}}}}"
        )
    };
    let water = block.folder.write("own.geojson", ring(""));
    assert_outcome("spfinalize", &["--flatten", &water, tile], b"", 3, "third coordinates at all vertices");
    let water = block.folder.write("own.geojson", ring(",8"));
    let points = run("spfinalize", &["--flatten", &water, tile], b"");
    let found = vertices(&run("spdelaunay2d", &[], &points.stdout).stdout);
    assert!(found.contains(&[12000, 12000, 800]) && found.contains(&[11000, 11000, 900]));
}

fn succeed(output: &Output) {
    assert_eq!(outcome(output).0, Some(0), "{}", outcome(output).1);
}

/// Ground at 50 on a grid with points on the border, and water at 10 that comes in over it.
#[test]
fn nothing_dry_is_pulled_down_where_water_is_cut() {
    let folder = Folder::new();
    let places = || (0..21).flat_map(|x| (0..21).map(move |y| [10 * x, 10 * y]));
    let ground = folder
        .write("ground.txt", places().map(|[x, y]| format!("{x}.00 {y}.00 50.00\n")).collect::<String>());
    let arms = "[[150,40],[260,40],[260,160],[150,160],[150,140],[240,140],[240,60],[150,60],[150,40]]";
    let corner = "[[155,260],[155,185],[100,185],[100,280],[280,280],[280,-50],[185,-50],[185,15],[240,15],[240,260],[155,260]]";
    let island =
        "[[-90,-90],[290,-90],[290,290],[-90,290],[-90,-90]],[[-3,-3],[203,-3],[203,203],[-3,203],[-3,-3]]";
    let spike = "[[33,33],[44,44],[66,44],[66,66],[44,66],[44,44],[33,33]]";
    for (rings, parts) in [(arms, 2), (corner, 2), (island, 0), (spike, 1)] {
        let rings = format!("[{rings}]");
        let lake = format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"level\":10}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":{rings}}}}}"
        );
        let [country, levels] = [folder.write("lake.geojson", lake), folder.path("cut.geojson")];
        let scale = ["--scale", "0.01,0.01,0.01"];
        let found = run(
            "spfinalize",
            &[&scale[..], &["--flatten", &country, "--shore-width", "8", "--levels", &levels, &ground]]
                .concat(),
            b"",
        );
        assert_eq!(outcome(&found).0, Some(0), "{}", outcome(&found).1);
        let layer: Value = serde_json::from_slice(&fs::read(&levels).unwrap()).unwrap();
        let geometry = &layer["features"][0]["geometry"];
        let count = match geometry["type"].as_str() {
            None => 0,
            Some("Polygon") => 1,
            _ => geometry["coordinates"].as_array().unwrap().len(),
        };
        assert_eq!(count, parts, "{rings}");
        if parts == 0 {
            continue;
        }
        let points = run("spfinalize", &[&scale[..], &["--flatten", &levels, &ground]].concat(), b"");
        assert_eq!(outcome(&points).0, Some(0), "{}", outcome(&points).1);
        let mesh = run("spdelaunay2d", &[], &points.stdout).stdout;
        let output = run("spconstrain", &["--lines", &levels], &mesh);
        assert_eq!(outcome(&output).0, Some(0), "{}", outcome(&output).1);
        let wet: Vec<Vec<Place>> = layer_rings(geometry);
        let is_wet = |place: Place| wet.iter().any(|ring| is_in(ring, place) || distance(ring, place) < 0.01);
        let mut dry = 0;
        for [x, y, z] in vertices(&output.stdout) {
            let place = [x, y].map(|at| at as f64 / 100.0);
            assert_eq!(z, if is_wet(place) { 1000 } else { 5000 }, "{place:?} of {rings}");
            dry += usize::from(z == 5000);
        }
        assert!(dry > 300);
    }
    // A text states no box, so the points say it; and none are no points.
    let all = [
        "--flatten",
        &folder.path("lake.geojson"),
        "--shore-width",
        "8",
        "--levels",
        &folder.path("cut.geojson"),
        "--keep-z",
        "90,99",
        &ground,
    ];
    assert_outcome("spfinalize", &all, b"", 2, "no points");
}

fn layer_rings(geometry: &Value) -> Vec<Vec<Place>> {
    let polygons = match geometry["type"].as_str() {
        Some("Polygon") => vec![geometry["coordinates"].clone()],
        _ => geometry["coordinates"].as_array().unwrap().clone(),
    };
    let place = |vertex: &Value| [0, 1].map(|axis| vertex[axis].as_f64().unwrap());
    polygons.iter().map(|polygon| polygon[0].as_array().unwrap().iter().map(place).collect()).collect()
}
