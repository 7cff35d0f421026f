//! Selects atoms of a structure.

use std::borrow::Cow;
use std::collections::HashSet;

use crate::molecules::classes::Class;
use crate::molecules::conformers::{Preference, one_conformer};
use crate::molecules::model::{Atom, AtomView, Model, Residue, Structure};
use crate::molecules::names::Name;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point3;

/// Models to select.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Models {
    /// The first model of the file.
    #[default]
    First,
    /// The model with this number.
    One(i64),
    /// The models with numbers from one to another, which is one of them.
    Range(i64, i64),
    /// All models, as one set of atoms.
    All,
    /// All models, for a caller that makes one of them first ([`Structure::joined`]).
    Joined,
}

impl Models {
    /// Whether several models may be taken one by one.
    pub fn are_several(self) -> bool {
        matches!(self, Models::Range(..) | Models::All)
    }
}

/// Alternate locations to select. Atoms with a single location are always selected.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Altlocs {
    /// The conformer of each residue with the highest occupancy; of equal ones the first.
    #[default]
    Best,
    /// The first conformer of each residue.
    First,
    /// The locations with this name.
    Named(String),
    /// All locations.
    All,
}

/// Types of atoms to select.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Atoms {
    /// All atoms.
    #[default]
    All,
    /// All atoms except hydrogen (and deuterium).
    Heavy,
    /// Alpha carbons only.
    CAlpha,
}

/// The atoms to select.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selection {
    /// Models.
    pub models: Models,
    /// Names of chains as the authors call them; all chains if empty.
    pub chains: Vec<String>,
    /// Alternate locations.
    pub altlocs: Altlocs,
    /// Whether HETATM records are selected.
    pub hetatm: bool,
    /// Types of atoms.
    pub atoms: Atoms,
    /// Classes of residues; all if empty.
    pub classes: Vec<Class>,
}

impl Default for Selection {
    fn default() -> Self {
        Selection {
            models: Models::default(),
            chains: Vec::new(),
            altlocs: Altlocs::default(),
            hetatm: true,
            atoms: Atoms::default(),
            classes: Vec::new(),
        }
    }
}

/// Atomic number of carbon.
const CARBON: u8 = 6;

/// The selected atoms (or points without names), in the order of the file.
#[derive(Debug, Clone)]
pub struct Selected<'s> {
    structure: &'s Structure,
    points: Cow<'s, [Point3]>,
    members: Members,
}

/// Places of the selected atoms in the structure.
#[derive(Debug, Clone)]
enum Members {
    /// All atoms of one model.
    Model(usize),
    /// Model and index of each atom.
    Listed(Vec<[u32; 2]>),
}

