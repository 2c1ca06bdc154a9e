//! Twelve rigs and ways of writing, as different programs have them: names, axes, rates, units,
//! and joints above the body.

use glam::{Quat, Vec3};
use segue_formats::bvh::{RotationOrder, WriteOptions, write};
use segue_motion::clip::{Clip, ClipError, JointTranslations};
use segue_motion::skeleton::{Channel, Joint, Skeleton, SkeletonError};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// The reason why a motion cannot be written as a rig has it.
#[derive(Debug)]
pub(crate) enum RigError {
    Skeleton(SkeletonError),
    Clip(ClipError),
}

impl std::fmt::Display for RigError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Skeleton(error) => error.fmt(f),
            Self::Clip(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RigError {}

impl From<SkeletonError> for RigError {
    fn from(error: SkeletonError) -> Self {
        Self::Skeleton(error)
    }
}

impl From<ClipError> for RigError {
    fn from(error: ClipError) -> Self {
        Self::Clip(error)
    }
}

/// The frames of the joints, and the joints above the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// As the synthesiser has it.
    Plain,
    /// A world with +Z up, and the same rest pose.
    ZUp,
    /// Bones along +X of their joints, as in 3ds Max.
    AlongX,
    /// Position channels on every joint.
    AllPositions,
    /// Below a joint that stands still, turned so that +Z is up, as in game engines.
    BelowRoot,
}

