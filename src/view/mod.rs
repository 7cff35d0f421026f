//! Pictures of streams.

pub mod frame;
pub mod page;
