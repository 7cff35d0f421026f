//! Plans that change: what does not depend on a change is not made again.

use std::fs;

use super::{Cluster, simplices, succeed};
use crate::programs::{Folder, assert_outcome, cloud, outcome, run};
use crate::sources::las_file::LasFile;

/// What is not the same in two plans has another name.
#[test]
fn plans_share_what_does_not_depend_on_a_change() {
    let cluster = Cluster::new(&[]);
    succeed(&cluster.run(&cluster.nodes(), &[]));
    succeed(&cluster.collect(&[]));
    let files = cluster.files();
    // The last tile gets another elevation, and a later time.
    let tile = cluster.tiles.last().unwrap();
    let mut changed = fs::read(tile).unwrap();
    let at = changed.len() - 20;
    changed[at] ^= 1;
    fs::write(tile, changed).unwrap();
    let (plan, parts) = (cluster.plan_path(), cluster.folder.path("parts"));
    let (code, message) = outcome(&cluster.collect(&[]));
    assert_eq!((code, message.contains("plan again")), (Some(2), true), "{message}");
    assert_outcome("spnode", &["list", &plan, "-d", &parts, "--missing"], &[], 2, "plan again");
    cluster.plan();
    let missing = cluster.missing();
    let stages = succeed(&run("spnode", &["list", &plan, "--stages"], &[])).lines().count();
    assert!(missing.len() < 4 * stages && missing.len() < cluster.nodes().len() / 2, "{missing:?}");
    // Nothing is removed before the new mesh is there, and what is removed is said.
    let clean = |flags: &[&str]| run("spnode", &[&["clean", &plan, "-d", &parts][..], flags].concat(), &[]);
    assert_eq!(clean(&[]).status.code(), Some(2));
    succeed(&run("spinfo", &["--audit", &cluster.folder.path("mesh.json")], &[]));
    succeed(&cluster.run(&missing, &[]));
    assert!(cluster.missing().is_empty());
    succeed(&cluster.collect(&[]));
    let piped = run("spconvert", &["-", "--to", "text"], &cluster.piped()).stdout;
    assert_eq!(cluster.mesh(), simplices(&piped));
    let listed = succeed(&clean(&["--dry-run"]));
    assert_eq!(listed, succeed(&clean(&[])));
    // Three files of each node that was made again, of which the root has no residual.
    assert_eq!(listed.lines().count(), 3 * missing.len() - 1);
    let kept = cluster.files().iter().filter(|file| files.contains(file)).count();
    assert_eq!(kept, files.len() - (2 * missing.len() - 1), "no byte of the others is another one");
    assert!(clean(&[]).stdout.is_empty());
    succeed(&run("spinfo", &["--audit", &cluster.folder.path("mesh.json")], &[]));
}

/// Tiles outside of all others, and inside, leave boxes where they are.
#[test]
fn plans_grow_and_shrink_without_starting_again() {
    let mut cluster = Cluster::new(&[]);
    let mut tiles = cluster.tiles.clone();
    let position = |i: i32| [i * 7919 % 101 - 700, i * 3571 % 101 + 400, i % 9];
    let far = LasFile { scale: [0.01; 3], ..LasFile::of(&(0..400).map(position).collect::<Vec<_>>()) };
    tiles.push(cluster.folder.write("far.las", far.bytes()));
    succeed(&cluster.run(&cluster.nodes(), &[]));
    for tiles in [tiles.clone(), tiles[1..].to_vec(), tiles] {
        cluster.tiles = tiles;
        cluster.plan();
        let (missing, all) = (cluster.missing(), cluster.nodes());
        assert!(missing.len() <= 12 && missing.len() < all.len() / 2, "{missing:?} of {all:?}");
        cluster.complete();
        succeed(&cluster.collect(&[]));
        let piped = run("spconvert", &["-", "--to", "text"], &cluster.piped()).stdout;
        assert_eq!(cluster.mesh(), simplices(&piped));
    }
}

/// A plan moves with its files, and another time does not matter if it knows them by content.
#[test]
fn plans_move_with_their_roots() {
    let folder = Folder::new();
    let text = cloud(500);
    let tile = folder.write("here/a.txt", &text);
    let [here, there, plan, parts, mesh] =
        ["here", "there", "plan.json", "parts", "mesh.json"].map(|name| folder.path(name));
    let root = format!("survey={here}");
    let planned = ["--plan", &plan, "--leaf-points", "100", "--hash", "--root", &root, "-q", &tile];
    succeed(&run("spfinalize", &planned, &[]));
    succeed(&run("spnode", &["collect", "-q", &plan, "-d", &parts, "-o", &mesh], &[]));
    fs::rename(&here, &there).unwrap();
    folder.write("there/a.txt", &text);
    let list = ["list", &plan, "-d", &parts, "--missing", "--root"];
    let missing = |root: &str| run("spnode", &[&list[..], &[root]].concat(), &[]);
    assert_eq!(missing(&root).status.code(), Some(1));
    let moved = format!("survey={there}");
    assert_eq!(succeed(&missing(&moved)), "");
    assert_eq!(missing("other=/").status.code(), Some(2));
    let moved_tile = folder.path("there/a.txt");
    let twice = ["--plan", &plan, "--root", &moved, "--root", "survey=/", &moved_tile];
    assert_outcome("spfinalize", &twice, &[], 2, "the root \"survey\" is given twice");
    assert_outcome("spfinalize", &["--plan", &plan, "--root", &root, &moved_tile], &[], 1, "is no folder");
    folder.write("there/a.txt", text.replacen('1', "2", 1));
    assert_eq!(missing(&moved).status.code(), Some(2));
}

