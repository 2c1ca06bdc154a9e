//! Small files that others depend on: the skeletons of motions.

use super::sha256_hex;
use segue_formats::acclaim::{self, AcclaimSkeleton};
use segue_formats::numpy::{self, SmplModel};
use segue_formats::{ImportError, ImportOptions};
use segue_text::{Message, msg};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A small file that others depend on: the skeleton of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkeletonFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of the file's bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Its bytes; for a body model those that its joints need.
    pub bytes: Arc<[u8]>,
    /// Whether it is a body model, not the skeleton of an ASF file.
    #[serde(default)]
    pub is_model: bool,
}

impl SkeletonFile {
    /// Returns the report on a file that was just read.
    #[must_use]
    pub fn new(name: &str, bytes: &[u8]) -> Self {
        let name = name.to_owned();
        Self { name, sha256: sha256_hex(bytes), bytes: Arc::from(bytes), is_model: false }
    }

    /// Returns a body model without its mesh: a few KB of 100 MB.
    ///
    /// # Errors
    /// [`ImportError`] when it cannot be read.
    pub fn of_model(
        name: &str,
        bytes: &[u8],
        options: &ImportOptions,
    ) -> Result<Self, ImportError> {
        let model = numpy::read_model(name, bytes, options)?;
        Ok(Self::of_joints(name, sha256_hex(bytes), &model))
    }

    pub(super) fn of_joints(name: &str, sha256: String, model: &SmplModel) -> Self {
        let (name, bytes) = (name.to_owned(), Arc::from(model.to_bytes()));
        Self { name, sha256, bytes, is_model: true }
    }
}

/// The skeleton files that can be read.
pub(super) struct Skeletons<'a> {
    /// Those of AMC files.
    pub(super) acclaim: Vec<(&'a SkeletonFile, AcclaimSkeleton)>,
    /// Those of `NumPy` files.
    pub(super) models: Vec<(&'a SkeletonFile, SmplModel)>,
}

impl<'a> Skeletons<'a> {
    pub(super) fn of(skeleton_files: &'a [SkeletonFile], options: &ImportOptions) -> Self {
        let (models, others): (Vec<_>, Vec<_>) =
            skeleton_files.iter().partition(|skeleton_file| skeleton_file.is_model);
        let acclaim = |own: &'a SkeletonFile| {
            Some((own, acclaim::read_skeleton(&own.name, &own.bytes, options).ok()?))
        };
        let model = |own: &'a SkeletonFile| {
            Some((own, numpy::read_model(&own.name, &own.bytes, options).ok()?))
        };
        Self {
            acclaim: others.into_iter().filter_map(acclaim).collect(),
            models: models.into_iter().filter_map(model).collect(),
        }
    }
}

/// Returns the error for a motion whose skeleton is not among those given, about the most similar
/// one.
pub(super) fn mismatch(
    name: &str,
    bytes: &[u8],
    skeletons: &[(&SkeletonFile, AcclaimSkeleton)],
) -> Option<Message> {
    let fits =
        skeletons.iter().map(|(own, skeleton)| (own, acclaim::matching_bones(bytes, skeleton)));
    let (own, (fitting, bones)) =
        fits.max_by_key(|(own, (fitting, _))| (acclaim::goes_by_name(name, &own.name), *fitting))?;
    Some(msg!(
        "the skeleton of {file} does not fit: {fitting} of {bones} bones have its names and degrees of freedom",
        file = own.name
    ))
}
