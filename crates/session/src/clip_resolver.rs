//! Resolution of the clips that labs use: found in the library, synthesised, made again from a
//! recipe, or requested from the app.

use crate::contact_edits::corrections_of;
use crate::document::Document;
use crate::files::FileIntake;
use crate::labs::{Answer, Inputs, LabClips, LabError, LabSet, MoreClip, Slot};
use crate::labs::{lab_of, preset_motion, recipe_name, recipe_params, slots_of};
use crate::library::{Entry, Origin, split_reference};
use crate::motion::foot_options;
use crate::outside;
use crate::params::{Compare, Key, Params, Value};
use segue_motion::clip::Motion;
use std::sync::Arc;

/// The parts of a session that provide labs with clips, and run the labs.
pub(crate) struct ClipResolver<'a> {
    pub(crate) document: &'a mut Document,
    pub(crate) files: &'a mut FileIntake,
    pub(crate) labs: &'a mut LabSet,
}

impl ClipResolver<'_> {
    /// Makes one built-in clip that was not needed yet, so that the library can describe it.
    /// Returns `false` when all are made.
    pub(crate) fn make_next(&mut self) -> bool {
        // Results of other labs take longer, and are made when they are used.
        let is_quick = |entry: &Entry| match entry.origin {
            Origin::Preset => true,
            Origin::Made => {
                recipe_params(&entry.id).is_some_and(|params| lab_of(params.lab()).is_synthetic())
            }
            _ => false,
        };
        let unmade = |entry: &&Arc<Entry>| entry.motion.is_none() && is_quick(entry);
        let next =
            self.document.library.entries().iter().find(unmade).map(|entry| entry.id.clone());
        next.is_some_and(|id| self.motion(&id).is_ok())
    }

    /// Returns the motion of a clip, with its feet read as the parameters say, and its contacts as
    /// corrected.
    fn motion_with_feet(
        &mut self,
        reference: &str,
        params: &Params,
    ) -> Result<Arc<Motion>, LabError> {
        let motion = self.motion(reference)?;
        // Labs without the options of reading feet read them as ever.
        let uses = |key: Key| key.param().is_used_by(params.lab());
        let feet = if uses(Key::ContactHeight) { foot_options(params) } else { motion.feet() };
        let library = &self.document.library;
        let entry = library.find(reference).filter(|_| uses(Key::ContactEdits));
        let corrections = entry.and_then(|entry| corrections_of(library, params, &entry.id));
        Ok(self.labs.feet.read(&motion, feet, corrections))
    }

    /// Returns the motion of a clip. Makes or requests it if it is not available yet.
    ///
    /// # Errors
    /// [`LabError`] with the reason why there is no motion, or none yet.
    pub(crate) fn motion(&mut self, reference: &str) -> Result<Arc<Motion>, LabError> {
        let Some(entry) = self.document.library.find(reference) else {
            return Err(LabError::MissingClip {
                name: outside::short(split_reference(reference).0),
            });
        };
        if matches!(entry.origin, Origin::File(_)) {
            self.files.note_use(&entry.id);
        }
        if let Some(motion) = &entry.motion {
            return Ok(Arc::clone(motion));
        }
        let id = entry.id.clone();
        let motion = match &entry.origin {
            Origin::Sample(sample) => {
                let sample = *sample;
                self.files.request_sample(self.document, sample);
                let failed = self.document.library.get(&id).and_then(|entry| entry.unread.clone());
                return Err(
                    failed.map_or(LabError::Loading { name: sample.label }, LabError::Unread)
                );
            }
            Origin::Preset => Arc::new(preset_motion(&id)?),
            Origin::Made => {
                let params = recipe_params(&id)
                    .ok_or_else(|| LabError::NoRecipe { id: outside::short(&id) })?;
                self.make_again(&params)?
            }
            Origin::File(file) if entry.awaits_skeleton() => {
                return Err(LabError::AwaitsSkeleton { file: file.name.clone() });
            }
            Origin::File(_) if entry.unread.is_some() => {
                return Err(LabError::Unread(entry.unread.clone().unwrap_or_default()));
            }
            Origin::File(file) => {
                let file = file.clone();
                if !self.files.read_anew(self.document, &file, None)? {
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
        let maps = Arc::clone(self.document.library.bone_maps());
        self.document.library.change(&id, |entry| {
            entry.set_motion(motion);
            entry.take_mapped_roles(&maps);
        });
        let made = self.document.library.get(&id).and_then(|entry| entry.motion.clone());
        made.ok_or_else(|| LabError::MissingClip { name: outside::short(&id) })
    }

    /// Keeps the motions of the clips in A and B, and has that of the chosen character read if it
    /// is not here.
    pub(crate) fn keep_slots_and_character(&mut self) {
        for slot in [Slot::A, Slot::B] {
            let held = self.document.slot(slot).filter(|entry| entry.motion.is_some());
            if let Some(entry) = held {
                self.files.note_use(&entry.id);
            }
        }
        let character = self.document.params.text(Key::Character).to_owned();
        if self.document.library.find(&character).is_some_and(|entry| entry.has_mesh()) {
            // If it cannot be read, a notice has said so.
            let _is_here = self.motion(&character).is_ok();
        }
    }

    /// Returns the motions of several clips, with their feet read as the parameters say. Makes or
    /// requests all that are not available yet before it fails with the first missing one.
    fn motions_with_feet(
        &mut self,
        ids: &[String],
        params: &Params,
    ) -> Result<Vec<Arc<Motion>>, LabError> {
        let motion = |id: &String| {
            self.document.ensure_clip(id);
            self.motion_with_feet(id, params)
        };
        let motions: Vec<_> = ids.iter().map(motion).collect();
        motions.into_iter().collect()
    }

    /// Makes a result again from its recipe. Its clips may in turn have to be made or loaded.
    fn make_again(&mut self, params: &Params) -> Result<Arc<Motion>, LabError> {
        for key in [Key::A, Key::B] {
            let reference = params.text(key).to_owned();
            let _was_gone =
                self.document.restore_built_in(&reference) || self.document.ensure_clip(&reference);
        }
        self.labs.graphs.set_guide(None);
        match self.answer(params, None, widest_window(params, None)) {
            Answer::Made { outcome, is_draft: false, .. } => Ok(Arc::clone(&outcome.motion)),
            Answer::Refused(problem) => Err(problem),
            _ => Err(LabError::BeingMade { name: recipe_name(params).to_string() }),
        }
    }

    /// Returns the clips that the lab of the parameters makes its result from. Requests all of them
    /// before it fails with the first missing one, so that files are fetched together.
    pub(crate) fn lab_clips(&mut self, params: &Params) -> Result<LabClips, LabError> {
        let lab = lab_of(params.lab());
        let slots: Vec<_> = slots_of(params.lab())
            .map(|slot| self.motion_with_feet(params.text(slot.key()), params))
            .collect();
        let ids = lab.more_clips(params)?;
        let motions = self.motions_with_feet(&ids, params);
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

    /// Returns the inputs of a pane's result; `None` while they are being computed.
    fn inputs(&mut self, params: &Params, match_window: usize) -> Result<Option<Inputs>, LabError> {
        let clips = self.lab_clips(params)?;
        self.labs.inputs(clips, params, match_window)
    }

    /// Returns the answer to the parameters of a pane; `shown` are the inputs of its present
    /// result.
    pub(crate) fn answer(
        &mut self,
        params: &Params,
        shown: Option<&Inputs>,
        match_window: usize,
    ) -> Answer {
        answer_by(self.inputs(params, match_window), shown)
    }

    /// Returns the answer to parameters of a command that waits for no worker to make the result.
    pub(crate) fn answer_here(&mut self, params: &Params) -> Answer {
        let inputs = self.lab_clips(params);
        answer_by(inputs.and_then(|clips| self.labs.inputs_here(clips, params, 0)), None)
    }
}

/// Returns the answer by the inputs of a result, if they are known; `shown` are those of the
/// present one.
fn answer_by(inputs: Result<Option<Inputs>, LabError>, shown: Option<&Inputs>) -> Answer {
    match inputs {
        Ok(None) => Answer::Awaited,
        Ok(Some(inputs)) if shown == Some(&inputs) => Answer::Same { is_draft: inputs.is_draft() },
        Ok(Some(inputs)) => match inputs.run() {
            Ok(outcome) => Answer::Made {
                outcome: Arc::new(outcome),
                is_draft: inputs.is_draft(),
                inputs: Some(inputs),
            },
            Err(problem) => Answer::Refused(problem),
        },
        Err(problem) => Answer::Refused(problem),
    }
}

/// Returns the window of the automatic match, in frames: one for all panes, so that they differ in
/// the compared value alone.
pub(crate) fn widest_window(params: &Params, compare: Option<&Compare>) -> usize {
    let windows = compare
        .filter(|compare| compare.key == Key::BlendWindow)
        .map(|compare| compare.values.as_slice());
    let widest = windows.unwrap_or(&[]).iter().fold(0.0, |widest: f64, value| match value {
        Value::Number(frames) => widest.max(*frames),
        _ => widest,
    });
    if widest > 0.0 { widest as usize } else { params.number(Key::BlendWindow) as usize }
}
