//! Motion graphs: clips of one skeleton, cut into stretches, with transitions wherever two windows look alike (Kovar, Gleicher, Pighin 2002).
//!
//! A [`FrameSet`] is what the graph is made of. [`AllPairs`] compares all its windows, [`Candidates`] are the places where one may go over
//! into another, a [`MotionGraph`] is made of them, [`Choices`] say how probable each way out of a stretch is, a [`Walker`] goes through the graph
//! by a seed, and a [`Stitcher`] makes motion of where it goes. Each step is quick beside the one before it, and can be done again
//! alone: a new blend window needs new running sums, a new threshold new candidates, another weight law other choices.
//!
//! # Conventions
//! A transition leaves clip A at frame `leave` and enters clip B at frame `enter`; `A[leave..leave + window)` and `B[enter..enter + window)`
//! overlap ([`crate::registration`]). Distances are root-mean-square distances per point, centimetres on the reference body.
//!
//! # The same walk everywhere
//! What is chosen depends on sums, products, quotients and square roots of the clips' numbers alone, which are the same on every machine;
//! distances are rounded to 0.001 cm, probabilities are whole numbers, and chance is a generator (PCG) of whole numbers. Trigonometry, which
//! differs in its last digit from machine to machine, places bodies but decides nothing.
//!
//! ```
//! use segue::blend::Source;
//! use segue::graph::{AllPairs, Candidates, Choices, FrameSet, GraphOptions, MotionGraph, Stitcher, StitchOptions, Walker, WeightOptions};
//! use segue::{skeleton::Roles, synth};
//! use std::sync::Arc;
//!
//! let [walk, run] = [synth::Action::Walk, synth::Action::Run].map(|action| synth::synthesize(&synth::Params::new(action)));
//! let (walk, run) = (Arc::new(walk?.clip), Arc::new(run?.clip));
//! let roles = Roles::detect(walk.skeleton());
//! let height = f64::from(roles.body_height(walk.skeleton()));
//! let sources = [walk, run].map(|clip| Arc::new(Source::new(clip, &roles)));
//! let set = Arc::new(FrameSet::new(sources.to_vec(), height)?);
//!
//! let mut all = AllPairs::new(Arc::clone(&set))?;
//! while !all.advance(100_000).is_complete() {}
//! let options = GraphOptions { blend_window: 12, edge_threshold_cm: 20.0, ..GraphOptions::default() };
//! let candidates = Candidates::find(&all, &all.distances(options.blend_window)?, &options)?;
//! let graph = Arc::new(MotionGraph::new(&set, &candidates, &options)?.pruned()?);
//! let choices = Arc::new(Choices::new(&graph, &WeightOptions::default())?);
//!
//! let mut walker = Walker::new(Arc::clone(&graph), choices, 7);
//! let mut stitcher = Stitcher::new(Arc::clone(&set), &StitchOptions::dissolve(options.blend_window));
//! let mut secs = 0.0;
//! while secs < 20.0 {
//!     let stay = walker.next_stay().ok_or("a pruned graph has no dead end")?;
//!     secs += stitcher.stitch(&graph, &stay)?.clip.frames() as f64 / set.fps();
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod candidates;
mod distances;
mod error;
mod export;
mod follow;
mod frames;
mod measure;
mod stitch;
mod stream;
mod walk;
mod weights;

pub use build::{Construction, GraphOptions, Jump, MotionGraph, Stretch, Way};
pub use candidates::{Candidate, CandidateSearch, Candidates};
pub use distances::{AllPairs, AllSweep, FrameDistances, PausedAllSweep};
pub use error::GraphError;
pub use follow::{Followed, GroundPath, PathSearch, follow};
pub use frames::{FrameSet, Place};
pub use measure::{Seam, WalkMeter, WalkMetrics, WalkProfile};
pub use stitch::{PieceSeam, StitchOptions, Stitcher, WalkMistake, WalkPiece, assembled};
pub use stream::CandidateStream;
pub use walk::{Stay, Walker};
pub use weights::{Choices, DistanceLaw, RunLength, WeightOptions};

#[cfg(test)]
mod tests;
