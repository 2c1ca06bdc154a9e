//! Clips with the quantities that are derived from them once and used everywhere.

use super::{
    Clip, ContactCorrections, ContactOptions, Contacts, UsualMotion, character_frames,
    estimate_ground,
};
use crate::math::{Planar, wrap_angle};
use crate::skeleton::{Role, Roles};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

mod analysis;

pub use analysis::MotionAnalysis;

/// The greatest number of frames that are sampled to find the body plan.
const MAX_PLAN_SAMPLES: usize = 60;

/// Options for the feet of a clip: the contacts, and the height of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootOptions {
    /// The thresholds for planted feet.
    pub contacts: ContactOptions,
    /// The height of the ground, metres; `None` to estimate it from the planted feet.
    pub ground_m: Option<f32>,
}

/// A clip with its joint roles, ground frames, foot contacts and ground height: the input of every
/// algorithm that combines clips.
///
/// [`analyze`](Self::analyze) makes it once; then it is shared in an [`Arc`]. Ground frames,
/// contacts and ground height are computed on first use, each in O(frames × joints), and kept,
/// unless they are given ([`with_ground_frames`](Self::with_ground_frames),
/// [`with_contacts`](Self::with_contacts), [`with_ground_m`](Self::with_ground_m)). Contacts may be
/// corrected by hand ([`with_contact_corrections`](Self::with_contact_corrections)).
#[derive(Clone, Debug)]
pub struct Motion {
    clip: Arc<Clip>,
    roles: Roles,
    ground_frames: OnceLock<Vec<Planar>>,
    feet: FootOptions,
    /// The contacts before corrections.
    found_contacts: OnceLock<Contacts>,
    corrections: ContactCorrections,
    /// The corrected contacts; unused without corrections.
    contacts: OnceLock<Contacts>,
    ground_m: OnceLock<f32>,
    usual: OnceLock<UsualMotion>,
    seams: Vec<Range<usize>>,
    is_cycle: bool,
}

impl PartialEq for Motion {
    /// Quantities that are computed on demand are computed here if necessary.
    fn eq(&self, other: &Self) -> bool {
        self.clip == other.clip
            && self.roles == other.roles
            && self.ground_frames() == other.ground_frames()
            && self.feet == other.feet
            && (&self.seams, self.is_cycle) == (&other.seams, other.is_cycle)
            && self.ground_m() == other.ground_m()
            && self.contacts() == other.contacts()
    }
}

/// Returns roles with the body plan of a clip: that of the rest pose, or, where that does not
/// stand, that of the frames ([`Roles::with_plan_of`]). It belongs to a file: a part of its clip,
/// or a result, has the plan of its roles.
#[must_use]
pub fn with_body_plan_of(clip: &Clip, roles: Roles) -> Roles {
    let step = clip.frames().div_ceil(MAX_PLAN_SAMPLES).max(1);
    let poses = (0..clip.frames()).step_by(step).map(|frame| clip.world_pose(frame));
    roles.with_plan_of(clip.skeleton(), poses)
}

impl Motion {
    /// Analyses a clip; the roles of its joints are found in its skeleton ([`Roles::detect`]), and
    /// its frames show whether it stands on four legs where the rest pose does not
    /// ([`with_body_plan_of`]).
    #[must_use]
    pub fn analyze(clip: impl Into<Arc<Clip>>) -> Self {
        let clip = clip.into();
        let roles = with_body_plan_of(&clip, Roles::detect(clip.skeleton()));
        Self::with_roles(clip, &roles)
    }

    /// Analyses a clip whose joints have these roles, on a body of their plan.
    #[must_use]
    pub fn with_roles(clip: impl Into<Arc<Clip>>, roles: &Roles) -> Self {
        Self {
            clip: clip.into(),
            roles: roles.clone(),
            ground_frames: OnceLock::new(),
            feet: FootOptions::default(),
            found_contacts: OnceLock::new(),
            corrections: ContactCorrections::default(),
            contacts: OnceLock::new(),
            ground_m: OnceLock::new(),
            usual: OnceLock::new(),
            seams: Vec::new(),
            is_cycle: false,
        }
    }

    /// Returns the motion of a clip with known ground frames ([`character_frames`]), one per frame.
    /// Missing ones repeat the last one; surplus ones are ignored.
    #[must_use]
    pub fn with_ground_frames(
        clip: impl Into<Arc<Clip>>,
        roles: &Roles,
        mut ground_frames: Vec<Planar>,
    ) -> Self {
        let clip = clip.into();
        let last = ground_frames.last().copied().unwrap_or(Planar::IDENTITY);
        ground_frames.resize(clip.frames(), last);
        Self { ground_frames: ground_frames.into(), ..Self::with_roles(clip, roles) }
    }

