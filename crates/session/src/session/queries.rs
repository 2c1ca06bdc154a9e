//! Queries of panels, the page's API and pictures.

use super::Session;
use crate::Selected;
use crate::bone_map;
use crate::clip_info::ClipInfo;
use crate::contact_edits::{ContactClip, corrections_of, named_clips, with_named_edits};
use crate::labs::lab::Beside;
use crate::labs::lab_of;
use crate::labs::{CharacterMotion, CycleMade, DistanceMap, Remedy, Slot, remedies};
use crate::labs::{made_motion_has, middle_mps, range_of, synth_action};
use crate::lesson::would_set_up;
use crate::library::{Entry, split_reference};
use crate::link;
use crate::motion::foot_options;
use crate::pane::Pane;
use crate::params::{Compare, Key, Kind, Params, Value};
use segue_motion::clip::Motion;
use segue_motion::matching::{made_name, made_params};
use segue_motion::skeleton::{Role, Side};
use segue_motion::skin::Character;
use segue_motion::synth;
use segue_text::{Message, msg};
use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

/// Returns the query string of parameters, without `?`.
fn query_of(params: &Params) -> String {
    let query = link::write(params);
    if would_set_up(params) {
        // The lab, which is usually named only if it is not the first one, shows that there is a
        // state besides.
        format!("{query}&{}={}", Key::Lab.param().name, params.lab().word())
    } else {
        query
    }
}

impl Session {
    /// Returns the query string that restores this state, without `?`.
    #[must_use]
    pub fn query(&self) -> String {
        self.query_with_corrections(&self.document.params)
    }

    /// Returns the clips whose contacts can be corrected on the timeline: those that the panes show
    /// frame by frame. None in labs whose results have frames of their own.
    #[must_use]
    pub fn contact_clips(&self) -> Vec<ContactClip> {
        let (library, present) = (&self.document.library, &self.document.params);
        let mut clips: Vec<ContactClip> = Vec::new();
        let shown = self.panes.list.iter().filter_map(Pane::made_from);
        for params in shown.filter(|params| lab_of(params.lab()).shows_clip()) {
            let entry = library.find(params.text(Key::A));
            let Some((entry, motion)) =
                entry.and_then(|entry| Some((entry, entry.motion.as_ref()?)))
            else {
                continue;
            };
            let corrections = corrections_of(library, present, &entry.id);
            let read = self.labs.feet.known(motion, foot_options(present), corrections);
            let has_feet =
                Side::BOTH.iter().any(|&side| motion.roles().get(Role::foot(side)).is_some());
            let is_new = clips.iter().all(|clip| clip.id != entry.id);
            let read = read.filter(|motion| has_feet && is_new && !self.is_analyzing(motion));
            if let Some(motion) = read {
                clips.push(ContactClip { id: entry.id.clone(), motion: Arc::clone(motion) });
            }
        }
        clips
    }

    /// Returns whether a worker is at what is derived from the frames of a motion: contacts, places
    /// and the height of the ground. To ask for them meanwhile would take longer than a frame.
    #[must_use]
    pub fn is_analyzing(&self, motion: &Motion) -> bool {
        self.labs.is_analyzing(motion)
    }

    /// Returns the number of clips with the rig of a clip, which corrections of its body parts
    /// apply to; clips that were never read do not count.
    #[must_use]
    pub fn clips_of_rig(&self, id: &str) -> usize {
        let library = &self.document.library;
        let Some(own) = library.get(id).and_then(|entry| entry.facts.as_ref()) else {
            return 0;
        };
        let is_of_rig =
            |entry: &&Arc<Entry>| entry.facts.as_ref().is_some_and(|facts| facts.rig == own.rig);
        library.entries().iter().filter(is_of_rig).count()
    }

    /// Returns the query string that shows this state to somebody else, without `?`: the size of
    /// the type and the language are each reader's own.
    #[must_use]
    pub fn query_for_others(&self) -> String {
        let mut params = self.document.params.clone();
        let defaults = Params::default();
        for key in [Key::Projector, Key::Lang] {
            params.copy_from(&defaults, key);
        }
        self.query_with_corrections(&params)
    }

    /// Returns the query string of parameters, with the corrected contacts and body parts of the
    /// clips that they name.
    fn query_with_corrections(&self, params: &Params) -> String {
        let mut query = if params.contact_edits().is_empty() {
            query_of(params)
        } else {
            query_of(&with_named_edits(params))
        };
        let (library, of_link) = (&self.document.library, &self.document.maps_of_link);
        if !library.bone_maps().is_empty() {
            let maps = bone_map::linked_maps(library, of_link, &named_clips(params));
            link::add_bone_maps(&mut query, &maps);
        }
        query
    }

