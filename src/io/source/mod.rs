//! Point data of other programs, read as one input: LAS, LAZ, COPC, text, spmesh streams and their text
//! twins, SPA and SPB, raw numbers, and the vertices of PLY, OBJ and VTK.

mod base64;
mod byte_order;
mod crs;
mod detect;
mod events;
mod grid;
mod gzip;
mod input;
mod las_header;
mod laz;
mod laz_chunks;
mod laz_codec;
mod lines;
mod mesh_events;
mod numbers;
mod obj;
mod opened;
mod origin;
pub mod panic_guard;
mod patches;
mod placement;
mod ply;
mod ply_header;
mod point_arrays;
pub mod points4;
mod polygon;
mod polylines;
mod raw;
mod raw_type;
mod records;
mod sample_type;
mod sma;
mod smb;
mod smb_header;
mod sp;
mod sp_events;
mod spa;
mod spb;
mod statements;
mod stream;
pub mod structure;
mod text;
mod twin;
mod twin4;
mod twin_configurations;
mod twin_functions;
mod twin_header;
mod values;
mod vertices;
mod vtk;
mod words;

use std::num::NonZeroUsize;
use std::path::PathBuf;

pub use crs::crs_name;
pub use events::EventSource;
pub use input::Input;
pub use lines::quote;
pub use obj::open_obj;
pub use opened::{Opened, open_knots, open_planar};
pub use origin::name_of;
pub use ply::open_ply;
pub use polylines::{Polyline, PolylineKind, read_polylines};
pub use raw_type::RawType;
pub use sma::open_sma;
pub use smb::open_smb;
pub use sp::{SpDatatype, SpEvent, SpFinalization, SpHeader, SpReader};
pub use sp_events::SpEvents;
pub use spa::SpaReader;
pub use spb::SpbReader;
pub use twin::TwinSource;
pub use values::{Values, read_values};
pub use words::{finite, for_each_line};

use spmesh_core::error::Result;
use spmesh_core::parallel::available_threads;
use spmesh_model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// About how many points a batch has: few enough to stay in the cache of a core on their way.
const BATCH_POINTS: usize = 1 << 14;

/// What to read of the files, and how.
#[derive(Debug, Clone, Default)]
pub struct SourceOptions {
    /// Keep only points of these classes, if any are given.
    pub keep_class: Vec<u8>,
    /// Drop points of these classes.
    pub drop_class: Vec<u8>,
    /// Keep only first returns.
    pub first_only: bool,
    /// Keep only last returns.
    pub last_only: bool,
    /// Keep only points that lie in this closed box of the world; sides may be infinite.
    pub bounds: Option<Bounds>,
    /// Drop and count points with a coordinate that is not finite, instead of failing.
    pub skip_invalid: bool,
    /// Dimensions of the geometry: 2 (z is an elevation) or 3.
    pub dims: u8,
    /// Grid to put integer coordinates on: scale and offset per axis, instead of those of the files.
    pub grid: Option<([f64; 3], [f64; 3])>,
    /// Files hold nothing but numbers of this type, x, y and z of one point after the other; their content does not tell.
    pub raw: Option<RawType>,
    /// Where spools go; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
    /// Threads that decompress points; one per core if `None`.
    pub threads: Option<NonZeroUsize>,
}

impl SourceOptions {
    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(available_threads).get()
    }
}

/// What is known of an input before its points are read.
#[derive(Debug, Clone)]
pub struct Description {
    /// Encoding that all points of the input share.
    pub coordinates: Coordinates,
    /// Dimensions of the geometry: 2 or 3.
    pub dims: u8,
    /// Whether two-dimensional points carry an elevation.
    pub has_elevation: bool,
    /// Coordinate reference system that all files share.
    pub crs: Crs,
    /// Bounding box that the headers state, in stored coordinates: to be verified.
    pub stated_bounds: Option<Bounds>,
    /// Number of points that the headers state, before filters.
    pub stated_points: Option<u64>,
}

/// One pass over an input.
pub trait PointReader: Send {
    /// Replaces the content of `batch` with the next points, in stored coordinates of the description;
    /// an empty batch after the call means the end of the input.
    ///
    /// # Errors
    /// If the input cannot be read, is malformed, or has an invalid point (file and record are named).
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()>;

    /// Points dropped so far because a coordinate is not finite.
    fn invalid(&self) -> u64;
}
