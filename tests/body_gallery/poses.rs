//! Poses that strain a body, for any skeleton: made from its bind pose by turning bones in the
//! world.

use glam::{Quat, Vec3};
use segue_motion::skeleton::{Role, Roles, Side, Skeleton, WorldPose};
use segue_motion::skin::SkinnedMesh;

/// A pose under construction, on a body that faces +Z.
struct Posing<'a> {
    skeleton: &'a Skeleton,
    roles: &'a Roles,
    pose: WorldPose,
}

impl Posing<'_> {
    fn joint(&self, role: Role) -> Option<usize> {
        self.roles.get_within(role, self.skeleton.len())
    }

    /// Rotates a joint and everything below it about its position.
    fn turn(&mut self, joint: Option<usize>, turn: Quat) {
        let Some(joint) = joint else { return };
        let center = self.pose.positions[joint];
        for below in joint..self.skeleton.len() {
            let mut above = std::iter::successors(Some(below), |&j| self.skeleton.parent(j));
            if above.any(|j| j == joint) {
                self.pose.positions[below] = center + turn * (self.pose.positions[below] - center);
                self.pose.rotations[below] = turn * self.pose.rotations[below];
            }
        }
    }

    /// Turns a limb by the shortest way so that its bones have these directions; x points away from
    /// the body.
    fn limb(&mut self, side: Side, roles: &[Role], directions: &[[f32; 3]]) {
        let mirror = Vec3::new(if side == Side::Left { 1.0 } else { -1.0 }, 1.0, 1.0);
        for (bone, direction) in roles.windows(2).zip(directions) {
            let (Some(start), Some(end)) = (self.joint(bone[0]), self.joint(bone[1])) else {
                continue;
            };
            let now = (self.pose.positions[end] - self.pose.positions[start]).normalize_or(Vec3::Y);
            let wanted = (Vec3::from(*direction) * mirror).normalize_or(now);
            self.turn(Some(start), Quat::from_rotation_arc(now, wanted));
        }
    }

    fn legs(&mut self, left: [[f32; 3]; 3], right: [[f32; 3]; 3]) {
        self.limb(Side::Left, &Role::leg(Side::Left), &left);
        self.limb(Side::Right, &Role::leg(Side::Right), &right);
    }

    fn arms(&mut self, left: [[f32; 3]; 2], right: [[f32; 3]; 2]) {
        self.limb(Side::Left, &Role::arm(Side::Left), &left);
        self.limb(Side::Right, &Role::arm(Side::Right), &right);
    }
}

/// Returns the pose in which the mesh was generated.
pub(crate) fn bind_pose(mesh: &SkinnedMesh) -> WorldPose {
    let bind: Vec<_> = mesh.bind.iter().map(|joint_from_bind| joint_from_bind.inverse()).collect();
    WorldPose {
        positions: bind.iter().map(|bind| bind.translation).collect(),
        rotations: bind.iter().map(|bind| bind.rotation).collect(),
    }
}

/// Returns the bind pose and poses that strain a body: the contact of a walk, a deep squat with
/// arms ahead, arms up with legs apart, and folded limbs with twisted hands and trunk.
pub(crate) fn strained(mesh: &SkinnedMesh, skeleton: &Skeleton, roles: &Roles) -> Vec<WorldPose> {
    let foot = [0.08, -0.5, 1.0];
    let posed = |strain: &dyn Fn(&mut Posing<'_>)| {
        let mut posing = Posing { skeleton, roles, pose: bind_pose(mesh) };
        strain(&mut posing);
        posing.pose
    };
    let contact = posed(&|body| {
        body.legs(
            [[0.02, -1.0, 0.45], [0.0, -1.0, 0.35], [0.05, -0.15, 1.0]],
            [[0.02, -1.0, -0.25], [0.0, -1.0, -0.55], [0.05, -1.0, 0.6]],
        );
        body.arms([[0.22, -1.0, -0.35], [0.1, -1.0, 0.05]], [[0.22, -1.0, 0.3], [0.0, -0.8, 0.6]]);
    });
    let squat = posed(&|body| {
        body.turn(body.joint(Role::Hips), Quat::from_rotation_x(0.45));
        let leg = [[0.3, -0.2, 1.0], [0.0, -0.75, -0.65], foot];
        body.legs(leg, leg);
        body.arms([[-0.1, -0.1, 1.0], [-0.1, 0.0, 1.0]], [[-0.1, -0.1, 1.0], [-0.1, 0.0, 1.0]]);
    });
    let raised = posed(&|body| {
        body.legs(
            [[0.05, 0.1, 1.0], [0.05, 0.1, 1.0], [0.0, 1.0, 0.6]],
            [[0.8, -0.6, 0.0], [0.8, -0.6, 0.0], [0.5, -0.4, 1.0]],
        );
        body.arms([[0.12, 1.0, 0.0], [0.0, 1.0, 0.1]], [[0.12, 1.0, 0.0], [0.0, 1.0, 0.1]]);
        body.turn(body.joint(Role::Head), Quat::from_rotation_y(0.9));
    });
    let folded = posed(&|body| {
        body.turn(body.joint(Role::Spine), Quat::from_rotation_y(0.6));
        body.legs(
            [[0.05, -1.0, 0.1], [0.0, 0.5, -0.85], [0.0, -0.2, -1.0]],
            [[0.05, -0.1, 1.0], [0.0, -1.0, 0.0], foot],
        );
        body.arms([[0.4, -0.9, 0.2], [-0.1, 0.9, 0.5]], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        body.turn(body.joint(Role::LeftHand), Quat::from_rotation_y(1.6));
        body.turn(body.joint(Role::RightHand), Quat::from_rotation_z(1.6));
    });
    vec![bind_pose(mesh), contact, squat, raised, folded]
}

/// Returns the bind pose, and one in which every joint with a bone turns by this angle about the
/// world's X, up and down by turns.
pub(crate) fn curled(mesh: &SkinnedMesh, skeleton: &Skeleton, radians: f32) -> Vec<WorldPose> {
    let roles = Roles::default();
    let mut posing = Posing { skeleton, roles: &roles, pose: bind_pose(mesh) };
    for joint in 1..skeleton.len() {
        let sign = if joint % 2 == 0 { 1.0 } else { -1.0 };
        posing.turn(Some(joint), Quat::from_rotation_x(sign * radians));
    }
    vec![bind_pose(mesh), posing.pose]
}
