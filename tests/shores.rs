//! Shores that lines end in, water without points, and elevations that are far from the ground.

use crate::programs::{Folder, outcome, run};
use crate::spconstrain::audit;
use crate::water::{SCALE, cells, vertices};

/// A lake amid points at 105, with its left side at `x`.
fn lake(x: u32, properties: &str, z: &str) -> String {
    let ring = [[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]].map(|[u, v]| format!("[{},{v}{z}]", x + u));
    let geometry = format!(r#"{{"type":"Polygon","coordinates":[[{}]]}}"#, ring.join(","));
    format!(r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{geometry}}}"#)
}

fn soft(vertices: &str) -> String {
    format!(r#"{{"type":"Feature","geometry":{{"type":"LineString","coordinates":[{vertices}]}}}}"#)
}

fn collection(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

/// Points at 105, also just outside of lakes.
fn walls() -> String {
    let rows = |x: i32| (-6..16).map(move |y| format!("{}.3 {}.7 105\n", 2 * x, 2 * y));
    (-6..46).flat_map(rows).collect()
}

struct Run {
    mesh: Vec<u8>,
    messages: [String; 2],
}

/// The mesh of walls with water and lines, which both programs get.
fn meshed(folder: &Folder, water: &[String], lines: &[String], flags: &[&str]) -> Run {
    let files = [("--flatten", "water.geojson", water), ("--lines", "lines.geojson", lines)];
    let (mut own, mut both) = ([&SCALE[..], flags, &["-"]].concat(), flags.to_vec());
    let given = files.iter().filter(|(.., features)| !features.is_empty());
    let given = given.map(|(flag, name, features)| (*flag, folder.write(name, collection(features))));
    let given: Vec<(&str, String)> = given.collect();
    for (flag, file) in &given {
        own.extend([*flag, file]);
        both.extend(["--lines", file]);
    }
    let points = run("spfinalize", &own, walls().as_bytes());
    let mesh = run("spdelaunay2d", &[], &points.stdout).stdout;
    let mesh = run("spconstrain", &both, &mesh);
    let ended = [&points, &mesh].map(outcome);
    assert!(ended.iter().all(|(code, _)| *code == Some(0)), "{ended:?}");
    audit(&mesh.stdout);
    Run { mesh: mesh.stdout, messages: ended.map(|(_, messages)| messages) }
}

/// The elevations of cells inside of the first lake.
fn in_lake(folder: &Folder, mesh: &[u8]) -> Vec<f64> {
    let raster = folder.path("dem.asc");
    let (code, message) = outcome(&run("spdem", &["--step", "1", "-o", &raster], mesh));
    assert_eq!(code, Some(0), "{message}");
    let cells = cells(&std::fs::read_to_string(&raster).expect("a raster"));
    let is_in = |cell: &&[f64; 3]| cell[..2].iter().all(|&value| value > 0.0 && value < 20.0);
    cells.iter().filter(is_in).map(|cell| cell[2]).collect()
}

#[test]
fn lakes_with_soft_lines_in_them_are_level() {
    let folder = Folder::new();
    for line in ["[3,6],[3,16]", "[-8,5],[3,6]", "[0,0],[3,16]", "[-8,5],[60,17]", "[1,1],[1,2],[19,2]"] {
        for (properties, z) in [(r#""level":100"#, ""), ("", ",100")] {
            for flags in [&[][..], &["--densify", "3"]] {
                let Run { mesh, messages } = meshed(&folder, &[lake(0, properties, z)], &[soft(line)], flags);
                let found = in_lake(&folder, &mesh);
                assert!(
                    found.len() >= 361 && found.iter().all(|&z| z == 100.0),
                    "{line} {flags:?}: {found:?}"
                );
                assert!(!messages[1].contains("not level"), "{line} {flags:?}: {}", messages[1]);
            }
        }
    }
}

#[test]
fn lines_between_lakes_are_no_shores() {
    let folder = Folder::new();
    let water = [lake(0, r#""level":100"#, ""), lake(50, r#""level":99"#, "")];
    let Run { mesh, messages } = meshed(&folder, &water, &[soft("[10,10],[60,11]")], &["--densify", "3"]);
    assert!(!messages[1].contains("not level"), "{}", messages[1]);
    assert!(in_lake(&folder, &mesh).iter().all(|&z| z == 100.0));
}

#[test]
fn water_without_points_is_left_out() {
    let folder = Folder::new();
    let near = lake(0, "", "");
    let river = r#"{"type":"Feature","properties":{"river":"a"},"geometry":{"type":"LineString","coordinates":
        [[5000,5,7],[5020,5,6]]}}"#;
    let far = [
        vec![lake(5000, "", "")],
        vec![lake(5000, r#""level":101"#, "")],
        vec![lake(5000, "", ",101")],
        vec![lake(5000, r#""river":"a""#, ""), river.to_string()],
    ];
    let alone = meshed(&folder, std::slice::from_ref(&near), &[], &[]);
    for far in far {
        let water = [std::slice::from_ref(&near), &far[..]].concat();
        let Run { mesh, messages } = meshed(&folder, &water, &[], &[]);
        assert!(vertices(&mesh) == vertices(&alone.mesh), "{far:?}");
        let message = "1 of 2 polygons of water is left out, as no points are in the water or near its shore; \
                       the first is ";
        assert!(messages[0].contains(message), "{far:?}: {}", messages[0]);
        assert!(messages[0].contains("water.geojson: feature 1"), "{far:?}: {}", messages[0]);
    }
    assert!(!alone.messages[0].contains("left out"), "{}", alone.messages[0]);
}

#[test]
fn stated_elevations_far_from_points_are_counted() {
    let folder = Folder::new();
    let line = |z: [u32; 2]| {
        let [a, b] = z;
        soft(&format!("[30,5,{a}],[45,6,{b}]"))
    };
    let far = |water: &[String], lines: &[String], count: Option<&str>| {
        let messages = meshed(&folder, water, lines, &[]).messages;
        match count {
            Some(count) => assert!(messages[0].contains(count), "{}", messages[0]),
            None => assert!(!messages[0].contains("far from"), "{}", messages[0]),
        }
    };
    far(&[lake(0, "", ",0")], &[], Some("4 of 4 elevations that lines or water state are far from"));
    far(&[lake(0, r#""level":0"#, "")], &[], Some("4 of 4 elevations"));
    far(&[lake(0, r#""level":150"#, "")], &[line([104, 106])], Some("4 of 6 elevations"));
    far(&[lake(0, "", "")], &[line([0, 0])], Some("2 of 2 elevations"));
    far(&[], &[line([0, 104])], Some("1 of 2 elevations that lines or water state is far from"));
    far(&[lake(0, "", ",100")], &[line([104, 107])], None);
    // In a mesh that exists already.
    let points = run("spfinalize", &[&SCALE[..], &["-"]].concat(), walls().as_bytes()).stdout;
    let mesh = run("spdelaunay2d", &[], &points).stdout;
    let lines = folder.write("lines.geojson", collection(&[line([0, 104])]));
    let (code, messages) = outcome(&run("spconstrain", &["--lines", &lines], &mesh));
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("1 vertex took elevations from lines that are far from"), "{messages}");
}