#[test]
fn nodes_are_divided_into_batches() {
    let cluster = Cluster::new(&[]);
    let batches = |points: &str, flags: &[&str]| -> Vec<Vec<String>> {
        let plan = cluster.plan_path();
        let listed = run("spnode", &[&["list", &plan, "--batch-points", points][..], flags].concat(), &[]);
        succeed(&listed).lines().map(|line| line.split(' ').map(str::to_string).collect()).collect()
    };
    for points in ["0", "700", "100000"] {
        assert_eq!(batches(points, &[]).concat(), cluster.nodes());
    }
    assert_eq!(batches("0", &[]).len(), cluster.nodes().len());
    assert_eq!(batches("100000", &["--stage", "0"]).len(), 1);
}

/// A mesh goes on without a bad tile, says so, and takes it back when it is mended.
#[test]
fn bad_tiles_are_left_out_and_listed() {
    let cluster = Cluster::new(&[]);
    succeed(&cluster.run(&cluster.nodes(), &[]));
    succeed(&cluster.collect(&[]));
    let (mesh, list) = (cluster.mesh(), cluster.folder.path("bad.tsv"));
    let [cut, wrong] = [&cluster.tiles[4], &cluster.tiles[8]];
    let [whole_cut, whole_wrong] = [cut, wrong].map(|tile| fs::read(tile).unwrap());
    let skipped = || -> Vec<String> {
        let manifest = fs::read(cluster.folder.path("mesh.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_slice(&manifest).unwrap();
        let files = manifest["skipped"].as_array().unwrap();
        files.iter().map(|file| file["file"].as_str().unwrap().to_string()).collect()
    };
    let make = || {
        cluster.plan_with(&["--skip-bad", &list]);
        cluster.complete();
        succeed(&cluster.collect(&[]));
        skipped()
    };
    // One is found when its header is read, the other one by a job: its box leaves points out.
    fs::write(cut, &whole_cut[..100]).unwrap();
    let mut header = whole_wrong.clone();
    header[179..187].copy_from_slice(&2.5f64.to_le_bytes());
    fs::write(wrong, header).unwrap();
    cluster.plan_with(&["--skip-bad", &list]);
    let (code, message) = outcome(&cluster.run(&cluster.missing(), &[]));
    assert_eq!((code, message.contains("list of --skip-bad")), (Some(3), true), "{message}");
    fs::write(&list, fs::read_to_string(&list).unwrap() + wrong + "\n").unwrap();
    assert_eq!(make(), [cut.as_str(), wrong]);
    assert!(cluster.mesh() != mesh);
    assert_eq!(make(), [cut.as_str(), wrong], "the list says the same when it is read again");
    fs::write(cut, &whole_cut).unwrap();
    assert_eq!(make(), [wrong.as_str()]);
    let misspelt = fs::read_to_string(&list).unwrap().replace("tile4", "tile44") + "/no/such.las\n";
    let other = cluster.folder.write("other.tsv", misspelt);
    let plan = cluster.folder.path("other.json");
    let arguments = ["--plan", &plan, "--skip-bad", &other, &cluster.tiles[0]];
    assert_outcome("spfinalize", &arguments, &[], 0, "files not among the inputs, such as /no/such.las");
    fs::write(wrong, &whole_wrong).unwrap();
    assert!(make().is_empty() && cluster.mesh() == mesh);
    assert_eq!(fs::read_to_string(&list).unwrap().lines().count(), 1);
    assert_outcome(
        "spfinalize",
        &["--plan", &cluster.plan_path(), "--skip-bad", cut, wrong],
        &[],
        3,
        "this is not UTF-8",
    );
    let area = cluster.folder.write("area.wkt", "POLYGON((0 0,9 0,9 9,0 9,0 0))\n");
    let plan = cluster.plan_path();
    assert_outcome(
        "spfinalize",
        &["--plan", &plan, "--clip", &area, "--skip-bad", &area, wrong],
        &[],
        3,
        "no list",
    );
    assert_outcome("spfinalize", &["--plan", &plan, wrong, wrong], &[], 2, "is given twice");
}

/// A file has one name, wherever it is planned from.
#[test]
fn plans_from_other_folders_have_the_same_nodes() {
    let folder = Folder::new();
    folder.write("tiles/a.txt", cloud(300));
    folder.write("below/empty", "");
    let planned = |from: &str, file: &str| {
        let plan = folder.path("plan.json");
        let planned = crate::programs::tool("spfinalize")
            .args(["-q", "--plan", &plan, file])
            .current_dir(folder.path(from))
            .output()
            .unwrap();
        succeed(&planned);
        succeed(&run("spnode", &["list", &plan], &[]))
    };
    let here = planned("tiles", "a.txt");
    assert_eq!(planned("below", "../tiles/a.txt"), here);
    assert_eq!(planned("below", "./../below/../tiles/./a.txt"), here);
}
