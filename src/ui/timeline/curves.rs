//! The curves of a joint, cached, and the menu that chooses them.

use super::curve_values::{CurveValues, Extremes};
use crate::ui::kit::{self, MenuItem, Part};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::palette_of;
use eframe::egui::{self, RectAlign, Ui};
use segue_motion::clip::Motion;
use segue_motion::skeleton::Role;
use segue_session::choices::{self, Selected as _};
use segue_session::{
    Command, Key, List, MAX_MORE_CURVES, Outcome, Params, PlacedClip, RegistrationFacts, Session,
    Slot, Value, curve_kind, joint_of,
};
use segue_text::Message;
use std::sync::Arc;

/// The curves of the chosen joint for all panes, kept until a result or the choice changes.
#[derive(Debug, Default)]
pub(crate) struct CurveCache {
    panes: Vec<(Message, Arc<Outcome>)>,
    what: Option<Plotted>,
    /// A plot for each quantity.
    pub(super) plots: Vec<Plot>,
    /// The number of curves refined so far.
    refinements: u64,
}

/// The choice of curves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plotted {
    pub(super) joint: String,
    pub(super) quantities: Vec<choices::Curve>,
    pub(super) of: choices::CurvesOf,
}

/// The curves of one quantity.
#[derive(Debug)]
pub(super) struct Plot {
    pub(super) quantity: choices::Curve,
    pub(super) lines: Vec<Curve>,
}

/// One curve.
#[derive(Debug)]
pub(super) struct Curve {
    pub(super) of: CurveOf,
    pub(super) points: Vec<[f64; 2]>,
    /// Its values, where the points are not all of them.
    pub(super) values: Option<CurveValues>,
    /// The points of a long curve that are to take the place of samples.
    extremes: Option<Extremes>,
}

/// The owner of a curve.
#[derive(Debug)]
pub(super) enum CurveOf {
    /// One of the clips that a result was made from.
    Source(Part),
    /// The result of a pane, by its number and its name.
    Pane(usize, Message),
}

/// The number of frames of a long curve that are computed at once, about a millisecond.
const FRAMES_AT_ONCE: usize = 1_000;

impl Curve {
    /// Returns a curve; a long one consists of samples until [`CurveCache::work`] has refined it.
    /// `values` are `None` where the motion lacks the joint: the curve then has no points.
    fn new(of: CurveOf, values: Option<CurveValues>) -> Self {
        let points = values.as_ref().map(CurveValues::sampled).unwrap_or_default();
        let values = values.filter(CurveValues::is_long);
        Self { of, points, extremes: values.as_ref().map(CurveValues::extremes), values }
    }
}

impl CurveOf {
    /// Returns its name beside the plot.
    pub(super) fn name(&self) -> Text<'_> {
        match self {
            Self::Source(part) => Text::Data(part.letter()),
            Self::Pane(_, name) => name.into(),
        }
    }
}

impl Plotted {
    /// Returns the choice of the parameters.
    pub(super) fn of(params: &Params) -> Self {
        Self {
            joint: params.text(Key::Joint).to_owned(),
            quantities: params.plotted_curves(),
            of: params.choice(),
        }
    }
}

impl CurveCache {
    /// Recomputes the curves if a result or the choice has changed.
    pub(super) fn update(
        &mut self,
        main: &Arc<Outcome>,
        panes: &[(Message, &Arc<Outcome>)],
        what: &Plotted,
    ) {
        let shown = panes.iter().map(|(name, outcome)| (name, *outcome));
        let known = self.panes.iter().map(|(name, outcome)| (name, outcome));
        let same = shown.len() == known.len()
            && shown.zip(known).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(a.1, b.1));
        if same && self.what.as_ref() == Some(what) {
            return;
        }
        self.panes =
            panes.iter().map(|(name, outcome)| (name.clone(), Arc::clone(outcome))).collect();
        self.what = Some(what.clone());
        let plot = |&quantity| Plot { quantity, lines: lines(main, panes, what, quantity) };
        self.plots = what.quantities.iter().map(plot).collect();
    }

    /// Returns whether long curves are still made of samples.
    pub(crate) fn is_coarse(&self) -> bool {
        self.plots.iter().flat_map(|plot| &plot.lines).any(|line| line.extremes.is_some())
    }

    /// Refines a part of the first coarse curve, so that no peak is missing; returns whether any is
    /// left.
    pub(crate) fn work(&mut self) -> bool {
        let mut lines = self.plots.iter_mut().flat_map(|plot| &mut plot.lines);
        let Some(line) = lines.find(|line| line.extremes.is_some()) else { return false };
        if let (Some(values), Some(extremes)) = (&line.values, &mut line.extremes)
            && let Some(points) = extremes.advance(values, FRAMES_AT_ONCE)
        {
            (line.points, line.extremes) = (points, None);
            self.refinements += 1;
        }
        self.is_coarse()
    }

    /// Returns the number of curves refined so far: when it changes, curves have to be drawn again.
    pub(crate) fn refinements(&self) -> u64 {
        self.refinements
    }
}

