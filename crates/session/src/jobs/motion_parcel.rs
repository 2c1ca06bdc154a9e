//! Clips on their way to a worker.

use super::clip_parcel::ClipHead;
use super::parcel::{put, take};
use super::{Parcel, ParcelError};
use glam::DVec2;
use segue_motion::clip::{ContactCorrection, ContactOptions, Contacts, FootOptions, Motion};
use segue_motion::math::Planar;
use segue_motion::skeleton::{FoldedChain, Foot, Joint, Roles, Skeleton};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// A motion without its arrays.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    clip: ClipHead<'a>,
    joints: Cow<'a, [Joint]>,
    above: Cow<'a, Option<FoldedChain>>,
    roles: Cow<'a, Roles>,
    contacts: ContactOptions,
    /// The height of the ground that is set by hand.
    set_ground_m: Option<f32>,
    /// For each correction, the index of its foot, its frames, and whether it plants it.
    corrections: Vec<(usize, Range<usize>, bool)>,
    seams: Vec<Range<usize>>,
    is_cycle: bool,
    /// Whether the ground frames are known.
    knows_places: bool,
    /// The number of feet whose contacts are known.
    feet: usize,
    ground_m: Option<f32>,
}

/// Packs a clip with as much of its ground frames, contacts and ground height as is known, but
/// without its floats ([`arrays_of`](super::clip_parcel::arrays_of)). A worker computes the rest
/// when it needs it, with the same bits.
pub(crate) fn pack_without_floats(motion: &Motion) -> Result<Parcel, ParcelError> {
    let clip = motion.clip();
    let skeleton = clip.skeleton();
    let head = Head {
        clip: ClipHead::of(clip),
        joints: Cow::Borrowed(skeleton.joints()),
        above: Cow::Owned(skeleton.folded_chain().cloned()),
        roles: Cow::Borrowed(motion.roles()),
        contacts: motion.feet().contacts,
        set_ground_m: motion.feet().ground_m,
        corrections: (motion.contact_corrections().list().iter())
            .map(|of| (of.foot.index(), of.frames.clone(), of.planted))
            .collect(),
        seams: motion.seams().to_vec(),
        is_cycle: motion.is_cycle(),
        knows_places: motion.known_ground_frames().is_some(),
        feet: motion.known_contacts().map_or(0, |contacts| contacts.feet().len()),
        ground_m: motion.known_ground_m(),
    };
    let mut bytes = Vec::with_capacity(26 * clip.frames());
    for place in motion.known_ground_frames().unwrap_or_default() {
        put(&mut bytes, &[place.yaw, place.shift.x, place.shift.y]);
    }
    if let Some(found) = motion.known_contacts() {
        for &foot in found.feet() {
            bytes.extend((0..clip.frames()).map(|frame| u8::from(found.planted(foot, frame))));
        }
    }
    Ok(Parcel { head: serde_json::to_string(&head)?, floats: Vec::new(), bytes })
}

/// Restores a clip.
pub(crate) fn unpack(parcel: &Parcel) -> Result<Motion, ParcelError> {
    unpack_on(&parcel.head, &parcel.floats, &parcel.bytes, std::iter::empty())
}

/// Restores a clip from the parts of its parcel, on the first of the skeletons that is its own.
pub(super) fn unpack_on<'a>(
    head: &str,
    mut floats: &[f32],
    mut bytes: &[u8],
    mut skeletons: impl Iterator<Item = &'a Arc<Skeleton>>,
) -> Result<Motion, ParcelError> {
    let head: Head<'_> = serde_json::from_str(head)?;
    let frames = head.clip.frames;
    let skeleton = Skeleton::new(head.joints.into_owned()).map_err(|_| ParcelError::Arrays)?;
    let skeleton = skeleton.with_folded_chain(head.above.into_owned());
    let known = skeletons.find(|known| ***known == skeleton);
    let skeleton = known.map_or_else(|| Arc::new(skeleton), Arc::clone);
    let clip = head.clip.take(&skeleton, &mut floats)?;
    let places = take::<[f64; 3]>(&mut bytes, if head.knows_places { frames } else { 0 })?;
    let places =
        places.into_iter().map(|[yaw, x, z]| Planar { yaw, shift: DVec2::new(x, z) }).collect();
    let known_feet = Foot::ALL.get(..head.feet).ok_or(ParcelError::Arrays)?;
    let contacts = take_contacts(&mut bytes, frames, known_feet)?;
    let corrections = head.corrections.into_iter().filter_map(|(foot, frames, planted)| {
        Some(ContactCorrection { foot: *Foot::ALL.get(foot)?, frames, planted })
    });
    let feet = FootOptions { contacts: head.contacts, ground_m: head.set_ground_m };
    let mut motion = if head.knows_places {
        Motion::with_ground_frames(clip, &head.roles, places)
    } else {
        Motion::with_roles(clip, &head.roles)
    }
    .with_feet(feet);
    if !known_feet.is_empty() {
        motion = motion.with_contacts(contacts);
    }
    motion = motion.with_contact_corrections(corrections.collect());
    if let Some(ground_m) = head.ground_m {
        motion = motion.with_ground_m(ground_m);
    }
    Ok(motion.with_seams(head.seams).declared_cycle(head.is_cycle))
}

/// Moves the flags of some feet from the front of `bytes`, foot by foot.
pub(super) fn take_contacts(
    bytes: &mut &[u8],
    frames: usize,
    feet: &[Foot],
) -> Result<Contacts, ParcelError> {
    let mut planted: Vec<Vec<bool>> = Vec::with_capacity(feet.len());
    for _ in feet {
        planted.push(take::<u8>(bytes, frames)?.into_iter().map(|flag| flag != 0).collect());
    }
    let mut planted = planted.into_iter();
    Ok(Contacts::of_feet(feet, |_| planted.next().unwrap_or_default()))
}
