//! Work that threads share.

use spmesh_delaunay::parallel::map;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

const THREADS: [usize; 3] = [1, 2, 5];

fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap()
}

#[test]
fn results_have_the_order_of_the_items() {
    for count in THREADS {
        for len in [0, 1, 100u64] {
            // Early items take longest.
            let work = |item: u64| {
                Ok::<_, String>((0..(len - item) * 1000).fold(item, |a, i| std::hint::black_box(a ^ i ^ i)))
            };
            let results = map(threads(count), (0..len).collect::<Vec<_>>(), work).unwrap();
            assert_eq!(results, (0..len).collect::<Vec<_>>());
        }
    }
}

#[test]
fn items_may_be_changed_in_place() {
    for count in THREADS {
        let mut items = [1, 2, 3, 4];
        let add = |item: &mut i32| {
            *item += 1;
            Ok::<(), String>(())
        };
        map(threads(count), &mut items, add).unwrap();
        assert_eq!(items, [2, 3, 4, 5]);
    }
}

#[test]
fn the_first_error_counts_and_ends_the_work() {
    for count in THREADS {
        let begun = AtomicUsize::new(0);
        let work = |item: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            if item % 10 == 7 { Err(format!("item {item}")) } else { Ok(()) }
        };
        let error = map(threads(count), 0..10_000, work).unwrap_err();
        assert_eq!(error, "item 7");
        if count == 1 {
            assert_eq!(begun.into_inner(), 8);
        }
    }
}

#[test]
fn a_panic_resumes_with_its_payload() {
    for count in THREADS {
        let work = |item: usize| {
            assert!(item != 3, "of the test");
            Ok::<(), String>(())
        };
        let panic = catch_unwind(AssertUnwindSafe(|| map(threads(count), 0..8, work))).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"of the test"));
    }
}
