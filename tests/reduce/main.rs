//! The reduction gives the same simplices for any cells, order, threads and tiles.

mod attributes;
mod audited_parts;
mod balls;
mod equality;
mod failures;
mod parts;
mod policies;
mod regions;
mod shapes;
mod solids;
mod space;
mod space_tile_damage;
mod space_tiles;
mod streams;
mod weights;
