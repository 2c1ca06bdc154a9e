//! The bone map of humanoid files: VRM 0.x, VRM 1.0 and VRM animations (VRMA).
//!
//! Sources: VRM Consortium, `vrm-specification`: `0.0/README.md`, `VRMC_vrm-1.0/humanoid.md` and
//! `VRMC_vrm_animation-1.0/README.md`.

use glam::{DMat3, DQuat, DVec3};
use segue_motion::skeleton::Role;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// The bone map of a file, and what follows from its kind.
pub(super) struct Humanoid {
    kind: Kind,
    /// The nodes of all bones; the bones that have no role are among them: chest, neck, shoulders,
    /// eyes, jaw and fingers.
    pub(super) nodes: Vec<usize>,
    /// The nodes of the bones that have a role, the first for each role.
    pub(super) roles: Vec<(Role, usize)>,
    /// Nodes whose animation is that of the face: expressions, and the direction of the eyes.
    face: BTreeSet<usize>,
    /// Nodes, and meshes of all nodes, that are drawn from the character's own eyes only.
    first_person_nodes: BTreeSet<usize>,
    first_person_meshes: BTreeSet<usize>,
}

/// The extension that has the bone map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// `VRM`: a character that faces −Z.
    Vrm0,
    /// `VRMC_vrm`: a character that faces +Z.
    Vrm1,
    /// `VRMC_vrm_animation`: nodes in a T-pose that faces +Z, without a mesh.
    Animation,
}

impl Humanoid {
    /// Returns the bone map in a file's JSON; `None` where it has none.
    ///
    /// # Errors
    /// [`serde_json::Error`] where the extension is not as specified.
    pub(super) fn read(json: &[u8]) -> Result<Option<Self>, serde_json::Error> {
        // Most files have none, and a second reading of their JSON takes time.
        if memchr::memmem::find(json, b"\"VRM").is_none() {
            return Ok(None);
        }
        let root: Root = serde_json::from_slice(json)?;
        let Extensions { animation, one, zero } = root.extensions.unwrap_or_default();
        Ok(match (one, zero, animation) {
            (Some(one), ..) => Some(Self::of_one(one)),
            (None, Some(zero), _) => Some(Self::of_zero(zero)),
            (None, None, Some(animation)) => Some(Self::of_animation(animation)),
            (None, None, None) => None,
        })
    }

    fn new(kind: Kind, bones: impl IntoIterator<Item = (String, usize)>) -> Self {
        let (mut nodes, mut roles): (Vec<usize>, Vec<(Role, usize)>) = (Vec::new(), Vec::new());
        for (name, node) in bones {
            nodes.push(node);
            let is_new = |role: &Role| roles.iter().all(|(known, _)| known != role);
            if let Some(role) = role(&name).filter(is_new) {
                roles.push((role, node));
            }
        }
        Self {
            kind,
            nodes,
            roles,
            face: BTreeSet::new(),
            first_person_nodes: BTreeSet::new(),
            first_person_meshes: BTreeSet::new(),
        }
    }

    fn of_one(vrm: Vrm1) -> Self {
        let annotations = vrm.first_person.unwrap_or_default().mesh_annotations;
        let hidden = annotations.into_iter().filter(|own| own.kind == "firstPersonOnly");
        Self {
            first_person_nodes: hidden.filter_map(|own| own.node).collect(),
            ..Self::new(Kind::Vrm1, vrm.humanoid.bones())
        }
    }

    fn of_zero(vrm: Vrm0) -> Self {
        let annotations = vrm.first_person.unwrap_or_default().mesh_annotations;
        let hidden = annotations.into_iter().filter(|own| own.kind == "FirstPersonOnly");
        let bones = vrm.humanoid.human_bones.into_iter();
        Self {
            first_person_meshes: hidden.filter_map(|own| own.mesh.index()).collect(),
            ..Self::new(Kind::Vrm0, bones.filter_map(|bone| Some((bone.bone, bone.node.index()?))))
        }
    }

    fn of_animation(animation: Animation) -> Self {
        let Expressions { preset, custom } = animation.expressions.unwrap_or_default();
        let eyes = animation.look_at.and_then(|eyes| eyes.node);
        let expressions = preset.into_values().chain(custom.into_values());
        Self {
            face: expressions.filter_map(|own| own.node).chain(eyes).collect(),
            ..Self::new(Kind::Animation, animation.humanoid.unwrap_or_default().bones())
        }
    }

