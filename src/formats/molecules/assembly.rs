//! Makes the atoms of a biological assembly: copies of chains, each moved by an operator.

use std::collections::{HashMap, HashSet};

use foldhash::fast::FixedState;

use crate::molecules::model::{Atom, Model, Residue, Structure};
use crate::molecules::motion::Motion;
use crate::molecules::names::Name;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{ASSEMBLY_CHAINS_MAX, assembly_atoms_max};
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

type Map<K, V> = HashMap<K, V, FixedState>;
type Set<K> = HashSet<K, FixedState>;

/// What one operator moves.
struct Copies {
    motion: Motion,
    subchains: Set<Name>,
}

/// Name of a copy of a chain, and its number, counted from 1.
type Chains = Map<Name, (Name, u64)>;

/// Number of copies of each chain so far, with the number behind the name of the last; and the names of the
/// chains of the file.
pub(crate) struct Counts {
    copies: Map<Name, [u64; 2]>,
    taken: Set<Name>,
}

impl Counts {
    pub(crate) fn new(residues: &[Residue]) -> Counts {
        Counts { copies: Map::default(), taken: residues.iter().map(|residue| residue.chain).collect() }
    }
}

/// What numbers of a copy are greater by than those of the copy before: serial numbers, and those of chains.
#[derive(Clone, Copy)]
struct Steps {
    serial: u64,
    chain: u32,
}

impl Structure {
    /// The atoms of the assembly of this name, operator by operator and in the order of the file.
    ///
    /// The first copy of chain A is named A, the next ones and so on, but for names of other chains
    /// of the file. The serial number of an atom
    /// of copy n is greater than in the file by n - 1 times the greatest serial number of the model.
    /// Coordinates are rounded to the grid of the structure.
    ///
    /// Memory: as for a file with these atoms, beside the structure.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Usage`] if the file states no such assembly or has none of its atoms;
    /// malformed if its operators are, or if it is too large.
    pub fn assembled(mut self, assembly: &str) -> Result<Structure> {
        let all = self.copies(assembly)?;
        self.check_count(&all)?;
        let models = std::mem::take(&mut self.models);
        let by_subchain: Vec<_> = models.iter().map(|model| self.by_subchain(model)).collect();
        let chain = self.residues.iter().map(|residue| residue.chain_number).max().unwrap_or(0);
        let steps: Vec<Steps> =
            models.iter().map(|model| Steps { serial: greatest_serial(model), chain }).collect();
        let mut made: Vec<Model> = models.iter().map(Model::without_atoms).collect();
        let mut counts = Counts::new(&self.residues);
        let chains_of = self.chains_of_subchains();
        for copies in &all {
            let chains = self.name_chains(copies, &chains_of, &mut counts);
            let sources = models.iter().zip(&by_subchain).zip(&steps);
            for (((model, by_subchain), &steps), made) in sources.zip(&mut made) {
                let lists = copies.subchains.iter().filter_map(|subchain| by_subchain.get(subchain));
                let mut atoms: Vec<u32> = lists.flatten().copied().collect();
                atoms.sort_unstable();
                self.copy_atoms(model, &atoms, &copies.motion, &chains, steps, made)?;
            }
        }
        made.retain(|model| !model.atoms.is_empty());
        if made.is_empty() {
            return Err(
                Error::usage(format!("has no atom of the assembly {assembly:?}")).of_input(&self.name)
            );
        }
        self.models = made;
        Ok(self)
    }

    /// The copies of an assembly, by the operators in the order in which they appear.
    fn copies(&self, assembly: &str) -> Result<Vec<Copies>> {
        let parts = self.assemblies.parts(assembly).map_err(|e| e.of_input(&self.name))?;
        if parts.is_empty() {
            return Err(self.lacks_assembly(assembly));
        }
        let (mut all, mut places): (Vec<Copies>, Map<[u64; 12], usize>) = (Vec::new(), Map::default());
        let mut chains = 0usize;
        for (subchains, motions) in parts {
            chains = chains.saturating_add(subchains.len().saturating_mul(motions.len()));
            if chains > ASSEMBLY_CHAINS_MAX {
                return Err(self.too_large(&format!("{ASSEMBLY_CHAINS_MAX} copies of chains")));
            }
            for motion in motions {
                let place = *places.entry(motion.key()).or_insert(all.len());
                if place == all.len() {
                    all.push(Copies { motion, subchains: Set::default() });
                }
                all[place].subchains.extend(subchains);
            }
        }
        Ok(all)
    }

    fn lacks_assembly(&self, assembly: &str) -> Error {
        let names = self.assemblies.names();
        if names.is_empty() {
            let reason = "states no assembly: PDB files do in REMARK 350, mmCIF in _pdbx_struct_assembly_gen";
            return Error::usage(reason).of_input(&self.name);
        }
        self.lacks("assembly", assembly, names.into_iter().map(str::to_string))
    }

    fn too_large(&self, limit: &str) -> Error {
        Error::malformed(format!("the assembly has more than {limit}, the maximum")).of_input(&self.name)
    }

