//! A hostile input and the command that reads it.

use std::fs;
use std::path::Path;

use crate::MEMORY_MAX;
use crate::measured::{Measured, tool};

pub struct Case {
    pub name: &'static str,
    /// A command. `IN` is the input, `OUT` an output, `DATA/` the samples of the tests, `MESH` a mesh.
    pub line: &'static str,
    pub bytes: Vec<u8>,
    /// The exit code, and a part of the message: it must fail for the right reason.
    pub code: i32,
    pub part: &'static str,
    /// Most memory beyond the start of the program. Units: MB.
    pub memory_max: f64,
}

/// An input that a program must refuse as malformed.
pub fn malformed(
    name: &'static str,
    line: &'static str,
    bytes: impl Into<Vec<u8>>,
    part: &'static str,
) -> Case {
    Case { name, line, bytes: bytes.into(), code: 3, part, memory_max: MEMORY_MAX }
}

/// An input that a program may accept.
pub fn accepted(name: &'static str, line: &'static str, bytes: impl Into<Vec<u8>>) -> Case {
    Case { name, line, bytes: bytes.into(), code: 0, part: "", memory_max: MEMORY_MAX }
}

impl Case {
    /// Another exit code than usual.
    pub fn with_code(self, code: i32) -> Case {
        Case { code, ..self }
    }

    pub fn words(&self) -> Vec<String> {
        self.line.split(' ').map(str::to_string).collect()
    }

    /// Writes the input and runs the command.
    pub fn run(&self, folder: &Path) -> Measured {
        let here = |name: &str| folder.join(name).to_str().expect("the path is UTF-8").to_string();
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");
        if self.line.contains("MESH") && !folder.join("mesh.spm").exists() {
            fs::write(folder.join("points.txt"), "0 0 1\n9 0 2\n9 9 3\n0 9 4\n4 5 6\n").expect("a folder");
            let (points, mesh) = (here("points.spm"), here("mesh.spm"));
            assert!(tool("spfinalize").args([&here("points.txt"), "-qo", &points]).status().is_ok());
            assert!(tool("spdelaunay2d").args([&points, "-qo", &mesh]).status().is_ok());
        }
        let words: Vec<String> = self.words();
        let arguments: Vec<String> = words[1..]
            .iter()
            .map(|word| match word.split_once('.') {
                Some(("IN", ending)) => here(&format!("in.{ending}")),
                Some(("OUT", ending)) => here(&format!("out.{ending}")),
                _ if word == "MESH" => here("mesh.spm"),
                _ => word.replace("DATA/", data),
            })
            .collect();
        for (word, path) in words[1..].iter().zip(&arguments).filter(|(word, _)| word.starts_with("IN.")) {
            fs::write(path, &self.bytes).unwrap_or_else(|error| panic!("{word}: {error}"));
        }
        Measured::of(tool(&words[0]).args(&arguments))
    }
}
