//! The editing of a path by hand: its control points and edits.

use crate::ui::out::Out;
use crate::ui::text;
use glam::DVec2;
use segue_motion::path::{
    ArcLengthPath, FitOptions, GroundSpline, PathEdit, PathEditError, Pins, SplineEnds, drawn_path,
};
use segue_session::LabId;
use segue_session::{Command, Key, List, Pane, PathFacts, Session, Value, spline_ends};
use segue_text::{Message, ToMessage};

/// The state of the editing between frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathHand {
    /// The chosen control point, for keys and buttons.
    pub(crate) chosen: Option<usize>,
    /// The control point under the pointer.
    pub(crate) hovered: Option<usize>,
    /// The point on the path under the pointer, and its parameter.
    pub(crate) place: Option<(DVec2, f64)>,
    /// The control point that is dragged.
    pub(crate) held: Option<DraggedPoint>,
    /// The reason why the last edit was refused.
    pub(crate) said: Option<Message>,
    /// The camera values set when the whole path was framed; `None` before.
    pub(crate) framed: Option<Vec<(Key, Value)>>,
}

/// A control point that is dragged.
#[derive(Clone, Debug)]
pub(crate) struct DraggedPoint {
    /// Its index.
    pub(crate) index: usize,
    /// The pane in which the drag began.
    pub(crate) pane: usize,
    /// The path when the drag began.
    pub(crate) start: GroundSpline,
    /// The offset from the pressed position to the point, metres.
    pub(crate) grip: DVec2,
}

/// The greatest distance between the ends of a loop, as a share of its length.
const LOOP_SHARE: f64 = 0.12;
/// The smoothing of a drawn curve, about the unsteadiness of a hand.
const DRAWN_SMOOTHING: f64 = 1e-3;
/// The least number of control points of a loop.
const LOOP_POINTS: usize = 6;

impl PathHand {
    /// Edits a path, or stores why that is not possible. The caller ends the step of undo.
    pub(crate) fn edit(
        &mut self,
        from: &GroundSpline,
        edit: &PathEdit,
        session: &Session,
        out: &mut Out,
    ) -> bool {
        let edited = from.edited(edit, pins(session));
        self.take(edited, session, out)
    }

    /// Edits a path, as one step of undo.
    pub(crate) fn edit_once(
        &mut self,
        from: &GroundSpline,
        edit: &PathEdit,
        session: &Session,
        out: &mut Out,
    ) -> bool {
        let done = self.edit(from, edit, session, out);
        out.commands.push(Command::Settle);
        done
    }

    fn take(
        &mut self,
        edited: Result<GroundSpline, PathEditError>,
        session: &Session,
        out: &mut Out,
    ) -> bool {
        // The path is rounded as in the link.
        let edited = edited.and_then(|spline| spline.rounded()).and_then(ArcLengthPath::new);
        match edited {
            Ok(curve) => {
                if session.params().edited_path() != Some(curve.spline()) {
                    out.set(Key::Path, List::EditedPath(Some(curve.spline().clone())).into());
                }
                self.said = None;
                true
            }
            Err(error) => {
                self.said = Some(error.to_sentence());
                false
            }
        }
    }

    /// Makes a path of a drawn line.
    pub(crate) fn take_drawn(&mut self, drawn: &[DVec2], session: &Session, out: &mut Out) {
        let length: f64 = drawn.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let gap =
            drawn.first().zip(drawn.last()).map_or(0.0, |(first, last)| first.distance(*last));
        let is_loop = gap < LOOP_SHARE * length;
        let wanted = session.params().number(Key::ControlPoints) as usize;
        let options = FitOptions {
            control_points: if is_loop { wanted.max(LOOP_POINTS) } else { wanted },
            smoothing: DRAWN_SMOOTHING,
            pin_ends: true,
            ends: spline_ends(session.params()),
        };
        let path = drawn_path(drawn, &options).and_then(|path| {
            if is_loop { path.edited(&PathEdit::Close, Pins::default()) } else { Ok(path) }
        });
        if self.take(path, session, out) {
            self.chosen = None;
        }
        out.commands.push(Command::Settle);
    }

    /// Adds a control point: behind the chosen one, or in the widest gap.
    pub(crate) fn add_point(&mut self, path: &PathFacts, session: &Session, out: &mut Out) {
        let spline = path.curve.spline();
        let ends = spline.with_ends(SplineEnds::Clamped).greville();
        let gaps = || ends.windows(2).enumerate();
        let widest = gaps()
            .max_by(|a, b| (a.1[1] - a.1[0]).total_cmp(&(b.1[1] - b.1[0])))
            .map_or(0, |(gap, _)| gap);
        let gap = self.chosen.filter(|&chosen| chosen + 1 < ends.len()).unwrap_or(widest);
        // If a knot is in the middle, the point is added beside it.
        let middle = |share: f64| ends[gap] + (ends[gap + 1] - ends[gap]) * share;
        for share in [0.5, 0.4, 0.6, 0.3, 0.7] {
            if self.edit(spline, &PathEdit::Insert { at: middle(share) }, session, out) {
                self.chosen = Some(gap + 1);
                break;
            }
        }
        out.commands.push(Command::Settle);
    }

    /// Removes the chosen control point.
    pub(crate) fn remove_point(&mut self, path: &PathFacts, session: &Session, out: &mut Out) {
        let Some(index) = self.chosen else {
            self.said = Some(text::CHOOSE_POINT.into());
            return;
        };
        let spline = path.curve.spline();
        if self.edit_once(spline, &PathEdit::Remove { index }, session, out) {
            self.chosen = Some(index.min(spline.points().len().saturating_sub(2)));
        }
    }
}

/// Returns which ends are pinned.
fn pins(session: &Session) -> Pins {
    Pins { start: session.params().is_on(Key::PinStart), end: session.params().is_on(Key::PinEnd) }
}

/// Returns the path of a pane, if it can be edited: not while the lab has no result.
pub(crate) fn path_of<'a>(session: &Session, pane: &'a Pane) -> Option<&'a PathFacts> {
    let is_open = session.params().lab() == LabId::Path && pane.problem.is_none();
    pane.outcome.as_ref()?.path().map(|fact| &**fact).filter(|_| is_open)
}

/// Returns a place snapped to the grid, if there is one.
pub(crate) fn snapped(place: DVec2, session: &Session) -> DVec2 {
    let grid = session.params().number(Key::PathGrid);
    if grid > 0.0 { (place / grid).round() * grid } else { place }
}
