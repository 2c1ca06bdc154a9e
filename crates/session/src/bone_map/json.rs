//! Bone maps as files of JSON (`docs/bone-maps.md`).

use super::BoneMap;
use crate::outside;
use segue_motion::skeleton::Role;
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;

/// The largest file that is read as a bone map, bytes: it names a few dozen joints.
pub const MAX_BONE_MAP_BYTES: usize = 64 * 1024;

/// The version of the format.
const VERSION: u64 = 1;
/// The field that says what the file is.
const MARK: &str = "segue_bone_map";

/// The reason why a file is no bone map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum BoneMapError {
    /// More bytes than any map has.
    #[error("a bone map has at most {max} KB", max = MAX_BONE_MAP_BYTES / 1024)]
    TooLarge,
    /// The text breaks off, or has a sign that does not belong there.
    #[error(
        "line {line}, column {column}: this is not JSON; look there for a comma, a quote or a brace that is missing or too many"
    )]
    NotJson {
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
    },
    /// Another version, or another kind of file.
    #[error("`segue_bone_map` must be 1: this is no bone map, or one of a later version")]
    Version,
    /// A rig that is no text.
    #[error("`rig` must be a text; without it, the map is for any rig with these bones")]
    Rig,
    /// No list of body parts.
    #[error("`roles` must list body parts and the names of their bones; a saved map shows how")]
    Roles,
    /// A word that is no body part.
    #[error("`roles`: there is no body part `{word}`; a saved map names all of them")]
    UnknownRole {
        /// The word.
        word: String,
    },
    /// A body part whose bone is no name.
    #[error("`roles`: the bone of `{word}` must be a name in quotes, or null for none")]
    NotAName {
        /// The body part.
        word: String,
    },
    /// A part of a link without a rig.
    #[error("expected a rig and its corrected body parts, as in 5c0d1e7a90b1c2d3:left_foot-Foot_L")]
    LinkedRig,
    /// A part of a link with more corrections than links hold.
    #[error("at most {max} characters, or a bone map as a file")]
    LinkedLength {
        /// The limit.
        max: usize,
    },
    /// Two body parts with one bone.
    #[error("`roles`: `{first}` and `{second}` have the same bone; each bone has one part")]
    SameBone {
        /// A body part.
        first: String,
        /// The other one.
        second: String,
    },
}

/// Returns whether a file says that it is a bone map.
pub(crate) fn is_bone_map(bytes: &[u8]) -> bool {
    let head = bytes.get(..MAX_BONE_MAP_BYTES).unwrap_or(bytes);
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    head.trim_ascii_start().starts_with(b"{")
        && head.windows(MARK.len()).any(|window| window == MARK.as_bytes())
}

#[derive(Serialize)]
struct File<'a> {
    segue_bone_map: u64,
    rig: &'a str,
    #[serde(serialize_with = "by_word")]
    roles: &'a BTreeMap<Role, Option<String>>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn by_word<S: Serializer>(
    roles: &&BTreeMap<Role, Option<String>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(roles.iter().map(|(role, name)| (word_of_role(*role), name)))
}

/// Returns the word of a body part in files, links and the page's API: `left_foot`.
#[must_use]
pub fn word_of_role(role: Role) -> String {
    role.name().replace(' ', "_")
}

/// Returns the body part of a word ([`word_of_role`]).
#[must_use]
pub fn role_of_word(word: &str) -> Option<Role> {
    Role::ALL.into_iter().find(|&role| word_of_role(role) == word)
}

impl BoneMap {
    /// Returns the map as a text of JSON, which [`BoneMap::from_json`] reads.
    #[must_use]
    pub fn to_json(&self) -> String {
        let file = File { segue_bone_map: VERSION, rig: &self.rig, roles: &self.roles };
        // Maps of texts can always be written.
        serde_json::to_string_pretty(&file).unwrap_or_default() + "\n"
    }

    /// Reads a map from the bytes of a file.
    ///
    /// # Errors
    /// [`BoneMapError`] with the place and what to do.
    pub fn from_json(bytes: &[u8]) -> Result<Self, BoneMapError> {
        if bytes.len() > MAX_BONE_MAP_BYTES {
            return Err(BoneMapError::TooLarge);
        }
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let file: Value = serde_json::from_slice(bytes).map_err(|error| BoneMapError::NotJson {
            line: error.line().max(1),
            column: error.column().max(1),
        })?;
        if file.get(MARK).and_then(Value::as_u64) != Some(VERSION) {
            return Err(BoneMapError::Version);
        }
        let rig = match file.get("rig") {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(rig)) => outside::short(rig),
            Some(_) => return Err(BoneMapError::Rig),
        };
        let Some(Value::Object(parts)) = file.get("roles") else {
            return Err(BoneMapError::Roles);
        };
        Ok(Self { rig, roles: Self::roles_of(parts)? })
    }

    /// Reads the body parts of a map, by word.
    ///
    /// # Errors
    /// [`BoneMapError`] about the first part that does not fit.
    pub fn roles_of(
        parts: &serde_json::Map<String, Value>,
    ) -> Result<BTreeMap<Role, Option<String>>, BoneMapError> {
        let mut roles: BTreeMap<Role, Option<String>> = BTreeMap::new();
        for (word, name) in parts {
            let role = role_of_word(word)
                .ok_or_else(|| BoneMapError::UnknownRole { word: outside::short(word) })?;
            let name = match name {
                Value::Null => None,
                Value::String(name) if !name.is_empty() => Some(name.clone()),
                _ => return Err(BoneMapError::NotAName { word: word.clone() }),
            };
            Self::add_role(&mut roles, role, name)?;
        }
        Ok(roles)
    }

    /// Adds a body part and the name of its bone to others.
    ///
    /// # Errors
    /// [`BoneMapError::SameBone`] if another part has that bone.
    pub(super) fn add_role(
        roles: &mut BTreeMap<Role, Option<String>>,
        role: Role,
        name: Option<String>,
    ) -> Result<(), BoneMapError> {
        let same = roles.iter().find(|(_, other)| name.is_some() && **other == name);
        if let Some((&first, _)) = same {
            let [first, second] = [first, role].map(word_of_role);
            return Err(BoneMapError::SameBone { first, second });
        }
        roles.insert(role, name);
        Ok(())
    }
}
