//! Many input files: where their outputs go, and what happens if some files fail.

use std::fs;
use std::time::{Duration, SystemTime};

use super::meshes::Mesh;
use super::molecules::{Rows, cloud, models, pdb};
use crate::programs::{Folder, outcome, run};

fn summary(folder: &Folder) -> Rows {
    Rows::new(&fs::read_to_string(folder.path("out/summary.tsv")).unwrap())
}

/// A folder with three valid files in two subfolders, and their names.
fn files() -> (Folder, Vec<String>) {
    let folder = Folder::new();
    let names = [("in/1abc.pdb", 50), ("in/2abc.ent", 60), ("more/1abc.pdb", 70)];
    let files = names.map(|(name, count)| folder.write(name, pdb(&cloud(count, 9_000, u64::from(count)))));
    (folder, files.to_vec())
}

fn sweep(folder: &Folder, arguments: &[&str], files: &[String]) -> (Option<i32>, String) {
    let out = folder.path("out");
    let files = files.iter().map(String::as_str);
    let arguments: Vec<&str> =
        ["--out-dir", &out].into_iter().chain(arguments.iter().copied()).chain(files).collect();
    outcome(&run("tess3", &arguments, &[]))
}

#[test]
fn each_file_becomes_a_mesh_and_a_line() {
    let (folder, files) = files();
    let (code, message) = sweep(&folder, &["--threads", "2"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("3 files done"), "{message}");
    let names = folder.names("out");
    assert_eq!(names, ["2abc.spm", "in/1abc.pdb.spm", "more/1abc.pdb.spm", "summary.tsv"]);
    let rows = summary(&folder);
    assert_eq!(rows.len(), 3);
    for (file, count) in files.iter().zip([50, 60, 70]) {
        let row = rows.of_file(file);
        let path = folder.path(&format!("out/{}", rows.text(row, "output")));
        let bytes = fs::read(path).unwrap();
        assert_eq!(rows.number(row, "output_bytes") as usize, bytes.len());
        let mesh = Mesh::read(&bytes);
        mesh.prove();
        assert_eq!(mesh.points.len(), count);
        assert_eq!(rows.number(row, "atoms") as usize, count);
        assert_eq!(rows.number(row, "unique_points") as usize, count);
        assert_eq!(rows.number(row, "tetrahedra") as usize, mesh.tetrahedra.len());
        // Euler: the hull of a triangulated ball with v vertices on it has 2v - 4 facets.
        assert_eq!(rows.number(row, "hull_facets") as usize % 2, 0);
        assert!(rows.number(row, "seconds") > 0.0);
        let peak = rows.number(row, "peak_memory_bytes");
        assert!((20.0 * count as f64..1e7).contains(&peak), "{peak}");
        assert_eq!(rows.text(row, "error"), "");
        assert!(rows.text(row, "options").contains("--hetatm on"));
    }
}

#[test]
fn hull_facets_are_counted() {
    let folder = Folder::new();
    let corners = "0 0 0\n4 0 0\n0 4 0\n0 0 4\n1 1 1\n";
    let file = folder.write("five.xyz", corners);
    assert_eq!(sweep(&folder, &[], &[file]).0, Some(0));
    let rows = summary(&folder);
    let counts = ["atoms", "unique_points", "tetrahedra", "hull_facets"].map(|column| rows.number(0, column));
    assert_eq!(counts, [5.0, 5.0, 4.0, 4.0]);
}

#[test]
fn outputs_of_different_kinds_and_options_have_their_places() {
    let (folder, files) = files();
    for flag in ["--table", "--contacts"] {
        assert_eq!(sweep(&folder, &[flag], &files[1..]).0, Some(0));
    }
    let names = folder.names("out");
    let expected = ["1abc.contacts.tsv", "1abc.tetrahedra.tsv", "2abc.contacts.tsv", "2abc.tetrahedra.tsv"];
    assert_eq!(names[..4], expected);
    let alone = run("tess3", &["--contacts", &files[1]], &[]);
    assert_eq!(fs::read(folder.path("out/2abc.contacts.tsv")).unwrap(), alone.stdout);
}

#[test]
fn files_of_one_name_in_one_folder_keep_their_endings() {
    let folder = Folder::new();
    let text = pdb(&cloud(20, 9_000, 1));
    let files = ["a.pdb", "a.ent", "A.xyz", "b.pdb", "b.pdb.pdb"].map(|name| folder.write(name, &text));
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    let names = folder.names("out");
    assert_eq!(names, ["A.xyz.spm", "a.ent.spm", "a.pdb.spm", "b.pdb.spm", "b.spm", "summary.tsv"]);
}

#[test]
fn a_file_that_is_given_twice_is_done_once() {
    let (folder, files) = files();
    assert_eq!(sweep(&folder, &[], &[files[0].clone(), files[0].clone()]).0, Some(0));
    assert_eq!(folder.names("out"), ["1abc.spm", "summary.tsv"]);
    assert_eq!(summary(&folder).len(), 1);
}

#[test]
fn lists_of_files_are_read_from_files_and_stdin() {
    let (folder, files) = files();
    let list = folder.write("list", format!("{}\n\n{}\r\n", files[0], files[1]));
    assert_eq!(sweep(&folder, &["--lof", &list], &files[2..]).0, Some(0));
    assert_eq!(summary(&folder).len(), 3);
    let out = folder.path("piped");
    let output = run("tess3", &["--lof", "-", "--out-dir", &out], files.join("\n").as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    assert_eq!(folder.names("piped").len(), 4);
}

#[test]
fn a_bad_file_does_not_stop_the_others_unless_asked_to() {
    let (folder, mut files) = files();
    let large = "ATOM      1  CA  ALA A   1      xx.xxx   1.000   1.000\n".repeat(1000);
    files.push(folder.write("in/bad.pdb", large));
    files.push(folder.write("in/empty.pdb", ""));
    files.push(folder.path("in/missing.pdb"));
    files.push(folder.path("in"));
    for keep_going in [&["--threads", "1"][..], &["--keep-going", "--threads", "2"]] {
        let (code, message) = sweep(&folder, keep_going, &files);
        assert_eq!(code, Some(1), "{message}");
        assert!(message.contains("4 of 7 files failed"), "{message}");
        let rows = summary(&folder);
        assert_eq!(rows.len(), 7);
        for (name, word) in
            [("bad.pdb", "line 1"), ("empty.pdb", "empty"), ("missing.pdb", "No such file"), ("/in", "")]
        {
            let row = rows.of_file(name);
            let error = rows.text(row, "error");
            assert!(!error.is_empty() && error.contains(word), "{name}: {error}");
            assert!(message.contains(error), "{message}");
            assert_eq!((rows.text(row, "output"), rows.text(row, "atoms")), ("", ""));
        }
        assert_eq!(folder.names("out").len(), 4);
    }
    // The malformed file is the largest, so it comes first and ends the sweep.
    let strict = folder.path("strict");
    let arguments: Vec<&str> = ["--out-dir", &strict, "--strict", "--threads", "1"]
        .into_iter()
        .chain(files.iter().map(String::as_str))
        .collect();
    let (code, message) = outcome(&run("tess3", &arguments, &[]));
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("bad.pdb"), "{message}");
    assert_eq!(folder.names("strict"), ["summary.tsv"]);
    let rows = Rows::new(&fs::read_to_string(folder.path("strict/summary.tsv")).unwrap());
    assert_eq!(rows.len(), 1);
}

/// Modification times of all outputs.
fn times(folder: &Folder) -> Vec<(String, SystemTime)> {
    let names = folder.names("out").into_iter().filter(|name| name != "summary.tsv");
    names.map(|name| (name.clone(), modified(&folder.path(&format!("out/{name}"))))).collect()
}

fn modified(path: &str) -> SystemTime {
    fs::metadata(path).unwrap().modified().unwrap()
}

fn set_modified(path: &str, time: SystemTime) {
    fs::File::options().append(true).open(path).unwrap().set_modified(time).unwrap();
}

#[test]
fn what_is_done_is_not_done_again() {
    let (folder, mut files) = files();
    let bad = folder.write("in/bad.pdb", "ATOM  none\n");
    files.push(bad.clone());
    assert_eq!(sweep(&folder, &[], &files).0, Some(1));
    // Old outputs of inputs that are older still.
    let past = |hours: u64| SystemTime::UNIX_EPOCH + Duration::from_secs(1_600_000_000 + 3600 * hours);
    files.iter().for_each(|file| set_modified(file, past(0)));
    let age = |folder: &Folder| {
        for (name, _) in times(folder) {
            set_modified(&folder.path(&format!("out/{name}")), past(5));
        }
    };
    age(&folder);
    let before = times(&folder);
    let (code, message) = sweep(&folder, &["--resume"], &files);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("1 of 4 files failed, 3 had been done before"), "{message}");
    assert_eq!(times(&folder), before);
    assert_eq!(summary(&folder).len(), 4);

    // The bad file is corrected, one file is new, one has changed, and one output is cut.
    folder.write("in/bad.pdb", pdb(&cloud(12, 9_000, 1)));
    files.push(folder.write("in/new.pdb", pdb(&cloud(13, 9_000, 1))));
    set_modified(&files[0], past(9));
    let cut = folder.path("out/more/1abc.pdb.spm");
    let whole = fs::read(&cut).unwrap();
    fs::write(&cut, &whole[..whole.len() - 8]).unwrap();
    set_modified(&cut, past(5));
    let (code, message) = sweep(&folder, &["--resume"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("4 files done, 1 had been done before"), "{message}");
    assert_eq!(fs::read(&cut).unwrap(), whole);
    let rows = summary(&folder);
    assert_eq!(rows.len(), 5);
    assert_eq!(rows.number(rows.of_file("bad.pdb"), "atoms"), 12.0);
    assert_eq!(modified(&folder.path("out/2abc.spm")), past(5));
    assert!(modified(&folder.path("out/in/1abc.pdb.spm")) > past(9));

    // With other flags, all outputs are outdated.
    let (code, message) = sweep(&folder, &["--resume", "--atoms", "ca"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("5 files done;"), "{message}");
}

#[test]
fn a_sweep_that_was_killed_goes_on() {
    let (folder, files) = files();
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    // As after a kill: the last line is incomplete.
    let path = folder.path("out/summary.tsv");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, &text[..text.len() - 10]).unwrap();
    let (code, message) = sweep(&folder, &["--resume"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 files done, 2 had been done before"), "{message}");
    assert_eq!(summary(&folder).len(), 3);
    // Without a summary, or without --resume, all files are done again.
    fs::remove_file(&path).unwrap();
    assert!(sweep(&folder, &["--resume"], &files).1.contains("3 files done;"));
    assert!(sweep(&folder, &[], &files).1.contains("3 files done;"));
}

#[test]
fn a_resumed_sweep_does_not_take_the_name_of_what_is_there() {
    let (folder, files) = files();
    assert_eq!(sweep(&folder, &[], &files[..1]).0, Some(0));
    assert_eq!(sweep(&folder, &["--resume"], &files[2..]).0, Some(0));
    assert_eq!(folder.names("out"), ["1abc.pdb.spm", "1abc.spm", "summary.tsv"]);
    let (_, message) = sweep(&folder, &["--resume"], &files);
    assert!(message.contains("1 files done, 2 had been done before"), "{message}");
    assert_eq!(summary(&folder).len(), 3);
}

#[test]
fn models_are_meshes_of_their_own() {
    let folder = Folder::new();
    let file = folder.write("nmr.pdb", models(&[cloud(20, 9_000, 1), cloud(30, 9_000, 2)]));
    let again = folder.write(
        "twice.pdb",
        models(&[cloud(20, 9_000, 1), cloud(30, 9_000, 2)]).replace("     2\n", "     1\n"),
    );
    let (code, message) = sweep(&folder, &["--model", "all"], &[file, again]);
    assert_eq!(code, Some(0), "{message}");
    let names = folder.names("out");
    let expected =
        ["nmr.model1.spm", "nmr.model2.spm", "summary.tsv", "twice.model1.spm", "twice.model2.spm"];
    assert_eq!(names, expected);
    let rows = summary(&folder);
    assert_eq!(rows.len(), 4);
    let mut atoms: Vec<f64> = (0..4).map(|row| rows.number(row, "atoms")).collect();
    atoms.sort_unstable_by(f64::total_cmp);
    assert_eq!(atoms, [20.0, 20.0, 30.0, 30.0]);
}

#[test]
fn threads_change_nothing_of_what_is_written() {
    let (folder, files) = files();
    let outputs = ["1", "2", "8"].map(|threads| {
        assert_eq!(sweep(&folder, &["--threads", threads], &files).0, Some(0));
        let names = folder.names("out").into_iter().filter(|name| name.ends_with(".spm"));
        names.map(|name| fs::read(folder.path(&format!("out/{name}"))).unwrap()).collect::<Vec<_>>()
    });
    assert_eq!(outputs[0], outputs[1]);
    assert_eq!(outputs[0], outputs[2]);
}
