//! `NumPy`: arrays in `.npy` and `.npz` files, as research on human motion has them.
//!
//! A `.npy` file is a header, which is a Python dictionary with type, order and shape, and the
//! elements (`NumPy`, "The NPY format", versions 1.0 to 3.0). A `.npz` file is a zip archive of
//! them. Neither has a skeleton or a unit: which motion the arrays are is known by their names and
//! shapes.
//!
//! | file | arrays | body |
//! |---|---|---|
//! | AMASS, SMPL, SMPL-H, SMPL-X | `poses` or `root_orient`, `pose_body`, …; `trans` | a generic one, or that of a model ([`read_model`]) |
//! | Kimodo | `posed_joints`, `global_rot_mats` | from the motion |
//! | `HumanML3D` | 263 or 272 values in each frame | from the motion |
//! | MDM | a pickled dictionary with `motion`, `lengths` | from the motion |
//! | Motion-X | 322 values in each frame | as AMASS |
//! | Segue | see [`write_npz`] | its own |
//!
//! Rotations are vectors (axis times angle), quaternions in either order, six numbers or matrices.
//! Arrays stay as they are in the file until they are used, so that memory is bounded by the size
//! of the file, or of its content where it is packed. Pickled files are read by a machine that
//! knows arrays, numbers, texts, lists and dictionaries, and calls nothing.

mod array;
mod body;
mod bundle;
mod container;
mod features;
mod header;
mod model;
mod model_clip;
mod own;
mod pickle;
mod plain;
mod points;
mod posed;
mod rigs;
mod smpl;
mod take;
mod turns;
mod write;

pub(super) use header::is_npy;
pub use model::{SmplModel, read_model};
pub use model_clip::model_clip;
pub use write::write_npz;

use crate::assemble::assemble;
use crate::error::{Fault, ImportError};
use crate::warning::Tally;
use crate::{ImportOptions, ImportedFile, archive, check_size, has_extension, stem};
use container::{entry_paths, read_npy, read_npz};
use segue_text::{Message, msg};

/// The arrays that no motion needs; some are large.
const UNUSED: [&str; 7] =
    ["dmpls", "marker_data", "markers_latent", "vertices", "faces", "posedirs", "weights"];

/// The array names by which a `.zip` file is recognised as an archive of arrays.
const TELLING: [&str; 7] =
    ["poses", "trans", "pose_body", "posed_joints", "global_rot_mats", "rotations", "v_template"];

/// The content of an archive of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Motion,
    Model,
}

/// Returns the content of a zip archive that is a `.npz` file; `None` for an archive of files. An
/// archive of `.npy` files with a name other than `.npz` may be a folder of motions.
pub(super) fn content_of_zip(name: &str, bytes: &[u8]) -> Option<Content> {
    let paths = entry_paths(bytes);
    let is_array = |path: &String| !path.contains('/') && has_extension(path, "npy");
    if paths.is_empty() || !paths.iter().all(is_array) {
        return None;
    }
    if model::is_model(&paths) {
        return Some(Content::Model);
    }
    let told = |path: &String| TELLING.iter().any(|own| path.strip_suffix(".npy") == Some(own));
    let is_called_so = !has_extension(name, "zip");
    (is_called_so || paths.iter().any(told)).then_some(Content::Motion)
}

/// Returns whether a file name has the ending of a pickle.
pub(super) fn is_pickle(name: &str) -> bool {
    ["pkl", "pickle"].iter().any(|ending| has_extension(name, ending))
}

/// Reads a `.npy` or `.npz` file with the bones of a generic body where it has none: a clip for
/// each motion in it, in metres and Y up.
///
/// # Errors
/// [`ImportError`] when the file is broken, or none of the motions that are known by their names
/// and shapes.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    read_with_models(name, bytes, &[], options).map(|(file, _)| file)
}

/// Reads a `.npy` or `.npz` file as [`read`] does, with the bones of the best of some body models.
/// Returns the index of the model that was used as well.
///
/// # Errors
/// Those of [`read`].
pub fn read_with_models(
    name: &str,
    bytes: &[u8],
    models: &[&SmplModel],
    options: &ImportOptions,
) -> Result<(ImportedFile, Option<usize>), ImportError> {
    check_size(name, bytes, options)?;
    clips(name, bytes, models, options).map_err(|fault| fault.locate(name, b""))
}

fn clips(
    name: &str,
    bytes: &[u8],
    models: &[&SmplModel],
    options: &ImportOptions,
) -> Result<(ImportedFile, Option<usize>), Fault> {
    let bundles = if archive::is_zip(bytes) {
        vec![read_npz(bytes, options.max_bytes, &|name| !UNUSED.contains(&name))?]
    } else {
        read_npy(bytes)?
    };
    let mut tally = Tally::default();
    let (mut clips, mut used) = (Vec::new(), None);
    let mut takes = Vec::new();
    for bundle in &bundles {
        if own::is_own(bundle) {
            let own = own::read(bundle, &mut tally)?;
            let (fps, provenance) = (options.fps.or(own.fps), own.provenance);
            let fps = fps.filter(|fps| fps.is_finite() && *fps > 0.0).unwrap_or(take::DEFAULT_FPS);
            let as_written = own::options_as_written(options);
            let mut read = assemble(name, vec![own.raw], fps, &as_written, None, &mut tally, 0)?;
            if let (Some(provenance), true) = (provenance, *options == unset(options)) {
                for imported in &mut read {
                    imported.clip = imported.clip.clone().with_provenance(provenance);
                }
            }
            clips.extend(read);
        } else if smpl::is_smpl(bundle) {
            takes.push(smpl::read(bundle, models, &mut tally)?);
        } else if posed::is_posed(bundle) {
            takes.push((posed::read(bundle, &mut tally)?, None));
        } else {
            takes.extend(plain::read(bundle, models, &mut tally)?);
        }
    }
    let several = takes.len() > 1;
    for (index, (take, model)) in takes.into_iter().enumerate() {
        used = used.or(model);
        let mut imported = take.into_clip(name, options, &mut tally)?;
        if several {
            let numbered = format!("{} {}", stem(name), index + 1);
            imported.clip = imported.clip.with_name(numbered);
        }
        clips.push(imported);
    }
    Ok((ImportedFile { clips, warnings: tally.into_warnings(b"") }, used))
}

/// Returns the options without the user's unit and up axis.
fn unset(options: &ImportOptions) -> ImportOptions {
    ImportOptions { metres_per_unit: None, up: None, ..*options }
}

/// Returns the fault of an array whose shape is not `expected`.
fn wrong_shape(found: &[usize], expected: &str) -> Fault {
    Fault::new(0, array_of(found), msg!("{expected}", expected = expected.to_owned()))
}

/// Returns a description of an array by its shape, for an error.
fn array_of(shape: &[usize]) -> Message {
    msg!("an array of shape {shape}", shape = array::shape_text(shape))
}
