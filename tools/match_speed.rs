//! Measures the time of a search in motion matching, at the median and at the 99th percentile: 27
//! dimensions; 5,000, 50,000 and 500,000 frames; queries from a recorded drive and from noise; by
//! four methods. `cargo xtask match-speed` runs it and prints a table in Markdown; `node
//! tests/browser/search.mjs` does the same in Chromium, where the page measures the time.

#[path = "../crates/motion/benches/common/search.rs"]
mod search;

/// The number of queries for slow methods with many frames.
#[cfg(not(target_arch = "wasm32"))]
const FEW: usize = 200;

#[cfg(not(target_arch = "wasm32"))]
#[expect(clippy::print_stdout, reason = "the table is what it is for")]
fn main() {
    use search::{Kind, Method, Trial};
    use std::hint::black_box;
    use std::time::{Duration, Instant};

    let methods = Method::ALL.map(|method| format!("{} (µs)", method.name())).join(" | ");
    println!("| frames | queries | {methods} | frames looked at |");
    println!("|---|---|---|---|---|---|---|");
    for frames in [5_000, 50_000, 500_000] {
        let trial = Trial::new(frames);
        for kind in Kind::ALL {
            let times = Method::ALL.map(|method| {
                let all = trial.queries(kind);
                let queries = if method == Method::Boxes { all } else { all.min(FEW) };
                let mut times = vec![Duration::MAX; queries];
                // The fastest of three passes for each query, to exclude other work of the machine.
                for _ in 0..3 {
                    for (query, time) in times.iter_mut().enumerate() {
                        let start = Instant::now();
                        black_box(trial.search(method, kind, query));
                        *time = start.elapsed().min(*time);
                    }
                }
                times.sort_unstable();
                let at = |share: f64| {
                    times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6
                };
                format!("{:.1}, {:.1}", at(0.5), at(0.99))
            });
            let visited: usize = (0..trial.queries(kind))
                .map(|query| trial.search(Method::Boxes, kind, query).1)
                .sum();
            println!(
                "| {} | {} | {} | {} |",
                trial.frames(),
                kind.name(),
                times.join(" | "),
                visited / trial.queries(kind).max(1)
            );
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::search::{Kind, Method, Trial};
    use wasm_bindgen::prelude::wasm_bindgen;

    /// The searches that the page runs.
    #[wasm_bindgen]
    pub struct SearchTrial(Trial);

    #[wasm_bindgen]
    impl SearchTrial {
        /// Returns the searches over about `frames` frames.
        #[wasm_bindgen(constructor)]
        pub fn new(frames: usize) -> Self {
            Self(Trial::new(frames))
        }

        /// Returns the number of frames that can be found.
        pub fn frames(&self) -> usize {
            self.0.frames()
        }

        /// Returns the names of the kinds of queries.
        pub fn kinds(&self) -> Vec<String> {
            Kind::ALL.map(|kind| kind.name().to_owned()).into()
        }

        /// Returns the names of the methods; the first is Segue's.
        pub fn methods(&self) -> Vec<String> {
            Method::ALL.map(|method| method.name().to_owned()).into()
        }

        /// Returns the number of queries of a kind, by the kind's number.
        pub fn queries(&self, kind: usize) -> usize {
            self.0.queries(Kind::ALL[kind])
        }

        /// Returns the cost of the best frame by a method, by the method's number.
        pub fn search(&self, method: usize, kind: usize, query: usize) -> f32 {
            self.0.search(Method::ALL[method], Kind::ALL[kind], query).0
        }
    }
}

#[cfg(target_arch = "wasm32")]
fn main() {}
