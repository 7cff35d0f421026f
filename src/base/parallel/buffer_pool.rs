//! Buffers that are used again.

use crossbeam_channel::{Receiver, Sender, bounded};

/// Used buffers on their way back to the threads that fill them. Clones share the buffers.
///
/// Memory: at most as many buffers as the pool was made for; further ones are freed. Dropping the last clone
/// frees the remaining buffers.
#[derive(Debug)]
pub struct BufferPool<T> {
    used: Sender<T>,
    free: Receiver<T>,
}

// Not derived: that would require `T: Clone`.
impl<T> Clone for BufferPool<T> {
    fn clone(&self) -> Self {
        BufferPool { used: self.used.clone(), free: self.free.clone() }
    }
}

impl<T> BufferPool<T> {
    /// An empty pool that keeps at most `len_max` buffers.
    pub fn new(len_max: usize) -> Self {
        let (used, free) = bounded(len_max);
        BufferPool { used, free }
    }

    /// A used buffer, or an empty one if there is none. Never waits.
    pub fn take(&self) -> T
    where
        T: Default,
    {
        self.free.try_recv().unwrap_or_default()
    }

    /// Keeps a buffer for later, or frees it if the pool is full. Never waits.
    pub fn give_back(&self, buffer: T) {
        drop(self.used.try_send(buffer));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_keeps_no_more_buffers_than_it_may() {
        let pool = BufferPool::new(2);
        assert_eq!(pool.take(), Vec::<u8>::new());
        (1..=3).for_each(|byte| pool.clone().give_back(vec![byte]));
        assert_eq!([pool.take(), pool.take(), pool.take()], [vec![1], vec![2], vec![]]);
    }
}
