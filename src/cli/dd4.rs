//! `dd4`: flags.

mod source;

pub use source::{EXAMPLES as SOURCE_EXAMPLES, SourceFlags};