    /// Returns the query string of the parameters alone, as it is stored: the corrected body parts
    /// are stored with the library.
    #[must_use]
    pub fn stored_query(&self) -> String {
        query_of(&self.document.params)
    }

    /// Returns the open comparison.
    #[must_use]
    pub fn compare(&self) -> Option<&Compare> {
        self.document.params.compare()
    }

    /// Returns the clip in a slot.
    #[must_use]
    pub fn slot(&self, slot: Slot) -> Option<&Arc<Entry>> {
        self.document.slot(slot)
    }

    /// Returns whether the clip in a slot is part of what the lab shows.
    #[must_use]
    pub fn uses(&self, slot: Slot) -> bool {
        slot.key().param().is_used_by(self.document.params.lab())
    }

    /// Returns whether the opened link names this parameter, even with its default.
    #[must_use]
    pub fn names(&self, key: Key) -> bool {
        self.document.link_names(key)
    }

    /// Returns the id of a clip that a parameter may name: one of the library, or a bundled take,
    /// which joins the library when it is named.
    #[must_use]
    pub fn nameable(&self, reference: &str) -> Option<String> {
        self.document.nameable(reference)
    }

    /// Returns the values of a choice in the panes: those that are compared, or the one that is
    /// set.
    #[must_use]
    pub fn choices<C: Selected>(&self) -> Vec<C> {
        match self.compare().filter(|compare| compare.key == C::KEY) {
            Some(compare) => compare.values.iter().filter_map(Value::choice).collect(),
            None => vec![self.document.params.choice()],
        }
    }

    /// Returns the name of a pane's difference from the others: the value with its unit, or the
    /// clip's name. `None` if nothing is compared.
    #[must_use]
    pub fn variant_name(&self, pane: &Pane) -> Option<Message> {
        let (key, value) = pane.compared()?;
        let param = key.param();
        Some(match (param.kind, value) {
            (Kind::Clip, Value::Text(id)) => self
                .document
                .library
                .find(id)
                .map_or_else(|| Message::data(split_reference(id).0), |entry| entry.title()),
            _ if param.unit.is_empty() => param.spoken(value),
            _ => msg!("{value} {unit}", value = param.spoken(value), unit = param.unit),
        })
    }

    /// Returns the title on screen of a clip of which only the name is known, such as a clip of a
    /// walk.
    #[must_use]
    pub fn clip_title(&self, name: &str) -> Message {
        static MADE: LazyLock<BTreeMap<String, Message>> = LazyLock::new(|| {
            let names = made_params().into_iter().map(|params| made_name(&params));
            names.map(|name| (name.to_string(), name)).collect()
        });
        match self.document.library.entries().iter().find(|entry| entry.name == name) {
            Some(entry) => entry.title(),
            None => MADE.get(name).cloned().unwrap_or_else(|| Message::data(name)),
        }
    }

    /// Returns the character that replaces generated bodies: that of the clip in the parameter
    /// `character`.
    #[must_use]
    pub fn character(&self) -> Option<Character> {
        self.document.library.find(self.document.params.text(Key::Character))?.character()
    }

    /// Returns a motion on the stage on the skeleton of the chosen character, with its feet and
    /// hands where the motion has them. `None` while that is computed, for characters that the user
    /// drives, and where the motion cannot move the character: the directions of bones are shown.
    #[must_use]
    pub fn on_character(&self, motion: &Motion) -> Option<&Arc<CharacterMotion>> {
        self.labs.characters.of(motion)
    }

    /// Returns the reason why the motion on the stage cannot move the chosen character, in a
    /// sentence. `None` if it can, or if none is chosen.
    #[must_use]
    pub fn character_note(&self) -> Option<Message> {
        let entry = self.document.library.find(self.document.params.text(Key::Character))?;
        let character = entry.character()?;
        let shown = self.panes.list.iter().filter_map(|pane| pane.outcome.as_ref());
        let mut motions = shown.map(|outcome| &outcome.motion);
        let moves =
            |motion: &Arc<Motion>| character.is_moved_by(motion.clip().skeleton(), motion.roles());
        let is_left_out = motions.any(|motion| !moves(motion));
        is_left_out.then(|| {
            msg!(
                "This clip cannot animate {name}: they have no limbs in common. The clip is shown on its own body.",
                name = entry.title()
            )
        })
    }

    /// Returns what would let a pane have a result, the best first; empty where it has one, and
    /// where nothing is known to help.
    #[must_use]
    pub fn remedies(&self, pane: &Pane) -> Vec<Remedy> {
        let Some(problem) = &pane.problem else {
            return Vec::new();
        };
        remedies(problem, &pane.params_in(&self.document.params), &self.document.library)
    }

