//! Long work without the interpreter's lock, on all cores.

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
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