    fn check_count(&self, all: &[Copies]) -> Result<()> {
        let mut counts: Map<Name, usize> = Map::default();
        for atom in self.models.iter().flat_map(|model| &model.atoms) {
            *counts.entry(self.residues[atom.residue as usize].subchain).or_default() += 1;
        }
        let of_subchain = |subchain| counts.get(subchain).copied().unwrap_or(0);
        let atoms: usize = all.iter().flat_map(|copies| &copies.subchains).map(of_subchain).sum();
        let of_file = self.models.iter().map(|model| model.atoms.len()).sum();
        let most = assembly_atoms_max(of_file);
        if atoms <= most {
            return Ok(());
        }
        let what = format!(
            "the assembly has {atoms} atoms, those of a file with {of_file} have {most} at most: give a file with \
             all atoms, or leave out --assembly"
        );
        Err(Error::malformed(what).of_input(&self.name))
    }

    /// Indices of the atoms of each subchain in a model.
    fn by_subchain(&self, model: &Model) -> Map<Name, Vec<u32>> {
        let mut all: Map<Name, Vec<u32>> = Map::default();
        for (index, atom) in (0..).zip(&model.atoms) {
            all.entry(self.residues[atom.residue as usize].subchain).or_default().push(index);
        }
        all
    }

    /// The chains of each subchain: one, in most files.
    fn chains_of_subchains(&self) -> Map<Name, Set<Name>> {
        let mut all: Map<Name, Set<Name>> = Map::default();
        for residue in &self.residues {
            all.entry(residue.subchain).or_default().insert(residue.chain);
        }
        all
    }

    /// Counts and names the copies that an operator makes of chains. `counts` has those of the operators
    /// before.
    fn name_chains(
        &mut self,
        copies: &Copies,
        chains_of: &Map<Name, Set<Name>>,
        counts: &mut Counts,
    ) -> Chains {
        let mut chains = Chains::default();
        for &chain in copies.subchains.iter().filter_map(|subchain| chains_of.get(subchain)).flatten() {
            chains.entry(chain).or_insert_with(|| self.name_copy(chain, counts));
        }
        chains
    }

    /// The name of the next copy of a chain, and its number: of chain A these are A, A-2, A-3 and so on, but
    /// for names of chains of the file.
    pub(crate) fn name_copy(&mut self, chain: Name, counts: &mut Counts) -> (Name, u64) {
        let [count, last] = counts.copies.entry(chain).or_default();
        *count += 1;
        if *count == 1 {
            return (chain, 1);
        }
        loop {
            *last = 2.max(*last + 1);
            let text = format!("{}-{last}", self.names.text(chain));
            let name = self.names.intern(&text);
            if !counts.taken.contains(&name) {
                return (name, *count);
            }
        }
    }

    /// Adds copies of these atoms of `model` to `made`.
    fn copy_atoms(
        &mut self,
        model: &Model,
        atoms: &[u32],
        motion: &Motion,
        chains: &Chains,
        steps: Steps,
        made: &mut Model,
    ) -> Result<()> {
        let mut residues: Map<u32, u32> = Map::default();
        for &index in atoms {
            let atom = model.atoms[index as usize];
            let residue = self.residues[atom.residue as usize];
            let (chain, number) = chains[&residue.chain];
            let residue = match residues.get(&atom.residue) {
                _ if number == 1 => atom.residue,
                Some(&index) => index,
                None => {
                    let step =
                        u32::try_from(number - 1).ok().and_then(|copies| copies.checked_mul(steps.chain));
                    let chain_number = step.and_then(|step| residue.chain_number.checked_add(step));
                    let chain_number = chain_number.ok_or_else(|| self.too_large("2^32 chains"))?;
                    let index = self.add_residue(Residue { chain, chain_number, ..residue })?;
                    residues.insert(atom.residue, index);
                    index
                }
            };
            let serial =
                steps.serial.checked_mul(number - 1).and_then(|before| atom.serial.checked_add(before));
            let serial = serial.ok_or_else(|| self.serials_overflow())?;
            made.points.push(self.moved(model.points[index as usize], motion)?);
            made.atoms.push(Atom { serial, residue, ..atom });
        }
        Ok(())
    }

    pub(crate) fn serials_overflow(&self) -> Error {
        Error::malformed("serial numbers are too large to number copies").of_input(&self.name)
    }

    fn add_residue(&mut self, residue: Residue) -> Result<u32> {
        self.residues.push(residue);
        u32::try_from(self.residues.len() - 1).map_err(|_| self.too_large("2^32 residues"))
    }

    /// A moved position, on the grid of the structure.
    fn moved(&self, point: Point3, motion: &Motion) -> Result<Point3> {
        let (moved, max) = match self.coordinates {
            Coordinates::F64 => (motion.apply(point, 1.0), f64::MAX),
            Coordinates::I32 { scale, .. } => {
                // The sum turns -0 to 0.
                (motion.apply(point, scale[0]).map(|value| value.round() + 0.0), f64::from(i32::MAX))
            }
        };
        if moved.iter().all(|value| value.abs() <= max) {
            return Ok(moved);
        }
        Err(Error::malformed("an operator of the assembly moves atoms too far").of_input(&self.name))
    }
}

pub(crate) fn greatest_serial(model: &Model) -> u64 {
    model.atoms.iter().map(|atom| atom.serial).max().unwrap_or(0)
}
