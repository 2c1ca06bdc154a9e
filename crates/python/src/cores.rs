//! Long work without the interpreter's lock, on all cores or on one.

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::RefCell;
use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The process that has imported the module.
static IMPORTED_BY: OnceLock<u32> = OnceLock::new();

/// Notes which process imports the module.
pub(crate) fn note_process() {
    IMPORTED_BY.get_or_init(process::id);
}

/// Does something without the interpreter's lock. It may use all cores, also in a process that was
/// forked, as the workers of `PyTorch`'s `DataLoader` are: such a process has none of the threads
/// of its parent, and would wait for them for ever.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| match forked_pool() {
        Some(pool) => pool.install(work),
        None => work(),
    })
}

/// Does something without the interpreter's lock, on one core: one of many pieces of work, whose
/// number is that of the cores that are to be used.
pub(crate) fn on_one_core<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    thread_local! {
        static POOL: RefCell<Option<(u32, ThreadPool)>> = const { RefCell::new(None) };
    }
    py.detach(|| {
        POOL.with_borrow_mut(|pool| {
            let own = process::id();
            // In a process that was forked, the thread of its parent's pool is missing.
            if pool.as_ref().is_none_or(|(process, _)| *process != own) {
                let made = ThreadPoolBuilder::new().num_threads(1).build().ok();
                *pool = made.map(|made| (own, made));
            }
            match pool {
                Some((_, pool)) => pool.install(work),
                None => work(),
            }
        })
    })
}

/// Returns the threads of a process that was forked; `None` in the process that has imported the
/// module, which has those that `rayon` starts by itself.
fn forked_pool() -> Option<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let own = process::id();
    if *IMPORTED_BY.get_or_init(process::id) == own {
        return None;
    }
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if pool.as_ref().is_none_or(|(process, _)| *process != own) {
        let made = ThreadPoolBuilder::new().build().ok()?;
        *pool = Some((own, Arc::new(made)));
    }
    pool.as_ref().map(|(_, pool)| Arc::clone(pool))
}
