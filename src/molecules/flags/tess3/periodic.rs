//! Flags of Voronoi and Laguerre cells, and of periodic boxes.

use clap::Args;

use super::balls::BallFlags;
use crate::tess3::{Level, PeriodicFrom, Product};
use spmesh_base::error::{Error, Result};
use spmesh_formats::molecules::PeriodicBox;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Voronoi cells and periodic boxes")]
pub(super) struct PeriodicFlags {
    /// Write a table of Voronoi cells, not clipped by balls: volume, area, number of faces, and the density
    /// of points by Delaunay tessellation (DTFE). With --radii, cells of the power diagram (Laguerre cells).
    /// Without a box, cells on the hull are unbounded
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha", "filtration", "sasa", "volumes", "ses"])]
    #[arg(conflicts_with_all = ["contact_areas", "buried_areas", "pockets"])]
    cells: bool,

    /// Rows of --cells are the faces between cells: which image of the second atom is a neighbour of the
    /// first, their distance, and the area
    #[arg(long, requires = "cells")]
    faces: bool,

    /// Atoms repeat in the box that the file states, each frame in its own: CRYST1 of PDB, _cell of mmCIF and
    /// BinaryCIF, Lattice of extended XYZ, boxes of GRO, XTC, TRR and DCD. For --cells, --sasa, --volumes and
    /// --contact-areas
    #[arg(long)]
    periodic: bool,

    /// Atoms repeat in this box: sides a,b,c (Å), with angles alpha,beta,gamma (degrees) if they are not
    /// right, or nine numbers of three vectors
    #[arg(long = "box", value_name = "NUMBER,...", allow_hyphen_values = true, value_parser = parse_box)]
    stated: Option<PeriodicBox>,
}

impl PeriodicFlags {
    /// The table that is asked for, if it is one of cells.
    pub(super) fn product(&self, balls: &BallFlags) -> Result<Option<Product>> {
        match (self.cells, self.faces, balls.stated_level()) {
            (false, ..) => Ok(None),
            (_, true, None | Some(Level::Atom)) => Ok(Some(Product::SiteFaces)),
            (_, true, Some(_)) => Err(Error::usage("--faces are between atoms: --per atom, or none")),
            (_, _, level) => Ok(Some(Product::SiteCells(level.unwrap_or_default()))),
        }
    }

    /// Where the box of a product comes from, if there is one.
    pub(super) fn source(&self, product: Product, balls: &BallFlags) -> Result<Option<PeriodicFrom>> {
        let source = match (self.stated, self.periodic) {
            (Some(stated), _) => PeriodicFrom::Stated(stated),
            (None, true) => PeriodicFrom::File,
            (None, false) => return Ok(None),
        };
        let reason = match product {
            Product::Cells if balls.has_gradients() => {
                "derivatives (--gradients) are measured without images"
            }
            Product::SiteCells(_) | Product::SiteFaces | Product::Cells | Product::ContactAreas => {
                return Ok(Some(source));
            }
            Product::Contacts => "list neighbours with --cells --faces",
            Product::Mesh => "a mesh has each vertex at one place",
            Product::Tetrahedra => "a tetrahedron may have a point and its image as corners",
            Product::Pockets => "a pocket could lead through the box without end",
            Product::Surface | Product::Filtration | Product::BuriedAreas => "it is not measured with images",
        };
        let message =
            format!("a periodic box goes with --cells, --sasa, --volumes and --contact-areas only: {reason}");
        Err(Error::usage(message))
    }

    /// The flags as a user would type them.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for (name, is_given) in
            [(" --cells", self.cells), (" --faces", self.faces), (" --periodic", self.periodic)]
        {
            text += if is_given { name } else { "" };
        }
        text + &self.stated.map_or(String::new(), |stated| format!(" --box {stated}"))
    }
}

fn parse_box(text: &str) -> std::result::Result<PeriodicBox, String> {
    text.parse().map_err(|error: Error| error.to_string())
}
