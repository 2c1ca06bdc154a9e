//! The tree of nodes of a file, at rest and in its takes.

use crate::cut::Cut;
use crate::matrix::columns;
use crate::parts::{Parts, Window};
use crate::take::{Movement, Take, WholeCurves};
use crate::{Image, Mesh, OpenError, mesh, stream, take};
use ufbx::{
    AllocatorOpts, CoordinateAxes, CoordinateAxis, ElementType, InheritModeHandling, LoadOpts,
    Progress, ProgressCb, ProgressResult, SceneRoot, SpaceConversion, StringOpt,
};

/// The greatest number of nodes below each other; ufbx walks some trees by recursion.
const MAX_DEPTH: u32 = 1024;
/// The number of bytes between two reports of progress.
const PROGRESS_BYTES: u64 = 256 << 10;

/// The memory that ufbx asks for at once, bytes: with its own 16 MB, more than a small scene needs
/// would stay unused.
const CHUNK_BYTES: usize = 1 << 20;
/// The memory of a scene from which on it is read again without its meshes, bytes.
const MIN_DROPPED_BYTES: usize = 8 << 20;

/// Limits of opening a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenOptions {
    /// The greatest memory for the file's content, bytes. While a file is read, it may take the
    /// same again.
    pub max_memory: usize,
    /// Whether meshes are read.
    pub meshes: bool,
    /// The memory for keys of curves from which on a binary file is read in parts, bytes, each with
    /// a part of the keys that takes about as much. A key takes 40 bytes, in the file 12 or, as
    /// most programs pack them, 5.
    pub max_key_memory: usize,
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
pub struct Scene<'a> {
    /// All that is read; where the file is read in parts, without most keys.
    root: Option<SceneRoot>,
    bytes: &'a [u8],
    options: OpenOptions,
    /// The file, where it is read in parts.
    parts: Option<Parts<'a>>,
    nodes: Vec<Node>,
    takes: Vec<Take>,
    metres_per_unit: f64,
    up: UpAxis,
    fps: f64,
    constraints: usize,
    /// Whether there are meshes and images.
    has_meshes: bool,
}

impl<'a> Scene<'a> {
    /// Opens a file. `progress` gets the number of bytes read about every 256 KB, and returns
    /// whether to go on.
    ///
    /// # Errors
    /// [`OpenError`] when the file is not FBX, is broken, is too large, or `progress` returned
    /// `false`.
    pub fn open(
        bytes: &'a [u8],
        options: OpenOptions,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Self, OpenError> {
        match Parts::open(bytes, options, progress) {
            Ok(Some((root, parts))) => {
                let takes = parts.takes(&root)?;
                return Ok(Self::new(bytes, options, root, takes, Some(parts)));
            }
            // Keys that are too many in parts are too many at once.
            Err(error @ (OpenError::Stopped | OpenError::Keys)) => return Err(error),
            // Something is not as expected, and may be read nevertheless, or refused for a better
            // reason: a part has no length by which a cut-off array would be noticed.
            Ok(None) | Err(_) => {}
        }
        let root = load(Source::Bytes(bytes), options, progress)?;
        let takes = take::takes(&root, &WholeCurves, options.max_memory)?;
        Ok(Self::new(bytes, options, root, takes, None))
    }

    fn new(
        bytes: &'a [u8],
        options: OpenOptions,
        root: SceneRoot,
        takes: Vec<Take>,
        parts: Option<Parts<'a>>,
    ) -> Self {
        let axis = ufbx::find_prop(&root.settings.props, "UpAxis");
        let up = match axis.map_or(-1, |axis| axis.value_int) {
            0 => UpAxis::X,
            1 => UpAxis::Y,
            2 => UpAxis::Z,
            _ => UpAxis::Unknown,
        };
        let constraints = root.constraints.into_iter().filter(|constraint| constraint.active);
        Self {
            bytes,
            options,
            nodes: nodes(&root),
            takes,
            metres_per_unit: root.settings.unit_meters,
            up,
            fps: root.settings.frames_per_second,
            constraints: constraints.count(),
            has_meshes: options.meshes,
            root: Some(root),
            parts,
        }
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

    /// Returns whether it is read in parts, because its keys would take more than
    /// [`OpenOptions::max_key_memory`].
    #[must_use]
    pub fn is_in_parts(&self) -> bool {
        self.parts.is_some()
    }

    /// Returns the skinned meshes, without those of which more than `max_vertices` vertices would
    /// come together, and the number of those left out.
    #[must_use]
    pub fn meshes(&self, max_vertices: usize) -> (Vec<Mesh>, usize) {
        let root = self.root.as_ref().filter(|_| self.has_meshes);
        root.map(|root| mesh::meshes(root, max_vertices)).unwrap_or_default()
    }

    /// Returns an image of a texture.
    #[must_use]
    pub fn image(&self, index: usize) -> Option<Image<'_>> {
        let root = self.root.as_ref().filter(|_| self.has_meshes)?;
        let file = root.texture_files.as_ref().get(index)?;
        Some(Image {
            relative_path: file.relative_filename.as_ref(),
            absolute_path: file.absolute_filename.as_ref(),
            content: &file.content,
        })
    }

    /// Drops meshes and images. Where they may take much memory, the file is read again without
    /// them, but only the first time that this is called. `progress` is that of [`Scene::open`].
    ///
    /// # Errors
    /// [`OpenError`] when the file cannot be read again, or `progress` returned `false`. There are
    /// no transforms in takes from then on.
    pub fn drop_meshes(
        &mut self,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), OpenError> {
        // Without them, a scene may still take enough that another reading seemed worth it.
        if !std::mem::take(&mut self.has_meshes) {
            return Ok(());
        }
        if self.parts.is_some() {
            self.root = None;
            return Ok(());
        }
        let used = self.root.as_ref().map_or(0, |root| root.metadata.result_memory_used);
        if used < self.bytes.len().max(MIN_DROPPED_BYTES) {
            return Ok(());
        }
        // Before the other is read, so that there is memory for one only.
        self.root = None;
        let options = OpenOptions { meshes: false, ..self.options };
        let bare = load(Source::Bytes(self.bytes), options, progress)?;
        if !are_same(&nodes(&bare), &self.nodes) {
            return Err(OpenError::differs());
        }
        self.root = Some(bare);
        Ok(())
    }

    /// Returns the transforms of the nodes in the takes.
    #[must_use]
    pub fn poses(&self) -> Poses<'_> {
        Poses { scene: self, window: None }
    }

