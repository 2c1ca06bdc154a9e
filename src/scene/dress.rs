//! The bodies of skeletons: made when first seen, kept as long as the skeleton is.

use super::Body;
use crate::session::{Key, Motion, Params};
use crate::skeleton::{Roles, Skeleton};
use crate::skin::{Build, SkinnedMesh};
use std::sync::{Arc, Weak};

/// What bodies look like for now, and those that were made so.
#[derive(Debug, Default)]
pub(super) struct Wardrobe {
    cut: Cut,
    bodies: Vec<(Weak<Skeleton>, Roles, Arc<Body>)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cut {
    skin: bool,
    girth: f32,
}

impl Wardrobe {
    /// Chooses what is worn from now on, and lets go of what nobody wears any longer.
    pub(super) fn choose(&mut self, params: &Params) {
        let cut = Cut {
            skin: params.text(Key::Look) != "limbs",
            girth: params.number(Key::FigureBuild) as f32,
        };
        if cut != self.cut {
            self.bodies.clear();
        }
        self.cut = cut;
        self.bodies.retain(|(skeleton, ..)| skeleton.strong_count() > 0);
    }

    /// The body of a motion's skeleton.
    pub(super) fn body(&mut self, motion: &Motion) -> Arc<Body> {
        let skeleton = motion.clip.skeleton();
        let known =
            |(known, roles, _): &&(Weak<Skeleton>, Roles, Arc<Body>)| known.as_ptr() == Arc::as_ptr(skeleton) && *roles == motion.roles;
        if let Some((.., body)) = self.bodies.iter().find(known) {
            return Arc::clone(body);
        }
        let Cut { skin, girth } = self.cut;
        let mut body = Body::new(skeleton, Some(&motion.roles)).with_girth(girth);
        if skin {
            let build = Build { girth, ..Build::default() };
            body = body.with_skin(self.mesh(skeleton, &motion.roles, build));
        }
        let body = Arc::new(body);
        self.bodies
            .push((Arc::downgrade(skeleton), motion.roles.clone(), Arc::clone(&body)));
        body
    }

    /// A mesh for a skeleton: the same for all skeletons that are equal, so that they are drawn together.
    fn mesh(&self, skeleton: &Arc<Skeleton>, roles: &Roles, build: Build) -> Arc<SkinnedMesh> {
        let alike = self.bodies.iter().find(|(other, others_roles, _)| {
            others_roles == roles && other.upgrade().is_some_and(|other| *other == **skeleton)
        });
        match alike.and_then(|(.., body)| body.skin()) {
            Some(mesh) => Arc::clone(mesh),
            None => Arc::new(SkinnedMesh::around(skeleton, roles, build)),
        }
    }
}
