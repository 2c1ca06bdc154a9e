//! Writing of BVH files.

use super::convert::kind;
use super::euler::{compose, distance, nearest, one_angle, precise, three_angles, two_angles};
use glam::{DQuat, DVec3, Quat, Vec3};
use segue_motion::clip::{Clip, Interpolation, UpAxis, resample};
use segue_motion::skeleton::{Channel, Joint, Skeleton};
use std::fmt::Write as _;

/// The tolerance, radians, within which rotations of fewer than three channels are sufficient.
const SAME_ROTATION: f64 = 2e-6;

/// Translations this near to the OFFSET (metres) need no channel.
const SAME_PLACE: f32 = 1e-6;

/// The order of three rotation channels; the first one is applied last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "the names are the orders")]
pub enum RotationOrder {
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    /// The order of most files.
    #[default]
    Zxy,
    Zyx,
}

impl RotationOrder {
    fn channels(self) -> [Channel; 3] {
        use Channel::{XRotation as X, YRotation as Y, ZRotation as Z};
        match self {
            Self::Xyz => [X, Y, Z],
            Self::Xzy => [X, Z, Y],
            Self::Yxz => [Y, X, Z],
            Self::Yzx => [Y, Z, X],
            Self::Zxy => [Z, X, Y],
            Self::Zyx => [Z, Y, X],
        }
    }

    /// Returns the axes (0 to 2), in order.
    pub(crate) fn axes(self) -> [usize; 3] {
        self.channels().map(|channel| kind(channel).1)
    }

    /// Returns the angles about the axes, radians, of a rotation; of all solutions the one nearest
    /// to `near`.
    pub(crate) fn angles(self, q: Quat, near: [f64; 3]) -> [f64; 3] {
        three_angles(precise(q), self.axes(), near)
    }
}

/// Options of writing a BVH file. The defaults are those of the file that the clip came from.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WriteOptions {
    /// Metres per unit of the file; the clip's own where `None` or out of range.
    pub metres_per_unit: Option<f64>,
    /// The file's up axis; the clip's own where `None`.
    pub up: Option<UpAxis>,
    /// One order for the rotations of all joints; each joint's own where `None`.
    pub rotation_order: Option<RotationOrder>,
    /// Frames per second; the clip's own where `None` or not accepted by [`resample`].
    pub fps: Option<f64>,
}

/// Writes a clip as BVH text with LF line ends.
///
/// Every joint keeps its channels as long as they can hold its motion; where they cannot, and where
/// there are none, it gets three rotations (Z, X, Y unless it has an order of its own) and, if it
/// moves against its parent, three positions. Leaves get an End Site, of length 0 where the clip
/// has none. Read back, positions (metres) and rotations (radians) are the same to 1e-5. Line ends
/// and braces in names become spaces and parentheses, since names are the rest of their line.
/// Joints that the clip's file has above the one that carries the body are written again
/// ([`Clip::unfolded`]).
///
/// Some programs use positions in place of the OFFSET, others add the two. The root, which always
/// moves, therefore has an OFFSET of zero where it has all three positions, and a joint that stays
/// at its OFFSET is not given positions that its source did not have.
#[must_use]
pub fn write(clip: &Clip, options: &WriteOptions) -> String {
    let resampled = options.fps.and_then(|fps| resample(clip, fps, Interpolation::default()).ok());
    let clip = resampled.as_ref().unwrap_or(clip);
    let unfolded = clip.unfolded();
    let clip = unfolded.as_ref().unwrap_or(clip);
    let writer = Writer::new(clip, options);
    let mut out =
        String::with_capacity(256 * clip.skeleton().len() + 9 * writer.columns() * clip.frames());
    let order = writer.hierarchy(&mut out);
    writer.motion(&mut out, &order);
    out
}

/// A joint's channels in the file.
struct Plan {
    channels: Vec<Channel>,
    /// The axes of the rotation channels, in order.
    axes: Vec<usize>,
}

struct Writer<'a> {
    clip: &'a Clip,
    units_per_metre: f64,
    up: UpAxis,
    /// Number of decimals of lengths.
    decimals: usize,
    plans: Vec<Plan>,
    /// For each joint, the index of its translations.
    tracks: Vec<Option<usize>>,
}

impl<'a> Writer<'a> {
    fn new(clip: &'a Clip, options: &WriteOptions) -> Self {
        let skeleton: &Skeleton = clip.skeleton();
        let source = clip.provenance();
        let is_length = |unit: &f64| unit.is_finite() && *unit > 0.0;
        let unit = options
            .metres_per_unit
            .filter(is_length)
            .or(Some(source.metres_per_unit).filter(is_length))
            .unwrap_or(0.01);
        let mut tracks = vec![None; skeleton.len()];
        for (index, track) in clip.translations().iter().enumerate() {
            tracks[track.joint] = Some(index);
        }
        let mut writer = Self {
            clip,
            units_per_metre: unit.recip(),
            up: options.up.unwrap_or(source.up),
            // A ten-millionth of a metre, and never less than six digits.
            decimals: (7.0 + libm::log10(unit)).ceil().clamp(6.0, 300.0) as usize,
            plans: Vec::new(),
            tracks,
        };
        writer.plans =
            (0..skeleton.len()).map(|joint| writer.plan(joint, options.rotation_order)).collect();
        if writer.columns() == 0 {
            // A row must not be empty, or there would be no rows.
            let channels = [POSITIONS.as_slice(), &RotationOrder::default().channels()].concat();
            writer.plans[0] = Plan { axes: axes_of(&channels), channels };
        }
        writer
    }

