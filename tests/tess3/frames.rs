//! Frames of trajectories: rows in their order, as those of files of their own, and failures.

use std::fs;
use std::path::Path;

use super::molecules::Rows;
use crate::programs::{Folder, outcome, run};

pub fn sample(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name).to_str().unwrap().to_string()
}

/// A table of `tess3`.
fn table(arguments: &[&str]) -> String {
    let output = run("tess3", &[&["-q"], arguments].concat(), &[]);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

const AREAS: [&str; 4] = ["--sasa", "--volumes", "--per", "residue"];

/// The rows of a table: file, number of the model or frame, and the rest.
fn rows(table: &str) -> Vec<[&str; 3]> {
    let fields = table.lines().skip(1).map(|line| line.splitn(3, '\t').collect::<Vec<_>>());
    fields.map(|fields| fields.try_into().unwrap()).collect()
}

/// The rows without the file.
fn numbered(table: &str) -> Vec<[&str; 2]> {
    rows(table).into_iter().map(|[_, number, rest]| [number, rest]).collect()
}

/// The frames of `frames.gro` as texts.
fn separate() -> Vec<String> {
    let text = fs::read_to_string(sample("frames.gro")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    lines.chunks(lines.len() / 3).map(|frame| frame.join("\n") + "\n").collect()
}

#[test]
fn frames_have_the_rows_of_files_of_their_own() {
    let folder = Folder::new();
    let of_files: Vec<String> = separate()
        .iter()
        .map(|text| table(&[&AREAS[..], &[&folder.write("one.gro", text)]].concat()))
        .collect();
    let expected: Vec<[&str; 2]> = ["0", "1", "2"]
        .iter()
        .zip(&of_files)
        .flat_map(|(number, table)| rows(table).into_iter().map(move |[_, _, rest]| [*number, rest]))
        .collect();
    let [gro, xtc, trr, dcd] = ["gro", "xtc", "trr", "dcd"].map(|ending| sample(&format!("frames.{ending}")));
    for threads in ["1", "2", "5"] {
        let arguments = [&AREAS[..], &["--threads", threads]].concat();
        let of_frames = table(&[&arguments[..], &["--frames", "::", &gro]].concat());
        assert!(of_frames.starts_with("file\tframe\tchain\t"), "{of_frames}");
        assert_eq!(numbered(&of_frames), expected);
        let of_trajectory = table(&[&arguments[..], &["--top", &gro, &xtc]].concat());
        assert_eq!(numbered(&of_trajectory), expected);
        // The file is that of the frames.
        assert!(rows(&of_frames).iter().all(|row| row[0] == gro));
        assert!(rows(&of_trajectory).iter().all(|row| row[0] == xtc));
        for exact in [&trr, &dcd] {
            let rows = Rows::new(&table(&[&arguments[..], &["--top", &gro, exact]].concat()));
            let rounded = Rows::new(&of_frames);
            assert_eq!(rows.len(), rounded.len());
            let area = |rows: &Rows| (0..rows.len()).map(|row| rows.number(row, "area")).sum::<f64>();
            assert!((area(&rows) / area(&rounded) - 1.0).abs() < 1e-3);
        }
    }
    let second = table(&[&AREAS[..], &["--top", &gro, &xtc, "--frames", "1"]].concat());
    assert!(numbered(&second).iter().all(|row| row[0] == "1" && expected.contains(row)), "{second}");
    let zipped = folder.write("frames.xtc.zst", zstd::encode_all(&fs::read(&xtc).unwrap()[..], 3).unwrap());
    let [plain, zipped] = [&xtc, &zipped].map(|path| table(&["--contacts", "--top", &gro, path]));
    assert!(plain.starts_with("file\tframe\tchain1") && numbered(&plain) == numbered(&zipped));
}

#[test]
fn models_are_measured_by_their_numbers() {
    let path = sample("1l2y.pdb.gz");
    let areas = |more: &[&str]| table(&[&AREAS[..], more, &[&path]].concat());
    let [first, second, all] = [&["--model", "1"][..], &["--model", "2"], &["--model", "all"]].map(areas);
    let second_rows = second.split_once('\n').unwrap().1;
    assert_eq!(all, first.clone() + second_rows);
    for threads in ["1", "2", "9"] {
        assert_eq!(areas(&["--model", "1..7", "--threads", threads]), all);
    }
    assert_eq!(areas(&["--model", "2..2"]), second);
    let frames = areas(&["--frames", "1:"]);
    let of_models = numbered(&second).into_iter().map(|[_, rest]| ["1", rest]);
    assert_eq!(numbered(&frames), of_models.collect::<Vec<_>>());
    for (range, code, words) in [("3..9", 2, "has no model"), ("2..1", 2, "FIRST..LAST")] {
        let (found, message) = outcome(&run("tess3", &["--model", range, "--sasa", &path], &[]));
        assert!(found == Some(code) && message.contains(words), "{message}");
    }
}

#[test]
fn a_sweep_has_a_row_for_each_frame() {
    let folder = Folder::new();
    let [gro, xtc, dcd] = ["gro", "xtc", "dcd"].map(|ending| sample(&format!("frames.{ending}")));
    let out = folder.path("out");
    let sweep = |more: &[&str]| {
        let arguments = ["--top", &gro, "--out-dir", &out, "--sasa", "--per", "molecule", &xtc, &dcd];
        outcome(&run("tess3", &[&arguments[..], more].concat(), &[]))
    };
    assert_eq!(sweep(&[]).0, Some(0));
    let summary = Rows::new(&fs::read_to_string(folder.path("out/summary.tsv")).unwrap());
    assert_eq!(summary.len(), 6);
    for row in 0..6 {
        assert_eq!(summary.number(row, "model") as usize, row % 3);
        assert_eq!(summary.number(row, "atoms"), 170.0);
        assert_eq!(summary.number(row, "topology_bytes"), fs::metadata(&gro).unwrap().len() as f64);
        assert!(summary.text(row, "options").contains("--frames 0::1"));
    }
    let of_one = table(&["--sasa", "--per", "molecule", "--top", &gro, &xtc]);
    let output = summary.text(summary.of_file("frames.xtc"), "output").to_string();
    assert_eq!(fs::read_to_string(folder.path(&format!("out/{output}"))).unwrap(), of_one);
    assert!(sweep(&["--resume"]).1.contains("2 had been done before"), "{:?}", sweep(&["--resume"]));
    // One table of all, on any number of threads.
    let whole = folder.path("whole.tsv");
    for threads in ["1", "3"] {
        assert_eq!(sweep(&["-o", &whole, "--threads", threads]).0, Some(0));
        let of_both = fs::read_to_string(&whole).unwrap();
        assert_eq!(rows(&of_both)[..3], rows(&of_one));
        assert_eq!(rows(&of_both).len(), 6);
    }
    // Meshes are one output per frame.
    let meshes = folder.path("meshes");
    assert_eq!(outcome(&run("tess3", &["--top", &gro, &xtc, "--out-dir", &meshes], &[])).0, Some(0));
    assert_eq!(
        folder.names("meshes"),
        ["frames.model0.spm", "frames.model1.spm", "frames.model2.spm", "summary.tsv"]
    );
}

#[test]
fn failures_leave_no_table() {
    let folder = Folder::new();
    let [gro, xtc] = ["gro", "xtc"].map(|ending| sample(&format!("frames.{ending}")));
    let bytes = fs::read(&xtc).unwrap();
    let cut = folder.write("cut.xtc", &bytes[..bytes.len() - 50]);
    let other = sample("1l2y.pdb.gz");
    for (arguments, code, words) in [
        (vec!["--top", &gro, &cut], 3, "frame 2 at byte"),
        (vec!["--top", &other, &xtc], 2, "frame 0 at byte 56: the frame has 170 atoms, the topology 304"),
        (vec![&xtc], 3, "this is an XTC trajectory of GROMACS"),
        (vec!["--frames", "0", &xtc], 2, "--top FILE"),
        (vec!["--top", &gro, &xtc, "--frames", "7:"], 2, "has 3 frames"),
        (vec!["--top", &gro, &xtc, "--frames", "2:1"], 2, "FIRST:END:STEP"),
        (vec!["--top", &gro, "--model", "1", &xtc], 2, "cannot be used with"),
        (vec!["--top", "-", "-"], 2, "cannot both be stdin"),
    ] {
        let out = folder.path("out.tsv");
        let arguments = [&["--sasa", "-o", &out][..], &arguments].concat();
        let (found, message) = outcome(&run("tess3", &arguments, &[]));
        assert!(found == Some(code) && message.contains(words), "{arguments:?}: {message}");
        assert!(!Path::new(&out).exists(), "{arguments:?}");
    }
    let mesh = folder.path("all.spm");
    let (code, message) = outcome(&run("tess3", &["--top", &gro, &xtc, "-o", &mesh], &[]));
    assert!(code == Some(2) && message.contains("several frames need a folder"), "{message}");
}
