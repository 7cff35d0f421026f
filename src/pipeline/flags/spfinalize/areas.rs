//! Flags for polygons that select points.

use std::path::PathBuf;

use clap::Args;

use crate::finalize::Areas;
use crate::lines::Target;
use spmesh_base::error::Result;
use spmesh_formats::source::read_polygons;

/// Polygons that select points. They apply after the filters, and before points are thinned.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Polygons")]
pub(super) struct AreaFlags {
    /// Keep only points inside of these polygons or on their border: GeoJSON, Shapefile, GeoPackage or WKT.
    /// May be given several times: one of the polygons must have the point
    #[arg(long, value_name = "FILE")]
    clip: Vec<PathBuf>,

    /// Drop points inside of these polygons; those on a border stay, unless another polygon has them inside.
    /// May be given several times
    #[arg(long, value_name = "FILE")]
    drop_inside: Vec<PathBuf>,
}

impl AreaFlags {
    /// All files of polygons.
    pub(super) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.clip.iter().chain(&self.drop_inside)
    }

    /// Reads the polygons, and messages for the user.
    pub(super) fn read(&self, target: &Target) -> Result<(Areas, Vec<String>)> {
        let Target { coordinates, crs, .. } = target;
        let (clip, mut notices) = read_polygons(&self.clip, coordinates, crs)?;
        let (drop, more) = read_polygons(&self.drop_inside, coordinates, crs)?;
        notices.extend(more);
        let clip = (!self.clip.is_empty()).then_some(&clip[..]);
        Ok((Areas::new(clip, &drop), notices))
    }
}
