//! Selects atoms; if none is left, the error tells what other flags would select.

use spmesh_base::error::{Error, Result};
use spmesh_formats::molecules::{Altlocs, Atoms, Selected, Selection, Structure};

/// The atoms of a selection.
pub(super) fn select<'s>(structure: &'s Structure, selection: &Selection) -> Result<Selected<'s>> {
    let selected = structure.select(selection)?;
    if selected.points().is_empty() { Err(nothing_left(structure, selection)) } else { Ok(selected) }
}

/// The error for an empty selection, with the counts that other flags would give.
fn nothing_left(structure: &Structure, selection: &Selection) -> Error {
    let count = |selection: &Selection| structure.select(selection).map_or(0, |s| s.points().len());
    let relaxed = [
        ("--hetatm on", Selection { hetatm: true, ..selection.clone() }),
        ("--atoms all", Selection { atoms: Atoms::All, ..selection.clone() }),
        ("all classes", Selection { classes: Vec::new(), ..selection.clone() }),
        ("all chains", Selection { chains: Vec::new(), ..selection.clone() }),
        ("--altloc all", Selection { altlocs: Altlocs::All, ..selection.clone() }),
    ];
    let counts = relaxed.iter().map(|(flag, relaxed)| (flag, count(relaxed))).filter(|&(_, atoms)| atoms > 0);
    let remedies: Vec<String> =
        counts.map(|(flag, atoms)| format!("with {flag} there would be {atoms}")).collect();
    let all = Selection { models: selection.models, altlocs: Altlocs::All, ..Selection::default() };
    let mut message = "no atom is selected".to_string();
    if let Ok(all) = structure.select(&all) {
        message += &describe(&all);
    }
    for hint in structure.missing_location(selection).into_iter().chain(remedies) {
        message += &format!("; {hint}");
    }
    Error::usage(message)
}

/// Describes all atoms: " of 644: 524 ATOM and 120 HETATM records in the chains A, B".
fn describe(all: &Selected<'_>) -> String {
    const CHAINS_MAX: usize = 12;
    let mut chains: Vec<&str> = Vec::new();
    let mut hetatm = 0;
    for atom in (0..all.points().len()).filter_map(|index| all.atom(index)) {
        hetatm += usize::from(atom.atom.is_hetatm);
        let is_known = chains.len() > CHAINS_MAX || chains.contains(&atom.chain());
        if !is_known {
            chains.push(atom.chain());
        }
    }
    if chains.len() > CHAINS_MAX {
        chains[CHAINS_MAX] = "...";
    }
    let count = all.points().len();
    let plural = if chains.len() == 1 { "" } else { "s" };
    let atoms = count - hetatm;
    format!(
        " of {count}: {atoms} ATOM and {hetatm} HETATM records in the chain{plural} {}",
        chains.join(", ")
    )
}
