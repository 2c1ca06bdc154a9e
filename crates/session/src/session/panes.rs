//! From the library and the parameters to results: what has changed is computed again, and nothing
//! else.

use super::Session;
use super::going_round::{Glide, durations};
use crate::compare::{Compare, MAX_PANES};
use crate::labs::LabError;
use crate::labs::{Gauge, Inputs, JobKind, LabClips, MoreClip, Outcome, Slot, Source};
use crate::labs::{belongs_to, lab, preset_motion, recipe_ingredients, recipe_name, recipe_params};
use crate::library::{Entry, Origin, split_reference};
use crate::missing::dismiss_found;
use crate::motion::foot_options;
use crate::outside;
use crate::params::{Key, Kind, Params, Value};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_text::ToMessage;
use std::sync::Arc;

/// One pane of the stage: a result under one value of the compared parameter.
///
/// What is shown and what is handed on are not the same: while a result is computed, an older one
/// may stay on the stage. Whatever hands a result on (as a clip, a file, a number, a report) takes
/// it from [`Pane::result`].
#[derive(Clone, Debug, Default)]
pub struct Pane {
    /// The compared parameter and this pane's value; `None` when there is nothing to compare.
    pub variant: Option<(Key, Value)>,
    /// What is on the stage: the result, or, while that is computed, an earlier one
    /// ([`Pane::is_outdated`]). Always `None` beside a [`problem`](Self::problem).
    pub outcome: Option<Arc<Outcome>>,
    /// Why the result cannot be made: what is missing and what to do.
    pub problem: Option<LabError>,
    /// The clips that the result would have been made of, as they lie on the stage in its place.
    /// Empty where there is no problem.
    pub sources: Vec<Source>,
    /// What `outcome` was made from.
    made_from: Option<Arc<Params>>,
    standing: Standing,
    pub(super) inputs: Option<Inputs>,
    /// Where a result that goes round has got to: it lies there in the world that is shown.
    pub(super) place: Planar,
    /// A gait that has not yet the speed of the result.
    pub(super) glide: Option<Glide>,
}

/// What the outcome of a pane is to what the parameters ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Standing {
    /// It is of earlier parameters; that of the present ones is being computed.
    #[default]
    Earlier,
    /// It is of the present parameters, and not finished: its place is not found yet, or its feet
    /// are not planted.
    Draft,
    /// It is the result.
    Finished,
}

impl Standing {
    fn of(is_draft: bool) -> Self {
        if is_draft { Self::Draft } else { Self::Finished }
    }
}

/// What becomes of a pane.
pub(super) enum Answer {
    /// The result, or a draft of it.
    Made { outcome: Arc<Outcome>, is_draft: bool, inputs: Option<Inputs> },
    /// What it shows is the result of the present parameters, too, or a draft of it.
    Same { is_draft: bool },
    /// The result is being computed.
    Awaited,
    /// The result cannot be made, for that reason.
    Refused(LabError),
}

/// A result, and what it was made from.
#[derive(Clone, Copy, Debug)]
pub struct Made<'a> {
    /// The result.
    pub outcome: &'a Arc<Outcome>,
    /// The parameters under which it is made again.
    pub params: &'a Params,
}

/// Why a pane has no result to hand on.
#[derive(Clone, Debug, PartialEq, thiserror::Error, ToMessage)]
pub enum NoResult {
    /// It cannot be made: what is missing and what to do.
    #[error("{problem}", problem = .0.to_sentence())]
    Refused(LabError),
    /// It is not there yet.
    #[error("the result is still being computed")]
    Awaited,
}

/// What a pane has on the stage at some time.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The pane's result; a gait on its way to it, where the speed has just been changed.
    pub outcome: &'a Arc<Outcome>,
    /// The time in its motion, seconds.
    pub secs: f64,
    /// Where the motion lies in the world that is shown.
    pub place: Planar,
}

