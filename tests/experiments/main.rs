//! Programs that were built with experiments: a test program of its own, because all other tests run the
//! programs as they are shipped.

mod dd4;
#[allow(dead_code, reason = "the tests of `tess3` use more of it")]
#[path = "../tess3/mesh.rs"]
mod mesh;
#[allow(dead_code, reason = "the tests of `tess3` use more of it")]
#[path = "../tess3/molecules.rs"]
mod molecules;
#[allow(dead_code, reason = "other tests use more of it")]
#[path = "../programs.rs"]
mod programs;
mod tess3;
