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
use spmesh_stream::{Coordinates, Header, JoinedMesh, OpenedPart, PartName, PartSize, StreamReader, Totals};

const FORMAT: &str = "spmesh mesh in parts";
const VERSION: u32 = 2;

/// What all versions have.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u32,
}

/// A part of a mesh: a stream of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestPart {
    /// Its name: 16 hexadecimal digits.
    pub name: String,
    /// How many parts it joins, directly or not: those that are listed directly before it.
    pub below: u32,
    /// Its file, relative to the folder of the manifest.
    pub file: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its vertices that no part before it has.
    pub vertices: u64,
    /// Its triangles or tetrahedra.
    pub simplices: u64,
    /// A box that holds its vertices, in stored coordinates; none without points.
    #[serde(rename = "box")]
    pub bounds: Option<[[f64; 3]; 2]>,
}

/// A file that a mesh does without.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkippedFile {
    /// Its path, as it was given.
    pub file: String,
    /// What is wrong with it.
    pub reason: String,
}

/// A mesh in parts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    format: String,
    version: u32,
    /// Bounding box of all points in stored coordinates; none without points.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Points of the input, and how many of them coincide with another one.
    pub points: u64,
    /// Points that coincide with another one, and are no vertices.
    pub merged: u64,
    /// Files whose points are not in the mesh.
    pub skipped: Vec<SkippedFile>,
    /// The parts, each behind those that it joins.
    pub parts: Vec<ManifestPart>,
}

impl Manifest {
    /// A manifest of these parts.
    pub fn new(parts: Vec<ManifestPart>) -> Manifest {
        let (format, skipped) = (FORMAT.to_string(), Vec::new());
        Manifest { format, version: VERSION, bounds: None, points: 0, merged: 0, skipped, parts }
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
}

/// Whether a file starts as a manifest does. Pipes do not.
pub fn is_manifest(file: &File) -> bool {
    let mut head = [0; 256];
    let Ok(len) = file.read_at(&mut head, 0) else { return false };
    let start = format!("{{\"format\":\"{FORMAT}\"").replace(' ', "");
    let found = head[..len].iter().filter(|byte| !byte.is_ascii_whitespace());
    found.take(start.len()).eq(start.as_bytes())
}

/// A mesh in parts of which nothing but a header was read.
#[derive(Debug)]
pub struct MeshInParts {
    manifest: Manifest,
    path: PathBuf,
    /// That of the joined mesh.
    header: Header,
}

impl MeshInParts {
    /// Opens the mesh of the manifest at `path`.
    ///
    /// Memory: the manifest.
    ///
    /// # Errors
    /// If the manifest or the header of a part cannot be read.
    pub fn open(path: &Path) -> Result<MeshInParts> {
        let read = || -> Result<MeshInParts> {
            let manifest = Manifest::parse(&inputs::read(path, "a manifest of", MANIFEST_LEN_MAX)?)?;
            let header = header_of(&manifest, path)?;
            Ok(MeshInParts { manifest, path: path.to_path_buf(), header })
        };
        read().map_err(|e| e.of_input(path.display().to_string()))
    }

    /// The header of the whole mesh.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The mesh as one stream. Of a `window`, a closed box of the world, parts are left out that have no
    /// vertex there, and no simplex that reaches in.
    ///
    /// Memory: that of [`JoinedMesh`].
    ///
    /// # Errors
    /// Malformed, if the parts of the manifest cannot be those of a mesh.
    pub fn join(self, window: Option<&Bounds>) -> Result<JoinedMesh> {
        let MeshInParts { manifest, path, header } = self;
        let files: Vec<PathBuf> = manifest.parts.iter().map(|part| file_of(part, &path)).collect();
        let is_wanted =
            |part: &ManifestPart| window.is_none_or(|window| reaches(part, window, &header.coordinates));
        let stated = Totals { points: manifest.points, merged: manifest.merged, ..Totals::default() };
        let joined = || -> Result<JoinedMesh> {
            let sizes = manifest.parts.iter().map(|part| size_of(part, is_wanted(part)));
            let sizes = sizes.collect::<Result<Vec<PartSize>>>()?;
            JoinedMesh::new(header.clone(), sizes, stated, Box::new(move |place| open_part(&files[place])))
        };
        joined().map_err(|e| e.of_input(path.display().to_string()))
    }
}

/// The header of the joined mesh.
fn header_of(manifest: &Manifest, path: &Path) -> Result<Header> {
    // All parts have the same grid. The last one joins all others, so nearly every window needs it.
    let Some(last) = manifest.parts.last() else { return Err(Error::malformed("a mesh without parts")) };
    let (input, name) = open_part(&file_of(last, path))?;
    let reader = StreamReader::new(input, name)?;
    let header = reader.header().clone();
    size_of(last, true)?.name.expect(&header).map_err(|e| e.of_input(reader.name()))?;
    let bounds = manifest.bounds.map(|[min, max]| Bounds { min, max });
    let header = Header { bounds, tree: None, part: None, points: None, ..header };
    header.check().map_err(Error::malformed)?;
    Ok(header)
}

/// The file of a part of the manifest at `path`.
fn file_of(part: &ManifestPart, path: &Path) -> PathBuf {
    path.parent().map_or_else(|| PathBuf::from(&part.file), |folder| folder.join(&part.file))
}

/// Whether a part may have simplices in a window.
fn reaches(part: &ManifestPart, window: &Bounds, coordinates: &Coordinates) -> bool {
    let Some([min, max]) = part.bounds.filter(|_| part.simplices > 0) else { return false };
    let world = Bounds { min: coordinates.to_world(min), max: coordinates.to_world(max) };
    coordinates.widened(&world).meets(window)
}

fn size_of(part: &ManifestPart, is_wanted: bool) -> Result<PartSize> {
    let node = PartName::parse_node(&part.name);
    let node = node.ok_or_else(|| Error::malformed(format!("{:?} is no name of a part", part.name)))?;
    let name = PartName { node, below: part.below };
    Ok(PartSize { name, is_wanted, vertices: part.vertices, simplices: part.simplices })
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
