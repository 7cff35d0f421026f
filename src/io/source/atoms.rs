//! Atoms of molecular structures as points: PDB, mmCIF, XYZ.

use std::io::Read;
use std::sync::Arc;

use super::pass::{BATCH_POINTS, Pass, Stated};
use super::placement::Placement;
use super::structure::{self, Selection, read_structure_from};
use crate::detect::Format;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::{Bounds, Point};
use spmesh_stream::Crs;

/// The positions of atoms.
pub(super) type Atoms = Arc<[Point]>;

/// Reads the atoms that `tess3` takes by default: of the first model, and of alternate locations those of one
/// conformer. Notices say what is left out.
///
/// Memory: 24 bytes per atom, and 56 more while the file is read.
pub(super) fn read(
    file: impl Read + 'static,
    name: &str,
    format: Format,
    notices: &mut Vec<String>,
) -> Result<(Atoms, Stated)> {
    let format = match format {
        Format::Pdb => structure::Format::Pdb,
        Format::Mmcif => structure::Format::Mmcif,
        Format::Xyz => structure::Format::Xyz,
        other => return Err(Error::usage(format!("{} holds no points of space", other.name()))),
    };
    let structure = read_structure_from(file, name, Some(format))?;
    notices.extend(structure.warnings.iter().cloned());
    let selected = structure.select(&Selection::default())?;
    let points: Atoms = selected.points().into();
    let models = structure.models.len();
    if models > 1 {
        notices.push(format!("only the atoms of the first of {models} models are points"));
    }
    let others = structure.models[0].points.len() - points.len();
    if others > 0 {
        notices.push(format!("{others} atoms at other alternate locations are left out"));
    }
    let stated = Stated {
        coordinates: structure.coordinates,
        has_z: Some(true),
        crs: Crs::Unknown,
        bounds: Bounds::of_points(&points),
        points: Some(points.len() as u64),
        offers: Vec::new(),
    };
    Ok((points, stated))
}

/// One pass over atoms.
pub(super) struct AtomPass {
    atoms: Atoms,
    next: usize,
}

impl AtomPass {
    pub(super) fn new(atoms: &Atoms) -> Self {
        AtomPass { atoms: Arc::clone(atoms), next: 0 }
    }
}

impl Pass for AtomPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        _rows: &mut Vec<u8>,
    ) -> Result<bool> {
        let left = &self.atoms[self.next..];
        let points = &left[..left.len().min(BATCH_POINTS)];
        for &point in points {
            placement.put(point, batch)?;
        }
        self.next += points.len();
        Ok(!points.is_empty())
    }
}
