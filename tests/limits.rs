//! Programs whose memory or threads the system limits: an error with advice, never an abort or a panic.

mod counts;
mod formats;
mod named;
mod sides;

use std::process::{Command, Output};

use crate::programs::{Folder, cloud, outcome, run, sample, skip, tool};

/// Runs a tool with a limit of the shell, such as `-v 40000` for KiB of address space.
fn limited(limit: &str, name: &str, arguments: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!(r#"ulimit {limit}; exec "$0" "$@""#)]);
    shell.arg(tool(name).get_program()).args(arguments).output().expect("the shell runs")
}

#[test]
#[cfg(target_os = "linux")]
fn little_memory_is_an_error_with_advice() {
    try_limits(false);
}

/// Programs that work with little memory work with more.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "long: run with -- --ignored"]
fn every_limit_of_memory_is_an_error_with_advice_or_enough() {
    try_limits(true);
}

/// Runs programs with more and more memory; if not `all`, until it is enough.
#[cfg(target_os = "linux")]
fn try_limits(all: bool) {
    let folder = Folder::new();
    let file = |name: &str, tool: &str, arguments: &[&str]| {
        let output = run(tool, arguments, &[]);
        assert!(output.status.success(), "{:?}", outcome(&output));
        folder.write(name, output.stdout)
    };
    let tile = sample("lareunion.laz");
    let points = file("points.spm", "spfinalize", &[&tile]);
    let solid = file("solid.spm", "spfinalize", &["--octree", &tile]);
    let mesh = file("mesh.spm", "spdelaunay2d", &[&points]);
    let text = folder.write("points.txt", cloud(5_000));
    let cases: [(&str, &[&str]); 12] = [
        ("spfinalize", &[&tile]),
        ("spfinalize", &["--threads", "8", &tile]),
        ("spdelaunay2d", &["--threads", "8", &points]),
        ("spdelaunay3d", &["--threads", "2", &solid]),
        ("spdem", &["--columns", "4000", &mesh]),
        ("spdem", &["--contours", "1", &mesh]),
        ("spview", &["--format", "png", &mesh]),
        ("tess3", &[&tile]),
        ("dd4", &["--grid", "12x12x12x12"]),
        ("configgen", &["--degree", "3", &text]),
        ("splinefit", &["fit", "--step", "4000", &text]),
        ("spinfo", &["--audit", &mesh]),
    ];
    let mut failures = 0;
    for (name, arguments) in cases {
        for megabytes in [24, 28, 34, 42, 60] {
            let output = limited(&format!("-v {}", megabytes << 10), name, arguments);
            let (code, message) = outcome(&output);
            // 127: not even the shared libraries of the program fit.
            let is_expected = [Some(0), Some(1), Some(5), Some(127)].contains(&code);
            assert!(is_expected, "{name} {arguments:?} with {megabytes} MB: {code:?}, {message}");
            failures += usize::from(code == Some(5));
            // glibc has a line of its own for a thread that finds no memory when it starts.
            let own = message.lines().filter(|line| !line.starts_with("Fatal glibc error: "));
            let is_one_line = message.contains("memory") && own.count() == 1;
            assert!(code != Some(5) || is_one_line, "{name}: {message}");
            if code == Some(0) && !all {
                break;
            }
        }
    }
    assert!(failures > 10, "{failures}");
}

/// A small input needs little address space, whatever `--memory` allows.
#[test]
#[cfg(target_os = "linux")]
fn address_space_is_that_of_the_input() {
    let folder = Folder::new();
    let text = folder.write("points.txt", cloud(1_000));
    for memory in ["64M", "512M", "100G"] {
        let (code, message) = outcome(&limited("-v 50000", "spfinalize", &["--memory", memory, &text]));
        assert_eq!(code, Some(0), "--memory {memory}: {message}");
    }
}

/// The limit holds for users other than root.
#[test]
#[cfg(target_os = "linux")]
fn refused_threads_are_an_error_with_advice() {
    let folder = Folder::new();
    let text = folder.write("points.txt", cloud(100));
    let points = folder.write("points.spm", run("spfinalize", &[&text], &[]).stdout);
    let nobody = "--reuid=65534 --regid=65534 --clear-groups prlimit --nproc=1:1";
    let limited = |name: &str, arguments: &[&str]| {
        let mut command = Command::new("setpriv");
        command.args(nobody.split(' ')).arg(tool(name).get_program()).args(arguments);
        command.stdin(std::fs::File::open(&points).expect("a file")).output()
    };
    // Without setpriv, without the right to become another user, or in a folder that others may not enter.
    if !limited("spinfo", &["--version"]).is_ok_and(|output| output.status.success()) {
        skip("this user cannot become another one, whose threads can be limited");
        return;
    }
    for (threads, expected) in [("1", 0), ("8", 1)] {
        let output = limited("spdelaunay2d", &["--threads", threads]).expect("it runs");
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(expected), "{message}");
        assert!(code == Some(0) || message.contains("take fewer --threads"), "{message}");
    }
}

/// The signal of the system would end the program without a word.
#[test]
#[cfg(target_os = "linux")]
fn files_that_may_not_grow_are_an_error() {
    let folder = Folder::new();
    let text = folder.write("points.txt", cloud(5_000));
    let output = folder.path("points.spm");
    let limited = limited("-f 8", "spfinalize", &[&text, "-o", &output]);
    let (code, message) = outcome(&limited);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("points.spm") && message.contains("large"), "{message}");
    assert!(!std::path::Path::new(&output).exists());
}
