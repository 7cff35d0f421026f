//! Command lines of `spdem`, `spheight`, `spcanopy` and `spconstrain`.

mod sheets;
pub mod spcanopy;
pub mod spconstrain;
pub mod spdem;
pub mod spheight;
