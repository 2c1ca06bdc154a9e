//! Four search methods over the same frames with the same queries, measured by
//! `benches/matching.rs` and `tools/match_speed.rs`.

use glam::DVec2;
use segue_motion::clip::Motion;
use segue_motion::matching::search::{Query, TreeIndex, scan};
use segue_motion::matching::{
    Control, Controller, ControllerOptions, Database, DatabaseOptions, Hit, RATE, Recording,
    TagFilter, made_params,
};
use segue_motion::math::Planar;
use segue_motion::skeleton::Roles;
use segue_motion::synth::{Params, Style, synthesize};
use std::sync::Arc;

/// A generator of pseudorandom numbers (Knuth's constants), the same in every run.
struct Random(u64);

impl Random {
    /// Returns a number from 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Returns synthesised clips by different persons in different styles, of `frames` frames in all
/// with their mirror images.
pub(crate) fn clips(frames: usize) -> Vec<Arc<Motion>> {
    let (mut chance, mut clips, mut made_frames) = (Random(1), Vec::<Arc<Motion>>::new(), 0);
    for round in 0.. {
        for natural in made_params() {
            if 2 * made_frames >= frames {
                return clips;
            }
            let mut manner = || {
                if round == 0 { 1.0 } else { chance.between(0.5, 1.5) as f32 }
            };
            let style = Style {
                bounce: manner(),
                arm_swing: manner(),
                stance_width: manner(),
                energy: manner(),
                lean: manner(),
            };
            let speed_mps = match Params::speed_range(natural.action) {
                Some((low, high)) if round > 0 => {
                    (natural.speed_mps * chance.between(0.85, 1.15) as f32).clamp(low, high)
                }
                _ => natural.speed_mps,
            };
            let turn = chance.between(0.7, 1.0) as f32;
            let params = Params {
                style,
                speed_mps,
                turn_rate_dps: natural.turn_rate_dps * turn,
                seed: round,
                fps: RATE as f32,
                ..natural
            };
            let clip = synthesize(&params).expect("in range").clip;
            made_frames += clip.frames();
            let roles = clips
                .first()
                .map_or_else(|| Roles::detect(clip.skeleton()), |first| first.roles().clone());
            clips.push(Arc::new(Motion::with_roles(clip, &roles)));
        }
    }
    clips
}

/// Returns the input of a player who changes direction every second or so.
pub(crate) fn recording(seed: u64, ticks: u32) -> Recording {
    let (mut chance, mut recording, mut yaw) = (Random(seed), Recording::new(), 0.0f64);
    while recording.ticks() < ticks as usize {
        let speed = [0.0, 1.4, 1.4, 1.4, 2.0, 3.2][(chance.next() * 6.0) as usize];
        yaw += chance.between(-2.0, 2.0);
        let facing = (chance.next() < 0.15).then_some(yaw + chance.between(-1.5, 1.5));
        let control = Control::new(DVec2::new(yaw.sin(), yaw.cos()) * speed, facing);
        recording.hold(control, chance.between(24.0, 150.0) as u32);
    }
    recording
}

/// A query, and the frame that was playing.
type DrivenQuery = (Vec<f32>, Option<Hit>);

fn driven(database: &Arc<Database>) -> Vec<DrivenQuery> {
    let mut controller =
        Controller::new(Arc::clone(database), ControllerOptions::default(), &Planar::IDENTITY)
            .expect("defaults");
    let mut asked = Vec::new();
    for control in recording(7, 12_000).controls() {
        controller.tick(&control);
        if let Some(search) =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks())
        {
            let current = search.current;
            let known = database.is_valid(current.place).then(|| Hit {
                frame: database.number(current.place).expect("it is playing"),
                cost: current.cost,
            });
            asked.push((search.query.clone(), known));
        }
    }
    asked
}

fn noise(dims: usize) -> Vec<DrivenQuery> {
    let mut chance = Random(3);
    // The sum of twelve uniform numbers is nearly normally distributed.
    let mut normal = || (0..12).map(|_| chance.next()).sum::<f64>() - 6.0;
    (0..500).map(|_| ((0..dims).map(|_| normal() as f32).collect(), None)).collect()
}

/// Boxes over 16 and 64 consecutive frames, early exit after each dimension; rows already weighted.
struct TwoLevels {
    dims: usize,
    rows: Vec<f32>,
    small: Vec<f32>,
    large: Vec<f32>,
}

