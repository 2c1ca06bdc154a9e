//! Clips on their way to a worker.

use super::clip_parcel::ClipHead;
use super::parcel::{ArrayReader, put, split_values};
use super::{Parcel, ParcelError};
use glam::DVec2;
use segue_motion::clip::{ContactCorrection, ContactOptions, Contacts, FootOptions, Motion};
use segue_motion::math::Planar;
use segue_motion::skeleton::{FoldedChain, Foot, Joint, Roles, Skeleton};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// A motion without its skeleton, its roles and its arrays.
#[derive(Serialize, Deserialize)]
pub(super) struct MotionHead<'a> {
    #[serde(borrow)]
    clip: ClipHead<'a>,
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

impl<'a> MotionHead<'a> {
    pub(super) fn of(motion: &'a Motion) -> Self {
        Self {
            clip: ClipHead::of(motion.clip()),
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
        }
    }

    /// Takes the arrays of the motion, and returns the motion of a body.
    pub(super) fn take(
        self,
        skeleton: &Arc<Skeleton>,
        roles: &Roles,
        arrays: &mut ArrayReader<'_>,
    ) -> Result<Motion, ParcelError> {
        let frames = self.clip.frames;
        let clip = self.clip.take(skeleton, arrays)?;
        let bytes = &mut arrays.bytes;
        let places = take_places(bytes, if self.knows_places { frames } else { 0 })?;
        let known_feet = Foot::ALL.get(..self.feet).ok_or(ParcelError::Arrays)?;
        let contacts = take_contacts(bytes, frames, known_feet)?;
        let corrections = self.corrections.into_iter().filter_map(|(foot, frames, planted)| {
            Some(ContactCorrection { foot: *Foot::ALL.get(foot)?, frames, planted })
        });
        let feet = FootOptions { contacts: self.contacts, ground_m: self.set_ground_m };
        let mut motion = if self.knows_places {
            Motion::with_ground_frames(clip, roles, places)
        } else {
            Motion::with_roles(clip, roles)
        }
        .with_feet(feet);
        if !known_feet.is_empty() {
            motion = motion.with_contacts(contacts);
        }
        motion = motion.with_contact_corrections(corrections.collect());
        if let Some(ground_m) = self.ground_m {
            motion = motion.with_ground_m(ground_m);
        }
        Ok(motion.with_seams(self.seams).declared_cycle(self.is_cycle))
    }
}

/// Appends the arrays of a motion that are no floats: as much of its ground frames and contacts as
/// is known.
pub(super) fn put_known(bytes: &mut Vec<u8>, motion: &Motion) {
    let frames = motion.clip().frames();
    bytes.reserve(26 * frames);
    let places = motion.known_ground_frames().unwrap_or_default().iter();
    let places: Vec<[f64; 3]> =
        places.map(|place| [place.yaw, place.shift.x, place.shift.y]).collect();
    put(bytes, &places);
    if let Some(found) = motion.known_contacts() {
        for &foot in found.feet() {
            bytes.extend((0..frames).map(|frame| u8::from(found.planted(foot, frame))));
        }
    }
}

/// A motion without its arrays.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    #[serde(borrow)]
    motion: MotionHead<'a>,
    joints: Cow<'a, [Joint]>,
    above: Cow<'a, Option<FoldedChain>>,
    roles: Cow<'a, Roles>,
}

/// Packs a clip with as much of its ground frames, contacts and ground height as is known, but
/// without its floats ([`arrays_of`](super::clip_parcel::arrays_of)). A worker computes the rest
/// when it needs it, with the same bits.
pub(crate) fn pack_without_floats(motion: &Motion) -> Result<Parcel, ParcelError> {
    let skeleton = motion.clip().skeleton();
    let head = Head {
        motion: MotionHead::of(motion),
        joints: Cow::Borrowed(skeleton.joints()),
        above: Cow::Owned(skeleton.folded_chain().cloned()),
        roles: Cow::Borrowed(motion.roles()),
    };
    let mut bytes = Vec::new();
    put_known(&mut bytes, motion);
    Ok(Parcel { head: serde_json::to_string(&head)?, bytes, ..Parcel::default() })
}

/// Restores a clip.
pub(crate) fn unpack(parcel: &Parcel) -> Result<Motion, ParcelError> {
    let head: Head<'_> = serde_json::from_str(&parcel.head)?;
    let skeleton = Skeleton::new(head.joints.into_owned()).map_err(|_| ParcelError::Arrays)?;
    let skeleton = Arc::new(skeleton.with_folded_chain(head.above.into_owned()));
    let mut arrays = ArrayReader::new(parcel.rotations.clone(), &parcel.floats, &parcel.bytes);
    head.motion.take(&skeleton, &head.roles, &mut arrays)
}

/// Moves places on the ground from the front of `bytes`.
pub(super) fn take_places(bytes: &mut &[u8], count: usize) -> Result<Vec<Planar>, ParcelError> {
    let places = split_values::<[f64; 3]>(bytes, count)?;
    Ok(places.map(|[yaw, x, z]| Planar { yaw, shift: DVec2::new(x, z) }).collect())
}

/// Moves the flags of some feet from the front of `bytes`, foot by foot.
pub(super) fn take_contacts(
    bytes: &mut &[u8],
    frames: usize,
    feet: &[Foot],
) -> Result<Contacts, ParcelError> {
    let mut planted: Vec<Vec<bool>> = Vec::with_capacity(feet.len());
    for _ in feet {
        planted.push(split_values::<u8>(bytes, frames)?.map(|flag| flag != 0).collect());
    }
    let mut planted = planted.into_iter();
    Ok(Contacts::of_feet(feet, |_| planted.next().unwrap_or_default()))
}
