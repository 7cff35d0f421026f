//! The vectors of `formats/vectors`: this crate and the Python reader must accept and refuse the same ones.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::{Event, Header, MemoryRules, StreamReader};

use crate::programs::{Folder, run, skip};

/// One vector: its name, its bytes, and the expected text twin, or words and exit code of the error.
pub struct Vector {
    pub name: String,
    pub bytes: Vec<u8>,
    pub expected: String,
    /// That of success for a vector in `pass`.
    pub exit_code: u8,
}

pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The bytes of the vector of this name that programs take.
pub fn vector(name: &str) -> Vec<u8> {
    load("pass", "txt").into_iter().find(|vector| vector.name == name).unwrap().bytes
}

/// All vectors of a folder, by name.
pub fn load(folder: &str, extension: &str) -> Vec<Vector> {
    let mut vectors = Vec::new();
    for entry in std::fs::read_dir(repository("formats/vectors").join(folder)).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|found| found == "hex") {
            let expected = std::fs::read_to_string(path.with_extension(extension)).unwrap();
            let (expected, exit_code) = match expected.split_once("\nexit code ") {
                Some((words, code)) => (words.to_string(), code.trim_end().parse().unwrap()),
                None => (expected, 0),
            };
            vectors.push(Vector {
                name: path.file_stem().unwrap().to_string_lossy().into_owned(),
                bytes: parse_hex(&std::fs::read_to_string(&path).unwrap()),
                expected,
                exit_code,
            });
        }
    }
    vectors.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(vectors.len() > 10, "the vectors of {folder} are missing");
    vectors
}

fn parse_hex(text: &str) -> Vec<u8> {
    let data = text.lines().map(|line| line.split('#').next().unwrap());
    data.flat_map(str::split_whitespace).map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// Reads a whole stream and checks every rule, including the rules that need to remember cells and vertices.
pub fn verify(bytes: &[u8]) -> Result<(Header, Vec<Event>)> {
    verify_rows(bytes).map(|(header, events, _)| (header, events))
}

/// As [`verify`], with the attributes of the points of each event.
pub fn verify_rows(bytes: &[u8]) -> Result<(Header, Vec<Event>, Vec<Vec<u8>>)> {
    let mut reader = StreamReader::new(bytes, "vector")?;
    let header = reader.header().clone();
    let mut rules = MemoryRules::new(&header);
    let (mut events, mut rows) = (Vec::new(), Vec::new());
    while let Some(event) = reader.next_event()? {
        rules.check(&event).map_err(|error| reader.locate(error))?;
        events.push(event);
        rows.push(reader.rows().to_vec());
    }
    Ok((header, events, rows))
}

/// Whether the error says that a stream is malformed, or needs what this version does not know.
pub fn is_refused(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::Malformed | ErrorKind::Unsupported)
}

/// Runs a script of this repository with `input` on stdin. Without Python, prints a note to stderr and
/// returns `None`.
pub fn run_python(script: &str, arguments: &[&str], input: &[u8]) -> Option<Output> {
    let spawned = Command::new("python3")
        .arg(repository(script))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let Ok(mut child) = spawned else {
        skip(&format!("python3 is missing, {script} was not run"));
        return None;
    };
    let mut stdin = child.stdin.take().unwrap();
    let output = std::thread::scope(|scope| {
        // The script may end before it has read everything.
        scope.spawn(move || drop(stdin.write_all(input)));
        child.wait_with_output().unwrap()
    });
    Some(output)
}

#[test]
fn vectors_that_must_pass_do() {
    for vector in load("pass", "txt") {
        if let Err(error) = verify(&vector.bytes) {
            panic!("{}: {error}", vector.name);
        }
    }
}

#[test]
fn vectors_that_must_fail_do_with_their_words_and_a_position() {
    for vector in load("fail", "err") {
        let error = verify(&vector.bytes).map(|_| ()).expect_err(&vector.name);
        let message = error.to_string();
        assert_eq!(error.exit_code(), vector.exit_code, "{}: {message}", vector.name);
        assert!(is_refused(&error), "{}: {message}", vector.name);
        assert!(message.contains(&vector.expected), "{}: {message}", vector.name);
        assert!(!message.contains('{'), "{}: a structure in {message}", vector.name);
        assert!(message.contains(" byte ") || message.contains(": byte "), "{}: {message}", vector.name);
    }
}

/// Manifests of meshes in parts: programs read them as one stream, or say what is wrong.
#[test]
fn meshes_in_parts_are_joined_or_refused() {
    let folder = repository("formats/vectors/joined");
    let mut seen = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        seen += 1;
        let name = path.to_str().unwrap();
        let output = run("spconvert", &[name, "--to", "text"], &[]);
        let (code, message) = (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned());
        if let Ok(twin) = std::fs::read(path.with_extension("txt")) {
            assert_eq!(code, Some(0), "{name}: {message}");
            assert!(output.stdout == twin, "{name}");
            continue;
        }
        let expected = std::fs::read_to_string(path.with_extension("err")).unwrap();
        let (words, exit_code) = expected.split_once("\nexit code ").unwrap();
        assert_eq!(code, exit_code.trim_end().parse().ok(), "{name}: {message}");
        assert!(message.contains(words), "{name}: {message}");
    }
    assert!(seen > 20);
}

