//! `spdem --below-water`: the ground on shores that is lower than the water, with a search of all shores for
//! each cell.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::levels::Block;
use crate::programs::{Folder, assert_outcome, outcome, run};
use crate::water::{cells, is_in};

const WIDTH: f64 = 4.0;

/// The rings of all polygons of a layer, each with those of its feature.
fn rings(layer: &Value) -> Vec<Vec<Vec<[f64; 3]>>> {
    let ring = |ring: &Value| -> Vec<[f64; 3]> {
        let vertices = ring.as_array().expect("a ring").iter();
        vertices.map(|vertex| [0, 1, 2].map(|axis| vertex[axis].as_f64().expect("a number"))).collect()
    };
    let polygon = |polygon: &Value| polygon.as_array().expect("rings").iter().map(ring).collect();
    let of = |feature: &Value| -> Vec<Vec<Vec<[f64; 3]>>> {
        let coordinates = &feature["geometry"]["coordinates"];
        match feature["geometry"]["type"].as_str() {
            Some("Polygon") => vec![polygon(coordinates)],
            _ => coordinates.as_array().expect("polygons").iter().map(polygon).collect(),
        }
    };
    layer["features"].as_array().expect("features").iter().flat_map(of).collect()
}

/// The distance to the nearest shore, and the level of the water there; `None` in water.
fn shore(polygons: &[Vec<Vec<[f64; 3]>>], place: [f64; 2]) -> Option<(f64, f64)> {
    let flat = |ring: &Vec<[f64; 3]>| ring.iter().map(|&[x, y, _]| [x, y]).collect::<Vec<_>>();
    let is_inside = |polygon: &Vec<Vec<[f64; 3]>>| {
        polygon.iter().filter(|ring| is_in(&flat(ring), place)).count() % 2 == 1
    };
    if polygons.iter().any(is_inside) {
        return None;
    }
    let of_edge = |ends: &[[f64; 3]]| {
        let ([a, b], [x, y]) = ([ends[0], ends[1]], place);
        let [u, v] = [b[0] - a[0], b[1] - a[1]];
        let along = (((x - a[0]) * u + (y - a[1]) * v) / (u * u + v * v)).clamp(0.0, 1.0);
        ((x - a[0] - along * u).hypot(y - a[1] - along * v), a[2] + along * (b[2] - a[2]))
    };
    let edges = polygons.iter().flatten().flat_map(|ring| ring.windows(2).map(of_edge));
    edges.min_by(|a, b| a.0.total_cmp(&b.0))
}

#[test]
fn shores_below_the_water_are_those_of_a_search() {
    let block = Block::new();
    block.levels(&[]);
    let path = |name: &str| block.folder.path(name);
    let layer: Value = serde_json::from_slice(&fs::read(path("levels.geojson")).unwrap()).unwrap();
    let polygons = rings(&layer);
    fs::write(path("mesh.spm"), block.mesh(&block.tiles)).unwrap();
    let draw = |name: &str, flags: &[&str]| {
        let (levels, output, mesh) = (path("levels.geojson"), path(name), path("mesh.spm"));
        let all = [&["--step", "1", "-o", &output, "--stats=json", "-q", &mesh], flags].concat();
        let all: Vec<&str> =
            all.iter().map(|word| if *word == "LEVELS" { &levels[..] } else { word }).collect();
        let (code, message) = outcome(&run("spdem", &all, &[]));
        assert_eq!(code, Some(0), "{message}");
        let stats: Value = serde_json::from_str(&message).expect("JSON");
        (cells(&fs::read_to_string(output).unwrap()), stats["known"].as_u64().unwrap())
    };
    let below = ["--below-water", "LEVELS", "--shore-width", "4"];
    let (found, count) = draw("below.asc", &below);
    assert_eq!(found.len() as u64, count);
    let key = |[x, y, _]: &[f64; 3]| [x.to_bits(), y.to_bits()];
    let mut found: BTreeMap<[u64; 2], f64> = found.iter().map(|cell| (key(cell), cell[2])).collect();
    let (all, _) = draw("dem.asc", &[]);
    let mut doubtful = 0;
    for cell in all {
        let [x, y, z] = cell;
        let depth = shore(&polygons, [x, y]).map(|(distance, level)| (distance, level - z));
        let expected = depth.filter(|&(distance, depth)| distance <= WIDTH && depth > 0.0).map(|(_, it)| it);
        match (found.remove(&key(&cell)), expected) {
            (None, None) => {}
            (Some(found), Some(expected)) => {
                assert!((found - expected).abs() < 1e-4, "{cell:?}: {found}, {expected}")
            }
            // Decided by roundings of this search.
            _ if depth
                .is_some_and(|(distance, depth)| (distance - WIDTH).abs() < 1e-9 || depth.abs() < 1e-5) =>
            {
                doubtful += 1;
            }
            (found, expected) => panic!("{cell:?}: {found:?}, expected {expected:?}"),
        }
    }
    assert!(found.is_empty() && count > 100 && doubtful < 5, "{count} cells, {doubtful} in doubt: {found:?}");
    // Raised points are not below the water; only triangles between them and lower ground behind are.
    let tiles: Vec<&str> = block.tiles.iter().map(String::as_str).collect();
    let flags =
        ["--flatten", &path("levels.geojson"), "--keep-class", "2", "--shore-width", "4", "--raise-shore"];
    let points = run("spfinalize", &[&flags[..], &tiles].concat(), &[]);
    fs::write(path("mesh.spm"), run("spdelaunay2d", &[], &points.stdout).stdout).unwrap();
    let (_, raised) = draw("raised.asc", &below);
    assert!(raised < count * 2 / 3, "{raised} of {count} cells");
}

#[test]
fn water_without_levels_and_wrong_flags_are_refused() {
    let folder = Folder::new();
    let lake = r#"{"type":"Polygon","coordinates":[[[2,2],[8,2],[8,8],[2,8],[2,2]]]}"#;
    let path = folder.write("lake.geojson", lake);
    let points = run("spfinalize", &["-"], b"0 0 1\n10 0 1\n0 10 1\n10 10 1\n");
    let mesh = run("spdelaunay2d", &[], &points.stdout).stdout;
    let fails = |flags: &[&str], part: &str| {
        assert_outcome("spdem", &[&["--step", "1"], flags].concat(), &mesh, 2, part);
    };
    fails(
        &["--below-water", &path, "--shore-width", "1"],
        "write all levels first, with spfinalize --levels",
    );
    fails(&["--below-water", &path], "--shore-width");
    fails(&["--below-water", &path, "--shore-width", "0"], "expected a length above 0");
    fails(&["--below-water", &path, "--shore-width", "1", "--kind", "slope"], "cannot be used with");
}
