//! The best and the worst pane.

use segue_session::Pane;
use segue_session::metrics::{Ends, MetricId, MetricRow};

/// The best and the worst pane.
pub(super) type Verdicts = Ends;

/// Returns a number of a pane's result; `None` for an earlier result, which is compared with
/// nothing.
fn value_of(pane: &Pane, id: MetricId) -> Option<f64> {
    pane.result().ok()?.outcome.metric(id)?.value
}

/// Compares all panes: by the velocity jump, which is seen as smooth or rough; for registered clips
/// by foot skating. Where no difference can be seen, the next of these numbers decides.
pub(super) fn verdicts(panes: &[Pane]) -> Verdicts {
    let is_registered = panes
        .iter()
        .filter_map(|pane| pane.outcome.as_ref())
        .any(|outcome| outcome.registered().is_some());
    let looked_at = if is_registered {
        [MetricId::Skating, MetricId::VelocityJump, MetricId::PoseJump]
    } else {
        [MetricId::VelocityJump, MetricId::PoseJump, MetricId::Skating]
    };
    looked_at
        .map(|id| ends(panes, id.row()))
        .into_iter()
        .find(|ends| *ends != Ends::default())
        .unwrap_or_default()
}

/// Returns the panes whose number is seen to be the best and the worst.
pub(super) fn ends(panes: &[Pane], row: &MetricRow) -> Ends {
    let values: Vec<Option<f64>> = panes.iter().map(|pane| value_of(pane, row.id)).collect();
    row.ends(&values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::{Command, Session};

    #[test]
    fn panes_are_ranked_by_the_metrics_of_every_lab() {
        for (link, best, worst) in [
            ("compare=blend_window:30,15,10", 0, 2),
            ("lab=transition&compare=mistake:none,hemisphere", 0, 1),
            (
                "lab=loop&a=walk_left&loop_from=0.3&loop_to=1.2&compare=loop_method:exact,linear",
                0,
                1,
            ),
            ("lab=register&compare=warp_with:registered,plain", 0, 1),
        ] {
            let mut session = Session::new();
            session.apply(Command::OpenLink(link.into())).unwrap();
            while session.work() {}
            let found = verdicts(session.panes());
            assert_eq!((found.best, found.worst), (Some(best), Some(worst)), "{link}");
        }
    }
}