/// Returns the curves of one quantity.
fn lines(
    main: &Outcome,
    panes: &[(Message, &Arc<Outcome>)],
    Plotted { joint, of, .. }: &Plotted,
    quantity: choices::Curve,
) -> Vec<Curve> {
    let mut lines = Vec::new();
    let end = main.duration_secs();
    // A result without sources has its own curve alone.
    let has_sources = !main.sources.is_empty();
    let sources = main.sources.iter().filter(|_| *of != choices::CurvesOf::Result);
    for source in sources {
        let part = if source.slot == Slot::A { Part::A } else { Part::B };
        if let Some(registered) = main.registered() {
            let values = registered_values(source, registered, joint, quantity);
            lines.push(Curve::new(CurveOf::Source(part), values));
            continue;
        }
        // Sources are shown where they can be compared with the result.
        let window = main.transition.map_or(0.0..end, |transition| {
            let margin = (transition.end_secs - transition.start_secs).max(0.25);
            transition.start_secs - margin..transition.end_secs + margin
        });
        let values = values(&source.motion, joint, quantity, source.starts_at_secs);
        let values = values.map(|values| {
            values.within(|secs| window.contains(&secs) && (0.0..=end).contains(&secs))
        });
        lines.push(Curve::new(CurveOf::Source(part), values));
    }
    let shows_results = *of != choices::CurvesOf::Sources || !has_sources;
    let results = panes.iter().enumerate().filter(|_| shows_results);
    lines.extend(results.map(|(index, (name, outcome))| {
        let values = values(&outcome.motion, joint, quantity, 0.0);
        Curve::new(CurveOf::Pane(index, name.clone()), values)
    }));
    lines
}

/// Returns the values of a joint, in the time of a result that the motion begins in at that time;
/// `None` without the joint.
fn values(
    motion: &Arc<Motion>,
    joint: &str,
    quantity: choices::Curve,
    starts_at_secs: f64,
) -> Option<CurveValues> {
    let joint = joint_of(motion, joint)?;
    Some(CurveValues::of_motion(motion, joint, curve_kind(quantity), starts_at_secs))
}

/// Returns the values of a source in the result's time: those in the frames that the result is made
/// of.
fn registered_values(
    source: &PlacedClip,
    registered: &RegistrationFacts,
    joint: &str,
    quantity: choices::Curve,
) -> Option<CurveValues> {
    let joint = joint_of(&source.motion, joint)?;
    let (fps, of) = (registered.map.fps(), usize::from(source.slot == Slot::B));
    let own = registered.frame_pairs.iter().map(|frame_pair| frame_pair.frames[of]);
    let own = own.map(|frame| (frame > -0.5).then(|| frame.round() as usize)).collect();
    Some(CurveValues::of_frames(&source.motion, joint, curve_kind(quantity), fps, own))
}

/// Returns the unit of a curve.
pub(super) fn unit_of(quantity: choices::Curve) -> &'static str {
    match quantity {
        choices::Curve::Height | choices::Curve::Distance => "m",
        choices::Curve::Angle => "°",
        choices::Curve::Turn => "°/s",
        choices::Curve::Speed => "m/s",
    }
}

