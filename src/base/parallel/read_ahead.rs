//! One thread prepares buffers while the caller consumes others.

use std::iter::repeat_with;
use std::sync::{Mutex, PoisonError};

use crossbeam_channel::bounded;

use super::threads::{join, spawn_scoped};
use crate::error::Result;

/// Fills buffers with `produce` on a thread called `name`, and gives them in order to `consume` on the
/// calling thread. The two threads share `buffers` buffers. `produce` returns whether it filled the buffer;
/// `false` ends the input.
///
/// After an error of `consume`, the call waits until the current `produce` has returned.
///
/// Memory: `buffers` buffers.
///
/// # Errors
/// The first error in the order of the buffers, whichever thread it happens on;
/// [`crate::error::ErrorKind::Io`] if the system refuses a thread.
///
/// # Panics
/// If `produce` or `consume` panics.
pub fn read_ahead<B: Default + Send>(
    name: &str,
    buffers: usize,
    mut produce: impl FnMut(&mut B) -> Result<bool> + Send,
    mut consume: impl FnMut(&mut B) -> Result<()>,
) -> Result<()> {
    let slots: Vec<Mutex<B>> = repeat_with(Mutex::default).take(buffers).collect();
    // A buffer has one user at a time, the one that knows its number, so that nobody waits for its lock.
    let slot = |number: usize| slots[number].lock().unwrap_or_else(PoisonError::into_inner);
    pass_round(name, buffers, &mut |number| produce(&mut slot(number)), &mut |number| {
        consume(&mut slot(number))
    })
}

/// Passes the numbers of buffers from one to the other. Knows no buffers, so that it is compiled once.
fn pass_round(
    name: &str,
    buffers: usize,
    produce: &mut (dyn FnMut(usize) -> Result<bool> + Send),
    consume: &mut dyn FnMut(usize) -> Result<()>,
) -> Result<()> {
    let (full_in, full) = bounded::<usize>(buffers);
    let (empty_in, empty) = bounded::<usize>(buffers);
    let run = move || -> Result<()> {
        // Either channel is closed early when `consume` fails.
        while let Ok(number) = empty.recv() {
            if !produce(number)? || full_in.send(number).is_err() {
                break;
            }
        }
        Ok(())
    };
    // The closure owns both ends of the caller, so that an error or a panic closes the channels before the
    // scope waits.
    std::thread::scope(move |scope| {
        let producer = spawn_scoped(scope, name, run)?;
        for number in 0..buffers {
            // Fails only if the producer has ended; the join below returns the reason.
            let _ = empty_in.send(number);
        }
        for number in full {
            consume(number)?;
            let _ = empty_in.send(number);
        }
        join(producer)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Fills buffers with the numbers below `count`.
    fn numbers(count: usize) -> impl FnMut(&mut Vec<usize>) -> Result<bool> + Send {
        let mut next = 0;
        move |buffer| {
            buffer.clear();
            buffer.push(next);
            next += 1;
            Ok(next <= count)
        }
    }

    #[test]
    fn buffers_come_in_order_and_go_round() {
        for buffers in [1, 3] {
            for count in [0, 1, 100] {
                let mut seen = Vec::new();
                read_ahead("test", buffers, numbers(count), |buffer| {
                    seen.extend_from_slice(buffer);
                    Ok(())
                })
                .unwrap();
                assert_eq!(seen, (0..count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn the_producer_is_no_further_ahead_than_there_are_buffers() {
        let (filled, mut consumed) = (AtomicUsize::new(0), 0);
        let mut produce = numbers(100);
        let count = |buffer: &mut Vec<usize>| {
            filled.fetch_add(1, Ordering::SeqCst);
            produce(buffer)
        };
        read_ahead("test", 3, count, |_| {
            assert!(filled.load(Ordering::SeqCst) <= consumed + 3);
            consumed += 1;
            Ok(())
        })
        .unwrap();
        assert_eq!(consumed, 100);
    }

    #[test]
    fn the_first_error_in_order_counts() {
        let run = |broken_at: usize, refused: usize| {
            let mut produce = numbers(100);
            let fail = move |buffer: &mut Vec<usize>| {
                let is_filled = produce(buffer)?;
                if buffer[0] == broken_at { Err(Error::usage("produce")) } else { Ok(is_filled) }
            };
            let consume = |buffer: &mut Vec<usize>| {
                if buffer[0] == refused { Err(Error::usage("consume")) } else { Ok(()) }
            };
            read_ahead("test", 3, fail, consume).unwrap_err().to_string()
        };
        assert_eq!(run(5, 200), "produce");
        assert_eq!(run(200, 5), "consume");
        assert_eq!(run(6, 5), "consume");
        assert_eq!(run(5, 6), "produce");
    }

    #[test]
    fn panics_of_both_sides_resume() {
        let produce = |_: &mut ()| -> Result<bool> { panic!("produce") };
        let panic = catch_unwind(|| read_ahead("test", 3, produce, |()| Ok(()))).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"produce"));
        let run = || read_ahead("test", 3, numbers(100), |_| panic!("consume"));
        let panic = catch_unwind(AssertUnwindSafe(run)).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"consume"));
    }
}
