//! The atoms that the user wants, or what there would be to choose from.

use crate::error::{Error, Result};
use crate::source::structure::{Altlocs, Atoms, Models, Selected, Selection, Structure};

/// Index of the model to be triangulated: the first one, unless another is wanted.
///
/// # Errors
/// Usage, if there is no such model.
pub(super) fn model_index(structure: &Structure, wanted: Models) -> Result<usize> {
    let numbers = || structure.models.iter().map(|model| model.number);
    match wanted {
        Models::One(number) => numbers().position(|other| other == number).ok_or_else(|| {
            Error::usage(format!("there is no model {number}: {}", range("model", numbers().collect())))
        }),
        _ if structure.models.is_empty() => Err(Error::usage("there is no model")),
        _ => Ok(0),
    }
}

/// The atoms of a selection.
///
/// # Errors
/// Usage, if there is none; the message says what there would be.
pub(super) fn select<'s>(structure: &'s Structure, selection: &Selection) -> Result<Selected<'s>> {
    let selected = structure.select(selection)?;
    if selected.points().is_empty() { Err(nothing_left(structure, selection)) } else { Ok(selected) }
}

/// What part of the selection excludes everything: whatever gives atoms if it is left out alone, or else all.
fn nothing_left(structure: &Structure, selection: &Selection) -> Error {
    let all = Selection { models: selection.models, altlocs: Altlocs::All, ..Selection::default() };
    let count = |selection: &Selection| structure.select(selection).map_or(0, |s| s.points().len());
    let with_hetatm = Selection { hetatm: true, ..selection.clone() };
    let with_all_atoms = Selection { atoms: Atoms::All, ..selection.clone() };
    let with_all_chains = Selection { chains: Vec::new(), ..selection.clone() };
    let mut remedies = Vec::new();
    for (flag, relaxed) in [
        ("--hetatm on", &with_hetatm),
        ("--atoms all", &with_all_atoms),
        ("all chains", &with_all_chains),
    ] {
        if relaxed != selection && count(relaxed) > 0 {
            remedies.push(format!("with {flag} there would be {}", count(relaxed)));
        }
    }
    let records = structure.select(&all).map_or(String::new(), |all| describe(&all));
    let remedies = if remedies.is_empty() { String::new() } else { format!("; {}", remedies.join(", ")) };
    Error::usage(format!("no atom is selected{records}{remedies}"))
}

/// What there is: " of 644 (120 HETATM, 70 alpha carbons) in chains A, B".
fn describe(all: &Selected<'_>) -> String {
    let atoms = (0..all.points().len()).filter_map(|index| all.atom(index));
    let mut chains: Vec<&str> = Vec::new();
    let mut hetatm = 0;
    for atom in atoms {
        hetatm += usize::from(atom.atom.is_hetatm);
        if !chains.contains(&atom.chain()) {
            chains.push(atom.chain());
        }
    }
    let chains = range("chain", chains.iter().map(|chain| format!("{chain:?}")).collect());
    format!(" of {} ({hetatm} HETATM records; {chains})", all.points().len())
}

/// A list that names what there is, up to a dozen of them.
fn range<T: std::fmt::Display>(what: &str, all: Vec<T>) -> String {
    const NAMED_MAX: usize = 12;
    let named: Vec<String> = all.iter().take(NAMED_MAX).map(ToString::to_string).collect();
    let more = if all.len() > NAMED_MAX { format!(" and {} more", all.len() - NAMED_MAX) } else { String::new() };
    let plural = if all.len() == 1 { "" } else { "s" };
    format!("{what}{plural} {}{more}", named.join(", "))
}
