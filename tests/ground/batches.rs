//! Batches of files that are one set of points: damaged ones are left out, and what is done is skipped.

use std::collections::BTreeMap;
use std::fs;

use spmesh_base::random::Random;

use super::{scene, unclassified};
use crate::height::batches::{identity, rows};
use crate::programs::{Folder, outcome, run};

/// Six tiles side by side, odd ones as LAZ.
fn tiles(folder: &Folder) -> Vec<String> {
    let mut random = Random::new(31);
    let tile = |at: i32| {
        let own = scene(&mut random, 1200, 30, 0.1);
        let moved: Vec<[i32; 3]> = own.iter().map(|[x, y, z]| [x + 3000 * at, *y, *z]).collect();
        let file = unclassified(&moved);
        match at % 2 {
            0 => folder.write(&format!("{at}.las"), file.bytes()),
            _ => folder.write(&format!("{at}.laz"), file.compressed(100)),
        }
    };
    (0..6).map(tile).collect()
}

fn ground(flags: &[&str], files: &[String]) -> (Option<i32>, String) {
    outcome(&run("spground", &[flags, &files.iter().map(String::as_str).collect::<Vec<_>>()].concat(), &[]))
}

fn outputs(folder: &Folder, out: &str) -> BTreeMap<String, Vec<u8>> {
    let names = folder.names(out).into_iter().filter(|name| !name.starts_with("summary"));
    names.map(|name| (name.clone(), fs::read(folder.path(&format!("{out}/{name}"))).unwrap())).collect()
}

/// Files that cannot be opened, and one whose points end early, which is found when others were read.
#[test]
fn damaged_files_are_left_out() {
    let folder = Folder::new();
    let files = tiles(&folder);
    let whole = fs::read(&files[3]).unwrap();
    fs::write(&files[3], &whole[..whole.len() / 2]).unwrap();
    let middle = fs::read(&files[1]).unwrap();
    let mut wrong = middle.clone();
    wrong[middle.len() / 2..middle.len() / 2 + 300].fill(0xaa);
    fs::write(&files[1], &wrong).unwrap();
    fs::write(&files[4], "no points\n").unwrap();
    let (out, fresh) = (folder.path("out"), folder.path("fresh"));
    let (code, message) = ground(&["--out-dir", &out], &files);
    assert!(code == Some(3) && outputs(&folder, "out").is_empty(), "{message}");
    let (code, message) = ground(&["--out-dir", &out, "--keep-going"], &files);
    assert!(code == Some(1) && message.contains("3 of 6 files failed"), "{message}");
    let good: Vec<String> = [0, 2, 5].iter().map(|&at| files[at].clone()).collect();
    assert_eq!(ground(&["--out-dir", &fresh], &good).0, Some(0));
    assert!(outputs(&folder, "out") == outputs(&folder, "fresh"));
    let found = rows(&folder, "out/summary.jsonl");
    for (at, file) in files.iter().enumerate() {
        let row = &found[file.rsplit('/').next().unwrap()];
        let status = if [1, 3, 4].contains(&at) { ("failed", 3) } else { ("done", 0) };
        assert_eq!((&row["status"], &row["exit_code"]), (&status.0.into(), &status.1.into()), "{row}");
        if status.1 == 0 {
            let sum = |names: &[&str]| names.iter().map(|name| row[*name].as_u64().unwrap()).sum::<u64>();
            assert_eq!(sum(&["points"]), 1200);
            assert_eq!(sum(&["other", "ground", "low_noise", "high_noise", "kept"]), 1200, "{row}");
        }
    }
}

/// All classes depend on all files: what is done stays so while none of them changes.
#[test]
fn what_is_done_is_skipped() {
    let folder = Folder::new();
    let files = tiles(&folder);
    let out = folder.path("out");
    let flags = ["--out-dir", &out, "--skip-existing"];
    let identities = || {
        let names = folder.names("out").into_iter().filter(|name| !name.starts_with("summary"));
        names.map(|name| identity(&folder.path(&format!("out/{name}")))).collect::<Vec<_>>()
    };
    assert_eq!(ground(&flags, &files).0, Some(0));
    let first = identities();
    let (code, message) = ground(&flags, &files);
    assert!(code == Some(0) && message.contains("6 had been done before"), "{message}");
    assert_eq!(identities(), first);
    // One output is gone: the others stay.
    fs::remove_file(folder.path("out/2.las")).unwrap();
    assert_eq!(ground(&flags, &files).0, Some(0));
    let second = identities();
    assert_eq!(first.iter().zip(&second).filter(|(before, after)| before != after).count(), 1);
    // Other flags, fewer files, or a file that changed: all again.
    for (extra, files) in [(&["--slope", "0.3"][..], &files[..]), (&[], &files[1..])] {
        let before = identities();
        let (code, message) = ground(&[&flags[..], extra].concat(), files);
        assert!(code == Some(0) && !message.contains("before"), "{message}");
        let after = identities();
        let again = before.iter().zip(&after).filter(|(before, after)| before != after).count();
        assert_eq!(again, files.len());
    }
    fs::write(&files[5], unclassified(&scene(&mut Random::new(1), 90, 30, 0.0)).compressed(100)).unwrap();
    let (code, message) = ground(&flags, &files[1..]);
    assert!(code == Some(0) && !message.contains("before"), "{message}");
    let expected = folder.path("expected");
    assert_eq!(ground(&["--out-dir", &expected], &files[1..]).0, Some(0));
    let mut found = outputs(&folder, "out");
    found.remove("0.las");
    assert!(found == outputs(&folder, "expected"));
}

/// All jobs of a plan must leave out the same files.
#[test]
fn jobs_of_a_plan_leave_nothing_out() {
    let folder = Folder::new();
    let files = tiles(&folder);
    let (plan, out) = (folder.path("plan.json"), folder.path("out"));
    let all: Vec<&str> = ["--plan", &plan].into_iter().chain(files.iter().map(String::as_str)).collect();
    assert!(run("spfinalize", &all, &[]).status.success());
    let flags = ["--plan", &plan, "--out-dir", &out];
    let (code, message) = ground(&[&flags[..], &["--keep-going"]].concat(), &files[..1]);
    assert!(code == Some(2) && message.contains("--skip-bad"), "{message}");
    assert_eq!(ground(&[&flags[..], &["--resume"]].concat(), &files[..2]).0, Some(0));
    let (code, message) = ground(&[&flags[..], &["--resume"]].concat(), &files[..2]);
    assert!(code == Some(0) && message.contains("2 had been done before"), "{message}");
}
