//! `splinefit mesh`: flags.

use std::path::PathBuf;

use clap::Args;

use crate::error::Result;
use crate::output::Output;
use crate::splinefit::{ControlMesh, Spline};

#[derive(Debug, Clone, Args)]
pub(super) struct Flags {
    /// The spline; - is stdin
    #[arg(value_name = "SPLINE", default_value = "-")]
    spline: PathBuf,

    /// Where the triangle mesh goes; - is stdout. With the ending .svg, a picture of it
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Draw the mesh as SVG, whatever the ending
    #[arg(long)]
    svg: bool,
}

impl Flags {
    pub(super) fn run(&self) -> Result<()> {
        let is_picture = self.svg || self.output.extension().is_some_and(|ending| ending == "svg");
        let mut output = Output::create(&self.output, !is_picture)?;
        let mesh = ControlMesh::of(&Spline::open(&self.spline)?)?;
        if is_picture {
            mesh.draw(&mut output)?
        } else {
            mesh.write(&mut output)?
        }
        output.commit()
    }
}