    /// Returns the length of the file's unit, metres: 0.01 where the file states none.
    #[must_use]
    pub fn metres_per_unit(&self) -> f64 {
        self.metres_per_unit
    }

    /// Returns the up axis that the file states.
    #[must_use]
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// Returns the frame rate that the file states, frames per second; 24 where it states none.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Returns the number of active constraints, which are not evaluated.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.constraints
    }
}

/// The transforms of nodes in takes. Of a file that is read in parts, the part around the time that
/// was asked for last is kept: times are best asked for in their order.
pub struct Poses<'a> {
    scene: &'a Scene<'a>,
    window: Option<Window>,
}

impl Poses<'_> {
    /// Returns the transform of a node at a time of a take, seconds; outside of the takes if there
    /// is no such take, and the identity if there is no such node.
    ///
    /// # Errors
    /// [`OpenError`] when a part of the file cannot be read.
    pub fn transform(
        &mut self,
        take: usize,
        node: usize,
        secs: f64,
    ) -> Result<Transform, OpenError> {
        let Scene { root, parts, nodes, takes, .. } = self.scene;
        let moves = takes.get(take).and_then(|take| take.movements.get(node));
        let still = moves.is_none_or(|moves| *moves == Movement::Still);
        let at_rest = || nodes.get(node).map_or(Transform::IDENTITY, |node| node.local);
        if still {
            return Ok(at_rest());
        }
        let root = match (parts, takes.get(take)) {
            (Some(parts), Some(found)) => {
                let window = self.window.take().filter(|window| window.has(take, secs));
                let window = match window {
                    Some(window) => window,
                    None => parts.window(take, found, secs)?,
                };
                Some(&self.window.insert(window).root)
            }
            _ => root.as_ref(),
        };
        let found =
            root.and_then(|root| Some((root.anim_stacks.get(take)?, root.nodes.get(node + 1)?)));
        Ok(found.map_or_else(at_rest, |(stack, found)| {
            ufbx::evaluate_transform(&stack.anim, found, secs).into()
        }))
    }
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self =
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };
}

/// The bytes of a scene.
pub(crate) enum Source<'a> {
    /// A whole file.
    Bytes(&'a [u8]),
    /// A file with a part of its keys.
    Cut(Cut<'a>),
}

/// Reads a scene.
pub(crate) fn load(
    source: Source<'_>,
    options: OpenOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<SceneRoot, OpenError> {
    let memory = || AllocatorOpts {
        // Zero would stand for no limit.
        memory_limit: options.max_memory.max(1),
        huge_threshold: CHUNK_BYTES / 16,
        max_chunk_size: CHUNK_BYTES,
        ..AllocatorOpts::default()
    };
    let mut report = |done: &Progress| {
        if progress(usize::try_from(done.bytes_read).unwrap_or(usize::MAX)) {
            ProgressResult::Continue
        } else {
            ProgressResult::Cancel
        }
    };
    let options = LoadOpts {
        temp_allocator: memory(),
        result_allocator: memory(),
        ignore_geometry: !options.meshes,
        ignore_embedded: !options.meshes,
        skip_mesh_parts: true,
        // `mesh::influences` reads the weights of clusters, in less memory.
        skip_skin_vertices: true,
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
    };
    Ok(match source {
        Source::Bytes(bytes) => ufbx::load_memory(bytes, options)?,
        Source::Cut(cut) => stream::load(cut, options)?,
    })
}

/// Returns whether the nodes of two readings of a file are the same to the last bit, because a NaN
/// in a file does not equal itself.
pub(crate) fn are_same(nodes: &[Node], others: &[Node]) -> bool {
    let bits = |transform: &Transform| {
        let Transform { translation, rotation, scale } = transform;
        (translation.map(f64::to_bits), rotation.map(f64::to_bits), scale.map(f64::to_bits))
    };
    let is_same = |(one, other): (&Node, &Node)| {
        one.name == other.name
            && one.parent == other.parent
            && bits(&one.local) == bits(&other.local)
    };
    nodes.len() == others.len() && nodes.iter().zip(others).all(is_same)
}

/// Returns the nodes below the root node of ufbx, which is the first one and stands for the world.
pub(crate) fn nodes(root: &SceneRoot) -> Vec<Node> {
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
