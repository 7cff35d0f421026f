//! Writes a tetrahedralization as a stream, patch by patch along the curve.

use std::io::Write;

use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::{CornerParts, Corners, Vertex};
use spmesh_stream::{Patch, StreamWriter};

/// Tetrahedra per patch. With four vertices of its own each, a tetrahedron takes at most 4 * (4 + 24 + 4)
/// bytes, so a patch stays below the maximum of a block.
const PATCH_TETRAHEDRA: usize = 8000;

/// Vertices without tetrahedra per patch, by the same reckoning.
const PATCH_VERTICES: usize = 32_000;

/// Id of a vertex that is in no patch so far.
const NONE: u32 = u32::MAX;

/// Flag of an entry of `ids` that holds the place of a vertex in `imported`, while the current patch imports
/// it. Ids are less, because the kernel counts eight words per tetrahedron in 32 bits.
const IMPORTED: u32 = 1 << 31;

/// Writes tetrahedra with their vertices and labels, then the vertices that are in no tetrahedron. A vertex
/// is new in its first patch, and finalized in its last. `label` maps the index of a vertex among the points
/// of the input to its label. With `weights` of these points, vertices in no tetrahedron are hidden, and come
/// first.
///
/// Memory: 8 bytes per vertex, in space that the mesh no longer needs, and one patch.
///
/// # Errors
/// If writing fails, or a coordinate does not fit the encoding of the stream.
pub fn write_mesh<W: Write>(
    writer: &mut StreamWriter<W>,
    mesh: &mut Corners,
    label: impl Fn(u32) -> u64,
    weights: Option<&[f64]>,
) -> Result<()> {
    let CornerParts { vertices, tetrahedra, spare } = mesh.parts();
    let mut own = Vec::new();
    let words = match spare.get_mut(..2 * vertices.len()) {
        Some(words) => words,
        None => {
            own.resize(2 * vertices.len(), 0);
            &mut own[..]
        }
    };
    let mut builder = PatchBuilder::new(vertices, label, words, weights);
    if weights.is_some() {
        builder.last_patches.fill(NONE);
        tetrahedra.as_flattened().iter().for_each(|&v| builder.last_patches[v as usize] = 0);
        let vertices = (0..).zip(&*builder.last_patches);
        let hidden: Vec<u32> = vertices.filter(|(_, last)| **last == NONE).map(|(v, _)| v).collect();
        builder.singles(hidden.into_iter(), writer)?;
    }
    for (number, corners) in (builder.number..).zip(tetrahedra.chunks(PATCH_TETRAHEDRA)) {
        corners.as_flattened().iter().for_each(|&v| builder.last_patches[v as usize] = number);
    }
    for corners in tetrahedra.chunks(PATCH_TETRAHEDRA) {
        corners.as_flattened().iter().for_each(|&v| builder.corner(v));
        builder.close(writer)?;
    }
    builder.singles(0..vertices.len() as u32, writer)
}

/// Builds one patch after the other.
struct PatchBuilder<'m, Label> {
    vertices: &'m [Vertex],
    label: Label,
    /// The weight of each point of the input, if they have weights.
    weights: Option<&'m [f64]>,
    /// The weights of the new vertices, as rows.
    rows: Vec<u8>,
    /// Number of the last patch that uses a vertex; undefined before the first.
    last_patches: &'m mut [u32],
    /// Number of the current patch.
    number: u32,
    /// Id of each vertex, [`NONE`], or [`IMPORTED`] and its place in `imported`.
    ids: &'m mut [u32],
    /// New vertices of the patch.
    new: Vec<u32>,
    /// Ids and vertices that the patch imports, in order of appearance.
    imported: Vec<(u32, u32)>,
    /// For each of `imported`, its local index.
    locals: Vec<u32>,
    labels: Vec<u64>,
    /// The patch as it is written. A corner is the local index of a new vertex, or [`IMPORTED`] with a place.
    patch: Patch,
}

