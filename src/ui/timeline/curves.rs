//! The curves of a joint, cached, and the menu that chooses them.

use crate::ui::kit::{self, MenuItem, Part};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::Out;
use crate::ui::text;
use eframe::egui::{self, RectAlign, Ui};
use segue_motion::clip::{Motion, joint_curve};
use segue_motion::skeleton::Role;
use segue_session::choices;
use segue_session::{
    Key, Kind, Outcome, PlacedClip, RegistrationFacts, Slot, Value, curve_kind, joint_of,
};
use segue_text::Message;
use std::sync::Arc;

/// The curves of the chosen joint for all panes, kept until a result or the choice changes.
#[derive(Debug, Default)]
pub(crate) struct CurveCache {
    panes: Vec<(Message, Arc<Outcome>)>,
    what: (String, Option<choices::Curve>),
    pub(super) lines: Vec<Curve>,
}

/// One curve.
#[derive(Debug)]
pub(super) struct Curve {
    pub(super) of: CurveOf,
    pub(super) points: Vec<[f64; 2]>,
}

/// The owner of a curve.
#[derive(Debug)]
pub(super) enum CurveOf {
    /// One of the clips that a result was made from.
    Source(Part),
    /// The result of a pane, by its number and its name.
    Pane(usize, Message),
}

/// The greatest number of points of a curve: no screen shows more.
const MAX_CURVE_POINTS: usize = 900;

impl CurveOf {
    /// Returns its name beside the plot.
    pub(super) fn name(&self) -> Text<'_> {
        match self {
            Self::Source(part) => Text::Data(part.letter()),
            Self::Pane(_, name) => name.into(),
        }
    }
}

impl CurveCache {
    /// Recomputes the curves if a result or the choice has changed.
    pub(super) fn update(
        &mut self,
        main: &Arc<Outcome>,
        panes: &[(Message, &Arc<Outcome>)],
        joint: &str,
        quantity: choices::Curve,
    ) {
        let shown = panes.iter().map(|(name, outcome)| (name, *outcome));
        let known = self.panes.iter().map(|(name, outcome)| (name, outcome));
        let same = shown.len() == known.len()
            && shown.zip(known).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(a.1, b.1));
        if same && self.what.0 == joint && self.what.1 == Some(quantity) {
            return;
        }
        self.panes =
            panes.iter().map(|(name, outcome)| (name.clone(), Arc::clone(outcome))).collect();
        self.what = (joint.to_owned(), Some(quantity));
        self.lines.clear();
        let end = main.duration_secs();
        for source in &main.sources {
            let part = if source.slot == Slot::A { Part::A } else { Part::B };
            if let Some(registered) = main.registered() {
                self.lines.push(Curve {
                    of: CurveOf::Source(part),
                    points: registered_curve(source, registered, joint, quantity),
                });
                continue;
            }
            // Sources are shown where they can be compared with the result.
            let window = main.transition.map_or(0.0..end, |transition| {
                let margin = (transition.end_secs - transition.start_secs).max(0.25);
                transition.start_secs - margin..transition.end_secs + margin
            });
            let mut points = curve(&source.motion, joint, quantity, source.starts_at_secs);
            points.retain(|point| window.contains(&point[0]) && (0.0..=end).contains(&point[0]));
            self.lines.push(Curve { of: CurveOf::Source(part), points });
        }
        let results = panes.iter().enumerate().map(|(index, (name, outcome))| Curve {
            of: CurveOf::Pane(index, name.clone()),
            points: curve(&outcome.motion, joint, quantity, 0.0),
        });
        self.lines.extend(results);
    }
}

/// Returns the curve of a joint, in the time of a result that the motion begins in at that time.
fn curve(
    motion: &Motion,
    joint: &str,
    quantity: choices::Curve,
    starts_at_secs: f64,
) -> Vec<[f64; 2]> {
    let Some(joint) = joint_of(motion, joint) else {
        return Vec::new();
    };
    let values = joint_curve(motion.clip(), joint, curve_kind(quantity));
    let stride = values.len().div_ceil(MAX_CURVE_POINTS).max(1);
    let fps = motion.clip().fps();
    values
        .iter()
        .enumerate()
        .step_by(stride)
        .map(|(frame, &value)| [starts_at_secs + frame as f64 / fps, f64::from(value)])
        .collect()
}

