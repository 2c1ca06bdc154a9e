//! Inference of a file's unit and up axis from the size and stance of the character; no motion
//! format states them reliably.

use super::raw::RawMotion;
use glam::Vec3;
use segue_motion::clip::{Provenance, UpAxis};
use segue_motion::skeleton::{Joint, Role, Roles, Side, Skeleton, WorldPose};
use segue_text::{Message, ToMessage, msg};
use std::fmt;

/// Metres per unit of the CMU motion capture database: inches scaled by 0.45, as its skeleton files
/// say (`:units … length 0.45`).
pub const CMU_METRES_PER_UNIT: f64 = 0.0254 / 0.45;

/// Ranges of a person's height in file units (from, below), and the unit. Between people of 1.2 to
/// 2.2 m there is no overlap; in the gaps, the bound is where both neighbours are equally far from
/// a person of 1.7 m, except for centimetres, which are more common than inches.
const UNITS: [(f64, f64, f64); 7] = [
    (0.3, 3.1, 1.0),
    (3.1, 9.7, 0.3048),
    (9.7, 22.6, 0.1),
    (22.6, 45.0, CMU_METRES_PER_UNIT),
    (45.0, 95.0, 0.0254),
    (95.0, 500.0, 0.01),
    (500.0, 5000.0, 0.001),
];

/// The same for bodies on four legs, from cats to horses, as [`Roles::body_height`] measures them
/// by their legs. Their sizes overlap in more units, so that only the usual ones are assumed.
const UNITS_ON_FOUR_LEGS: [(f64, f64, f64); 3] =
    [(0.1, 5.0, 1.0), (5.0, 500.0, 0.01), (500.0, 5000.0, 0.001)];
/// The frames in which four legs are sought.
const PLAN_SAMPLES: usize = 16;

/// The ratio of a body's lengths along two axes from which on the longer one is up.
const CLEAR_RATIO: f32 = 1.25;

/// The unit and up axis of a file, and the source of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The unit and the up axis with which the clip was read.
    pub provenance: Provenance,
    /// The height of the character standing upright, in the file's units: from the lengths of its
    /// bones ([`Roles::body_height`]) where names give its legs, otherwise its extent.
    pub height_units: f64,
    /// Whether the unit was inferred from the height, or stated by the file and confirmed by the
    /// height, rather than given.
    pub unit_detected: bool,
    /// Whether the height fits no unit, so that centimetres were assumed.
    pub unit_unknown: bool,
    /// The source of the up axis.
    pub up_source: UpSource,
    /// Whether the character stands on four legs: its unit was inferred from the sizes of animals.
    pub is_quadruped: bool,
}

/// The source of an up axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpSource {
    /// It was given.
    Given,
    /// It was inferred from the stance.
    Inferred,
    /// The evidence is weak, as for a body that lies in every frame.
    Uncertain,
}

impl Measure {
    /// Returns the height of the character standing upright, metres.
    #[must_use]
    pub fn height_metres(&self) -> f64 {
        self.height_units * self.provenance.metres_per_unit
    }

    /// Returns the measure with the unit stated by the file, metres, if that makes the character as
    /// tall as a person (0.9 to 2.5 m), or an animal on four legs (0.1 to 4 m), and no other unit
    /// was given.
    pub(super) fn with_unit_of_file(self, metres_per_unit: Option<f64>) -> Self {
        let sizes = if self.is_quadruped { 0.1..4.0 } else { 0.9..2.5 };
        match metres_per_unit
            .filter(|unit| self.unit_detected && sizes.contains(&(self.height_units * unit)))
        {
            Some(metres_per_unit) => Self {
                provenance: Provenance { metres_per_unit, ..self.provenance },
                unit_unknown: false,
                ..self
            },
            None => self,
        }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.to_message().fmt(f)
    }
}

impl ToMessage for Measure {
    fn to_message(&self) -> Message {
        let metres = self.provenance.metres_per_unit;
        let unit: Message = match metres {
            1.0 => "metres".into(),
            0.3048 => "feet".into(),
            0.1 => "decimetres".into(),
            0.0254 => "inches".into(),
            0.01 => "centimetres".into(),
            0.001 => "millimetres".into(),
            CMU_METRES_PER_UNIT => "CMU units of 5.64 cm".into(),
            _ => msg!("units of {metres} m"),
        };
        let up = match self.provenance.up {
            UpAxis::Y => "Y up",
            UpAxis::Z => "Z up",
        };
        let (units, height) = (self.height_units, self.height_metres());
        if self.unit_detected {
            msg!("{units:.1} units tall, read as {unit}: {height:.2} m; {up}")
        } else {
            msg!("{units:.1} units tall, set to {unit}: {height:.2} m; {up}")
        }
    }
}

