//! The bodies of skeletons: made when first seen, kept as long as the skeleton is. A skin takes a
//! while: until it is there, limbs are worn.

use super::Body;
use segue_motion::clip::{Motion, reference_pose};
use segue_motion::skeleton::{Roles, Skeleton, WorldPose};
use segue_motion::skin::{Character, Drive, Sculptor, Sculpture, SkinnedMesh};
use segue_session::choices;
use segue_session::{Key, Params, Session};
use std::sync::{Arc, Weak};

/// So many skeletons' skins are kept, whether they are worn or not.
const MOST_KEPT: usize = 16;

/// A character that is by itself smaller or larger beside its motion is none of a size that anybody
/// could look at.
const SIZES: (f32, f32) = (0.02, 50.0);

/// What bodies look like for now, and those that were made so.
#[derive(Debug, Default)]
pub(super) struct Wardrobe {
    cut: Cut,
    character: Option<Character>,
    /// The character in the sizes that it is drawn in, each with how many times as large it is
    /// itself.
    sizes: Vec<(f32, Character)>,
    bodies: Vec<(Weak<Skeleton>, Roles, Arc<Body>)>,
    /// One for all skeletons that are equal, so that they are drawn together; the oldest first.
    tailored: Vec<Tailored>,
}

/// The skin of a skeleton.
#[derive(Debug)]
struct Tailored {
    skeleton: Arc<Skeleton>,
    roles: Roles,
    state: State,
    /// As it is worn for now.
    mesh: Option<Arc<SkinnedMesh>>,
}

#[derive(Debug)]
enum State {
    Begun(Box<Sculptor>),
    Done(Box<Sculpture>),
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cut {
    skin: bool,
    girth: f32,
}

/// Whether bodies have a skin.
fn shows_skin(params: &Params) -> bool {
    params.choice::<choices::Look>() != choices::Look::Limbs
}

/// The character that is shown in place of bodies made around bones.
pub(super) fn worn_character(session: &Session) -> Option<Character> {
    session.character().filter(|_| shows_skin(session.params()))
}

/// How many times as large a character is by itself as the motion that moves it; `None` where it
/// cannot.
pub(super) fn size_beside(character: &Character, motion: &Motion) -> Option<f32> {
    let size = character.size_beside(motion.clip().skeleton(), motion.roles())?;
    Some(size.clamp(SIZES.0, SIZES.1))
}

impl Wardrobe {
    /// Chooses what is worn from now on, and lets go of what nobody wears any longer.
    pub(super) fn choose(&mut self, session: &Session) {
        let params = session.params();
        let cut = Cut { skin: shows_skin(params), girth: params.number(Key::FigureBuild) as f32 };
        let character = worn_character(session);
        let same = match (&character, &self.character) {
            (Some(new), Some(old)) => {
                Arc::ptr_eq(&new.mesh, &old.mesh) && Arc::ptr_eq(&new.skeleton, &old.skeleton)
            }
            (new, old) => new.is_none() && old.is_none(),
        };
        if cut != self.cut || !same {
            self.bodies.clear();
            for tailored in &mut self.tailored {
                tailored.mesh = None;
            }
        }
        if !same {
            self.sizes = character.iter().map(|character| (1.0, character.clone())).collect();
        }
        (self.cut, self.character) = (cut, character);
        self.bodies.retain(|(skeleton, ..)| skeleton.strong_count() > 0);
    }

    /// The body of a motion's skeleton.
    pub(super) fn body(&mut self, motion: &Motion) -> Arc<Body> {
        let skeleton = motion.clip().skeleton();
        let known = |(known, roles, _): &&(Weak<Skeleton>, Roles, Arc<Body>)| {
            known.as_ptr() == Arc::as_ptr(skeleton) && roles == motion.roles()
        };
        if let Some((.., body)) = self.bodies.iter().find(known) {
            return Arc::clone(body);
        }
        let body = Arc::new(self.led(motion).unwrap_or_else(|| self.made(motion)));
        self.bodies.push((Arc::downgrade(skeleton), motion.roles().clone(), Arc::clone(&body)));
        body
    }

