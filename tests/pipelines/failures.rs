//! Pipes of which a part fails.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use super::{TRIANGULATORS, long_stream, mesh_of};
use crate::programs::{Folder, assert_silent_without_reader, cloud, outcome, run, sample, skip, start, tool};

#[test]
fn a_killed_producer_leaves_no_result() {
    for (name, arguments) in TRIANGULATORS {
        let folder = tempfile::tempdir().unwrap();
        let source = folder.path().join("cloud.xyz");
        fs::write(&source, cloud(60_000)).unwrap();
        let arguments = [arguments, &["--cell-points", "2000", source.to_str().unwrap()]].concat();
        let mut finalize = start("spfinalize", &arguments, Stdio::null());
        let mut delaunay = tool(name);
        let mesh = folder.path().join("mesh.spm");
        delaunay.args(["-o", mesh.to_str().unwrap()]).stdin(Stdio::piped());
        let mut delaunay = delaunay.spawn().unwrap();
        // Forward a part of the stream. The finalizer then blocks on the rest until it is killed.
        let mut part = vec![0; 300_000];
        finalize.stdout.as_mut().unwrap().read_exact(&mut part).unwrap();
        std::io::Write::write_all(delaunay.stdin.as_mut().unwrap(), &part).unwrap();
        finalize.kill().unwrap();
        let mut rest = Vec::new();
        finalize.stdout.take().unwrap().read_to_end(&mut rest).unwrap();
        std::io::Write::write_all(delaunay.stdin.as_mut().unwrap(), &rest).unwrap();
        assert!(!finalize.wait().unwrap().success());
        let output = delaunay.wait_with_output().unwrap();
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(3), "{message}");
        assert!(message.starts_with(&format!("{name}: stdin: block ")), "{message}");
        let left: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["cloud.xyz"]);
    }
}

#[test]
fn errors_travel_down_the_pipe() {
    for (triangulator, arguments) in TRIANGULATORS {
        let points = long_stream(arguments);
        let cut = &points[..points.len() / 2];
        let mesh = run(triangulator, &[], cut);
        assert_eq!(outcome(&mesh).0, Some(3));
        for (name, arguments) in [("spinfo", &["--audit", "-"][..]), ("spconvert", &["--to", "text"])] {
            let (code, message) = outcome(&run(name, arguments, &mesh.stdout));
            assert_eq!(code, Some(3), "{name}: {message}");
        }
    }
}

#[test]
fn a_closed_pipe_is_silent() {
    let points = long_stream(&[]);
    let mesh = mesh_of(&points, &[]);
    let folder = tempfile::tempdir().unwrap();
    let names = ["points.spm", "mesh.spm", "space.spm"];
    let files = names.map(|name| folder.path().join(name).to_str().unwrap().to_string());
    let contents = [&points, &mesh, &long_stream(&["--octree"])];
    files.iter().zip(contents).for_each(|(file, content)| fs::write(file, content).unwrap());
    let runs = [
        ("spfinalize", vec![&files[0][..]]),
        ("spdelaunay2d", vec!["--threads", "1", &files[0]]),
        ("spdelaunay2d", vec!["--threads", "2", &files[0]]),
        ("spdelaunay2d", vec!["--threads", "8", &files[0]]),
        ("spdelaunay3d", vec!["--threads", "1", &files[2]]),
        ("spdelaunay3d", vec!["--threads", "8", &files[2]]),
        ("spconvert", vec!["--to", "text", &files[1]]),
        ("spconvert", vec!["--to", "ply", &files[1]]),
    ];
    for (name, arguments) in runs {
        assert_silent_without_reader(name, &arguments);
    }
}

