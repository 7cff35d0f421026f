//! Molecules: `tess3`.

#[allow(dead_code, reason = "other test programs use more of it")]
mod programs;
mod tess3;
