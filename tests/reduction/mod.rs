//! The reduction gives the same simplices whatever the cells, the order, the threads and the tiles.

mod equality;
mod failures;
mod policies;
mod space;
mod streams;
