//! `spground`: classes against the definition on small inputs, for any cutting, and all other bytes of the
//! files.

mod batches;
mod definition;
mod failures;

use std::collections::BTreeMap;

use spmesh_base::random::Random;
use spmesh_stream::{Event, StreamReader};

use crate::height::Parts;
use crate::programs::{Folder, outcome, run, sample};
use crate::sources::las_file::{LasFile, geo_keys};
use definition::{Rules, classes};

/// A hill with a house, trees, pits and a bird, in centimetres.
fn scene(random: &mut Random, points: usize, side: u64, steepness: f64) -> Vec<[i32; 3]> {
    let mut scene = Vec::new();
    for number in 0..points {
        let [x, y] = [0, 1].map(|_| random.below(100 * side) as i32 - 700);
        let hill = f64::from(x) * steepness + 40.0 * (f64::from(y) / 300.0).sin();
        let mut z = hill as i32 + random.below(12) as i32 + 5000;
        let is_house = (200..900).contains(&x) && (300..800).contains(&y);
        z += if is_house { 400 } else { 0 };
        z += if random.unit() < 0.15 { 30 + random.below(900) as i32 } else { 0 };
        z -= if number % 400 == 7 { 900 } else { 0 };
        z += if number % 900 == 8 { 6000 } else { 0 };
        scene.push([x, y, z]);
    }
    scene
}

fn classes_of(file: &[u8]) -> Vec<u8> {
    let parts = Parts::of(file);
    let is_extended = parts.header[104] & 0x3f >= 6;
    parts.records().map(|record| if is_extended { record[16] } else { record[15] & 31 }).collect()
}

fn unclassified(points: &[[i32; 3]]) -> LasFile {
    let mut file = LasFile::of(points);
    file.records.iter_mut().for_each(|record| record.class = 0);
    file
}

/// The classes that the program finds in one file.
fn found(folder: &Folder, file: &LasFile, flags: &[&str]) -> Vec<u8> {
    let (input, output) = (folder.write("in.las", file.bytes()), folder.path("out.las"));
    let done = run("spground", &[&[&input, "-o", &output][..], flags].concat(), &[]);
    assert_eq!(outcome(&done).0, Some(0), "{:?}", outcome(&done));
    classes_of(&std::fs::read(output).unwrap())
}

#[test]
fn classes_are_those_of_the_definition() {
    let folder = Folder::new();
    let (mut random, mut birds) = (Random::new(21), 0);
    for (points, side, steepness, window, slope, reach) in [
        (1500, 24, 0.0, 4, 0.2, 100.0),
        (900, 20, 0.4, 5, 0.3, 2.0),
        (250, 24, 0.1, 3, 0.2, 1.7),
        (250, 24, 0.1, 3, 0.2, 100.0),
        (2500, 16, 0.9, 6, 0.15, 3.0),
    ] {
        let scene = scene(&mut random, points, side, steepness);
        let window_text = window.to_string();
        let [slope_text, reach_text] = [slope, reach].map(|value| value.to_string());
        let flags = ["--window", &window_text, "--slope", &slope_text, "--reach", &reach_text];
        let found = found(&folder, &unclassified(&scene), &flags);
        let expected = classes(&scene, Rules { window, slope, reach });
        let mut unsure = 0;
        for (at, (&found, &(class, margin))) in found.iter().zip(&expected).enumerate() {
            unsure += usize::from(margin < 0.01);
            assert!(found == class || margin < 0.01, "{:?}: {found}, not {class} ({margin})", scene[at]);
        }
        assert!(unsure < points / 50, "{unsure}");
        for class in [1, 2, 7] {
            assert!(found.contains(&class), "{class}");
        }
        birds += found.iter().filter(|class| **class == 18).count();
    }
    assert!(birds > 0);
}