/// A rig, and its way of writing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rig {
    /// The name of its folder.
    pub(crate) folder: &'static str,
    /// The names of the joints of the middle: hips, three of the spine, neck, head.
    middle: [&'static str; 6],
    /// Those of a side, with `*` for it: thigh, shank, foot, toes, shoulder, upper arm, forearm,
    /// hand.
    limbs: [&'static str; 8],
    /// The words for left and right.
    sides: [&'static str; 2],
    pub(crate) form: Form,
    pub(crate) fps: f32,
    /// The length of a unit, metres.
    metres_per_unit: f64,
    order: RotationOrder,
    /// The height of the body, metres.
    pub(crate) height_m: f32,
}

const CM: f64 = 0.01;

/// The rigs.
pub(crate) const RIGS: [Rig; 12] = [
    Rig {
        folder: "01 game studio",
        middle: ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"],
        limbs: ["*UpLeg", "*Leg", "*Foot", "*Toe", "*Shoulder", "*Arm", "*ForeArm", "*Hand"],
        sides: ["Left", "Right"],
        form: Form::Plain,
        fps: 30.0,
        metres_per_unit: CM,
        order: RotationOrder::Zyx,
        height_m: 1.75,
    },
    Rig {
        folder: "02 library with prefixes",
        middle: [
            "mixamorig:Hips",
            "mixamorig:Spine",
            "mixamorig:Spine1",
            "mixamorig:Spine2",
            "mixamorig:Neck",
            "mixamorig:Head",
        ],
        limbs: [
            "mixamorig:*UpLeg",
            "mixamorig:*Leg",
            "mixamorig:*Foot",
            "mixamorig:*ToeBase",
            "mixamorig:*Shoulder",
            "mixamorig:*Arm",
            "mixamorig:*ForeArm",
            "mixamorig:*Hand",
        ],
        sides: ["Left", "Right"],
        form: Form::Plain,
        fps: 60.0,
        metres_per_unit: CM,
        order: RotationOrder::Xyz,
        height_m: 1.68,
    },
    Rig {
        folder: "03 motion database",
        middle: ["hip", "abdomen", "chest", "chest2", "neck", "head"],
        limbs: ["*Thigh", "*Shin", "*Foot", "*Toe", "*Collar", "*Shldr", "*ForeArm", "*Hand"],
        sides: ["l", "r"],
        form: Form::Plain,
        fps: 120.0,
        metres_per_unit: 0.0254,
        order: RotationOrder::Zxy,
        height_m: 1.82,
    },
    Rig {
        folder: "04 bones along X",
        middle: [
            "Bip01_Pelvis",
            "Bip01_Spine",
            "Bip01_Spine1",
            "Bip01_Spine2",
            "Bip01_Neck",
            "Bip01_Head",
        ],
        limbs: [
            "Bip01_*_Thigh",
            "Bip01_*_Calf",
            "Bip01_*_Foot",
            "Bip01_*_Toe0",
            "Bip01_*_Clavicle",
            "Bip01_*_UpperArm",
            "Bip01_*_Forearm",
            "Bip01_*_Hand",
        ],
        sides: ["L", "R"],
        form: Form::AlongX,
        fps: 30.0,
        metres_per_unit: 0.0254,
        order: RotationOrder::Zxy,
        height_m: 1.8,
    },
    Rig {
        folder: "05 game engine",
        middle: ["pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"],
        limbs: [
            "thigh_*",
            "calf_*",
            "foot_*",
            "ball_*",
            "clavicle_*",
            "upperarm_*",
            "lowerarm_*",
            "hand_*",
        ],
        sides: ["l", "r"],
        form: Form::BelowRoot,
        fps: 30.0,
        metres_per_unit: CM,
        order: RotationOrder::Zyx,
        height_m: 1.8,
    },
    Rig {
        folder: "06 Z up in metres",
        middle: ["hips", "spine", "spine.001", "spine.002", "neck", "head"],
        limbs: [
            "thigh.*",
            "shin.*",
            "foot.*",
            "toe.*",
            "shoulder.*",
            "upper_arm.*",
            "forearm.*",
            "hand.*",
        ],
        sides: ["L", "R"],
        form: Form::ZUp,
        fps: 24.0,
        metres_per_unit: 1.0,
        order: RotationOrder::Xyz,
        height_m: 1.7,
    },
    Rig {
        folder: "07 avatars",
        middle: ["hips", "spine", "chest", "upperChest", "neck", "head"],
        limbs: [
            "*UpperLeg",
            "*LowerLeg",
            "*Foot",
            "*Toes",
            "*Shoulder",
            "*UpperArm",
            "*LowerArm",
            "*Hand",
        ],
        sides: ["left", "right"],
        form: Form::Plain,
        fps: 60.0,
        metres_per_unit: 1.0,
        order: RotationOrder::Yxz,
        height_m: 1.55,
    },
    Rig {
        folder: "08 positions on all joints",
        middle: ["Hip", "Ab", "Chest", "Chest2", "Neck", "Head"],
        limbs: ["*Thigh", "*Shin", "*Foot", "*Toe", "*Shoulder", "*UArm", "*FArm", "*Hand"],
        sides: ["L", "R"],
        form: Form::AllPositions,
        fps: 120.0,
        metres_per_unit: CM,
        order: RotationOrder::Zxy,
        height_m: 1.9,
    },
    Rig {
        folder: "09 inertial suit",
        middle: ["Hips", "Chest", "Chest2", "Chest3", "Neck", "Head"],
        limbs: ["*Hip", "*Knee", "*Ankle", "*Toe", "*Collar", "*Shoulder", "*Elbow", "*Wrist"],
        sides: ["Left", "Right"],
        form: Form::Plain,
        fps: 100.0,
        metres_per_unit: CM,
        order: RotationOrder::Yxz,
        height_m: 1.76,
    },
    Rig {
        folder: "10 body model",
        middle: ["Pelvis", "Spine1", "Spine2", "Spine3", "Neck", "Head"],
        limbs: [
            "*_Hip",
            "*_Knee",
            "*_Ankle",
            "*_Foot",
            "*_Collar",
            "*_Shoulder",
            "*_Elbow",
            "*_Wrist",
        ],
        sides: ["L", "R"],
        form: Form::ZUp,
        fps: 50.0,
        metres_per_unit: 1.0,
        order: RotationOrder::Zyx,
        height_m: 1.65,
    },
    Rig {
        folder: "11 full body solver",
        middle: ["Root", "LowerBack", "Thorax", "UpperThorax", "LowerNeck", "Head"],
        limbs: [
            "*_femur",
            "*_tibia",
            "*_foot",
            "*_toes",
            "*_clavicle",
            "*_humerus",
            "*_radius",
            "*_hand",
        ],
        sides: ["l", "r"],
        form: Form::BelowRoot,
        fps: 60.0,
        metres_per_unit: 0.001,
        order: RotationOrder::Xyz,
        height_m: 1.72,
    },
    Rig {
        folder: "12 names that say nothing",
        middle: ["bone_0", "bone_1", "bone_2", "bone_3", "bone_4", "bone_5"],
        limbs: [
            "bone_6*", "bone_7*", "bone_8*", "bone_9*", "bone_10*", "bone_11*", "bone_12*",
            "bone_13*",
        ],
        sides: ["a", "b"],
        form: Form::Plain,
        fps: 25.0,
        metres_per_unit: CM,
        order: RotationOrder::Zxy,
        height_m: 1.78,
    },
];

impl Rig {
    /// Returns the number of channels of a frame.
    pub(crate) fn channels(&self) -> usize {
        match self.form {
            Form::AllPositions => 22 * 6,
            Form::BelowRoot => 22 * 3 + 9,
            Form::Plain | Form::ZUp | Form::AlongX => 22 * 3 + 3,
        }
    }

    /// Returns a motion of the synthesiser's body as a BVH file of this rig.
    ///
    /// # Errors
    /// [`RigError`] if the joints of the motion are not those of the synthesiser's body.
    pub(crate) fn file(&self, made: &Clip) -> Result<String, RigError> {
        let named = self.named(made)?;
        let formed = match self.form {
            Form::Plain => named,
            Form::ZUp => z_up(&named)?,
            Form::AlongX => along_x(&named)?,
            Form::AllPositions => with_all_positions(&named)?,
            Form::BelowRoot => below_root(&named)?,
        };
        let order = (self.form != Form::AllPositions).then_some(self.order);
        let options = WriteOptions {
            metres_per_unit: Some(self.metres_per_unit),
            rotation_order: order,
            ..WriteOptions::default()
        };
        Ok(write(&formed, &options))
    }

    /// Returns the names in the order of the synthesiser's joints.
    fn names(&self) -> Vec<String> {
        let of_side = |limbs: &[&str], side: &str| -> Vec<String> {
            limbs.iter().map(|name| name.replace('*', side)).collect()
        };
        let [hips, trunk @ ..] = self.middle;
        let (legs, arms) = self.limbs.split_at(4);
        let legs = self.sides.iter().flat_map(|side| of_side(legs, side));
        let arms = self.sides.iter().flat_map(|side| of_side(arms, side));
        std::iter::once(hips.to_owned())
            .chain(legs)
            .chain(trunk.map(str::to_owned))
            .chain(arms)
            .collect()
    }

    fn named(&self, made: &Clip) -> Result<Clip, RigError> {
        let joints = made.skeleton().joints().iter().zip(self.names());
        let joints =
            joints.map(|(joint, name)| Joint { name, channels: Vec::new(), ..joint.clone() });
        rebuilt(made, joints.collect(), rotations(made), made.root_translations().to_vec())
    }
}

fn rebuilt(
    clip: &Clip,
    joints: Vec<Joint>,
    rotations: Vec<Quat>,
    roots: Vec<Vec3>,
) -> Result<Clip, RigError> {
    let skeleton = Arc::new(Skeleton::new(joints)?);
    Ok(Clip::new(clip.name(), skeleton, clip.fps(), rotations, roots)?)
}

fn rotations(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect()
}

/// Returns the world turned so that +Z is up, with the same rest pose.
fn z_up(clip: &Clip) -> Result<Clip, RigError> {
    let turn = Quat::from_rotation_x(FRAC_PI_2);
    let mut turned = rotations(clip);
    for root in turned.iter_mut().step_by(clip.skeleton().len()) {
        *root = turn * *root;
    }
    let roots = clip.root_translations().iter().map(|at| turn * *at).collect();
    rebuilt(clip, clip.skeleton().joints().to_vec(), turned, roots)
}

/// Returns the clip with the frames of the joints turned so that bones point along +X.
fn along_x(clip: &Clip) -> Result<Clip, RigError> {
    let mut joints = clip.skeleton().joints().to_vec();
    let bone_of = |index: usize, joint: &Joint| {
        let child = clip.skeleton().joints().iter().find(|own| own.parent == Some(index));
        child.map(|own| own.offset).or(joint.end_site).unwrap_or(Vec3::Y)
    };
    let turns: Vec<Quat> = clip
        .skeleton()
        .joints()
        .iter()
        .enumerate()
        .map(|(index, joint)| {
            Quat::from_rotation_arc(Vec3::X, bone_of(index, joint).normalize_or(Vec3::Y))
        })
        .collect();
    let turn_of = |joint: Option<usize>| {
        joint.and_then(|joint| turns.get(joint)).copied().unwrap_or(Quat::IDENTITY)
    };
    for (index, joint) in joints.iter_mut().enumerate() {
        joint.offset = turn_of(joint.parent).conjugate() * joint.offset;
        joint.end_site = joint.end_site.map(|end| turn_of(Some(index)).conjugate() * end);
    }
    let mut turned = Vec::new();
    for frame in 0..clip.frames() {
        for (index, (&own, joint)) in clip.rotations(frame).iter().zip(&joints).enumerate() {
            turned.push(turn_of(joint.parent).conjugate() * own * turn_of(Some(index)));
        }
    }
    rebuilt(clip, joints, turned, clip.root_translations().to_vec())
}

/// Returns the clip with position channels on every joint.
fn with_all_positions(clip: &Clip) -> Result<Clip, RigError> {
    use Channel::{XPosition, XRotation, YPosition, YRotation, ZPosition, ZRotation};
    let mut joints = clip.skeleton().joints().to_vec();
    for joint in &mut joints {
        joint.channels = vec![XPosition, YPosition, ZPosition, ZRotation, XRotation, YRotation];
    }
    rebuilt(clip, joints, rotations(clip), clip.root_translations().to_vec())
}

/// Returns the body below a joint that stands still and is turned so that +Z is up.
fn below_root(clip: &Clip) -> Result<Clip, RigError> {
    let turn = Quat::from_rotation_x(-FRAC_PI_2);
    let mut joints = vec![Joint {
        name: "Reference".to_owned(),
        parent: None,
        offset: Vec3::ZERO,
        end_site: None,
        channels: Vec::new(),
    }];
    joints.extend(clip.skeleton().joints().iter().map(|joint| Joint {
        parent: Some(joint.parent.map_or(0, |parent| parent + 1)),
        offset: if joint.parent.is_none() { Vec3::ZERO } else { joint.offset },
        ..joint.clone()
    }));
    let mut turned = Vec::new();
    for frame in 0..clip.frames() {
        turned.push(turn);
        for (index, own) in clip.rotations(frame).iter().enumerate() {
            turned.push(if index == 0 { turn.conjugate() * *own } else { *own });
        }
    }
    let places = clip.root_translations().iter().map(|at| turn.conjugate() * *at).collect();
    let roots = vec![Vec3::ZERO; clip.frames()];
    let clip = rebuilt(clip, joints, turned, roots)?;
    Ok(clip.with_translations(vec![JointTranslations { joint: 1, values: places }])?)
}
