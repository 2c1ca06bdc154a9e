//! Clips as `.npz` files, for scripts.

use crate::zip_out::ZipWriter;
use segue_motion::clip::Clip;

/// The place of the first element is a multiple of this, as `NumPy`'s documentation of the format
/// asks.
const ALIGNMENT: usize = 64;

/// Writes a clip as a `.npz` file: a stored zip of arrays in version 1.0 of their format.
///
/// | array | shape | content |
/// |---|---|---|
/// | `names` | (joints) | names of the joints, parents before children |
/// | `parents` | (joints) | index of the parent, −1 for the root |
/// | `offsets` | (joints, 3) | place at rest in the parent, metres, Y up |
/// | `ends` | (joints, 3) | end of the bone in the joint, NaN where it has none |
/// | `rotations` | (frames, joints, 4) | rotation in the parent, quaternion w x y z |
/// | `root` | (frames, 3) | place of the root in the world, metres |
/// | `moving` | (tracks) | joints that also move in their parents |
/// | `moves` | (tracks, frames, 3) | their places there, metres |
/// | `fps` | () | frames per second |
/// | `metres_per_unit`, `z_up` | () | unit and up axis of the file that the clip came from |
///
/// ```python
/// import numpy as np
/// clip = np.load("walk.npz")
/// names, turns, fps = clip["names"], clip["rotations"], float(clip["fps"])
/// ```
///
/// Reading it again gives the same clip, to the last bit.
#[must_use]
pub fn write_npz(clip: &Clip) -> Vec<u8> {
    let unfolded = clip.unfolded();
    let clip = unfolded.as_ref().unwrap_or(clip);
    let joints = clip.skeleton().joints();
    let (count, frames) = (joints.len(), clip.frames());
    let mut npz = NpzWriter::default();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    npz.texts("names", &names);
    let parents = joints.iter().map(|joint| joint.parent.map_or(-1, |parent| parent as i32));
    npz.integers("parents", &parents.collect::<Vec<i32>>());
    let offsets = joints.iter().flat_map(|joint| joint.offset.to_array());
    npz.floats("offsets", &[count, 3], &offsets.collect::<Vec<f32>>());
    let ends = joints.iter().flat_map(|j| j.end_site.map_or([f32::NAN; 3], |end| end.to_array()));
    npz.floats("ends", &[count, 3], &ends.collect::<Vec<f32>>());
    let rotations =
        (0..frames).flat_map(|frame| clip.rotations(frame)).flat_map(|q| [q.w, q.x, q.y, q.z]);
    npz.floats("rotations", &[frames, count, 4], &rotations.collect::<Vec<f32>>());
    let root = clip.root_translations().iter().flat_map(glam::Vec3::to_array);
    npz.floats("root", &[frames, 3], &root.collect::<Vec<f32>>());
    let tracks = clip.translations();
    let moving: Vec<i32> = tracks.iter().map(|track| track.joint as i32).collect();
    npz.integers("moving", &moving);
    let moves = tracks.iter().flat_map(|track| &track.values).flat_map(glam::Vec3::to_array);
    npz.floats("moves", &[tracks.len(), frames, 3], &moves.collect::<Vec<f32>>());
    npz.double("fps", clip.fps());
    npz.double("metres_per_unit", clip.provenance().metres_per_unit);
    let z_up = clip.provenance().up == segue_motion::clip::UpAxis::Z;
    npz.array("z_up", "|b1", &[], &[u8::from(z_up)]);
    npz.finish()
}

/// Writes a `.npz` file array by array.
#[derive(Debug, Default)]
pub(super) struct NpzWriter(ZipWriter);

impl NpzWriter {
    pub(super) fn floats(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.array(name, "<f4", shape, &data);
    }

    pub(super) fn integers(&mut self, name: &str, values: &[i32]) {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.array(name, "<i4", &[values.len()], &data);
    }

    pub(super) fn double(&mut self, name: &str, value: f64) {
        self.array(name, "<f8", &[], &value.to_le_bytes());
    }

    pub(super) fn texts(&mut self, name: &str, texts: &[&str]) {
        let widest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
        let padded = |text: &str| -> Vec<u8> {
            let characters = text.chars().chain(std::iter::repeat('\0')).take(widest);
            characters.flat_map(|c| u32::from(c).to_le_bytes()).collect()
        };
        let data: Vec<u8> = texts.iter().flat_map(|text| padded(text)).collect();
        self.array(name, &format!("<U{widest}"), &[texts.len()], &data);
    }

    /// Adds an array of a type and shape from the bytes of its elements.
    pub(super) fn array(&mut self, name: &str, code: &str, shape: &[usize], elements: &[u8]) {
        // A motion that has no room in an archive has none in memory, either.
        self.0.store(&format!("{name}.npy"), &npy(code, shape, elements)).ok();
    }

    /// Returns the file.
    pub(super) fn finish(self) -> Vec<u8> {
        self.0.finish()
    }
}

/// The number of bytes before the text of a header.
const BEFORE: usize = 10;

/// Returns a `.npy` file.
fn npy(code: &str, shape: &[usize], elements: &[u8]) -> Vec<u8> {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if sizes.len() == 1 { "," } else { "" };
    let mut header =
        format!("{{'descr':'{code}','fortran_order':False,'shape':({}{comma}),}}", sizes.join(","));
    let length = (BEFORE + header.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE;
    header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\0".to_vec();
    file.extend((length as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(elements);
    file
}
