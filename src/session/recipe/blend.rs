use super::{Outcome, Slot, Source, Transition};
use crate::blend::{self, DissolveOptions, RootBlend, WeightLaw};
use crate::clip::{Contacts, Interpolation, resample, retarget};
use crate::math::Planar;
use crate::metrics::{Profile, Subject, TransitionMetrics};
use crate::registration::{Region, SearchOptions, TransitionSearch, limb_weights};
use crate::session::motion::Motion;
use crate::session::params::{Key, Params};
use std::sync::Arc;

/// What a blend depends on. Equal inputs, equal result.
#[derive(Clone, Debug)]
pub(in crate::session) struct BlendInputs {
    pair: Arc<Pair>,
    place: Place,
    options: DissolveOptions,
}

impl PartialEq for BlendInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pair, &other.pair) && self.place == other.place && self.options == other.options
    }
}

/// Where A is left and B entered.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    leave: usize,
    enter: usize,
    distance_cm: f32,
}

/// Two clips made ready for each other.
#[derive(Debug)]
struct Pair {
    a: Arc<Motion>,
    b: Arc<Motion>,
    /// B on the skeleton and at the frame rate of A.
    incoming: Arc<Motion>,
    /// What dissolve and metrics know of A and of `incoming`.
    profiles: [Profile; 2],
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
        })
    }
}

/// Makes blends, and keeps what does not change from one to the next: the pair of clips and the distances between their frames.
#[derive(Debug, Default)]
pub(in crate::session) struct Blender {
    pair: Option<Arc<Pair>>,
    search: Option<TransitionSearch>,
    progress: f32,
}

/// Rows of the distance grid in one slice: about 2 ms for 31 joints in a browser.
const ROWS_PER_SLICE: usize = 16;
/// Rows that are compared at once when the clips change: a few seconds of motion need no second slice.
const ROWS_AT_ONCE: usize = 160;

impl Blender {
    /// Brings everything to the point where the blend itself is a pure function: finds the place, makes the clips fit each other.
    pub(in crate::session) fn inputs(
        &mut self,
        a: &Arc<Motion>,
        b: &Arc<Motion>,
        params: &Params,
        match_window: usize,
    ) -> Result<BlendInputs, String> {
        let pair = self.pair(a, b)?;
        let (frames_a, frames_b) = (pair.a.clip.frames(), pair.incoming.clip.frames());
        let window = (params.number(Key::BlendWindow) as usize).min(frames_a).min(frames_b);
        let fps = pair.a.clip.fps();
        let frame = |key, frames: usize| {
            params
                .optional(key)
                .map(|secs| ((secs * fps).round() as usize).min(frames.saturating_sub(window)))
        };
        let match_window = match_window.min(frames_a).min(frames_b);
        let place = self.place(&pair, match_window, frame(Key::LeaveA, frames_a), frame(Key::EnterB, frames_b))?;
        let law = match params.text(Key::WeightLaw) {
            "linear" => WeightLaw::Linear,
            "smoother" => WeightLaw::Smoother,
            _ => WeightLaw::Smooth,
        };
        let root = if params.is_on(Key::RootBlend) {
            RootBlend::Velocity
        } else {
            RootBlend::World
        };
        Ok(BlendInputs {
            pair,
            place,
            options: DissolveOptions {
                window,
                law,
                align: params.is_on(Key::Align),
                root,
            },
        })
    }

    fn pair(&mut self, a: &Arc<Motion>, b: &Arc<Motion>) -> Result<Arc<Pair>, String> {
        if let Some(pair) = &self.pair
            && Arc::ptr_eq(&pair.a, a)
            && Arc::ptr_eq(&pair.b, b)
        {
            return Ok(Arc::clone(pair));
        }
        let pair = Arc::new(Pair::new(a, b)?);
        let weights = limb_weights(pair.a.clip.skeleton());
        let body_height = pair.a.roles.body_height(pair.a.clip.skeleton());
        let search = TransitionSearch::new(
            Arc::clone(&pair.a.clip),
            Arc::clone(&pair.incoming.clip),
            &weights,
            body_height.into(),
        );
        self.search = Some(search.map_err(|error| error.to_string())?);
        self.pair = Some(Arc::clone(&pair));
        self.compare_rows(ROWS_AT_ONCE);
        Ok(pair)
    }