#[test]
fn the_python_reader_gives_the_same_twins_and_the_same_errors() {
    let Some(output) = run_python("scripts/check_vectors.py", &[], &[]) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_vectors_are_those_that_their_writer_spells_out() {
    let Some(output) = run_python("scripts/make_vectors.py", &["--check"], &[]) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The manifest names every vector; its bytes are those of the `.hex` file, and faults are where it says.
#[test]
fn the_manifest_tells_of_every_vector() {
    let text = std::fs::read(repository("formats/vectors/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let entries = manifest["vectors"].as_array().unwrap();
    let mut names = Vec::new();
    for (folder, extension) in [("pass", "txt"), ("fail", "err")] {
        for vector in load(folder, extension) {
            let file = format!("{folder}/{}.spm", vector.name);
            let entry = entries.iter().find(|entry| entry["file"] == file.as_str());
            let entry = entry.unwrap_or_else(|| panic!("{file} is not in the manifest"));
            let bytes = std::fs::read(repository("formats/vectors").join(&file)).unwrap();
            assert!(bytes == vector.bytes, "{file} differs from its .hex");
            assert_eq!(entry["exit_code"], vector.exit_code, "{file}");
            if let Err(error) = verify(&bytes) {
                let place = match entry["block"].as_u64() {
                    Some(block) => format!("block {block} at byte {}", entry["byte"]),
                    None if entry["byte"] == 0 => "header at byte 0".to_string(),
                    None => format!("byte {}: ", entry["byte"]),
                };
                assert!(error.to_string().contains(&place), "{file}: {error}, expected at {place}");
            }
            names.push(file);
        }
    }
    assert_eq!(names.len(), entries.len());
}

/// The small reader and writer beside the text work together with the programs.
#[test]
fn the_small_reader_and_writer_do_what_they_say() {
    for (file, lines) in [("formats/reader.py", 60), ("formats/writer.py", 40)] {
        let text = std::fs::read_to_string(repository(file)).unwrap();
        assert!(text.lines().count() <= lines, "{file} has more than {lines} lines");
    }
    let points = "0 0 1\n4 0 2\n0 4.5 3\n4 4 5\n";
    let Some(written) = run_python("formats/writer.py", &[], points.as_bytes()) else { return };
    assert!(written.status.success());
    assert_eq!(verify(&written.stdout).unwrap().1.len(), 2);
    let finalized = run("spfinalize", &["--preserve", "-"], &written.stdout);
    let mesh = run("spdelaunay2d", &[], &finalized.stdout);
    let read = |stream: &[u8]| run_python("formats/reader.py", &[], stream).unwrap();
    let obj = String::from_utf8(read(&finalized.stdout).stdout).unwrap();
    assert_eq!(obj, "v 0.0 0.0 1.0\nv 4.0 0.0 2.0\nv 0.0 4.5 3.0\nv 4.0 4.0 5.0\n");
    let triangles = read(&mesh.stdout);
    assert!(triangles.status.success(), "{}", String::from_utf8_lossy(&triangles.stderr));
    let lines = String::from_utf8(triangles.stdout).unwrap();
    assert_eq!(lines.lines().filter(|line| line.starts_with("f ")).count(), 2);
    // Grids of integers, and damage.
    let vector = std::fs::read(repository("formats/vectors/pass/mesh-two-patches.spm")).unwrap();
    let obj = String::from_utf8(read(&vector).stdout).unwrap();
    assert!(obj.contains("v 1.0 1.0 1.0\n") && obj.ends_with("f 4 3 2\n"), "{obj}");
    assert!(!read(&vector[..vector.len() - 1]).status.success());
    let folder = Folder::new();
    let driver = folder.write("damage.py", DAMAGE);
    let reader = repository("formats/reader.py");
    let output = run_python(&driver, &[reader.to_str().unwrap()], &vector).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let refused = String::from_utf8(output.stdout).unwrap();
    assert_eq!(refused.trim_end(), format!("accepted [-1], refused {}", vector.len()));
}

/// Runs a reader on a stream as it is, which is byte -1, and on the stream with each of its bytes changed;
/// all in one process, as each start of Python takes longer than hundreds of streams.
const DAMAGE: &str = "
import contextlib, io, sys
code, stream = compile(open(sys.argv[1]).read(), 'reader', 'exec'), sys.stdin.buffer.read()
accepted, refused = [], 0
for at in range(-1, len(stream)):
    damaged = bytearray(stream)
    if at >= 0:
        damaged[at] ^= 4
    sys.stdin = io.TextIOWrapper(io.BytesIO(damaged))
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(code, {'__name__': '__main__'})
        accepted.append(at)
    except Exception:
        refused += 1
print(f'accepted {accepted}, refused {refused}')
";