    /// Returns the rotation from the file's axes to those in which the character faces +Z.
    pub(super) fn turn(&self) -> (DQuat, DMat3) {
        match self.kind {
            // Exactly half a turn about Y.
            Kind::Vrm0 => (
                DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0),
                DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0)),
            ),
            Kind::Vrm1 | Kind::Animation => (DQuat::IDENTITY, DMat3::IDENTITY),
        }
    }

    /// Returns whether the file is an animation for other characters.
    pub(super) fn is_animation(&self) -> bool {
        self.kind == Kind::Animation
    }

    /// Returns whether a node stands for the face: its channels are no motion of a joint.
    pub(super) fn is_face(&self, node: usize) -> bool {
        self.face.contains(&node)
    }

    /// Returns whether the mesh of a node is drawn from the character's own eyes only.
    pub(super) fn is_first_person(&self, node: usize, mesh: usize) -> bool {
        self.first_person_nodes.contains(&node) || self.first_person_meshes.contains(&mesh)
    }
}

/// Returns the role of a bone, by the name that both versions of the format have for it.
fn role(bone: &str) -> Option<Role> {
    Some(match bone {
        "hips" => Role::Hips,
        "spine" => Role::Spine,
        "head" => Role::Head,
        "leftUpperLeg" => Role::LeftThigh,
        "leftLowerLeg" => Role::LeftShin,
        "leftFoot" => Role::LeftFoot,
        "leftToes" => Role::LeftToe,
        "rightUpperLeg" => Role::RightThigh,
        "rightLowerLeg" => Role::RightShin,
        "rightFoot" => Role::RightFoot,
        "rightToes" => Role::RightToe,
        "leftUpperArm" => Role::LeftUpperArm,
        "leftLowerArm" => Role::LeftForearm,
        "leftHand" => Role::LeftHand,
        "rightUpperArm" => Role::RightUpperArm,
        "rightLowerArm" => Role::RightForearm,
        "rightHand" => Role::RightHand,
        _ => return None,
    })
}

#[derive(Deserialize)]
struct Root {
    extensions: Option<Extensions>,
}

#[derive(Default, Deserialize)]
struct Extensions {
    #[serde(rename = "VRMC_vrm_animation")]
    animation: Option<Animation>,
    #[serde(rename = "VRMC_vrm")]
    one: Option<Vrm1>,
    #[serde(rename = "VRM")]
    zero: Option<Vrm0>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Vrm1 {
    humanoid: Bones,
    first_person: Option<FirstPerson<NodeAnnotation>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Animation {
    humanoid: Option<Bones>,
    expressions: Option<Expressions>,
    look_at: Option<NodeOf>,
}

/// Bones by name, as in VRM 1.0 and VRMA.
#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Bones {
    human_bones: BTreeMap<String, NodeOf>,
}

impl Bones {
    fn bones(self) -> impl Iterator<Item = (String, usize)> {
        self.human_bones.into_iter().filter_map(|(name, bone)| Some((name, bone.node?)))
    }
}

#[derive(Deserialize)]
struct NodeOf {
    node: Option<usize>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Expressions {
    preset: BTreeMap<String, NodeOf>,
    custom: BTreeMap<String, NodeOf>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Vrm0 {
    humanoid: BoneList,
    first_person: Option<FirstPerson<MeshAnnotation>>,
}

/// Bones in a list, as in VRM 0.x.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BoneList {
    human_bones: Vec<Bone>,
}

#[derive(Deserialize)]
struct Bone {
    bone: String,
    #[serde(default)]
    node: Optional,
}

/// An index of VRM 0.x, whose writers have -1 for none.
#[derive(Clone, Copy, Deserialize)]
struct Optional(i64);

impl Default for Optional {
    fn default() -> Self {
        Self(-1)
    }
}

impl Optional {
    fn index(self) -> Option<usize> {
        usize::try_from(self.0).ok()
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct FirstPerson<A> {
    mesh_annotations: Vec<A>,
}

impl<A> Default for FirstPerson<A> {
    fn default() -> Self {
        Self { mesh_annotations: Vec::new() }
    }
}

#[derive(Deserialize)]
struct NodeAnnotation {
    node: Option<usize>,
    #[serde(rename = "type", default)]
    kind: String,
}

#[derive(Deserialize)]
struct MeshAnnotation {
    #[serde(default)]
    mesh: Optional,
    #[serde(rename = "firstPersonFlag", default)]
    kind: String,
}
