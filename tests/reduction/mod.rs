//! The reduction gives the same triangles whatever the cells, the order, the threads and the tiles.

mod equality;
mod failures;
mod policies;
mod streams;
