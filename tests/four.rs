//! Four dimensions: `dd4`, its sources and its meshes.

mod dd4;
mod points4;
#[allow(dead_code, reason = "other test programs use more of it")]
mod programs;
mod spacetime;
