//! Programs chained by pipes: their output, and what happens when one of them fails.

mod failures;

use std::fs;

use crate::programs::{Folder, assert_outcome, cloud, outcome, run, sample, skip};
use crate::sources::las_file::LasFile;
use crate::vectors::run_python;

/// The streaming triangulators, and their flags for spfinalize.
const TRIANGULATORS: [(&str, &[&str]); 2] = [("spdelaunay2d", &[]), ("spdelaunay3d", &["--octree"])];

/// A chunked stream of a cloud, much longer than the capacity of a pipe.
fn long_stream(arguments: &[&str]) -> Vec<u8> {
    let arguments = [arguments, &["--cell-points", "2000", "-"]].concat();
    let output = run("spfinalize", &arguments, cloud(60_000).as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    assert!(output.stdout.len() > 1_000_000);
    output.stdout
}

fn mesh_of(points: &[u8], arguments: &[&str]) -> Vec<u8> {
    let output = run("spdelaunay2d", arguments, points);
    assert!(output.status.success(), "{:?}", outcome(&output));
    output.stdout
}

#[test]
fn a_real_tile_becomes_an_audited_mesh() {
    let tile = sample("lareunion.laz");
    let points = run("spfinalize", &["--cell-points", "3000", &tile], &[]);
    assert!(points.status.success(), "{:?}", outcome(&points));
    let mesh = mesh_of(&points.stdout, &["--duplicates", "lowest"]);
    let audit = run("spinfo", &["--audit", "--json", "-"], &mesh);
    assert!(audit.status.success(), "{:?}", outcome(&audit));
    let report: serde_json::Value = serde_json::from_slice(&audit.stdout).unwrap();
    assert_eq!(report["counts"]["points"], 59_712);
    assert_eq!(report["counts"]["vertices"], 59_712 - 51);
}

#[test]
fn points_of_space_become_an_audited_mesh() {
    let points = run("spfinalize", &["--octree", "--cell-points", "5000", "-"], cloud(20_000).as_bytes());
    assert!(points.status.success(), "{:?}", outcome(&points));
    let mesh = |threads: &str| {
        let output = run("spdelaunay3d", &["--threads", threads, "--stats", "json"], &points.stdout);
        let (code, report) = outcome(&output);
        assert_eq!(code, Some(0), "{report}");
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["points"], 20_000);
        assert!(report["tetrahedra"].as_u64() > Some(100_000), "{report}");
        output.stdout
    };
    let one = mesh("1");
    assert!(one == mesh("3"), "the stream depends on the number of threads");
    let audit = run("spinfo", &["--audit", "-"], &one);
    assert!(audit.status.success(), "{:?}", outcome(&audit));
    let refused = run("spdelaunay2d", &[], &points.stdout);
    assert_eq!(outcome(&refused).0, Some(2));
    let flat = run("spfinalize", &["--octree", "-"], b"0 0 1\n5 0 1\n0 5 1\n9 9 1\n");
    let (code, message) = outcome(&run("spdelaunay3d", &[], &flat.stdout));
    assert_eq!((code, message.contains("all points in a plane")), (Some(0), true), "{message}");
}

