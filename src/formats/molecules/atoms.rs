//! Atoms of molecular structures as points: PDB, mmCIF, XYZ.

use std::sync::Arc;

use crate::molecules::{Radii, RadiusCounts, Selected, Selection, read_structure_from};
use crate::source::pass::{BATCH_POINTS, Content, Opening, Pass, Sort, Stated};
use crate::source::placement::Placement;
use crate::source::row_plan::{RowPlan, offers_of};
use spmesh_base::error::{Error, Result, counted};
use spmesh_stream::Crs;
use spmesh_stream::model::attributes::{Attribute, NumberType};
use spmesh_stream::model::bounds::{Bounds, Point};

/// Bytes of the radius of an atom.
const RADIUS_LEN: usize = size_of::<u32>();

/// The positions of atoms, and their radii if they are wanted.
#[derive(Debug, Clone)]
struct Atoms {
    points: Arc<[Point]>,
    /// In steps of 0.001 Å, little-endian; empty if they are not wanted.
    radii: Arc<[u8]>,
}

/// Opens the atoms that `tess3` takes by default: of the first model, and of alternate locations those of one
/// conformer. Notices say what is left out. With `radii`, atoms have an attribute.
///
/// Memory: 24 bytes per atom, 4 for a radius, and 56 more while the file is read.
pub(crate) fn open(file: &Opening, notices: &mut Vec<String>) -> Result<Content> {
    let radii = file.options.radii.as_deref();
    let structure = read_structure_from(file.origin.plain()?, file.name, Some(file.format))?;
    notices.extend(structure.warnings.iter().cloned());
    let selected = structure.select(&Selection::default())?;
    let points: Arc<[Point]> = selected.points().into();
    let found = radii.map_or(Ok(Vec::new()), |radii| radii_of(&selected, radii, notices))?;
    let models = structure.models.len();
    if models > 1 {
        notices.push(format!("only the atoms of the first of {models} models are points"));
    }
    let others = structure.models[0].points.len() - points.len();
    if others > 0 {
        let others = counted(
            others as u64,
            "atom at another alternate location is",
            "atoms at other alternate locations are",
        );
        notices.push(format!("{others} left out"));
    }
    let stated = Stated {
        coordinates: structure.coordinates,
        has_z: Some(true),
        crs: Crs::Unknown.into(),
        bounds: Bounds::of_points(&points),
        points: Some(points.len() as u64),
        offers: offers_of(radii.map(|_| radius()).as_slice()).into(),
    };
    let atoms = Atoms { points, radii: found.into() };
    let content =
        Content::new(stated, move |_, plan| Ok(Box::new(AtomPass { atoms: atoms.clone(), plan, next: 0 })));
    Ok(Content { sort: Sort::Atoms, ..content })
}

/// The attribute of atoms with radii.
fn radius() -> Attribute {
    Attribute { unit: "Å".into(), scale: Some([0.001, 0.0]), ..Attribute::new("radius", NumberType::U32) }
}

/// The radii as bytes.
fn radii_of(selected: &Selected<'_>, radii: &Radii, notices: &mut Vec<String>) -> Result<Vec<u8>> {
    let Some(mut atoms) = radii.of_atoms(selected) else {
        return Err(Error::usage("points have no elements, and so no radii"));
    };
    let mut bytes = Vec::with_capacity(RADIUS_LEN * selected.points().len());
    let mut counts = RadiusCounts::default();
    atoms.try_for_each(|found| {
        let (_, steps, origin) = found?;
        counts.add(origin);
        bytes.extend(steps.to_le_bytes());
        Ok(())
    })?;
    notices.extend(counts.notices());
    Ok(bytes)
}

/// One pass over atoms.
struct AtomPass {
    atoms: Atoms,
    plan: RowPlan,
    next: usize,
}

impl Pass for AtomPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        let left = &self.atoms.points[self.next..];
        let points = &left[..left.len().min(BATCH_POINTS)];
        for (index, &point) in (self.next..).zip(points) {
            if placement.put(point, batch)? && !self.plan.is_empty() {
                self.plan.append(&self.atoms.radii[index * RADIUS_LEN..][..RADIUS_LEN], rows);
            }
        }
        self.next += points.len();
        Ok(!points.is_empty())
    }
}