/// Measures a motion in file units and axes. Given values are used unchanged.
///
/// If names give the legs, nothing depends on the rest pose, which may be implausible: the height
/// follows from bone lengths, and the up axis is the one along which limbs and head point over all
/// frames, and on whose floor the body moves ([`Evidence`]).
pub(super) fn measure(
    raw: &RawMotion,
    metres_per_unit: Option<f64>,
    up: Option<UpAxis>,
) -> Measure {
    let rest = Body::of(&raw.rest_points());
    let skeleton = Skeleton::new(raw.joints.clone()).ok();
    let frames =
        skeleton.as_ref().map(|skeleton| sampled_frames(raw, skeleton)).unwrap_or_default();
    let by_shape = || up_axis(&raw.rest_points(), &rest, &frames);
    let named = skeleton.as_ref().and_then(NamedBody::of);
    let (found_up, up_source) = match (up, &named) {
        (Some(up), _) => (up, UpSource::Given),
        (None, Some(named)) => named.up_axis(raw, by_shape),
        (None, None) => (by_shape(), UpSource::Inferred),
    };
    let height = match &named {
        Some(named) => named.height,
        None => f64::from(extent_along(index(found_up), raw, &rest, &frames)),
    };
    let given = metres_per_unit.filter(|unit| unit.is_finite() && *unit > 0.0);
    let is_quadruped =
        skeleton.as_ref().is_some_and(|skeleton| stands_on_four_legs(raw, skeleton, found_up));
    let units = if is_quadruped { &UNITS_ON_FOUR_LEGS[..] } else { &UNITS };
    let detected =
        units.iter().find(|(from, below, _)| (*from..*below).contains(&height)).map(|unit| unit.2);
    Measure {
        provenance: Provenance {
            metres_per_unit: given.or(detected).unwrap_or(0.01),
            up: found_up,
        },
        height_units: height,
        unit_detected: given.is_none(),
        unit_unknown: given.is_none() && detected.is_none(),
        up_source,
        is_quadruped,
    }
}

/// Returns whether a body stands on four legs, where this axis is up ([`Roles::with_plan_of`]).
fn stands_on_four_legs(raw: &RawMotion, skeleton: &Skeleton, up: UpAxis) -> bool {
    let upright = |point: Vec3| match up {
        UpAxis::Y => point,
        UpAxis::Z => Vec3::new(point.x, point.z, -point.y),
    };
    let joints = skeleton.joints().iter().map(|joint| Joint {
        offset: upright(joint.offset),
        end_site: joint.end_site.map(upright),
        ..joint.clone()
    });
    let Ok(turned) = Skeleton::new(joints.collect()) else { return false };
    let step = raw.frames().div_ceil(PLAN_SAMPLES).max(1);
    let poses = (0..raw.frames()).step_by(step).map(|frame| {
        let points = raw.world_points(skeleton, frame).into_iter();
        WorldPose { positions: points.map(upright).collect(), rotations: Vec::new() }
    });
    Roles::detect(&turned).with_plan_of(&turned, poses).is_quadruped()
}

/// Returns the height of a body without known roles: that of its rest pose, or of the median frame
/// where the rest pose lies flat.
fn extent_along(axis: usize, raw: &RawMotion, rest: &Body, frames: &[Body]) -> f32 {
    // A rest pose that lies flat (bones along their own axes) does not show the height; the frames
    // do.
    let upright = rest.extent()[axis] > 0.35 * rest.extent().max_element();
    let mut heights: Vec<f32> = frames.iter().map(|body| body.extent()[axis]).collect();
    heights.sort_by(f32::total_cmp);
    match heights.get(heights.len() / 2) {
        Some(&median) if !upright => median,
        _ => {
            let height = rest.extent()[axis];
            // Without legs, the root's height is used.
            let has_legs = rest.low[axis] < -0.2 * height;
            let offset = raw.joints.first().map_or(0.0, |root| root.offset[axis]);
            let root = if offset == 0.0 {
                raw.root_translations.first().map_or(0.0, |root| root[axis])
            } else {
                offset
            };
            if has_legs { height } else { height + root.max(0.0) }
        }
    }
}