impl Structure {
    /// Selects atoms. Selecting a whole model takes no time. Points without names are in every selection of
    /// their model, unless it asks for chains, classes or alpha carbons.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Usage`] if the structure has no such model or chain, or no names to
    /// select by. An empty selection is not an error.
    pub fn select(&self, selection: &Selection) -> Result<Selected<'_>> {
        let models = self.models_of(selection)?;
        let chains = self.chains_of(selection)?;
        let mut members = Vec::new();
        for &model in &models {
            let filter = Filter::new(self, model, selection, &chains);
            if models.len() == 1 && filter.wants_all() {
                return Ok(self.whole(model));
            }
            let wanted = (0..self.models[model].points.len()).filter(|&atom| filter.wants(atom));
            members.extend(wanted.map(|atom| [model as u32, atom as u32]));
        }
        if let [model] = models[..]
            && members.len() == self.models[model].points.len()
        {
            return Ok(self.whole(model));
        }
        let points = members.iter().map(|&[model, atom]| self.models[model as usize].points[atom as usize]);
        let points = Cow::Owned(points.collect());
        Ok(Selected { structure: self, points, members: Members::Listed(members) })
    }

    fn whole(&self, model: usize) -> Selected<'_> {
        let points = Cow::Borrowed(self.models[model].points.as_slice());
        Selected { structure: self, points, members: Members::Model(model) }
    }

    /// What a user may not expect of the file, or of a selection of its atoms, in sentences; usually nothing.
    /// `is_periodic` says whether atoms repeat in a box.
    pub fn notices(&self, selection: &Selection, is_periodic: bool) -> Vec<String> {
        let models = self.models.len();
        let is_cut = models > 1 && selection.models == Models::First;
        let others = is_cut.then(|| {
            format!(
                "only the first of {models} models is taken: see --model N, --model all and --model joined"
            )
        });
        let of_box = self.notice_of_box(is_periodic);
        let missing = self.missing_location(selection);
        self.warnings.iter().cloned().chain(missing).chain(others).chain(of_box).collect()
    }

    /// What a user may not expect of the periodic box.
    fn notice_of_box(&self, is_periodic: bool) -> Option<String> {
        let group = self.space_group.as_ref().filter(|_| is_periodic);
        let of_crystal = group.map(|group| {
            format!("the space group is {group}: only the atoms of the file repeat, not those that it makes")
        });
        // Structures with residues mostly state the cell of a crystal, and are wanted without it.
        let has_residues = self.residues.iter().any(|residue| !residue.name.is_empty());
        let is_left = !is_periodic && !has_residues && self.models.iter().any(|m| m.periodic_box.is_some());
        of_crystal.or_else(|| {
            is_left
                .then(|| "the file states a periodic box: images of atoms count with --periodic".to_string())
        })
    }

    /// Indices of the selected models, of which there is one at least.
    ///
    /// # Errors
    /// Usage, if the structure has no such model.
    pub fn models_of(&self, selection: &Selection) -> Result<Vec<usize>> {
        match selection.models {
            Models::First => Ok(vec![0]),
            Models::All | Models::Joined => Ok((0..self.models.len()).collect()),
            Models::One(number) => {
                let model = self.models.iter().position(|model| model.number == number);
                model.map(|model| vec![model]).ok_or_else(|| self.lacks_model(&number.to_string()))
            }
            Models::Range(first, last) => {
                let is_wanted = |&model: &usize| (first..=last).contains(&self.models[model].number);
                let models: Vec<usize> = (0..self.models.len()).filter(is_wanted).collect();
                if models.is_empty() {
                    Err(self.lacks_model(&format!("{first}..{last}")))
                } else {
                    Ok(models)
                }
            }
        }
    }

    fn lacks_model(&self, wanted: &str) -> Error {
        self.lacks("model", wanted, self.models.iter().map(|model| model.number.to_string()))
    }

    /// The selected chains; empty if all are.
    fn chains_of(&self, selection: &Selection) -> Result<Vec<Name>> {
        let is_nameless = self.models.iter().all(|model| model.atoms.is_empty());
        let is_by_residue = !selection.chains.is_empty() || !selection.classes.is_empty();
        if is_nameless && (is_by_residue || selection.atoms == Atoms::CAlpha) {
            let reason = "has points without names: chains, classes and atoms cannot be selected";
            return Err(Error::usage(reason).of_input(&self.name));
        }
        if !selection.classes.is_empty() && self.residues.iter().all(|residue| residue.name.is_empty()) {
            let reason = "has atoms without residues: classes cannot be selected";
            return Err(Error::usage(reason).of_input(&self.name));
        }
        let find = |chain: &String| {
            let found = self.names.find(chain);
            let found = found.filter(|&name| self.residues.iter().any(|residue| residue.chain == name));
            found.ok_or_else(|| self.lacks("chain", chain, self.chains().into_iter().map(str::to_string)))
        };
        selection.chains.iter().map(find).collect()
    }

    /// The names of all chains, in the order in which they appear.
    pub fn chains(&self) -> Vec<&str> {
        let mut seen = HashSet::new();
        let chains = self.residues.iter().map(|residue| residue.chain);
        chains.filter(|&chain| seen.insert(chain)).map(|chain| self.names.text(chain)).collect()
    }

    /// The error for a name that the file lacks.
    pub(crate) fn lacks(&self, what: &str, wanted: &str, there: impl Iterator<Item = String>) -> Error {
        const SHOWN: usize = 20;
        let mut there: Vec<String> = there.take(SHOWN + 1).collect();
        if there.len() > SHOWN {
            there[SHOWN] = "...".to_string();
        }
        Error::usage(format!("has no {what} {wanted:?}, only {}", there.join(", "))).of_input(&self.name)
    }
}

