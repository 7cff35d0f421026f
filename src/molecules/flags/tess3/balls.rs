//! Flags that make balls of atoms, and measure them.

use std::fmt::Write;
use std::num::NonZeroUsize;

use clap::Args;

use crate::tess3::{BallOptions, Between, ContactFilter, Level, Maxima, NamedRadii, Product};
use spmesh_base::error::{Error, Result};
use spmesh_shell::named;

/// Steps of a probe in 1 Å.
const STEPS: f64 = 1000.0;

/// Greatest radius of a probe, in Å.
const PROBE_MAX: f64 = 100.0;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Atoms as balls")]
pub(super) struct BallFlags {
    /// Write a table of areas: the part of each sphere that no other ball covers (Å²). By default this is the
    /// solvent-accessible surface, with --probe 0 that of van der Waals
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration"])]
    sasa: bool,

    /// Write a table of volumes: the part of each ball that is nearest to its atom by power distance (Å³);
    /// together they are the volume of the union. With --sasa, one table has both
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration"])]
    volumes: bool,

    /// Write a table of the molecular (solvent-excluded) surface, on which the probe rolls: its area (Å²),
    /// and the volume inside it, into which the probe cannot reach (Å³)
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration", "sasa", "volumes"])]
    ses: bool,

    /// Write a table of contacts: the area of the flat face between two cells, inside both balls (Å²); not
    /// the buried area
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration", "sasa", "volumes", "ses"])]
    contact_areas: bool,

    /// Write a table of buried areas: for each pair of chains the area of --sasa that each loses to the other
    /// (Å²), computed for the two alone. --between tells other pairs; with --per residue or atom, rows are
    /// what loses area
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration", "sasa", "volumes", "ses"])]
    #[arg(conflicts_with = "contact_areas")]
    buried_areas: bool,

    /// Write a table of pockets and voids, the largest first: spaces outside all balls whose exits narrow; a
    /// void has no exit (Edelsbrunner et al. 1998, as CASTp). With --per, a table of what is around each
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration", "sasa", "volumes"])]
    #[arg(conflicts_with_all = ["ses", "contact_areas", "buried_areas"])]
    pockets: bool,

    /// Rows of --pockets are the mouths, the largest of each pocket first; with --per, the atoms, residues or
    /// chains at each mouth
    #[arg(long)]
    mouths: bool,

    /// Radii of atoms, also for a mesh or a filtration with weights: protor (united atoms, Tsai et al. 1999),
    /// own (those of a PQR file, else protor), bondi (by element), united (Chothia 1976), charmm (CHARMM36m,
    /// hydrogens too), or a file with lines RESIDUE ATOM RADIUS, ELEMENT RADIUS, table NAME or else RADIUS
    /// [default: own]
    #[arg(long, value_name = "NAME|FILE")]
    radii: Option<String>,

    /// Radius of a probe that is added to each radius (Å), to three decimals; 0 for the van der Waals surface
    /// [default: 1.4; of a mesh or --filtration 0]
    #[arg(long, value_name = "RADIUS", value_parser = parse_probe)]
    probe: Option<u32>,

    /// Level of the rows; areas and volumes are summed [default: atom; of --pockets molecule]
    #[arg(long, value_enum, value_name = "LEVEL")]
    per: Option<Level>,

    /// Add columns to --sasa --per residue, chain or molecule: areas of polar and of apolar (carbon) atoms,
    /// and of the main and side chains of polymers
    #[arg(long)]
    by_kind: bool,

    /// Add columns to --sasa and --volumes of atoms: the derivatives of the area (Å) and the volume (Å²) of
    /// the whole by the coordinates of each atom
    #[arg(long)]
    gradients: bool,

    /// Add a column to --sasa --per residue: the area over that of the amino acid in Gly-X-Gly, by Tien et
    /// al. 2013 (theoretical) or Miller et al. 1987
    #[arg(long, value_name = "tien|miller", hide_possible_values = true)]
    #[arg(value_parser = named(&[("tien", Maxima::Tien), ("miller", Maxima::Miller)]))]
    relative: Option<Maxima>,

    /// Only contacts, or buried areas, of at least this area (Å²); with --per, the sum
    #[arg(long, value_name = "AREA", value_parser = parse_positive)]
    min_area: Option<f64>,

    /// Only contacts of atoms whose centres are at most this far apart (Å)
    #[arg(long, value_name = "DISTANCE", value_parser = parse_positive)]
    within: Option<f64>,

