//! Options of analysing a motion, from the parameters.

use crate::choices::Curve;
use crate::params::{Key, Params, Value};
use segue_motion::clip::{ContactCorrections, ContactOptions, CurveKind, FootOptions, Motion};
use segue_motion::skeleton::Role;
use std::collections::VecDeque;
use std::sync::Arc;

/// Returns the options of the parameters for reading the feet of a clip. A foot leaves the ground
/// above 1.75 times the height and twice the speed at which it lands.
#[must_use]
pub fn foot_options(params: &Params) -> FootOptions {
    let usual = ContactOptions::default();
    // Default parameters give exactly the default options, so that clips need not be read again.
    let share = |key: Key| match key.param().default_value() {
        Value::Number(default) => (params.number(key) / default) as f32,
        _ => 1.0,
    };
    let (height, speed) = (share(Key::ContactHeight), share(Key::ContactSpeed));
    FootOptions {
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

/// A cache of clips whose feet were read with options other than the defaults, or whose contacts
/// were corrected.
#[derive(Clone, Debug, Default)]
pub(super) struct FeetReader(VecDeque<(Arc<Motion>, Arc<Motion>)>);

impl FeetReader {
    /// The greatest number of clips in one graph.
    const KEPT: usize = 64;

    /// Returns a motion with its feet read with these options, and with these corrections of its
    /// contacts.
    pub(super) fn read(
        &mut self,
        motion: &Arc<Motion>,
        feet: FootOptions,
        corrections: Option<&ContactCorrections>,
    ) -> Arc<Motion> {
        if let Some(known) = self.known(motion, feet, corrections) {
            return Arc::clone(known);
        }
        let mut read = Motion::clone(motion);
        if read.feet() != feet {
            read = read.with_feet(feet);
        }
        if let Some(corrections) = corrections {
            read = read.with_contact_corrections(corrections.clone());
        }
        let read = Arc::new(read);
        // While an edge is dragged, every frame has other corrections.
        self.0.retain(|(of, read)| !(Arc::ptr_eq(of, motion) && read.feet() == feet));
        self.0.truncate(Self::KEPT - 1);
        self.0.push_front((Arc::clone(motion), Arc::clone(&read)));
        read
    }

    /// Forgets clips that nothing else holds.
    pub(super) fn forget_dropped(&mut self) {
        self.0.retain(|(of, read)| Arc::strong_count(of) > 1 || Arc::strong_count(read) > 1);
    }

    /// Returns what [`read`](Self::read) returns, if it was read before.
    pub(super) fn known<'a>(
        &'a self,
        motion: &'a Arc<Motion>,
        feet: FootOptions,
        corrections: Option<&ContactCorrections>,
    ) -> Option<&'a Arc<Motion>> {
        if motion.feet() == feet && corrections.is_none() {
            return Some(motion);
        }
        let own = motion.contact_corrections();
        let is_read = |(of, read): &&(Arc<Motion>, Arc<Motion>)| {
            Arc::ptr_eq(of, motion)
                && read.feet() == feet
                && read.contact_corrections() == corrections.unwrap_or(own)
        };
        self.0.iter().find(is_read).map(|(_, read)| read)
    }
}

/// Returns the joint that a user names: a body part ("right foot") or a joint's name, in upper or
/// lower case.
#[must_use]
pub fn joint_of(motion: &Motion, name: &str) -> Option<usize> {
    let role = Role::ALL.into_iter().find(|role| role.name().eq_ignore_ascii_case(name));
    let by_role = role.and_then(|role| motion.roles().get(role));
    by_role.or_else(|| {
        motion
            .clip()
            .skeleton()
            .joints()
            .iter()
            .position(|joint| joint.name.eq_ignore_ascii_case(name))
    })
}

/// Returns the word for a joint that users know and [`joint_of`] accepts: its body part, otherwise
/// its own name.
#[must_use]
pub fn word_of_joint(motion: &Motion, joint: usize) -> &str {
    match motion.roles().role_of(joint) {
        Some(role) => role.name(),
        None => {
            motion.clip().skeleton().joints().get(joint).map_or("", |joint| joint.name.as_str())
        }
    }
}

/// Returns the curve of a value of the parameter `curve`.
#[must_use]
pub fn curve_kind(curve: Curve) -> CurveKind {
    match curve {
        Curve::Height => CurveKind::Height,
        Curve::Distance => CurveKind::Distance,
        Curve::Angle => CurveKind::Angle,
        Curve::Turn => CurveKind::AngularSpeed,
        Curve::Speed => CurveKind::Speed,
    }
}

/// Returns the frame that is nearest to a time; 0 for a clip without frames.
#[must_use]
pub fn frame_at(motion: &Motion, secs: f64) -> usize {
    let last = motion.clip().frames().saturating_sub(1) as f64;
    // The clamp maps negative times and NaN to frame 0: `max` returns the other operand.
    (secs * motion.clip().fps()).round().max(0.0).min(last) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{opened, settle};
    use crate::metrics::MetricId;
    use crate::{Command, Outcome};
    use segue_motion::clip::character_frames;
    use segue_motion::skeleton::Side;

    fn outcome(link: &str) -> Arc<Outcome> {
        Arc::clone(opened(link).main_outcome().unwrap())
    }

    fn planted(motion: &Motion) -> usize {
        let frames = 0..motion.contacts().frames();
        frames.filter(|&frame| motion.contacts().planted(Side::Left, frame)).count()
    }

    #[test]
    fn feet_are_read_with_the_options_of_the_parameters() {
        let usual = outcome("lab=view&a=walk");
        assert_eq!((usual.motion.ground_m(), usual.motion.feet()), (0.0, FootOptions::default()));
        assert_eq!(foot_options(&Params::default()), FootOptions::default());
        let raised = outcome("lab=view&a=walk&ground=5");
        assert!((raised.motion.ground_m() - 0.05).abs() < 1e-6);
        let penetration = |outcome: &Outcome| {
            let metric = outcome.metric(MetricId::ClipPenetration).unwrap();
            metric.value.unwrap()
        };
        // The lowest points of this body are toe tips, which stand 1 cm above the soles.
        assert!(
            (3.0..=5.0).contains(&(penetration(&raised) - penetration(&usual))),
            "{} {}",
            penetration(&raised),
            penetration(&usual)
        );
        let generous = outcome("lab=view&a=walk&contact_height=8&contact_speed=0.8");
        assert!(planted(&generous.motion) > planted(&usual.motion));
        // B on the skeleton and at the rate of A is read in the same way.
        let blended = outcome("lab=blend&a=walk&b=run&ground=5");
        assert!((blended.motion.ground_m() - 0.05).abs() < 1e-6);
    }

    #[test]
    fn feet_read_with_other_options_keep_blended_ground_frames() {
        let mut session = opened("lab=blend&a=walk_left&b=run");
        session.apply(Command::Keep(0)).unwrap();
        let kept = session.library().entries().last().unwrap();
        let (id, motion) = (kept.id.clone(), Arc::clone(kept.motion.as_ref().unwrap()));
        let measured = character_frames(motion.clip(), motion.roles());
        assert_ne!(motion.ground_frames(), measured, "the blend has ground frames of its own");
        let link = format!("lab=view&a={id}&ground=5&contact_height=8");
        session.apply(Command::OpenLink(link)).unwrap();
        settle(&mut session);
        let read = &session.main_outcome().unwrap().motion;
        assert_ne!((read.feet(), read.contacts()), (motion.feet(), motion.contacts()));
        assert_eq!(read.ground_frames(), motion.ground_frames());
    }
}
