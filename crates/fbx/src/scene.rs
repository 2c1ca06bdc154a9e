//! The tree of nodes of a file, at rest and in its takes.

use crate::matrix::columns;
use crate::take::{Movement, Take};
use crate::{Image, Mesh, OpenError, mesh, take};
use ufbx::{
    AllocatorOpts, CoordinateAxes, CoordinateAxis, ElementType, InheritModeHandling, LoadOpts,
    Progress, ProgressCb, ProgressResult, SceneRoot, SpaceConversion, StringOpt,
};

/// The greatest number of nodes below each other; ufbx walks some trees by recursion.
const MAX_DEPTH: u32 = 1024;
/// The number of bytes between two reports of progress.
const PROGRESS_BYTES: u64 = 256 << 10;

/// Limits of opening a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenOptions {
    /// The greatest memory for the file's content, bytes.
    pub max_memory: usize,
    /// Whether meshes are read.
    pub meshes: bool,
}

/// A transform from a node's axes to its parent's: scale first, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// In the file's unit.
    pub translation: [f64; 3],
    /// A unit quaternion, x, y, z, w.
    pub rotation: [f64; 4],
    /// The factor along each axis.
    pub scale: [f64; 3],
}

impl From<ufbx::Transform> for Transform {
    fn from(transform: ufbx::Transform) -> Self {
        let ufbx::Transform { translation: t, rotation: r, scale: s } = transform;
        Self {
            translation: [t.x, t.y, t.z],
            rotation: [r.x, r.y, r.z, r.w],
            scale: [s.x, s.y, s.z],
        }
    }
}

/// The kind of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// A joint of a skeleton (`Root`, `Limb`, `LimbNode`).
    Bone,
    /// A group, a locator, or a node without attribute.
    Empty,
    /// A node that shows a mesh.
    Mesh,
    /// A light, a camera or anything else.
    Other,
}

/// A node of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name, with its namespace.
    pub name: String,
    /// The index of its parent, which is lower than its own.
    pub parent: Option<usize>,
    /// Its kind.
    pub kind: NodeKind,
    /// Its transform outside of the takes.
    pub local: Transform,
    /// The columns of its transform in the world when meshes were bound to it, the last one the
    /// position.
    pub bind: Option<[[f64; 3]; 4]>,
}

/// The up axis of a file's own axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// X or −X.
    X,
    /// Y or −Y.
    Y,
    /// Z or −Z.
    Z,
    /// Not stated.
    Unknown,
}

/// An open file.
pub struct Scene {
    root: SceneRoot,
    nodes: Vec<Node>,
    takes: Vec<Take>,
}

impl Scene {
    /// Opens a file. `progress` gets the number of bytes read about every 256 KB, and returns
    /// whether to go on.
    ///
    /// # Errors
    /// [`OpenError`] when the file is not FBX, is broken, is too large, or `progress` returned
    /// `false`.
    pub fn open(
        bytes: &[u8],
        options: OpenOptions,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Self, OpenError> {
        let memory =
            || AllocatorOpts { memory_limit: options.max_memory, ..AllocatorOpts::default() };
        let mut report = |done: &Progress| {
            if progress(usize::try_from(done.bytes_read).unwrap_or(usize::MAX)) {
                ProgressResult::Continue
            } else {
                ProgressResult::Cancel
            }
        };
        let root = ufbx::load_memory(
            bytes,
            LoadOpts {
                temp_allocator: memory(),
                result_allocator: memory(),
                ignore_geometry: !options.meshes,
                ignore_embedded: !options.meshes,
                skip_mesh_parts: true,
                clean_skin_weights: true,
                node_depth_limit: MAX_DEPTH,
                progress_cb: ProgressCb::Mut(&mut report),
                progress_interval_hint: PROGRESS_BYTES,
                inherit_mode_handling: InheritModeHandling::Compensate,
                scale_helper_name: StringOpt::Ref(" scale"),
                space_conversion: SpaceConversion::AdjustTransforms,
                target_axes: CoordinateAxes {
                    right: CoordinateAxis::PositiveX,
                    up: CoordinateAxis::PositiveY,
                    front: CoordinateAxis::PositiveZ,
                },
                file_format: ufbx::FileFormat::Fbx,
                ..LoadOpts::default()
            },
        )?;
        let nodes = nodes(&root);
        let takes = root.anim_stacks.into_iter().map(|stack| take::take(&root, stack)).collect();
        Ok(Self { root, nodes, takes })
    }

    /// The nodes, each behind its parent.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The takes, in the order of the file.
    #[must_use]
    pub fn takes(&self) -> &[Take] {
        &self.takes
    }

    /// Returns the skinned meshes, without those of which more than `max_vertices` vertices would
    /// come together, and the number of those left out.
    #[must_use]
    pub fn meshes(&self, max_vertices: usize) -> (Vec<Mesh>, usize) {
        mesh::meshes(&self.root, max_vertices)
    }

    /// Returns an image of a texture.
    #[must_use]
    pub fn image(&self, index: usize) -> Option<Image<'_>> {
        let file = self.root.texture_files.as_ref().get(index)?;
        Some(Image {
            relative_path: file.relative_filename.as_ref(),
            absolute_path: file.absolute_filename.as_ref(),
            content: &file.content,
        })
    }

