//! The rows of a table, and its clip.

use super::COLUMNS;
use super::g1::HINGES;
use super::limits::TOLERANCE;
use super::robot::{Robot, RobotPose};
use crate::assemble::assemble;
use crate::bvh::{MEMORY_FLOOR, MEMORY_PER_BYTE};
use crate::error::Fault;
use crate::text::{decode, is_space, name as text_of, quoted};
use crate::warning::{Tally, WarningKind};
use crate::{ImportError, ImportOptions, ImportedFile, check_size};
use glam::{DQuat, DVec3};
use segue_motion::clip::UpAxis;
use segue_text::msg;

/// Frames per second of retargeted sets without header, and of tables with one.
const PLAIN_FPS: f64 = 30.0;
const NAMED_FPS: f64 = 120.0;
/// The least difference of the mean uprightness of two quaternion orders by which one is chosen.
const CLEARLY_UPRIGHT: f64 = 0.05;
/// The least travel that determines the robot's direction of motion, metres.
const MIN_TRAVEL: f64 = 0.5;
/// The memory for a row, bytes: a pose, and the rotations of all joints.
const BYTES_PER_ROW: u64 = 800;
/// Larger magnitudes are overflows, not measurements.
const MAX_MAGNITUDE: f64 = 1e6;

/// Reads a table of the robot's hinges.
///
/// # Errors
/// [`ImportError`] when the table has other columns, or a cell is no number.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    check_size(name, bytes, options)?;
    let text = decode(bytes);
    let mut tally = Tally::default();
    let read = |tally: &mut Tally| {
        let (poses, assumed) = poses(&text, tally)?;
        warn_of_limits(&poses, tally);
        let given = options.fps.filter(|fps| fps.is_finite() && *fps > 0.0);
        let fps = given.unwrap_or_else(|| {
            tally.add(WarningKind::AssumedFrameRate { fps: assumed }, None);
            assumed
        });
        let raw = Robot::new().motion(&poses);
        // The model of the robot is metric, Z up; both may be set by hand.
        let own = ImportOptions {
            metres_per_unit: options.metres_per_unit.or(Some(1.0)),
            up: options.up.or(Some(UpAxis::Z)),
            ..*options
        };
        assemble(name, vec![raw], fps, &own, None, tally, 0)
    };
    let clips = read(&mut tally).map_err(|fault| fault.locate(name, &text))?;
    Ok(ImportedFile { clips, warnings: tally.into_warnings(&text) })
}

/// Returns whether a line is a header with the robot's columns.
pub(super) fn is_header(line: &[u8]) -> bool {
    let lower = line.to_ascii_lowercase();
    let has = |word: &[u8]| lower.windows(word.len()).any(|part| part == word);
    has(b"root_translatex") && has(b"_dof")
}

/// Returns the cells of a row, trimmed.
pub(super) fn cells(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| matches!(b, b',' | b';')).map(<[u8]>::trim_ascii)
}

pub(super) fn number(cell: &[u8]) -> Option<f64> {
    fast_float2::parse::<f64, _>(cell).ok()
}

/// A table of numbers with rows of equal length.
struct Table {
    values: Vec<f64>,
    columns: usize,
}

