//! The derived quantities of a motion as data, so that another thread can compute them.

use super::Motion;
use crate::clip::Contacts;
use crate::math::Planar;

/// The quantities that are derived from a motion on first use.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionAnalysis {
    /// The ground frames ([`Motion::ground_frames`]).
    pub ground_frames: Vec<Planar>,
    /// The contacts before corrections ([`Motion::found_contacts`]).
    pub contacts: Contacts,
    /// The height of the ground, metres ([`Motion::ground_m`]).
    pub ground_m: f32,
}

impl Motion {
    /// Computes everything that is derived from it and not yet known.
    #[must_use]
    pub fn analysis(&self) -> MotionAnalysis {
        MotionAnalysis {
            ground_frames: self.ground_frames().to_vec(),
            contacts: self.found_contacts().clone(),
            ground_m: self.ground_m(),
        }
    }

    /// Returns whether everything in its [analysis](Self::analysis) is known.
    #[must_use]
    pub fn is_analyzed(&self) -> bool {
        self.known_ground_frames().is_some()
            && self.known_contacts().is_some()
            && self.known_ground_m().is_some()
    }

    /// Takes in the analysis of an equal motion, which was computed elsewhere. What is known stays.
    /// Returns `false`, and takes nothing, where it is that of a clip of another length.
    pub fn learn(&self, analysis: MotionAnalysis) -> bool {
        let frames = self.clip().frames();
        let MotionAnalysis { ground_frames, contacts, ground_m } = analysis;
        if ground_frames.len() != frames || contacts.frames() != frames {
            return false;
        }
        self.ground_frames.get_or_init(|| ground_frames);
        self.found_contacts.get_or_init(|| contacts);
        self.ground_m.get_or_init(|| ground_m);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn motion_that_learns_equals_one_that_computes() {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let (motion, same) = (Motion::analyze(clip.clone()), Motion::analyze(clip.clone()));
        assert!(!motion.is_analyzed());
        let analysis = motion.analysis();
        assert!(motion.is_analyzed() && !same.is_analyzed());
        assert!(same.learn(analysis.clone()) && same.is_analyzed());
        assert_eq!((&same.analysis(), &same), (&analysis, &motion));
        // Known quantities stay, and the analysis of another clip is refused.
        let raised = Motion::analyze(clip.clone()).with_ground_m(0.5);
        assert!(raised.learn(analysis.clone()));
        assert_eq!((raised.ground_m(), raised.contacts()), (0.5, motion.contacts()));
        let other = Motion::analyze(clip.crop(0..clip.frames() - 1).unwrap());
        assert!(!other.learn(analysis) && !other.is_analyzed());
    }
}
