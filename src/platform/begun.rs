//! Tasks that several workers do at once, whose events are delivered in the order of the tasks.

use std::collections::{BTreeSet, VecDeque};

/// The tasks that were begun and are not delivered, with their events.
#[derive(Debug)]
pub(super) struct Begun<E>(VecDeque<Task<E>>);

#[derive(Debug)]
struct Task<E> {
    id: u64,
    events: Vec<E>,
    is_done: bool,
}

impl<E> Default for Begun<E> {
    fn default() -> Self {
        Self(VecDeque::new())
    }
}

impl<E> Begun<E> {
    /// Returns the number of tasks.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Adds a task behind the others.
    pub(super) fn begin(&mut self, id: u64) {
        self.0.push_back(Task { id, events: Vec::new(), is_done: false });
    }

    /// Adds an event of a task, which may be its last one.
    pub(super) fn add(&mut self, id: u64, event: E, is_last: bool) {
        if let Some(task) = self.0.iter_mut().find(|task| task.id == id) {
            task.events.push(event);
            task.is_done |= is_last;
        }
    }

    /// Removes tasks with their events.
    pub(super) fn remove(&mut self, ids: &BTreeSet<u64>) {
        self.0.retain(|task| !ids.contains(&task.id));
    }

    /// Takes out the tasks that are done, up to the first one that is not. Returns their events in
    /// order, each with its task.
    pub(super) fn take_ready(&mut self) -> Vec<(u64, E)> {
        let mut ready = Vec::new();
        while self.0.front().is_some_and(|task| task.is_done) {
            if let Some(task) = self.0.pop_front() {
                ready.extend(task.events.into_iter().map(|event| (task.id, event)));
            }
        }
        ready
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_come_in_the_order_of_the_tasks() {
        let mut begun = Begun::default();
        for id in [4, 5, 6, 7] {
            begun.begin(id);
        }
        begun.add(5, "b", true);
        begun.add(4, "a 1", false);
        assert!(begun.take_ready().is_empty() && begun.len() == 4);
        begun.add(4, "a 2", true);
        assert_eq!(begun.take_ready(), [(4, "a 1"), (4, "a 2"), (5, "b")]);
        begun.add(7, "d", true);
        begun.add(9, "of no task", true);
        assert!(begun.take_ready().is_empty());
        // A task that is stopped no longer holds up those behind it.
        begun.remove(&[6].into());
        assert_eq!(begun.take_ready(), [(7, "d")]);
        assert_eq!(begun.len(), 0);
    }
}
