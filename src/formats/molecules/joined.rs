//! All models as one: files of assemblies have copies of chains as models.

use std::collections::HashMap;

use foldhash::fast::FixedState;

use crate::molecules::assembly::{Counts, greatest_serial};
use crate::molecules::model::{Model, Structure};
use crate::molecules::names::Name;
use spmesh_base::error::Result;

impl Structure {
    /// The structure whose only model has the atoms of all models, with the number of the first.
    ///
    /// Names of chains, and serial numbers, are those of copies in an assembly: chain A of the second model
    /// is A-2, and its serial numbers follow the greatest one of the first model.
    ///
    /// # Errors
    /// Malformed, if serial numbers exceed 64 bits.
    pub fn joined(mut self) -> Result<Structure> {
        let mut counts = Counts::new(&self.residues);
        let mut all = self.models[0].without_atoms();
        let mut serials = 0u64;
        for mut model in std::mem::take(&mut self.models) {
            self.name_chains_of(&model, &mut counts);
            let greatest = greatest_serial(&model);
            for atom in &mut model.atoms {
                atom.serial = atom.serial.checked_add(serials).ok_or_else(|| self.serials_overflow())?;
            }
            serials = serials.checked_add(greatest).ok_or_else(|| self.serials_overflow())?;
            all.points.append(&mut model.points);
            all.atoms.append(&mut model.atoms);
            all.labels.append(&mut model.labels);
        }
        self.models = vec![all];
        Ok(self)
    }

    /// Names the chains of a model as copies. No other model has its residues.
    fn name_chains_of(&mut self, model: &Model, counts: &mut Counts) {
        let mut names: HashMap<Name, Name, FixedState> = HashMap::default();
        let mut last = None;
        for residue in model.atoms.iter().map(|atom| atom.residue) {
            if last.replace(residue) == Some(residue) {
                continue;
            }
            let chain = self.residues[residue as usize].chain;
            let name = *names.entry(chain).or_insert_with(|| self.name_copy(chain, counts).0);
            self.residues[residue as usize].chain = name;
        }
    }
}