/// A body whose legs are known by their joints' names.
struct NamedBody<'a> {
    skeleton: &'a Skeleton,
    roles: Roles,
    /// File units.
    height: f64,
}

/// The evidence that an axis points up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Evidence {
    /// The component along it of the mean direction of limbs and head, −1 to 1: from feet to hips,
    /// from hands to shoulders, from hips to head.
    limbs: f32,
    /// 0 to 1: the lowest point of the body stays at one level near 0, as on a floor.
    floor: f32,
}

impl Evidence {
    fn sum(self) -> f32 {
        self.limbs + self.floor
    }
}

/// The least difference of evidence between the axes; below it the rest pose decides, with a
/// warning.
const MIN_EVIDENCE: f32 = 0.6;
/// The tolerance of a floor's level, as a share of the body's height.
const FLOOR_SHARE: f32 = 0.15;

impl<'a> NamedBody<'a> {
    fn of(skeleton: &'a Skeleton) -> Option<Self> {
        let roles = Roles::by_name(skeleton);
        roles.leg_length(skeleton)?;
        let height = f64::from(roles.body_height(skeleton));
        (height.is_finite() && height > 0.0).then_some(Self { skeleton, roles, height })
    }

    /// Returns the up axis, and how certain it is.
    fn up_axis(&self, raw: &RawMotion, by_shape: impl FnOnce() -> UpAxis) -> (UpAxis, UpSource) {
        let [y, z] = self.evidence(raw).map(Evidence::sum);
        if (y - z).abs() < MIN_EVIDENCE {
            return (by_shape(), UpSource::Uncertain);
        }
        (if z > y { UpAxis::Z } else { UpAxis::Y }, UpSource::Inferred)
    }

    /// Returns the evidence for Y and for Z.
    fn evidence(&self, raw: &RawMotion) -> [Evidence; 2] {
        let frames = raw.frames();
        let samples = UP_SAMPLES.min(frames);
        let (mut limbs, mut lows) = (Vec3::ZERO, Vec::with_capacity(samples));
        for i in 0..samples {
            let points = raw.world_points(self.skeleton, i * frames / samples);
            if let Some(direction) = self.limb_direction(&points) {
                limbs += direction / samples as f32;
            }
            lows.push(Body::of(&points).low);
        }
        let floor = |axis: usize| {
            let mut levels: Vec<f32> = lows.iter().map(|low| low[axis]).collect();
            levels.sort_by(f32::total_cmp);
            let at = |share: f32| {
                levels.get((share * levels.len() as f32) as usize).copied().unwrap_or(0.0)
            };
            let near = |distance: f32| {
                (1.0 - distance.abs() / (FLOOR_SHARE * self.height as f32)).clamp(0.0, 1.0)
            };
            0.5 * near(at(0.9) - at(0.1)) + 0.5 * near(at(0.5))
        };
        [1, 2].map(|axis| Evidence { limbs: limbs[axis], floor: floor(axis) })
    }

    /// Returns the direction of limbs and head in a frame, weighted by length; unit length.
    fn limb_direction(&self, points: &[Vec3]) -> Option<Vec3> {
        let at = |role| self.roles.get(role).and_then(|joint| points.get(joint).copied());
        let between = |from: Role, to: Role| Some(at(to)? - at(from)?).filter(|v| v.is_finite());
        let legs = Side::BOTH.map(|side| between(Role::foot(side), Role::thigh(side)));
        let arms = Side::BOTH.map(|side| between(Role::hand(side), Role::upper_arm(side)));
        let trunk = between(Role::Hips, Role::Head);
        let sum: Vec3 = legs.into_iter().chain(arms).chain([trunk]).flatten().sum();
        sum.try_normalize()
    }
}

/// The number of frames that are read for the up axis, spread over the clip.
const UP_SAMPLES: usize = 32;

fn index(up: UpAxis) -> usize {
    match up {
        UpAxis::Y => 1,
        UpAxis::Z => 2,
    }
}

