//! A cache of results that panes request, and that are computed in slices.

use std::ops::ControlFlow;

/// Results by what they are made of. Those that no pane requests any more are dropped, as is their
/// work.
#[derive(Debug)]
pub(super) struct RequestCache<Of, Work, Made> {
    known: Vec<Entry<Of, Made>>,
    under_way: Vec<Entry<Of, Work>>,
    /// Whether a result is finished that was not there when it was requested.
    is_ready: bool,
}

/// The outcome of a slice of work.
#[derive(Debug)]
pub(super) enum Step<Work, Made> {
    /// There is more to do.
    On(Work),
    /// There is nothing to do until a worker answers.
    Waits(Work),
    /// The result.
    Done(Made),
}

impl<Work, Made> From<ControlFlow<Made, Work>> for Step<Work, Made> {
    fn from(flow: ControlFlow<Made, Work>) -> Self {
        match flow {
            ControlFlow::Continue(work) => Self::On(work),
            ControlFlow::Break(made) => Self::Done(made),
        }
    }
}

/// Does one slice of the first work in a list that waits for no worker; work that ends leaves the
/// list, and its result is returned. `None` where there is no work, or all of it waits.
pub(super) fn work_on_first<Work, Made>(
    all: &mut Vec<Work>,
    mut slice: impl FnMut(Work) -> Step<Work, Made>,
) -> Option<ControlFlow<Made>> {
    for at in 0..all.len() {
        match slice(all.remove(at)) {
            Step::On(work) => {
                all.insert(at, work);
                return Some(ControlFlow::Continue(()));
            }
            Step::Waits(work) => all.insert(at, work),
            Step::Done(made) => return Some(ControlFlow::Break(made)),
        }
    }
    None
}

#[derive(Debug)]
struct Entry<Of, T> {
    is_wanted: bool,
    of: Of,
    content: T,
}

impl<Of, Work, Made> Default for RequestCache<Of, Work, Made> {
    fn default() -> Self {
        Self { known: Vec::new(), under_way: Vec::new(), is_ready: false }
    }
}

/// Returns the first entry that `is_it` selects, after noting that it is requested.
fn wanted<Of, T>(
    entries: &mut [Entry<Of, T>],
    is_it: impl Fn(&Of, &T) -> bool,
) -> Option<&mut Entry<Of, T>> {
    let entry = entries.iter_mut().find(|entry| is_it(&entry.of, &entry.content))?;
    entry.is_wanted = true;
    Some(entry)
}

impl<Of, Work, Made> RequestCache<Of, Work, Made> {
    /// Requests a result, and returns it if it is known.
    pub(super) fn request(&mut self, is_it: impl Fn(&Of, &Made) -> bool) -> Option<&Made> {
        wanted(&mut self.known, is_it).map(|entry| &entry.content)
    }

    /// Requests a result, and returns whether it is being computed.
    pub(super) fn is_under_way(&mut self, is_it: impl Fn(&Of) -> bool) -> bool {
        wanted(&mut self.under_way, |of, _| is_it(of)).is_some()
    }

    /// Returns a known result without requesting it.
    pub(super) fn known(&self, is_it: impl Fn(&Of) -> bool) -> Option<&Made> {
        self.known.iter().find(|entry| is_it(&entry.of)).map(|entry| &entry.content)
    }

    /// Begins to compute a result that is requested.
    pub(super) fn begin(&mut self, of: Of, work: Work) {
        self.under_way.push(Entry { is_wanted: true, of, content: work });
    }

    /// Keeps a result that is requested.
    pub(super) fn keep(&mut self, of: Of, made: Made) {
        self.known.push(Entry { is_wanted: true, of, content: made });
    }

    /// Drops the results that were not requested since the last call, and clears the requests.
    pub(super) fn clear_requests(&mut self) {
        self.is_ready = false;
        self.known.retain(|entry| entry.is_wanted);
        self.known.iter_mut().for_each(|entry| entry.is_wanted = false);
        self.under_way.iter_mut().for_each(|entry| entry.is_wanted = false);
    }

    /// Does one slice of the first result that is requested and not known, and waits for no worker.
    /// Returns `false` if there is none.
    pub(super) fn work<S: Into<Step<Work, Made>>>(
        &mut self,
        mut slice: impl FnMut(&Of, Work) -> S,
    ) -> bool {
        self.under_way.retain(|entry| entry.is_wanted);
        let worked = work_on_first(&mut self.under_way, |Entry { is_wanted, of, content }| {
            match slice(&of, content).into() {
                Step::On(content) => Step::On(Entry { is_wanted, of, content }),
                Step::Waits(content) => Step::Waits(Entry { is_wanted, of, content }),
                Step::Done(made) => Step::Done((of, made)),
            }
        });
        let is_at_work = worked.is_some();
        if let Some((of, made)) = worked.and_then(ControlFlow::break_value) {
            self.keep(of, made);
            self.is_ready = true;
        }
        is_at_work
    }

