//! Command line of `spview`.

pub mod spview;