    /// Returns the value that Segue found for an automatic parameter.
    #[must_use]
    pub fn automatic_value(&self, key: Key) -> Option<f64> {
        match key {
            Key::RetargetRightFoot => return Some(self.document.params.number(Key::RetargetFeet)),
            Key::RetargetRightHand => return Some(self.document.params.number(Key::RetargetHands)),
            _ => {}
        }
        let outcome = self.main_outcome()?;
        let (transition, made) = (outcome.transition, outcome.cycle.map(|cycle| cycle.made));
        match (key, made) {
            (Key::Speed, Some(CycleMade::Gait { clips_mps, .. })) => {
                return Some(middle_mps(clips_mps));
            }
            (Key::LoopFrom, Some(CycleMade::Cut { from_secs, .. })) => return Some(from_secs),
            (Key::LoopTo, Some(CycleMade::Cut { to_secs, .. })) => return Some(to_secs),
            _ => {}
        }
        match key {
            Key::LeaveA => transition.map(|t| t.leave_a_secs),
            Key::EnterB => transition.map(|t| t.enter_b_secs),
            Key::MixFrameA => self.frame_in(Slot::A, transition?.leave_a_secs),
            Key::MixFrameB => self.frame_in(Slot::B, transition?.enter_b_secs),
            Key::EditTo => Some(self.slot(Slot::A)?.facts.as_ref()?.duration_secs()),
            Key::Resample => Some(self.slot(Slot::A)?.facts.as_ref()?.fps),
            Key::GaitSpeed => {
                Some(f64::from(synth::Params::new(synth_action(&self.document.params)).speed_mps))
            }
            Key::WarpFrom => Some(outcome.registered()?.part_secs[0]),
            Key::WarpTo => Some(outcome.registered()?.part_secs[1]),
            Key::WarpSmoothing => Some((0.1 * outcome.motion.clip().fps()).round()),
            Key::Ground => Some(f64::from(outcome.motion.ground_m()) * 100.0),
            Key::PlaceX => Some(to_step(outcome.motion.standing_at(0.0).shift.x, 0.01)),
            Key::PlaceZ => Some(to_step(outcome.motion.standing_at(0.0).shift.y, 0.01)),
            Key::PlaceHeading => {
                Some(to_step(outcome.motion.standing_at(0.0).yaw.to_degrees(), 0.1))
            }
            Key::In | Key::EditFrom => Some(0.0),
            Key::Out => Some(self.duration_secs()),
            _ => None,
        }
    }

    /// Returns the frame of a slot's clip at a time, at its own rate.
    fn frame_in(&self, slot: Slot, secs: f64) -> Option<f64> {
        Some((secs * self.slot(slot)?.facts.as_ref()?.fps).round())
    }

    /// Returns whether the open lab shows a clip with a change: its feet are locked, it is moved,
    /// or in place.
    #[must_use]
    pub fn view_is_changed(&self) -> bool {
        let lab = lab_of(self.document.params.lab());
        lab.shows_clip() && !lab.is_clip_as_it_is(&self.document.params)
    }

    /// Returns the distances between the frames of two clips: those of the first pane, or newer
    /// ones without a result.
    #[must_use]
    pub fn distance_map(&self) -> Option<&Arc<DistanceMap>> {
        if !lab_of(self.document.params.lab()).has(Beside::DistanceMap) {
            return None;
        }
        let pane = self.panes.list.first()?;
        let shown = pane.outcome.as_ref().and_then(|outcome| outcome.registered());
        let shown = shown.map(|registered| &registered.map);
        shown.or_else(|| self.labs.registrations.last_map())
    }

    /// Returns whether the motion to be synthesised has a parameter: a standing one has no speed.
    #[must_use]
    pub fn made_motion_has(&self, key: Key) -> bool {
        made_motion_has(&self.document.params, key)
    }

    /// Returns the part of a number's range that can be used now, if that is less than in the
    /// table: speeds and durations of a synthesised motion.
    #[must_use]
    pub fn range_of(&self, key: Key) -> Option<(f64, f64)> {
        range_of(&self.document.params, key)
    }

    /// Returns the clips as the page's API has them. A clip that was not made or loaded yet has no
    /// frames.
    #[must_use]
    pub fn clip_infos(&self) -> Vec<ClipInfo> {
        self.document.library.entries().iter().map(|entry| ClipInfo::of(entry)).collect()
    }
}

/// Rounds a value to whole steps; never returns negative zero.
fn to_step(value: f64, step: f64) -> f64 {
    (value / step).round() * step + 0.0
}
