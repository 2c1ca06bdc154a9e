//! The Edit lab: a clip that is trimmed, mirrored and changed in other ways as a whole.

use super::feet::{Lock, slide, slide_before, with_feet};
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs, can_change_result};
use super::pair::{Pair, Pairs};
use super::{Cycle, CycleMade, Outcome};
use crate::LabId;
use crate::choices::{Direction, Repeats, Sides};
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Kind, List, PARAMS, Param, Params, Value};
use segue_motion::clip::{Interpolation, Motion, ground_speed};
use segue_motion::math::Planar;
use segue_motion::metrics::worst_foot_slide;
use segue_motion::transition::{repeat_clip, treat_as_cycle};
use segue_text::{Message, msg};
use std::ops::Range;
use std::sync::Arc;

/// The Edit lab: one clip, edited as a whole.
pub(super) struct EditLab;

impl<S: HasPart<Pairs>> Lab<S> for EditLab {
    fn more_clips(&self, params: &Params) -> Result<Vec<String>, LabError> {
        Ok(params.clip_ids(Key::EditBody).iter().take(1).cloned().collect())
    }

    fn without_clip(&self, params: &Params, id: &str) -> Vec<(Key, Value)> {
        let is_body = params.clip_ids(Key::EditBody).iter().any(|body| body == id);
        let none = || (Key::EditBody, List::ClipIds(Vec::new()).into());
        is_body.then(none).into_iter().collect()
    }

    fn result_name(&self, params: &Params, a: Message, _b: Message) -> Message {
        let mut parts = edits_of(params);
        parts.insert(0, a);
        Message::joined(parts, ", ")
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} edited", params.text(Key::A))
    }

    fn is_clip_as_it_is(&self, params: &Params) -> bool {
        let changes = |param: &Param| {
            !matches!(param.kind, Kind::Clip)
                && param.is_ingredient_of(LabId::Edit)
                && can_change_result(params, param.key)
                && !(WEIGHTS.contains(&param.key) && params.clip_ids(Key::EditBody).is_empty())
                && params.is_changed(param.key)
        };
        !PARAMS.iter().any(changes)
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk")
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let (mut motion, mut on_body) = (Arc::clone(clips.first()?), None);
        if let Some(body) = clips.more.first() {
            let pairs = HasPart::<Pairs>::part(labs);
            let Some(pair) = pairs.on_body(&body.motion, &motion, params)? else {
                return Ok(None);
            };
            (motion, on_body) = (Arc::clone(&pair.incoming), Some(pair));
        }
        Ok(Some(Inputs::new(EditInputs {
            motion,
            on_body,
            edits: Edits::of(params),
            foot_lock: Lock::of(params),
        })))
    }
}

/// The parameters that mean something only on another body.
const WEIGHTS: [Key; 4] =
    [Key::RetargetFeet, Key::RetargetHands, Key::RetargetRightFoot, Key::RetargetRightHand];

/// An edit of a clip of the library that needs no panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClipEdit {
    /// Exchanges left and right.
    Mirror,
    /// Plays it backwards.
    Reverse,
    /// Declares it one cycle.
    Loop,
    /// Gives it another frame rate, in whole frames per second.
    Resample(u32),
}

/// Returns the parameters of the Edit lab with a clip and one edit.
pub(crate) fn edit_params(id: &str, edit: ClipEdit) -> Option<Params> {
    let mut params = Params::default();
    let value = match edit {
        ClipEdit::Mirror => (Key::Mirror, Sides::Mirrored.into()),
        ClipEdit::Reverse => (Key::Reverse, Direction::Backwards.into()),
        ClipEdit::Loop => (Key::AsLoop, Repeats::Cycle.into()),
        ClipEdit::Resample(fps) => (Key::Resample, Value::Number(f64::from(fps))),
    };
    for (key, value) in
        [(Key::Lab, LabId::Edit.into()), (Key::A, Value::Text(id.to_owned())), value]
    {
        params.set(key, value).ok()?;
    }
    Some(params)
}

