//! Recovery from panics, and distribution of work to threads.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

thread_local! {
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Records panics from now on instead of printing them.
pub fn keep_panics() {
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        let words = info.payload_as_str().unwrap_or("a panic");
        LAST_PANIC.with(|last| *last.borrow_mut() = format!("{words} ({place})"));
    }));
}

/// Runs a closure; returns its value, or the message and place of its panic.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // A session that panicked is not used again.
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| LAST_PANIC.with(|last| last.borrow().clone()))
}

/// Returns the results for all numbers below `count`, in order, computed by as many threads as the
/// machine has cores.
pub fn parallel_map<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let threads = thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        break;
                    }
                    let made = work(index);
                    if let Ok(mut result) = results[index].lock() {
                        *result = Some(made);
                    }
                }
            });
        }
    });
    results.into_iter().filter_map(|result| result.into_inner().ok().flatten()).collect()
}
