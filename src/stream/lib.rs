//! The spmesh stream: one container for finalized points, meshes and residuals.
//!
//! `formats/spmesh.md` is the specification; this module is its reader and its writer. Tools meet only here.

mod block;
mod cell_words;
mod chunks;
mod configuration_rules;
mod configuration_set;
mod configurations;
mod diagram4;
mod event;
mod finalized;
mod functions;
mod header;
mod kind;
mod live;
mod patch_blocks;
mod payload;
mod points4;
mod reader;
mod rules4;
mod tail;
mod tally;
mod triangles;
mod write_configurations;
mod writer;

pub use configuration_set::{Collector, ConfigurationSet};
pub use configurations::ConfigurationBlock;
pub use configurations::{check_degree, claim_from_name, claim_name};
pub use diagram4::Diagram4;
pub use event::{Event, Patch, Totals};
pub use finalized::FinalizedCells;
pub use functions::{kind_of, kind_of_name, kind_parts};
pub use header::{Coordinates, Crs, Header};
pub use kind::Kind;
pub use live::LiveVertices;
pub use patch_blocks::{PatchBlocks, PointCode};
pub use payload::{check_place, decode_points};
pub use points4::Points4;
pub use points4::check_value;
pub use reader::StreamReader;
pub use tail::ends_with_end;
pub use tally::Tally;
pub use triangles::write_triangles;
pub use write_configurations::{Content, configurations_header, write_configurations, write_content};
pub use writer::StreamWriter;
pub use writer::encode_points;
