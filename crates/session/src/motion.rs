use crate::choices::Curve;
use crate::params::{Key, Params, Value};
use segue_motion::clip::{
    Clip, ContactOptions, Contacts, CurveKind, character_frames, estimate_ground,
};
use segue_motion::math::{Planar, wrap_angle};
use segue_motion::skeleton::{Role, Roles};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// How the feet of a clip are read: when they are planted, and where the ground is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeetReading {
    /// When a foot counts as planted.
    pub contacts: ContactOptions,
    /// The height of the ground, metres; `None` where planted feet tell it.
    pub ground_m: Option<f32>,
}

impl FeetReading {
    /// Returns what the parameters ask for. A foot leaves the ground above 1.75 times the height
    /// and twice the speed at which it comes down.
    #[must_use]
    pub fn of(params: &Params) -> Self {
        let usual = ContactOptions::default();
        // Unchanged parameters are exactly the usual options: clips need not be read again.
        let share = |key: Key| match key.param().default_value() {
            Value::Number(default) => (params.number(key) / default) as f32,
            _ => 1.0,
        };
        let (height, speed) = (share(Key::ContactHeight), share(Key::ContactSpeed));
        Self {
            contacts: ContactOptions {
                enter_height_m: usual.enter_height_m * height,
                leave_height_m: usual.leave_height_m * height,
                enter_speed_mps: usual.enter_speed_mps * speed,
                leave_speed_mps: usual.leave_speed_mps * speed,
                ..usual
            },
            ground_m: params.optional(Key::Ground).map(|cm| (cm * 0.01) as f32),
        }
    }
}

/// Reads the feet of clips otherwise than usual, and keeps the last readings.
#[derive(Clone, Debug, Default)]
pub(super) struct FeetReader(VecDeque<(Arc<Motion>, Arc<Motion>)>);

impl FeetReader {
    /// More clips than that are not in one graph.
    const KEPT: usize = 64;

    /// Returns a motion with its feet read in this way.
    pub(super) fn read(&mut self, motion: &Arc<Motion>, feet: FeetReading) -> Arc<Motion> {
        if motion.feet == feet {
            return Arc::clone(motion);
        }
        if let Some((_, read)) =
            self.0.iter().find(|(of, read)| Arc::ptr_eq(of, motion) && read.feet == feet)
        {
            return Arc::clone(read);
        }
        let read = Arc::new(Motion {
            seams: motion.seams.clone(),
            ..Motion::analyze_feet((*motion.clip).clone(), Some(motion.roles.clone()), feet)
        });
        self.0.truncate(Self::KEPT - 1);
        self.0.push_front((Arc::clone(motion), Arc::clone(&read)));
        read
    }
}

/// A clip with what is derived from it once and used everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The clip.
    pub clip: Arc<Clip>,
    /// What its joints are for.
    pub roles: Roles,
    /// When which foot is planted.
    pub contacts: Contacts,
    /// Where the character stands and what it faces, one frame of reference per frame of the clip.
    pub ground_frames: Vec<Planar>,
    /// The frames in which one clip goes over into the next, in order: where a result was joined
    /// from clips.
    pub seams: Vec<Range<usize>>,
    /// The height of the ground under the clip, metres.
    pub ground_m: f32,
    /// How its feet were read.
    pub feet: FeetReading,
}

impl Motion {
    /// Derives everything from a clip; `roles` are found in the skeleton when none are given.
    #[must_use]
    pub fn analyze(clip: Clip, roles: Option<Roles>) -> Self {
        Self::analyze_feet(clip, roles, FeetReading::default())
    }

    /// Derives everything from a clip as [`analyze`](Self::analyze) does, its feet read in this
    /// way.
    #[must_use]
    pub fn analyze_feet(clip: Clip, roles: Option<Roles>, feet: FeetReading) -> Self {
        let roles = roles.unwrap_or_else(|| Roles::detect(clip.skeleton()));
        let contacts = Contacts::detect(&clip, &roles, &feet.contacts);
        let ground_frames = character_frames(&clip, &roles);
        Self {
            ground_m: feet.ground_m.unwrap_or_else(|| estimate_ground(&clip, &roles, &contacts)),
            feet,
            clip: Arc::new(clip),
            roles,
            contacts,
            ground_frames,
            seams: Vec::new(),
        }
    }

    /// The first frame from which on nothing is joined any more; 0 where nothing is.
    #[must_use]
    pub fn behind_seams(&self) -> usize {
        let last = self.clip.frames().saturating_sub(1);
        self.seams.iter().map(|seam| seam.end).max().unwrap_or(0).min(last)
    }

    /// The last frame up to which nothing is joined yet; that of the clip where nothing is.
    #[must_use]
    pub fn before_seams(&self) -> usize {
        let last = self.clip.frames().saturating_sub(1);
        self.seams.iter().map(|seam| seam.start).min().unwrap_or(last).min(last)
    }

    /// The seams as they lie in a motion that plays the same at another pace: `frame` says where
    /// one of this motion's frames plays there.
    pub(super) fn seams_at(&self, frame: impl Fn(usize) -> usize) -> Vec<Range<usize>> {
        self.seams.iter().map(|seam| frame(seam.start)..frame(seam.end)).collect()
    }

