//! Long items, each with a part that must wait for its turn.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use super::threads::{join, on_panic, spawn_scoped};
use crate::error::Result;

/// What is done with items, one after the other or on several threads.
pub trait InTurn: Sync {
    /// An item, what comes of it, and what a thread keeps from one item to the next.
    type Item: Send;
    /// What `work` makes of an item.
    type Done: Send;
    /// Buffers of a thread.
    type State: Send;
    /// What the parts in turn share.
    type Shared: Send;

    /// Whether an item may be begun while others of this weight in all are under way. Called again when less
    /// is; without others, it must not refuse.
    ///
    /// # Errors
    /// Those that end the work in place of the item.
    fn admits(&self, item: &mut Self::Item, under_way: u64, shared: &Self::Shared) -> Result<bool>;

    /// The weight of an item.
    fn weight(&self, item: &Self::Item) -> u64;

    /// What does not depend on other items.
    ///
    /// # Errors
    /// Those that end the work when it is the item's turn.
    fn work(&self, state: &mut Self::State, item: Self::Item) -> Result<Self::Done>;

    /// What needs all earlier items to be finished.
    ///
    /// # Errors
    /// Those that end the work.
    fn finish(&self, state: &mut Self::State, done: Self::Done, shared: &mut Self::Shared) -> Result<()>;
}

struct Turn<S> {
    /// The item whose turn it is.
    number: u64,
    /// Weight of the items under way.
    under_way: u64,
    /// No further item is finished.
    is_over: bool,
    result: Result<()>,
    shared: S,
}

struct Turns<'t, T: InTurn, N> {
    task: &'t T,
    /// The number of the next item, and where it comes from; `None` after the last.
    input: Mutex<(u64, Option<N>)>,
    turn: Mutex<Turn<T::Shared>>,
    changed: Condvar,
    /// Set after a failure: no further item is begun. Earlier ones may still be finished.
    ends: AtomicBool,
}

/// Takes items from `next`, which gets a flag that is set after a failure, until it returns `None`, works on
/// them on as many threads as there are `states`, and finishes them one at a time, in their order, each on
/// its thread. Returns what the threads and the turns kept.
///
/// Memory: an item for each thread.
///
/// # Errors
/// The first one in the order of the items, of `next`, too; [`crate::error::ErrorKind::Io`] if the system
/// refuses a thread.
///
/// # Panics
/// If the task panics.
pub fn in_turn<T: InTurn>(
    task: &T,
    mut states: Vec<T::State>,
    shared: T::Shared,
    next: impl FnMut(&AtomicBool) -> Result<Option<T::Item>> + Send,
) -> Result<(Vec<T::State>, T::Shared)> {
    let turn = Turn { number: 0, under_way: 0, is_over: false, result: Ok(()), shared };
    let turns = Turns {
        task,
        input: Mutex::new((0, Some(next))),
        turn: Mutex::new(turn),
        changed: Condvar::new(),
        ends: AtomicBool::new(false),
    };
    thread::scope(|scope| {
        let mut others = Vec::new();
        let (first, rest) = states.split_first_mut().expect("a state for each thread");
        let started = rest.iter_mut().try_for_each(|state| {
            others.push(spawn_scoped(scope, "worker", || turns.run_guarded(state))?);
            Ok(())
        });
        match started {
            Ok(()) => turns.run_guarded(first),
            Err(_) => turns.end(),
        }
        others.into_iter().for_each(join);
        started
    })?;
    let Turn { result, shared, .. } = turns.turn.into_inner().unwrap_or_else(PoisonError::into_inner);
    result.map(|()| (states, shared))
}