    /// Returns the same motion with its feet read by other options: contacts and ground height are
    /// computed anew. Corrections of the contacts stay.
    #[must_use]
    pub fn with_feet(self, feet: FootOptions) -> Self {
        Self {
            feet,
            found_contacts: OnceLock::new(),
            contacts: OnceLock::new(),
            ground_m: OnceLock::new(),
            ..self
        }
    }

    /// Returns the same motion with these contacts in place of those that would be detected, and
    /// without corrections of them.
    #[must_use]
    pub fn with_contacts(self, contacts: Contacts) -> Self {
        let corrections = ContactCorrections::default();
        Self { found_contacts: contacts.into(), corrections, contacts: OnceLock::new(), ..self }
    }

    /// Returns the same motion with its contacts corrected by hand, in place of earlier
    /// corrections. The height of the ground is estimated anew.
    #[must_use]
    pub fn with_contact_corrections(self, corrections: ContactCorrections) -> Self {
        if corrections == self.corrections {
            return self;
        }
        Self { corrections, contacts: OnceLock::new(), ground_m: OnceLock::new(), ..self }
    }

    /// Returns the same motion with this height of the ground in place of an estimate, metres.
    #[must_use]
    pub fn with_ground_m(self, ground_m: f32) -> Self {
        Self { ground_m: ground_m.into(), ..self }
    }

    /// Returns the same motion with these seams ([`seams`](Self::seams)).
    #[must_use]
    pub fn with_seams(self, seams: Vec<Range<usize>>) -> Self {
        Self { seams, ..self }
    }

    /// Returns the same motion, declared one cycle or not ([`is_cycle`](Self::is_cycle)). The last
    /// frame of a cycle has the pose of its first one; `treat_as_cycle` in
    /// [`transition`](crate::transition) closes a clip and declares it.
    #[must_use]
    pub fn declared_cycle(self, is_cycle: bool) -> Self {
        Self { is_cycle, ..self }
    }

    /// Returns the motion of a changed clip with as many frames: its ground frames are given, and
    /// contacts and ground height are those of this motion.
    #[must_use]
    pub fn with_clip(&self, clip: impl Into<Arc<Clip>>, ground_frames: Vec<Planar>) -> Self {
        Self::with_ground_frames(clip, &self.roles, ground_frames)
            .with_feet(self.feet)
            .with_contacts(self.contacts().clone())
            .with_ground_m(self.ground_m())
            .with_seams(self.seams.clone())
    }

    /// Returns the motion of another clip of the same skeleton, whose ground frames are known.
    #[must_use]
    pub(crate) fn same_body(&self, clip: Clip, ground_frames: Vec<Planar>) -> Self {
        Self::with_ground_frames(clip, &self.roles, ground_frames).with_feet(self.feet)
    }

    /// Returns the same motion moved over the ground ([`Clip::transformed`]).
    #[must_use]
    pub fn moved(&self, world_from_clip: &Planar) -> Self {
        let frames =
            self.ground_frames().iter().map(|frame| world_from_clip.after(frame)).collect();
        Self {
            found_contacts: self.found_contacts.clone(),
            corrections: self.corrections.clone(),
            contacts: self.contacts.clone(),
            ground_m: self.ground_m.clone(),
            seams: self.seams.clone(),
            is_cycle: self.is_cycle,
            ..self.same_body(self.clip.transformed(world_from_clip), frames)
        }
    }

    /// Returns the same motion with corrected roles, and the body plan that goes with them. Roles
    /// of joints that the skeleton does not have, as they may be stored for another version of the
    /// clip, are ignored.
    #[must_use]
    pub fn with_corrected_roles(self, roles: &Roles) -> Self {
        let joints = self.clip.skeleton().len();
        let fits =
            Role::ALL.into_iter().filter_map(|role| roles.get(role)).all(|joint| joint < joints);
        if !fits || *roles == self.roles {
            return self;
        }
        let roles = with_body_plan_of(&self.clip, roles.clone());
        Self::with_roles(self.clip, &roles)
            .with_feet(self.feet)
            .with_contact_corrections(self.corrections)
            .with_seams(self.seams)
            .declared_cycle(self.is_cycle)
    }

    /// Returns the clip.
    #[must_use]
    pub fn clip(&self) -> &Arc<Clip> {
        &self.clip
    }

