//! Molecules and other balls: tetrahedra of atoms (thesis 3.4), and the union of balls, its areas, volumes,
//! contacts, pockets and surfaces.
//!
//! [`balls`] and [`cells`] compute, [`tess3`] is the engine of the program; `flags`, with the feature of this
//! name, has its command line. `float` is the program of the thesis, in floating-point arithmetic, for
//! experiments.

pub mod balls;
pub mod cells;
#[cfg(feature = "flags")]
pub mod flags;
pub mod float;
pub mod tess3;
