//! The manifest of a mesh in parts: a small file that stands for the mesh wherever a stream is read.

use std::fs::{self, File};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::source::gzip::Plain;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::MANIFEST_LEN_MAX;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Header, JoinedMesh, OpenedPart, PartSize, StreamReader, Totals};

const FORMAT: &str = "spmesh mesh in parts";
const VERSION: u32 = 1;

/// What all versions have.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u32,
}

/// A part of a mesh: a stream of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestPart {
    /// Its number.
    pub number: u32,
    /// Its file, relative to the folder of the manifest.
    pub file: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its vertices that no part before it has.
    pub vertices: u64,
    /// Its triangles or tetrahedra.
    pub simplices: u64,
}

/// A mesh in parts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    format: String,
    version: u32,
    /// The hash of the plan, in hexadecimal digits.
    pub plan: String,
    /// Bounding box of all points in stored coordinates; none without points.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Points of the input, and how many of them coincide with another one.
    pub points: u64,
    /// Points that coincide with another one, and are no vertices.
    pub merged: u64,
    /// The parts, each behind those whose vertices it uses.
    pub parts: Vec<ManifestPart>,
}

impl Manifest {
    /// A manifest of these parts.
    pub fn new(plan: &str, parts: Vec<ManifestPart>) -> Manifest {
        let (format, plan) = (FORMAT.to_string(), plan.to_string());
        Manifest { format, version: VERSION, plan, bounds: None, points: 0, merged: 0, parts }
    }

    /// The manifest as JSON, one part in each line.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn to_json(&self) -> Result<String> {
        let text = |e: serde_json::Error| Error::malformed(format!("the manifest cannot be written: {e}"));
        let head = serde_json::to_string(&Manifest { parts: Vec::new(), ..self.clone() }).map_err(text)?;
        let parts: std::result::Result<Vec<String>, _> =
            self.parts.iter().map(serde_json::to_string).collect();
        let head = head.strip_suffix("]}").unwrap_or(&head);
        Ok(format!("{head}\n{}\n]}}\n", parts.map_err(text)?.join(",\n")))
    }

    fn parse(text: &[u8]) -> Result<Manifest> {
        let not_one = |e: serde_json::Error| {
            Error::malformed(format!("this is JSON, but no manifest of a mesh in parts: {e}"))
        };
        let Head { format, version } = serde_json::from_slice(text).map_err(not_one)?;
        if format != FORMAT {
            return Err(Error::malformed(format!("this is {format:?}, expected a mesh in parts")));
        }
        if version != VERSION {
            return Err(Error::unsupported(format!(
                "version {version} of a manifest; this program reads {VERSION}"
            )));
        }
        serde_json::from_slice(text).map_err(not_one)
    }

    /// The number by which streams name the plan.
    fn plan_number(&self) -> Result<u64> {
        let digits = self.plan.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        let number = u64::from_str_radix(&self.plan, 16).ok().filter(|_| digits && self.plan.len() == 16);
        number.ok_or_else(|| Error::malformed(format!("{:?} is no hash of a plan", self.plan)))
    }
}

/// Whether a file starts as a manifest does. Pipes do not.
pub fn is_manifest(file: &File) -> bool {
    let mut head = [0; 256];
    let Ok(len) = file.read_at(&mut head, 0) else { return false };
    let start = format!("{{\"format\":\"{FORMAT}\"").replace(' ', "");
    let found = head[..len].iter().filter(|byte| !byte.is_ascii_whitespace());
    found.take(start.len()).eq(start.as_bytes())
}

/// Opens a mesh in parts as one stream.
///
/// Memory: the manifest, and that of [`JoinedMesh`].
///
/// # Errors
/// If the manifest or the first part cannot be read.
pub fn open_manifest(path: &Path) -> Result<JoinedMesh> {
    joined(path).map_err(|e| e.of_input(path.display().to_string()))
}

fn joined(path: &Path) -> Result<JoinedMesh> {
    let manifest = Manifest::parse(&inputs::read(path, "a manifest of", MANIFEST_LEN_MAX)?)?;
    let plan = manifest.plan_number()?;
    let folder = path.parent().map(PathBuf::from).unwrap_or_default();
    let sizes: Vec<PartSize> = manifest.parts.iter().map(size_of).collect();
    let mut files = vec![PathBuf::new(); manifest.parts.len()];
    for part in &manifest.parts {
        if let Some(file) = files.get_mut(part.number as usize) {
            *file = folder.join(&part.file);
        }
    }
    let open = move |number: u32| open_part(&files[number as usize]);
    let Some(first) = sizes.first() else { return Err(Error::malformed("a mesh without parts")) };
    if first.number as usize >= sizes.len() {
        return Err(Error::malformed("parts are not numbered from 0 on"));
    }
    let (input, name) = open(first.number)?;
    let header = StreamReader::new(input, name)?.header().clone();
    let bounds = manifest.bounds.map(|[min, max]| Bounds { min, max });
    let header = Header { bounds, tree: None, part: None, points: None, ..header };
    header.check().map_err(Error::malformed)?;
    let stated = Totals { points: manifest.points, merged: manifest.merged, ..Totals::default() };
    JoinedMesh::new(header, plan, sizes, stated, Box::new(open))
}

fn size_of(part: &ManifestPart) -> PartSize {
    PartSize { number: part.number, vertices: part.vertices, simplices: part.simplices }
}

fn open_part(path: &Path) -> Result<OpenedPart> {
    let name = path.display().to_string();
    let named = |e: Error| e.of_input(&name);
    // Opening a pipe that nothing writes to would wait for ever.
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return Err(named(Error::malformed("a part of a mesh is no regular file")));
    }
    let file = inputs::open(path).map_err(named)?;
    let plain = Plain::new(file).map_err(|e| named(Error::io("reading", e)))?;
    Ok((Box::new(plain), name))
}