/// Returns what the Edit lab does to a clip with these parameters, in the order in which it does
/// it; empty if nothing.
#[must_use]
pub fn edits_of(params: &Params) -> Vec<Message> {
    let edits = Edits::of(params);
    let mut done = Vec::new();
    match edits.secs {
        [Some(a), Some(b)] => {
            let (from, to) = (a.min(b), a.max(b));
            done.push(msg!("{from:.2} to {to:.2} s", from, to));
        }
        [Some(from), None] => done.push(msg!("from {from:.2} s", from)),
        [None, Some(to)] => done.push(msg!("to {to:.2} s", to)),
        [None, None] => {}
    }
    if edits.is_loop {
        done.push("as a loop".into());
    }
    if edits.is_reversed {
        done.push("reversed".into());
    }
    if edits.is_mirrored {
        done.push("mirrored".into());
    }
    if !params.clip_ids(Key::EditBody).is_empty() {
        done.push("on another body".into());
    }
    let spoken = |key: Key| key.param().spoken(params.get(key));
    if edits.fps.is_some() {
        done.push(msg!("{rate} fps", rate = spoken(Key::Resample)));
    }
    if edits.scale != 1.0 {
        done.push(msg!("scaled by {factor}", factor = spoken(Key::Scale)));
    }
    if edits.turn_deg != 0.0 {
        done.push(msg!("turned by {degrees}°", degrees = spoken(Key::Turn)));
    }
    if edits.shift_m != [0.0; 2] {
        done.push(msg!("moved by {x}, {z} m", x = spoken(Key::MoveX), z = spoken(Key::MoveZ)));
    }
    if Lock::of(params).is_some() {
        done.push("feet held".into());
    }
    done
}

/// The most rotations of an edited clip: frames times joints. They take 128 MiB.
const MAX_ROTATIONS: usize = 1 << 23;

/// The edits of a clip. They are applied in the order of the fields: trimmed, closed into a loop,
/// reversed, mirrored, resampled, scaled, turned and moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edits {
    /// The ends of the part that stays, seconds; those of the clip where they are not given.
    secs: [Option<f64>; 2],
    is_loop: bool,
    is_reversed: bool,
    is_mirrored: bool,
    /// The frame rate, frames per second; that of the clip where it is not given.
    fps: Option<f64>,
    scale: f64,
    /// The turn about the position of the first frame, degrees.
    turn_deg: f64,
    /// The shift over the ground, (x, z) in metres.
    shift_m: [f64; 2],
}

impl Edits {
    fn of(params: &Params) -> Self {
        Self {
            secs: [Key::EditFrom, Key::EditTo].map(|key| params.optional(key)),
            is_loop: params.choice::<Repeats>() == Repeats::Cycle,
            is_reversed: params.choice::<Direction>() == Direction::Backwards,
            is_mirrored: params.choice::<Sides>() == Sides::Mirrored,
            fps: params.optional(Key::Resample),
            scale: params.number(Key::Scale),
            turn_deg: params.number(Key::Turn),
            shift_m: [Key::MoveX, Key::MoveZ].map(|key| params.number(key)),
        }
    }

    /// Returns the frames of a clip that stay, the last one included: at least one.
    fn part(&self, motion: &Motion) -> Result<Range<usize>, LabError> {
        let last = motion.clip().frames().checked_sub(1).ok_or(LabError::NoFrames)?;
        let frame = |secs: f64| ((secs * motion.clip().fps()).round().max(0.0) as usize).min(last);
        let [a, b] = [self.secs[0].map_or(0, frame), self.secs[1].map_or(last, frame)];
        Ok(a.min(b)..a.max(b) + 1)
    }

    fn apply(&self, source: &Motion) -> Result<Motion, LabError> {
        let part = self.part(source)?;
        if let Some(fps) = self.fps {
            let joints = source.clip().skeleton().len();
            let frames = (part.len() as f64 * fps / source.clip().fps()).ceil() as usize;
            if frames.saturating_mul(joints) > MAX_ROTATIONS {
                return Err(LabError::TooManyFrames { frames, joints });
            }
        }
        let mut motion = source.cropped(part)?;
        if self.is_loop {
            motion = treat_as_cycle(&motion)?;
        }
        if self.is_reversed {
            motion = motion.reversed();
        }
        if self.is_mirrored {
            motion = motion.mirrored()?;
        }
        if let Some(fps) = self.fps {
            motion = motion.resampled(fps, Interpolation::Cubic)?;
        }
        if self.scale != 1.0 {
            motion = motion.scaled(self.scale as f32);
        }
        let place = self.world_from_clip(&motion);
        Ok(if place == Planar::IDENTITY { motion } else { motion.moved(&place) })
    }

