//! Locking of planted feet, and the distance that they slide.

use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::clip::{Clip, Contacts};
use segue_motion::metrics::Extreme;
use segue_motion::skeleton::Roles;
use segue_motion::transition::{FootLockError, FootLockOptions, FootLocking};
use std::sync::Arc;

/// Foot lock options for clips on ground of any height: [`FootLockOptions`] without the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lock {
    blend_secs: f64,
    max_shift_m: f32,
    clearance_m: Option<f32>,
}

impl Lock {
    /// Returns the options of the parameters; `None` if feet are not locked.
    pub(super) fn of(params: &Params) -> Option<Self> {
        let metres = |key| (params.number(key) / 100.0) as f32;
        params.is_on(Key::FootLock).then(|| Self {
            blend_secs: params.number(Key::LockBlend),
            max_shift_m: metres(Key::LockReach),
            clearance_m: Some(metres(Key::LockClearance)).filter(|&clearance_m| clearance_m > 0.0),
        })
    }

    /// Returns the options on ground of a height, metres.
    pub(super) fn on_ground(self, ground_m: f32) -> FootLockOptions {
        let Self { blend_secs, max_shift_m, clearance_m } = self;
        FootLockOptions { blend_secs, max_shift_m, ground_m: Some(ground_m), clearance_m }
    }
}

/// Starts locking the planted feet of a clip to ground at a height, metres. `None` for a body
/// without legs, whose result stays unchanged.
pub(super) fn locking(
    clip: Arc<Clip>,
    roles: &Roles,
    contacts: &Contacts,
    ground_m: f32,
    lock: Lock,
) -> Result<Option<FootLocking>, LabError> {
    match FootLocking::new(clip, roles, contacts, &lock.on_ground(ground_m)) {
        Ok(locking) => Ok(Some(locking)),
        Err(FootLockError::NoLegs) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Returns a clip unchanged, or with its planted feet locked as by [`locking`].
pub(super) fn with_feet(
    free: &Arc<Clip>,
    roles: &Roles,
    contacts: &Contacts,
    ground_m: f32,
    lock: Option<Lock>,
) -> Result<Arc<Clip>, LabError> {
    let Some(lock) = lock else {
        return Ok(Arc::clone(free));
    };
    match locking(Arc::clone(free), roles, contacts, ground_m, lock)? {
        Some(locking) => Ok(Arc::new(locking.finish()?)),
        None => Ok(Arc::clone(free)),
    }
}

/// Returns the metric of foot slide over a whole result, defined in all labs as
/// [`worst_foot_slide`](segue_motion::metrics::worst_foot_slide).
pub(super) fn slide(worst: Option<Extreme>, fps: f64) -> Metric {
    Metric::extreme(MetricId::FootSlide, worst, fps)
}

/// Returns the metric of foot slide without the foot lock. It has no place: that motion is not
/// shown.
pub(super) fn slide_before(worst: Option<Extreme>) -> Metric {
    Metric::new(MetricId::FootSlideBefore, worst.map(|slide| slide.value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Value;
    use segue_motion::registration::fixtures::Walk;

    /// Returns parameters with the foot lock on.
    fn locked() -> Params {
        let mut params = Params::default();
        params.set(Key::FootLock, Value::Switch(true)).unwrap();
        params
    }

    #[test]
    fn lock_of_default_parameters_has_default_options() {
        assert_eq!(Lock::of(&Params::default()), None);
        let lock = Lock::of(&locked()).unwrap();
        assert_eq!(lock.on_ground(0.0), FootLockOptions::default());
        assert_eq!(lock.on_ground(0.3).ground_m, Some(0.3));
    }

    #[test]
    fn lock_of_each_parameter_sets_one_option() {
        let mut params = locked();
        for (key, value) in
            [(Key::LockBlend, 0.5), (Key::LockReach, 12.0), (Key::LockClearance, 6.0)]
        {
            params.set(key, Value::Number(value)).unwrap();
        }
        let options = FootLockOptions {
            blend_secs: 0.5,
            max_shift_m: 0.12,
            ground_m: Some(0.0),
            clearance_m: Some(0.06),
        };
        assert_eq!(Lock::of(&params).unwrap().on_ground(0.0), options);
        params.set(Key::LockClearance, Value::Number(0.0)).unwrap();
        assert_eq!(
            Lock::of(&params).unwrap().on_ground(0.0).clearance_m,
            None,
            "swings stay as they are"
        );
    }

    #[test]
    fn locking_without_legs_changes_nothing() {
        let clip = Arc::new(Walk::default().clip());
        let roles = Roles::default();
        let contacts = Contacts::from_flags([vec![true; clip.frames()], vec![true; clip.frames()]]);
        assert!(Arc::ptr_eq(
            &with_feet(&clip, &roles, &contacts, 0.0, Lock::of(&locked())).unwrap(),
            &clip
        ));
    }
}
