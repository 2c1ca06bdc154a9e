//! Planted feet: held where they stand, and how far they slide.

use crate::clip::{Clip, Contacts};
use crate::metrics::Metric;
use crate::skeleton::Roles;
use crate::transition::{FootLockOptions, foot_lock};
use std::sync::Arc;

/// A result as it is, or with its planted feet held.
pub(super) fn with_feet(free: &Arc<Clip>, roles: &Roles, contacts: &Contacts, locked: bool) -> Result<Arc<Clip>, String> {
    if !locked {
        return Ok(Arc::clone(free));
    }
    let locked = foot_lock(free, roles, contacts, &FootLockOptions::default());
    Ok(Arc::new(locked.map_err(|error| error.to_string())?))
}

/// How far the feet of a whole result slide.
pub(super) fn slide(cm: Option<f64>) -> Metric {
    Metric::lower(
        "skate_cm",
        "Foot slide",
        cm,
        "cm",
        "How far a planted foot slides in the worst stance.",
    )
}

/// How far the feet of a result would slide if they were not held, by the measure that stands beside it.
pub(super) fn slide_before(cm: Option<f64>) -> Metric {
    Metric::fact(
        "skate_before_cm",
        "Foot slide before the lock",
        cm,
        "cm",
        "How far planted feet slide without the foot lock, measured in the same way.",
    )
}