/// Draws the menu on the caption: which curves of which joint, and of which motions.
pub(super) fn curve_menu_ui(
    session: &Session,
    outcome: &Outcome,
    row: &egui::Response,
    out: &mut Out,
    ui: &mut Ui,
) {
    let (params, palette) = (session.params(), palette_of(ui));
    let rect = egui::Rect::from_min_max(
        egui::pos2(row.rect.right() - 220.0, row.rect.top()),
        row.rect.max,
    );
    let opener = ui
        .interact(rect, ui.scope_id().with("curve menu"), egui::Sense::click())
        .on_hover_cursor(egui::CursorIcon::PointingHand);
    // Behind the caption.
    let mark = egui::vec2(12.0, 12.0);
    let at = egui::pos2(rect.right() + 8.0, rect.center().y);
    let ink = if opener.hovered() || opener.has_focus() { palette.text } else { palette.muted };
    let at = egui::Rect::from_center_size(at, mark);
    kit::paint_icon(kit::Icon::ChevronDown, at, ink, ui.painter());
    let name = say(text::CURVES, ui);
    kit::describe(&opener, &egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    kit::switches_menu_ui(&opener, RectAlign::TOP_END, |ui| {
        let shown = params.plotted_curves();
        for &quantity in choices::Curve::ALL {
            let chosen = shown.contains(&quantity);
            let can = if chosen { shown.len() > 1 } else { shown.len() <= MAX_MORE_CURVES };
            let text = Word::new(quantity.label()).into();
            if item_ui(text, chosen, can, ui) {
                toggle(quantity, shown.clone(), out);
            }
        }
        if !outcome.sources.is_empty() {
            kit::menu_line_ui(ui);
            for &of in choices::CurvesOf::ALL {
                let chosen = params.choice::<choices::CurvesOf>() == of;
                if item_ui(Word::new(of.label()).into(), chosen, true, ui) {
                    out.set_once(Key::CurvesOf, of.into());
                }
            }
        }
        kit::menu_line_ui(ui);
        egui::ScrollArea::vertical().max_height(240.0).show(ui, |ui| {
            let chosen = joint_of(&outcome.motion, params.text(Key::Joint));
            let plan = outcome.motion.roles().body_plan();
            for role in Role::ALL {
                let Some(joint) = outcome.motion.roles().get(role) else {
                    continue;
                };
                if item_ui(Word::new(role.name_in(plan)).into(), chosen == Some(joint), true, ui) {
                    out.set_once(Key::Joint, Value::Text(role.name().to_owned()));
                }
            }
        });
    });
}

fn item_ui(text: Text<'_>, chosen: bool, can: bool, ui: &mut Ui) -> bool {
    let item = MenuItem { text, chosen: Some(chosen), ..MenuItem::default() };
    ui.add_enabled_ui(can, |ui| kit::menu_item_ui(item, ui).clicked()).inner
}

/// Adds a quantity to those that are plotted, or takes it away.
fn toggle(quantity: choices::Curve, mut shown: Vec<choices::Curve>, out: &mut Out) {
    if shown.contains(&quantity) {
        shown.retain(|other| *other != quantity);
    } else {
        shown.push(quantity);
    }
    if let [first, more @ ..] = &shown[..] {
        out.commands.push(Command::Set(vec![
            (Key::Curve, (*first).into()),
            (Key::MoreCurves, List::Curves(more.to_vec()).into()),
        ]));
        out.commands.push(Command::Settle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::timeline::tracks::named_outcomes;

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
        let what = Plotted {
            joint: "right foot".to_owned(),
            quantities: vec![choices::Curve::Angle],
            of: choices::CurvesOf::All,
        };
        cache.update(session.main_outcome().unwrap(), &panes, &what);
        let lines = &cache.plots[0].lines;
        let names: Vec<_> = lines.iter().map(|line| line.of.name().english()).collect();
        assert_eq!(names, ["A", "B", "inertialize", "dissolve, smooth", "dead blend"]);
        let results = &lines[2..];
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

    #[test]
    fn curves_have_the_values_of_their_clips() {
        let mut session = Session::new();
        let link = "lab=view&a=walk&curve=height&more_curves=distance,speed,height&joint=left shin";
        session.apply(Command::OpenLink(link.into())).unwrap();
        while session.work() {}
        let outcome = session.main_outcome().unwrap();
        let mut cache = CurveCache::default();
        cache.update(outcome, &named_outcomes(&session), &Plotted::of(session.params()));
        let shown: Vec<_> = cache.plots.iter().map(|plot| plot.quantity.word()).collect();
        assert_eq!(shown, ["height", "distance", "speed"], "each once");
        let (clip, knee) = (outcome.motion.clip(), outcome.motion.roles().get(Role::LeftShin));
        let at = |frame: usize| clip.world_pose(frame).positions[knee.unwrap()];
        for frame in [0, 37, 120] {
            let value = |plot: usize| cache.plots[plot].lines[0].points[frame];
            assert_eq!(value(0), [frame as f64 / 60.0, f64::from(at(frame).y)]);
            let way = (at(frame) - at(0)).with_y(0.0).length();
            assert_eq!(value(1)[1], f64::from(way));
        }
    }

    #[test]
    fn curves_of_the_sources_or_of_the_result_are_left_out() {
        let mut session = Session::new();
        let mut cache = CurveCache::default();
        let mut names = |link: &str| {
            session.apply(Command::OpenLink(link.into())).unwrap();
            while session.work() {}
            let outcome = session.main_outcome().unwrap();
            cache.update(outcome, &named_outcomes(&session), &Plotted::of(session.params()));
            let names =
                cache.plots[0].lines.iter().map(|line| line.of.name().english().into_owned());
            names.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(names("lab=blend"), "A B result");
        assert_eq!(names("lab=blend&curves_of=result"), "result");
        assert_eq!(names("lab=blend&curves_of=sources"), "A B");
        assert_eq!(names("lab=view&curves_of=sources"), "result", "it has no sources");
    }
}
