//! The skeleton of an ASF file.

use super::asf::{self, Asf, Dof, FileBone, Mention};
use super::lexer::Lexer;
use crate::bvh::MAX_DEPTH;
use crate::error::{Fault, ImportError};
use crate::text::{decode, name, quoted};
use crate::warning::{ImportWarning, Tally, WarningKind};
use crate::{ImportOptions, check_size, stem};
use glam::{DMat3, DVec3, Vec3};
use segue_motion::skeleton::{Channel, Joint};
use segue_text::msg;
use std::collections::HashMap;

/// Metres per unit of a file whose `:units` have a `length` of 1: inches, as the CMU database
/// documents its 0.45.
const METRES_PER_LENGTH: f64 = 0.0254;

/// The degrees of freedom of a bone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motor {
    pub(super) dofs: Vec<Dof>,
    /// The index of its first value in a row.
    pub(super) first_value: usize,
    /// The bone's own axes C, about which its degrees of freedom rotate. For the root: its
    /// orientation.
    pub(super) axes: DMat3,
    /// Unit vector along the bone at rest, or zero.
    pub(super) direction: DVec3,
    /// The position of the joint in the parent's frame at rest, of the root in the world. File
    /// units.
    pub(super) offset: DVec3,
}

/// The skeleton of an ASF file, ready for the motions of AMC files.
///
/// Each bone is a joint with the bone's name at the bone's *start*, so that the joint's rotation
/// turns the bone; its tip is the offset of the joints below, or an end site. The root is joint 0,
/// called `root`. Lengths are in the file's units until a clip is made.
#[derive(Clone, Debug, PartialEq)]
pub struct AcclaimSkeleton {
    pub(super) file: String,
    pub(super) joints: Vec<Joint>,
    /// One for each joint.
    pub(super) motors: Vec<Motor>,
    /// The number of values of a row.
    pub(super) width: usize,
    pub(super) radians: bool,
    pub(super) unit_of_file: Option<f64>,
    pub(super) warnings: Vec<ImportWarning>,
    by_name: HashMap<String, usize>,
    /// Joints by name in lower case; of several, the first.
    by_lowercase_name: HashMap<String, usize>,
}

/// Reads an ASF file. `file_name` is used in errors and, without its ending, as the name of clips
/// of the skeleton alone.
///
/// # Errors
/// [`ImportError`] with the place of the fault: a missing section, an invalid number, a bone below
/// two parents or below itself.
pub fn read_skeleton(
    file_name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<AcclaimSkeleton, ImportError> {
    check_size(file_name, bytes, options)?;
    let text = decode(bytes);
    let mut lexer = Lexer::new(&text);
    let parsed = asf::read(&mut lexer).and_then(|asf| build(&asf, &mut lexer.tally));
    match parsed {
        Ok(skeleton) => Ok(AcclaimSkeleton {
            file: file_name.to_owned(),
            warnings: lexer.tally.into_warnings(&text),
            ..skeleton
        }),
        Err(fault) => Err(fault.locate(file_name, &text)),
    }
}

impl AcclaimSkeleton {
    /// Returns the oddities of the file, one line per kind.
    #[must_use]
    pub fn warnings(&self) -> &[ImportWarning] {
        &self.warnings
    }

    /// Returns the file's name without folders and ending.
    #[must_use]
    pub fn name(&self) -> &str {
        stem(&self.file)
    }

    /// Returns the joint of a bone's name; the exact case takes precedence.
    pub(super) fn find(&self, bone: &str) -> Option<usize> {
        let lowercase = || self.by_lowercase_name.get(&bone.to_lowercase());
        self.by_name.get(bone).or_else(lowercase).copied()
    }

    /// Returns the number of values per frame of a joint.
    pub(super) fn values(&self, joint: usize) -> usize {
        self.motors.get(joint).map_or(0, |motor| motor.dofs.len())
    }
}

/// The hierarchy, by place in the file; the root is 0 and the bones follow.
struct Tree {
    parents: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
}

fn tree(asf: &Asf<'_>, tally: &mut Tally) -> Result<Tree, Fault> {
    let mut places: HashMap<&[u8], usize> =
        asf.bones.iter().enumerate().map(|(index, bone)| (bone.name, index + 1)).collect();
    places.insert(b"root", 0);
    let mut parents = vec![None; asf.bones.len() + 1];
    let mut children = vec![Vec::new(); asf.bones.len() + 1];
    let mut place = |mention: &Mention<'_>| {
        let root = || mention.name.eq_ignore_ascii_case(b"root").then_some(0);
        let found = places.get(mention.name).copied().or_else(root);
        if found.is_none() {
            let name = name(mention.name).0;
            tally.add(WarningKind::UnknownInHierarchy { name }, Some(mention.at));
        }
        found
    };
    for (parent, child) in &asf.links {
        let (Some(above), Some(below)) = (place(parent), place(child)) else {
            continue;
        };
        let taken = below == 0 || parents.get(below).copied().flatten().is_some();
        if taken {
            return Err(Fault::new(
                child.at,
                quoted(child.name),
                "each bone below one other, and the root below none",
            ));
        }
        if let (Some(parent), Some(list)) = (parents.get_mut(below), children.get_mut(above)) {
            *parent = Some(above);
            list.push(below);
        }
    }
    Ok(Tree { parents, children })
}

