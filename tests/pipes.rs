//! Points to meshes by `spfinalize`, `spdelaunay2d` and `spconstrain`: lines, areas, water, limits, files.

mod areas;
mod banks;
mod below_water;
mod bends;
mod cell_grid;
mod crs;
mod empty;
mod endless;
mod files;
mod finalize;
mod inputs;
#[path = "sources/las_file.rs"]
#[allow(dead_code, reason = "other test programs use more of it")]
mod las_file;
mod levels;
mod limits;
mod lines;
mod messages;
#[allow(dead_code, reason = "other test programs use more of it")]
mod programs;
mod reach;
mod scenes;
mod shores;
mod spconstrain;
mod system;
mod water;
