//! Plans, nodes and manifests: many jobs make the mesh that one pipe makes, and repair what was damaged.

mod changes;

use std::collections::BTreeSet;
use std::fs;
use std::process::Output;

use rustix::fs::Mode;

use crate::programs::{Folder, assert_outcome, cloud, outcome, run, sample};
use crate::sources::las_file::LasFile;

/// A folder with tiles that overlap, and the plan for them.
struct Cluster {
    folder: Folder,
    tiles: Vec<String>,
    flags: Vec<&'static str>,
}

impl Cluster {
    /// Tiles of a hundred steps, with ties and with points on borders, some of them of another scale.
    fn new(flags: &[&'static str]) -> Cluster {
        let folder = Folder::new();
        let mut tiles = Vec::new();
        for (number, (column, row)) in
            (0..3).flat_map(|row| (0..3).map(move |column| (column, row))).enumerate()
        {
            let position = |i: i32| {
                let (x, y) = (i * 7919 % 101, i * 3571 % 101);
                [column * 100 + x, row * 100 + y, (x * y) % 37]
            };
            let fine = number % 4 == 1;
            let factor = if fine { 10 } else { 1 };
            let positions: Vec<[i32; 3]> = (0..400).map(|i| position(i).map(|at| at * factor)).collect();
            let scale = [if fine { 0.001 } else { 0.01 }; 3];
            let mut las = LasFile { scale, ..LasFile::of(&positions) };
            las.records.iter_mut().step_by(7).for_each(|record| record.class = 5);
            tiles.push(folder.write(&format!("tile{number}.las"), las.bytes()));
        }
        let cluster = Cluster { folder, tiles, flags: flags.to_vec() };
        cluster.plan();
        cluster
    }

    fn plan(&self) {
        self.plan_with(&[]);
    }

    fn plan_with(&self, flags: &[&str]) {
        let plan = self.plan_path();
        let mut arguments = vec!["--plan", &plan, "--leaf-points", "300"];
        arguments.extend(&self.flags);
        arguments.extend(flags);
        arguments.extend(self.tiles.iter().map(String::as_str));
        succeed(&run("spfinalize", &arguments, &[]));
    }

    fn plan_path(&self) -> String {
        self.folder.path("plan.json")
    }

    fn nodes(&self) -> Vec<String> {
        let listed = succeed(&run("spnode", &["list", &self.plan_path()], &[]));
        listed.lines().map(|line| line.split('\t').next().unwrap().to_string()).collect()
    }

    /// The path of a file of a node.
    fn file(&self, number: usize, ending: &str) -> String {
        let listed = succeed(&run("spnode", &["list", &self.plan_path()], &[]));
        let name = listed.lines().nth(number).unwrap().rsplit('\t').next().unwrap();
        self.folder.path(&format!("parts/{}/{name}.{ending}", &name[..2]))
    }

    /// The nodes that are not complete.
    fn missing(&self) -> Vec<String> {
        let (plan, parts) = (self.plan_path(), self.folder.path("parts"));
        let listed = succeed(&run("spnode", &["list", &plan, "-d", &parts, "--missing"], &[]));
        listed.lines().map(|line| line.split('\t').next().unwrap().to_string()).collect()
    }

    /// Makes what is missing.
    fn complete(&self) {
        match &self.missing()[..] {
            [] => {}
            missing => drop(succeed(&self.run(missing, &[]))),
        }
    }

    fn run(&self, nodes: &[String], flags: &[&str]) -> Output {
        let (plan, parts) = (self.plan_path(), self.folder.path("parts"));
        let mut arguments = vec!["run", &plan, "-d", &parts];
        arguments.extend(nodes.iter().map(String::as_str));
        arguments.extend(flags);
        run("spnode", &arguments, &[])
    }

    fn collect(&self, flags: &[&str]) -> Output {
        let (plan, parts, mesh) =
            (self.plan_path(), self.folder.path("parts"), self.folder.path("mesh.json"));
        run("spnode", &[&["collect", &plan, "-d", &parts, "-o", &mesh][..], flags].concat(), &[])
    }

    /// The mesh of one pipe, with the triangulator and the flags of the plan.
    fn piped(&self) -> Vec<u8> {
        let mut arguments = self.flags.clone();
        arguments.extend(self.tiles.iter().map(String::as_str));
        let points = run("spfinalize", &arguments, &[]);
        let tool = if self.flags.contains(&"--octree") { "spdelaunay3d" } else { "spdelaunay2d" };
        run(tool, &[], &points.stdout).stdout
    }

    fn mesh(&self) -> BTreeSet<Vec<String>> {
        simplices(&run("spconvert", &[&self.folder.path("mesh.json"), "--to", "text"], &[]).stdout)
    }

    fn files(&self) -> Vec<(String, Vec<u8>)> {
        let names = self.folder.names("parts").into_iter().filter(|name| name.ends_with(".spm"));
        names
            .map(|name| (name.clone(), fs::read(self.folder.path(&format!("parts/{name}"))).unwrap()))
            .collect()
    }
}

fn succeed(output: &Output) -> String {
    assert!(output.status.success(), "{:?}", outcome(output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The simplices of a text twin, each as its corners in order.
fn simplices(twin: &[u8]) -> BTreeSet<Vec<String>> {
    let text = String::from_utf8_lossy(twin);
    let vertices: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("v ")).collect();
    let lines = text.lines().filter_map(|line| line.strip_prefix("f ").or_else(|| line.strip_prefix("c ")));
    let corners = |line: &str| {
        let mut corners: Vec<String> =
            line.split(' ').map(|id| vertices[id.parse::<usize>().unwrap() - 1].to_string()).collect();
        corners.sort_unstable();
        corners
    };
    let all: Vec<Vec<String>> = lines.map(corners).collect();
    let set: BTreeSet<Vec<String>> = all.iter().cloned().collect();
    assert_eq!(set.len(), all.len(), "no simplex comes twice");
    set
}

#[test]
fn jobs_make_the_mesh_of_one_pipe() {
    for flags in [&[][..], &["--keep-class", "2"], &["--octree"], &["--attributes", "intensity"]] {
        let cluster = Cluster::new(flags);
        let nodes = cluster.nodes();
        assert!(nodes.len() > 8, "{nodes:?}");
        // Children come before their parents in any order by stage.
        succeed(&cluster.run(&nodes, &[]));
        succeed(&cluster.collect(&["--verify"]));
        let piped = run("spconvert", &["-", "--to", "text"], &cluster.piped()).stdout;
        assert_eq!(cluster.mesh(), simplices(&piped), "{flags:?}");
        succeed(&run("spinfo", &["--audit", &cluster.folder.path("mesh.json")], &[]));
        // Nothing is made twice, and making it again changes no byte.
        let before = cluster.files();
        assert_eq!(outcome(&cluster.run(&nodes, &[])).1, "");
        succeed(&cluster.run(&nodes, &["--force", "--threads", "1", "-q"]));
        assert!(before == cluster.files(), "{flags:?}");
    }
}

#[test]
fn rasters_of_parts_are_one_raster() {
    let cluster = Cluster::new(&[]);
    succeed(&cluster.run(&cluster.nodes(), &[]));
    succeed(&cluster.collect(&[]));
    let grid = ["--step", "0.1", "--bounds", "0,0,3,3", "--format", "asc"];
    let cells = |input: &str, bytes: &[u8]| -> Vec<String> {
        let output = run("spdem", &[&grid[..], &["-q", input]].concat(), bytes);
        succeed(&output).lines().skip(6).flat_map(str::split_whitespace).map(str::to_string).collect()
    };
    let whole = cells("-", &cluster.piped());
    assert_eq!(whole, cells(&cluster.folder.path("mesh.json"), &[]));
    let mut mosaic = vec!["-9999".to_string(); whole.len()];
    for (name, _) in cluster.files().iter().filter(|(name, _)| !name.contains("rest")) {
        for (cell, value) in mosaic.iter_mut().zip(cells(&cluster.folder.path(&format!("parts/{name}")), &[]))
        {
            if value != "-9999" {
                assert_eq!(cell, "-9999", "a cell is in one part only");
                *cell = value;
            }
        }
    }
    assert_eq!(mosaic, whole);
    let lines =
        |input: &str, bytes: &[u8]| succeed(&run("spdem", &["-q", "--contours", "0.05", input], bytes));
    assert_eq!(lines("-", &cluster.piped()).len(), lines(&cluster.folder.path("mesh.json"), &[]).len());
}

#[test]
fn damage_is_repaired_by_running_the_same_command_again() {
    let cluster = Cluster::new(&[]);
    let nodes = cluster.nodes();
    succeed(&cluster.run(&nodes, &[]));
    succeed(&cluster.collect(&[]));
    let (mesh, files) = (cluster.mesh(), cluster.files());
    let path = |name: &str| cluster.folder.path(&format!("parts/{name}"));
    let listed = succeed(&run("spnode", &["list", &cluster.plan_path(), "--stage", "0"], &[]));
    let leaves = listed.lines().count();
    let residuals: Vec<&String> =
        files.iter().map(|(name, _)| name).filter(|name| name.contains("rest")).collect();
    for (number, &name) in residuals.iter().enumerate().step_by(3) {
        let whole = fs::read(path(name)).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() * 2 / 3] ^= 4;
        let damaged = [Some(flipped), Some(whole[..whole.len() - 20].to_vec()), None];
        match &damaged[number % 3] {
            Some(bytes) => fs::write(path(name), bytes).unwrap(),
            None => fs::remove_file(path(name)).unwrap(),
        }
        fs::remove_file(cluster.file(nodes.len() - 1, "json")).unwrap();
        succeed(&cluster.run(&nodes[leaves..], &["--force"]));
        assert!(files == cluster.files(), "{name} is as it was");
    }
    let meshes: Vec<&String> =
        files.iter().map(|(name, _)| name).filter(|name| !name.contains("rest")).collect();
    for &name in meshes.iter().step_by(4) {
        fs::remove_file(path(name)).unwrap();
        let (code, message) = outcome(&cluster.collect(&[]));
        assert_eq!((code, message.contains("triangles, ")), (Some(0), true), "{message}");
        let mut bytes = fs::read(path(name)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(path(name), bytes).unwrap();
        succeed(&cluster.collect(&["--verify"]));
    }
    assert!(files == cluster.files() && mesh == cluster.mesh());
}

#[test]
fn plans_are_refused_when_files_or_points_changed() {
    let cluster = Cluster::new(&[]);
    let nodes = cluster.nodes();
    let tile = cluster.tiles[4].clone();
    let bytes = fs::read(&tile).unwrap();
    fs::write(&tile, &bytes[..bytes.len() - 28]).unwrap();
    let (code, message) = outcome(&cluster.run(&nodes, &[]));
    assert_eq!((code, message.contains("changed since the plan was made")), (Some(2), true), "{message}");
    // A header whose box leaves points out would lose them.
    let mut wrong = bytes.clone();
    wrong[179..187].copy_from_slice(&1.5f64.to_le_bytes());
    fs::write(&tile, wrong).unwrap();
    cluster.plan();
    let (code, message) = outcome(&cluster.run(&cluster.nodes(), &[]));
    assert_eq!(
        (code, message.contains("outside of the box that the header states")),
        (Some(3), true),
        "{message}"
    );
    // Old parts are those of another plan.
    fs::write(&tile, bytes).unwrap();
    cluster.plan();
    succeed(&cluster.run(&cluster.nodes(), &[]));
    succeed(&cluster.collect(&[]));
    let plan = fs::read_to_string(cluster.plan_path()).unwrap();
    fs::write(cluster.plan_path(), plan.replacen("\"points\":", "\"points\":1", 1)).unwrap();
    assert_outcome("spnode", &["list", &cluster.plan_path()], &[], 3, "plan");
}

#[test]
fn bad_requests_are_named() {
    let folder = Folder::new();
    let (plan, text) = (folder.path("plan.json"), folder.write("points.txt", cloud(500)));
    let bad = folder.write("bad.las", b"LASF, but not for long");
    let worse = folder.write("worse.las", b"LASF, neither");
    assert_outcome("spfinalize", &["--plan", &plan, &bad, &worse], &[], 3, "worse.las");
    assert_outcome("spfinalize", &["--plan", &plan, "-"], b"0 0 0\n", 2, "plans need files");
    assert_outcome("spfinalize", &["--plan", &plan, "--thin", "1", &text], &[], 2, "--thin");
    assert_outcome("spfinalize", &["--plan", &text, &text], &[], 2, "");
    assert_outcome("spfinalize", &["--leaf-points", "9", &text], &[], 2, "--plan");
    assert_outcome(
        "spfinalize",
        &["--plan", &plan, "--leaf-points", "100", &text],
        &[],
        0,
        "was read to plan",
    );
    let parts = folder.path("parts");
    assert_outcome("spnode", &["run", &plan, "-d", &parts, "99"], &[], 2, "there is no node 99");
    assert_outcome("spnode", &["run", &text, "-d", &parts, "0"], &[], 3, "no plan");
    let mesh = folder.path("mesh.json");
    // What is missing is made.
    assert_outcome("spnode", &["collect", &plan, "-d", &parts, "-o", &mesh], &[], 0, "all accounted for");
    let manifest: serde_json::Value = serde_json::from_slice(&fs::read(&mesh).unwrap()).unwrap();
    let part = folder.path(manifest["parts"][1]["file"].as_str().unwrap());
    assert_outcome("spinfo", &["--audit", &part], &[], 2, "audit the manifest");
    assert_outcome("spinfo", &["--audit", "--points", &text, &mesh], &[], 0, "");
    let manifest = fs::read_to_string(&mesh).unwrap();
    fs::write(&mesh, manifest.replacen("\"vertices\":", "\"vertices\":1", 1)).unwrap();
    assert_outcome("spinfo", &[&mesh], &[], 3, "vertices of its own, expected");
    fs::write(&mesh, &manifest[..manifest.len() / 2]).unwrap();
    assert_outcome("spinfo", &[&mesh], &[], 3, "no manifest");
    let raster = folder.path("raster.tif");
    let [bounds, points] = ["\"bounds\":", "\"points\":"].map(|name| manifest.find(name).unwrap());
    for (wrong, (code, part)) in [
        ("[[2,0,0],[1,1,1]]", (3, "bounding box")),
        ("[[0,0,0],[0.123,1,1]]", (3, "bounding box")),
        ("[[-1e308,0,0],[1e308,1,1]]", (2, "the window is wider than any number")),
    ] {
        let changed = format!("{}\"bounds\":{wrong},{}", &manifest[..bounds], &manifest[points..]);
        fs::write(&mesh, changed).unwrap();
        assert_outcome("spdem", &["--columns", "9", &mesh, "-o", &raster], &[], code, part);
    }
    fs::write(&mesh, &manifest).unwrap();
    fs::remove_file(&part).unwrap();
    assert_outcome("spinfo", &[&mesh], &[], 1, ".spm");
    // A pipe that nothing writes to.
    rustix::fs::mkfifoat(rustix::fs::CWD, &part, Mode::RUSR | Mode::WUSR).unwrap();
    assert_outcome("spinfo", &[&mesh], &[], 3, "a part of a mesh is no regular file");
}

#[test]
fn a_real_copc_file_is_read_in_parts() {
    let folder = Folder::new();
    let (plan, parts, mesh) = (folder.path("plan.json"), folder.path("parts"), folder.path("mesh.json"));
    let (tile, copc) = (sample("lareunion.laz"), sample("simple_with_page.copc.laz"));
    for file in [&tile, &copc] {
        succeed(&run("spfinalize", &["--plan", &plan, "--leaf-points", "3000", file], &[]));
        succeed(&run("spnode", &["collect", &plan, "-d", &parts, "-o", &mesh, "-q"], &[]));
        succeed(&run("spinfo", &["--audit", "--points", file, &mesh], &[]));
        fs::remove_dir_all(&parts).unwrap();
    }
}

#[test]
fn a_damaged_report_counts_as_none() {
    let cluster = Cluster::new(&[]);
    let manifest = || {
        succeed(&cluster.collect(&["-q"]));
        fs::read(cluster.folder.path("mesh.json")).unwrap()
    };
    let whole = manifest();
    let path = cluster.file(1, "json");
    let report = fs::read(&path).unwrap();
    for place in (0..report.len()).step_by(29) {
        let mut damaged = report.clone();
        damaged[place] ^= 1 << (place % 7);
        fs::write(&path, damaged).unwrap();
        assert!(manifest() == whole, "byte {place}");
    }
}

#[test]
fn nodes_of_the_same_files_and_points_have_one_name() {
    let cluster = Cluster::new(&["--keep-class", "2"]);
    let id = |name: &str, flags: &[&str]| -> String {
        let path = cluster.folder.path(name);
        let mut arguments = vec!["--plan", &path, "--leaf-points", "300"];
        arguments.extend(flags);
        arguments.extend(cluster.tiles.iter().map(String::as_str));
        succeed(&run("spfinalize", &arguments, &[]));
        let plan: serde_json::Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
        plan["nodes"].as_array().unwrap().last().unwrap()["name"].as_str().unwrap().to_string()
    };
    let one = id("plan.json", &["--keep-class", "2"]);
    assert_eq!(one, id("other.json", &["-q", "--threads=1", "--memory", "300M", "--keep-class", "2"]));
    assert_ne!(one, id("third.json", &["--keep-class", "5"]));
    assert_ne!(one, id("fourth.json", &["--keep-class", "2", "--duplicates", "lowest"]));
}

#[test]
fn parts_of_other_nodes_are_made_again() {
    let cluster = Cluster::new(&[]);
    let nodes = cluster.nodes();
    succeed(&cluster.run(&nodes, &[]));
    succeed(&cluster.collect(&[]));
    let (mesh, files) = (cluster.mesh(), cluster.files());
    // A residual of another node, with the length that is expected.
    fs::copy(cluster.file(3, "rest.spm"), cluster.file(0, "rest.spm")).unwrap();
    succeed(&cluster.run(&nodes, &["--force"]));
    fs::copy(cluster.file(1, "spm"), cluster.file(0, "spm")).unwrap();
    succeed(&cluster.collect(&["--verify"]));
    assert!(files == cluster.files() && mesh == cluster.mesh());
}

#[test]
fn polygons_are_those_of_the_plan() {
    let square = |side: i32| format!("POLYGON ((0 0, {side} 0, {side} {side}, 0 {side}, 0 0))\n");
    let cluster = Cluster::new(&[]);
    let wkt = cluster.folder.write("square.wkt", square(2));
    let plan = cluster.plan_path();
    let mut arguments = vec!["--plan", &plan, "--leaf-points", "300", "--clip", &wkt];
    arguments.extend(cluster.tiles.iter().map(String::as_str));
    succeed(&run("spfinalize", &arguments, &[]));
    succeed(&cluster.run(&cluster.nodes()[..2], &[]));
    cluster.folder.write("square.wkt", square(30));
    let (code, message) = outcome(&cluster.run(&cluster.nodes(), &[]));
    assert_eq!((code, message.contains("changed since the plan was made")), (Some(2), true), "{message}");
    // A value of a flag that is the name of a file would be taken for the file.
    let named = cluster.folder.write("2", fs::read(&cluster.tiles[0]).unwrap());
    let output = crate::programs::tool("spfinalize")
        .args(["--plan", &plan, "--keep-class", "2", "2"])
        .current_dir(std::path::Path::new(&named).parent().unwrap())
        .output()
        .unwrap();
    assert_eq!((outcome(&output).0, outcome(&output).1.contains("./NAME")), (Some(2), true));
    let far = cluster.folder.write("far.txt", "-1e308 0 0\n1e308 0 0\n0 1 0\n");
    assert_outcome("spfinalize", &["--plan", &plan, "--leaf-points", "1", &far], &[], 0, "read to plan");
}
