//! Areas whose borders are segments of a network.

use std::path::PathBuf;

use super::numbered::{Bent, Numbered, numbered};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::Breaklines;

/// Files of lines and polygons.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sources<'p> {
    /// Lines; rings of polygons among them are lines.
    pub lines: &'p [PathBuf],
    /// Polygons outside of which the mesh is removed.
    pub hull: &'p [PathBuf],
    /// Polygons inside of which it is removed.
    pub holes: &'p [PathBuf],
    /// Lakes, and rivers with their centre lines or banks.
    pub water: &'p [PathBuf],
}

/// What a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Lines,
    Hull,
    Holes,
    Water,
    /// Lines that close rivers of `Water` between their banks.
    Ends,
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
    /// Numbers of the lines of `--lines` that may be shores of water, in order: rings, and lines of rivers.
    pub shores: Vec<u32>,
}

/// A ring of a polygon.
pub(crate) struct Ring {
    role: Role,
    line: u32,
    /// Its polygon, over all files.
    polygon: u32,
}

/// The rings of the polygons of areas.
pub(crate) fn rings(files: &[(Role, String, Breaklines)]) -> Result<Vec<Ring>> {
    let of_areas = numbered(files).filter(|line| matches!(line.role, Role::Hull | Role::Holes));
    let ring = |Numbered { role, file, number, polygon, line }: Numbered| {
        line.check_ring().map_err(|error| error.at(&*line.position).of_input(file))?;
        Ok(Ring { role, line: number, polygon: polygon.expect("a ring has a polygon") })
    };
    of_areas.map(ring).collect()
}

/// The lines that may be shores.
pub(crate) fn shores(files: &[(Role, String, Breaklines)]) -> Vec<u32> {
    let may_be = |it: &Numbered| {
        it.role == Role::Lines && (it.polygon.is_some() || it.line.properties.river.is_some())
    };
    numbered(files).filter(may_be).map(|line| line.number).collect()
}

/// The areas after noding.
pub(crate) fn areas(rings: &[Ring], bent: &Bent) -> Result<Areas> {
    let mut areas = Areas::default();
    for same in rings.chunk_by(|a, b| a.polygon == b.polygon) {
        let mut segments = Vec::new();
        for &Ring { line, .. } in same {
            segments.extend(bent.segments(line).map_err(|[x, y]| {
                Error::malformed(format!("the ring of line {line} was lost behind {x}, {y} of the grid"))
            })?);
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
