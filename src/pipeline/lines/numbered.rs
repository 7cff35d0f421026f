//! The lines of all files by their numbers, before and after noding.

use super::areas::Role;
use spmesh_delaunay::noding::{Chains, LineVertex, Noded};
use spmesh_formats::source::{Breakline, Breaklines};

/// A line among those of all files.
pub(crate) struct Numbered<'f> {
    pub(crate) role: Role,
    /// Name of its file.
    pub(crate) file: &'f str,
    /// Its number over all files.
    pub(crate) number: u32,
    /// Its polygon, over all files.
    pub(crate) polygon: Option<u32>,
    pub(crate) line: &'f Breakline,
}

/// The lines of files, in their order.
pub(crate) fn numbered(files: &[(Role, String, Breaklines)]) -> impl Iterator<Item = Numbered<'_>> {
    let firsts = files.iter().scan(0, |polygons, (.., lines)| {
        let first = *polygons;
        *polygons += 1 + lines.lines.iter().filter_map(|line| line.polygon).max().unwrap_or(0);
        Some(first)
    });
    let lines = files.iter().zip(firsts).flat_map(|((role, file, lines), first)| {
        lines.lines.iter().map(move |line| (*role, file, line.polygon.map(|polygon| first + polygon), line))
    });
    (0..).zip(lines).map(|(number, (role, file, polygon, line))| Numbered {
        role,
        file,
        number,
        polygon,
        line,
    })
}

/// Lines after noding.
pub(crate) struct Bent<'n> {
    pub(crate) noded: &'n Noded,
    chains: Chains<'n>,
    vertices: &'n [LineVertex],
    /// The numbers of the first vertices of lines.
    starts: &'n [u32],
}

impl<'n> Bent<'n> {
    pub(crate) fn new(noded: &'n Noded, vertices: &'n [LineVertex], starts: &'n [u32]) -> Bent<'n> {
        Bent { noded, chains: Chains::new(noded), vertices, starts }
    }

    /// The vertices of a line before noding.
    pub(crate) fn vertices(&self, line: u32) -> &'n [LineVertex] {
        let line = line as usize;
        let end = self.starts.get(line + 1).map_or(self.vertices.len(), |&end| end as usize);
        &self.vertices[self.starts[line] as usize..end]
    }

    /// The segments to which a line was bent, in its order.
    pub(crate) fn segments(&self, line: u32) -> Result<Vec<u32>, [i64; 2]> {
        let mut segments = Vec::new();
        for part in self.vertices(line).windows(2) {
            if !self.chains.of_part(part[0].place, part[1].place, |segment| segments.push(segment)) {
                return Err(part[0].place);
            }
        }
        Ok(segments)
    }
}
