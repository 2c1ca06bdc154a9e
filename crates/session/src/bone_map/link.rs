//! Bone maps as parts of a link: `bones=5c0d1e7a90b1c2d3:left_foot-Foot_L;left_toe-`, with a part
//! for each rig whose clips are used.

use super::{BoneMap, BoneMapError, RIG_DIGITS, role_of_word, word_of_role};
use crate::library::Library;
use crate::outside;
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Role, RoleSource, Roles};
use std::collections::{BTreeMap, BTreeSet};

/// The key of these parts.
pub(crate) const BONES: &str = "bones";
/// The longest part, bytes. A link with a longer one would not fit into messages; a map of all
/// parts is a file ([`BoneMap::to_json`]).
const MAX_PART_BYTES: usize = 800;
/// The most rigs in a link.
pub(crate) const MAX_LINKED_RIGS: usize = 4;

/// The characters of names that separate the parts of a map.
const SEPARATORS: &AsciiSet = &CONTROLS.add(b';').add(b'%');

impl BoneMap {
    /// Returns the map as a part of a link, which [`BoneMap::from_link`] reads; `None` where it is
    /// too long, or says nothing.
    pub(crate) fn to_link(&self) -> Option<String> {
        let parts: Vec<String> = (self.roles.iter())
            .map(|(role, name)| {
                let name = name.as_deref().unwrap_or_default();
                format!("{}-{}", word_of_role(*role), utf8_percent_encode(name, SEPARATORS))
            })
            .collect();
        let part = format!("{}:{}", self.rig, parts.join(";"));
        (!parts.is_empty() && part.len() <= MAX_PART_BYTES).then_some(part)
    }

    /// Reads a map from a part of a link.
    ///
    /// # Errors
    /// [`BoneMapError`] about the first body part that does not fit.
    pub(crate) fn from_link(part: &str) -> Result<Self, BoneMapError> {
        let is_rig = |text: &str| {
            text.len() == RIG_DIGITS && text.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        let found = part.split_once(':').filter(|(rig, _)| is_rig(rig));
        let (rig, parts) = found.ok_or(BoneMapError::LinkedRig)?;
        if part.len() > MAX_PART_BYTES {
            return Err(BoneMapError::LinkedLength { max: MAX_PART_BYTES });
        }
        let mut roles = BTreeMap::new();
        for part in parts.split(';') {
            let (word, name) = part.split_once('-').unwrap_or((part, ""));
            let role = role_of_word(word)
                .ok_or_else(|| BoneMapError::UnknownRole { word: outside::short(word) })?;
            let name = percent_decode_str(name).decode_utf8_lossy().into_owned();
            Self::add_role(&mut roles, role, (!name.is_empty()).then_some(name))?;
        }
        Ok(Self { rig: rig.to_ascii_lowercase(), roles })
    }
}

/// Returns the corrections of body parts for a link to some clips, by rig: the parts that differ
/// from those that are found. While a clip is not here or not read, the maps of the opened link for
/// other rigs stay in it.
pub(crate) fn linked_maps(
    library: &Library,
    of_link: &[BoneMap],
    clips: &[String],
) -> Vec<BoneMap> {
    let mut maps: Vec<BoneMap> = Vec::new();
    let mut rigs: BTreeSet<&str> = BTreeSet::new();
    let mut is_complete = true;
    for id in clips.iter().filter(|id| !id.is_empty()) {
        let entry = library.find(id);
        let read = entry.and_then(|entry| Some((entry.facts.as_ref()?, entry.motion.as_ref()?)));
        let Some((facts, motion)) = read else {
            is_complete = false;
            continue;
        };
        if rigs.insert(&facts.rig)
            && let Some(map) = library.bone_maps().get(&facts.rig)
        {
            maps.extend(corrections(map, motion));
        }
    }
    if !is_complete {
        maps.extend(of_link.iter().filter(|map| !rigs.contains(map.rig.as_str())).cloned());
    }
    maps.truncate(MAX_LINKED_RIGS);
    maps
}

/// Returns the parts of a rig's map that differ from those that are found in a clip.
fn corrections(map: &BoneMap, motion: &Motion) -> Option<BoneMap> {
    let found = Roles::detect(motion.clip().skeleton());
    let is_corrected = |role: Role| match motion.roles().source(role) {
        Some(source) => source == RoleSource::ByHand,
        None => found.get(role).is_some(),
    };
    let roles = map.roles.iter().filter(|(role, _)| is_corrected(**role));
    let roles: BTreeMap<_, _> = roles.map(|(role, name)| (*role, name.clone())).collect();
    (!roles.is_empty()).then(|| BoneMap { rig: map.rig.clone(), roles })
}
