//! `dd4`: flags.

mod product;
mod source;

pub use product::{EXAMPLES as PRODUCT_EXAMPLES, Product, ProductFlags, write};
pub use source::{EXAMPLES as SOURCE_EXAMPLES, SourceFlags};
