//! Running the tools as a user does.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

/// A command for a tool of this crate.
pub fn tool(name: &str) -> Command {
    let path = match name {
        "spfinalize" => env!("CARGO_BIN_EXE_spfinalize"),
        "spdelaunay2d" => env!("CARGO_BIN_EXE_spdelaunay2d"),
        "spinfo" => env!("CARGO_BIN_EXE_spinfo"),
        "spconvert" => env!("CARGO_BIN_EXE_spconvert"),
        "dd4" => env!("CARGO_BIN_EXE_dd4"),
        "tess3" => env!("CARGO_BIN_EXE_tess3"),
        other => panic!("no tool {other}"),
    };
    let mut command = Command::new(path);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs a tool with arguments and input.
pub fn run(name: &str, arguments: &[&str], input: &[u8]) -> Output {
    let mut child = tool(name).args(arguments).stdin(Stdio::piped()).spawn().expect("the tool starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let input = input.to_vec();
    // A tool may stop reading early; that is its right and not the test's failure.
    let feeder = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("the tool ends");
    feeder.join().expect("the feeder ends");
    output
}

/// Starts a tool that reads from `stdin`.
pub fn start(name: &str, arguments: &[&str], stdin: Stdio) -> Child {
    tool(name).args(arguments).stdin(stdin).spawn().expect("the tool starts")
}

/// Exit code and messages, for assertions.
pub fn outcome(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A small file that comes with the tests.
pub fn sample(name: &str) -> String {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "tests", "data", name].iter().collect();
    path.to_str().expect("the path is UTF-8").to_string()
}

/// Lines of a scattered cloud of `count` points, each different in x and y.
pub fn cloud(count: u64) -> String {
    let point = |i: u64| (i * 7919 % 100_003, i * 104_729 % 99_991, i % 97);
    (0..count).map(point).map(|(x, y, z)| format!("{x} {y} {z}\n")).collect()
}