impl Tree {
    /// Returns the bones below the root with their depths, in the order of the hierarchy: each is
    /// followed by all below it.
    fn order(&self) -> Vec<(usize, usize)> {
        let mut order = Vec::new();
        let mut open = vec![(0, 0)];
        while let Some((bone, depth)) = open.pop() {
            order.push((bone, depth));
            let children = self.children.get(bone).map(Vec::as_slice).unwrap_or_default();
            open.extend(children.iter().rev().map(|&child| (child, depth + 1)));
        }
        order
    }

    /// Returns a bone that is below itself.
    fn cycle(&self) -> Option<usize> {
        // The first pass that reached each bone; passes are counted from 1.
        let mut passes = vec![0_usize; self.parents.len()];
        (0..self.parents.len()).find(|&start| {
            let mut at = Some(start);
            while let Some(bone) = at {
                match passes.get_mut(bone) {
                    Some(walk) if *walk == 0 => *walk = start + 1,
                    Some(walk) => return *walk == start + 1,
                    None => return false,
                }
                at = self.parents.get(bone).copied().flatten();
            }
            false
        })
    }
}

fn build(asf: &Asf<'_>, tally: &mut Tally) -> Result<AcclaimSkeleton, Fault> {
    let tree = tree(asf, tally)?;
    let bone =
        |place: usize| place.checked_sub(1).map_or(Some(&asf.root), |index| asf.bones.get(index));
    if let Some(bone) = tree.cycle().and_then(bone) {
        return Err(Fault::new(
            bone.at,
            msg!("{name} below itself", name = quoted(bone.name)),
            "a hierarchy without circles",
        ));
    }
    let order = tree.order();
    let mut joint_of: Vec<Option<usize>> = vec![None; asf.bones.len() + 1];
    let (mut joints, mut motors) = (Vec::<Joint>::new(), Vec::<Motor>::new());
    let (mut by_name, mut by_lowercase_name) = (HashMap::new(), HashMap::new());
    let mut first_value = 0;
    let mut tails: Vec<DVec3> = Vec::new();
    for &(place, depth) in &order {
        let Some(bone) = bone(place) else { continue };
        if depth > MAX_DEPTH {
            let found = msg!("a bone below more than {MAX_DEPTH} others");
            return Err(Fault::new(bone.at, found, "a skeleton"));
        }
        let (name, is_utf8) = name(bone.name);
        if !is_utf8 {
            tally.add(WarningKind::Latin1Names, Some(bone.at));
        }
        let index = joints.len();
        if let Some(slot) = joint_of.get_mut(place) {
            *slot = Some(index);
        }
        by_name.entry(name.clone()).or_insert(index);
        by_lowercase_name.entry(name.to_lowercase()).or_insert(index);
        let parent = tree
            .parents
            .get(place)
            .copied()
            .flatten()
            .and_then(|parent| joint_of.get(parent).copied().flatten());
        let direction = DVec3::from_array(bone.direction).normalize_or_zero();
        let tail = direction * bone.length;
        let offset = match parent {
            Some(parent) => tails.get(parent).copied().unwrap_or_default(),
            None => DVec3::from_array(asf.root_position),
        };
        let is_leaf = tree.children.get(place).is_none_or(Vec::is_empty);
        joints.push(Joint {
            name,
            parent,
            offset: offset.as_vec3(),
            end_site: (is_leaf && tail != DVec3::ZERO)
                .then(|| tail.as_vec3())
                .filter(|tail| *tail != Vec3::ZERO),
            channels: channels(&bone.dofs),
        });
        motors.push(Motor {
            dofs: bone.dofs.clone(),
            first_value,
            axes: axes(bone, asf.radians),
            direction,
            offset,
        });
        tails.push(tail);
        first_value += bone.dofs.len();
    }
    for (place, _) in joint_of.iter().enumerate().filter(|(_, joint)| joint.is_none()) {
        if let Some(bone) = bone(place) {
            let name = name(bone.name).0;
            tally.add(WarningKind::LooseBones { name }, Some(bone.at));
        }
    }
    Ok(AcclaimSkeleton {
        file: String::new(),
        joints,
        motors,
        width: first_value,
        radians: asf.radians,
        unit_of_file: asf.length.map(|length| METRES_PER_LENGTH / length),
        warnings: Vec::new(),
        by_name,
        by_lowercase_name,
    })
}

/// Returns the equivalent channels of a file that multiplies them from left to right, with
/// rotations about the bone's own axes: the rotations in reverse order.
fn channels(dofs: &[Dof]) -> Vec<Channel> {
    let moves = dofs.iter().filter_map(|dof| match dof {
        Dof::Move(0) => Some(Channel::XPosition),
        Dof::Move(1) => Some(Channel::YPosition),
        Dof::Move(_) => Some(Channel::ZPosition),
        Dof::Turn(_) | Dof::Stretch => None,
    });
    let turns = dofs.iter().rev().filter_map(|dof| match dof {
        Dof::Turn(0) => Some(Channel::XRotation),
        Dof::Turn(1) => Some(Channel::YRotation),
        Dof::Turn(_) => Some(Channel::ZRotation),
        Dof::Move(_) | Dof::Stretch => None,
    });
    moves.chain(turns).collect()
}

/// Returns the product of the rotations of `axis` about fixed axes.
fn axes(bone: &FileBone<'_>, radians: bool) -> DMat3 {
    bone.axis_order.iter().fold(DMat3::IDENTITY, |axes, &index| {
        let value = bone.axis.get(index).copied().unwrap_or_default();
        let angle = if radians { value } else { value.to_radians() };
        let turn = match index {
            0 => DMat3::from_rotation_x(angle),
            1 => DMat3::from_rotation_y(angle),
            _ => DMat3::from_rotation_z(angle),
        };
        turn * axes
    })
}
