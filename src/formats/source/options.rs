//! Options of reading an input.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

use crate::detect::Reader;
use crate::molecules::Radii;
use crate::raw::number::RawType;
use crate::source::filters::{DropReason, Filters};
use crate::source::gzip::Use;
use crate::source::origin::Admitted;
use crate::source::row_plan::AttributeChoice;
use crate::text::options::TextOptions;
use spmesh_base::parallel::available_threads;
use spmesh_stream::model::bounds::{Bounds, Region};
use spmesh_stream::{Coordinates, Crs};

/// What to do about a point with a coordinate that is not finite.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum InvalidAdvice {
    /// The program has no flag for it, but reads the output of `spfinalize`.
    #[default]
    Spfinalize,
    /// The program has the flag.
    SkipInvalid,
    /// Each point has its place in the output, so that the program skips none.
    LeaveOut,
}

impl InvalidAdvice {
    /// The advice, for messages.
    pub(crate) fn text(self) -> &'static str {
        match self {
            InvalidAdvice::Spfinalize => "spfinalize --skip-invalid drops and counts such points",
            InvalidAdvice::SkipInvalid => "--skip-invalid drops and counts such points",
            InvalidAdvice::LeaveOut => "leave it out: the output has a line or row for each point",
        }
    }
}

/// What to read of the files, and how.
#[derive(Debug, Clone, Default)]
pub struct SourceOptions {
    /// The reading tool, for messages.
    pub reader: &'static Reader,
    /// What points carry beside their coordinates.
    pub attributes: AttributeChoice,
    /// Keep only points that pass these filters.
    pub filters: Filters,
    /// Keep only points that lie in this closed box of the world; sides may be infinite.
    pub bounds: Option<Bounds>,
    /// Points outside of this closed box of the world may be left out where an index of a LAS or LAZ file
    /// tells where they are; sides may be infinite. This is a permission and no filter: other points may
    /// still come. It holds for points as the file stores them, before they move to a common grid.
    pub reach: Option<Bounds>,
    /// Drop and count points with a coordinate that is not finite, instead of failing.
    pub skip_invalid: bool,
    /// What the error for such a point advises.
    pub invalid_advice: InvalidAdvice,
    /// Take the whole points before the cut of LAS, LAZ, text and raw files that were cut off.
    pub salvage: bool,
    /// Dimensions of the geometry: 2 (z is an elevation) or 3.
    pub dims: u8,
    /// Grid for integer coordinates: scale and offset per axis, instead of the files' own.
    pub grid: Option<([f64; 3], [f64; 3])>,
    /// The encoding of all points, instead of one that suits the files: that of a larger input, of which they are a
    /// part.
    pub encoding: Option<Coordinates>,
    /// Keep only points in this half-open box, in stored coordinates of `encoding`. Points outside of it are those of
    /// other parts: nothing counts them as dropped.
    pub window: Option<Region<3>>,
    /// Type of the numbers if the files hold only x, y and z of one point after the other, without a header.
    /// Such files cannot be recognized by content.
    pub raw: Option<RawType>,
    /// The coordinate reference system, whatever the files state.
    pub crs: Option<Crs>,
    /// Whether the program holds all points: a compressed file then must not expand implausibly.
    pub holds_points: bool,
    /// Radii of atoms, which they then have as an attribute.
    pub radii: Option<Arc<Radii>>,
    /// How lines of text are laid out.
    pub text: TextOptions,
    /// Folder of spools; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
    /// Threads that decompress points; one per core if `None`.
    pub threads: Option<NonZeroUsize>,
}

impl SourceOptions {
    /// The parts of the world that points must lie in, with the reason for which others are dropped.
    pub(crate) fn windows(&self) -> Vec<(DropReason, Bounds)> {
        let bounds = self.bounds.map(|bounds| (DropReason::Bounds, bounds));
        let z = self.filters.z.map(|z| (DropReason::Z, z.of_z()));
        bounds.into_iter().chain(z).collect()
    }

    /// The folder of spools.
    pub(crate) fn temp_dir(&self) -> PathBuf {
        self.temp_dir.clone().unwrap_or_else(std::env::temp_dir)
    }

    /// What may be spooled.
    pub(crate) fn admitted(&self) -> Admitted {
        if self.raw.is_some() { Admitted::Everything } else { Admitted::Formats(self.reader) }
    }

    /// What the program does with the points.
    pub(crate) fn purpose(&self) -> Use {
        if self.holds_points { Use::Held } else { Use::Passed }
    }

    /// How many threads decompress points.
    pub(crate) fn threads(&self) -> usize {
        self.threads.unwrap_or_else(available_threads).get()
    }
}