impl Table {
    /// Reads the rows of a text from an offset on; a number that is not finite is replaced by the
    /// one above it.
    fn read(text: &[u8], from: usize, columns: usize, tally: &mut Tally) -> Result<Self, Fault> {
        let mut table = Self { values: Vec::new(), columns };
        let mut row: Vec<f64> = Vec::with_capacity(columns);
        let mut at = from;
        let body = text.get(from..).unwrap_or_default();
        let last = body.iter().rposition(|b| !is_space(*b)).map_or(from, |last| from + last);
        for line in body.split(|b| matches!(b, b'\n' | b'\r')) {
            let start = at;
            at += line.len() + 1;
            let is_comment = line.trim_ascii().first() == Some(&b'#');
            if line.trim_ascii().is_empty() || is_comment {
                continue;
            }
            row.clear();
            let is_last = start + line.len() > last;
            for cell in cells(line.trim_ascii().trim_suffix_comma()) {
                match number(cell) {
                    Some(value) => row.push(value),
                    None if is_last && row.len() < columns => break,
                    None => {
                        let within = cell.as_ptr().addr().saturating_sub(line.as_ptr().addr());
                        return Err(Fault::at_token(start + within, cell, "a number"));
                    }
                }
            }
            if row.len() != columns {
                if is_last && row.len() < columns && !table.values.is_empty() {
                    let kind = WarningKind::TruncatedRow { found: row.len(), expected: columns };
                    tally.add(kind, Some(start));
                    break;
                }
                let found = msg!("{count} numbers", count = row.len());
                return Err(Fault::new(start, found, msg!("{columns} numbers")));
            }
            for (column, value) in row.iter_mut().enumerate() {
                if !value.is_finite() || value.abs() > MAX_MAGNITUDE {
                    tally.add(WarningKind::NotFinite, Some(start));
                    let above = table.values.len().checked_sub(columns);
                    *value = above.map_or(0.0, |above| table.values[above + column]);
                }
            }
            table.values.extend_from_slice(&row);
            let rows = (table.values.len() / columns) as u64;
            // A table with some of the hinges is expanded to all of them.
            let limit =
                MEMORY_FLOOR.saturating_add(MEMORY_PER_BYTE.saturating_mul(text.len() as u64));
            if rows * BYTES_PER_ROW > limit {
                let found = msg!(
                    "a motion of more than {mb} MB, most of it in bones without values",
                    mb = limit >> 20
                );
                return Err(Fault::new(start, found, "a motion that fits into memory")
                    .with_hint("cut the motion into parts"));
            }
        }
        Ok(table)
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns)
    }
}

trait TrimComma {
    /// Returns the line without its trailing comma.
    fn trim_suffix_comma(&self) -> &[u8];
}

impl TrimComma for [u8] {
    fn trim_suffix_comma(&self) -> &[u8] {
        self.strip_suffix(b",").unwrap_or(self)
    }
}

/// Returns the poses of a table, and the usual frame rate of its kind.
fn poses(text: &[u8], tally: &mut Tally) -> Result<(Vec<RobotPose>, f64), Fault> {
    let start = text.iter().position(|b| !is_space(*b)).unwrap_or(text.len());
    let rest = &text[start..];
    let line = rest.split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
    let (poses, fps) = if is_header(line) {
        (named(text, start, line, tally)?, NAMED_FPS)
    } else if super::starts_like_robot_csv(rest) {
        let table = Table::read(text, start, COLUMNS, tally)?;
        (plain(&table, tally), PLAIN_FPS)
    } else {
        let found = if line.contains(&b',') {
            msg!("a table of {count} columns", count = cells(line).count())
        } else {
            quoted(line).into()
        };
        let expected = msg!(
            "{columns} columns of numbers of a Unitree G1, or a header with `root_translateX` and `left_knee_joint_dof`",
            columns = COLUMNS
        );
        return Err(Fault::new(start, found, expected).with_hint(
            "of tables, those of this robot are read; save other motions as BVH or GLB",
        ));
    };
    if poses.is_empty() {
        return Err(Fault::at_token(text.len(), b"", "a row of numbers"));
    }
    Ok((poses, fps))
}

/// Reads a table with a header: centimetres and degrees.
fn named(
    text: &[u8],
    start: usize,
    line: &[u8],
    tally: &mut Tally,
) -> Result<Vec<RobotPose>, Fault> {
    let names: Vec<String> = cells(line.trim_ascii().trim_suffix_comma())
        .map(|cell| text_of(cell).0.trim_matches('"').to_ascii_lowercase())
        .collect();
    let column = |name: &str| names.iter().position(|own| own == name);
    let mut root = [0_usize; 6];
    let parts = ["translatex", "translatey", "translatez", "rotatex", "rotatey", "rotatez"];
    for (place, part) in root.iter_mut().zip(parts) {
        let name = format!("root_{part}");
        *place = column(&name).ok_or_else(|| {
            let found = Fault::new(start, "a header without this column", msg!("`{name}`"));
            found.with_hint("export the table with the place and the rotation of the root")
        })?;
    }
    let hinge_of = |name: &str| {
        let own = name.strip_suffix("_dof")?;
        let own = own.strip_suffix("_joint").unwrap_or(own);
        HINGES.iter().position(|hinge| hinge.name == own)
    };
    let mut columns = [None; HINGES.len()];
    for (index, name) in names.iter().enumerate() {
        match hinge_of(name) {
            Some(hinge) => columns[hinge] = Some(index),
            None if name.ends_with("_dof") => {
                tally.add(WarningKind::UnknownBones { name: name.clone() }, Some(start));
            }
            None => {}
        }
    }
    for (hinge, column) in HINGES.iter().zip(&columns) {
        if column.is_none() {
            tally.add(WarningKind::RestingBones { name: hinge.name.to_owned() }, None);
        }
    }
    let table = Table::read(text, start + line.len(), names.len(), tally)?;
    Ok(table
        .rows()
        .map(|row| {
            let [x, y, z, rx, ry, rz] = root.map(|column| row[column]);
            let turn =
                |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
            RobotPose {
                place: DVec3::new(x, y, z) / 100.0,
                turn: turn(DVec3::Z, rz) * turn(DVec3::Y, ry) * turn(DVec3::X, rx),
                angles: columns.map(|column| column.map_or(0.0, |index| row[index].to_radians())),
            }
        })
        .collect())
}