impl Pane {
    /// The result of the present parameters, to be kept, saved, measured or told of.
    ///
    /// # Errors
    /// [`NoResult`] where it cannot be made, and while it is computed: what is on the stage then is
    /// of earlier parameters, or a draft.
    pub fn result(&self) -> Result<Made<'_>, NoResult> {
        if let Some(problem) = &self.problem {
            return Err(NoResult::Refused(problem.clone()));
        }
        self.made().filter(|_| self.standing == Standing::Finished).ok_or(NoResult::Awaited)
    }

    /// As [`Pane::result`], for what makes it anew from its parameters: its feet may still have to
    /// be planted.
    pub(super) fn recipe(&self) -> Result<Made<'_>, NoResult> {
        let drafted = self
            .made()
            .filter(|made| self.standing == Standing::Draft && made.outcome.awaits_feet());
        drafted.map_or_else(|| self.result(), Ok)
    }

    /// What is on the stage, and what it was made from.
    fn made(&self) -> Option<Made<'_>> {
        let (outcome, params) = (self.outcome.as_ref()?, self.made_from.as_deref()?);
        Some(Made { outcome, params })
    }

    /// What the result on the stage was made from; `None` where there is none.
    #[must_use]
    pub fn made_from(&self) -> Option<&Params> {
        self.made().map(|made| made.params)
    }

    /// The compared parameter and its value in what is on the stage; without anything there, in
    /// what is asked for.
    #[must_use]
    pub fn compared(&self) -> Option<(Key, &Value)> {
        let (key, value) = self.variant.as_ref()?;
        Some((*key, self.made_from().map_or(value, |from| from.get(*key))))
    }

    /// Whether the result on the stage is of earlier parameters: that of the present ones is being
    /// computed.
    #[must_use]
    pub fn is_outdated(&self) -> bool {
        self.outcome.is_some() && self.standing == Standing::Earlier
    }

    /// Takes the answer to what `params` ask for. Every lab's comes here: where there is no result,
    /// no earlier one stands for it.
    pub(super) fn take(&mut self, answer: Answer, params: &Arc<Params>) {
        self.problem = None;
        self.sources.clear();
        match answer {
            Answer::Made { outcome, is_draft, inputs } => {
                self.outcome = Some(outcome);
                self.inputs = inputs;
                self.made_from = Some(Arc::clone(params));
                self.standing = Standing::of(is_draft);
            }
            Answer::Same { is_draft } => {
                self.made_from = Some(Arc::clone(params));
                self.standing = Standing::of(is_draft);
            }
            Answer::Awaited => {
                self.standing = Standing::Earlier;
                // An earlier result stays until there is a newer one, but for that of another lab.
                if self.made_from().is_some_and(|from| from.get(Key::Lab) != params.get(Key::Lab)) {
                    self.clear();
                }
            }
            Answer::Refused(problem) => {
                self.clear();
                self.problem = Some(problem);
            }
        }
    }

    /// Puts the numbers that every lab has first in the list of a new result. Until they are
    /// measured it is a draft.
    pub(super) fn measure(&mut self, gauge: &mut Gauge) {
        let Some(outcome) = self.outcome.as_mut().filter(|_| self.standing != Standing::Earlier)
        else {
            return;
        };
        if outcome.is_measured {
            return;
        }
        let found = gauge.numbers(outcome);
        if found.is_none() {
            self.standing = Standing::Draft;
        }
        if found.is_some() || !outcome.awaits_numbers() {
            Arc::make_mut(outcome).take_numbers(found);
        }
    }

    /// What is driven goes on: the same character, a moment later.
    pub(super) fn go_on(&mut self, outcome: Outcome) {
        self.outcome = Some(Arc::new(outcome));
    }

    fn clear(&mut self) {
        (self.outcome, self.made_from, self.inputs, self.glide) = (None, None, None, None);
        self.place = Planar::IDENTITY;
        self.standing = Standing::Earlier;
    }

    /// What is shown at a time of the timeline; nothing while there is no result. A result that
    /// goes round and is shorter than the timeline begins again, and walks on from where it is.
    #[must_use]
    pub fn shown_at(&self, secs: f64) -> Option<Shown<'_>> {
        let own = self.outcome.as_ref()?;
        let gliding = self.glide.as_ref().and_then(|glide| {
            let [own_secs, gliding_secs] = durations(own, &glide.outcome)?;
            Some((&glide.outcome, secs / own_secs * gliding_secs))
        });
        let (outcome, secs) = gliding.unwrap_or((own, secs));
        let (secs, place) = outcome.around(secs);
        Some(Shown { outcome, secs, place: self.place.after(&place) })
    }
}

/// Something that takes longer than a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The number by which it can be stopped; `None` where it ends soon by itself.
    pub task: Option<u64>,
    /// What it is.
    pub kind: JobKind,
    /// How much is done, 0 to 1.
    pub progress: f64,
    /// The size of the file that is read, bytes.
    pub size: Option<u64>,
}

