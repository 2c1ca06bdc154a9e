//! Remedies: commands that let a refused result be made, or that open the place to mend it.

use super::error::LabError;
use super::lab::slots_of;
use super::lab_set::lab_of;
use super::outcome::Slot;
use super::{ClipEdit, recipe_ingredients};
use crate::LabId;
use crate::command::Command;
use crate::library::{Entry, Library};
use crate::params::{Key, Kind, Params, Value};
use segue_motion::blend::BlendError;
use segue_motion::clip::{Motion, ground_speed};
use segue_motion::gait::{GaitCycle, GaitError};
use segue_motion::graph::GraphError;
use segue_motion::matching::MatchError;
use segue_motion::path::PathEditError;
use segue_motion::registration::{PathError, RegistrationError};
use segue_motion::skeleton::Role;
use segue_motion::transition::LoopError;
use segue_text::{Message, msg};
use std::sync::Arc;

/// A remedy of a refused result, offered as a button beside the reason.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Declares the clip in a slot one cycle: the edited clip joins the library and takes the slot.
    TreatAsLoop {
        /// The slot.
        slot: Slot,
        /// The clip's id.
        id: String,
    },
    /// Gives the clip in a slot another frame rate: the edited clip joins the library and takes the
    /// slot. B gets the rate of A anyway.
    Resample {
        /// The slot.
        slot: Slot,
        /// The clip's id.
        id: String,
        /// The rate, frames per second.
        fps: u32,
    },
    /// Puts another clip into a slot.
    Choose {
        /// The slot.
        slot: Slot,
        /// The clip's id.
        id: String,
        /// Its name.
        name: Message,
    },
    /// Opens the View lab, in which the body parts of a clip are set.
    SetBodyParts {
        /// The clip's id.
        id: String,
        /// Its name.
        name: Message,
    },
    /// Opens the Edit lab with a clip.
    EditClip {
        /// The clip's id.
        id: String,
    },
    /// Sets a parameter.
    Set(Key, Value),
    /// Brings parameters back to their defaults.
    Reset(Vec<Key>),
}

impl Remedy {
    /// Returns the words of its button: what it does.
    #[must_use]
    pub fn label(&self) -> Message {
        match self {
            Self::TreatAsLoop { slot, .. } => {
                msg!("Treat {slot} as a loop", slot = Message::data(slot.label()))
            }
            Self::Resample { slot, fps, .. } => {
                let rate = f64::from(*fps);
                msg!("Resample {slot} to {rate:.0} fps", slot = Message::data(slot.label()), rate)
            }
            Self::Choose { slot, name, .. } => {
                msg!(
                    "Use {name} as {slot}",
                    name = name.clone(),
                    slot = Message::data(slot.label())
                )
            }
            Self::SetBodyParts { name, .. } => {
                msg!("Set body parts of {name}", name = name.clone())
            }
            Self::EditClip { .. } => "Edit the clip".into(),
            Self::Set(key, value) => {
                let param = key.param();
                let label = Message::from(param.label);
                match param.unit {
                    "" => msg!("Set {label} to {value}", label, value = param.spoken(value)),
                    unit => {
                        let value = msg!("{value} {unit}", value = param.spoken(value), unit);
                        msg!("Set {label} to {value}", label, value)
                    }
                }
            }
            Self::Reset(keys) => {
                let labels = keys.iter().map(|key| Message::from(key.param().label)).collect();
                msg!("Reset {labels}", labels = Message::joined(labels, ", "))
            }
        }
    }

    /// Returns the commands that it stands for, in order.
    #[must_use]
    pub fn commands(&self) -> Vec<Command> {
        let set = |values| vec![Command::Set(values), Command::Settle];
        match self {
            Self::TreatAsLoop { slot, id } => {
                vec![Command::Edit(id.clone(), ClipEdit::Loop, Some(*slot))]
            }
            Self::Resample { slot, id, fps } => {
                vec![Command::Edit(id.clone(), ClipEdit::Resample(*fps), Some(*slot))]
            }
            Self::Choose { slot, id, .. } => vec![Command::Assign(*slot, id.clone())],
            Self::SetBodyParts { id, .. } => set(vec![
                (Key::Lab, LabId::View.into()),
                (Key::Compare, Value::Compare(None)),
                (Key::A, Value::Text(id.clone())),
            ]),
            Self::EditClip { id } => set(edit_values(id)),
            Self::Set(key, value) => set(vec![(*key, value.clone())]),
            Self::Reset(keys) => {
                set(keys.iter().map(|key| (*key, key.param().default_value())).collect())
            }
        }
    }
}

