//! Command lines of `spdem`, `spheight`, `spcanopy`, `spconstrain` and `spreport`.

mod sheets;
pub mod spcanopy;
pub mod spconstrain;
pub mod spdem;
pub mod spheight;
pub mod spreport;
