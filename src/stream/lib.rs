//! Reader and writer of spmesh streams: one container for points, meshes, 4D diagrams and splines.
//!
//! A stream is a header, then blocks with checksums, then an END block with totals. [`Header`] states the
//! [`Kind`] of the stream, which decides what blocks it may hold, and how stored coordinates map to the world
//! ([`Coordinates`], [`Crs`]). Coordinates in blocks are *stored* coordinates.
//!
//! - [`StreamWriter`] writes blocks; only [`StreamWriter::end`] completes a stream.
//! - [`StreamReader`] decodes and checks one block at a time, and returns it as an [`Event`]. It verifies
//!   length and checksum before it decodes, and totals at the end. Its memory is independent of the length of
//!   the stream. It decompresses blocks where a writer compressed them, which [`Header::compressed`] allows.
//!   It skips header records and blocks that it does not know if their tags allow that, and refuses others as
//!   [`spmesh_base::error::ErrorKind::Unsupported`].
//! - [`LiveVertices`] and [`FinalizedCells`] keep what a consumer needs between events: vertices that later
//!   patches may still use, and cells that no later point lies in. [`MemoryRules`] checks with both what the
//!   reader alone cannot check.
//! - A triangle mesh may be [`Constrained`]: [`Segment`]s are then chains of its edges, which the sides of
//!   [`Patch`]es name.
//! - Points of space may come in overlapping [`PointRegion`]s, each of which a consumer can take alone.
//! - Points of space may be [`Weighted`]: a mesh of them is a regular tetrahedralization.
//! - [`ConfigurationSet`] and [`read_diagram4`] hold whole streams in memory, for consumers that need all at
//!   once.
//! - [`model`] has the data themselves: points, boxes, cells, configurations, attributes.
//!
//! `formats/spmesh.md` specifies every byte. Tools exchange data through this crate only.
//!
//! # Example
//!
//! ```
//! use spmesh_stream::{Coordinates, Event, Header, Kind, StreamReader, StreamWriter};
//!
//! # fn main() -> spmesh_base::error::Result<()> {
//! // Three points of space, written to memory.
//! let points = vec![[0.0, 0.0, 0.5], [1.0, 0.0, 0.25], [0.0, 1.0, -2.0]];
//! let header = Header::new(Kind::Points, Coordinates::F64, 3, false);
//! let mut writer = StreamWriter::new(Vec::new(), header)?;
//! writer.points(&points)?;
//! // A stream of points counts its points itself: END ignores both arguments.
//! let bytes = writer.end(0, 0)?;
//!
//! let mut reader = StreamReader::new(&bytes[..], "memory")?;
//! assert_eq!(reader.header().dims, 3);
//! let mut found = Vec::new();
//! while let Some(event) = reader.next_event()? {
//!     if let Event::Points(block) = event {
//!         found.extend(block);
//!     }
//! }
//! assert_eq!(found, points);
//! assert_eq!(reader.totals().points, 3);
//!
//! // A truncated stream is an error, never a shorter one.
//! let mut reader = StreamReader::new(&bytes[..bytes.len() - 1], "memory")?;
//! assert!(matches!(reader.next_event()?, Some(Event::Points(_))));
//! assert!(reader.next_event().is_err());
//! # Ok(())
//! # }
//! ```

mod ascending;
mod attribute_code;
mod block;
mod cell_words;
mod chunks;
mod compression;
mod configuration_rules;
mod configuration_set;
mod configurations;
mod constraint_edges;
mod constraints;
mod coordinates;
mod decimals;
mod diagram4;
mod event;
mod finalized;
mod functions;
mod head;
mod header;
mod header_code;
mod joined;
mod kind;
mod live;
mod memory_rules;
pub mod model;
mod part;
mod patch_blocks;
mod payload;
mod points4;
mod reader;
mod regions;
mod rules4;
mod surface;
mod tag_rules;
mod tail;
mod tally;
mod triangles;
mod weights;
mod write_configurations;
mod writer;

pub use ascending::{Ascending, Place};
pub use cell_words::check_word_count;
pub use compression::Decompressor;
#[cfg(feature = "zstd")]
pub use compression::{ZstdReader, zstd_frame};
pub use configuration_set::{Collector, ConfigurationSet};
pub use configurations::ConfigurationBlock;
pub use configurations::{check_degree, claim_from_name, claim_name};
pub use constraint_edges::ConstraintEdges;
pub use constraints::{Constrained, Segment};
pub use coordinates::Coordinates;
pub use diagram4::{Diagram4Collector, read_diagram4};
pub use event::{Event, Patch, Totals};
pub use finalized::FinalizedCells;
pub use functions::{function_kind, function_kind_of_name, function_kind_parts};
pub use header::{Crs, Header};
pub use header_code::{VERSION, check_version};
pub use joined::{JoinedMesh, OpenedPart, PartSize};
pub use kind::Kind;
pub use live::LiveVertices;
pub use memory_rules::MemoryRules;
pub use part::{GlobalId, Origin, PartName, check_residual_id};
pub use patch_blocks::{PatchBlocks, PointCode};
pub use payload::{check_place, decode_points};
pub use points4::Points4;
pub use points4::check_value;
pub use reader::StreamReader;
pub use regions::PointRegion;
pub use rules4::{check_neighbour_count, check_vertex_count};
pub use surface::{check_part, check_surface};
pub use tail::ends_with_end;
pub use tally::Tally;
pub use triangles::write_triangles;
pub use weights::{Weighted, Weights};
pub use write_configurations::{Content, configurations_header, write_configurations, write_content};
pub use writer::StreamWriter;
pub use writer::encode_points;