impl<'m, Label: Fn(u32) -> u64> PatchBuilder<'m, Label> {
    /// Needs two words per vertex.
    fn new(vertices: &'m [Vertex], label: Label, words: &'m mut [u32], weights: Option<&'m [f64]>) -> Self {
        assert!(vertices.len() < IMPORTED as usize, "more vertices than the kernel can number");
        let (last_patches, ids) = words.split_at_mut(vertices.len());
        ids.fill(NONE);
        PatchBuilder {
            vertices,
            label,
            weights,
            rows: Vec::new(),
            last_patches,
            number: 0,
            ids,
            new: Vec::new(),
            imported: Vec::new(),
            locals: Vec::new(),
            labels: Vec::new(),
            patch: Patch::default(),
        }
    }

    /// Adds a corner of a tetrahedron.
    #[inline]
    fn corner(&mut self, v: u32) {
        let first_id = self.patch.first_id as u32;
        let id = &mut self.ids[v as usize];
        if *id == NONE {
            *id = first_id + self.new.len() as u32;
            self.new.push(v);
        } else if *id < first_id {
            self.imported.push((*id, v));
            *id = IMPORTED | (self.imported.len() - 1) as u32;
        }
        let corner = if *id < IMPORTED { *id - first_id } else { *id };
        self.patch.simplices.push(corner);
    }

    /// Writes those vertices that are in no patch so far.
    fn singles<W: Write>(
        &mut self,
        vertices: impl Iterator<Item = u32>,
        writer: &mut StreamWriter<W>,
    ) -> Result<()> {
        for v in vertices {
            self.single(v);
            if self.new.len() == PATCH_VERTICES {
                self.close(writer)?;
            }
        }
        self.close(writer)
    }

    /// Adds a vertex, if it is in no patch so far.
    fn single(&mut self, v: u32) {
        let id = &mut self.ids[v as usize];
        if *id == NONE {
            *id = self.patch.first_id as u32 + self.new.len() as u32;
            self.new.push(v);
            self.last_patches[v as usize] = self.number;
        }
    }

    /// Writes the patch, if there is anything in it.
    fn close<W: Write>(&mut self, writer: &mut StreamWriter<W>) -> Result<()> {
        if self.new.is_empty() && self.imported.is_empty() {
            return Ok(());
        }
        self.number_imported();
        for corner in &mut self.patch.simplices {
            if *corner >= IMPORTED {
                *corner = self.locals[(*corner - IMPORTED) as usize];
            }
        }
        let vertices = self.new.iter().copied().chain(self.imported.iter().map(|&(_, v)| v));
        let is_last = |v: u32| self.last_patches[v as usize] == self.number;
        self.patch.finalized.extend((0..).zip(vertices).filter(|&(_, v)| is_last(v)).map(|(local, _)| local));
        self.patch.new.extend(self.new.iter().map(|&v| self.vertices[v as usize].at));
        self.patch.imported.extend(self.imported.iter().map(|&(id, _)| u64::from(id)));
        if let Some(weights) = self.weights {
            let of_new = self.new.iter().map(|&v| weights[self.vertices[v as usize].index as usize]);
            self.rows.extend(of_new.flat_map(f64::to_le_bytes));
        }
        writer.patch_with_rows(&self.patch, &self.rows)?;
        self.labels.extend(self.new.iter().map(|&v| (self.label)(self.vertices[v as usize].index)));
        if !self.labels.is_empty() {
            writer.labels(&self.labels)?;
        }
        self.start_next();
        Ok(())
    }

    /// Sorts the imported vertices, assigns local indices to them, and restores their ids.
    fn number_imported(&mut self) {
        self.imported.sort_unstable();
        self.locals.clear();
        self.locals.resize(self.imported.len(), 0);
        let first = self.new.len() as u32;
        for (local, &(id, v)) in (first..).zip(&self.imported) {
            let place = std::mem::replace(&mut self.ids[v as usize], id) - IMPORTED;
            self.locals[place as usize] = local;
        }
    }

    fn start_next(&mut self) {
        self.number += 1;
        self.patch.first_id += self.new.len() as u64;
        self.new.clear();
        self.imported.clear();
        self.labels.clear();
        self.rows.clear();
        self.patch.new.clear();
        self.patch.imported.clear();
        self.patch.simplices.clear();
        self.patch.finalized.clear();
    }
}
