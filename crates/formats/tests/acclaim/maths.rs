//! Rotations and translations of bones, compared with the definition by matrices.

use super::read_with;
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use segue_formats::ImportOptions;
use std::fmt::Write;

#[derive(Clone, Debug)]
struct Bone {
    parent: usize,
    direction: DVec3,
    length: f64,
    axis: [f64; 3],
    axis_order: [usize; 3],
    dofs: Vec<usize>,
}

const DOFS: [&str; 7] = ["tx", "ty", "tz", "rx", "ry", "rz", "l"];
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

fn about(axis: usize, degrees: f64) -> DMat3 {
    [DMat3::from_rotation_x, DMat3::from_rotation_y, DMat3::from_rotation_z][axis](
        degrees.to_radians(),
    )
}

fn letters(order: [usize; 3]) -> String {
    order.iter().map(|&axis| ["X", "Y", "Z"][axis]).collect()
}

fn triple(v: [f64; 3]) -> String {
    format!("{} {} {}", v[0], v[1], v[2])
}

fn bone() -> impl Strategy<Value = (prop::sample::Index, Bone)> {
    let dofs = prop::sample::subsequence((0..7).collect::<Vec<usize>>(), 0..=7).prop_shuffle();
    let part = || -1.0..1.0_f64;
    (
        any::<prop::sample::Index>(),
        [part(), part(), part()],
        0.0..40.0_f64,
        prop::array::uniform3(-180.0..180.0_f64),
        0..6_usize,
        dofs,
    )
        .prop_map(|(parent, direction, length, axis, order, dofs)| {
            let bone = Bone {
                parent: 0,
                direction: DVec3::from_array(direction).normalize_or_zero(),
                length,
                axis,
                axis_order: ORDERS[order],
                dofs,
            };
            (parent, bone)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn bones_equal_the_definition(
        bones in prop::collection::vec(bone(), 1..6),
        root_dofs in Just((0..6_usize).collect::<Vec<_>>()).prop_shuffle(),
        root_order in 0..6_usize,
        position in prop::array::uniform3(-20.0..20.0_f64),
        orientation in prop::array::uniform3(-180.0..180.0_f64),
        values in prop::collection::vec(-90.0..90.0_f64, 48),
    ) {
        // Each bone is a child of any bone before it; the root is 0.
        let bones: Vec<Bone> = bones
            .into_iter()
            .enumerate()
            .map(|(index, (parent, bone))| Bone { parent: parent.index(index + 1), ..bone })
            .collect();
        let name = |index: usize| if index == 0 { "root".to_owned() } else { format!("b{index}") };
        let order: Vec<&str> = root_dofs.iter().map(|&dof| DOFS[dof]).collect();
        let mut asf = format!(
            ":root\norder {}\naxis {}\nposition {}\norientation {}\n:bonedata\n",
            order.join(" ").to_uppercase(),
            letters(ORDERS[root_order]),
            triple(position),
            triple(orientation)
        );
        let mut tree = String::from(":hierarchy\nbegin\n");
        let mut motion = String::from("1\nroot");
        let mut values = values.into_iter();
        let mut take = |dofs: &[usize], motion: &mut String| {
            let mut own = [0.0; 7];
            for &dof in dofs {
                own[dof] = values.next().unwrap_or_default();
                write!(motion, " {}", own[dof]).unwrap();
            }
            own
        };
        let turn = |dofs: &[usize], own: &[f64; 7]| {
            dofs.iter()
                .filter(|dof| (3..6).contains(*dof))
                .fold(DMat3::IDENTITY, |m, &dof| about(dof - 3, own[dof]) * m)
        };
        let own = take(&root_dofs, &mut motion);
        let base = ORDERS[root_order]
            .iter()
            .fold(DMat3::IDENTITY, |m, &axis| about(axis, orientation[axis]) * m);
        let start = DVec3::from_array(position) + base * DVec3::new(own[0], own[1], own[2]);
        // Rotation, start and end of every bone in the world, straight from the definition.
        let mut world = vec![(base * turn(&root_dofs, &own), start, start)];
        for (index, bone) in bones.iter().enumerate() {
            let names: Vec<&str> = bone.dofs.iter().map(|&dof| DOFS[dof]).collect();
            write!(
                asf,
                "begin\nname {}\ndirection {}\nlength {}\naxis {} {}\ndof {}\nend\n",
                name(index + 1),
                triple(bone.direction.to_array()),
                bone.length,
                triple(bone.axis),
                letters(bone.axis_order),
                names.join(" ")
            )
            .unwrap();
            writeln!(tree, "{} {}", name(bone.parent), name(index + 1)).unwrap();
            write!(motion, "\n{}", name(index + 1)).unwrap();
            let own = take(&bone.dofs, &mut motion);
            let c = bone
                .axis_order
                .iter()
                .fold(DMat3::IDENTITY, |m, &axis| about(axis, bone.axis[axis]) * m);
            let (parent, _, end) = world[bone.parent];
            let start = end + parent * (c * DVec3::new(own[0], own[1], own[2]));
            let rotation = parent * c * turn(&bone.dofs, &own) * c.transpose();
            world.push((
                rotation,
                start,
                start + rotation * (bone.direction * (bone.length + own[6])),
            ));
        }
        asf += &tree;
        let options = ImportOptions {
            metres_per_unit: Some(0.01),
            up: Some(segue_motion::clip::UpAxis::Y),
            ..ImportOptions::default()
        };
        let imported = read_with(&asf, &motion, &options)
            .map_err(|error| TestCaseError::fail(format!("{error}\n{asf}\n{motion}")))?;
        let clip = &imported.clips[0].clip;
        let pose = clip.world_pose(0);
        for (index, (rotation, start, end)) in world.iter().enumerate() {
            let Some(joint) = clip.skeleton().find(&name(index)) else {
                // The joints above the bone that carries the body were folded into it.
                let above = clip.skeleton().folded_chain().unwrap();
                prop_assert!(above.joints().any(|joint| joint.name == name(index)));
                continue;
            };
            prop_assert!(
                (pose.positions[joint] * 100.0).as_dvec3().distance(*start) < 1e-3,
                "{} of\n{asf}{motion}",
                name(index)
            );
            let found = glam::Mat3::from_quat(pose.rotations[joint]).as_dmat3();
            prop_assert!((found - *rotation).to_cols_array().iter().all(|d| d.abs() < 1e-5));
            let grows = index > 0 && bones[index - 1].dofs.contains(&6);
            if let (Some(tip), false) = (clip.skeleton().joints()[joint].end_site, grows) {
                prop_assert!((pose.point(joint, tip) * 100.0).as_dvec3().distance(*end) < 1e-3);
            }
        }
    }
}
