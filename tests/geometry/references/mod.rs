//! The references themselves: filters against integers, and definitions against each other.

mod diagrams;
mod plane;
mod space;
mod tetrahedra;