/// The bounding box of a body.
#[derive(Clone, Copy)]
struct Body {
    low: Vec3,
    high: Vec3,
}

impl Body {
    fn of(points: &[Vec3]) -> Self {
        let finite = points.iter().copied().filter(|p| p.is_finite());
        let around = finite.fold(None, |b: Option<Self>, p| {
            Some(b.map_or(Self { low: p, high: p }, |b| Self {
                low: b.low.min(p),
                high: b.high.max(p),
            }))
        });
        around.unwrap_or(Self { low: Vec3::ZERO, high: Vec3::ZERO })
    }

    fn extent(&self) -> Vec3 {
        self.high - self.low
    }

    /// Returns the distance of the lowest point from the ground if this axis were up, as a share of
    /// the height.
    fn off_ground(&self, axis: usize) -> f32 {
        self.low[axis].abs() / self.extent()[axis].max(f32::MIN_POSITIVE)
    }
}

/// Returns the bodies of up to eight frames spread over the clip.
fn sampled_frames(raw: &RawMotion, skeleton: &Skeleton) -> Vec<Body> {
    const SAMPLES: usize = 8;
    let frames = raw.frames();
    (0..SAMPLES.min(frames))
        .map(|i| Body::of(&raw.world_points(skeleton, i * frames / SAMPLES.min(frames))))
        .collect()
}

/// Returns the up axis; Y without evidence for Z.
fn up_axis(rest_points: &[Vec3], rest: &Body, frames: &[Body]) -> UpAxis {
    let by_rest = longer_axis(rest.extent(), lateral_axis(rest_points, rest));
    // Frames in which the feet are on the ground of one axis and far from that of the other.
    let share = |votes: &dyn Fn(&Body) -> bool| {
        frames.iter().filter(|body| votes(body)).count() as f32 / frames.len().max(1) as f32
    };
    let stands = |body: &Body, up: usize, other: usize| {
        body.off_ground(up) < 0.15 && body.off_ground(other) > 0.3
    };
    match by_rest {
        // A four-legged body is longer than it is tall, but its feet are on the ground.
        Some(UpAxis::Z)
            if share(&|body| stands(body, 1, 2)) > 0.7
                && share(&|body| stands(body, 2, 1)) < 0.1 =>
        {
            UpAxis::Y
        }
        // The root rotates a Y-up rest pose upright in a Z-up world.
        Some(UpAxis::Y)
            if share(&|body| stands(body, 2, 1) && body.extent().z > 2.0 * body.extent().y)
                > 0.9 =>
        {
            UpAxis::Z
        }
        Some(up) => up,
        None => {
            frames.first().and_then(|body| longer_axis(body.extent(), None)).unwrap_or_default()
        }
    }
}

/// Returns which of Y and Z is up by a body's size along both, when they are clearly different and
/// the arms do not run along one of them.
fn longer_axis(extent: Vec3, lateral: Option<usize>) -> Option<UpAxis> {
    // A body that lies along X gives no evidence for the other axes.
    if extent.y.max(extent.z) < 0.35 * extent.x {
        return None;
    }
    match lateral {
        Some(1) => Some(UpAxis::Z),
        Some(2) => Some(UpAxis::Y),
        _ if extent.z > CLEAR_RATIO * extent.y => Some(UpAxis::Z),
        _ if extent.y > CLEAR_RATIO * extent.z => Some(UpAxis::Y),
        _ => None,
    }
}

