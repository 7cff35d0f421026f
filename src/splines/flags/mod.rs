//! Command lines of `configgen` and `splinefit`.

pub mod configgen;
pub mod splinefit;