    /// Returns the work under way, the next first, and what each is for.
    pub(super) fn under_way(&self) -> impl Iterator<Item = (&Of, &Work)> {
        self.under_way.iter().map(|entry| (&entry.of, &entry.content))
    }

    /// Returns whether a result is finished that was not there when it was requested.
    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }
}

impl<Of, Work, Made: Clone, E: Clone> RequestCache<Of, Work, Result<Made, E>> {
    /// Requests a result; `None` while it is being computed. Where it is neither known nor under
    /// way, `begin` returns the result, if that takes no longer than a frame, or the work for it.
    pub(super) fn request_or_begin(
        &mut self,
        of: Of,
        is_it: impl Fn(&Of) -> bool,
        begin: impl FnOnce(&Of) -> Result<ControlFlow<Made, Work>, E>,
    ) -> Result<Option<Made>, E> {
        if let Some(known) = self.request(|of, _| is_it(of)) {
            return known.clone().map(Some);
        }
        if self.is_under_way(is_it) {
            return Ok(None);
        }
        Ok(match begin(&of)? {
            ControlFlow::Continue(work) => {
                self.begin(of, work);
                None
            }
            ControlFlow::Break(made) => {
                self.keep(of, Ok(made.clone()));
                Some(made)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns work that takes as many slices as are left, and one to finish.
    fn slices() -> impl Fn(&u32, u32) -> ControlFlow<String, u32> + Copy {
        |of, left| match left {
            0 => ControlFlow::Break(of.to_string()),
            _ => ControlFlow::Continue(left - 1),
        }
    }

    #[test]
    fn result_is_computed_in_slices_and_kept_while_it_is_requested() {
        let (mut cache, slice) = (RequestCache::<u32, u32, String>::default(), slices());
        assert!(!cache.work(slice) && !cache.is_under_way(|&of| of == 7));
        cache.begin(7, 2);
        assert!(cache.work(slice) && cache.work(slice) && !cache.is_ready());
        assert!(cache.work(slice) && cache.is_ready() && !cache.work(slice));
        cache.clear_requests();
        assert!(!cache.is_ready());
        assert_eq!(cache.request(|&of, _| of == 7).map(String::as_str), Some("7"));
        cache.clear_requests();
        assert!(cache.known(|&of| of == 7).is_some(), "it was requested");
        cache.clear_requests();
        assert_eq!(cache.known(|&of| of == 7), None, "nothing requested it");
    }

    #[test]
    fn work_goes_on_behind_what_waits_for_a_worker() {
        let mut cache = RequestCache::<u32, u32, u32>::default();
        cache.begin(1, 0);
        cache.begin(2, 0);
        let first_waits = |of: &u32, _| if *of == 1 { Step::Waits(0) } else { Step::Done(7) };
        assert!(cache.work(first_waits) && !cache.work(first_waits));
        assert!(cache.is_under_way(|&of| of == 1) && cache.known(|&of| of == 2) == Some(&7));
    }

    #[test]
    fn work_that_is_no_longer_requested_is_dropped() {
        let (mut cache, slice) = (RequestCache::<u32, u32, String>::default(), slices());
        cache.begin(1, 5);
        cache.begin(2, 0);
        cache.clear_requests();
        assert!(cache.is_under_way(|&of| of == 2));
        assert!(cache.work(slice) && !cache.work(slice));
        assert!(cache.known(|&of| of == 2).is_some() && cache.known(|&of| of == 1).is_none());
    }

    #[test]
    fn result_that_takes_no_longer_than_a_frame_is_there_at_once() {
        let mut cache = RequestCache::<u32, u32, Result<u32, String>>::default();
        let at_once = |of: &u32| Ok(ControlFlow::Break(of + 1));
        let long = |of: &u32| Ok(ControlFlow::Continue(*of));
        let refused = |_: &u32| Err("no".to_owned());
        assert_eq!(cache.request_or_begin(1, |of| *of == 1, at_once), Ok(Some(2)));
        assert_eq!(cache.request_or_begin(1, |of| *of == 1, refused), Ok(Some(2)), "it is kept");
        assert_eq!(cache.request_or_begin(5, |of| *of == 5, refused), Err("no".to_owned()));
        assert_eq!(cache.request_or_begin(5, |of| *of == 5, long), Ok(None));
        assert_eq!(cache.request_or_begin(5, |of| *of == 5, refused), Ok(None), "it is under way");
        assert!(cache.work(|of, work| ControlFlow::Break(Ok(of + work))));
        assert_eq!(cache.request_or_begin(5, |of| *of == 5, refused), Ok(Some(10)));
    }
}
