//! Tests of several clips in one file.

use super::*;
use segue_motion::skeleton::{Joint, Roles, Skeleton};
use segue_motion::skin::SkinnedMesh;

/// Returns a skeleton with longer thighs.
fn longer(skeleton: &Skeleton) -> Arc<Skeleton> {
    let thighs = Roles::detect(skeleton);
    let is_longer = |joint: usize| thighs.role_of(joint).is_some() && joint % 2 == 1;
    let joints = skeleton.joints().iter().enumerate().map(|(index, joint)| Joint {
        offset: joint.offset * if is_longer(index) { 1.2 } else { 1.0 },
        ..joint.clone()
    });
    Arc::new(Skeleton::new(joints.collect()).unwrap())
}

/// Returns the largest distance between the joints of one name in two clips, metres: nodes are read
/// depth first.
fn largest_distance(own: &Clip, back: &Clip) -> f32 {
    let joints = own.skeleton().joints().iter();
    let places: Vec<usize> =
        joints.map(|joint| back.skeleton().find(&joint.name).unwrap()).collect();
    let distances = (0..own.frames()).flat_map(|frame| {
        let (own, back) = (own.world_pose(frame), back.world_pose(frame));
        let pairs = own.positions.iter().zip(&places);
        pairs.map(|(own, &place)| own.distance(back.positions[place])).collect::<Vec<_>>()
    });
    distances.fold(0.0, f32::max)
}

#[test]
fn clips_of_one_skeleton_are_animations_on_one_skin() {
    let skeleton = fixtures::cmu_bvh();
    let [a, b] = [1, 2].map(|seed| wander(&skeleton, 20 + seed as usize, seed).with_name("turn"));
    let other = wander(&longer(&skeleton), 12, 3).with_name("turn 2");
    let clips = [&a, &b, &other];
    let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
    for mesh in [None, Some(&mesh)] {
        let bytes = write_clips_glb(&clips, mesh, &GlbOptions::default()).unwrap();
        let file = crate::import("x.glb", &bytes, &ImportOptions::default()).unwrap();
        let names: Vec<&str> = file.clips.iter().map(|own| own.clip.name()).collect();
        assert_eq!(names, ["turn", "turn 3", "turn 2"]);
        for (own, back) in clips.iter().zip(&file.clips) {
            assert_eq!(own.frames(), back.clip.frames());
            let apart = largest_distance(own, &back.clip);
            assert!(apart < 1e-5, "{}: {apart} m", back.clip.name());
        }
        // One skin for all of them.
        let json = bytes.windows(8).filter(|w| w == b"\"joints\"").count();
        assert_eq!(json, 1);
    }
    // One clip alone is the file that it was.
    assert_eq!(
        write_glb(&a, &GlbOptions::default()),
        write_clips_glb(&[&a], None, &GlbOptions::default())
    );
}

#[test]
fn clips_of_other_joints_are_refused_by_name() {
    let a = wander(&fixtures::lafan(), 3, 1).with_name("a");
    let b = wander(&fixtures::mixamo(), 3, 1).with_name("b");
    let write = |clips: &[&Clip]| write_clips_glb(clips, None, &GlbOptions::default());
    let refused = GlbError::OtherSkeleton { clip: "b".into(), first: "a".into() };
    assert_eq!(write(&[&a, &b]), Err(refused));
    assert_eq!(write(&[]), Err(GlbError::NoClips));
    // Joints above the body count, too.
    let rooted = a.with_ground_root();
    assert!(write(&[&a, &rooted]).is_err());
    assert!(write(&[&rooted, &rooted]).is_ok());
}

#[test]
fn ground_root_of_a_written_clip_is_read_back() {
    let clip = wander(&fixtures::cmu_bvh(), 30, 4).with_ground_root();
    let bytes = write_glb(&clip, &GlbOptions::default()).unwrap();
    let back = crate::import("x.glb", &bytes, &ImportOptions::default()).unwrap().clips.remove(0);
    let [own, back] = [&clip, &back.clip].map(|clip| clip.unfolded().unwrap());
    assert_eq!(back.skeleton().joints()[0].name, "root");
    assert!(largest_distance(&own, &back) < 1e-4);
}
