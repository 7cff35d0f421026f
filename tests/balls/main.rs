//! Unions of balls against slow and plain references.

mod balls;
mod cells;
mod float;
mod float_parts;
mod in_box;
mod molecular_mesh;
mod parts;
mod pockets;
mod polyhedron;
mod surface;
mod surfaces;
mod tiles;
mod vectors;