/// Stored heights count for less than stored x and y here, so they must not be triangulated as they are.
#[test]
fn axes_of_different_scales_are_triangulated_in_shape() {
    let positions: Vec<[i32; 3]> =
        (0..300).map(|i| [i * 7919 % 1009, i * 3571 % 997, i * 131 % 97]).collect();
    let lines = |scale: [f64; 3]| -> String {
        let line = |at: &[i32; 3]| -> String {
            let world: Vec<String> = (0..3).map(|i| (f64::from(at[i]) * scale[i]).to_string()).collect();
            world.join(" ") + "\n"
        };
        positions.iter().map(line).collect()
    };
    // A common grid; a common measure that is too fine a fraction, so that points become f64.
    for scale in [[0.25, 0.25, 2.0], [0.25, 0.5, 0.75], [0.25, 0.25, 0.25 * 1.000_030_517_578_125]] {
        let las = LasFile { scale, ..LasFile::of(&positions) }.bytes();
        let points = run("spfinalize", &["--octree", "--cell-points", "50", "-"], &las);
        let streamed = run("spdelaunay3d", &[], &points.stdout);
        let whole = run("tess3", &["-"], lines(scale).as_bytes());
        assert!(streamed.status.success() && whole.status.success(), "{:?}", outcome(&points));
        let (streamed, whole) = (tetrahedra(&streamed.stdout), tetrahedra(&whole.stdout));
        assert!(streamed.len() > 1000 && streamed == whole, "{scale:?}: {} {}", streamed.len(), whole.len());
        let convert = ["--from", "points", "--dims", "3", "--to", "spm"];
        let points = run("spconvert", &convert, &las);
        let points = run("spfinalize", &["--octree", "-"], &points.stdout);
        let again = run("spdelaunay3d", &[], &points.stdout);
        assert!(tetrahedra(&again.stdout) == whole, "{scale:?} through spconvert");
    }
}

/// The words of all lines that start with a word, without it.
fn words<'t>(text: &'t str, start: &str) -> Vec<Vec<&'t str>> {
    let lines = text.lines().filter_map(|line| line.strip_prefix(start));
    lines.map(|line| line.split_whitespace().collect()).collect()
}