    /// The seams of a motion that is this one up to `own` and `next` behind it, whose frame
    /// `enters` plays where `own` begins.
    pub(super) fn seams_joined(
        &self,
        own: &Range<usize>,
        next: &Self,
        enters: usize,
    ) -> Vec<Range<usize>> {
        let before = self.seams.iter().filter(|seam| seam.start < own.start);
        let before = before.map(|seam| seam.start..seam.end.min(own.start));
        let behind = next.seams.iter().filter(|seam| seam.start >= enters);
        let behind =
            behind.map(|seam| seam.start - enters + own.start..seam.end - enters + own.start);
        before.chain([own.clone()]).chain(behind).collect()
    }

    /// The same with roles that were corrected by hand. Such as name joints that the skeleton has
    /// not, as those of another version's clip may, are left alone.
    #[must_use]
    pub fn with_roles(self, by_hand: Option<&Roles>) -> Self {
        let joints = self.clip.skeleton().len();
        let fits = |roles: &&Roles| {
            Role::ALL.into_iter().filter_map(|role| roles.get(role)).all(|joint| joint < joints)
        };
        match by_hand.filter(fits) {
            Some(roles) if *roles != self.roles => Self {
                seams: self.seams,
                ..Self::analyze_feet(
                    Arc::unwrap_or_clone(self.clip),
                    Some(roles.clone()),
                    self.feet,
                )
            },
            _ => self,
        }
    }

    /// Where the character stands and what it faces at a time; between two frames in proportion,
    /// beyond the ends as at them.
    #[must_use]
    pub fn standing_at(&self, secs: f64) -> Planar {
        let last = self.ground_frames.len().saturating_sub(1);
        // `max` takes NaN to 0.
        let at = (secs * self.clip.fps()).max(0.0).min(last as f64);
        let [here, next] = [at.floor() as usize, (at.floor() as usize + 1).min(last)]
            .map(|frame| self.ground_frames.get(frame));
        let (Some(here), Some(next)) = (here, next) else {
            return Planar::IDENTITY;
        };
        Planar {
            yaw: wrap_angle(here.yaw + wrap_angle(next.yaw - here.yaw) * at.fract()),
            shift: here.shift.lerp(next.shift, at.fract()),
        }
    }
}

/// The joint that a user names: a body part ("right foot") or a joint's name, whatever the case.
#[must_use]
pub fn joint_of(motion: &Motion, name: &str) -> Option<usize> {
    let role = Role::ALL.into_iter().find(|role| role.name().eq_ignore_ascii_case(name));
    let by_role = role.and_then(|role| motion.roles.get(role));
    by_role.or_else(|| {
        motion
            .clip
            .skeleton()
            .joints()
            .iter()
            .position(|joint| joint.name.eq_ignore_ascii_case(name))
    })
}

/// What a person calls a joint, and [`joint_of`] understands: its body part, else its own name.
#[must_use]
pub fn word_of_joint(motion: &Motion, joint: usize) -> &str {
    match motion.roles.role_of(joint) {
        Some(role) => role.name(),
        None => motion.clip.skeleton().joints().get(joint).map_or("", |joint| joint.name.as_str()),
    }
}

/// The curve that a word of the parameter `curve` means.
#[must_use]
pub fn curve_kind(curve: Curve) -> CurveKind {
    match curve {
        Curve::Height => CurveKind::Height,
        Curve::Angle => CurveKind::Angle,
        Curve::Turn => CurveKind::AngularSpeed,
        Curve::Speed => CurveKind::Speed,
    }
}

/// The frame that is nearest to a time. 0 for a clip without frames.
#[must_use]
pub fn frame_at(motion: &Motion, secs: f64) -> usize {
    let last = motion.clip.frames().saturating_sub(1) as f64;
    // The clamp turns a negative time into frame 0, and NaN too: `max` returns the other operand.
    (secs * motion.clip.fps()).round().max(0.0).min(last) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Outcome, Session};
    use segue_motion::skeleton::Side;

    fn outcome(link: &str) -> Arc<Outcome> {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.to_owned())).unwrap();
        while session.work() {}
        Arc::clone(session.main_outcome().unwrap())
    }

    fn planted(motion: &Motion) -> usize {
        let frames = 0..motion.contacts.frames();
        frames.filter(|&frame| motion.contacts.planted(Side::Left, frame)).count()
    }

    #[test]
    fn feet_are_read_as_the_parameters_ask() {
        let usual = outcome("lab=view&a=walk");
        assert_eq!((usual.motion.ground_m, usual.motion.feet), (0.0, FeetReading::default()));
        assert_eq!(FeetReading::of(&Params::default()), FeetReading::default());
        let raised = outcome("lab=view&a=walk&ground=5");
        assert!((raised.motion.ground_m - 0.05).abs() < 1e-6);
        let sunk = |outcome: &Outcome| {
            let metric =
                outcome.metrics.iter().find(|metric| metric.id == "clip_penetration_cm").unwrap();
            metric.value.unwrap()
        };
        // The lowest points of this body are toe tips, which stand 1 cm above the soles.
        assert!(
            (3.0..=5.0).contains(&(sunk(&raised) - sunk(&usual))),
            "{} {}",
            sunk(&raised),
            sunk(&usual)
        );
        let generous = outcome("lab=view&a=walk&contact_height=8&contact_speed=0.8");
        assert!(planted(&generous.motion) > planted(&usual.motion));
        // B on the skeleton and at the rate of A is read in the same way.
        let blended = outcome("lab=blend&a=walk&b=run&ground=5");
        assert!((blended.motion.ground_m - 0.05).abs() < 1e-6);
    }
}