    fn compare_rows(&mut self, rows: usize) {
        if let Some(search) = &mut self.search {
            let progress = search.advance(rows);
            self.progress = if progress.is_complete() {
                1.0
            } else {
                progress.done as f32 / progress.total.max(1) as f32
            };
        }
    }

    /// The frames that the user named, and the best match for what is left open. Until the distances are known, the middle of what is allowed.
    fn place(&self, pair: &Pair, window: usize, leave: Option<usize>, enter: Option<usize>) -> Result<Place, String> {
        let search = self.search.as_ref().ok_or("there are no clips to match")?;
        let (frames_a, frames_b) = (pair.a.clip.frames(), pair.incoming.clip.frames());
        let mut options = SearchOptions::new(window);
        if let Some(frame) = leave {
            options.leave = Region::frame(frame, frames_a);
        }
        if let Some(frame) = enter {
            options.enter = Region::frame(frame, frames_b);
        }
        if self.is_searching() {
            let place = Place {
                leave: leave.unwrap_or((frames_a * 3 / 4).min(frames_a.saturating_sub(window))),
                enter: enter.unwrap_or(0),
                distance_cm: f32::NAN,
            };
            return Ok(place);
        }
        let best = search.best(&options).map_err(|error| error.to_string())?;
        Ok(Place {
            leave: leave.unwrap_or(best.leave),
            enter: enter.unwrap_or(best.enter),
            distance_cm: best.rms_cm as f32,
        })
    }

    /// One slice of comparing frames. `false` when there was nothing to do.
    pub(in crate::session) fn work(&mut self) -> bool {
        let searching = self.is_searching();
        if searching {
            self.compare_rows(ROWS_PER_SLICE);
        }
        searching
    }

    /// Whether the distances between the clips' frames are still being computed.
    pub(in crate::session) fn is_searching(&self) -> bool {
        self.search.is_some() && self.progress < 1.0
    }

    /// How much of the comparison is done, 0 to 1; `None` when there is none under way.
    pub(in crate::session) fn progress(&self) -> Option<f32> {
        self.is_searching().then_some(self.progress)
    }
}

impl BlendInputs {
    /// The blend.
    pub(in crate::session) fn run(&self) -> Result<Outcome, String> {
        let Self { pair, place, options } = self;
        let [a, b] = &pair.profiles;
        let made = blend::dissolve(a.source(), place.leave, b.source(), place.enter, options).map_err(|error| error.to_string())?;
        let fps = made.clip.fps();
        let secs = |frame: usize| frame as f64 / fps;
        let window = made.transition.clone();
        let transition = Transition {
            start_secs: secs(window.start),
            end_secs: secs(window.end.max(window.start)),
            leave_a_secs: secs(place.leave),
            enter_b_secs: secs(place.enter),
            window_frames: window.len(),
            distance_cm: place.distance_cm,
        };
        let contacts = Contacts::joined(&pair.a.contacts, &pair.incoming.contacts, place.leave, place.enter, made.handover);
        let name = format!("{} to {}", pair.a.clip.name(), pair.b.clip.name());
        let motion = Motion {
            clip: Arc::new(made.clip.with_name(name)),
            roles: pair.a.roles.clone(),
            contacts,
            ground_frames: made.frames,
        };
        let subject = Subject {
            result: &motion.clip,
            start: window.start,
            end: window.end,
            handover: made.handover,
            enter: place.enter,
            a,
            b,
            roles: &motion.roles,
            ground_m: 0.0,
        };
        let metrics = TransitionMetrics::measure(&subject).list().to_vec();
        let source = |slot, motion: &Arc<Motion>, starts_at_secs, world_from_clip| Source {
            slot,
            motion: Arc::clone(motion),
            starts_at_secs,
            world_from_clip,
        };
        let sources = vec![
            source(Slot::A, &pair.a, 0.0, Planar::IDENTITY),
            source(Slot::B, &pair.incoming, secs(place.leave) - secs(place.enter), made.world_from_b),
        ];
        Ok(Outcome {
            motion: Arc::new(motion),
            sources,
            transition: Some(transition),
            metrics,
        })
    }
}
