//! Graphs and walks of the tests of the Graph lab.

use crate::Walk;
use crate::fixtures::*;

/// A graph that is built quickly.
pub(super) const SMALL: &str =
    "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=20";

pub(super) fn set(session: &mut Session, key: Key, value: Value) {
    session.apply(Command::Set(vec![(key, value)])).unwrap();
    while session.work() {}
}

pub(super) fn walk(session: &Session) -> &Arc<Walk> {
    walk_of(session, 0)
}

pub(super) fn walk_of(session: &Session, pane: usize) -> &Arc<Walk> {
    let pane = &session.panes()[pane];
    assert_eq!(pane.problem, None);
    pane.outcome.as_ref().unwrap().walk().unwrap()
}

pub(super) fn number(session: &Session, pane: usize, id: MetricId) -> f64 {
    number_of(session.panes()[pane].outcome.as_ref().unwrap(), id)
}

/// Returns the clips in the order in which they play, with the frame at which each is entered.
pub(super) fn way(walk: &Walk) -> Vec<(usize, usize)> {
    walk.passed.iter().map(|passed| (passed.stay.clip, passed.stay.from)).collect()
}

/// Asserts that each stay begins where a transition enters and ends where the next one leaves,
/// along transitions of the graph.
pub(super) fn assert_connected(walk: &Walk) {
    let jumps = walk.built.graph().jumps();
    for pair in walk.passed.windows(2) {
        let (stay, next) = (&pair[0].stay, &pair[1].stay);
        let jump = &jumps[next.jump.unwrap()];
        assert_eq!((stay.clip, stay.to), (jump.leave.clip, jump.leave.frame));
        assert_eq!((next.clip, next.from), (jump.enter.clip, jump.enter.frame));
        assert!(stay.from < stay.to && pair[0].end == pair[1].start);
        assert_eq!(
            pair[1].seam.map(|seam| [seam.leave, seam.enter]),
            Some([jump.leave, jump.enter])
        );
    }
}