    fn columns(&self) -> usize {
        self.plans.iter().map(|plan| plan.channels.len()).sum()
    }

    /// Returns the local translation of a joint, file axes, metres.
    fn translation(&self, joint: usize, frame: usize) -> Vec3 {
        let translation = match (joint, self.tracks[joint]) {
            (0, _) => self.clip.root_translations()[frame],
            (_, Some(track)) => self.clip.translations()[track].values[frame],
            (_, None) => self.clip.skeleton().joints()[joint].offset,
        };
        self.to_file(translation)
    }

    fn to_file(&self, v: Vec3) -> Vec3 {
        match self.up {
            UpAxis::Y => v,
            // The inverse of the rotation of the import: -90° about X.
            UpAxis::Z => Vec3::new(v.x, -v.z, v.y),
        }
    }

    fn rotation(&self, joint: usize, frame: usize) -> DQuat {
        let q = self.clip.rotations(frame)[joint];
        let v = self.to_file(Vec3::new(q.x, q.y, q.z));
        precise(Quat::from_xyzw(v.x, v.y, v.z, q.w))
    }

    fn plan(&self, index: usize, order: Option<RotationOrder>) -> Plan {
        let joint: &Joint = &self.clip.skeleton().joints()[index];
        let frames = 0..self.clip.frames();
        let source = &joint.channels;
        let axes = axes_of(source);
        let offset = self.to_file(joint.offset);
        let moves = |axis: usize| {
            frames.clone().any(|frame| {
                (self.translation(index, frame)[axis] - offset[axis]).abs() > SAME_PLACE
            })
        };
        let holds_positions = |channels: &[Channel]| {
            (0..3).all(|axis| channels.contains(&POSITIONS[axis]) || !moves(axis))
        };
        let holds_rotations = |axes: &[usize]| {
            is_order(axes)
                || frames.clone().all(|frame| {
                    let q = self.rotation(index, frame);
                    distance(compose(axes, &angles(axes, q, [0.0; 3])), q) < SAME_ROTATION
                })
        };
        let rotations_fit = holds_rotations(&axes);
        let reordered =
            order.is_some_and(|order| !axes.is_empty() && axes != axes_of(&order.channels()));
        let is_bare_root = index == 0 && source.is_empty();
        if rotations_fit && !reordered && !is_bare_root && holds_positions(source) {
            return Plan { channels: source.clone(), axes };
        }
        let needs_rotations = is_bare_root || !axes.is_empty() || !rotations_fit;
        let turns: Vec<Channel> = match order {
            _ if !needs_rotations => Vec::new(),
            Some(order) => order.channels().to_vec(),
            None if rotations_fit && !axes.is_empty() => {
                source.iter().copied().filter(|&channel| kind(channel).0).collect()
            }
            None => RotationOrder::default().channels().to_vec(),
        };
        let places: Vec<Channel> = if !is_bare_root && holds_positions(source) {
            source.iter().copied().filter(|&channel| !kind(channel).0).collect()
        } else {
            POSITIONS.to_vec()
        };
        let rotations_first = source.first().is_some_and(|&channel| kind(channel).0)
            && source.iter().any(|&channel| !kind(channel).0);
        let channels =
            if rotations_first { [turns, places].concat() } else { [places, turns].concat() };
        Plan { axes: axes_of(&channels), channels }
    }

    /// Writes the HIERARCHY without recursion. Returns the joints in its order, which is that of
    /// the numbers in a row: each joint is followed by all below it, while a skeleton only has
    /// parents first.
    fn hierarchy(&self, out: &mut String) -> Vec<usize> {
        let joints = self.clip.skeleton().joints();
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
        for (index, joint) in joints.iter().enumerate().skip(1) {
            children[joint.parent.unwrap_or_default()].push(index);
        }
        let mut order = Vec::with_capacity(joints.len());
        out.push_str("HIERARCHY\n");
        // The remaining steps: joints to open, and depths to close.
        let mut steps = vec![Step::Open(0, 0)];
        while let Some(step) = steps.pop() {
            match step {
                Step::Close(depth) => line(out, depth, "}"),
                Step::Open(index, depth) => {
                    order.push(index);
                    self.joint(out, index, depth, children[index].is_empty());
                    steps.push(Step::Close(depth));
                    steps.extend(
                        children[index].iter().rev().map(|&child| Step::Open(child, depth + 1)),
                    );
                }
            }
        }
        order
    }

