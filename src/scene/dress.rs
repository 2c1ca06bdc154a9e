//! The bodies of skeletons: made when first seen, kept as long as the skeleton is.

use super::Body;
use crate::session::{Key, Motion, Session};
use crate::skeleton::{Roles, Skeleton};
use crate::skin::{Character, Drive, SkinnedMesh};
use std::sync::{Arc, Weak};

/// What bodies look like for now, and those that were made so.
#[derive(Debug, Default)]
pub(super) struct Wardrobe {
    cut: Cut,
    character: Option<Character>,
    bodies: Vec<(Weak<Skeleton>, Roles, Arc<Body>)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cut {
    skin: bool,
    girth: f32,
}

impl Wardrobe {
    /// Chooses what is worn from now on, and lets go of what nobody wears any longer.
    /// In a hurry that is what is made at once: limbs.
    pub(super) fn choose(&mut self, session: &Session, hurry: bool) {
        let params = session.params();
        let cut = Cut {
            skin: params.text(Key::Look) != "limbs" && !hurry,
            girth: params.number(Key::FigureBuild) as f32,
        };
        let character = session.character().filter(|_| cut.skin);
        let same = match (&character, &self.character) {
            (Some(new), Some(old)) => Arc::ptr_eq(&new.mesh, &old.mesh) && Arc::ptr_eq(&new.skeleton, &old.skeleton),
            (new, old) => new.is_none() && old.is_none(),
        };
        if cut != self.cut || !same {
            self.bodies.clear();
        }
        (self.cut, self.character) = (cut, character);
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
        let body = Arc::new(self.led(motion).unwrap_or_else(|| self.made(motion)));
        self.bodies
            .push((Arc::downgrade(skeleton), motion.roles.clone(), Arc::clone(&body)));
        body
    }

    /// The character in place of a body, where there is one that can be moved so.
    fn led(&self, motion: &Motion) -> Option<Body> {
        let character = self.character.as_ref()?;
        let drive = Drive::new(&motion.clip, &motion.roles, character)?;
        Some(Body::led(character, drive, &motion.roles))
    }

    /// A body about the bones.
    fn made(&self, motion: &Motion) -> Body {
        let Cut { skin, girth } = self.cut;
        let skeleton = motion.clip.skeleton();
        let body = Body::new(skeleton, Some(&motion.roles)).with_girth(girth);
        if !skin {
            return body;
        }
        body.with_skin(self.mesh(skeleton, &motion.roles, girth))
    }

    /// A mesh for a skeleton: the same for all skeletons that are equal, so that they are drawn together.
    fn mesh(&self, skeleton: &Arc<Skeleton>, roles: &Roles, girth: f32) -> Arc<SkinnedMesh> {
        let alike = self
            .bodies
            .iter()
            .find(|(other, others_roles, _)| others_roles == roles && other.upgrade().is_some_and(|other| *other == **skeleton));
        match alike.and_then(|(.., body)| body.skin()) {
            Some(mesh) => Arc::clone(mesh),
            None => Arc::new(SkinnedMesh::around(skeleton, roles, girth)),
        }
    }
}
