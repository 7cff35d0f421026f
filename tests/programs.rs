//! Runs the programs as a user does.

use std::fs;
use std::io::{Read, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use spmesh_base::error::ErrorKind;

/// A command for a tool of the project.
pub fn tool(name: &str) -> Command {
    let path = match name {
        "spfinalize" => env!("CARGO_BIN_EXE_spfinalize"),
        "spdelaunay2d" => env!("CARGO_BIN_EXE_spdelaunay2d"),
        "spconstrain" => env!("CARGO_BIN_EXE_spconstrain"),
        "splinefit" => env!("CARGO_BIN_EXE_splinefit"),
        "spdelaunay3d" => env!("CARGO_BIN_EXE_spdelaunay3d"),
        "spdem" => env!("CARGO_BIN_EXE_spdem"),
        "spcanopy" => env!("CARGO_BIN_EXE_spcanopy"),
        "spground" => env!("CARGO_BIN_EXE_spground"),
        "spheight" => env!("CARGO_BIN_EXE_spheight"),
        "spreport" => env!("CARGO_BIN_EXE_spreport"),
        "spdiff" => env!("CARGO_BIN_EXE_spdiff"),
        "spsimplify" => env!("CARGO_BIN_EXE_spsimplify"),
        "spnode" => env!("CARGO_BIN_EXE_spnode"),
        "spview" => env!("CARGO_BIN_EXE_spview"),
        "spinfo" => env!("CARGO_BIN_EXE_spinfo"),
        "spconvert" => env!("CARGO_BIN_EXE_spconvert"),
        "configgen" => env!("CARGO_BIN_EXE_configgen"),
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
    // The program may stop reading early; that does not fail the test.
    let feeder = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("the tool ends");
    feeder.join().expect("the feeder ends");
    output
}

/// Starts a tool that reads from `stdin`.
pub fn start(name: &str, arguments: &[&str], stdin: Stdio) -> Child {
    tool(name).args(arguments).stdin(stdin).spawn().expect("the tool starts")
}

/// Lets a command start its program with these signals ignored, as after `nohup`, or with their default
/// effect. Otherwise a program inherits what whoever started the tests ignores or blocks.
pub fn with_signals<'c>(command: &'c mut Command, signals: &[i32], are_ignored: bool) -> &'c mut Command {
    let signals = signals.to_vec();
    let effect = if are_ignored { libc::SIG_IGN } else { libc::SIG_DFL };
    let prepare = move || {
        let mut none = std::mem::MaybeUninit::<libc::sigset_t>::zeroed();
        // SAFETY: the pointers are valid for the calls, which are async-signal-safe; no handler is set.
        unsafe {
            libc::sigemptyset(none.as_mut_ptr());
            libc::sigprocmask(libc::SIG_SETMASK, none.as_ptr(), std::ptr::null_mut());
            for &signal in &signals {
                libc::signal(signal, effect);
            }
        }
        Ok(())
    };
    // SAFETY: between fork and exec, only async-signal-safe calls are made.
    unsafe { command.pre_exec(prepare) }
}

/// Says on stderr that a test checks nothing here. The test harness captures `eprintln!`.
pub fn skip(why: &str) {
    writeln!(std::io::stderr(), "SKIPPED: {why}").expect("stderr");
}

/// Exit code and messages, for assertions.
pub fn outcome(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Asserts that a program whose reader closes the pipe after 100 bytes exits silently with 141.
pub fn assert_silent_without_reader(name: &str, arguments: &[&str]) {
    let mut child = start(name, arguments, Stdio::null());
    let mut head = [0; 100];
    child.stdout.take().expect("stdout is piped").read_exact(&mut head).expect("there is more");
    let (code, message) = outcome(&child.wait_with_output().expect("the tool ends"));
    assert_eq!((code, &message[..]), (Some(141), ""), "{name} {arguments:?}");
}

/// Asserts the exit code of a program, and that its message contains a part and no panic.
pub fn assert_outcome(name: &str, arguments: &[&str], input: &[u8], code: i32, part: &str) {
    let (found, message) = outcome(&run(name, arguments, input));
    assert_eq!(found, Some(code), "{arguments:?}: {message}");
    assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
}

/// The kind of error about a changed byte of a stream. The version is checked before the checksum, as other
/// versions may have another one.
pub fn kind_of_damage(at: usize) -> ErrorKind {
    if matches!(at, 8 | 9) { ErrorKind::Unsupported } else { ErrorKind::Malformed }
}

/// Asserts that a tool refuses a stream that is cut or damaged anywhere, leaves no new file, and does not
/// change an old one. `names` are a new and an old output.
pub fn assert_damage_leaves_no_file(name: &str, arguments: &[&str], names: [&str; 2], stream: &[u8]) {
    let folder = Folder::new();
    folder.file(names[0], "old");
    let check = |bytes: &[u8], place: usize, expected: u8| {
        for output in names {
            let (code, message) =
                outcome(&run(name, &[arguments, &["-o", &folder.path(output)]].concat(), bytes));
            assert_eq!(code, Some(expected.into()), "{name} with {output}, at {place}: {message}");
            assert!(message.contains("stdin: ") && !message.contains("panicked"), "{message}");
        }
        assert_eq!(folder.names(""), names[..1], "{name}, at {place}");
    };
    for place in (0..stream.len()).step_by(stream.len() / 7) {
        check(&stream[..place], place, ErrorKind::Malformed.exit_code());
        let mut damaged = stream.to_vec();
        let changed = (place + 9).min(stream.len() - 1);
        damaged[changed] ^= 4;
        check(&damaged, place, kind_of_damage(changed).exit_code());
    }
    assert_eq!(fs::read_to_string(folder.path(names[0])).expect("a file"), "old");
}

/// A small file that comes with the tests.
pub fn sample(name: &str) -> String {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "tests", "data", name].iter().collect();
    path.to_str().expect("the path is UTF-8").to_string()
}

/// Lines of a scattered cloud of `count` points; no two share an x or a y.
pub fn cloud(count: u64) -> String {
    let point = |i: u64| (i * 7919 % 100_003, i * 104_729 % 99_991, i % 97);
    (0..count).map(point).map(|(x, y, z)| format!("{x} {y} {z}\n")).collect()
}

/// The mesh stream of a cloud of `count` points.
pub fn mesh_of_cloud(count: u64) -> Vec<u8> {
    let points = run("spfinalize", &["-"], cloud(count).as_bytes());
    let mesh = run("spdelaunay2d", &[], &points.stdout);
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    mesh.stdout
}

/// A temporary folder that is removed at the end of a test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn root(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: &str) -> String {
        self.root().join(name).to_str().expect("the path is UTF-8").to_string()
    }

    /// Writes a file and creates the folders for it.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.root().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a temporary folder");
        // Some file systems sync an overwritten file at once; a new file avoids that.
        drop(fs::remove_file(&path));
        fs::write(&path, content).expect("a temporary file");
        path
    }

    /// As [`Folder::file`]; returns the path as a tool's argument.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        self.file(name, content);
        self.path(name)
    }

    /// Names of all files below a folder, sorted.
    pub fn names(&self, folder: &str) -> Vec<String> {
        let root = self.root().join(folder);
        let mut names = Vec::new();
        collect(&root, &root, &mut names);
        names.sort_unstable();
        names
    }
}

fn collect(root: &Path, folder: &Path, names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(root, &path, names);
        } else {
            let name = path.strip_prefix(root).expect("it is below");
            names.push(name.to_str().expect("the path is UTF-8").to_string());
        }
    }
}
