//! Flags of meshes that take the place of tables of balls.

use std::path::Path;

use clap::Args;

use super::balls::{BallFlags, parse_positive};
use crate::tess3::{ColourBy, PictureForm, PictureOptions, Product};
use spmesh_base::error::{Error, Result};
use spmesh_shell::{Names, named, of_ending};

/// Resolution by default, in Å.
const RESOLUTION: f64 = 0.5;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Atoms as balls, as meshes (-o FILE.ply or FILE.vtu)")]
pub(super) struct PictureFlags {
    /// Greatest distance of neighbouring vertices (Å), at least 1/200 of the greatest radius [default: 0.5]
    #[arg(long, value_name = "DISTANCE", value_parser = parse_positive)]
    resolution: Option<f64>,

    /// What the colours of --sasa tell: the element, the chain, or the pocket around which a triangle lies
    /// [default: element]
    #[arg(long, value_name = "WHAT", requires = "sasa", value_parser = named(COLOURS))]
    colour_by: Option<ColourBy>,
}

const COLOURS: Names<ColourBy> =
    &[("element", ColourBy::Element), ("chain", ColourBy::Chain), ("pocket", ColourBy::Pocket)];

/// The forms that endings of names stand for.
const FORMS: Names<PictureForm> = &[
    ("ply", PictureForm::Ply),
    ("vtu", PictureForm::Vtu),
    ("pdb", PictureForm::Pdb),
    ("cif", PictureForm::Mmcif),
    ("defattr", PictureForm::Defattr),
];

impl PictureFlags {
    /// The mesh that the ending of the output asks for; `None` for a table.
    pub(super) fn of_output(
        &self,
        output: &Path,
        product: Product,
        balls: &BallFlags,
    ) -> Result<Option<PictureOptions>> {
        let takes = |form: &PictureForm| match form {
            PictureForm::Ply | PictureForm::Vtu => {
                matches!(
                    product,
                    Product::Cells | Product::Surface | Product::ContactAreas | Product::Pockets
                )
            }
            PictureForm::Pdb => matches!(product, Product::Cells | Product::Surface | Product::Pockets),
            PictureForm::Mmcif | PictureForm::Defattr => matches!(product, Product::Cells | Product::Surface),
        };
        let form = of_ending(FORMS, output).filter(takes);
        if let Some(form) = form.filter(|form| form.is_of_atoms()) {
            self.refuse("goes with -o FILE.ply or FILE.vtu")?;
            balls.check_for_atoms()?;
            return Ok(Some(PictureOptions { form, resolution: RESOLUTION, colours: ColourBy::Element }));
        }
        let Some(form) = form else {
            let reason = "needs -o FILE.ply or FILE.vtu, and --sasa, --ses, --contact-areas or --pockets";
            return self.refuse(reason).map(|()| None);
        };
        balls.check_for_mesh()?;
        let colours = self.colour_by.unwrap_or(ColourBy::Element);
        Ok(Some(PictureOptions { form, resolution: self.resolution.unwrap_or(RESOLUTION), colours }))
    }

    /// Refuses flags of meshes where there is none.
    pub(super) fn refuse(&self, reason: &str) -> Result<()> {
        let flag = match (self.resolution, self.colour_by) {
            (Some(_), _) => "--resolution",
            (_, Some(_)) => "--colour-by",
            _ => return Ok(()),
        };
        Err(Error::usage(format!("{flag} {reason}")))
    }
}