impl<T: InTurn, N: FnMut(&AtomicBool) -> Result<Option<T::Item>> + Send> Turns<'_, T, N> {
    /// Others do not wait for the turn of an item that has panicked.
    fn run_guarded(&self, state: &mut T::State) {
        on_panic(|| self.end(), || self.run(state));
    }

    fn run(&self, state: &mut T::State) {
        while let Some((number, item)) = self.take() {
            let (weight, done) = match item {
                Ok(item) => (self.task.weight(&item), self.task.work(state, item)),
                Err(error) => (0, Err(error)),
            };
            if done.is_err() {
                self.ends.store(true, Ordering::Relaxed);
            }
            let mut turn = self.turn_of(number);
            if turn.is_over {
                return;
            }
            let finished = done.and_then(|done| self.task.finish(state, done, &mut turn.shared));
            turn.number += 1;
            turn.under_way -= weight;
            turn.is_over = finished.is_err();
            self.ends.fetch_or(turn.is_over, Ordering::Relaxed);
            turn.result = finished;
            drop(turn);
            self.changed.notify_all();
        }
    }

    /// The next item, when it may be begun.
    fn take(&self) -> Option<(u64, Result<T::Item>)> {
        let mut input = self.input.lock().unwrap_or_else(PoisonError::into_inner);
        let (number, next) = &mut *input;
        let item =
            if self.ends.load(Ordering::Relaxed) { None } else { next.as_mut()?(&self.ends).transpose() };
        let Some(item) = item else {
            *next = None;
            return None;
        };
        let item = item.and_then(|mut item| {
            let mut turn = self.turn();
            while !turn.is_over && !self.task.admits(&mut item, turn.under_way, &turn.shared)? {
                turn = self.changed.wait(turn).unwrap_or_else(PoisonError::into_inner);
            }
            turn.under_way += self.task.weight(&item);
            Ok(item)
        });
        if self.ends.load(Ordering::Relaxed) {
            // What is under way decides which error is the first.
            *next = None;
            return None;
        }
        if item.is_err() {
            *next = None;
        }
        *number += 1;
        Some((*number - 1, item))
    }

    fn turn(&self) -> MutexGuard<'_, Turn<T::Shared>> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the turn of an item, or until none comes any more.
    fn turn_of(&self, number: u64) -> MutexGuard<'_, Turn<T::Shared>> {
        let waits = |turn: &mut Turn<T::Shared>| !turn.is_over && turn.number != number;
        self.changed.wait_while(self.turn(), waits).unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets nothing more be begun or finished.
    fn end(&self) {
        self.ends.store(true, Ordering::Relaxed);
        self.turn().is_over = true;
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::time::Duration;

    /// Squares numbers; some fail or panic.
    struct Squares {
        fails_at: u64,
        panics_at: u64,
        under_way_max: u64,
    }

    impl InTurn for Squares {
        type Item = u64;
        type Done = [u64; 2];
        type State = u64;
        type Shared = Vec<[u64; 2]>;

        fn admits(&self, _: &mut u64, under_way: u64, _: &Vec<[u64; 2]>) -> Result<bool> {
            Ok(under_way <= self.under_way_max)
        }

        fn weight(&self, _: &u64) -> u64 {
            1
        }

        fn work(&self, _: &mut u64, item: u64) -> Result<[u64; 2]> {
            assert!(item != self.panics_at, "as it should");
            std::thread::sleep(Duration::from_micros(200 * (7 - item % 7)));
            Ok([item, item * item])
        }

        fn finish(&self, state: &mut u64, done: [u64; 2], shared: &mut Vec<[u64; 2]>) -> Result<()> {
            if done[0] == self.fails_at {
                return Err(Error::malformed("as it should"));
            }
            *state += 1;
            shared.push(done);
            Ok(())
        }
    }

    const NEVER: u64 = u64::MAX;

    fn squares(threads: usize, task: &Squares, ends: Result<u64>) -> Result<(Vec<u64>, Vec<[u64; 2]>)> {
        let (count, mut failure) = match ends {
            Ok(count) => (count, None),
            Err(error) => (10, Some(error)),
        };
        let mut numbers = 0..count;
        in_turn(task, vec![0; threads], Vec::new(), |_| match numbers.next() {
            Some(number) => Ok(Some(number)),
            None => failure.take().map_or(Ok(None), Err),
        })
    }

    #[test]
    fn all_items_are_finished_in_their_order() {
        for threads in [1, 2, 5] {
            for under_way_max in [0, 1, NEVER] {
                let task = Squares { fails_at: NEVER, panics_at: NEVER, under_way_max };
                let (states, shared) = squares(threads, &task, Ok(40)).unwrap();
                assert_eq!(states.iter().sum::<u64>(), 40);
                assert!(shared.iter().copied().eq((0..40).map(|i| [i, i * i])), "{shared:?}");
                assert!(squares(threads, &task, Ok(0)).unwrap().1.is_empty());
            }
        }
    }

    #[test]
    fn the_first_error_ends_it() {
        for threads in [1, 2, 5] {
            let task = Squares { fails_at: 17, panics_at: NEVER, under_way_max: NEVER };
            assert_eq!(squares(threads, &task, Ok(40)).unwrap_err().to_string(), "as it should");
            let ends = squares(threads, &task, Err(Error::malformed("no more")));
            assert_eq!(ends.unwrap_err().to_string(), "no more");
        }
    }

    #[test]
    #[should_panic = "as it should"]
    fn a_panic_goes_on_with_the_caller() {
        let task = Squares { fails_at: NEVER, panics_at: 11, under_way_max: NEVER };
        squares(3, &task, Ok(40)).unwrap();
    }

    #[test]
    #[should_panic = "as it should"]
    fn a_panic_ends_the_wait_for_more() {
        let task = Squares { fails_at: NEVER, panics_at: 0, under_way_max: NEVER };
        let mut has_come = false;
        let next = |ends: &AtomicBool| {
            while has_come && !ends.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok((!std::mem::replace(&mut has_come, true)).then_some(0))
        };
        in_turn(&task, vec![0; 3], Vec::new(), next).unwrap();
    }
}
