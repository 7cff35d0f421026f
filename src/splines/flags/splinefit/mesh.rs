//! `splinefit mesh`: flags.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use crate::splinefit::{ControlMesh, Spline};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::source::name_of;
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_stream::StreamReader;
use spmesh_view::{Moments, Options, Picture};

#[derive(Debug, Clone, Args)]
pub(super) struct Flags {
    /// The spline; - is stdin
    #[arg(value_name = "SPLINE", default_value = "-")]
    spline: PathBuf,

    /// Where the triangle mesh goes; - is stdout. With the extension .svg, a picture of it
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Draw the mesh as SVG, independently of the extension
    #[arg(long)]
    svg: bool,

    #[command(flatten)]
    compression: Compression,
}

impl Flags {
    pub(super) fn run(&self) -> Result<()> {
        if !self.svg {
            endings::check(&self.output, &[endings::STREAM, &["svg"]])?;
        }
        let is_picture = self.svg || self.output.extension().is_some_and(|ending| ending == "svg");
        let compress = self.compression.of_output(!is_picture)?;
        let mut output = Output::create(&self.output, !is_picture)?;
        let mesh = ControlMesh::of(&Spline::open(&self.spline)?)?;
        if is_picture {
            self.draw(&mesh, &mut output)?
        } else {
            mesh.write(compress, &mut output)?
        }
        output.commit()
    }

    /// The picture that `spview` makes of the mesh, from one side.
    fn draw(&self, mesh: &ControlMesh, output: &mut Output) -> Result<()> {
        let mut stream = Vec::new();
        mesh.write(false, &mut stream)?;
        let mut reader = StreamReader::new(&stream[..], "the control mesh")?;
        let name = format!("Control mesh of {}", name_of(&self.spline));
        let options = Options { oblique: true, ..Options::new(name) };
        let mut take = |picture: &Picture| {
            let written = output.write_all(picture.svg.as_bytes());
            written.map_err(|error| Error::io("writing the picture", error))
        };
        spmesh_view::draw(&mut reader, &options, Moments::default(), &mut take, |_| {})
    }
}
