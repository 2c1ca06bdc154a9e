//! What a search costs: 27 dimensions; 5,000, 50,000 and 500,000 frames; queries from a recorded drive through that database and from noise. The
//! boxes against a plain scan, against boxes over 16 and 64 frames in order of time with early exit (the usual way, Holden 2020), and against
//! the k-d tree of `kiddo`. Then a table of medians and 99th percentiles; what building costs; and what a crowd costs.

#![expect(clippy::print_stdout, reason = "criterion has no percentiles")]

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use segue::matching::search::{Question, TreeIndex, scan};
use segue::matching::{
    Control, Controller, ControllerOptions, Database, DatabaseOptions, Hit, MatchClip, RATE, Recording, TagFilter, made_params,
};
use segue::math::Planar;
use segue::skeleton::Roles;
use segue::synth::{Params, Style, synthesize};
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A generator of whole numbers (Knuth's constants) that every run shares.
struct Chance(u64);

impl Chance {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Clips of the synthesiser, each by another person in another manner, with so many frames when mirrored.
fn clips(frames: usize) -> Vec<MatchClip> {
    let (mut chance, mut clips, mut made_frames) = (Chance(1), Vec::<MatchClip>::new(), 0);
    for round in 0.. {
        for natural in made_params() {
            if 2 * made_frames >= frames {
                return clips;
            }
            let mut manner = || if round == 0 { 1.0 } else { chance.between(0.5, 1.5) as f32 };
            let style = Style {
                bounce: manner(),
                arm_swing: manner(),
                stance_width: manner(),
                energy: manner(),
                lean: manner(),
            };
            let speed_mps = match Params::speed_range(natural.action) {
                Some((low, high)) if round > 0 => (natural.speed_mps * chance.between(0.85, 1.15) as f32).clamp(low, high),
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
                .map_or_else(|| Roles::detect(clip.skeleton()), |first| first.roles.clone());
            clips.push(MatchClip::new(Arc::new(clip), roles));
        }
    }
    clips
}

/// A player who changes his mind every second or so.
fn recording(seed: u64, ticks: u32) -> Recording {
    let (mut chance, mut recording, mut yaw) = (Chance(seed), Recording::new(), 0.0f64);
    while recording.ticks() < ticks as usize {
        let speed = [0.0, 1.4, 1.4, 1.4, 2.0, 3.2][(chance.next() * 6.0) as usize];
        yaw += chance.between(-2.0, 2.0);
        let facing = (chance.next() < 0.15).then_some(yaw + chance.between(-1.5, 1.5));
        let control = Control::new(DVec2::new(yaw.sin(), yaw.cos()) * speed, facing);
        recording.hold(control, chance.between(24.0, 150.0) as u32);
    }
    recording
}

type Search<'a> = dyn FnMut(&Asked) + 'a;

/// What was asked, and the frame that was playing.
type Asked = (Vec<f32>, Option<Hit>);

fn driven(database: &Arc<Database>) -> Vec<Asked> {
    let mut controller = Controller::new(Arc::clone(database), ControllerOptions::default(), &Planar::IDENTITY).expect("defaults");
    let mut asked = Vec::new();
    for control in recording(7, 12_000).controls() {
        controller.tick(&control);
        if let Some(search) = controller.last_search().filter(|search| search.tick + 1 == controller.ticks()) {
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

fn noise(dims: usize) -> Vec<Asked> {
    let mut chance = Chance(3);
    // Twelve evenly spread numbers are nearly normally spread.
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
                let (mut low, mut high) = (vec![f32::INFINITY; dims], vec![f32::NEG_INFINITY; dims]);
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

/// Median and 99th percentile, microseconds. Of each question the fastest of three passes over all of them: what else the machine does is not counted.
fn percentiles(asked: &[Asked], search: &mut dyn FnMut(&Asked)) -> (f64, f64) {
    let mut times = vec![Duration::MAX; asked.len()];
    for _ in 0..3 {
        for (asked, time) in asked.iter().zip(&mut times) {
            let start = Instant::now();
            search(asked);
            *time = start.elapsed().min(*time);
        }
    }
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
    (at(0.5), at(0.99))
}

fn searches(c: &mut Criterion) {
    println!("frames, queries: boxes, two levels, k-d tree, scan; each median and 99th percentile in µs; frames that the boxes looked at");
    for frames in [5_000, 50_000, 500_000] {
        let database = Arc::new(Database::new(clips(frames), &DatabaseOptions::default()).expect("clips"));
        let weights = ControllerOptions::default().weights.spread(database.features().layout());
        let candidates = database.candidates();
        let filter = TagFilter::default();
        let tree = TreeIndex::new(&candidates, &weights, filter).expect("a tree");
        let two = TwoLevels::new(&database, &weights);
        for (kind, asked) in [("drive", driven(&database)), ("noise", noise(weights.len()))] {
            let ask = |asked: &'_ Asked| -> Vec<f32> { asked.0.iter().zip(&weights).map(|(q, w)| q * w).collect() };
            let mut boxes = |(query, known): &Asked| {
                let question = Question {
                    query,
                    weights: &weights,
                    filter,
                };
                black_box(database.index().search(database.masks(), &question, *known));
            };
            let mut levels = |asked: &Asked| {
                black_box(two.search(&ask(asked), asked.1.map(|hit| hit.cost)));
            };
            let mut kiddo = |(query, _): &Asked| {
                black_box(tree.search(
                    &candidates,
                    &Question {
                        query,
                        weights: &weights,
                        filter,
                    },
                ));
            };
            let mut plain = |(query, _): &Asked| {
                black_box(scan(
                    &candidates,
                    &Question {
                        query,
                        weights: &weights,
                        filter,
                    },
                ));
            };
            let few = &asked[..asked.len().min(if frames > 100_000 { 200 } else { 1_000 })];
            let visited: usize = (asked.iter())
                .map(|(query, known)| {
                    let question = Question {
                        query,
                        weights: &weights,
                        filter,
                    };
                    database.index().search(database.masks(), &question, *known).visited
                })
                .sum();
            let row = [
                percentiles(&asked, &mut boxes),
                percentiles(few, &mut levels),
                percentiles(few, &mut kiddo),
                percentiles(few, &mut plain),
            ];
            let text: Vec<String> = row.iter().map(|(median, late)| format!("{median:.1} {late:.1}")).collect();
            println!("{} {kind}: {}; {}", database.valid().len(), text.join(", "), visited / asked.len());
            let mut group = c.benchmark_group(format!("matching/{frames}/{kind}"));
            group
                .sample_size(10)
                .measurement_time(Duration::from_secs(2))
                .warm_up_time(Duration::from_millis(500));
            let methods: [(&str, &mut Search); 4] = [
                ("boxes", &mut boxes),
                ("two levels", &mut levels),
                ("k-d tree", &mut kiddo),
                ("scan", &mut plain),
            ];
            for (name, search) in methods {
                let mut next = 0;
                group.bench_function(name, |bench| {
                    bench.iter(|| {
                        next = (next + 1) % asked.len();
                        search(&asked[next]);
                    });
                });
            }
            group.finish();
        }
    }
}

fn building(c: &mut Criterion) {
    let mut group = c.benchmark_group("matching/build");
    group.sample_size(10);
    let clips = clips(50_000);
    group.bench_function("50,000 frames", |bench| {
        bench.iter(|| Database::new(clips.clone(), &DatabaseOptions::default()).expect("clips"));
    });
}

/// A second of sixty characters, each driven by a recording of its own.
fn crowd(c: &mut Criterion) {
    let mut group = c.benchmark_group("matching/crowd");
    group.sample_size(10);
    let database = Arc::new(Database::new(clips(20_000), &DatabaseOptions::default()).expect("clips"));
    let recordings: Vec<Recording> = (0..60).map(|seed| recording(seed, 6_000)).collect();
    let mut characters: Vec<Controller> = (0..60)
        .map(|_| Controller::new(Arc::clone(&database), ControllerOptions::default(), &Planar::IDENTITY).expect("defaults"))
        .collect();
    let mut second = 0;
    group.bench_function("60 characters, 60 updates", |bench| {
        bench.iter(|| {
            for (character, recording) in characters.iter_mut().zip(&recordings) {
                for tick in 0..RATE {
                    let control = recording.control((second * RATE + tick) % 6_000).unwrap_or_default();
                    character.tick(&control);
                }
            }
            second += 1;
        });
    });
}

criterion_group!(benches, building, crowd, searches);
criterion_main!(benches);
