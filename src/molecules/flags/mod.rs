//! Command line of `tess3`.

pub mod tess3;
