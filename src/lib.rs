//! Exact Delaunay triangulation in the plane and in space, for sets of points in memory and for streams of
//! points that are larger than memory.
//!
//! The result never depends on rounding: all decisions are exact. It is canonical: ties between cocircular or
//! cospherical points are broken by a rule that looks only at their coordinates, so a set of points has one
//! triangulation, whatever the order of the points.
//!
//! # Points of the plane
//!
//! [`delaunay2::triangulate`](delaunay::delaunay2::triangulate) takes points and returns a
//! [`Triangulation`](delaunay::delaunay2::Triangulation). Its vertices are indices of the points.
//!
//! ```
//! use spmesh::delaunay::Location;
//! use spmesh::delaunay::delaunay2::triangulate;
//!
//! let points = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [3.0, 3.0], [0.0, 0.0]];
//! let mesh = triangulate(&points)?;
//! for [a, b, c] in mesh.simplices() {
//!     println!("{a} {b} {c}");
//! }
//! assert_eq!(mesh.hull().count(), 4);
//! assert_eq!(mesh.duplicates(), [[4, 0]]);
//!
//! match mesh.locate([1.0, 0.5]) {
//!     Location::Simplex(number) => println!("in triangle {number}, beside {:?}", mesh.neighbours(number)),
//!     location => panic!("{location:?}"),
//! }
//! assert_eq!(mesh.locate([2.0, 0.0]), Location::Edge([0, 1]));
//! # Ok::<(), spmesh::delaunay::Error>(())
//! ```
//!
//! # Points of space
//!
//! [`delaunay3::triangulate`](delaunay::delaunay3::triangulate) returns a
//! [`Tetrahedralization`](delaunay::delaunay3::Tetrahedralization), which has the same methods.
//!
//! ```
//! use spmesh::delaunay::delaunay3::triangulate;
//!
//! let cube: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
//! let mesh = triangulate(&cube)?;
//! // Twelve edges of the cube, and a diagonal on each face at least.
//! assert!(mesh.edges().len() >= 18);
//! assert_eq!(mesh.hull().count(), 12);
//! # Ok::<(), spmesh::delaunay::Error>(())
//! ```
//!
//! Programs that triangulate many sets use [`delaunay2::Kernel`](delaunay::delaunay2::Kernel) or
//! [`delaunay3::Kernel`](delaunay::delaunay3::Kernel), which keep their buffers.
//!
//! # Streams
//!
//! A [`StreamWriter`](stream::StreamWriter) writes points, or a mesh, block by block; a
//! [`StreamReader`](stream::StreamReader) reads and checks them. [`reduce::triangulate`] turns a stream of
//! points into a stream of triangles. It needs memory for the whole set only if the stream does not say when
//! parts of the plane are complete; the program `spfinalize` adds that.
//!
//! ```
//! use spmesh::reduce::{self, Options};
//! use spmesh::stream::{Coordinates, Event, Header, Kind, StreamReader, StreamWriter};
//!
//! let header = Header::new(Kind::Points, Coordinates::F64, 2, false);
//! let mut writer = StreamWriter::new(Vec::new(), header)?;
//! writer.points(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [3.0, 3.0, 0.0]])?;
//! let points: Vec<u8> = writer.end(4, 0)?;
//!
//! let reader = StreamReader::new(std::io::Cursor::new(points), "points")?;
//! let (mesh, _stats) = reduce::triangulate(reader, Vec::new(), &Options::default(), |_read| {})?;
//!
//! let mut reader = StreamReader::new(mesh.as_slice(), "mesh")?;
//! let mut triangles = 0;
//! while let Some(event) = reader.next_event()? {
//!     if let Event::Patch(patch) = event {
//!         triangles += patch.triangles().count();
//!     }
//! }
//! assert_eq!(triangles, 2);
//! # Ok::<(), spmesh::base::error::Error>(())
//! ```
//!
//! # Features
//!
//! The default features build the programs. With `default-features = false` this crate is the library alone.
//!
//! | feature | adds |
//! |---|---|
//! | `programs` (default) | all programs |
//! | `pipeline`, `terrain`, `view`, `convert`, `molecules`, `spacetime`, `splines` | the programs of one subject |
//! | `geopackage` (default) | lines of GeoPackages |
//! | `experiments` | flags that measure the kernels |
//!
//! Engines of the programs are crates of their own, such as `spmesh-terrain`, whose feature `flags` adds the
//! command lines.

pub use spmesh_base as base;
pub use spmesh_delaunay as delaunay;
pub use spmesh_pipeline::reduce;
pub use spmesh_stream as stream;
