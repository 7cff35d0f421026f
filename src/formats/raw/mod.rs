//! Raw numbers without a header.

pub(crate) mod byte_order;
pub(crate) mod number;
pub(crate) mod read;
pub(crate) mod sample;
