//! Flags that choose atoms.

use std::fmt;

use clap::{Args, ValueEnum};

use spmesh_formats::molecules::{Altlocs, Atoms, Class, Models, Selection};

/// Which atoms are triangulated.
#[derive(Debug, Clone, Args)]
pub(super) struct SelectionFlags {
    /// The model of this number, or all models one by one [default: the first model]
    #[arg(long, value_name = "N|all", allow_hyphen_values = true, value_parser = parse_models)]
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
    #[arg(long, value_enum, value_name = "CLASS,...", value_delimiter = ',', hide_possible_values = true)]
    classes: Vec<ClassFlag>,

    /// Whether HETATM records are wanted: ligands, ions, water, and modified residues of polymers (to keep
    /// these, use --classes polymer)
    #[arg(long, value_enum, default_value_t = Switch::On, value_name = "on|off", hide_possible_values = true)]
    hetatm: Switch,

    /// Which atoms: all, all but hydrogen (heavy), or alpha carbons (ca)
    #[arg(long, value_enum, default_value_t = AtomsFlag::All, value_name = "ca|heavy|all", hide_possible_values = true)]
    atoms: AtomsFlag,
}

/// On or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Switch {
    /// Yes
    On,
    /// No
    Off,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AtomsFlag {
    /// Alpha carbons only
    Ca,
    /// All but hydrogen and deuterium
    Heavy,
    /// All
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum ClassFlag {
    /// Amino acids and nucleotides in chains
    Polymer,
    /// Small molecules
    Ligand,
    /// Metals and halogens
    Ion,
    /// Water
    Water,
}

impl ClassFlag {
    fn class(self) -> Class {
        match self {
            ClassFlag::Polymer => Class::Polymer,
            ClassFlag::Ligand => Class::Ligand,
            ClassFlag::Ion => Class::Ion,
            ClassFlag::Water => Class::Water,
        }
    }
}

impl SelectionFlags {
    pub(super) fn selection(&self) -> Selection {
        Selection {
            models: self.model.unwrap_or_default(),
            chains: self.chain.clone(),
            altlocs: self.altloc.clone(),
            hetatm: self.hetatm == Switch::On,
            atoms: match self.atoms {
                AtomsFlag::Ca => Atoms::CAlpha,
                AtomsFlag::Heavy => Atoms::Heavy,
                AtomsFlag::All => Atoms::All,
            },
            classes: self.classes.iter().map(|flag| flag.class()).collect(),
        }
    }

    pub(super) fn assembly(&self) -> Option<&str> {
        self.assembly.as_deref()
    }

    pub(super) fn wants_all_models(&self) -> bool {
        self.model == Some(Models::All)
    }
}

/// The flags as a user would type them.
impl fmt::Display for SelectionFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.model.unwrap_or_default() {
            Models::First => {}
            Models::One(number) => write!(f, "--model {number} ")?,
            Models::All => write!(f, "--model all ")?,
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
        let hetatm = if self.hetatm == Switch::On { "on" } else { "off" };
        let atoms = match self.atoms {
            AtomsFlag::Ca => "ca",
            AtomsFlag::Heavy => "heavy",
            AtomsFlag::All => "all",
        };
        write!(f, "--altloc {altloc} --hetatm {hetatm} --atoms {atoms}")?;
        let mut classes = self.classes.clone();
        classes.sort_unstable();
        classes.dedup();
        for (flag, class) in std::iter::once(" --classes ").chain(std::iter::repeat(",")).zip(classes) {
            let name = class.to_possible_value().expect("each class has a name");
            write!(f, "{flag}{}", name.get_name())?;
        }
        Ok(())
    }
}

fn parse_models(text: &str) -> Result<Models, String> {
    if text == "all" {
        return Ok(Models::All);
    }
    text.parse().map(Models::One).map_err(|_| format!("{text:?} is neither the number of a model nor all"))
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
