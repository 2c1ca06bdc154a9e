//! Motion graphs: clips of one skeleton, cut into stretches, with transitions between windows that
//! are alike. A walk through the graph is an endless motion.
//!
//! # The idea
//!
//! All clips are laid end to end, and every window is compared with every other. Where the distance
//! ([`crate::registration`]) is small, a transition is possible. Picture a railway map: stretches
//! of clips are the tracks ([`Stretch`]), transitions the switches ([`Jump`]), and a die is thrown
//! at each switch.
//!
//! ```text
//! p(the clip goes on) = c                       c: continuity; or w₀ / (w₀ + Σ w)
//! p(jump k)           = (1 - c) · w_k / Σ w     w = 1/D, exp(-(D - D₀)/σ), 1, or (wrong) D
//! mean run            = 1 / (1 - c) stretches   before the next jump
//! ```
//!
//! Dead ends are cut away: inside the largest strongly connected component
//! ([`MotionGraph::pruned`]) every stretch can be reached from every other, without end.
//!
//! The construction has these steps. A [`FrameSet`] holds the clips. [`AllPairs`] compares all
//! windows, [`Candidates`] are the possible transitions, a [`MotionGraph`] is built from them,
//! [`Choices`] hold the probability of each way out of a stretch, a [`Walker`] walks through the
//! graph by a seed, and a [`Stitcher`] makes the walk's motion. Each step is quick compared with
//! the one before it, and can be repeated alone: a new blend window needs new running sums, a new
//! threshold new candidates, another weight law other choices. [`follow()`] searches for a walk
//! along a path on the ground.
//!
//! A transition leaves clip A at frame `leave` and enters clip B at frame `enter`;
//! `A[leave..leave + window)` and `B[enter..enter + window)` overlap. Distances are
//! root-mean-square distances per point, in centimetres on the reference body.
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::Motion;
//! use segue_motion::graph::{AllPairs, Candidates, Choices, FrameSet, GraphOptions, MotionGraph};
//! use segue_motion::graph::{StitchOptions, Stitcher, Walker, WeightOptions};
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let run = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//! let height = f64::from(walk.body_height());
//! let set = Arc::new(FrameSet::new(vec![Arc::new(walk), Arc::new(run)], height)?);
//!
//! let mut all = AllPairs::new(Arc::clone(&set))?;
//! while !all.advance(100_000)?.is_complete() {}
//! let window = 12;
//! let options =
//!     GraphOptions { blend_window: window, edge_threshold_cm: 20.0, ..Default::default() };
//! let candidates = Candidates::find(&all, &all.distances(window)?, &options)?;
//! let graph = Arc::new(MotionGraph::new(&set, &candidates, &options)?.pruned()?);
//! assert!(graph.dead_ends().is_empty() && graph.jumps().len() > 20);
//!
//! let choices = Arc::new(Choices::new(&graph, &WeightOptions::default())?);
//! let mut walker = Walker::new(Arc::clone(&graph), choices, 7);
//! let mut stitcher = Stitcher::new(Arc::clone(&set), &StitchOptions::dissolve(window));
//! let (mut secs, mut jumps) = (0.0, 0);
//! while secs < 20.0 {
//!     let stay = walker.next_stay().ok_or("a pruned graph has no dead end")?;
//!     secs += stitcher.stitch(&graph, &stay)?.clip.frames() as f64 / set.fps();
//!     jumps += usize::from(stay.jump.is_some());
//! }
//! // Twenty seconds of motion, from two clips of about three seconds.
//! assert!(jumps > 5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Graph and walk equal those of a `NumPy` program, stay by stay; the length of walks between jumps
//! is the one that [`Choices::expected_run_secs`] returns, to 5 %. N frames are N²/2 pairs,
//! compared once: O(N²J) time and 12 bytes a pair. [`CandidateStream`] avoids this memory for long
//! clips, and leaves a coarse picture of their distances.
//!
//! *The same walk everywhere.* From clips that are equal to the last digit, every machine takes the
//! same walk: choices depend on sums, products, quotients and square roots in one order, which are
//! the same everywhere, and on an arc tangent, an exponential and a power of [`libm`], which is
//! made of these. Distances are rounded to 0.001 cm before they are ordered or compared with the
//! threshold, probabilities are integers, and the random generator (PCG) is one of integers. The
//! trigonometry of the platform, whose last digit varies, places bodies along a walk and decides
//! nothing.
//!
//! *As far as the clips are equal.* Clips that are synthesised, or read from angles, went through
//! that trigonometry, and may differ by a last digit between two machines. Rounding hides nearly
//! all of that; where two neighbours of a minimum are nearly equal, or a distance lies in the
//! middle between two roundings, a transition may be off by a frame. The walk of the built-in clips
//! is compared with a recorded one (`tests/golden/walk.json` of segue-session), natively and in the
//! browser.
//!
//! # What it does not do
//!
//! It makes no motion that is not in the clips: a clip without a transition below the threshold is
//! not reached, and [`GraphError`] says what to change. The content of a clip has no meaning for
//! it: a walk may stay in an idle stretch as long as in any other. It reacts at the next switch,
//! not at once; for that see [`crate::matching`].
//!
//! # Sources
//!
//! Kovar, Gleicher, Pighin, "Motion Graphs", 2002. Lee, Chai, Reitsma, Hodgins, Pollard,
//! "Interactive Control of Avatars Animated with Human Motion Data", 2002, section 4.1 (the
//! exponential weights).

mod all_pairs;
mod build;
mod candidate_sort;
mod candidates;
mod cells;
mod components;
mod distances;
mod error;
mod export;
mod follow;
mod frames;
mod grouped;
mod long_run;
mod measure;
mod overview;
mod parts;
mod stitch;
mod stream;
mod tiles;
mod walk;
mod weights;

pub use all_pairs::{AllPairs, AllSweep, PausedAllSweep};
pub use build::{Construction, GraphOptions, Jump, MotionGraph, Stretch, Way};
pub use candidate_sort::CandidateSort;
pub use candidates::{Candidate, CandidateSearch, Candidates};
pub use distances::{CountedTo, FrameDistances};
pub use error::GraphError;
pub use follow::{FollowSearch, FollowedWalk, GroundPath, follow};
pub use frames::{FrameSet, JoltSearch, Place};
pub use measure::{Seam, WalkMeter, WalkMetrics, WalkProfile};
pub use overview::{DistanceDetail, DistanceOverview};
pub use stitch::{
    PieceSeam, StitchOptions, Stitcher, WalkAssembly, WalkMistake, WalkPiece, assembled,
};
pub use stream::{CandidateStream, StreamComputer, StreamRow};
pub use tiles::{DistanceTile, TileCandidates, TileComputer, TileDistances};
pub use walk::{Stay, Walker};
pub use weights::{Choices, Continuity, DistanceLaw, RunLength, WeightOptions};

#[cfg(test)]
mod tests;