/// A window of more radii than one stage has, and two blocks.
#[test]
fn stages_and_blocks_do_not_matter() {
    let folder = Folder::new();
    let mut random = Random::new(3);
    let mut points = scene(&mut random, 700, 14, 0.3);
    // Far enough away for a block of its own.
    points.extend(scene(&mut random, 300, 9, 0.1).iter().map(|[x, y, z]| [x + 200_000, *y, *z]));
    let found = found(&folder, &unclassified(&points), &["--window", "21", "--slope", "0.25"]);
    let expected = classes(&points, Rules { window: 21, slope: 0.25, reach: 100.0 });
    for (at, (found, &(class, margin))) in found.iter().zip(&expected).enumerate() {
        assert!(*found == class || margin < 0.01, "{:?}: {found}, not {class} ({margin})", points[at]);
    }
}

#[test]
fn few_points_have_classes() {
    let folder = Folder::new();
    let level = |x, y| [100 * x, 100 * y, 300];
    let line: Vec<[i32; 3]> = (0..20).map(|at| level(at, at)).collect();
    let same = vec![level(1, 1); 9];
    for points in [vec![], vec![level(0, 0)], vec![level(0, 0), level(1, 1)], line, same] {
        let classes = found(&folder, &unclassified(&points), &[]);
        assert!(classes.iter().all(|&class| class == 1), "{points:?}");
    }
    let square: Vec<[i32; 3]> = (0..9).map(|at| level(at % 3, at / 3)).collect();
    assert_eq!(found(&folder, &unclassified(&square), &[]), [2; 9]);
}

