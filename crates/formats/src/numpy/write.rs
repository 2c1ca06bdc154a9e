//! Clips as `.npz` files, for scripts.

use segue_motion::clip::Clip;
use std::collections::BTreeSet;

/// The place of the first element is a multiple of this, as `NumPy`'s documentation of the format
/// asks.
const ALIGNMENT: usize = 64;

/// The date of the files in the archive, 1 January 1980 in the format of MS-DOS: the same clip
/// gives the same bytes at any time.
const DOS_DATE: u16 = 1 << 5 | 1;

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
pub(super) struct NpzWriter {
    bytes: Vec<u8>,
    /// The entries of the list at the end.
    list: Vec<u8>,
    names: BTreeSet<String>,
}

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
        if !self.names.insert(name.to_owned()) {
            return;
        }
        let file = npy(code, shape, elements);
        let path = format!("{name}.npy");
        let mut crc = flate2::Crc::new();
        crc.update(&file);
        let size = file.len() as u32;
        let mut common: Vec<u8> = Vec::new();
        // Version 2.0; no flags; stored; time and date.
        for field in [20, 0, 0, 0, DOS_DATE] {
            common.extend(u16::to_le_bytes(field));
        }
        for field in [crc.sum(), size, size] {
            common.extend(field.to_le_bytes());
        }
        common.extend((path.len() as u16).to_le_bytes());
        common.extend(0_u16.to_le_bytes());
        let at = self.bytes.len() as u32;
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(path.as_bytes());
        self.bytes.extend(&file);
        self.list.extend(b"PK\x01\x02\x14\0");
        self.list.extend(&common);
        // No comment, first disk, no attributes.
        self.list.extend([0; 10]);
        self.list.extend(at.to_le_bytes());
        self.list.extend(path.as_bytes());
    }

    /// Returns the file.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let (at, size) = (self.bytes.len() as u32, self.list.len() as u32);
        let count = self.names.len() as u16;
        self.bytes.append(&mut self.list);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        for number in [count, count] {
            self.bytes.extend(number.to_le_bytes());
        }
        for number in [size, at] {
            self.bytes.extend(number.to_le_bytes());
        }
        self.bytes.extend(0_u16.to_le_bytes());
        self.bytes
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
