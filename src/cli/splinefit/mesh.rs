//! `splinefit mesh`: flags.

use std::path::PathBuf;

use clap::Args;

use crate::error::Result;
use crate::output::Output;
use crate::splinefit::{Spline, write_control_mesh};

#[derive(Debug, Clone, Args)]
pub(super) struct Flags {
    /// The spline; - is stdin
    #[arg(value_name = "SPLINE", default_value = "-")]
    spline: PathBuf,

    /// Where the triangle mesh goes; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
}

impl Flags {
    pub(super) fn run(&self) -> Result<()> {
        let mut output = Output::create(&self.output, true)?;
        write_control_mesh(&Spline::open(&self.spline)?, &mut output)?;
        output.commit()
    }
}