    /// Only contacts, or buried areas, between different residues, chains or classes (see --classes); or
    /// between residues of a list, such as A:10-25,B/ATP (chain, numbers, name), and all others
    #[arg(long, value_parser = parse_between, value_name = "residues|chains|classes|LIST")]
    between: Option<Between>,
}

impl BallFlags {
    /// The table that is asked for, if it is one of balls.
    pub(super) fn product(&self) -> Option<Product> {
        if self.contact_areas {
            Some(Product::ContactAreas)
        } else if self.buried_areas {
            Some(Product::BuriedAreas)
        } else if self.pockets {
            Some(Product::Pockets)
        } else if self.ses {
            Some(Product::Surface)
        } else {
            (self.sasa || self.volumes).then_some(Product::Cells)
        }
    }

    /// The options.
    pub(super) fn options(&self, product: Product, threads: NonZeroUsize) -> Result<Option<BallOptions>> {
        let is_of_cells = matches!(product, Product::SiteCells(_) | Product::SiteFaces);
        let takes_weights = is_of_cells || matches!(product, Product::Filtration | Product::Mesh);
        let has_weights = takes_weights && self.radii.is_some();
        self.check_contacts_only()?;
        if self.mouths && !self.pockets {
            return Err(Error::usage("--mouths goes with --pockets"));
        }
        if self.per.is_some() && !is_of_cells && (product == Product::Filtration || has_weights) {
            let what = if product == Product::Filtration { "--filtration" } else { "a mesh" };
            return Err(Error::usage(format!("--per does not go with {what}")));
        }
        if self.product().is_none() && !has_weights {
            return self.check_idle(product).map(|()| None);
        }
        let level = self.level();
        self.check_kinds(level)?;
        if self.contact_areas && level == Level::Molecule {
            return Err(Error::usage(
                "--contact-areas needs --per atom, residue or chain: a molecule has no pairs",
            ));
        }
        if self.buried_areas && (level == Level::Molecule || self.between == Some(Between::Residues)) {
            return Err(Error::usage(
                "--buried-areas needs --per atom, residue or chain, and --between chains, classes or a list",
            ));
        }
        let NamedRadii { radii, text } = NamedRadii::load(self.radii.as_deref().unwrap_or("own"))?;
        let probe = self.probe.unwrap_or(if has_weights { 0 } else { 1_400 });
        let mut options = BallOptions {
            radii,
            probe,
            level,
            areas: self.sasa || self.ses,
            volumes: self.volumes || self.ses,
            by_kind: self.by_kind,
            gradients: self.gradients,
            relative: self.relative,
            contacts: ContactFilter {
                min_area: self.min_area.unwrap_or(0.0),
                within: self.within,
                between: self.between.clone(),
            },
            threads,
            mouths: self.mouths,
            picture: None,
            has_united_radii: matches!(&text[..], "own" | "protor" | "united"),
            text: String::new(),
        };
        options.text = self.text(&options, &text);
        Ok(Some(options))
    }

    /// The level that is asked for.
    pub(super) fn stated_level(&self) -> Option<Level> {
        self.per
    }

    /// Whether derivatives are asked for.
    pub(super) fn has_gradients(&self) -> bool {
        self.gradients
    }

    /// Refuses flags of tables for a mesh.
    pub(super) fn check_for_mesh(&self) -> Result<()> {
        match (self.per, self.volumes) {
            _ if self.mouths => Err(Error::usage("--mouths is a table: give a name that ends in .tsv")),
            (Some(_), _) => {
                Err(Error::usage("--per is for tables; a mesh states the serial numbers of atoms"))
            }
            _ if self.gradients => Err(Error::usage("--gradients is a table: give a name that ends in .tsv")),
            (_, true) => {
                Err(Error::usage("--volumes is a table: give a name that ends in .tsv, or --sasa alone"))
            }
            _ => Ok(()),
        }
    }

    /// Refuses flags of tables where atoms have one value each.
    pub(super) fn check_for_atoms(&self) -> Result<()> {
        let message = if self.mouths || self.pockets && self.per.is_some() {
            "spheres are of pockets: leave out --mouths and --per"
        } else if self.sasa && self.volumes {
            "an atom has one value: leave out --sasa or --volumes"
        } else if self.by_kind || self.gradients {
            "--by-kind and --gradients are for tables: give a name that ends in .tsv"
        } else if self.per == Some(Level::Molecule) {
            "--per molecule leaves atoms no value of their own: give a name that ends in .tsv"
        } else {
            return Ok(());
        };
        Err(Error::usage(message))
    }