impl Session {
    /// One slice of the work that is left over when a change would take longer than a frame. `true`
    /// while there is more.
    pub fn work(&mut self) -> bool {
        if self.labs.work(self.document.params.number(Key::Time)) {
            return true;
        }
        if self.labs.is_ready() {
            let held = self.held();
            self.refresh();
            self.go_on_from(&held);
            return true;
        }
        self.make_next()
    }

    /// Makes one built-in clip that was not needed yet, so that the library can tell what it is.
    /// `false` when all are made.
    pub(super) fn make_next(&mut self) -> bool {
        // What another lab made takes its time, and is made when it is used.
        let is_quick = |entry: &Entry| match entry.origin {
            Origin::Preset => true,
            Origin::Made => {
                recipe_params(&entry.id).is_some_and(|params| lab::of(params.lab()).is_synthetic())
            }
            _ => false,
        };
        let unmade = |entry: &&Arc<Entry>| entry.motion.is_none() && is_quick(entry);
        let next =
            self.document.library.entries().iter().find(unmade).map(|entry| entry.id.clone());
        next.is_some_and(|id| self.motion_of(&id).is_ok())
    }

    /// What is under way.
    #[must_use]
    pub fn jobs(&self) -> Vec<Job> {
        let computed = self.labs.progress().into_iter().map(|(kind, progress)| Job {
            task: None,
            kind,
            progress,
            size: None,
        });
        self.reading_jobs().chain(computed).collect()
    }

    /// Whether the clip in a slot is part of what the lab shows.
    #[must_use]
    pub fn uses(&self, slot: Slot) -> bool {
        lab::of(self.document.params.lab()).slots().contains(&slot)
    }

    /// The motion of a clip with its feet read as the parameters ask for.
    fn motion_read(&mut self, reference: &str, params: &Params) -> Result<Arc<Motion>, LabError> {
        let motion = self.motion_of(reference)?;
        Ok(self.feet.read(&motion, foot_options(params)))
    }

    /// The motion of a clip: made or asked for when it is not there yet.
    pub(super) fn motion_of(&mut self, reference: &str) -> Result<Arc<Motion>, LabError> {
        let Some(entry) = self.document.library.find(reference) else {
            return Err(LabError::MissingClip {
                name: outside::short(split_reference(reference).0),
            });
        };
        if let Some(motion) = &entry.motion {
            return Ok(Arc::clone(motion));
        }
        let id = entry.id.clone();
        let motion = match &entry.origin {
            Origin::Sample(sample) => {
                let sample = *sample;
                self.ask_for_sample(sample);
                let failed = self.document.library.get(&id).and_then(|entry| entry.unread.clone());
                return Err(
                    failed.map_or(LabError::Loading { name: sample.label }, LabError::Unread)
                );
            }
            Origin::Preset => Arc::new(preset_motion(&id)?),
            Origin::Made => {
                let params = recipe_params(&id)
                    .ok_or_else(|| LabError::NoRecipe { id: outside::short(&id) })?;
                self.made_again(&params)?
            }
            Origin::File(file) if entry.awaits_skeleton() => {
                return Err(LabError::AwaitsSkeleton { file: file.name.clone() });
            }
            Origin::File(_) if entry.unread.is_some() => {
                return Err(LabError::Unread(entry.unread.clone().unwrap_or_default()));
            }
            Origin::File(file) => {
                let file = file.clone();
                if !self.read_anew(&file, None)? {
                    return Err(LabError::Reading { file: file.name.clone() });
                }
                let motion = self.document.library.find(&id).and_then(|entry| entry.motion.clone());
                return motion.ok_or_else(|| LabError::NoSuchClip { file: file.name.clone() });
            }
        };
        let by_hand = self.document.library.get(&id).and_then(|entry| entry.roles_by_hand.clone());
        let motion = if let Some(roles) = &by_hand {
            Arc::new(Arc::unwrap_or_clone(motion).with_corrected_roles(roles))
        } else {
            motion
        };
        self.document.library.change(&id, |entry| entry.motion = Some(Arc::clone(&motion)));
        self.revision += 1;
        Ok(motion)
    }