/// Returns the parameters that open the Edit lab with an unchanged clip.
fn edit_values(id: &str) -> Vec<(Key, Value)> {
    let own = recipe_ingredients(LabId::Edit)
        .filter(|key| key.param().group == crate::params::Group::Lab(LabId::Edit))
        .map(|key| (key, key.param().default_value()));
    let opened = [
        (Key::Lab, LabId::Edit.into()),
        (Key::Compare, Value::Compare(None)),
        (Key::A, Value::Text(id.to_owned())),
    ];
    opened.into_iter().chain(own).collect()
}

/// The least speed of a clip that is offered as a gait, metres per second.
const MIN_SPEED_MPS: f32 = 0.2;
/// The least difference of speed between the clips that are offered for a blend by speed, metres
/// per second.
const MIN_DIFFERENCE_MPS: f64 = 0.3;

/// Returns the remedies of a refusal under these parameters, the best first; empty where there is
/// none.
pub(crate) fn remedies(problem: &LabError, params: &Params, library: &Library) -> Vec<Remedy> {
    let place = Place { params, library };
    match problem {
        LabError::InSlot { slot, error } => place.of_slot(error, *slot),
        _ => place.of_slot(problem, Slot::A),
    }
}

/// The clips and parameters of a refused result.
#[derive(Clone, Copy)]
struct Place<'a> {
    params: &'a Params,
    library: &'a Library,
}