    /// Refuses flags of balls where there are none.
    fn check_idle(&self, product: Product) -> Result<()> {
        let is_of_cells = matches!(product, Product::SiteCells(_) | Product::SiteFaces);
        let message = if self.radii.is_some() {
            "--radii goes with meshes, --sasa, --volumes, --ses, --contact-areas, --buried-areas, --pockets, \
             --cells or --filtration"
        } else if self.probe.is_some() {
            match product {
                Product::Filtration | Product::SiteCells(_) | Product::SiteFaces => "--probe needs --radii",
                Product::Mesh => {
                    "--probe needs --radii, or one of --sasa, --volumes, --ses, --contact-areas, --buried-areas \
                     and --pockets"
                }
                _ => {
                    "--probe goes with meshes, --sasa, --volumes, --ses, --contact-areas, --buried-areas, \
                     --pockets or --filtration"
                }
            }
        } else if self.per.is_some() && !is_of_cells {
            "--per goes with --sasa, --volumes, --ses, --contact-areas, --buried-areas, --pockets or --cells"
        } else {
            return Ok(());
        };
        Err(Error::usage(message))
    }

    /// Refuses columns of areas where there are none.
    fn check_kinds(&self, level: Level) -> Result<()> {
        if self.by_kind && !(self.sasa && level != Level::Atom) {
            return Err(Error::usage("--by-kind goes with --sasa --per residue, chain or molecule"));
        }
        if self.gradients && !((self.sasa || self.volumes) && level == Level::Atom) {
            return Err(Error::usage("--gradients goes with --sasa and --volumes of atoms"));
        }
        if self.relative.is_some() && !(self.sasa && level == Level::Residue) {
            return Err(Error::usage("--relative goes with --sasa --per residue"));
        }
        Ok(())
    }

    /// Refuses flags that choose contacts where there are none. (To the parser, a flag that conflicts with
    /// another is not required.)
    fn check_contacts_only(&self) -> Result<()> {
        let flags = [
            ("--min-area", self.min_area.is_some()),
            ("--within", self.within.is_some()),
            ("--between", self.between.is_some()),
        ];
        if self.buried_areas && self.within.is_none() {
            return Ok(());
        }
        match flags.into_iter().find(|(_, is_given)| *is_given && !self.contact_areas) {
            Some(("--within", _)) => Err(Error::usage("--within goes with --contact-areas")),
            Some((flag, _)) => {
                Err(Error::usage(format!("{flag} goes with --contact-areas or --buried-areas")))
            }
            None => Ok(()),
        }
    }

    fn level(&self) -> Level {
        self.per.unwrap_or(match (self.pockets, self.buried_areas) {
            (true, _) => Level::Molecule,
            (_, true) => Level::Chain,
            _ => Level::Atom,
        })
    }

    fn text(&self, options: &BallOptions, radii: &str) -> String {
        let mut text = String::new();
        let products = [
            ("sasa", self.sasa),
            ("volumes", self.volumes),
            ("ses", self.ses),
            ("contact-areas", self.contact_areas),
            ("buried-areas", self.buried_areas),
            ("pockets", self.pockets),
            ("mouths", self.mouths),
            ("by-kind", self.by_kind),
            ("gradients", self.gradients),
        ];
        for (name, is_given) in products {
            text += &if is_given { format!(" --{name}") } else { String::new() };
        }
        let probe = f64::from(options.probe) / STEPS;
        let _ = write!(text, " --radii {radii} --probe {probe} --per {}", options.level.name());
        for (name, value) in [("min-area", self.min_area), ("within", self.within)] {
            text += &value.map_or(String::new(), |value| format!(" --{name} {value}"));
        }
        if let Some(between) = &options.contacts.between {
            let _ = write!(text, " --between {between}");
        }
        if let Some(maxima) = options.relative {
            let _ = write!(text, " --relative {}", maxima.name());
        }
        text
    }
}

/// Steps of 0.001 Å.
fn parse_probe(text: &str) -> std::result::Result<u32, String> {
    let radius: f64 = text.parse().map_err(|_| format!("{text:?} is not a number"))?;
    let steps = (radius * STEPS).round();
    let is_exact = (steps / STEPS - radius).abs() < 1e-9;
    if (0.0..=PROBE_MAX).contains(&radius) && is_exact {
        Ok(steps as u32)
    } else {
        Err(format!("{text:?} is not a radius of 0 to {PROBE_MAX} Å with at most three decimals"))
    }
}

fn parse_between(text: &str) -> std::result::Result<Between, String> {
    Ok(match text {
        "residues" => Between::Residues,
        "chains" => Between::Chains,
        "classes" => Between::Classes,
        list => Between::Listed(list.parse()?),
    })
}

pub(super) fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(format!("{text:?} is not a number of 0 or more")),
    }
}
