//! A walk through the motion graph of a folder of clips, measured. Shared with the test of the same name.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "a module of an example and of a test, each of which uses a part of it"
)]

#[path = "../takes/mod.rs"]
mod takes;

use segue::blend::Source;
use segue::clip::{ContactOptions, Contacts};
use segue::graph::{
    AllPairs, Candidates, Choices, FrameSet, GraphOptions, MotionGraph, StitchOptions, Stitcher, WalkMetrics, WalkPiece, WalkProfile,
    Walker, WeightOptions,
};
use segue::session::Command;
use segue::skeleton::Roles;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use takes::session_of_folder;

/// A walk.
pub struct Walked {
    /// The largest component.
    pub graph: Arc<MotionGraph>,
    /// Transitions of the whole graph.
    pub transitions: usize,
    /// The walk.
    pub pieces: Vec<WalkPiece>,
    /// What it is like.
    pub metrics: WalkMetrics,
    /// Seconds for all pairs, the window, and the graph.
    pub secs: [f64; 3],
}

/// The clips of a folder: BVH files, and AMC files with the ASF file beside them; those whose file names `wanted` picks.
///
/// # Errors
/// When the folder or a file cannot be read, or the clips do not fit each other.
pub fn clips_of_folder(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Arc<FrameSet>, Box<dyn Error>> {
    let (mut session, ids) = session_of_folder(folder, wanted)?;
    let (mut sources, mut height) = (Vec::new(), 0.0);
    for id in ids {
        session.apply(Command::OpenLink(format!("lab=view&a={id}")))?;
        let outcome = session.main_outcome().ok_or_else(|| format!("there is no clip `{id}`"))?;
        let motion = &outcome.motion;
        height = f64::from(motion.roles.body_height(motion.clip.skeleton()));
        sources.push(Arc::new(Source::new(Arc::clone(&motion.clip), &motion.roles)));
    }
    Ok(Arc::new(FrameSet::new(sources, height)?))
}

/// Walks for so many seconds.
///
/// # Errors
/// When there is no graph.
pub fn walk(set: &Arc<FrameSet>, options: &GraphOptions, stitch: &StitchOptions, seed: u64, secs: f64) -> Result<Walked, Box<dyn Error>> {
    let start = Instant::now();
    let mut all = AllPairs::new(Arc::clone(set))?;
    all.finish()?;
    let terms = start.elapsed().as_secs_f64();
    let distances = all.distances(options.blend_window)?;
    let window = start.elapsed().as_secs_f64() - terms;
    let candidates = Candidates::find(&all, &distances, options)?;
    let whole = MotionGraph::new(set, &candidates, options)?;
    let graph = Arc::new(whole.pruned()?);
    let built = start.elapsed().as_secs_f64() - terms - window;
    let roles = Roles::detect(set.clips()[0].clip().skeleton());
    let contacts = set
        .clips()
        .iter()
        .map(|source| Contacts::detect(source.clip(), &roles, &ContactOptions::default()));
    let profile = WalkProfile::new(Arc::clone(set), &roles, contacts.collect());
    let choices = Arc::new(Choices::new(&graph, &WeightOptions::default())?);
    let mut walker = Walker::new(Arc::clone(&graph), choices, seed);
    let mut stitcher = Stitcher::new(Arc::clone(set), stitch);
    let (mut pieces, mut frames) = (Vec::new(), 0);
    while (frames as f64) < secs * set.fps() {
        let Some(stay) = walker.next_stay() else { break };
        let piece = stitcher.stitch(&graph, &stay)?;
        frames += piece.clip.frames();
        pieces.push(piece);
    }
    let metrics = WalkMetrics::measure(&pieces, &graph, &profile);
    Ok(Walked {
        graph,
        transitions: whole.jumps().len(),
        pieces,
        metrics,
        secs: [terms, window, built],
    })
}
