//! Planted feet: held where they stand, and how far they slide.

use crate::clip::{Clip, Contacts};
use crate::metrics::Metric;
use crate::skeleton::Roles;
use crate::transition::{FootLockError, FootLockOptions, FootLocking};
use std::sync::Arc;

/// Begins to hold the planted feet of a clip above ground of a height, metres. `None` for a body without legs, which stays as it is: what cannot be held
/// is no reason to have no result.
pub(super) fn locking(clip: Arc<Clip>, roles: &Roles, contacts: &Contacts, ground_m: f32) -> Result<Option<FootLocking>, String> {
    let options = FootLockOptions {
        ground_m: Some(ground_m),
        ..FootLockOptions::default()
    };
    match FootLocking::new(clip, roles, contacts, &options) {
        Ok(locking) => Ok(Some(locking)),
        Err(FootLockError::NoLegs) => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

/// Returns a result as it is, or with its planted feet held as [`locking`] does.
pub(super) fn with_feet(free: &Arc<Clip>, roles: &Roles, contacts: &Contacts, ground_m: f32, locked: bool) -> Result<Arc<Clip>, String> {
    if !locked {
        return Ok(Arc::clone(free));
    }
    match locking(Arc::clone(free), roles, contacts, ground_m)? {
        Some(locking) => Ok(Arc::new(locking.finish().map_err(|error| error.to_string())?)),
        None => Ok(Arc::clone(free)),
    }
}

/// How far the feet of a whole result slide: in all labs as [`foot_slide_cm`](crate::metrics::foot_slide_cm) has it.
pub(super) fn slide(cm: Option<f64>) -> Metric {
    Metric::lower(
        "foot_slide_cm",
        "Foot slide",
        cm,
        "cm",
        "How far a planted foot slides in the worst stance.",
    )
}

/// How far the feet of a result would slide if they were not held.
pub(super) fn slide_before(cm: Option<f64>) -> Metric {
    Metric::fact(
        "foot_slide_before_cm",
        "Foot slide before the lock",
        cm,
        "cm",
        "How far a planted foot slides in the worst stance without the foot lock.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::fixtures::Walk;

    #[test]
    fn body_without_legs_stays_as_it_is() {
        let clip = Arc::new(Walk::default().clip());
        let roles = Roles::default();
        let contacts = Contacts::from_flags([vec![true; clip.frames()], vec![true; clip.frames()]]);
        assert!(Arc::ptr_eq(&with_feet(&clip, &roles, &contacts, 0.0, true).unwrap(), &clip));
    }
}
