//! Many files with a summary: what is done, skipped and failed, also after kills.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

use serde_json::Value;
use sha2::{Digest, Sha256};
use spmesh_base::random::Random;

use super::{Parts, mesh_of, scattered};
use crate::programs::{Folder, outcome, run, start};
use crate::sources::las_file::LasFile;

/// The rows of a summary by the names of their files, which have one each.
pub(crate) fn rows(folder: &Folder, path: &str) -> BTreeMap<String, Value> {
    let text = fs::read_to_string(folder.path(path)).unwrap();
    // After a kill, the last line may be incomplete.
    let complete = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    let mut rows = BTreeMap::new();
    for line in complete.lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let name = row["file"].as_str().unwrap().rsplit('/').next().unwrap().to_string();
        assert!(rows.insert(name, row).is_none(), "two rows of a file: {line}");
    }
    rows
}

/// A folder with a ground, and as many files above it.
fn files(count: u64) -> (Folder, Vec<String>) {
    let folder = Folder::new();
    folder.file("ground.spm", mesh_of(&scattered(300, 1000, 1).bytes()));
    let file = |number: u64| {
        let points = scattered(100 + number as usize, 1100, 10 + number);
        if number.is_multiple_of(2) {
            folder.write(&format!("in/{number}.las"), points.bytes())
        } else {
            folder.write(&format!("in/{number}.laz"), points.compressed(60))
        }
    };
    let files = (0..count).map(file).collect();
    (folder, files)
}

fn arguments<'a>(folder: &Folder, flags: &[&'a str], files: &'a [String]) -> Vec<String> {
    let fixed = ["--ground".into(), folder.path("ground.spm"), "--out-dir".into(), folder.path("out")];
    let given = flags.iter().map(ToString::to_string).chain(files.iter().cloned());
    fixed.into_iter().chain(given).collect()
}

fn heights(folder: &Folder, flags: &[&str], files: &[String]) -> (Option<i32>, String) {
    let arguments = arguments(folder, flags, files);
    outcome(&run("spheight", &arguments.iter().map(String::as_str).collect::<Vec<_>>(), &[]))
}

/// The identity of a file: another one has another inode or time.
pub(crate) fn identity(path: &str) -> (u64, i64, i64) {
    let found = fs::metadata(path).unwrap();
    (found.ino(), found.mtime(), found.mtime_nsec())
}

/// Identities of the outputs of all files that are done.
fn done(folder: &Folder) -> BTreeMap<String, (u64, i64, i64)> {
    let rows = rows(folder, "out/summary.jsonl");
    let outputs = rows.values().filter_map(|row| row["output"].as_str());
    outputs.map(|output| (output.to_string(), identity(&folder.path(&format!("out/{output}"))))).collect()
}

/// Replaces some of the files by others that fail; returns the exit code of each.
fn spoil(folder: &Folder, files: &[String]) -> Vec<(String, u64)> {
    let name = |number: usize| files[number].rsplit('/').next().unwrap().to_string();
    let whole = fs::read(&files[5]).unwrap();
    fs::write(&files[5], &whole[..whole.len() / 2]).unwrap();
    fs::write(&files[16], "no points\n").unwrap();
    fs::remove_file(&files[27]).unwrap();
    folder.file(&format!("in/{}", name(38)), "");
    vec![(name(5), 3), (name(16), 3), (name(27), 1), (name(38), 3)]
}

