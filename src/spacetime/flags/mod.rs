//! Command line of `dd4`.

pub mod dd4;
