//! The state of the presenter mode.

/// The state of the presenter mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Presenter {
    /// Whether the stage is shown alone.
    pub(crate) is_on: bool,
    /// The pane of a comparison that is shown alone; `None` for all of them.
    pub(crate) pane: Option<usize>,
    /// Whether the window was in full screen in the last frame.
    was_fullscreen: bool,
    /// The time until which the bar is shown, seconds of egui's clock.
    pub(crate) shown_until: f64,
    /// The steps requested while a lesson was being loaded; negative for back.
    pub(crate) steps_to_go: i32,
}

impl Presenter {
    /// Returns the state in which the mode begins, or is over.
    pub(crate) fn new(is_on: bool) -> Self {
        Self { is_on, ..Self::default() }
    }

    /// Records whether the window is in full screen. A browser leaves full screen on Escape without
    /// telling the page, and the mode ends with it.
    pub(crate) fn note_fullscreen(&mut self, is_fullscreen: bool) {
        if self.is_on && self.was_fullscreen && !is_fullscreen {
            self.is_on = false;
        }
        self.was_fullscreen = self.is_on && is_fullscreen;
    }

    /// Returns the pane that is shown alone, where there are several.
    pub(crate) fn pane_alone(&self, count: usize) -> Option<usize> {
        self.pane.filter(|&pane| self.is_on && count > 1 && pane < count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presenting_ends_when_the_browser_leaves_the_whole_screen() {
        let mut presenter = Presenter { is_on: true, ..Presenter::default() };
        presenter.note_fullscreen(false);
        assert!(presenter.is_on, "the browser may have refused the whole screen");
        presenter.note_fullscreen(true);
        assert!(presenter.is_on);
        presenter.note_fullscreen(false);
        assert!(!presenter.is_on);
    }
}