    /// Returns the transform of a node at a time of a take, seconds; outside of the takes if there
    /// is no such take, and the identity if there is no such node.
    #[must_use]
    pub fn transform(&self, take: usize, node: usize, secs: f64) -> Transform {
        let moves = self.takes.get(take).and_then(|take| take.movements.get(node));
        let still = moves.is_none_or(|moves| *moves == Movement::Still);
        match (self.root.anim_stacks.get(take), self.root.nodes.get(node + 1)) {
            (Some(stack), Some(found)) if !still => {
                ufbx::evaluate_transform(&stack.anim, found, secs).into()
            }
            _ => self.nodes.get(node).map_or(Transform::IDENTITY, |node| node.local),
        }
    }

    /// Returns the length of the file's unit, metres: 0.01 where the file states none.
    #[must_use]
    pub fn metres_per_unit(&self) -> f64 {
        self.root.settings.unit_meters
    }

    /// Returns the up axis that the file states.
    #[must_use]
    pub fn up(&self) -> UpAxis {
        let axis = ufbx::find_prop(&self.root.settings.props, "UpAxis");
        match axis.map_or(-1, |axis| axis.value_int) {
            0 => UpAxis::X,
            1 => UpAxis::Y,
            2 => UpAxis::Z,
            _ => UpAxis::Unknown,
        }
    }

    /// Returns the frame rate that the file states, frames per second; 24 where it states none.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.root.settings.frames_per_second
    }

    /// Returns the number of active constraints, which are not evaluated.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.root.constraints.into_iter().filter(|constraint| constraint.active).count()
    }
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self =
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };
}

/// Returns the nodes below the root node of ufbx, which is the first one and stands for the world.
fn nodes(root: &SceneRoot) -> Vec<Node> {
    let mut nodes: Vec<Node> = root
        .nodes
        .into_iter()
        .skip(1)
        .map(|node| Node {
            name: node.element.name.as_ref().to_owned(),
            parent: node
                .parent
                .as_ref()
                .and_then(|parent| (parent.element.typed_id as usize).checked_sub(1)),
            kind: match node.attrib_type {
                _ if node.bone.is_some() => NodeKind::Bone,
                ElementType::Mesh => NodeKind::Mesh,
                ElementType::Unknown | ElementType::Empty | ElementType::Marker => NodeKind::Empty,
                _ => NodeKind::Other,
            },
            local: node.local_transform.into(),
            bind: node
                .bind_pose
                .as_ref()
                .and_then(|pose| ufbx::get_bone_pose(pose, node))
                .map(|pose| columns(&pose.bone_to_world)),
        })
        .collect();
    for cluster in &root.skin_clusters {
        let bone = cluster.bone_node.as_ref().and_then(|bone| bone.element.typed_id.checked_sub(1));
        if let Some(node) = bone.and_then(|bone| nodes.get_mut(bone as usize)) {
            node.bind = Some(columns(&cluster.bind_to_world));
        }
    }
    nodes
}