#[test]
fn cuttings_and_order_do_not_matter() {
    let folder = Folder::new();
    let mut random = Random::new(4);
    let mut points = scene(&mut random, 9000, 60, 0.2);
    // One point far away.
    points.push([90_000_000, 0, 5000]);
    let all = found(&folder, &unclassified(&points), &["--threads", "1"]);
    assert!(all.contains(&2) && all.contains(&1));
    assert_eq!(found(&folder, &unclassified(&points), &["--threads", "3", "--memory", "1G"]), all);
    let reversed: Vec<[i32; 3]> = points.iter().rev().copied().collect();
    let mut backwards = found(&folder, &unclassified(&reversed), &[]);
    backwards.reverse();
    assert_eq!(backwards, all);
    // Files with origins of their own, as LAZ.
    let mut paths = Vec::new();
    for part in 0..7 {
        let mut file = unclassified(&[]);
        file.offset = [f64::from(part) * 3.0, -10.0, 2.0];
        let shift = [part * 300, -1000, 200];
        let own = points.iter().skip(part as usize).step_by(7);
        let own: Vec<[i32; 3]> = own.map(|point| [0, 1, 2].map(|axis| point[axis] - shift[axis])).collect();
        file.records = unclassified(&own).records;
        paths.push(folder.write(&format!("part{part}.laz"), file.compressed(500)));
    }
    let out = folder.path("classified");
    let mut arguments: Vec<&str> = paths.iter().map(String::as_str).collect();
    arguments.extend(["--out-dir", &out]);
    let done = run("spground", &arguments, &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    for part in 0..7 {
        let classes = classes_of(&std::fs::read(format!("{out}/part{part}.laz")).unwrap());
        let expected: Vec<u8> = all.iter().skip(part).step_by(7).copied().collect();
        assert_eq!(classes, expected, "{part}");
    }
}

/// Text gets a column, and its mesh comes from a pipe, too.
#[test]
fn text_has_classes() {
    let folder = Folder::new();
    let points = scene(&mut Random::new(5), 1200, 24, 0.1);
    let line =
        |[x, y, z]: &[i32; 3]| [x, y, z].map(|value| format!("{:.2}", f64::from(*value) / 100.0)).join(",");
    let lines: Vec<String> = points.iter().map(line).collect();
    let text = format!("x,y,z\n{}\n", lines.join("\n"));
    let (input, output, mesh) =
        (folder.write("in.csv", &text), folder.path("out.csv"), folder.path("out.spm"));
    let done = run("spground", &[&input, "-o", &output], &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    let classes = found(&folder, &unclassified(&points), &[]);
    let expected = lines.iter().zip(&classes).map(|(line, class)| format!("{line},{class}\n"));
    let written = std::fs::read_to_string(&output).unwrap();
    assert!(written == format!("x,y,z,class\n{}", expected.collect::<String>()), "{written}");
    let done = run("spground", &["-", "-o", &mesh], text.as_bytes());
    assert!(done.status.success(), "{:?}", outcome(&done));
    let of_pipe = std::fs::read(&mesh).unwrap();
    let done = run("spground", &[&input, "-o", &mesh], &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    assert!(of_pipe == std::fs::read(&mesh).unwrap());
    // Files that get classes are read twice.
    let done = run("spground", &["-", "-o", &output], text.as_bytes());
    assert_eq!(outcome(&done).0, Some(2));
}

/// A stream keeps its attributes and tags, and gets one more attribute.
#[test]
fn streams_have_classes() {
    let folder = Folder::new();
    let points = scene(&mut Random::new(6), 3000, 30, 0.1);
    let mut file = unclassified(&points);
    let intensity = |point: &[i32; 3]| point[2].unsigned_abs() as u16;
    file.records.iter_mut().zip(&points).for_each(|(record, point)| record.intensity = intensity(point));
    let classes = found(&folder, &file, &[]);
    let expected: BTreeMap<[i32; 3], u8> = points.iter().copied().zip(classes).collect();
    let (input, out, mesh) = (folder.path("in.las"), folder.path("out"), folder.path("ground.spm"));
    for flags in [&["--attributes", "intensity"][..], &[]] {
        let stream = run("spfinalize", &[&["-q", &input][..], flags].concat(), &[]).stdout;
        let points_file = folder.write("points.spm", &stream);
        let done = run("spground", &[&points_file, "--out-dir", &out], &[]);
        assert!(done.status.success(), "{:?}", outcome(&done));
        let classified = std::fs::read(folder.path("out/points.spm")).unwrap();
        let [mut before, mut after] =
            [&stream, &classified].map(|bytes| StreamReader::new(&bytes[..], "it").unwrap());
        let names: Vec<&str> = after.header().attributes.iter().map(|one| &one.name[..]).collect();
        assert_eq!(names.last(), Some(&"classification"));
        let row_len = names.len() * 2 - 1;
        let mut counts = [0; 2];
        loop {
            let [old, new] = [&mut before, &mut after].map(|reader| reader.next_event().unwrap());
            if let (Some(Event::Points(old)), Some(Event::Points(new))) = (&old, &new) {
                assert_eq!(old, new);
                counts[0] += new.len();
                for (point, row) in new.iter().zip(after.rows().chunks_exact(row_len)) {
                    let stored = point.map(|value| value as i32);
                    assert_eq!(row.last(), Some(&expected[&stored]));
                    assert!(row_len == 1 || row[..2] == intensity(&stored).to_le_bytes());
                }
            } else {
                counts[1] += usize::from(matches!(old, Some(Event::Cells(_))));
                assert_eq!(old, new);
            }
            if new.is_none() {
                break;
            }
        }
        assert!(counts[0] == 3000 && counts[1] > 0, "{counts:?}");
        // Twice the same attribute, and other endings.
        let again =
            run("spground", &[&folder.path("out/points.spm"), "--out-dir", &folder.path("again")], &[]);
        let (code, message) = outcome(&again);
        assert!(code == Some(2) && message.contains("attribute classification already"), "{message}");
        let (code, message) = outcome(&run("spground", &[&points_file, "-o", &folder.path("out.laz")], &[]));
        assert!(code == Some(2) && message.contains("streams stay streams"), "{message}");
        let cut = folder.write("cut.spm", &stream[..stream.len() - 30]);
        let (code, message) = outcome(&run("spground", &[&cut, "--out-dir", &folder.path("cut")], &[]));
        assert!(code == Some(3) && message.contains("cut.spm"), "{message}");
        assert!(folder.names("cut").is_empty());
    }
    let (code, message) = outcome(&run("spground", &[&input, "-o", &mesh], &[]));
    assert_eq!(code, Some(0), "{message}");
    let (code, message) = outcome(&run("spground", &[&mesh, "--out-dir", &out], &[]));
    assert!(code == Some(2) && message.contains("expected points"), "{message}");
}

/// Jobs that see no more than the halo of their tiles.
#[test]
fn tiles_of_a_plan_have_the_classes_of_all() {
    let folder = Folder::new();
    let mut random = Random::new(8);
    let parameters = ["--window", "2", "--reach", "2"];
    let tiles: Vec<Vec<[i32; 3]>> = (0..7)
        .map(|tile| {
            let own = scene(&mut random, 1500, 40, 0.1);
            // The last ones are sparse, so that triangles are as large as they may be.
            let step = if tile < 5 { 1 } else { 4 };
            own.iter().step_by(step).map(|[x, y, z]| [x + 4000 * tile, *y, *z]).collect()
        })
        .collect();
    let all = found(&folder, &unclassified(&tiles.concat()), &parameters);
    let name = |tile: usize| format!("tile{tile}.las");
    let paths: Vec<String> =
        (0..7).map(|tile| folder.write(&name(tile), unclassified(&tiles[tile]).bytes())).collect();
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let plan = folder.path("plan.json");
    let done = run("spfinalize", &[&["--plan", &plan, "--leaf-points", "2000"][..], &paths].concat(), &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    let (out, report) = (folder.path("classified"), folder.path("report.json"));
    let mut at = 0;
    for tile in 0..7 {
        let arguments = ["--plan", &plan, paths[tile], "--out-dir", &out, "--report", &report];
        let done = run("spground", &[&arguments[..], &parameters].concat(), &[]);
        assert!(done.status.success(), "{:?}", outcome(&done));
        let classes = classes_of(&std::fs::read(format!("{out}/{}", name(tile))).unwrap());
        let count = tiles[tile].len();
        assert_eq!(classes, all[at..at + count], "{tile}");
        at += count;
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        assert!(report["points"].as_u64().unwrap() < all.len() as u64, "{report}");
    }
    // Leaves have each tile once.
    let leaves = folder.path("leaves");
    let listed = run("spnode", &["list", &plan, "--stage", "0"], &[]);
    let numbers = String::from_utf8(listed.stdout).unwrap();
    for line in numbers.lines() {
        let number = line.split_whitespace().next().unwrap();
        let arguments = ["--plan", &plan, "--leaf", number, "--out-dir", &leaves];
        let done = run("spground", &[&arguments[..], &parameters].concat(), &[]);
        assert!(done.status.success(), "{:?}", outcome(&done));
    }
    for tile in 0..7 {
        let [of_tile, of_leaf] =
            [&out, &leaves].map(|folder| std::fs::read(format!("{folder}/{}", name(tile))));
        assert_eq!(of_tile.unwrap(), of_leaf.unwrap(), "{tile}");
    }
}

/// A house of three storeys and its ground, in a file of another unit.
#[test]
fn parameters_are_metres() {
    let folder = Folder::new();
    let house = |x: i32, y: i32| (10..20).contains(&x) && (10..20).contains(&y);
    let scene: Vec<[i32; 3]> = (0..1600)
        .map(|at| (at % 40, at / 40))
        .map(|(x, y)| [x * 100, y * 100, if house(x, y) { 300 } else { 0 }])
        .collect();
    let classes = found(&folder, &unclassified(&scene), &["--window", "7"]);
    let count = |classes: &[u8]| classes.iter().filter(|class| **class == 1).count();
    assert_eq!(count(&classes), 100);
    let mut feet = unclassified(&scene);
    feet.scale = [0.01 / 0.3048; 3];
    // Oregon in international feet.
    feet.projection = vec![geo_keys(2992)];
    assert_eq!(found(&folder, &feet, &["--window", "7"]), classes);
}

#[test]
fn all_but_classes_stays() {
    let folder = Folder::new();
    for name in ["point10.las", "1_4_w_evlr.laz", "autzen.copc.laz", "crop_duplicate.laz", "lareunion.laz"] {
        let bytes = std::fs::read(sample(name)).unwrap();
        let output = folder.path("out.laz");
        let done = run("spground", &[&sample(name), "-o", &output], &[]);
        assert!(done.status.success(), "{name}: {:?}", outcome(&done));
        let [before, after] = [&bytes, &std::fs::read(output).unwrap()].map(|file| Parts::of(file));
        let place = if before.header[104] & 0x3f >= 6 { 16 } else { 15 };
        assert_eq!(before.records().len(), after.records().len());
        for (old, new) in before.records().zip(after.records()) {
            let mut expected = old.to_vec();
            expected[place] = if place == 16 { new[16] } else { old[15] & 0xe0 | new[15] & 0x1f };
            assert_eq!(expected, new, "{name}");
        }
        assert_eq!(before.kept(), after.kept(), "{name}");
    }
}

/// Tiles of cells that do not fit memory wait on disk, and points are put in their order.
#[test]
fn memory_does_not_matter() {
    let folder = Folder::new();
    let mut random = Random::new(17);
    let point = |_| {
        let [x, y] = [0, 1].map(|_| random.below(80_000) as i32);
        [x, y, x / 10 + random.below(300) as i32]
    };
    let points: Vec<[i32; 3]> = (0..4000).map(point).collect();
    let flags = ["--cell", "0.25", "--window", "1", "--threads", "2"];
    let ample = found(&folder, &unclassified(&points), &[&flags[..], &["--memory", "2G"]].concat());
    let little = found(&folder, &unclassified(&points), &[&flags[..], &["--memory", "90M"]].concat());
    assert_eq!(ample, little);
}

/// Some points keep their classes, and are no part of the ground; the report counts them.
#[test]
fn points_can_keep_their_classes() {
    let folder = Folder::new();
    let level = |at: i32| [100 * (at % 20), 100 * (at / 20), 0];
    let mut file = unclassified(&(0..400).map(level).collect::<Vec<_>>());
    // A pond that lies low, a withheld point, and all returns but the last.
    for record in &mut file.records[100..140] {
        (record.class, record.position[2]) = (9, -150);
    }
    file.records[200].flags = 4;
    (file.records[300].number, file.records[300].of) = (1, 2);
    let report = folder.path("report.json");
    let flags = ["--keep-class-of", "9", "--last-only", "--report", &report];
    let classes = found(&folder, &file, &flags);
    let expected: Vec<u8> = (0..400)
        .map(|at| match at {
            100..140 => 9,
            200 | 300 => 0,
            _ => 2,
        })
        .collect();
    assert_eq!(classes, expected);
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert_eq!((&report["kept"], &report["classes"]["2"]), (&42.into(), &358.into()));
    assert_eq!(report["points"], 358);
}

/// The mesh has the points of class 2, and no others.
#[test]
fn the_mesh_is_that_of_points_of_the_ground() {
    let folder = Folder::new();
    let scene = scene(&mut Random::new(8), 4000, 40, 0.1);
    let file = unclassified(&scene);
    let classes = found(&folder, &file, &[]);
    let (input, mesh) = (folder.path("in.las"), folder.path("ground.spm"));
    let done = run("spground", &[&input, "-o", &mesh], &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    let classified = folder.path("out.las");
    let points = run("spfinalize", &["-q", "--keep-class", "2", &classified], &[]);
    let expected = run("spdelaunay2d", &["-q", "--duplicates", "lowest"], &points.stdout);
    let text = |stream: &[u8]| {
        let mut lines: Vec<String> =
            crate::height::triangles_of(stream).iter().map(|corners| format!("{corners:?}")).collect();
        lines.sort_unstable();
        lines
    };
    let found = text(&std::fs::read(mesh).unwrap());
    assert!(found == text(&expected.stdout) && found.len() > 1000);
    assert!(classes.contains(&2));
}
