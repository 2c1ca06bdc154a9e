//! Tests of paths through distance matrices.

use super::search::weigh;
use super::*;
use proptest::prelude::*;

fn matrix(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f32) -> DistanceMatrix {
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    DistanceMatrix {
        stride: 1,
        window: 1,
        source_start: 0,
        target_start: 0,
        rows,
        columns,
        rms_m: cells.map(|(row, column)| value(row, column)).collect(),
    }
}

/// Returns whether at most `limit` steps in a row advance one clip alone.
fn keeps_limit(cells: &[(usize, usize)], limit: usize) -> bool {
    let (mut run, mut way) = (0, (1, 1));
    cells.windows(2).all(|pair| {
        let step = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        run = if step != (1, 1) && step == way { run + 1 } else { 1 };
        way = step;
        step == (1, 1) || run <= limit
    })
}

/// Enumerates all continuations of `cells`.
fn all_paths(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    cells: &mut Vec<(usize, usize)>,
    offer: &mut impl FnMut(&[(usize, usize)]),
) {
    let &(row, column) = cells.last().unwrap();
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let ends = match options.end {
        PathEnd::Corner => (row, column) == (rows - 1, columns - 1),
        PathEnd::Border { slack } => {
            (row == rows - 1 || column == columns - 1)
                && within(rows - 1 - row, rows, slack)
                && within(columns - 1 - column, columns, slack)
        }
    };
    if ends
        && keeps_limit(cells, options.slope_limit)
        && options.pins.iter().all(|pin| cells.contains(pin))
    {
        offer(cells);
    }
    for (down, right) in [(1, 1), (1, 0), (0, 1)] {
        if row + down < rows && column + right < columns {
            cells.push((row + down, column + right));
            all_paths(matrix, options, cells, offer);
            cells.pop();
        }
    }
}

/// Returns the least cost per weight of all paths.
fn brute_force(matrix: &DistanceMatrix, options: &PathOptions) -> Option<f64> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let mut starts = vec![(0, 0)];
    if let PathEnd::Border { slack } = options.start {
        starts.extend((1..rows).filter(|&row| within(row, rows, slack)).map(|row| (row, 0)));
        starts.extend(
            (1..columns).filter(|&column| within(column, columns, slack)).map(|column| (0, column)),
        );
    }
    let mut best: Option<f64> = None;
    for start in starts {
        all_paths(matrix, options, &mut vec![start], &mut |cells| {
            let (cost, weight) = weigh(matrix, cells, options.side_step_m);
            best = Some(best.map_or(cost / weight, |best| best.min(cost / weight)));
        });
    }
    best
}

