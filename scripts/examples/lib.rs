//! What several of these programs share.

#[path = "../benchmark/rust/src/lib.rs"]
pub mod files;
pub mod fuzzing;
