//! Tests of the transfer of reports.

use super::*;
use crate::reading::{Parcel, ReadSetup, read};
use segue_formats::bvh;
use segue_motion::clip::fixtures::QuadrupedWalk;
use segue_motion::skeleton::Roles;
use segue_motion::skin::{AlphaMode, Sampler, Wrap};
use segue_motion::synth::{Action, Params, synthesize};
use std::ops::Range;

impl Unpacker {
    /// Returns the capacities of its arrays.
    fn room(&self) -> Vec<usize> {
        let of_clip = |clip: &Arrays| {
            let translations: usize = clip.translations.iter().map(Vec::capacity).sum();
            let contacts: usize = clip.contacts.iter().map(Vec::capacity).sum();
            [clip.rotations.capacity(), translations, clip.ground_frames.capacity(), contacts]
        };
        let of_mesh = |mesh: &SkinnedMesh| {
            let vertices = mesh.positions.capacity()
                + mesh.normals.capacity()
                + mesh.joints.capacity()
                + mesh.weights.capacity();
            [
                vertices,
                mesh.colors.capacity(),
                mesh.triangles.capacity(),
                mesh.bind.capacity(),
                mesh.coordinates.capacity(),
            ]
        };
        let of_file = |file: &Incoming| {
            let clips = file.clips.iter().flat_map(of_clip);
            clips
                .chain(file.meshes.iter().flat_map(of_mesh))
                .chain(file.images.iter().map(Vec::capacity))
                .chain([file.unpacked.capacity()])
                .collect::<Vec<_>>()
        };
        self.files.iter().flat_map(of_file).collect()
    }
}

fn report(secs: f32) -> ReadReport {
    let made = synthesize(&Params { duration_secs: secs, ..Params::new(Action::Walk) });
    let text = bvh::write(&made.unwrap().clip, &bvh::WriteOptions::default());
    read("walk.bvh", text.as_bytes(), &ReadSetup::default(), &mut |_| true).unwrap()
}

/// Returns the report on a file of a body on four legs.
fn report_on_four_legs() -> ReadReport {
    let text = bvh::write(&QuadrupedWalk::default().clip(), &bvh::WriteOptions::default());
    read("dog.bvh", text.as_bytes(), &ReadSetup::default(), &mut |_| true).unwrap()
}

fn sent(report: &ReadReport) -> ReadReport {
    let parcel = Parcel::new(report.clone()).unwrap();
    let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
    let room = unpacker.room();
    parcel.pieces(|piece| unpacker.push(piece));
    assert_eq!(unpacker.room(), room, "nothing grows on the way");
    unpacker.finish().unwrap()
}

#[test]
fn unpacker_without_memory_is_refused_at_the_header() {
    let mut report = report(1.0);
    report.files[0].unpacked = Some(vec![7; 7]);
    let parcel = Parcel::new(report).unwrap();
    let head = parcel.head().replace("\"unpacked\":7", "\"unpacked\":1125899906842624");
    assert_ne!(head, parcel.head());
    let Err(error) = Unpacker::new(&head, u64::MAX) else {
        panic!("there is no petabyte");
    };
    assert!(matches!(error, WireError::NoRoom { .. }), "{error}");
    assert!(error.to_string().contains("remove clips"), "{error}");
    // The memory that is needed is known in bytes.
    let bytes = Unpacker::new(parcel.head(), u64::MAX).unwrap().bytes();
    assert!(Unpacker::new(parcel.head(), bytes).is_ok());
    assert!(matches!(Unpacker::new(parcel.head(), bytes - 1), Err(WireError::NoRoom { .. })));
}

#[test]
fn unpacker_returns_the_report_as_sent() {
    // Long enough for several pieces.
    let mut long = report(60.0);
    long.files
        .push(ReadFile { unpacked: Some((0..=255).collect()), ..report(1.0).files.remove(0) });
    let skeleton = long.files[0].result.as_ref().unwrap().clips[0].motion.clip().skeleton().clone();
    let skin = Texture {
        // Longer than a piece.
        image: (0..3 << 20).map(|byte| byte as u8).collect(),
        sampler: Sampler { wraps: [Wrap::Clamp, Wrap::Mirror], is_nearest: true },
        alpha: AlphaMode::Mask(0.25),
    };
    let hair = Texture { image: [7].into(), alpha: AlphaMode::Blend, ..skin.clone() };
    let part = |(triangles, texture): (Range<usize>, &Texture)| TexturedPart {
        triangles,
        texture: texture.clone(),
    };
    let mesh = Arc::new(SkinnedMesh {
        colors: vec![[0.5, 0.25, 1.0, 1.0]; 3],
        coordinates: vec![[0.5, 2.0]; 7],
        textured: [(0..4, &skin), (5..6, &hair), (6..9, &skin)].map(part).into(),
        ..SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0)
    });
    for file in &mut long.files {
        let read = file.result.as_mut().unwrap();
        read.clips.push(read.clips[0].clone());
        read.clips.iter_mut().for_each(|clip| clip.mesh = Some(Arc::clone(&mesh)));
    }
    long.notes.push("two".into());
    let mut pieces = 0;
    Parcel::new(long.clone()).unwrap().pieces(|_| pieces += 1);
    assert!(pieces > 1, "{pieces}");
    let arrived = sent(&long);
    assert_eq!(arrived, long);
    let clips = &arrived.files[0].result.as_ref().unwrap().clips;
    let [first, second] = [0, 1].map(|clip| clips[clip].mesh.as_ref().unwrap());
    assert!(Arc::ptr_eq(first, second));
    let image = |part: usize| &first.textured[part].texture.image;
    assert!(Arc::ptr_eq(image(0), image(2)));
    let on_four = report_on_four_legs();
    assert_eq!(sent(&on_four), on_four);
    let clip = &on_four.files[0].result.as_ref().unwrap().clips[0];
    assert_eq!(clip.motion.contacts().feet().len(), 4);
    let refused = read("no.bvh", b"HIERARCHY x", &ReadSetup::default(), &mut |_| true).unwrap();
    assert!(refused.files[0].result.is_err());
    assert_eq!(sent(&refused), refused);
}

#[test]
fn unpacker_with_missing_bytes_is_refused() {
    let parcel = Parcel::new(report(2.0)).unwrap();
    let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
    parcel.pieces(|piece| unpacker.push(&piece[..piece.len() - 2]));
    assert!(matches!(unpacker.finish(), Err(WireError::Length { .. })));
    assert!(Unpacker::new("{}", u64::MAX).is_err());
}
