//! Flags that choose atoms.

use std::fmt;

use clap::{ArgAction, Args};

use spmesh_formats::molecules::{Altlocs, Atoms, Class, Models, Selection};
use spmesh_shell::{Names, named, value_name};

/// Which atoms are triangulated.
#[derive(Debug, Clone, Args)]
pub(super) struct SelectionFlags {
    /// The model of this number; those of N to M, or all, one by one; or all joined, as files of assemblies
    /// have copies of chains as models: chain A of the second model is named A-2 [default: the first model]
    #[arg(long, value_name = "N|N..M|all|joined", allow_hyphen_values = true, value_parser = parse_models)]
    model: Option<Models>,

    /// The biological assembly of this name: copies of chains moved by operators. Copies of chain A are named
    /// A, A-2, A-3 and so on
    #[arg(long, value_name = "NAME")]
    assembly: Option<String>,

    /// Only these chains, as the authors call them
    #[arg(long, value_name = "CHAIN,...", value_delimiter = ',')]
    chain: Vec<String>,

    /// Which alternate locations: for each residue the conformer with the highest occupancy (best) or the
    /// first one; all; or those of this name
    #[arg(long, value_name = "best|first|all|NAME", default_value = "best", value_parser = parse_altlocs)]
    altloc: Altlocs,

    /// Only these classes of residues: polymer (amino acids and nucleotides, modified ones too), ligand, ion
    /// (single atoms), water [default: all]. mmCIF states them; in other files names, SEQRES and TER tell
    #[arg(long, value_name = "CLASS,...", value_delimiter = ',', hide_possible_values = true)]
    #[arg(value_parser = named(CLASSES))]
    classes: Vec<Class>,

    /// Whether HETATM records are wanted: ligands, ions, water, and modified residues of polymers (to keep
    /// these, use --classes polymer)
    #[arg(long, default_value = "on", value_name = "on|off", hide_possible_values = true)]
    #[arg(action = ArgAction::Set, value_parser = named(SWITCH))]
    hetatm: bool,

    /// Which atoms: all, all but hydrogen (heavy), or alpha carbons (ca)
    #[arg(long, value_name = "ca|heavy|all", hide_possible_values = true)]
    #[arg(default_value = "all", value_parser = named(ATOMS))]
    atoms: Atoms,
}

/// On or off.
pub(super) const SWITCH: Names<bool> = &[("on", true), ("off", false)];

const ATOMS: Names<Atoms> = &[("ca", Atoms::CAlpha), ("heavy", Atoms::Heavy), ("all", Atoms::All)];

const CLASSES: Names<Class> =
    &[("polymer", Class::Polymer), ("ligand", Class::Ligand), ("ion", Class::Ion), ("water", Class::Water)];

impl SelectionFlags {
    pub(super) fn selection(&self) -> Selection {
        Selection {
            models: self.model.unwrap_or_default(),
            chains: self.chain.clone(),
            altlocs: self.altloc.clone(),
            hetatm: self.hetatm,
            atoms: self.atoms,
            classes: self.classes.clone(),
        }
    }

    pub(super) fn assembly(&self) -> Option<&str> {
        self.assembly.as_deref()
    }

    pub(super) fn wants_several_models(&self) -> bool {
        self.model.is_some_and(Models::are_several)
    }
}

/// The flags as a user would type them.
impl fmt::Display for SelectionFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.model.unwrap_or_default() {
            Models::First => {}
            Models::One(number) => write!(f, "--model {number} ")?,
            Models::Range(first, last) => write!(f, "--model {first}..{last} ")?,
            Models::All => write!(f, "--model all ")?,
            Models::Joined => write!(f, "--model joined ")?,
        }
        if let Some(assembly) = &self.assembly {
            write!(f, "--assembly {assembly} ")?;
        }
        if !self.chain.is_empty() {
            write!(f, "--chain {} ", self.chain.join(","))?;
        }
        let altloc = match &self.altloc {
            Altlocs::Best => "best",
            Altlocs::First => "first",
            Altlocs::All => "all",
            Altlocs::Named(name) => name,
        };
        let (hetatm, atoms) = (value_name(SWITCH, &self.hetatm), value_name(ATOMS, &self.atoms));
        write!(f, "--altloc {altloc} --hetatm {hetatm} --atoms {atoms}")?;
        let classes = CLASSES.iter().filter(|(_, class)| self.classes.contains(class));
        for (flag, (class, _)) in std::iter::once(" --classes ").chain(std::iter::repeat(",")).zip(classes) {
            write!(f, "{flag}{class}")?;
        }
        Ok(())
    }
}

fn parse_models(text: &str) -> Result<Models, String> {
    match text {
        "all" => Ok(Models::All),
        "joined" => Ok(Models::Joined),
        _ => {
            let expected =
                || format!("{text:?} is neither the number of a model, FIRST..LAST, nor all or joined");
            let Some((first, last)) = text.split_once("..") else {
                return text.parse().map(Models::One).map_err(|_| expected());
            };
            match (first.parse(), last.parse()) {
                (Ok(first), Ok(last)) if first <= last => Ok(Models::Range(first, last)),
                _ => Err(expected()),
            }
        }
    }
}

fn parse_altlocs(text: &str) -> Result<Altlocs, String> {
    match text {
        "" => Err("expected best, first, all, or the name of a location".into()),
        "best" => Ok(Altlocs::Best),
        "first" => Ok(Altlocs::First),
        "all" => Ok(Altlocs::All),
        name => Ok(Altlocs::Named(name.to_string())),
    }
}
