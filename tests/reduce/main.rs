//! The reduction gives the same simplices whatever the cells, the order, the threads and the tiles.

mod equality;
mod failures;
mod policies;
mod space;
mod space_tile_damage;
mod space_tiles;
mod streams;
