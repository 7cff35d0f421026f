//! Command line of `spconvert`.

pub mod spconvert;
