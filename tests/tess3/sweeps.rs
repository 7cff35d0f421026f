//! Many input files: where their outputs go, and what happens if some files fail.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

use sha2::{Digest, Sha256};

use super::mesh::Mesh;
use super::molecules::{Rows, cloud, models, pdb};
use crate::programs::{Folder, outcome, run, start};

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
fn a_file_that_is_given_twice_is_refused_before_the_work() {
    let (folder, files) = files();
    let list = folder.write("list", files.join("\n"));
    let again = files[1].replace("/in/", "/in/./");
    for twice in [&files[1], &again] {
        let (code, message) = sweep(&folder, &["--lof", &list], std::slice::from_ref(twice));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains("2abc.ent") && message.contains("given twice"), "{message}");
    }
    assert!(!std::path::Path::new(&folder.path("out")).exists());
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
    // Files that have another time, but the same content.
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

    // The bad file is corrected, one file is new, one has other content and an older time, and one output is
    // cut.
    folder.write("in/bad.pdb", pdb(&cloud(12, 9_000, 1)));
    files.push(folder.write("in/new.pdb", pdb(&cloud(13, 9_000, 1))));
    folder.write("in/1abc.pdb", pdb(&cloud(50, 9_000, 51)));
    set_modified(&files[0], past(0) - Duration::from_secs(1));
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
    let alone = run("tess3", &[&files[0]], &[]);
    assert!(fs::read(folder.path("out/in/1abc.pdb.spm")).unwrap() == alone.stdout);

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
    assert!(message.contains("1 file done, 2 had been done before"), "{message}");
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
    assert!(message.contains("1 file done, 2 had been done before"), "{message}");
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

/// Replaces fields of the summary.
fn edit(folder: &Folder, from: &str, to: &str) {
    let path = folder.path("out/summary.tsv");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{text}");
    fs::write(&path, text.replace(from, to)).unwrap();
}

#[test]
fn the_summary_says_what_was_read_and_what_made_it() {
    let (folder, files) = files();
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    let rows = summary(&folder);
    for file in &files {
        let row = rows.of_file(file);
        let content = fs::read(file).unwrap();
        assert_eq!(rows.number(row, "input_bytes") as usize, content.len());
        let sha256 = data_encoding::HEXLOWER.encode(&Sha256::digest(&content));
        assert_eq!(rows.text(row, "input_sha256"), sha256);
        let since = modified(file).duration_since(SystemTime::UNIX_EPOCH).unwrap();
        let time = format!("{}.{:09}", since.as_secs(), since.subsec_nanos());
        assert_eq!(rows.text(row, "input_modified"), time);
        assert_eq!(rows.text(row, "version"), env!("CARGO_PKG_VERSION"));
    }
    // Outputs of another version are made again.
    edit(&folder, concat!("\t", env!("CARGO_PKG_VERSION"), "\t"), "\t0.0.9\t");
    assert!(sweep(&folder, &["--resume"], &files).1.contains("3 files done;"));
    assert!(sweep(&folder, &["--resume"], &files).1.contains("0 files done, 3 had been done before"));
    edit(&folder, "\tinput_sha256", "");
    let (code, message) = sweep(&folder, &["--resume"], &files);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("without --resume"), "{message}");
}

#[test]
fn a_file_that_fails_now_leaves_no_earlier_output() {
    for resume in [&["--resume"][..], &[]] {
        let folder = Folder::new();
        let text = models(&[cloud(20, 9_000, 1), cloud(30, 9_000, 2)]);
        let nmr = folder.write("nmr.pdb", &text);
        let one = folder.write("one.pdb", pdb(&cloud(15, 9_000, 3)));
        let files = [nmr, one];
        let flags: Vec<&str> = ["--model", "all"].iter().chain(resume).copied().collect();
        assert_eq!(sweep(&folder, &flags, &files).0, Some(0));
        assert_eq!(sweep(&folder, &["--contacts", "--summary", &folder.path("c.tsv")], &files).0, Some(0));
        let tables = ["nmr.contacts.tsv", "one.contacts.tsv"];
        let names = |rest: &[&str]| {
            let mut names: Vec<&str> = tables.iter().chain(rest).copied().collect();
            names.sort_unstable();
            names.into_iter().map(str::to_string).collect::<Vec<_>>()
        };
        let all = ["nmr.model1.spm", "nmr.model2.spm", "one.model1.spm", "summary.tsv"];
        assert_eq!(folder.names("out"), names(&all));
        // One model less, and no atoms.
        folder.write("nmr.pdb", &text[..text.find("ENDMDL").unwrap() + 7]);
        folder.write("one.pdb", "ATOM  none\n");
        let (code, message) = sweep(&folder, &flags, &files);
        assert_eq!(code, Some(1), "{message}");
        assert_eq!(folder.names("out"), names(&["nmr.model1.spm", "summary.tsv"]));
    }
}

