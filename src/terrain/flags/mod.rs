//! Command lines of `spdem`, `spground`, `spheight`, `spcanopy`, `spconstrain`, `spreport`, `spdiff` and
//! `spsimplify`.

mod names;
mod rewrite;
mod sheets;
pub mod spcanopy;
pub mod spconstrain;
pub mod spdem;
pub mod spdiff;
pub mod spground;
pub mod spheight;
pub mod spreport;
pub mod spsimplify;