/// Returns the curve of a source in the result's time: its values in the frames that the result is
/// made of.
fn registered_curve(
    source: &PlacedClip,
    registered: &RegistrationFacts,
    joint: &str,
    quantity: choices::Curve,
) -> Vec<[f64; 2]> {
    let Some(joint) = joint_of(&source.motion, joint) else {
        return Vec::new();
    };
    let values = joint_curve(source.motion.clip(), joint, curve_kind(quantity));
    let (fps, clip) = (registered.map.fps(), usize::from(source.slot == Slot::B));
    let stride = registered.frame_pairs.len().div_ceil(MAX_CURVE_POINTS).max(1);
    let frame_pairs = registered.frame_pairs.iter().enumerate().step_by(stride);
    frame_pairs
        .filter(|(_, frame_pair)| frame_pair.frames[clip] > -0.5)
        .filter_map(|(frame, frame_pair)| {
            let value = values.get(frame_pair.frames[clip].round() as usize)?;
            Some([frame as f64 / fps, f64::from(*value)])
        })
        .collect()
}

/// Returns the unit of a curve.
pub(super) fn unit_of(quantity: choices::Curve) -> &'static str {
    match quantity {
        choices::Curve::Height => "m",
        choices::Curve::Angle => "°",
        choices::Curve::Turn => "°/s",
        choices::Curve::Speed => "m/s",
    }
}

/// Draws the menu on the caption: which joint, and which curve of it.
pub(super) fn curve_menu_ui(outcome: &Outcome, row: &egui::Response, out: &mut Out, ui: &mut Ui) {
    let rect = egui::Rect::from_min_max(
        egui::pos2(row.rect.right() - 220.0, row.rect.top()),
        row.rect.max,
    );
    let opener = ui.interact(rect, ui.scope_id().with("curve menu"), egui::Sense::click());
    let name = say(text::CURVES, ui);
    kit::describe(&opener, &egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    kit::menu_ui(&opener, RectAlign::TOP_END, |ui| {
        if let Kind::Choice(choices) = Key::Curve.param().kind {
            for choice in choices {
                let text = Word::new(choice.label).into();
                if kit::menu_item_ui(MenuItem { text, ..MenuItem::default() }, ui).clicked() {
                    out.set_once(Key::Curve, Value::Choice(choice.key));
                }
            }
        }
        kit::menu_line_ui(ui);
        egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for role in
                Role::ALL.into_iter().filter(|&role| outcome.motion.roles().get(role).is_some())
            {
                let text = Word::new(role.name()).into();
                if kit::menu_item_ui(MenuItem { text, ..MenuItem::default() }, ui).clicked() {
                    out.set_once(Key::Joint, Value::Text(role.name().to_owned()));
                }
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::timeline::tracks::named_outcomes;
    use segue_session::{Command, Session};

    #[test]
    fn curves_of_all_panes_share_the_plot() {
        let mut session = Session::new();
        session
            .apply(Command::OpenLink(
                "lab=transition&compare=method:inertialize,smooth,dead".into(),
            ))
            .unwrap();
        while session.work() {}
        let panes = named_outcomes(&session);
        let mut cache = CurveCache::default();
        cache.update(session.main_outcome().unwrap(), &panes, "right foot", choices::Curve::Angle);
        let names: Vec<_> = cache.lines.iter().map(|line| line.of.name().english()).collect();
        assert_eq!(names, ["A", "B", "inertialize", "dissolve, smooth", "dead blend"]);
        let results = &cache.lines[2..];
        let length = |line: &Curve| line.points.len();
        assert!(results.iter().all(|line| length(line) > 100));
        // They differ in the transition, and not before.
        assert_eq!(results[0].points[..20], results[1].points[..20]);
        assert!(
            results[0]
                .points
                .iter()
                .zip(&results[1].points)
                .any(|(a, b)| (a[1] - b[1]).abs() > 1.0)
        );
    }
}