/// The order of a quaternion's components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    ScalarLast,
    ScalarFirst,
}

impl Order {
    fn turn(self, row: &[f64]) -> DQuat {
        let q = |index: usize| row.get(3 + index).copied().unwrap_or(0.0);
        let [x, y, z, w] = match self {
            Self::ScalarLast => [q(0), q(1), q(2), q(3)],
            Self::ScalarFirst => [q(1), q(2), q(3), q(0)],
        };
        let q = DQuat::from_xyzw(x, y, z, w);
        if q.length_squared() > 1e-12 { q.normalize() } else { DQuat::IDENTITY }
    }
}

/// Reads a table without a header: metres and radians.
fn plain(table: &Table, tally: &mut Tally) -> Vec<RobotPose> {
    let order = quaternion_order(table, tally);
    table
        .rows()
        .map(|row| {
            let mut angles = [0.0; HINGES.len()];
            angles.iter_mut().zip(&row[7..]).for_each(|(angle, value)| *angle = *value);
            RobotPose { place: DVec3::new(row[0], row[1], row[2]), turn: order.turn(row), angles }
        })
        .collect()
}

/// Returns the quaternion order in which the robot is upright, or failing that, walks forwards.
fn quaternion_order(table: &Table, tally: &mut Tally) -> Order {
    let rows: Vec<&[f64]> = table.rows().collect();
    let count = rows.len().max(1) as f64;
    let upright =
        |order: Order| rows.iter().map(|row| (order.turn(row) * DVec3::Z).z).sum::<f64>() / count;
    let lead = upright(Order::ScalarLast) - upright(Order::ScalarFirst);
    if lead.abs() > CLEARLY_UPRIGHT {
        return if lead > 0.0 { Order::ScalarLast } else { Order::ScalarFirst };
    }
    let place = |row: &[f64]| DVec3::new(row[0], row[1], 0.0);
    let ahead = |order: Order| -> f64 {
        let step =
            |pair: &[&[f64]]| (order.turn(pair[0]) * DVec3::X).dot(place(pair[1]) - place(pair[0]));
        rows.windows(2).map(step).sum()
    };
    let (last, first) = (ahead(Order::ScalarLast), ahead(Order::ScalarFirst));
    let order =
        if first > MIN_TRAVEL && first > last { Order::ScalarFirst } else { Order::ScalarLast };
    tally.add(WarningKind::QuaternionOrder { scalar_first: order == Order::ScalarFirst }, None);
    order
}

/// Warns of the hinge that exceeds its limits the most, with the number of others that do.
fn warn_of_limits(poses: &[RobotPose], tally: &mut Tally) {
    struct Beyond {
        hinge: usize,
        frames: usize,
        first: usize,
        radians: f64,
    }
    let mut all: Vec<Beyond> = Vec::new();
    for (index, hinge) in HINGES.iter().enumerate() {
        let [low, high] = hinge.limits;
        let mut beyond = Beyond { hinge: index, frames: 0, first: 0, radians: 0.0 };
        for (frame, pose) in poses.iter().enumerate() {
            let excess = (low - pose.angles[index]).max(pose.angles[index] - high);
            if excess > TOLERANCE {
                if beyond.frames == 0 {
                    beyond.first = frame;
                }
                beyond.frames += 1;
                beyond.radians = beyond.radians.max(excess);
            }
        }
        if beyond.frames > 0 {
            all.push(beyond);
        }
    }
    all.sort_by(|a, b| b.radians.total_cmp(&a.radians));
    for beyond in all {
        tally.add(
            WarningKind::BeyondLimits {
                joint: HINGES[beyond.hinge].name.to_owned(),
                frames: beyond.frames,
                first: beyond.first,
                degrees: beyond.radians.to_degrees(),
            },
            None,
        );
    }
}
