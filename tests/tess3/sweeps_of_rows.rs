//! One table of the rows of many files.

use std::fs;
use std::process::Stdio;

use super::molecules::{cloud, models, pdb};
use super::parquet_reader::read;
use crate::programs::{Folder, assert_outcome, outcome, run, start};

/// Files in an order that is neither that of their names nor that of their sizes.
fn files(folder: &Folder) -> Vec<String> {
    let counts = [30, 70, 10, 50];
    let file = |(at, count): (usize, u32)| {
        let text = if at == 1 {
            models(&[cloud(count, 9_000, 1), cloud(count, 9_000, 2)])
        } else {
            pdb(&cloud(count, 9_000, u64::from(count)))
        };
        folder.write(&format!("{}.pdb", 9 - at), text)
    };
    counts.into_iter().enumerate().map(|(at, count)| file((at, count))).collect()
}

const FLAGS: [&str; 5] = ["--sasa", "--model", "all", "--radii", "bondi"];

fn sweep(folder: &Folder, table: &str, more: &[&str], files: &[String]) -> (Option<i32>, String) {
    let (out, table) = (folder.path("out"), folder.path(table));
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let flags = [&FLAGS[..], more, &["--out-dir", &out, "-o", &table], &files].concat();
    outcome(&run("tess3", &flags, b""))
}

/// The rows of each file by itself, in a format with lines.
fn expected(ending: &str, files: &[String]) -> String {
    let mut text = String::new();
    for file in files {
        let output = run("tess3", &[&FLAGS[..], &["--format", ending, file]].concat(), b"");
        let table = String::from_utf8(output.stdout).unwrap();
        let head = if ending == "tsv" && !text.is_empty() { table.find('\n').unwrap() + 1 } else { 0 };
        text += &table[head..];
    }
    text
}

#[test]
fn one_table_has_the_rows_of_all_files_in_their_order() {
    let folder = Folder::new();
    let files = files(&folder);
    for ending in ["tsv", "jsonl"] {
        let name = format!("all.{ending}");
        let (code, message) = sweep(&folder, &name, &["--threads", "2"], &files);
        assert_eq!(code, Some(0), "{message}");
        assert_eq!(fs::read_to_string(folder.path(&name)).unwrap(), expected(ending, &files));
        assert_eq!(folder.names("out").len(), 5);
    }
    assert_eq!(sweep(&folder, "all.parquet", &["--resume"], &files).0, Some(0));
    let table = read(&fs::read(folder.path("all.parquet")).unwrap());
    let text = expected("tsv", &files);
    assert_eq!(table.rows.len(), text.lines().count() - 1);
    assert_eq!(table.groups, [table.rows.len()]);
    let names: Vec<&str> = table.columns.iter().map(|(name, _)| &name[..]).collect();
    assert_eq!(names.join("\t"), text.lines().next().unwrap());
}

#[test]
fn files_that_failed_have_no_rows_until_they_are_mended() {
    let folder = Folder::new();
    let files = files(&folder);
    let whole = fs::read(&files[2]).unwrap();
    fs::write(&files[2], "ATOM  none\n").unwrap();
    let (code, message) = sweep(&folder, "all.tsv", &[], &files);
    assert_eq!(code, Some(1), "{message}");
    let others = [&files[..2], &files[3..]].concat();
    assert_eq!(fs::read_to_string(folder.path("all.tsv")).unwrap(), expected("tsv", &others));
    fs::write(&files[2], whole).unwrap();
    // The table is made again of the parts of other files.
    let (code, message) = sweep(&folder, "all.tsv", &["--resume"], &files);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 file done, 3 had been done before"), "{message}");
    assert_eq!(fs::read_to_string(folder.path("all.tsv")).unwrap(), expected("tsv", &files));
    // Nothing is left to do, and an order is an order.
    let turned: Vec<String> = files.iter().rev().cloned().collect();
    assert!(sweep(&folder, "all.tsv", &["--resume"], &turned).1.contains("0 files done, 4 had been done"));
    assert_eq!(fs::read_to_string(folder.path("all.tsv")).unwrap(), expected("tsv", &turned));
    // A part that was changed is made again.
    let part = folder.names("out").into_iter().find(|name| name.ends_with(".rows")).unwrap();
    fs::write(folder.path(&format!("out/{part}")), "x").unwrap();
    assert!(sweep(&folder, "all.tsv", &["--resume"], &files).1.contains("1 file done, 3 had been"));
    assert_eq!(fs::read_to_string(folder.path("all.tsv")).unwrap(), expected("tsv", &files));
}

#[test]
fn a_sweep_that_is_killed_again_and_again_has_each_row_once() {
    let folder = Folder::new();
    let files: Vec<String> =
        (0..60).map(|at| folder.write(&format!("{at}.pdb"), pdb(&cloud(400, 20_000, at + 1)))).collect();
    let list = folder.write("list", files.join("\n"));
    let (out, table) = (folder.path("out"), folder.path("all.tsv"));
    let flags =
        ["--sasa", "--radii", "bondi", "--lof", &list, "--out-dir", &out, "-o", &table, "--threads", "2"];
    let mut kills = 0;
    loop {
        let mut child = start("tess3", &[&flags[..], &["--resume"]].concat(), Stdio::null());
        let done =
            |folder: &Folder| fs::read_to_string(folder.path("out/summary.tsv")).map_or(0, |text| text.len());
        let before = done(&folder);
        // Killed as soon as something more is done; twenty times at most.
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break Some(status);
            }
            if kills < 20 && done(&folder) > before + 300 {
                child.kill().unwrap();
                child.wait().unwrap();
                break None;
            }
        };
        match status {
            Some(status) => {
                assert!(status.success());
                break;
            }
            None => {
                assert!(!fs::exists(&table).unwrap(), "no table before all is done");
                kills += 1;
            }
        }
    }
    assert!(kills > 0);
    let text = fs::read_to_string(&table).unwrap();
    let found: Vec<&str> = text.lines().skip(1).map(|line| line.split('\t').next().unwrap()).collect();
    let expected: Vec<&str> = files.iter().flat_map(|file| std::iter::repeat_n(&file[..], 400)).collect();
    assert_eq!(found, expected);
}

#[test]
fn what_cannot_be_one_table_is_refused() {
    let folder = Folder::new();
    let files = files(&folder);
    let out = folder.path("out");
    for (flags, part) in [
        (&["-o", "all.spm"][..], "--output with --out-dir is for tables"),
        (&["--sasa", "-o", "all.csv"], ".parquet"),
        (&["--sasa", "-o", "all.tsv", "--format", "jsonl"], "the name is that of tsv"),
        (&["--sasa", "-o", &files[0]], "would replace the input"),
    ] {
        let flags = [flags, &["--out-dir", &out, &files[0], &files[1]]].concat();
        assert_outcome("tess3", &flags, b"", 2, part);
    }
    // Not even one whose name is that of a table.
    let input = folder.write("in.tsv", fs::read(&files[0]).unwrap());
    assert_outcome("tess3", &["--sasa", "--out-dir", &out, &input, "-o", &input], b"", 2, "would replace");
    assert_outcome("tess3", &["--sasa", &files[0], &files[1]], b"", 2, "for one table of all also -o FILE");
}