#[test]
fn a_batch_that_is_killed_again_and_again_does_each_file_once() {
    let (folder, files) = files(40);
    let bad = spoil(&folder, &files);
    let list = folder.write("list", files.join("\n"));
    let flags = ["--keep-going", "--skip-existing", "--lof", &list];
    let arguments = arguments(&folder, &flags, &[]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut random = Random::new(64);
    let mut before = BTreeMap::new();
    for kill in 0..6 {
        let mut child = start("spheight", &arguments, Stdio::null());
        // When the summary has some lines more.
        let lines = before.len() + random.below(9) as usize;
        let has_lines = || {
            let text = fs::read_to_string(folder.path("out/summary.jsonl")).unwrap_or_default();
            text.lines().count() >= lines
        };
        while !has_lines() && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let now = done(&folder);
        for (output, identity) in &before {
            assert_eq!(now.get(output), Some(identity), "{output} was made again, kill {kill}");
        }
        before = now;
    }
    let skipped = before.len();
    let (code, message) = heights(&folder, &flags, &[]);
    assert_eq!(code, Some(1), "{message}");
    let summary = format!("4 of 40 files failed, {skipped} had been done before");
    assert!(message.contains(&summary), "{message}");
    let (now, found) = (done(&folder), rows(&folder, "out/summary.jsonl"));
    assert!(before.iter().all(|(output, identity)| now[output] == *identity));
    assert_eq!((found.len(), now.len()), (40, 36));
    for (name, code) in &bad {
        let row = &found[name];
        assert_eq!((&row["status"], &row["exit_code"]), (&"failed".into(), &(*code).into()), "{row}");
        assert!(message.contains(row["error"].as_str().unwrap()), "{row}");
    }
    // Nothing but the outputs of a run that was never killed, with the same bytes.
    let good: Vec<String> = files
        .iter()
        .filter(|file| !bad.iter().any(|(name, _)| file.ends_with(&format!("/{name}"))))
        .cloned()
        .collect();
    let fresh = folder.path("fresh");
    let plain = ["--ground", &folder.path("ground.spm"), "--out-dir", &fresh];
    let plain = plain.into_iter().chain(good.iter().map(String::as_str)).collect::<Vec<_>>();
    assert!(run("spheight", &plain, &[]).status.success());
    let mut names = folder.names("fresh");
    for name in &names {
        let [made, expected] = ["out", "fresh"].map(|from| fs::read(folder.path(&format!("{from}/{name}"))));
        assert!(made.unwrap() == expected.unwrap(), "{name}");
    }
    names.push("summary.jsonl".into());
    names.sort_unstable();
    assert_eq!(folder.names("out"), names);
    // Quiet, only what failed is said.
    let (_, message) = heights(&folder, &["--keep-going", "--resume", "-q", "--lof", &list], &[]);
    assert_eq!(message.lines().count(), 5, "{message}");
    assert_eq!(done(&folder), now);
}

#[test]
fn rows_say_what_became_of_files() {
    let (folder, files) = files(3);
    let (code, message) = heights(&folder, &["--keep-going"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("3 files done; see") && message.contains("summary.jsonl"), "{message}");
    let found = rows(&folder, "out/summary.jsonl");
    let state = |path: &str| {
        let content = fs::read(path).unwrap();
        let (_, seconds, nanoseconds) = identity(path);
        let sha256 = data_encoding::HEXLOWER.encode(&Sha256::digest(&content));
        [Value::from(content.len()), format!("{seconds}.{nanoseconds:09}").into(), sha256.into()]
    };
    let columns = |row: &Value, prefix: &str| {
        ["bytes", "modified", "sha256"].map(|column| row[format!("{prefix}_{column}")].clone())
    };
    let mut without = 0;
    for file in &files {
        let row = &found[file.rsplit('/').next().unwrap()];
        assert_eq!(columns(row, "input"), state(file));
        assert_eq!(columns(row, "ground"), state(&folder.path("ground.spm")));
        let output = folder.path(&format!("out/{}", row["output"].as_str().unwrap()));
        assert_eq!([&row["output_bytes"], &row["output_modified"]], [&state(&output)[0], &state(&output)[1]]);
        let heights = Parts::of(&fs::read(output).unwrap()).heights();
        let count = |is: fn(i32) -> bool| Value::from(heights.iter().filter(|height| is(**height)).count());
        assert_eq!(row["points"], heights.len());
        assert_eq!(row["without_height"], count(|height| height == i32::MIN));
        assert_eq!(row["below_ground"], count(|height| height < 0 && height != i32::MIN));
        assert_eq!(row["outside"], row["without_height"]);
        assert!(row["error"].is_null() && row["seconds"].as_f64().unwrap() > 0.0, "{row}");
        without += row["without_height"].as_u64().unwrap();
    }
    assert!(without > 0 && message.contains(&format!("{without} points are outside of the ground")));
    // With heights of all points.
    assert_eq!(heights(&folder, &["--keep-going", "--outside", "nearest"], &files).0, Some(0));
    for row in rows(&folder, "out/summary.jsonl").values() {
        assert!(row["without_height"] == 0 && row["outside"].as_u64().unwrap() > 0, "{row}");
    }
    // The ending tells the format, as in sweeps of tess3.
    let table = folder.path("s.tsv");
    assert_eq!(heights(&folder, &["--summary", &table], &files).0, Some(0));
    let text = fs::read_to_string(table).unwrap();
    assert!(text.starts_with("file\toutput\tstatus\t") && text.lines().count() == 4, "{text}");
}

/// Sets the time of the last change.
fn age(path: &str, seconds: u64) {
    let time = SystemTime::UNIX_EPOCH + Duration::from_secs(1_600_000_000 + seconds);
    fs::File::options().append(true).open(path).unwrap().set_modified(time).unwrap();
}

#[test]
fn what_an_output_depends_on_decides() {
    let (folder, files) = files(3);
    let ground = folder.path("ground.spm");
    let again = |flags: &[&str], part: &str| {
        let flags = [&["--skip-existing"], flags].concat();
        let (code, message) = heights(&folder, &flags, &files);
        assert!(code == Some(0) && message.contains(part), "{flags:?}: {message}");
    };
    let (all, none) = ("3 files done; see", "0 files done, 3 had been done before");
    // The existence of outputs says nothing.
    assert_eq!(heights(&folder, &[], &files).0, Some(0));
    again(&[], all);
    again(&[], none);
    // Other times of the same content, of the inputs and of the ground.
    files.iter().chain([&ground]).for_each(|path| age(path, 0));
    again(&[], none);
    again(&["--stats=json"], "\"triangles\":0");
    // Another ground.
    let (old, new) = (fs::read(&ground).unwrap(), mesh_of(&scattered(300, 1000, 2).bytes()));
    fs::write(&ground, &new).unwrap();
    again(&[], all);
    fs::write(&ground, &old).unwrap();
    again(&[], all);
    // Other options.
    again(&["--name", "above"], all);
    again(&["--outside", "nearest"], all);
    again(&["--threads", "1", "--memory", "1M", "--outside", "nearest"], none);
    again(&[], all);
    // Another input of the same length.
    fs::write(&files[0], scattered(100, 1100, 99).bytes()).unwrap();
    again(&[], "1 file done, 2 had been done before");
    // An output that is gone, one that is cut, and one that another run has replaced.
    fs::remove_file(folder.path("out/0.las")).unwrap();
    again(&[], "1 file done, 2 had been done before");
    let cut = folder.path("out/1.laz");
    let whole = fs::read(&cut).unwrap();
    fs::write(&cut, &whole[1..]).unwrap();
    again(&[], "1 file done, 2 had been done before");
    assert!(fs::read(&cut).unwrap() == whole);
    folder.file("other.spm", mesh_of(&scattered(300, 1000, 3).bytes()));
    let right = fs::read(folder.path("out/2.las")).unwrap();
    let plain = ["--ground", &folder.path("other.spm"), &files[2], "--out-dir", &folder.path("out")];
    assert!(run("spheight", &plain, &[]).status.success());
    let wrong = fs::read(folder.path("out/2.las")).unwrap();
    assert!(wrong.len() == right.len() && wrong != right);
    again(&[], "1 file done, 2 had been done before");
    assert!(fs::read(folder.path("out/2.las")).unwrap() == right);
    // Another version.
    let summary = folder.path("out/summary.jsonl");
    let version = |of: &str| format!("\"version\":\"{of}\"");
    let text = fs::read_to_string(&summary).unwrap();
    fs::write(&summary, text.replace(&version(env!("CARGO_PKG_VERSION")), &version("0.0.9"))).unwrap();
    again(&[], all);
    again(&[], none);
    // Another format has other names: none of the former is left.
    again(&["--format", "laz"], all);
    assert_eq!(folder.names("out"), ["0.laz", "1.laz", "2.laz", "summary.jsonl"]);
}

#[test]
fn a_file_that_fails_now_leaves_no_earlier_heights() {
    let (folder, files) = files(2);
    assert_eq!(heights(&folder, &["--keep-going"], &files).0, Some(0));
    fs::write(&files[0], "no points").unwrap();
    let (code, message) = heights(&folder, &["--keep-going", "--resume"], &files);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("1 of 2 files failed, 1 had been done before"), "{message}");
    assert_eq!(folder.names("out"), ["1.laz", "summary.jsonl"]);
    // Without --keep-going, headers are looked at before the work, and the first error ends the run.
    let strict = heights(&folder, &["--resume"], &files);
    assert!(strict.0 == Some(3) && strict.1.contains("0.las"), "{strict:?}");
    assert_eq!(folder.names("out"), ["1.laz", "summary.jsonl"]);
}

#[test]
fn batches_that_cannot_be_right_are_refused() {
    let (folder, files) = files(2);
    let path = |name: &str| folder.path(name);
    let same = folder.write("more/0.las", scattered(10, 100, 5).bytes());
    let zipped = folder.write("zipped/0.las.gz", "");
    let inputs = [&files[..1], std::slice::from_ref(&same)].concat();
    for other in [&same, &zipped] {
        for flags in [&[][..], &["--keep-going"]] {
            let (code, message) = heights(&folder, flags, &[files[0].clone(), other.clone()]);
            assert!(code == Some(2) && message.contains("would have the same output as"), "{message}");
        }
    }
    let list = folder.write("list", &inputs[0]);
    for (flags, part) in [
        (["--resume", "--summary", "-"], "give it a file"),
        (["--keep-going", "--lof", &list], "given twice"),
        (["--keep-going", "--summary", &files[0]], "would replace the input"),
        (["--keep-going", "--summary", &path("out/0.las")], "the name is that of points"),
        (["--keep-going", "--name", ""], "--name"),
    ] {
        let (code, message) = heights(&folder, &flags, &inputs[..1]);
        assert!(code == Some(2) && message.contains(part), "{flags:?}: {message}");
    }
    let out = path("out");
    let piped = ["--ground", "-", "--skip-existing", &files[0], "--out-dir", &out];
    let ground = fs::read(path("ground.spm")).unwrap();
    let (code, message) = outcome(&run("spheight", &piped, &ground));
    assert!(code == Some(2) && message.contains("give it as a file"), "{message}");
    // Outputs into the folder of the inputs.
    let into = ["--ground", &path("ground.spm"), "--keep-going", &files[0], "--out-dir", &path("in")];
    let (code, message) = outcome(&run("spheight", &into, &[]));
    assert!(code == Some(2) && message.contains("would replace"), "{message}");
    assert!(!folder.names("").iter().any(|name| name.starts_with("out/")), "{:?}", folder.names(""));
    // An output that an earlier run made of another file, or of the same one by another name.
    assert_eq!(heights(&folder, &["--keep-going"], &files).0, Some(0));
    let (code, message) = heights(&folder, &["--resume"], &inputs[1..]);
    assert!(code == Some(2) && message.contains("is that of") && message.contains("in/0.las"), "{message}");
    let renamed = vec![files[0].replace("/in/", "/in/./")];
    let (code, message) = heights(&folder, &["--resume"], &renamed);
    assert!(code == Some(0) && message.contains("1 file done;"), "{message}");
    assert_eq!(rows(&folder, "out/summary.jsonl").len(), 2);
    // Another run is writing there.
    let held = fs::File::open(&out).unwrap();
    rustix::fs::flock(&held, rustix::fs::FlockOperation::LockExclusive).unwrap();
    let (code, message) = heights(&folder, &["--resume"], &files);
    assert!(code == Some(2) && message.contains("is writing here"), "{message}");
}

/// A pipe can be opened once only, and its heights are never skipped.
#[test]
fn pipes_are_read_once() {
    let folder = Folder::new();
    folder.file("ground.spm", mesh_of(&scattered(300, 1000, 1).bytes()));
    let pipe = folder.path("pipe.las");
    rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR).unwrap();
    let arguments = arguments(&folder, &["--keep-going"], std::slice::from_ref(&pipe));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let child = start("spheight", &arguments, Stdio::null());
    fs::write(&pipe, LasFile::of(&[[500, 500, 7]; 3]).bytes()).unwrap();
    let (code, message) = outcome(&child.wait_with_output().unwrap());
    assert_eq!(code, Some(0), "{message}");
    let row = &rows(&folder, "out/summary.jsonl")["pipe.las"];
    assert!(row["points"] == 3 && row["input_sha256"].is_null(), "{row}");
}
