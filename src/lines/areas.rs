//! Areas whose borders are segments of a network.

use std::path::PathBuf;

use spmesh_core::error::{Error, Result};
use spmesh_geometry::noding::{Chains, LineVertex, Noded};
use spmesh_io::source::Breaklines;

/// Files of lines and polygons.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sources<'p> {
    /// Lines; rings of polygons among them are lines.
    pub lines: &'p [PathBuf],
    /// Polygons outside of which the mesh is removed.
    pub hull: &'p [PathBuf],
    /// Polygons inside of which it is removed.
    pub holes: &'p [PathBuf],
    /// Lakes, rivers and their centre lines.
    pub water: &'p [PathBuf],
}

/// What a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Lines,
    Hull,
    Holes,
    Water,
}

impl<'p> Sources<'p> {
    pub(crate) fn files(&self) -> impl Iterator<Item = (Role, &'p PathBuf)> {
        let of = |role, paths: &'p [PathBuf]| paths.iter().map(move |path| (role, path));
        let areas = of(Role::Hull, self.hull).chain(of(Role::Holes, self.holes));
        of(Role::Lines, self.lines).chain(areas).chain(of(Role::Water, self.water))
    }
}

/// The polygons of areas, each as the numbers of the segments of its border. Inside of a polygon are the
/// places from which a ray crosses its border an odd number of times.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Areas {
    /// Of `--hull`; `None` if it was not given.
    pub hull: Option<Vec<Vec<u32>>>,
    /// Of `--holes`; `None` if it was not given.
    pub holes: Option<Vec<Vec<u32>>>,
}

/// A ring of a polygon.
pub(crate) struct Ring {
    role: Role,
    line: u32,
    /// Its polygon, over all files.
    polygon: u32,
}

/// The rings of the polygons of areas.
///
/// # Errors
/// Malformed, if a file of an area has a line that is no ring.
pub(crate) fn rings(files: &[(Role, String, Breaklines)]) -> Result<Vec<Ring>> {
    let (mut rings, mut line, mut polygons) = (Vec::new(), 0, 0);
    for (role, name, file) in files {
        for breakline in &file.lines {
            if matches!(role, Role::Hull | Role::Holes) {
                let Some(polygon) = breakline.polygon else {
                    let error = Error::malformed("found a line, expected polygons");
                    return Err(error.at(&breakline.position).of_input(name));
                };
                rings.push(Ring { role: *role, line, polygon: polygons + polygon });
            }
            line += 1;
        }
        polygons += 1 + file.lines.iter().filter_map(|line| line.polygon).max().unwrap_or(0);
    }
    Ok(rings)
}

/// The areas after noding; `starts` are the numbers of the first vertices of lines.
///
/// # Errors
/// Malformed, if a ring is no chain of segments, which noding excludes.
pub(crate) fn areas(rings: &[Ring], noded: &Noded, vertices: &[LineVertex], starts: &[u32]) -> Result<Areas> {
    let mut areas = Areas::default();
    if rings.is_empty() {
        return Ok(areas);
    }
    let chains = Chains::new(noded);
    for same in rings.chunk_by(|a, b| a.polygon == b.polygon) {
        let mut segments = Vec::new();
        for ring in same {
            let first = starts[ring.line as usize] as usize;
            let end = starts.get(ring.line as usize + 1).map_or(vertices.len(), |&end| end as usize);
            for part in vertices[first..end].windows(2) {
                if !chains.of_part(part[0].place, part[1].place, |segment| segments.push(segment)) {
                    let ([x, y], line) = (part[0].place, ring.line);
                    let message = format!("the ring of line {line} was lost behind {x}, {y} of the grid");
                    return Err(Error::malformed(message));
                }
            }
        }
        let polygon = odd(segments);
        let area = if same[0].role == Role::Hull { &mut areas.hull } else { &mut areas.holes };
        area.get_or_insert_default().push(polygon);
    }
    Ok(areas)
}

/// The segments that a border has an odd number of times: what it has twice is no border.
pub(crate) fn odd(mut segments: Vec<u32>) -> Vec<u32> {
    segments.sort_unstable();
    segments.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect()
}