    /// Returns the turn about the position of the first frame, followed by the shift.
    fn world_from_clip(&self, motion: &Motion) -> Planar {
        let first = motion.standing_at(0.0).shift;
        let turn = Planar::turn_about(self.turn_deg.to_radians(), first);
        let [x, z] = self.shift_m;
        if (self.turn_deg, x, z) == (0.0, 0.0, 0.0) {
            return Planar::IDENTITY;
        }
        Planar::new(0.0, x, z).after(&turn)
    }
}

/// The inputs of the result. Equal inputs give equal results.
#[derive(Clone, Debug)]
struct EditInputs {
    /// The clip, on another body if it gets one.
    motion: Arc<Motion>,
    on_body: Option<Arc<Pair>>,
    edits: Edits,
    foot_lock: Option<Lock>,
}

impl PartialEq for EditInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.motion, &other.motion)
            && self.edits == other.edits
            && self.foot_lock == other.foot_lock
    }
}

impl LabInputs for EditInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let part = self.edits.part(&self.motion)?;
        let free = self.edits.apply(&self.motion)?;
        let slid =
            |motion: &Motion| worst_foot_slide(motion.clip(), motion.roles(), motion.contacts());
        let fps = free.clip().fps();
        let mut slides = vec![slide(slid(&free), fps)];
        let motion = match self.foot_lock {
            None => free,
            Some(lock) => {
                let held = locked(&free, lock)?;
                slides = vec![slide(slid(&held), fps), slide_before(slid(&free))];
                held
            }
        };
        let clip = motion.clip();
        let mut metrics = vec![
            Metric::new(MetricId::ClipLength, clip.duration_secs()),
            Metric::new(MetricId::ClipFrames, clip.frames() as f64),
            Metric::new(
                MetricId::MeanSpeed,
                f64::from(ground_speed(motion.ground_frames(), clip.fps())),
            ),
        ];
        metrics.append(&mut slides);
        let secs = |frame: usize| frame as f64 / self.motion.clip().fps();
        let cycle = motion.is_cycle().then(|| Cycle {
            secs: clip.duration_secs(),
            made: CycleMade::Cut {
                from_secs: secs(part.start),
                to_secs: secs(part.end - 1),
                distance_cm: 0.0,
            },
        });
        let retargeted = self.on_body.as_ref().and_then(|pair| pair.retargeted.clone());
        Ok(Outcome { cycle, retargeted, metrics, ..Outcome::plain(Arc::new(motion)) })
    }
}

/// Returns a motion with its planted feet locked. The feet of a cycle are locked in the middle of
/// three repetitions, so that the locked cycle ends as it begins.
fn locked(motion: &Motion, lock: Lock) -> Result<Motion, LabError> {
    let (clip, frames) = (motion.clip(), motion.ground_frames());
    let (roles, ground_m) = (motion.roles(), motion.ground_m());
    let last = clip.frames().saturating_sub(1);
    let ends = frames.first().zip(frames.last()).filter(|_| motion.is_cycle() && last > 0);
    let Some((first, end)) = ends else {
        let held = with_feet(clip, roles, motion.contacts(), ground_m, Some(lock))?;
        return Ok(motion.with_clip(held, frames.to_vec()));
    };
    let cycle = end.after(&first.inverse());
    let before = clip.crop(0..last)?.transformed(&cycle.inverse());
    let three = Arc::new(repeat_clip(&before, &cycle, 3)?);
    let order: Vec<usize> = (0..3 * last).map(|frame| frame % last).collect();
    let contacts = motion.contacts().of_frames(&order);
    let held = with_feet(&three, roles, &contacts, ground_m, Some(lock))?;
    let middle = held.crop(last..2 * last)?;
    let whole = repeat_clip(&middle, &cycle, 2)?.crop(0..last + 1)?;
    Ok(motion.with_clip(whole, frames.to_vec()).declared_cycle(true))
}

#[cfg(test)]
mod tests;
