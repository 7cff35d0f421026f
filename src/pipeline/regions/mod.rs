//! Overlapping regions of space: the division of points on surfaces into sets that are tetrahedralized alone.
//!
//! Boxes divide space. The region of a box has all points that the tetrahedra with their circumcentre in the
//! box depend on, so that these can be found in it alone; a point is in each region that its cell in the
//! Voronoi diagram of a sample and itself reaches. On a surface, the balls of tetrahedra are as large as the
//! body inside of it, but they are empty, so a point is in few regions all the same.
//!
//! `docs/theory/regions.md` proves it. A [`sample`] of the points is tetrahedralized ([`diagram`]); the
//! centres of its balls tell how to lay the [`boxes`], and its Voronoi cells tell [`members`].
//!
//! Source: Clarkson and Shor, "Applications of random sampling in computational geometry, II", 1989; thesis
//! 5.6 proposes them for finalization.

mod boxes;
mod curves;
mod diagram;
mod members;
mod outward;
mod sample;

pub(crate) use boxes::Boxes;
pub(crate) use curves::tetrahedra_on_curves;
pub(crate) use diagram::Diagram;
pub(crate) use members::Members;
pub(crate) use sample::Sample;
