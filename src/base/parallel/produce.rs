//! A source on a thread of its own, which is never joined.

use std::ops::ControlFlow;

use crossbeam_channel::{Receiver, bounded};

use super::threads::spawn;
use crate::error::Result;

/// Starts a thread called `name` that sends what `next` returns; [`ControlFlow::Break`] is the last item. At
/// most `ahead` items wait, and the thread holds one more.
///
/// The thread is not joined: `next` may block on an input that stays silent, and a failure elsewhere must not
/// wait for it. The thread ends after the last item, or with the next item after the receiver is gone. If
/// `next` panics, the receiver sees the end of the channel without a last item.
///
/// # Errors
/// [`crate::error::ErrorKind::Io`] if the system refuses a thread.
pub fn produce<T: Send + 'static>(
    name: &str,
    ahead: usize,
    mut next: impl FnMut() -> ControlFlow<T, T> + Send + 'static,
) -> Result<Receiver<T>> {
    let (items_in, items) = bounded(ahead);
    let run = move || {
        loop {
            let (item, is_last) = match next() {
                ControlFlow::Continue(item) => (item, false),
                ControlFlow::Break(item) => (item, true),
            };
            if items_in.send(item).is_err() || is_last {
                return;
            }
        }
    };
    // Dropping the handle detaches the thread.
    spawn(name, Box::new(run))?;
    Ok(items)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn items_come_in_order_up_to_the_last_one() {
        let mut next = 0;
        let count = move || {
            next += 1;
            if next == 50 { ControlFlow::Break(next) } else { ControlFlow::Continue(next) }
        };
        let items = produce("test", 3, count).unwrap();
        assert_eq!(items.iter().collect::<Vec<u64>>(), (1..=50).collect::<Vec<_>>());
    }

    #[test]
    fn the_source_is_a_bounded_number_of_items_ahead() {
        let made = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&made);
        let next = move || match count.fetch_add(1, Ordering::SeqCst) {
            99 => ControlFlow::Break(99),
            item => ControlFlow::Continue(item),
        };
        let items = produce("test", 3, next).unwrap();
        for (taken, item) in (1..).zip(&items) {
            assert_eq!(item + 1, taken);
            assert!(made.load(Ordering::SeqCst) <= taken + 4);
        }
    }

    #[test]
    fn a_silent_source_holds_nothing_up() {
        let (_silent, never) = bounded::<()>(0);
        let next = move || {
            let _ = never.recv();
            ControlFlow::Break(())
        };
        drop(produce("test", 3, next).unwrap());
    }

    #[test]
    fn a_panic_is_an_end_without_a_last_item() {
        let items = produce("test", 3, || -> ControlFlow<(), ()> { panic!("of the test") }).unwrap();
        assert!(items.recv().is_err());
    }
}