impl Place<'_> {
    fn of_slot(&self, problem: &LabError, slot: Slot) -> Vec<Remedy> {
        match problem {
            LabError::Gait(GaitError::NoCycle { .. }) => self.as_gait(slot),
            LabError::Gait(GaitError::NoFeet { .. }) => {
                self.body_parts(slot).into_iter().chain(self.as_gait(slot)).collect()
            }
            LabError::Gait(GaitError::Speeds { .. }) => self.of_other_speed().into_iter().collect(),
            LabError::Loop(LoopError::TooShort { .. }) => self.as_loop(slot),
            LabError::Loop(LoopError::Range { .. }) | LabError::EmptyCycle => {
                self.reset(&[Key::LoopFrom, Key::LoopTo, Key::EditFrom, Key::EditTo, Key::AsLoop])
            }
            LabError::Registration(RegistrationError::TooManyPairs { stride, .. })
            | LabError::Blend(BlendError::Registration(RegistrationError::TooManyPairs {
                stride,
                ..
            })) => self.at_rate_divided(*stride).into_iter().collect(),
            LabError::Retarget(_) => self.unknown_bodies(),
            LabError::RootWay(_) => self.body_parts(slot).into_iter().collect(),
            LabError::Mirror(_) => {
                let parts = self.body_parts(slot).into_iter();
                parts.chain(self.reset(&[Key::Mirror])).collect()
            }
            LabError::OfClip { name, .. }
            | LabError::Match(
                MatchError::NoFeet { name, .. }
                | MatchError::Retarget { name, .. }
                | MatchError::Mirror { name, .. },
            ) => self.parts_by_name(name).into_iter().collect(),
            LabError::Path(PathEditError::NoTravel { .. } | PathEditError::Frames { .. }) => {
                let own = self.slot(Slot::A).map(|entry| Remedy::EditClip { id: entry.id.clone() });
                self.built_in(Slot::A, "walk").into_iter().chain(own).collect()
            }
            LabError::MissingClip { .. } => self.missing_slots(),
            LabError::NoGraphClips | LabError::TooManyGraphClips { .. } => {
                self.reset(&[Key::Clips])
            }
            LabError::Match(_) | LabError::NothingToMatch => {
                self.reset(&[Key::MatchClips, Key::AheadNear, Key::AheadMiddle, Key::AheadFar])
            }
            LabError::TwoMistakes => self.reset(&[Key::Mistake]),
            LabError::NoVisit { .. } => self.reset(&[Key::GoTo]),
            LabError::NoPreferredClip { .. } => self.reset(&[Key::PreferClip]),
            LabError::NoTag { .. } => self.reset(&[Key::AskTag]),
            LabError::PinBeyond { .. } => self.reset(&[Key::Pins]),
            LabError::NoRoomToJoin { .. } | LabError::JoinBackwards { .. } => {
                self.reset(&[Key::WarpFrom, Key::WarpTo])
            }
            LabError::TooManyFrames { .. } => self.reset(&[Key::Resample]),
            LabError::Warp(PathError::NoPath { needed, .. }) => {
                set_number(Key::SlopeLimit, *needed as f64)
            }
            LabError::Graph(GraphError::NoTransition { nearest_cm, .. }) => {
                set_number(Key::EdgeThreshold, (nearest_cm * 10.0).floor() / 10.0 + 0.1)
            }
            // No transition leads back. At twice the distance more of them do, and at least at the
            // usual threshold.
            LabError::Graph(GraphError::NoCycle { threshold_cm, .. }) => {
                let usual = match Key::EdgeThreshold.param().default_value() {
                    Value::Number(usual) => usual,
                    _ => 0.0,
                };
                set_number(Key::EdgeThreshold, usual.max(2.0 * threshold_cm))
            }
            _ => Vec::new(),
        }
    }

    fn slot(&self, slot: Slot) -> Option<&Arc<Entry>> {
        self.library.find(self.params.text(slot.key()))
    }

    /// Returns what lets a clip be taken as a gait: declared a cycle if it travels, otherwise
    /// another clip in its place.
    fn as_gait(&self, slot: Slot) -> Vec<Remedy> {
        let as_loop = self.slot(slot).filter(|entry| motion(entry).is_some_and(travels));
        let as_loop = as_loop.map(|entry| Remedy::TreatAsLoop { slot, id: entry.id.clone() });
        let other = if slot == Slot::A { "walk" } else { "run" };
        as_loop.into_iter().chain(self.built_in(slot, other)).take(1).collect()
    }

    /// Returns what lets a short clip be a loop: its own ends where others are set, otherwise
    /// declared a cycle as a whole.
    fn as_loop(&self, slot: Slot) -> Vec<Remedy> {
        let reset = self.reset(&[Key::LoopFrom, Key::LoopTo]);
        if !reset.is_empty() {
            return reset;
        }
        let can_close =
            |entry: &&Arc<Entry>| motion(entry).is_some_and(|motion| motion.clip().frames() > 2);
        let entry = self.slot(slot).filter(can_close);
        entry.map(|entry| Remedy::TreatAsLoop { slot, id: entry.id.clone() }).into_iter().collect()
    }

    /// Returns the remedy that divides the frame rate of A, and with it that of B.
    fn at_rate_divided(&self, stride: usize) -> Option<Remedy> {
        let entry = self.slot(Slot::A)?;
        let fps = (motion(entry)?.clip().fps() / stride.max(2) as f64).floor();
        Key::Resample.param().check(Value::Number(fps)).ok()?;
        Some(Remedy::Resample { slot: Slot::A, id: entry.id.clone(), fps: fps as u32 })
    }

    /// Returns a built-in clip for B that is faster or slower than A.
    fn of_other_speed(&self) -> Option<Remedy> {
        let speed = |entry: &Arc<Entry>| {
            let cycle = GaitCycle::find(motion(entry)?).ok()?;
            Some(cycle.speed_mps()).filter(|speed| *speed > f64::from(MIN_SPEED_MPS))
        };
        let Some(own) = self.slot(Slot::A).and_then(speed) else {
            return self.built_in(Slot::A, "walk");
        };
        let made = segue_motion::synth::presets();
        let differs = |id: &&str| {
            let preset = made.iter().find(|preset| preset.id == *id);
            preset.is_some_and(|preset| {
                (own - f64::from(preset.params.speed_mps)).abs() > MIN_DIFFERENCE_MPS
            })
        };
        let other = ["run", "walk"].into_iter().find(differs)?;
        self.built_in(Slot::B, other)
    }

    /// Returns the clips of a pair whose hips and legs are not known.
    fn unknown_bodies(&self) -> Vec<Remedy> {
        let is_unknown = |slot: &Slot| {
            let motion = self.slot(*slot).and_then(|entry| motion(entry));
            let knows = |role| motion.is_some_and(|motion| motion.roles().get(role).is_some());
            motion.is_some() && !(knows(Role::Hips) && knows(Role::LeftThigh))
        };
        let slots: Vec<Slot> = slots_of(self.params.lab()).collect();
        let unknown = slots.iter().copied().filter(is_unknown);
        let mut found: Vec<Remedy> = unknown.filter_map(|slot| self.body_parts(slot)).collect();
        if found.is_empty() {
            found.extend(slots.last().and_then(|slot| self.body_parts(*slot)));
        }
        found
    }

    fn body_parts(&self, slot: Slot) -> Option<Remedy> {
        self.slot(slot).map(|entry| body_parts(entry))
    }

    /// Returns the remedy for a clip in the lab's list, of which the name is known.
    fn parts_by_name(&self, name: &str) -> Option<Remedy> {
        let ids = lab_of(self.params.lab()).listed(self.params);
        let listed = ids.iter().filter_map(|id| self.library.find(id));
        let is_it = |entry: &&Arc<Entry>| {
            let own = motion(entry).is_some_and(|motion| motion.clip().name() == name);
            entry.name == name || own
        };
        listed.filter(is_it).map(|entry| body_parts(entry)).next()
    }

    fn missing_slots(&self) -> Vec<Remedy> {
        let missing = slots_of(self.params.lab()).filter(|slot| self.slot(*slot).is_none());
        let default = |slot: Slot| {
            let Value::Text(id) = slot.key().param().default_value() else {
                return None;
            };
            self.built_in(slot, &id)
        };
        missing.filter_map(default).collect()
    }

    /// Returns the remedy that puts a built-in clip into a slot; `None` if it is there.
    fn built_in(&self, slot: Slot, id: &str) -> Option<Remedy> {
        if self.params.text(slot.key()) == id {
            return None;
        }
        let preset = segue_motion::synth::presets().into_iter().find(|preset| preset.id == id)?;
        Some(Remedy::Choose { slot, id: id.to_owned(), name: preset.title.into() })
    }

    /// Returns the remedy that brings back the defaults of those of these parameters that have
    /// another value.
    fn reset(&self, keys: &[Key]) -> Vec<Remedy> {
        let is_used = |key: &&Key| key.param().is_used_by(self.params.lab());
        let changed = |key: &&Key| self.params.is_changed(**key);
        let keys: Vec<Key> = keys.iter().filter(is_used).filter(changed).copied().collect();
        if keys.is_empty() { Vec::new() } else { vec![Remedy::Reset(keys)] }
    }
}

/// Returns the remedy that sets a number, rounded up to its step; empty if it is out of range.
fn set_number(key: Key, number: f64) -> Vec<Remedy> {
    let Kind::Number { min, max, step, .. } = key.param().kind else {
        return Vec::new();
    };
    let number = (number / step - 1e-6).ceil() * step;
    let value = key.param().check(Value::Number(number)).ok();
    let value = value.filter(|_| (min..=max).contains(&number));
    value.map(|value| Remedy::Set(key, value)).into_iter().collect()
}

fn motion(entry: &Arc<Entry>) -> Option<&Arc<Motion>> {
    entry.motion.as_ref()
}

fn body_parts(entry: &Entry) -> Remedy {
    Remedy::SetBodyParts { id: entry.id.clone(), name: entry.title() }
}

/// Returns whether a clip moves over the ground, and can be closed.
fn travels(motion: &Arc<Motion>) -> bool {
    let clip = motion.clip();
    clip.frames() > 2 && ground_speed(motion.ground_frames(), clip.fps()) > MIN_SPEED_MPS
}

#[cfg(test)]
mod tests;
