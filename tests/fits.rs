//! Splines: `configgen` and `splinefit`.

mod configgen;
#[allow(dead_code, reason = "other test programs use more of it")]
mod programs;
mod splinefit;
