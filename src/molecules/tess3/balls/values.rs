//! Values of atoms in place of their temperature factors, as attributes of ChimeraX, and pockets as spheres.

use std::io::Write;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule, PictureForm};
use crate::balls::{Balls, Cell, pocket_spheres};
use spmesh_base::error::{Error, Result};
use spmesh_formats::molecules::{WrittenAtom, write_mmcif, write_pdb, written_atoms};

/// Which value atoms have: the one that the flags ask for.
fn name(options: &BallOptions) -> &'static str {
    match (options.relative, options.areas) {
        (Some(_), _) => "relative",
        (None, true) => "area",
        (None, false) => "volume",
    }
}

/// Writes the atoms with what was measured of each, or of its residue or chain.
pub(super) fn write(
    molecule: &Molecule<'_>,
    options: &BallOptions,
    form: PictureForm,
    cells: &[Cell],
    output: &mut impl Write,
) -> Result<()> {
    let groups = Groups::new(molecule.selected, options.level);
    let values = values(molecule, options, &groups, cells);
    if form == PictureForm::Defattr {
        return attributes(molecule, options, &groups, &values, output);
    }
    let value = |atom: usize| values[groups.of(atom as u32) as usize];
    let atoms = written_atoms(molecule.selected, value);
    match form {
        PictureForm::Mmcif => write_mmcif(name(options), molecule.origin.model, atoms, output),
        _ => write_pdb(atoms, output),
    }
}

/// The value of each group.
fn values(
    molecule: &Molecule<'_>,
    options: &BallOptions,
    groups: &Groups,
    cells: &[Cell],
) -> Vec<Option<f64>> {
    let count = if options.level == Level::Atom { cells.len() } else { groups.sizes.len() };
    let mut sums = vec![0.0; count];
    for (atom, cell) in (0..).zip(cells) {
        sums[groups.of(atom) as usize] += if options.areas {
            cell.area * molecule.scale.powi(2)
        } else {
            cell.volume * molecule.scale.powi(3)
        };
    }
    let value = |(group, sum): (u32, f64)| {
        let Some(maxima) = options.relative else { return Some(sum) };
        let atom = molecule.selected.atom(groups.named(group).atom as usize)?;
        Some(sum / maxima.of(atom.residue_name())?)
    };
    (0..).zip(sums).map(value).collect()
}

/// Writes values as attributes of atoms, residues or chains, as `open FILE.defattr` of ChimeraX reads them.
fn attributes(
    molecule: &Molecule<'_>,
    options: &BallOptions,
    groups: &Groups,
    values: &[Option<f64>],
    output: &mut impl Write,
) -> Result<()> {
    let recipient = match options.level {
        Level::Atom => "atoms",
        Level::Residue => "residues",
        _ => "chains",
    };
    let writing = |e| Error::io("writing attributes", e);
    // Names of attributes that ChimeraX has of its own are none of these.
    let name = format!("tess3_{}", name(options));
    write!(output, "attribute: {name}\nmatch mode: any\nrecipient: {recipient}\n").map_err(writing)?;
    for (group, value) in (0u32..).zip(values) {
        let atom = molecule.selected.atom(groups.named(group).atom as usize);
        let (Some(atom), Some(value)) = (atom, value) else { continue };
        let number = atom.residue_number().map_or(String::new(), |number| number.to_string());
        let residue = format!("{number}{}", atom.insertion_code());
        let place = match options.level {
            Level::Atom => format!("/{}:{residue}@{}", atom.chain(), atom.name()),
            Level::Residue => format!("/{}:{residue}", atom.chain()),
            _ => format!("/{}", atom.chain()),
        };
        writeln!(output, "\t{place}\t{value:.4}").map_err(writing)?;
    }
    Ok(())
}

/// Writes pockets as the spheres in their tetrahedra that touch atoms: each pocket is a residue, and radii
/// take the place of temperature factors.
pub(super) fn write_spheres(
    molecule: &Molecule<'_>,
    options: &BallOptions,
    balls: Balls<'_>,
    output: &mut impl Write,
) -> Result<()> {
    let coordinates = molecule.selected.structure().coordinates;
    let probe = molecule.length(options.probe);
    let mut serial = 0;
    let mut spheres = Vec::new();
    for (number, (is_void, of_pocket)) in (1i32..).zip(pocket_spheres(balls)?) {
        for (at, radius) in of_pocket {
            serial += 1;
            spheres.push(WrittenAtom {
                is_hetatm: true,
                serial,
                name: "SPH",
                element: "",
                altloc: "",
                residue: if is_void { "VOI" } else { "PCK" },
                chain: "P",
                subchain: "P",
                number: Some(number),
                insertion_code: "",
                at: coordinates.to_world(at),
                occupancy: 1.0,
                value: Some((radius + probe) * molecule.scale),
            });
        }
    }
    write_pdb(spheres.into_iter(), output)
}