#[test]
fn warnings_are_in_the_summary() {
    let folder = Folder::new();
    let flat = folder.write("flat.xyz", "0 0 0\n4 0 0\n0 4 0\n4 4 0\n4 4 0\n");
    assert_eq!(sweep(&folder, &[], &[flat]).0, Some(0));
    let rows = summary(&folder);
    let expected =
        "1 of 5 points coincides with an earlier one; no tetrahedra: all points in a plane (5 points)";
    assert_eq!(rows.text(0, "warnings"), expected);
    let files = ["tests/data/altloc.cif".into(), "tests/data/1pfe.cif.gz".into()];
    assert_eq!(sweep(&folder, &["--altloc", "Z"], &files).0, Some(1));
    let rows = summary(&folder);
    // Each atom of the first file has alternate locations.
    for (name, column) in [("altloc.cif", "error"), ("1pfe.cif.gz", "warnings")] {
        let text = rows.text(rows.of_file(name), column);
        assert!(text.contains("no atom has the alternate location \"Z\", only A, B"), "{text}");
    }
}

#[test]
fn two_sweeps_keep_out_of_each_others_folder() {
    let (folder, files) = files();
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    let path = |name: &str| fs::File::open(folder.path(name)).unwrap();
    for name in ["out", "out/summary.tsv"] {
        let held = path(name);
        rustix::fs::flock(&held, rustix::fs::FlockOperation::LockExclusive).unwrap();
        let (code, message) = sweep(&folder, &["--resume"], &files);
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains("another sweep"), "{message}");
        drop(held);
        assert_eq!(sweep(&folder, &["--resume"], &files).0, Some(0));
    }
    // Many at the same time: those that are let in lose no row of each other.
    let out = folder.path("many");
    let starts: Vec<_> = (0..12)
        .map(|_| start("tess3", &["--out-dir", &out, "--resume", &files[0], &files[1]], Stdio::null()))
        .collect();
    let ends: Vec<_> = starts.into_iter().map(|child| outcome(&child.wait_with_output().unwrap())).collect();
    assert!(ends.iter().any(|(code, _)| *code == Some(0)), "{ends:?}");
    assert!(ends.iter().all(|(code, _)| matches!(code, Some(0 | 2))), "{ends:?}");
    let rows = Rows::new(&fs::read_to_string(folder.path("many/summary.tsv")).unwrap());
    assert_eq!(rows.len(), 2);
}

#[test]
fn summaries_are_json_lines_if_their_name_says_so() {
    let (folder, files) = files();
    let path = folder.path("s.jsonl");
    let json = ["--summary", &path[..], "--resume"];
    let bad = folder.write("in/bad.pdb", "ATOM  none\n");
    let all: Vec<String> = files.iter().chain([&bad]).cloned().collect();
    assert_eq!(sweep(&folder, &json, &all).0, Some(1));
    let (code, message) = sweep(&folder, &json, &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("3 had been done before"), "{message}");
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    let rows = summary(&folder);
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().count(), 3);
    for line in text.lines() {
        let object: serde_json::Value = serde_json::from_str(line).unwrap();
        let row = rows.of_file(object["file"].as_str().unwrap());
        assert_eq!(object["tetrahedra"].as_f64().unwrap(), rows.number(row, "tetrahedra"));
        assert_eq!(object["input_sha256"].as_str().unwrap(), rows.text(row, "input_sha256"));
        assert!(object["error"].is_null() && object["seconds"].is_number());
    }
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

#[test]
fn named_pipes_are_read_once() {
    let folder = Folder::new();
    let pipe = folder.path("pipe.xyz");
    rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR).unwrap();
    let child = start("tess3", &["--out-dir", &folder.path("out"), &pipe], Stdio::null());
    fs::write(&pipe, "0 0 0\n4 0 0\n0 4 0\n0 0 4\n").unwrap();
    let (code, message) = outcome(&child.wait_with_output().unwrap());
    assert_eq!(code, Some(0), "{message}");
    let rows = summary(&folder);
    assert_eq!((rows.number(0, "atoms"), rows.text(0, "input_sha256")), (4.0, ""));
}

/// A sweep that stops, or is killed, before it comes to a file must not forget what there is of it.
#[test]
fn names_and_outputs_do_not_depend_on_interruptions() {
    let (folder, files) = files();
    let names = ["2abc.spm", "in/1abc.pdb.spm", "more/1abc.pdb.spm", "summary.tsv"];
    assert_eq!(sweep(&folder, &[], &files).0, Some(0));
    assert_eq!(folder.names("out"), names);
    folder.write("in/1abc.pdb", pdb(&cloud(51, 9_000, 51)));
    assert_eq!(sweep(&folder, &["--resume"], &files).0, Some(0));
    assert_eq!(folder.names("out"), names, "a revised file keeps the name of its output");
    // The largest file comes first, fails, and ends the sweep.
    let whole = fs::read(&files[1]).unwrap();
    folder.write("in/2abc.ent", "no structure\n".repeat(10_000));
    folder.write("in/1abc.pdb", pdb(&cloud(52, 9_000, 52)));
    let (code, message) = sweep(&folder, &["--resume", "--strict", "--threads", "1"], &files);
    assert_eq!(code, Some(3), "{message}");
    assert_eq!(folder.names("out"), ["more/1abc.pdb.spm", "summary.tsv"], "nothing is stale");
    fs::write(&files[1], whole).unwrap();
    assert_eq!(sweep(&folder, &["--resume"], &files).0, Some(0));
    assert_eq!(folder.names("out"), names);
    let made = fs::read(folder.path("out/in/1abc.pdb.spm")).unwrap();
    assert_eq!(Mesh::read(&made).points.len(), 52);
}
