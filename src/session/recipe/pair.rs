use super::Retargeted;
use crate::blend;
use crate::clip::{Interpolation, resample, retarget};
use crate::metrics::Profile;
use crate::session::motion::Motion;
use crate::skeleton::Retargeting;
use std::sync::Arc;

/// Two clips made ready for each other.
#[derive(Debug)]
pub(in crate::session) struct Pair {
    pub(super) a: Arc<Motion>,
    pub(super) b: Arc<Motion>,
    /// B on the skeleton and at the frame rate of A.
    pub(super) incoming: Arc<Motion>,
    /// What dissolve and metrics know of A and of `incoming`.
    pub(super) profiles: [Profile; 2],
    /// How B came onto A's skeleton, where that is not its own.
    pub(super) retargeted: Option<Arc<Retargeted>>,
}

impl Pair {
    fn new(a: &Arc<Motion>, b: &Arc<Motion>) -> Result<Self, String> {
        let same_skeleton = Arc::ptr_eq(a.clip.skeleton(), b.clip.skeleton()) || a.clip.skeleton() == b.clip.skeleton();
        let same_rate = (a.clip.fps() - b.clip.fps()).abs() <= 1e-4 * a.clip.fps();
        let incoming = if same_skeleton && same_rate {
            Arc::clone(b)
        } else {
            let mut clip = (*b.clip).clone();
            if !same_skeleton {
                clip = retarget(&clip, &b.roles, a.clip.skeleton(), &a.roles).map_err(|error| error.to_string())?;
            }
            if !same_rate {
                clip = resample(&clip, a.clip.fps(), Interpolation::Linear).map_err(|error| error.to_string())?;
            }
            let roles = if same_skeleton { b.roles.clone() } else { a.roles.clone() };
            Arc::new(Motion::analyze(clip, Some(roles)))
        };
        let profiles = [a, &incoming].map(|motion| {
            let source = blend::Source::with_frames(Arc::clone(&motion.clip), &motion.roles, motion.ground_frames.clone());
            Profile::new(Arc::new(source), &motion.roles, motion.contacts.clone())
        });
        Ok(Self {
            a: Arc::clone(a),
            b: Arc::clone(b),
            incoming,
            profiles,
            retargeted: (!same_skeleton).then(|| Arc::new(Retargeted::between(a, b))),
        })
    }
}

impl Retargeted {
    /// What happens to `b` on the skeleton of `a`.
    fn between(a: &Motion, b: &Motion) -> Self {
        let skeleton = a.clip.skeleton();
        let way = Retargeting::new(b.clip.skeleton(), &b.roles, skeleton, &a.roles);
        let joints = skeleton.joints().iter().enumerate();
        let unmoved = joints.filter(|(joint, _)| way.as_ref().is_none_or(|way| !way.moves(*joint)));
        Self {
            unmatched: unmoved.map(|(_, joint)| joint.name.clone()).collect(),
        }
    }
}

/// Makes pairs, and keeps the last one: labs and panes share it.
#[derive(Debug, Default)]
pub(in crate::session) struct Pairs(Option<Arc<Pair>>);

impl Pairs {
    /// B on the skeleton and at the rate of A.
    pub(in crate::session) fn of(&mut self, a: &Arc<Motion>, b: &Arc<Motion>) -> Result<Arc<Pair>, String> {
        if let Some(pair) = &self.0
            && Arc::ptr_eq(&pair.a, a)
            && Arc::ptr_eq(&pair.b, b)
        {
            return Ok(Arc::clone(pair));
        }
        let pair = Arc::new(Pair::new(a, b)?);
        self.0 = Some(Arc::clone(&pair));
        Ok(pair)
    }
}
