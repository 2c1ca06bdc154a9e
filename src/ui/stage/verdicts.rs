//! The best and the worst pane.

use segue_session::Pane;
use segue_session::metrics::{Better, MetricId};

/// The best and the worst pane: by the velocity jump, which is seen as smooth or rough; for
/// registered clips by foot skating. For equal values the next of these numbers decides.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Verdicts {
    pub(super) best: Option<usize>,
    pub(super) worst: Option<usize>,
}

/// Returns a number of a pane's result; `None` for an earlier result, which is compared with
/// nothing.
fn value_of(pane: &Pane, id: MetricId) -> Option<f64> {
    pane.result().ok()?.outcome.metric(id)?.value
}

/// Compares all panes.
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
        .map(|id| ranking(panes, id))
        .into_iter()
        .find(|verdicts| verdicts.best.is_some())
        .unwrap_or_default()
}

/// Returns which panes have the lowest and the highest value; none where they hardly differ.
pub(super) fn ranking(panes: &[Pane], id: MetricId) -> Verdicts {
    let metric = id.row();
    // A number that only describes has no best value.
    if metric.better != Better::Lower {
        return Verdicts::default();
    }
    let values: Vec<(usize, f64)> = panes
        .iter()
        .enumerate()
        .filter_map(|(index, pane)| Some((index, value_of(pane, id)?)))
        .collect();
    let least = metric.unit.least_difference();
    let best = values.iter().copied().min_by(|x, y| x.1.total_cmp(&y.1));
    let worst = values.iter().copied().max_by(|x, y| x.1.total_cmp(&y.1));
    match (best, worst) {
        (Some(best), Some(worst)) if worst.1 - best.1 >= least => {
            Verdicts { best: Some(best.0), worst: Some(worst.0) }
        }
        _ => Verdicts::default(),
    }
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