    /// Returns the roles of the joints.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        &self.roles
    }

    /// Returns the ground frames of the character, `world_from_character`, one per frame of the
    /// clip.
    #[must_use]
    pub fn ground_frames(&self) -> &[Planar] {
        self.ground_frames.get_or_init(|| character_frames(&self.clip, &self.roles))
    }

    /// Returns the options by which its feet are read.
    #[must_use]
    pub fn feet(&self) -> FootOptions {
        self.feet
    }

    /// Returns the frames in which each foot is planted.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        if self.corrections.is_empty() {
            return self.found_contacts();
        }
        self.contacts.get_or_init(|| self.corrections.applied_to(self.found_contacts()))
    }

    /// Returns the contacts before corrections: those that were detected or given.
    #[must_use]
    pub fn found_contacts(&self) -> &Contacts {
        let detect = || Contacts::detect(&self.clip, &self.roles, &self.feet.contacts);
        self.found_contacts.get_or_init(detect)
    }

    /// Returns the corrections of its contacts by hand.
    #[must_use]
    pub fn contact_corrections(&self) -> &ContactCorrections {
        &self.corrections
    }

    /// Returns the height of the ground under the clip, metres.
    #[must_use]
    pub fn ground_m(&self) -> f32 {
        let estimate = || estimate_ground(&self.clip, &self.roles, self.contacts());
        *self.ground_m.get_or_init(|| self.feet.ground_m.unwrap_or_else(estimate))
    }

    /// Returns the ground frames, if they are computed or given.
    #[must_use]
    pub fn known_ground_frames(&self) -> Option<&[Planar]> {
        self.ground_frames.get().map(Vec::as_slice)
    }

    /// Returns the contacts before corrections, if they are detected or given.
    #[must_use]
    pub fn known_contacts(&self) -> Option<&Contacts> {
        self.found_contacts.get()
    }

    /// Returns the height of the ground, metres, if it is estimated or given.
    #[must_use]
    pub fn known_ground_m(&self) -> Option<f32> {
        self.ground_m.get().copied()
    }

    /// Returns the usual speeds of its joints and root; measured on first use and kept.
    pub(crate) fn usual(&self) -> &UsualMotion {
        self.usual.get_or_init(|| UsualMotion::of(self))
    }

    /// Returns the height of the body in its rest pose, metres ([`Roles::body_height`]).
    #[must_use]
    pub fn body_height(&self) -> f32 {
        self.roles.body_height(self.clip.skeleton())
    }

    /// Returns the frames at which a result changes from one of its source clips to the next, in
    /// order.
    #[must_use]
    pub fn seams(&self) -> &[Range<usize>] {
        &self.seams
    }

    /// Returns whether the clip was declared one cycle: its last frame is its first, one cycle
    /// later. Where cycles are used, a declared one is taken whole, whatever its poses.
    #[must_use]
    pub fn is_cycle(&self) -> bool {
        self.is_cycle
    }

    /// Returns the first frame after all seams; 0 without seams.
    #[must_use]
    pub fn behind_seams(&self) -> usize {
        let last = self.clip.frames().saturating_sub(1);
        self.seams.iter().map(|seam| seam.end).max().unwrap_or(0).min(last)
    }

    /// Returns the last frame before all seams; that of the clip without seams.
    #[must_use]
    pub fn before_seams(&self) -> usize {
        let last = self.clip.frames().saturating_sub(1);
        self.seams.iter().map(|seam| seam.start).min().unwrap_or(last).min(last)
    }

    /// Returns the seams in a motion that plays the same at another pace: `frame` gives the frame
    /// at which one of this motion's frames plays there.
    #[must_use]
    pub fn seams_at(&self, frame: impl Fn(usize) -> usize) -> Vec<Range<usize>> {
        self.seams.iter().map(|seam| frame(seam.start)..frame(seam.end)).collect()
    }

    /// Returns the seams of a motion that is this one up to frame `own`, followed by `next` from
    /// its frame `enter` on.
    #[must_use]
    pub fn seams_joined(&self, own: &Range<usize>, next: &Self, enter: usize) -> Vec<Range<usize>> {
        let before = self.seams.iter().filter(|seam| seam.start < own.start);
        let before = before.map(|seam| seam.start..seam.end.min(own.start));
        let behind = next.seams.iter().filter(|seam| seam.start >= enter);
        let behind =
            behind.map(|seam| seam.start - enter + own.start..seam.end - enter + own.start);
        before.chain([own.clone()]).chain(behind).collect()
    }

    /// Returns the ground frame of the character at a time: interpolated between two frames, and
    /// that of the nearest frame outside the clip.
    #[must_use]
    pub fn standing_at(&self, secs: f64) -> Planar {
        let frames = self.ground_frames();
        let last = frames.len().saturating_sub(1);
        // `max` takes NaN to 0.
        let at = (secs * self.clip.fps()).max(0.0).min(last as f64);
        let [here, next] = [at.floor() as usize, (at.floor() as usize + 1).min(last)]
            .map(|frame| frames.get(frame));
        let (Some(here), Some(next)) = (here, next) else {
            return Planar::IDENTITY;
        };
        Planar {
            yaw: wrap_angle(here.yaw + wrap_angle(next.yaw - here.yaw) * at.fract()),
            shift: here.shift.lerp(next.shift, at.fract()),
        }
    }

    /// Returns the step of the character into `frame`, in its own frame at the frame before; for
    /// frame 0 the step that follows it.
    pub(crate) fn step_into(&self, frame: usize) -> Planar {
        let frame = frame.max(1);
        let frames = self.ground_frames();
        match (frames.get(frame - 1), frames.get(frame)) {
            (Some(before), Some(here)) => before.inverse().after(here),
            _ => Planar::IDENTITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::ContactCorrection;
    use crate::skeleton::Side;
    use crate::synth::{Action, Params, synthesize};

    fn walk() -> Clip {
        synthesize(&Params::new(Action::Walk)).unwrap().clip
    }

    #[test]
    fn contacts_and_ground_are_detected_on_first_use() {
        let motion = Motion::analyze(walk());
        let contacts = Contacts::detect(motion.clip(), motion.roles(), &ContactOptions::default());
        assert_eq!(*motion.contacts(), contacts);
        assert_eq!(motion.ground_m(), estimate_ground(motion.clip(), motion.roles(), &contacts));
        assert_eq!(motion, Motion::analyze(walk()));
    }

    #[test]
    fn given_contacts_and_ground_are_kept_by_a_changed_clip() {
        let frames = walk().frames();
        let none = Contacts::from_flags(Side::BOTH.map(|_| vec![false; frames]));
        let motion = Motion::analyze(walk()).with_contacts(none.clone()).with_ground_m(0.5);
        let changed = motion.with_clip(walk(), motion.ground_frames().to_vec());
        assert_eq!((changed.contacts(), changed.ground_m()), (&none, 0.5));
        let anew = changed.with_feet(FootOptions { ground_m: Some(0.1), ..FootOptions::default() });
        assert_ne!(*anew.contacts(), none);
        assert_eq!(anew.ground_m(), 0.1);
    }

    #[test]
    fn corrected_contacts_overrule_what_is_found_or_given() {
        let motion = Motion::analyze(walk());
        let (found, frames) = (motion.contacts().clone(), walk().frames());
        let all: ContactCorrections = Side::BOTH
            .map(|side| ContactCorrection { foot: side.into(), frames: 0..frames, planted: true })
            .into_iter()
            .collect();
        let corrected = motion.clone().with_contact_corrections(all.clone());
        assert!((0..frames).all(|frame| corrected.contacts().planted(Side::Left, frame)));
        assert_eq!((corrected.found_contacts(), corrected.contact_corrections()), (&found, &all));
        let raised = motion.clone().with_ground_m(0.5).with_contact_corrections(all.clone());
        assert_eq!(raised.ground_m(), motion.ground_m(), "estimated anew");
        // Other thresholds leave them alone, as does a place on the ground; new contacts end them.
        let strict = ContactOptions { min_secs: 10.0, ..ContactOptions::default() };
        let strict = FootOptions { contacts: strict, ground_m: None };
        let read = corrected.clone().with_feet(strict);
        assert_eq!(read.contacts(), corrected.contacts());
        assert_ne!(read.found_contacts(), &found);
        let there = Planar::new(0.3, 1.0, 0.0);
        assert_eq!(corrected.moved(&there).contacts(), corrected.contacts());
        assert_eq!(corrected.clone().with_contacts(found.clone()).contacts(), &found);
        let back = corrected.with_contact_corrections(ContactCorrections::default());
        assert_eq!(back, motion);
    }

    #[test]
    fn ground_frames_are_as_many_as_the_frames_of_the_clip() {
        let roles = Roles::default();
        let place = Planar::new(0.5, 1.0, 2.0);
        let short = Motion::with_ground_frames(walk(), &roles, vec![place]);
        assert_eq!(short.ground_frames(), vec![place; walk().frames()]);
        let long = Motion::with_ground_frames(walk(), &roles, vec![place; 100_000]);
        assert_eq!(long.ground_frames().len(), walk().frames());
        let none = Motion::with_ground_frames(walk(), &roles, Vec::new());
        assert_eq!(none.standing_at(0.3), Planar::IDENTITY);
    }

    #[test]
    fn corrected_roles_that_do_not_fit_are_ignored() {
        let motion = Motion::analyze(walk());
        let mut strange = motion.roles().clone();
        strange.set(Role::Head, Some(10_000));
        assert_eq!(motion.clone().with_corrected_roles(&strange), motion);
        let mut headless = motion.roles().clone();
        headless.set(Role::Head, None);
        let corrected = motion.with_corrected_roles(&headless);
        assert_eq!(*corrected.roles(), headless);
    }
}