    /// The character in place of a body, where there is one that can be moved so. It is drawn in
    /// the size of the motion, so that it stands where all else of the motion is drawn; the world
    /// is shown smaller by as much.
    fn led(&mut self, motion: &Motion) -> Option<Body> {
        let skeleton = motion.clip().skeleton();
        let character = self.character.as_ref()?;
        let size = size_beside(character, motion)?;
        let known = self.sizes.iter().find(|(known, _)| *known == size);
        let sized =
            known.map_or_else(|| character.scaled(size.recip()), |(_, sized)| sized.clone());
        if known.is_none() {
            self.sizes.push((size, sized.clone()));
        }
        let drive = Drive::new(motion.clip(), motion.roles(), &sized)?;
        Some(Body::led(&sized, drive, skeleton, motion.roles()).of_size(size))
    }

    /// A body about the bones.
    fn made(&mut self, motion: &Motion) -> Body {
        let Cut { skin, girth } = self.cut;
        let skeleton = motion.clip().skeleton();
        let reference = reference_pose(motion.clip(), motion.roles());
        let body = Body::standing(skeleton, Some(motion.roles()), &reference).with_girth(girth);
        match skin.then(|| self.mesh(skeleton, motion.roles(), &reference)).flatten() {
            Some(mesh) => body.with_skin(mesh),
            None => body,
        }
    }

    /// The skin of a skeleton, where it is there already; else it is begun.
    fn mesh(
        &mut self,
        skeleton: &Arc<Skeleton>,
        roles: &Roles,
        reference: &WorldPose,
    ) -> Option<Arc<SkinnedMesh>> {
        let girth = self.cut.girth;
        let fits = |known: &&mut Tailored| {
            known.roles == *roles
                && (Arc::ptr_eq(&known.skeleton, skeleton) || known.skeleton == *skeleton)
        };
        if let Some(known) = self.tailored.iter_mut().find(fits) {
            let State::Done(sculpture) = &known.state else {
                return None;
            };
            let mesh = known.mesh.get_or_insert_with(|| Arc::new(sculpture.with_girth(girth)));
            return Some(Arc::clone(mesh));
        }
        if self.tailored.len() >= MOST_KEPT {
            self.tailored.remove(0);
        }
        self.tailored.push(Tailored {
            skeleton: Arc::clone(skeleton),
            roles: roles.clone(),
            state: State::Begun(Box::new(Sculptor::new(skeleton, roles, reference))),
            mesh: None,
        });
        None
    }

    /// Whether a skin is in the making.
    pub(super) fn is_at_work(&self) -> bool {
        self.tailored.iter().any(|tailored| matches!(tailored.state, State::Begun(_)))
    }

    /// Makes a little more of a skin that is in the making. `true` while one is.
    pub(super) fn work(&mut self) -> bool {
        let begun = self.tailored.iter_mut().find_map(|tailored| match &mut tailored.state {
            State::Begun(sculptor) => Some((sculptor.advance(), &mut tailored.state)),
            State::Done(_) => None,
        });
        let Some((sculpture, state)) = begun else {
            return false;
        };
        if let Some(sculpture) = sculpture {
            *state = State::Done(Box::new(sculpture));
            // Whoever wears limbs for the time being is dressed anew.
            self.bodies.clear();
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::{Colors, Director, Look, Viewport};
    use segue_session::{Command, Key, Session, Value};

    /// Half the width of the waist of the skin that is worn; none where limbs are.
    fn width(director: &mut Director, session: &Session) -> Option<f32> {
        let stage = director.stage(
            session,
            &[(0, Viewport::default())],
            1.0,
            Look::DARK,
            &Colors::default(),
            0.0,
        );
        let skin = stage.panes[0].figures.first()?.skin.as_ref()?;
        let waist =
            skin.mesh.positions.iter().filter(|p| (0.05..0.2).contains(&p.y) && p.x.abs() < 0.4);
        Some(waist.map(|p| p.x).fold(0.0, f32::max))
    }

    #[test]
    fn limbs_are_worn_until_the_skin_is_made_and_any_girth_at_once() {
        let mut session = Session::new();
        while session.work() {}
        let mut director = Director::default();
        assert_eq!(width(&mut director, &session), None);
        assert!(director.is_at_work());
        let pieces = std::iter::from_fn(|| director.work().then_some(())).count();
        assert!(pieces > 50, "{pieces} pieces");
        let average = width(&mut director, &session).expect("a skin");
        let stout = Command::Set(vec![(Key::FigureBuild, Value::Number(1.5))]);
        session.apply(stout).expect("a stout one");
        let stout = width(&mut director, &session).expect("still a skin");
        assert!(stout > 1.35 * average && stout < 1.6 * average, "{average} to {stout} m");
        assert!(!director.is_at_work());
    }
}