    /// The motions of several clips with their feet read as the parameters ask for, as
    /// [`Self::motions_of`].
    fn motions_read(
        &mut self,
        ids: &[String],
        params: &Params,
    ) -> Result<Vec<Arc<Motion>>, LabError> {
        let motions = self.motions_of(ids)?;
        let reading = foot_options(params);
        Ok(motions.iter().map(|motion| self.feet.read(motion, reading)).collect())
    }

    /// The motions of several clips. What is not there yet is made or asked for, all of it, before
    /// the first that is missing is told.
    pub(super) fn motions_of(&mut self, ids: &[String]) -> Result<Vec<Arc<Motion>>, LabError> {
        let motion = |id: &String| {
            self.document.bring(id);
            self.motion_of(id)
        };
        let motions: Vec<_> = ids.iter().map(motion).collect();
        motions.into_iter().collect()
    }

    /// What a recipe makes, once more: its clips may have to be made themselves, or loaded.
    fn made_again(&mut self, params: &Params) -> Result<Arc<Motion>, LabError> {
        for key in [Key::A, Key::B] {
            let reference = params.text(key).to_owned();
            let _was_gone = self.document.bring_back(&reference) || self.document.bring(&reference);
        }
        let mut pane = Pane::default();
        self.labs.grapher.guide_by(None);
        self.refresh_pane(&mut pane, &Arc::new(params.clone()), widest_window(params, None));
        match pane.result() {
            Ok(made) => Ok(Arc::clone(&made.outcome.motion)),
            Err(NoResult::Refused(problem)) => Err(problem),
            Err(NoResult::Awaited) => Err(LabError::BeingMade { name: recipe_name(params) }),
        }
    }

    /// The parameters with a pane's own value of the compared one.
    pub(super) fn params_of(&self, pane: &Pane) -> Params {
        let mut params = self.document.params.clone();
        if let Some((key, value)) = &pane.variant {
            let result = params.set(*key, value.clone());
            debug_assert!(result.is_ok(), "compare holds checked values: {result:?}");
        }
        params
    }

    /// What a person calls that in which a pane differs from the others: the value with its unit,
    /// or the clip's name. `None` where there is nothing to compare.
    #[must_use]
    pub fn variant_name(&self, pane: &Pane) -> Option<String> {
        let (key, value) = pane.compared()?;
        let param = key.param();
        Some(match (param.kind, value) {
            (Kind::Clip, Value::Text(id)) => self
                .document
                .library
                .find(id)
                .map_or_else(|| split_reference(id).0.to_owned(), |entry| entry.name.clone()),
            _ => format!("{} {}", param.spoken(value), param.unit).trim_end().to_owned(),
        })
    }

    /// Recomputes the panes whose inputs have changed.
    pub(super) fn refresh(&mut self) {
        self.revision += 1;
        self.ask_for_lesson();
        let lab = self.document.params.lab();
        let is_clip = |key: Key| recipe_ingredients(lab).any(|ingredient| ingredient == key);
        // What is only looked at may be compared in every lab.
        let uses = |key: Key| {
            if key.param().group.is_of_lab() {
                belongs_to(key, lab)
            } else {
                !matches!(key.param().kind, Kind::Clip) || is_clip(key)
            }
        };
        let compare = self.compare().filter(|compare| uses(compare.key));
        let variants: Vec<Option<(Key, Value)>> = match &compare {
            Some(compare) => compare
                .values
                .iter()
                .take(MAX_PANES)
                .map(|value| Some((compare.key, value.clone())))
                .collect(),
            None => vec![None],
        };
        for clip in self.document.compared_clips() {
            self.document.bring(&clip);
        }
        dismiss_found(&self.document, &mut self.notices);
        let mut old = std::mem::take(&mut self.panes).into_iter();
        self.labs.ask_anew();
        let match_window = widest_window(&self.document.params, compare.as_ref());
        self.labs.grapher.guide_by(None);
        for variant in variants {
            let mut pane = old.next().unwrap_or_default();
            pane.variant = variant;
            let params = Arc::new(self.params_of(&pane));
            if !self.is_own_drive() {
                self.refresh_pane(&mut pane, &params, match_window);
                pane.measure(&mut self.labs.gauge);
            }
            if self.panes.is_empty() {
                self.labs.grapher.guide_by(Some(&params));
            }
            self.panes.push(pane);
        }
        self.refresh_driving();
        self.stand_in();
        self.refresh_company();
    }