/// Returns the axis across which the rest pose is symmetric: left to right.
fn lateral_axis(points: &[Vec3], rest: &Body) -> Option<usize> {
    /// The greatest number of points: every point is compared with every other, and rigs have
    /// fewer.
    const MAX_POINTS: usize = 512;
    if points.len() > MAX_POINTS {
        return None;
    }
    let tolerance = 0.02 * rest.extent().max_element();
    (0..3).find(|&axis| {
        let (mut aside, mut mirrored) = (0_u32, 0_u32);
        for point in points.iter().filter(|p| p[axis].abs() > tolerance) {
            let mut image = *point;
            image[axis] = -image[axis];
            aside += 1;
            mirrored += u32::from(points.iter().any(|p| p.distance(image) < tolerance));
        }
        aside >= 4 && f64::from(mirrored) > 0.8 * f64::from(aside)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ImportOptions;
    use crate::bvh::{WriteOptions, read, write};
    use glam::Quat;
    use segue_motion::clip::fixtures::QuadrupedWalk;

    /// Returns a person 1.66 m tall in T-pose, facing +Z with Y up, from pelvis to feet, head and
    /// hands.
    fn person(map: impl Fn(Vec3) -> Vec3, root: Vec3) -> RawMotion {
        let parts = [
            (None, [0.0, 0.0, 0.0], None),
            (Some(0), [0.1, -0.05, 0.0], None),
            (Some(1), [0.0, -0.42, 0.0], None),
            (Some(2), [0.0, -0.41, 0.0], Some([0.0, -0.06, 0.15])),
            (Some(0), [-0.1, -0.05, 0.0], None),
            (Some(4), [0.0, -0.42, 0.0], None),
            (Some(5), [0.0, -0.41, 0.0], Some([0.0, -0.06, 0.15])),
            (Some(0), [0.0, 0.5, 0.0], Some([0.0, 0.22, 0.0])),
            (Some(7), [0.2, 0.0, 0.0], None),
            (Some(8), [0.6, 0.0, 0.0], None),
            (Some(7), [-0.2, 0.0, 0.0], None),
            (Some(10), [-0.6, 0.0, 0.0], None),
        ];
        let joint = |(parent, offset, end): (Option<usize>, [f32; 3], Option<[f32; 3]>)| Joint {
            name: String::new(),
            parent,
            offset: map(offset.into()),
            end_site: end.map(|end| map(end.into())),
            channels: vec![],
        };
        let joints: Vec<Joint> = parts.into_iter().map(joint).collect();
        RawMotion {
            rotations: vec![Quat::IDENTITY; joints.len()],
            joints,
            root_translations: vec![map(root)],
            ..RawMotion::default()
        }
    }

    const STANDING: Vec3 = Vec3::new(3.0, 0.94, -2.0);

    #[test]
    fn measure_of_a_person_in_any_unit_finds_the_unit() {
        for (_, _, unit) in UNITS {
            let raw = person(|v| v / unit as f32, STANDING);
            let found = measure(&raw, None, None);
            assert_eq!(
                found.provenance,
                Provenance { metres_per_unit: unit, up: UpAxis::Y },
                "{found}"
            );
            assert!((found.height_metres() - 1.66).abs() < 1e-3, "{found}");
        }
        assert!(measure(&person(|v| v * 1e-3, STANDING), None, None).unit_unknown);
        assert!(measure(&person(|v| v * 1e30, STANDING), None, None).unit_unknown);
    }

    /// The legs of a dog in centimetres are as long as a person's in inches.
    #[test]
    fn measure_of_a_body_on_four_legs_finds_the_unit() {
        for axis in [None, Some(Vec3::X)] {
            let clip = QuadrupedWalk { axis, frames: 60, ..QuadrupedWalk::default() }.clip();
            for unit in [1.0, 0.01, 0.001] {
                for up in [UpAxis::Y, UpAxis::Z] {
                    let options = WriteOptions {
                        metres_per_unit: Some(unit),
                        up: Some(up),
                        ..WriteOptions::default()
                    };
                    let text = write(&clip, &options);
                    let read = read("dog.bvh", text.as_bytes(), &ImportOptions::default());
                    let measure = read.unwrap().clips[0].measure;
                    assert!(measure.is_quadruped, "{axis:?}: {measure}");
                    let found = measure.provenance;
                    assert_eq!((found.metres_per_unit, found.up), (unit, up), "{axis:?}");
                }
            }
        }
    }

    #[test]
    fn measure_finds_up_for_any_facing() {
        let facing_z = |v: Vec3| v;
        let facing_x = |v: Vec3| Vec3::new(v.z, v.y, -v.x);
        let z_up = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
        let z_up_facing_x = |v: Vec3| Vec3::new(v.z, v.x, v.y);
        assert_eq!(measure(&person(facing_z, STANDING), None, None).provenance.up, UpAxis::Y);
        assert_eq!(measure(&person(facing_x, STANDING), None, None).provenance.up, UpAxis::Y);
        assert_eq!(measure(&person(z_up, STANDING), None, None).provenance.up, UpAxis::Z);
        assert_eq!(measure(&person(z_up_facing_x, STANDING), None, None).provenance.up, UpAxis::Z);
    }

    #[test]
    fn measure_with_a_rotated_root_finds_up() {
        let mut raw = person(|v| v, Vec3::new(0.0, -2.0, 0.94));
        raw.rotations[0] = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        assert_eq!(measure(&raw, None, None).provenance.up, UpAxis::Z);
    }

    #[test]
    fn measure_with_given_values_keeps_them() {
        let found = measure(&person(|v| v, STANDING), Some(0.5), Some(UpAxis::Z));
        assert_eq!(found.provenance, Provenance { metres_per_unit: 0.5, up: UpAxis::Z });
        assert!(!found.unit_detected && found.up_source == UpSource::Given);
        assert!(measure(&person(|v| v, STANDING), Some(f64::NAN), None).unit_detected);
    }

    /// Returns the same person with named joints, in a motion of three frames, each moved and
    /// rotated.
    fn named(frames: [(Vec3, Quat); 3]) -> RawMotion {
        let mut raw = person(|v| v * 100.0, Vec3::ZERO);
        let names = [
            "Hips",
            "LeftUpLeg",
            "LeftLeg",
            "LeftFoot",
            "RightUpLeg",
            "RightLeg",
            "RightFoot",
            "Head",
            "LeftArm",
            "LeftHand",
            "RightArm",
            "RightHand",
        ];
        for (joint, name) in raw.joints.iter_mut().zip(names) {
            joint.name = name.into();
        }
        raw.rotations = vec![Quat::IDENTITY; 3 * raw.joints.len()];
        raw.root_translations = frames.iter().map(|(at, _)| *at * 100.0).collect();
        for (frame, (_, turn)) in frames.iter().enumerate() {
            raw.rotations[frame * names.len()] = *turn;
        }
        raw
    }

    #[test]
    fn measure_of_named_joints_finds_up_for_any_rest_pose() {
        let quarter = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let walks = [0.0, 1.0, 2.0]
            .map(|way| (Vec3::new(way, 0.94, 0.3 * way), Quat::from_rotation_y(way)));
        assert_eq!(measure(&named(walks), None, None).provenance.up, UpAxis::Y);
        // The rest pose stands along Y, and the motion is in a world where Z is up.
        let turned = walks.map(|(at, turn)| (quarter * at, quarter * turn));
        let found = measure(&named(turned), None, None);
        assert_eq!((found.provenance.up, found.up_source), (UpAxis::Z, UpSource::Inferred));
        // A runner whose trajectory goes along both axes of the ground.
        let runs = turned.map(|(at, turn)| (at + Vec3::new(0.0, 9.0 * at.x, 0.0), turn));
        assert_eq!(measure(&named(runs), None, None).provenance.up, UpAxis::Z);
    }

    #[test]
    fn measure_of_a_lying_body_is_uncertain() {
        let lies = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let found = measure(&named([(Vec3::new(0.0, 0.1, 0.0), lies); 3]), None, None);
        assert_eq!((found.provenance.up, found.up_source), (UpAxis::Y, UpSource::Uncertain));
        let given = measure(&named([(Vec3::new(0.0, 0.1, 0.0), lies); 3]), None, Some(UpAxis::Z));
        assert_eq!((given.provenance.up, given.up_source), (UpAxis::Z, UpSource::Given));
    }

    #[test]
    fn measure_of_named_joints_takes_height_from_bones() {
        let mut raw = named([(STANDING, Quat::IDENTITY); 3]);
        let height = measure(&raw, None, None).height_units;
        assert!((height - 83.0 / 0.491).abs() < 0.01, "{height}");
        // The same bones, each in a frame of its own: an implausible rest pose.
        for (index, joint) in raw.joints.iter_mut().enumerate() {
            let turn = Quat::from_scaled_axis(Vec3::new(index as f32, 1.0, -0.7 * index as f32));
            joint.offset = turn * joint.offset;
        }
        assert!((measure(&raw, None, None).height_units - height).abs() < 0.01);
    }

    #[test]
    fn measure_displays_as_a_sentence() {
        let said = measure(&person(|v| v * 100.0, STANDING), None, None).to_string();
        assert_eq!(said, "166.0 units tall, read as centimetres: 1.66 m; Y up");
    }
}