/// Tables are joined by coordinates, so every program must print the same ones.
#[test]
fn coordinates_are_printed_as_they_were_given() {
    let positions: Vec<[i32; 3]> =
        (0..400).map(|i| [i * 7919 % 100_003 - 28_016, i * 104_729 % 99_991, i * 31 % 9973]).collect();
    let las =
        LasFile { scale: [0.001; 3], offset: [0.0, -4_321_987.65, 0.0], ..LasFile::of(&positions) }.bytes();
    let decimal = |thousandths: i64| {
        let sign = if thousandths < 0 { "-" } else { "" };
        let digits = format!("{sign}{}.{:03}", thousandths.abs() / 1000, thousandths.abs() % 1000);
        digits.trim_end_matches('0').trim_end_matches('.').to_string()
    };
    let given = |at: &[i32; 3]| {
        [i64::from(at[0]), i64::from(at[1]) - 4_321_987_650, i64::from(at[2])].map(decimal).to_vec()
    };
    let mut expected: Vec<Vec<String>> = positions.iter().map(given).collect();
    assert!(positions.iter().any(|at| (f64::from(at[0]) * 0.001).to_string().len() > 12));
    expected.sort_unstable();
    let folder = Folder::new();
    let path = folder.write("a.las", &las);
    let points = run("spfinalize", &[&path], &[]).stdout;
    let mesh = mesh_of(&points, &[]);
    let text_of = |arguments: &[&str], input: &[u8]| {
        let output = run("spconvert", arguments, input);
        assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let assert_given = |mut found: Vec<Vec<&str>>, what: &str| {
        found.sort_unstable();
        assert!(found == expected, "{what}: {:?} and {:?}", found.first(), expected.first());
    };
    for (input, to) in [(&points, "text"), (&points, "spa"), (&mesh, "text"), (&mesh, "obj"), (&mesh, "sma")]
    {
        let text = text_of(&["--to", to, "-"], input);
        assert_given(words(&text, "v "), to);
    }
    let ply = text_of(&["--to", "ply", "--ascii", "-"], &mesh);
    let vertices = ply.split_once("end_header\n").unwrap().1.lines().take(expected.len());
    assert_given(vertices.map(|line| line.split(' ').collect()).collect(), "ply");

    let info = run("spinfo", &["--json", "-"], &mesh);
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    let bound = |side: &str, axis: usize| info["bounds"][side][axis].to_string();
    let least: Vec<i32> = (0..3).map(|axis| positions.iter().map(|at| at[axis]).min().unwrap()).collect();
    let least = given(&[least[0], least[1], least[2]]);
    assert_eq!([bound("min", 0), bound("min", 1)], least[..2]);

    let spline = run("splinefit", &["fit", "--tol", "1000", &path], &[]);
    assert!(spline.status.success(), "{:?}", outcome(&spline));
    let spline = folder.write("a.spline.spm", &spline.stdout);
    let table = run("splinefit", &["eval", &spline, "--at", &path], &[]);
    assert!(table.status.success(), "{:?}", outcome(&table));
    let table = String::from_utf8(table.stdout).unwrap();
    let places: Vec<Vec<&str>> = words(&table, "").into_iter().map(|row| row[..2].to_vec()).collect();
    let rows: Vec<Vec<String>> = positions.iter().map(|at| given(at)[..2].to_vec()).collect();
    assert!(
        places.len() >= rows.len()
            && rows.iter().zip(&places[places.len() - rows.len()..]).all(|(a, b)| a == b)
    );
}

/// Points without a tree may have any scales; spfinalize puts them on one grid.
#[test]
fn scales_of_a_stream_meet_on_one_grid_before_its_points_are_triangulated() {
    let header = |tree: &str| {
        format!(
            "#spmesh version 2\n#spmesh kind points\n#spmesh coordinates i32\n#spmesh scale 0.25 0.25 2\n\
             #spmesh offset 0 0 0\n#spmesh dims 3\n#spmesh elevation no\n{tree}#spmesh chunked no\n"
        )
    };
    let points: String =
        (0..200).map(|i| format!("v {} {} {}\n", i * 37 % 101, i * 53 % 97, i % 9 * 2)).collect();
    let end = "# end points 200 cells 0 vertices 0 simplices 0 merged 0 residual 0 walls 0\n";
    let twin = |tree: &str| [&header(tree), &points, end].concat();
    let stream = run("spconvert", &["--to", "spm"], twin("").as_bytes());
    assert!(stream.status.success(), "{:?}", outcome(&stream));
    let finalized = run("spfinalize", &["--octree", "-"], &stream.stdout);
    let streamed = run("spdelaunay3d", &[], &finalized.stdout);
    let lines = points.replace("v ", "");
    let whole = run("tess3", &["-"], lines.as_bytes());
    assert!(tetrahedra(&streamed.stdout) == tetrahedra(&whole.stdout) && whole.status.success());
    let uneven = twin("#spmesh tree 0 0 0 0 1024\n");
    assert_outcome("spconvert", &["--to", "spm"], uneven.as_bytes(), 3, "expected one scale");
}

#[test]
fn the_python_reader_accepts_what_the_pipeline_writes() {
    let tile = sample("lareunion.laz");
    let points = run("spfinalize", &["--cell-points", "3000", &tile], &[]).stdout;
    let preserved = run("spfinalize", &["--preserve", &tile], &[]).stdout;
    let mesh = mesh_of(&points, &[]);
    let part = mesh_of(&points, &["--partial", "--cell", "1/0/0"]);
    for stream in [points, preserved, mesh, part] {
        let Some(python) = run_python("scripts/spmesh_reader.py", &["-q", "-"], &stream) else { return };
        assert!(python.status.success(), "{:?}", outcome(&python));
    }
}

/// The triangles of a mesh as coordinates, sorted, from its text twin.
fn triangles(mesh: &[u8]) -> Vec<[String; 3]> {
    let output = run("spconvert", &["--to", "text"], mesh);
    assert!(output.status.success(), "{:?}", outcome(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let mut vertices: Vec<String> = Vec::new();
    let mut triangles = Vec::new();
    for line in text.lines() {
        if let Some(vertex) = line.strip_prefix("v ") {
            vertices.push(vertex.rsplit_once(' ').unwrap().0.to_string());
        } else if let Some(face) = line.strip_prefix("f ") {
            let t: Vec<usize> = face.split(' ').map(|i| i.parse::<usize>().unwrap() - 1).collect();
            let turn = |k: usize| std::array::from_fn(|i| vertices[t[(i + k) % 3]].clone());
            triangles.push((0..3).map(turn).min().unwrap());
        }
    }
    triangles.sort_unstable();
    triangles
}

#[test]
fn levels_order_threads_and_preserving_change_nothing() {
    let tile = sample("lareunion.laz");
    let reference = run("spfinalize", &["--level", "0", &tile], &[]).stdout;
    let reference = triangles(&mesh_of(&reference, &["--threads", "1"]));
    assert!(reference.len() > 100_000);
    for arguments in
        [&["--level", "1"][..], &["--level", "4"], &["--level", "6", "--preserve"], &["--preserve"]]
    {
        let points = run("spfinalize", &[arguments, &[&tile]].concat(), &[]);
        assert!(points.status.success(), "{:?}", outcome(&points));
        for threads in ["1", "2"] {
            let mesh = mesh_of(&points.stdout, &["--threads", threads]);
            assert!(triangles(&mesh) == reference, "{arguments:?}, {threads} threads");
        }
    }
}

#[test]
fn tiles_of_a_real_file_merge_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("points.spm");
    let points = points.to_str().unwrap();
    let tile = sample("lareunion.laz");
    assert!(run("spfinalize", &["-o", points, &tile], &[]).status.success());
    let info = run("spinfo", &["--json", points], &[]);
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    let bound = |corner: &str, axis: usize| info["bounds"][corner][axis].as_f64().unwrap();
    let border = |axis: usize, i: u32| match i {
        0 => f64::NEG_INFINITY,
        4 => f64::INFINITY,
        i => bound("min", axis) + (bound("max", axis) - bound("min", axis)) * f64::from(i) / 4.0,
    };
    let mut merge = vec!["--merge".to_string()];
    for i in 0..16 {
        let (x, y) = (i % 4, i / 4);
        let region = format!("{},{},{},{}", border(0, x), border(1, y), border(0, x + 1), border(1, y + 1));
        let part = folder.path().join(format!("part{i}.spm")).to_str().unwrap().to_string();
        let output = run("spdelaunay2d", &["--partial", "--region", &region, "-o", &part, points], &[]);
        assert!(output.status.success(), "{:?}", outcome(&output));
        merge.push(part);
    }
    let merge: Vec<&str> = merge.iter().map(String::as_str).collect();
    let whole = mesh_of(&fs::read(points).unwrap(), &[]);
    let merged = mesh_of(&[], &merge);
    assert!(triangles(&merged) == triangles(&whole));
    assert!(run("spinfo", &["--audit", "-"], &merged).status.success());
}

/// The command for one part of a plane or of space.
fn part(name: &str, region: &str, points: &str, output: &str) {
    let made = run(name, &["--partial", "--region", region, "-o", output, points], &[]);
    assert!(made.status.success(), "{:?}", outcome(&made));
}

#[test]
fn forgotten_parts_are_named() {
    let folder = Folder::new();
    let grid = ["--scale", "0.01,0.01,0.01", "--offset", "400000,0,0"];
    let text = folder.write("points.txt", cloud(300));
    let [flat, solid] = ["flat", "solid"].map(|name| folder.path(name));
    assert!(run("spfinalize", &[&grid[..], &["-o", &flat, &text]].concat(), &[]).status.success());
    assert!(run("spfinalize", &["--octree", "-o", &solid, &text], &[]).status.success());
    let planar = ["-inf,-inf,40000.5,inf", "40000.5,-inf,70000.1,inf", "70000.1,-inf,inf,inf"];
    let spatial = ["-inf,-inf,-inf,inf,inf,20", "-inf,-inf,20,inf,inf,60", "-inf,-inf,60,inf,inf,inf"];
    for (name, points, regions) in [("spdelaunay2d", &flat, planar), ("spdelaunay3d", &solid, spatial)] {
        let parts = [0, 1, 2].map(|i| folder.path(&format!("{name}{i}")));
        parts.iter().zip(regions).for_each(|(output, region)| part(name, region, points, output));
        let merge = |more: &[&str], forgotten: usize| {
            let given = parts.iter().enumerate().filter(|(i, _)| *i != forgotten).map(|(_, part)| &part[..]);
            let arguments: Vec<&str> =
                ["--merge"].into_iter().chain(more.iter().copied()).chain(given).collect();
            outcome(&run(name, &arguments, &[]))
        };
        assert_eq!(merge(&[], 3), (Some(0), String::new()));
        for (forgotten, region) in regions.iter().enumerate() {
            let (code, message) = merge(&[], forgotten);
            assert_eq!(code, Some(2), "{message}");
            assert!(
                message.contains(&format!("no part covers the region {region}: add its part")),
                "{message}"
            );
            let (code, message) = merge(&["--incomplete"], forgotten);
            assert_eq!(code, Some(0), "{message}");
            assert!(message.contains(&format!("no part covers the region {region}: left out")), "{message}");
        }
        let (code, message) = merge(&["--region", regions[1]], 0);
        assert!(code == Some(2) && message.contains("is not inside of the given one"), "{message}");
    }
    let one = folder.path("one");
    part("spdelaunay2d", "0,0,50000,50000", &flat, &one);
    assert_eq!(outcome(&run("spdelaunay2d", &["--merge", &one], &[])), (Some(0), String::new()));
    let larger = ["--merge", "--region", "0,0,60000,50000", &one];
    let (code, message) = outcome(&run("spdelaunay2d", &larger, &[]));
    assert!(code == Some(2) && message.contains("the region 50000,0,60000,50000: add"), "{message}");
}

/// The tetrahedra of a mesh as coordinates, sorted, from its text twin.
fn tetrahedra(mesh: &[u8]) -> Vec<[String; 4]> {
    let output = run("spconvert", &["--to", "text"], mesh);
    assert!(output.status.success(), "{:?}", outcome(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let vertices: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("v ")).collect();
    let corners = |line: &str| {
        let corner = |id: &str| vertices[id.parse::<usize>().unwrap() - 1].to_string();
        let mut corners: Vec<String> = line.split(' ').map(corner).collect();
        corners.sort_unstable();
        corners.try_into().unwrap()
    };
    let mut tetrahedra: Vec<_> =
        text.lines().filter_map(|line| line.strip_prefix("c ")).map(corners).collect();
    tetrahedra.sort_unstable();
    tetrahedra
}

#[test]
fn tiles_of_space_merge_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let points = path("points.spm");
    let point = |i: u64| format!("{} {} {}\n", i * 7919 % 1009, i * 104_729 % 1013 + i % 3, i * i % 1019);
    let cloud: String = (0..4_000).map(point).collect();
    let finalize = ["--octree", "--cell-points", "500", "-", "-o", &points];
    let made = run("spfinalize", &finalize, cloud.as_bytes());
    assert!(made.status.success(), "{:?}", outcome(&made));
    let parts = ["west", "south", "low", "high"].map(|name| path(&format!("{name}.spm")));
    let regions = [
        "-inf,-inf,-inf,400,inf,inf",
        "400,-inf,-inf,inf,500,inf",
        "400,500,-inf,inf,inf,480",
        "400,500,480,inf,inf,inf",
    ];
    for (part, region) in parts.iter().zip(regions) {
        let tile = run("spdelaunay3d", &["--partial", "--region", region, "-o", part, &points], &[]);
        let (code, message) = outcome(&tile);
        assert!(code == Some(0) && message.contains("lie outside of the region"), "{message}");
        let audit = run("spinfo", &["--audit", "--json", part], &[]);
        assert!(audit.status.success(), "{:?}", outcome(&audit));
        let report: serde_json::Value = serde_json::from_slice(&audit.stdout).unwrap();
        assert_eq!(report["kind"], "partial tetrahedral mesh");
        assert_eq!(report["region"]["min"].as_array().unwrap().len(), 3);
        assert!(report["counts"]["tetrahedra"].as_u64() > Some(100), "{report}");
        assert!(report["counts"]["walls"].as_u64() > Some(100), "{report}");
        let text = run("spconvert", &["--to", "text", part], &[]).stdout;
        let again = run("spconvert", &["--from", "text", "--to", "text", "-"], &text).stdout;
        assert!(text.starts_with(b"#spmesh version 2") && again == text);
        let python = run_python("scripts/spmesh_reader.py", &["-"], &fs::read(part).unwrap());
        assert!(python.is_none_or(|python| python.status.success() && python.stdout == text));
    }
    let east = path("east.spm");
    let [west, south, low, high] = &parts;
    let staged = ["--merge", "--region", "400,-inf,-inf,inf,inf,inf", "-o", &east, low, south, high];
    assert_eq!(outcome(&run("spdelaunay3d", &staged, &[])), (Some(0), String::new()));
    let merged = run("spdelaunay3d", &["--merge", "--stats=json", &east, west], &[]);
    let (code, stats) = outcome(&merged);
    assert_eq!(code, Some(0), "{stats}");
    let whole = run("spdelaunay3d", &[&points], &[]).stdout;
    assert!(tetrahedra(&merged.stdout) == tetrahedra(&whole));
    assert!(run("spinfo", &["--audit", "-"], &merged.stdout).status.success());
    for (arguments, words) in [
        (&["--merge", west, west][..], "overlap"),
        (&["--merge", &points], "--merge takes results of --partial"),
        (&[west], "use --merge to finish it"),
    ] {
        let (code, message) = outcome(&run("spdelaunay3d", arguments, &[]));
        assert!(code == Some(2) && message.contains(words), "{message}");
    }
    let (code, message) = outcome(&run("spdelaunay2d", &["--merge", west], &[]));
    assert!(code == Some(2) && message.contains("merge it with spdelaunay3d"), "{message}");
    let cell = run("spdelaunay3d", &["--partial", "--cell", "1/0/0/0", "-q", &points], &[]);
    assert_eq!(outcome(&cell), (Some(0), String::new()));
    assert!(run("spinfo", &["--audit", "-"], &cell.stdout).status.success());
}

#[test]
fn generated_flight_lines_go_through() {
    let examples = std::path::Path::new(env!("CARGO_BIN_EXE_spinfo")).with_file_name("examples");
    let generator = examples.join("gen_lidar");
    if !generator.exists() {
        skip("the example gen_lidar is not built (a plain `cargo test` builds it)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lines.laz");
    let file = file.to_str().unwrap();
    let made =
        std::process::Command::new(generator).args(["--points", "20000", "--seed", "1", "-o", file]).output();
    assert!(made.as_ref().is_ok_and(|output| output.status.success()), "{made:?}");
    let points = run("spfinalize", &["--cell-points", "1000", file], &[]);
    assert!(points.status.success(), "{:?}", outcome(&points));
    let audit = run("spinfo", &["--audit", "--points", file, "-"], &mesh_of(&points.stdout, &[]));
    assert!(audit.status.success(), "{:?}", outcome(&audit));
}

#[test]
fn limits_of_memory_are_refused_with_their_own_code() {
    let folder = Folder::new();
    let line: String = (0..60_000).map(|i| format!("{i} {} {}\n", 3 * i, 7 * i)).collect();
    for (program, flags) in TRIANGULATORS {
        let points = run("spfinalize", &[&["-q"], flags].concat(), line.as_bytes()).stdout;
        let output = &folder.path("mesh.spm");
        let (code, message) = outcome(&run(program, &["--memory", "17M", "-o", output], &points));
        assert_eq!(code, Some(5), "{program}: {message}");
        assert!(message.contains("--memory allows 17 MiB"), "{program}: {message}");
        assert!(fs::metadata(output).is_err(), "nothing under the final name");
        let (code, message) = outcome(&run(program, &["-q", "--memory", "200M", "-o", output], &points));
        assert_eq!((code, &message[..]), (Some(0), ""), "{program}");
        fs::remove_file(output).expect("a mesh");
    }
}
