//! Threads: the few shapes of parallel work that the programs need. Results of computations that are all in
//! memory come from `parallel::map` of the crate `delaunay`.
//!
//! | shape | function | threads end |
//! |---|---|---|
//! | results as they come, each handled by the caller | [`for_each_result`] | before it returns |
//! | jobs given one at a time, results in their order | [`OrderedPool`] | when the pool is dropped |
//! | long items with a part in their order, each on one thread | [`in_turn()`] | before it returns |
//! | one thread prepares buffers, the caller consumes them | [`read_ahead()`] | before it returns |
//! | a source that may block forever | [`produce()`] | with the source, or when the receiver is gone |
//! | a call at intervals, such as a display | [`Ticker`] | when the ticker is dropped |
//! | anything else, within a scope | [`spawn_scoped`] | with the scope |
//!
//! [`BufferPool`] passes used buffers back to the threads that fill them.
//!
//! Rules common to all: a panic of a worker resumes on the calling thread with its payload. After an error or
//! a panic no further item is begun; items under way are finished. No thread outlives the call or the value
//! that started it, except in [`produce()`].

mod buffer_pool;
mod in_turn;
mod ordered_pool;
mod produce;
mod read_ahead;
mod results;
mod threads;
mod ticker;

pub use buffer_pool::BufferPool;
pub use in_turn::{InTurn, in_turn};
pub use ordered_pool::OrderedPool;
pub use produce::produce;
pub use read_ahead::read_ahead;
pub use results::for_each_result;
pub use threads::{THREADS_DEFAULT_MAX, available_threads, spawn_scoped};
pub use ticker::Ticker;