    /// Where a result cannot be made, the clips that it was to be made of stand in its place, as
    /// far as they are there.
    fn stand_in(&mut self) {
        for index in 0..self.panes.len() {
            let Some(pane) = self.panes.get(index).filter(|pane| pane.problem.is_some()) else {
                continue;
            };
            let params = self.params_of(pane);
            let slots = [Slot::A, Slot::B].into_iter().filter(|slot| self.uses(*slot));
            let slots: Vec<Slot> = slots.collect();
            let found = slots
                .into_iter()
                .filter_map(|slot| Some((slot, self.motion_of(params.text(slot.key())).ok()?)));
            let found = beside_each_other(found.collect());
            if let Some(pane) = self.panes.get_mut(index) {
                pane.sources = found;
            }
        }
    }

    /// The clips that the lab of the parameters makes its result from. All are asked for before the
    /// first that is missing is told: what is to be fetched comes together.
    pub(super) fn lab_clips(&mut self, params: &Params) -> Result<LabClips, LabError> {
        let lab = lab::of(params.lab());
        let slots: Vec<_> = (lab.slots().iter())
            .map(|slot| self.motion_read(params.text(slot.key()), params))
            .collect();
        let ids = lab.more_clips(params)?;
        let motions =
            if lab.has_feet() { self.motions_read(&ids, params) } else { self.motions_of(&ids) };
        let slots = slots.into_iter().collect::<Result<_, _>>()?;
        let more = ids.into_iter().zip(motions?).map(|(id, motion)| MoreClip {
            name: self
                .document
                .library
                .find(&id)
                .map_or_else(|| id.clone(), |entry| entry.name.clone()),
            id,
            motion,
        });
        Ok(LabClips { slots, more: more.collect() })
    }

    /// What a pane's result depends on; `None` while that is still being computed.
    fn inputs(&mut self, params: &Params, match_window: usize) -> Result<Option<Inputs>, LabError> {
        let clips = self.lab_clips(params)?;
        lab::of(params.lab()).inputs(&mut self.labs, clips, params, match_window)
    }

    fn refresh_pane(&mut self, pane: &mut Pane, params: &Arc<Params>, match_window: usize) {
        let answer = match self.inputs(params, match_window) {
            Ok(None) => Answer::Awaited,
            Ok(Some(inputs)) if pane.inputs.as_ref() == Some(&inputs) => {
                Answer::Same { is_draft: inputs.is_draft() }
            }
            Ok(Some(inputs)) => match inputs.run() {
                Ok(outcome) => Answer::Made {
                    outcome: Arc::new(outcome),
                    is_draft: inputs.is_draft(),
                    inputs: Some(inputs),
                },
                Err(problem) => Answer::Refused(problem),
            },
            Err(problem) => Answer::Refused(problem),
        };
        pane.take(answer, params);
    }
}

/// Clips on the stage, the first on the left of the second, as seen from behind; one alone lies
/// where its file has it.
fn beside_each_other(clips: Vec<(Slot, Arc<Motion>)>) -> Vec<Source> {
    /// From the middle to either side, metres.
    const ASIDE_METRES: f64 = 0.6;
    let Some(stands) = clips.first().map(|(_, first)| first.standing_at(0.0)) else {
        return Vec::new();
    };
    let alone = clips.len() == 1;
    let placed =
        clips.into_iter().zip([ASIDE_METRES, -ASIDE_METRES]).map(|((slot, motion), side)| {
            let aside = Planar::new(0.0, if alone { 0.0 } else { side }, 0.0);
            let world_from_clip = stands.after(&aside).after(&motion.standing_at(0.0).inverse());
            Source::new(slot, &motion, 0.0, world_from_clip)
        });
    placed.collect()
}

/// The window that the automatic match uses: one for all panes, so that they differ in the compared
/// value alone.
fn widest_window(params: &Params, compare: Option<&Compare>) -> usize {
    let windows = compare
        .filter(|compare| compare.key == Key::BlendWindow)
        .map(|compare| compare.values.as_slice());
    let widest = windows.unwrap_or(&[]).iter().fold(0.0, |widest: f64, value| match value {
        Value::Number(frames) => widest.max(*frames),
        _ => widest,
    });
    if widest > 0.0 { widest as usize } else { params.number(Key::BlendWindow) as usize }
}