impl TwoLevels {
    fn new(database: &Database, weights: &[f32]) -> Self {
        let dims = weights.len();
        let row = |&frame: &u32| {
            database
                .features()
                .row(frame as usize)
                .expect("valid")
                .iter()
                .zip(weights)
                .map(|(x, w)| x * w)
        };
        let rows: Vec<f32> = database.valid().iter().flat_map(row).collect();
        let boxes = |frames: usize| {
            let one = |part: &[f32]| {
                let (mut low, mut high) =
                    (vec![f32::INFINITY; dims], vec![f32::NEG_INFINITY; dims]);
                for row in part.chunks_exact(dims) {
                    for dim in 0..dims {
                        low[dim] = low[dim].min(row[dim]);
                        high[dim] = high[dim].max(row[dim]);
                    }
                }
                low.extend(high);
                low
            };
            rows.chunks(frames * dims).flat_map(one).collect()
        };
        let (small, large) = (boxes(16), boxes(64));
        Self { dims, rows, small, large }
    }

    fn search(&self, query: &[f32], known: Option<f32>) -> f32 {
        let dims = self.dims;
        let mut best = known.unwrap_or(f32::INFINITY);
        let outside = |ends: &[f32], best: f32| {
            let mut cost = 0.0;
            for ((q, low), high) in query.iter().zip(&ends[..dims]).zip(&ends[dims..]) {
                let d = q - q.clamp(*low, *high);
                cost += d * d;
                if cost >= best {
                    return true;
                }
            }
            false
        };
        let parts = self.large.chunks_exact(2 * dims).zip(self.rows.chunks(64 * dims));
        for (large, (ends, rows)) in parts.enumerate() {
            if outside(ends, best) {
                continue;
            }
            for (index, rows) in rows.chunks(16 * dims).enumerate() {
                let at = (4 * large + index) * 2 * dims;
                if outside(&self.small[at..at + 2 * dims], best) {
                    continue;
                }
                for row in rows.chunks_exact(dims) {
                    let mut cost = 0.0;
                    for (q, x) in query.iter().zip(row) {
                        cost += (q - x) * (q - x);
                        if cost >= best {
                            break;
                        }
                    }
                    best = if cost < best { cost } else { best };
                }
            }
        }
        best
    }
}

/// The source of queries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A recorded drive through the database.
    Drive,
    /// Random features, far from the database.
    Noise,
}

/// A method of searching for the best frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// Segue's: boxes around similar frames.
    Boxes,
    /// Boxes over 16 and 64 frames in order of time with early exit, the usual way (Holden 2020).
    TwoLevels,
    /// The k-d tree of `kiddo`.
    Tree,
    /// A linear scan.
    Scan,
}

impl Kind {
    pub(crate) const ALL: [Self; 2] = [Self::Drive, Self::Noise];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Noise => "noise",
        }
    }
}

impl Method {
    pub(crate) const ALL: [Self; 4] = [Self::Boxes, Self::TwoLevels, Self::Tree, Self::Scan];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Boxes => "boxes",
            Self::TwoLevels => "two levels",
            Self::Tree => "k-d tree",
            Self::Scan => "scan",
        }
    }
}

/// A database of synthesised motions, the data structure of every method, and queries.
pub(crate) struct Trial {
    database: Arc<Database>,
    weights: Vec<f32>,
    two: TwoLevels,
    tree: TreeIndex,
    asked: [Vec<DrivenQuery>; 2],
}

impl Trial {
    /// Returns a trial of about `frames` frames with 27 dimensions.
    pub(crate) fn new(frames: usize) -> Self {
        let database =
            Arc::new(Database::new(clips(frames), &DatabaseOptions::default()).expect("clips"));
        let weights = ControllerOptions::default().weights.spread(database.features().layout());
        Self {
            tree: TreeIndex::new(&database.candidates(), &weights, TagFilter::default())
                .expect("a tree"),
            two: TwoLevels::new(&database, &weights),
            asked: [driven(&database), noise(weights.len())],
            weights,
            database,
        }
    }

    /// Returns the number of frames that can be found.
    pub(crate) fn frames(&self) -> usize {
        self.database.valid().len()
    }

    /// Returns the number of queries of a kind.
    pub(crate) fn queries(&self, kind: Kind) -> usize {
        self.asked[kind as usize].len()
    }

    /// Returns the cost of the best frame, and the number of frames that the boxes visited.
    pub(crate) fn search(&self, method: Method, kind: Kind, query: usize) -> (f32, usize) {
        let (query, known) = &self.asked[kind as usize][query];
        let query = Query { row: query, weights: &self.weights, filter: TagFilter::default() };
        let cost = |hit: Option<Hit>| hit.map_or(f32::NAN, |hit| hit.cost);
        match method {
            Method::Boxes => {
                let found = self.database.index().search(self.database.masks(), &query, *known);
                (cost(found.best), found.visited)
            }
            Method::TwoLevels => {
                let weighted: Vec<f32> =
                    query.row.iter().zip(&self.weights).map(|(q, w)| q * w).collect();
                (self.two.search(&weighted, known.map(|hit| hit.cost)), 0)
            }
            Method::Tree => (cost(self.tree.search(&self.database.candidates(), &query).best), 0),
            Method::Scan => (cost(scan(&self.database.candidates(), &query).best), 0),
        }
    }
}