fn end() -> impl Strategy<Value = PathEnd> {
    prop_oneof![Just(PathEnd::Corner), (0.0f64..0.7).prop_map(|slack| PathEnd::Border { slack })]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn optimal_path_is_the_cheapest_of_all(
        rows in 1usize..6,
        columns in 1usize..6,
        values in prop::collection::vec(0u8..6, 25),
        slope_limit in 1usize..4,
        start in end(),
        end in end(),
        pins in prop::collection::vec((0usize..5, 0usize..5), 0..3),
    ) {
        let matrix = matrix(rows, columns, |row, column| f32::from(values[row * 5 + column]));
        let pins: Vec<_> = pins.into_iter().filter(|pin| pin.0 < rows && pin.1 < columns).collect();
        let options = PathOptions { slope_limit, start, end, pins, side_step_m: 1e-3 };
        let best = brute_force(&matrix, &options);
        match optimal_path(&matrix, &options) {
            Ok(found) => {
                prop_assert!(keeps_limit(&found.cells, slope_limit), "{:?}", found.cells);
                prop_assert!(
                    options.pins.iter().all(|pin| found.cells.contains(pin)),
                    "{:?}",
                    found.cells
                );
                let (cost, weight) = weigh(&matrix, &found.cells, options.side_step_m);
                let best = best.unwrap();
                prop_assert!(
                    (cost / weight - best).abs() < 1e-9,
                    "{} {best} {:?}",
                    cost / weight,
                    found.cells
                );
            }
            Err(PathError::NoPath { .. }) => prop_assert_eq!(best, None),
            // Refused although steps along a border lead there: the clip that stands still in these
            // steps could not be warped.
            Err(PathError::Pins { .. } | PathError::PinAtEnd { .. }) => prop_assert!(
                options.pins.len()
                    > usize::from(start != PathEnd::Corner && end != PathEnd::Corner)
            ),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

#[test]
fn optimal_path_on_a_plateau_is_diagonal() {
    let flat = matrix(40, 40, |_, _| 0.02);
    let path = optimal_path(&flat, &PathOptions::default()).unwrap();
    assert_eq!(path.cells, (0..40).map(|i| (i, i)).collect::<Vec<_>>());
    assert!((path.mean_m - 0.02).abs() < 1e-8);
}

/// A valley of slope 2 is followed only as far as the limit allows.
#[test]
fn optimal_path_keeps_the_slope_limit() {
    let valley = |row: usize, column: usize| (2.0 * row as f32 - column as f32).abs();
    let steep = matrix(30, 59, valley);
    let path =
        optimal_path(&steep, &PathOptions { slope_limit: 1, ..PathOptions::default() }).unwrap();
    assert!(path.cells.iter().all(|&(row, column)| valley(row, column) <= 1.0));
    assert!(keeps_limit(&path.cells, 1));
    let three = matrix(20, 58, |row, column| (3.0 * row as f32 - column as f32).abs());
    let error = optimal_path(&three, &PathOptions { slope_limit: 1, ..PathOptions::default() })
        .unwrap_err();
    assert_eq!(
        error,
        PathError::NoPath { from: Some((0, 0)), to: Some((19, 57)), slope_limit: 1, needed: 2 }
    );
    assert!(error.to_string().contains("raise the slope limit to 2"), "{error}");
    assert!(optimal_path(&three, &PathOptions::default()).is_ok());
}

#[test]
fn optimal_path_that_is_impossible_is_refused() {
    let some = matrix(20, 30, |row, column| (row as f32 - column as f32).abs());
    let with = |pins: &[(usize, usize)]| {
        optimal_path(&some, &PathOptions { pins: pins.to_vec(), ..PathOptions::default() })
    };
    let crossing = with(&[(12, 8), (5, 9)]).unwrap_err();
    assert_eq!(crossing, PathError::Pins { first: (5, 9), second: (12, 8) });
    assert!(
        crossing.to_string().starts_with("the pins at frames 5 | 9 and 12 | 8 exclude each other")
    );
    assert!(matches!(with(&[(20, 3)]), Err(PathError::PinOutside { .. })));
    assert!(matches!(with(&[(0, 3)]), Err(PathError::PinAtEnd { end: "start", .. })));
    assert!(matches!(with(&[(3, 29)]), Err(PathError::PinAtEnd { end: "end", .. })));
    assert!(matches!(
        with(&[(5, 29 - 15), (6, 29 - 2)]),
        Err(PathError::NoPath { from: Some((5, 14)), to: Some((6, 27)), .. })
    ));
    assert!(with(&[(5, 9), (12, 14), (0, 0), (19, 29)]).is_ok());
    assert_eq!(
        optimal_path(&matrix(0, 5, |_, _| 0.0), &PathOptions::default()),
        Err(PathError::TooShort { window: 1 })
    );
    for slope_limit in [0, MAX_SLOPE_LIMIT + 1] {
        let options = PathOptions { slope_limit, ..PathOptions::default() };
        assert_eq!(optimal_path(&some, &options), Err(PathError::SlopeLimit { slope_limit }));
    }
}

/// Returns the distances of two walks whose speeds vary differently: strides make parallel valleys.
fn strides(rows: usize, columns: usize) -> DistanceMatrix {
    let phase = |t: f64, bend: f64| t * 20.0 + bend * (t * 7.0).sin();
    matrix(rows, columns, |row, column| {
        let (a, b) =
            (phase(row as f64 / rows as f64, 2.0), phase(column as f64 / columns as f64, -1.0));
        (0.02 + 0.1 * (1.0 - (a - b).cos()) + 0.01 * (a - b).abs()) as f32
    })
}

#[test]
fn path_in_corridor_equals_the_optimal_path() {
    let matrix = strides(700, 560);
    for (start, end) in [
        (PathEnd::Corner, PathEnd::Corner),
        (PathEnd::Border { slack: 0.1 }, PathEnd::Border { slack: 0.1 }),
    ] {
        let options = PathOptions { start, end, pins: vec![(200, 150)], ..PathOptions::default() };
        let whole = optimal_path(&matrix, &options).unwrap();
        let narrow = path_in_corridor(&matrix, &options, 8, 24).unwrap();
        assert_eq!(narrow, whole);
    }
    let narrow = path_in_corridor(&matrix, &PathOptions::default(), 8, 0).unwrap();
    let whole = optimal_path(&matrix, &PathOptions::default()).unwrap();
    assert!(narrow.mean_m >= whole.mean_m && narrow.mean_m < 1.1 * whole.mean_m);
}

#[test]
fn search_with_an_estimate_finds_the_same_path() {
    let field = matrix(300, 280, |row, column| {
        let (i, j) = (row as f32, column as f32);
        0.1 + 0.05 * ((0.11 * i - 0.13 * j).sin() + (0.02 * i).cos() * (0.031 * j).sin())
            + 1e-4 * (row * 31 + column * 17).rem_euclid(23) as f32
    });
    for slack in [0.1, 0.4] {
        let options = PathOptions {
            start: PathEnd::Border { slack },
            end: PathEnd::Border { slack },
            ..PathOptions::default()
        };
        let plain =
            TimeWarpSearch::without_estimate(&field, &options).unwrap().finish(&field).unwrap();
        let quick = optimal_path(&field, &options).unwrap();
        assert!((plain.mean_m - quick.mean_m).abs() < 1e-9, "{} {}", plain.mean_m, quick.mean_m);
        assert_eq!(plain.cells, quick.cells);
    }
}

/// Returns the least cost from corner to corner through a pin, by a table of all that a step may
/// depend on: its direction, the number of such steps before it, and whether the pin was passed.
fn cheapest_through(
    matrix: &DistanceMatrix,
    pin: (usize, usize),
    limit: usize,
    side_step_m: f64,
) -> f64 {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let mut table = vec![vec![[[f64::INFINITY; 16]; 2]; rows * columns]; 3];
    let mut least = f64::INFINITY;
    for row in 0..rows {
        for column in 0..columns {
            let here = f64::from(matrix.get(row, column).unwrap());
            let at = row * columns + column;
            for (way, (down, right)) in [(1, 1), (1, 0), (0, 1)].into_iter().enumerate() {
                let cost = if way == 0 { 2.0 * here } else { here + side_step_m };
                for passed_before in [0, 1] {
                    let passed = usize::from(passed_before == 1 || (row, column) == pin);
                    let mut put = |run: usize, sum: f64| {
                        let slot = &mut table[way][at][passed][run];
                        *slot = slot.min(sum + cost);
                    };
                    if (row, column, way) == (0, 0, 0) && passed_before == 0 {
                        put(1, 0.0);
                    }
                    if row < down || column < right {
                        continue;
                    }
                    let from = (row - down) * columns + column - right;
                    for other in 0..3 {
                        for run in 1..=limit {
                            let sum = table[other][from][passed_before][run];
                            let next = if other == way && way > 0 { run + 1 } else { 1 };
                            if sum.is_finite() && next <= limit {
                                let slot = &mut table[way][at][passed][next];
                                *slot = slot.min(sum + cost);
                            }
                        }
                    }
                }
                if (row, column) == (rows - 1, columns - 1) {
                    least = table[way][at][1].iter().copied().fold(least, f64::min);
                }
            }
        }
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// The matrix has so many rows that the trace goes through many blocks of rows.
    #[test]
    fn optimal_path_traced_over_many_blocks_is_the_cheapest(
        rows in 70usize..140,
        columns in 70usize..140,
        seed in any::<u32>(),
        slope_limit in 1usize..6,
        pin in (0.1f64..0.9, 0.1f64..0.9),
    ) {
        let hash = |row: usize, column: usize| {
            (row as u32).wrapping_mul(0x9E37_79B9)
                ^ (column as u32).wrapping_mul(0x85EB_CA6B)
                ^ seed
        };
        let value = |row, column| {
            (hash(row, column).wrapping_mul(0xC2B2_AE35) >> 16) as f32 / 65_536.0
                + ((row as f32 / 9.0).sin() - (column as f32 / 7.0).sin()).abs()
        };
        let matrix = matrix(rows, columns, value);
        let pin = ((pin.0 * rows as f64) as usize, (pin.1 * columns as f64) as usize);
        let options = PathOptions {
            slope_limit,
            start: PathEnd::Corner,
            end: PathEnd::Corner,
            pins: vec![pin],
            side_step_m: 1e-3,
        };
        if let Ok(found) = optimal_path(&matrix, &options) {
            let least = cheapest_through(&matrix, pin, slope_limit, options.side_step_m);
            let (cost, _) = weigh(&matrix, &found.cells, options.side_step_m);
            prop_assert!(keeps_limit(&found.cells, slope_limit) && found.cells.contains(&pin));
            prop_assert!((cost - least).abs() < 1e-9 * least, "{cost} {least}");
        } else {
            prop_assert!(
                !cheapest_through(&matrix, pin, slope_limit, options.side_step_m).is_finite()
            );
        }
    }
}

/// Rows outside of the corridor have no cells; with a pin far from the last column they must be
/// skipped.
#[test]
fn path_in_corridor_far_from_the_end_passes_its_pin() {
    let (rows, columns) = (400, 400);
    for (late, pin) in [(60.0f32, (200, 140)), (-60.0, (140, 200))] {
        let valley =
            matrix(rows, columns, |row, column| (row as f32 - column as f32 - late).abs() / 400.0);
        let border = PathEnd::Border { slack: 0.3 };
        let options =
            PathOptions { start: border, end: border, pins: vec![pin], ..PathOptions::default() };
        let path = optimal_path(&valley, &options).unwrap();
        assert!(path.cells.contains(&pin) && path.mean_m < 1e-3, "{}", path.mean_m);
    }
}
