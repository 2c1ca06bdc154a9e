//! The columns of the stage: one for each pane that is shown.

use crate::ui::state::{Layout, UiState};
use eframe::egui::{Rect, pos2};
use segue_session::Session;

/// Returns the panes that are shown, and the column of `place` that each has. A phone, or a
/// presenter, shows one pane at a time.
pub(super) fn shown_panes(
    session: &Session,
    place: Rect,
    layout: Layout,
    state: &UiState,
) -> Vec<(usize, Rect)> {
    let count = session.panes().len();
    let alone = (layout == Layout::Phone).then_some(state.shown_pane);
    match alone.or(state.presenter.pane_alone(count)) {
        Some(pane) => vec![(pane, place)],
        None => columns(place, count).enumerate().collect(),
    }
}

/// Returns the places of panes side by side.
fn columns(stage: Rect, count: usize) -> impl Iterator<Item = Rect> {
    let count = count.max(1);
    let width = stage.width() / count as f32;
    (0..count).map(move |index| {
        let left = stage.left() + (width * index as f32).round();
        let right = stage.left() + (width * (index + 1) as f32).round();
        Rect::from_min_max(pos2(left, stage.top()), pos2(right, stage.bottom()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn columns_fill_the_stage_without_gaps() {
        let stage = Rect::from_min_size(pos2(10.0, 5.0), vec2(1000.0, 400.0));
        let panes: Vec<Rect> = columns(stage, 3).collect();
        assert_eq!(panes[0].left(), 10.0);
        assert_eq!(panes[2].right(), 1010.0);
        assert!(panes.windows(2).all(|pair| pair[0].right() == pair[1].left()));
    }
}