    fn joint(&self, out: &mut String, index: usize, depth: usize, is_leaf: bool) {
        let joint = &self.clip.skeleton().joints()[index];
        line(
            out,
            depth,
            &format!("{} {}", if index == 0 { "ROOT" } else { "JOINT" }, written_name(&joint.name)),
        );
        line(out, depth, "{");
        let channels = &self.plans[index].channels;
        let is_placed = index == 0 && POSITIONS.iter().all(|position| channels.contains(position));
        self.offset(out, depth + 1, if is_placed { Vec3::ZERO } else { joint.offset });
        indent(out, depth + 1);
        out.push_str("CHANNELS ");
        out.push_str(&channels.len().to_string());
        for channel in channels {
            out.push(' ');
            out.push_str(keyword(*channel));
        }
        out.push('\n');
        if let Some(end) = joint.end_site.or(is_leaf.then_some(Vec3::ZERO)) {
            line(out, depth + 1, "End Site");
            line(out, depth + 1, "{");
            self.offset(out, depth + 2, end);
            line(out, depth + 1, "}");
        }
    }

    fn offset(&self, out: &mut String, depth: usize, offset: Vec3) {
        indent(out, depth);
        out.push_str("OFFSET");
        for length in self.to_file(offset).to_array() {
            out.push(' ');
            number(out, f64::from(length) * self.units_per_metre, self.decimals);
        }
        out.push('\n');
    }

    fn motion(&self, out: &mut String, order: &[usize]) {
        out.push_str("MOTION\nFrames: ");
        out.push_str(&self.clip.frames().to_string());
        out.push_str("\nFrame Time: ");
        out.push_str(&self.clip.fps().recip().to_string());
        out.push('\n');
        let mut before = vec![[0.0; 3]; self.plans.len()];
        for frame in 0..self.clip.frames() {
            let mut is_first = true;
            for &index in order {
                let plan = &self.plans[index];
                if plan.channels.is_empty() {
                    continue;
                }
                let translation: DVec3 =
                    self.translation(index, frame).as_dvec3() * self.units_per_metre;
                let turns = angles(&plan.axes, self.rotation(index, frame), before[index]);
                before[index] = turns;
                let mut turns = turns.into_iter();
                for &channel in &plan.channels {
                    if !is_first {
                        out.push(' ');
                    }
                    is_first = false;
                    match kind(channel) {
                        (true, _) => number(out, turns.next().unwrap_or_default().to_degrees(), 6),
                        (false, axis) => number(out, translation[axis], self.decimals),
                    }
                }
            }
            out.push('\n');
        }
    }
}

const POSITIONS: [Channel; 3] = [Channel::XPosition, Channel::YPosition, Channel::ZPosition];

enum Step {
    Open(usize, usize),
    Close(usize),
}

fn axes_of(channels: &[Channel]) -> Vec<usize> {
    channels
        .iter()
        .map(|&channel| kind(channel))
        .filter(|(turns, _)| *turns)
        .map(|(_, axis)| axis)
        .collect()
}

/// Returns whether axes are three different ones, which represent any rotation.
fn is_order(axes: &[usize]) -> bool {
    matches!(axes, &[a, b, c] if a != b && b != c && a != c)
}

/// Returns the angles about `axes` (radians) that are nearest to a rotation; 0 for axes beyond the
/// third and for repeated ones.
fn angles(axes: &[usize], q: DQuat, near: [f64; 3]) -> [f64; 3] {
    match *axes {
        [a, b, c, ..] if is_order(&[a, b, c]) => three_angles(q, [a, b, c], near),
        [a, b, ..] if a != b => {
            let [first, second] = two_angles(q, [a, b]);
            nearest([first, second, 0.0], [near[0], near[1], 0.0])
        }
        [a, ..] => nearest([one_angle(q, a), 0.0, 0.0], [near[0], 0.0, 0.0]),
        [] => [0.0; 3],
    }
}

fn keyword(channel: Channel) -> &'static str {
    match channel {
        Channel::XPosition => "Xposition",
        Channel::YPosition => "Yposition",
        Channel::ZPosition => "Zposition",
        Channel::XRotation => "Xrotation",
        Channel::YRotation => "Yrotation",
        Channel::ZRotation => "Zrotation",
    }
}

fn written_name(name: &str) -> String {
    let replaced = |c: char| match c {
        '{' => '(',
        '}' => ')',
        c if c.is_control() => ' ',
        c => c,
    };
    name.chars().map(replaced).collect::<String>().trim().to_owned()
}

/// Writes tabs, up to a limit: very deep chains would take quadratic space.
fn indent(out: &mut String, depth: usize) {
    out.extend(std::iter::repeat_n('\t', depth.min(64)));
}

fn line(out: &mut String, depth: usize, text: &str) {
    indent(out, depth);
    out.push_str(text);
    out.push('\n');
}

/// Writes a number with at most `decimals` digits after the point, without trailing zeros.
fn number(out: &mut String, value: f64, decimals: usize) {
    let start = out.len();
    // Writing to a string cannot fail.
    if write!(out, "{value:.decimals$}").is_err() {
        return;
    }
    let trimmed = out[start..].trim_end_matches('0').trim_end_matches('.').len();
    out.truncate(start + trimmed);
    if &out[start..] == "-0" || out.len() == start {
        out.truncate(start);
        out.push('0');
    }
}

#[cfg(test)]
mod tests;