/// Selects atoms of one model.
struct Filter<'s> {
    structure: &'s Structure,
    model: &'s Model,
    hetatm: bool,
    atoms: Atoms,
    /// For each residue, whether its chain and class are selected; empty if all are.
    residues: Vec<bool>,
    /// For each atom, whether its location is selected; empty if all are.
    locations: Vec<bool>,
}

impl<'s> Filter<'s> {
    fn new(structure: &'s Structure, model: usize, selection: &Selection, chains: &[Name]) -> Self {
        let model = &structure.models[model];
        let classes = &selection.classes;
        let is_wanted = |residue: &Residue| {
            (chains.is_empty() || chains.contains(&residue.chain))
                && (classes.is_empty() || classes.contains(&residue.class))
        };
        let wants_every = chains.is_empty() && classes.is_empty();
        let residues =
            if wants_every { Vec::new() } else { structure.residues.iter().map(is_wanted).collect() };
        let locations = match &selection.altlocs {
            Altlocs::All => Vec::new(),
            _ if model.atoms.iter().all(|atom| atom.altloc.is_empty()) => Vec::new(),
            Altlocs::Named(name) => {
                let name = structure.names.find(name);
                let is_wanted = |atom: &Atom| atom.altloc.is_empty() || Some(atom.altloc) == name;
                model.atoms.iter().map(is_wanted).collect()
            }
            Altlocs::First => one_conformer(&structure.residues, &model.atoms, Preference::First),
            Altlocs::Best => one_conformer(&structure.residues, &model.atoms, Preference::MostOccupied),
        };
        Filter { structure, model, hetatm: selection.hetatm, atoms: selection.atoms, residues, locations }
    }

    /// Whether all atoms pass.
    fn wants_all(&self) -> bool {
        let every_kind = self.hetatm && self.atoms == Atoms::All;
        self.model.atoms.is_empty() || (every_kind && self.residues.is_empty() && self.locations.is_empty())
    }

    fn wants(&self, index: usize) -> bool {
        let Some(atom) = self.model.atoms.get(index) else { return true };
        let is_kind = || match self.atoms {
            Atoms::All => true,
            Atoms::Heavy => !atom.is_hydrogen(),
            Atoms::CAlpha => self.is_alpha_carbon(atom),
        };
        (self.hetatm || !atom.is_hetatm)
            && self.residues.get(atom.residue as usize).is_none_or(|&wanted| wanted)
            && self.locations.get(index).is_none_or(|&wanted| wanted)
            && is_kind()
    }

    fn is_alpha_carbon(&self, atom: &Atom) -> bool {
        atom.atomic_number == CARBON && self.structure.names.text(atom.name).eq_ignore_ascii_case("CA")
    }
}

impl<'s> Selected<'s> {
    /// Positions of the atoms, in the stored coordinates of the structure.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// The structure of the atoms.
    pub fn structure(&self) -> &'s Structure {
        self.structure
    }

    /// The label of the point at `index`: its atom's serial number or, for points without names, their label
    /// or else the number of the point in the input, counted from 1.
    pub fn label(&self, index: usize) -> u64 {
        let [model, atom] = self.place(index);
        let Model { atoms, labels, .. } = &self.structure.models[model];
        let label = labels.get(atom).copied().unwrap_or(atom as u64 + 1);
        atoms.get(atom).map_or(label, |atom| atom.serial)
    }

    /// The atom at `index`; `None` for points without names.
    pub fn atom(&self, index: usize) -> Option<AtomView<'s>> {
        let [model, atom] = self.place(index);
        let model = &self.structure.models[model];
        let point = self.points[index];
        Some(AtomView { structure: self.structure, model: model.number, atom: model.atoms.get(atom)?, point })
    }

    /// Indices of model and atom of the point at `index`.
    fn place(&self, index: usize) -> [usize; 2] {
        match &self.members {
            Members::Model(model) => [*model, index],
            Members::Listed(members) => members[index].map(|index| index as usize),
        }
    }
}