#[test]
fn a_full_disk_is_an_error_with_its_reason() {
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    let points = long_stream(&[]);
    let mesh = mesh_of(&points, &[]);
    let space = long_stream(&["--octree"]);
    let runs = [
        ("spfinalize", vec!["-", "-o", "/dev/full"], &points),
        ("spdelaunay2d", vec!["--threads", "1", "-o", "/dev/full"], &points),
        ("spdelaunay2d", vec!["--threads", "2", "-o", "/dev/full"], &points),
        ("spdelaunay2d", vec!["--threads", "8", "-o", "/dev/full"], &points),
        ("spdelaunay3d", vec!["--threads", "1", "-o", "/dev/full"], &space),
        ("spdelaunay3d", vec!["--threads", "8", "-o", "/dev/full"], &space),
        ("spconvert", vec!["--to", "text", "-o", "/dev/full"], &mesh),
    ];
    for (name, arguments, input) in runs {
        let (code, message) = outcome(&run(name, &arguments, input));
        assert_eq!(code, Some(1), "{name}: {message}");
        assert!(message.contains("No space left on device"), "{name}: {message}");
    }
}

/// Runs a pipe in a shell: the exit codes of its programs, the code of the whole, and what it says.
fn pipe(programs: &str) -> (Vec<i32>, i32, String) {
    let folder = tool("spinfo").get_program().to_owned();
    let folder = Path::new(&folder).parent().unwrap().to_path_buf();
    let script = format!(
        "set -o pipefail; PATH=\"{}:$PATH\"; {programs}; code=($? ${{PIPESTATUS[@]}}); echo ${{code[@]}}",
        folder.display()
    );
    let output = Command::new("bash").args(["-c", &script.replace("; code=", "\ncode=")]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let codes: Vec<i32> = text.trim().split(' ').map(|code| code.parse().unwrap()).collect();
    (codes[1..].to_vec(), codes[0], String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_first_program_that_fails_gives_the_code_and_the_message() {
    let folder = Folder::new();
    let tile = fs::read(sample("lareunion.laz")).unwrap();
    let cut = folder.write("cut.laz", &tile[..tile.len() / 2]);
    let twin = folder.write("bad.txt", "#spmesh points 2\nv 1 2\nx\n");
    let dem = format!("spdem -o '{}'", folder.path("a.tif"));
    for (first, code) in [
        ("spfinalize /no/such.laz".to_string(), 1),
        ("spfinalize --no-such-flag a.laz".to_string(), 2),
        ("spfinalize --lof - -".to_string(), 2),
        (format!("spfinalize '{cut}'"), 3),
        (format!("spfinalize --memory 1K '{}'", sample("lareunion.laz")), 5),
        (format!("spconvert '{twin}' --to spm"), 3),
    ] {
        let (codes, whole, said) = pipe(&format!("{first} | spdelaunay2d | {dem}"));
        assert_eq!((codes, whole), (vec![code; 3], code), "{first}: {said}");
        assert!(!said.contains("spdelaunay2d:") && !said.contains("spdem:"), "{first}: {said}");
        assert!(!said.is_empty());
    }
    let (codes, whole, said) = pipe(&format!("head -c 100 '{cut}' | spdelaunay2d | {dem}"));
    assert_eq!((codes, whole), (vec![0, 3, 3], 3));
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(folder.names("."), ["bad.txt", "cut.laz"]);
}

#[test]
fn a_failure_in_the_middle_of_a_stream_is_passed_on() {
    let folder = Folder::new();
    let points = long_stream(&[]);
    for len in [points.len() / 2, points.len() - 1] {
        let file = folder.write("cut.spm", &points[..len]);
        let dem = format!("spdem -o '{}'", folder.path("a.tif"));
        let (codes, _, said) =
            pipe(&format!("spconvert '{file}' --to spm | spdelaunay2d | spconvert --to spm | {dem}"));
        assert_eq!(codes, [3; 4], "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

#[test]
fn failures_are_marked_in_pipes_of_binary_data_only() {
    let folder = Folder::new();
    let output = folder.path("a.spm");
    assert_eq!(run("spfinalize", &["/no/such.laz"], &[]).stdout, b"\nspmesh: failed 001\n");
    for arguments in [&["spfinalize", "/no/such.laz", "-o", &output][..], &["spinfo", "/no/such.spm"]] {
        assert!(run(arguments[0], &arguments[1..], &[]).stdout.is_empty(), "{arguments:?}");
    }
}
