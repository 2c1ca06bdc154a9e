//! The bodies of skeletons: generated on first use, and dropped with their skeleton. A skin takes a
//! while to build; until then the body consists of limbs.

use crate::Body;
use segue_motion::clip::Motion;
use segue_motion::clip::reference_pose;
use segue_motion::skeleton::{Roles, Skeleton, WorldPose};
use segue_motion::skin::{Character, Drive, ProceduralSkin, SkinBuilder, SkinnedMesh};
use segue_session::choices;
use segue_session::{Key, Params, Session};
use std::sync::{Arc, Weak};

/// The greatest number of skins that are kept, shown or not.
const MAX_SKINS: usize = 16;

/// The smallest and largest size of a character relative to its motion; outside of this range
/// nothing would be visible.
const SIZE_RANGE: (f32, f32) = (0.02, 50.0);

/// The bodies in the current style.
#[derive(Debug, Default)]
pub(crate) struct BodyCache {
    style: BodyStyle,
    character: Option<Character>,
    /// The character in every size in which it is drawn, with the ratio of its own size to that
    /// size.
    sizes: Vec<(f32, Character)>,
    bodies: Vec<(Weak<Skeleton>, Roles, Arc<Body>)>,
    /// One for all skeletons that are equal, so that they are drawn together; the oldest first.
    skins: Vec<CachedSkin>,
}

/// The skin of a skeleton.
#[derive(Debug)]
struct CachedSkin {
    skeleton: Arc<Skeleton>,
    roles: Roles,
    state: SkinState,
    /// The skin with the current girth.
    mesh: Option<Arc<SkinnedMesh>>,
}

/// The progress of building a skin.
#[derive(Debug)]
enum SkinState {
    Building(Box<SkinBuilder>),
    Built(Box<ProceduralSkin>),
}

/// The style of bodies that are generated around bones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BodyStyle {
    /// Whether they have a skin.
    skin: bool,
    /// Their girth, as a multiple of the average.
    girth: f32,
}

/// Returns whether bodies have a skin.
fn shows_skin(params: &Params) -> bool {
    params.choice::<choices::Look>() != choices::Look::Limbs
}

/// Returns the character that is shown in place of generated bodies.
pub(crate) fn shown_character(session: &Session) -> Option<Character> {
    session.character().filter(|_| shows_skin(session.params()))
}

/// Returns the ratio of a character's own size to that of a motion; `None` where the motion cannot
/// move it.
pub(crate) fn size_beside(character: &Character, motion: &Motion) -> Option<f32> {
    let size = character.size_beside(motion.clip().skeleton(), motion.roles())?;
    Some(size.clamp(SIZE_RANGE.0, SIZE_RANGE.1))
}

impl BodyCache {
    /// Applies the session's present look, and drops the bodies of skeletons that are gone.
    pub(crate) fn update(&mut self, session: &Session) {
        let params = session.params();
        let style =
            BodyStyle { skin: shows_skin(params), girth: params.number(Key::FigureBuild) as f32 };
        let character = shown_character(session);
        let same = match (&character, &self.character) {
            (Some(new), Some(old)) => {
                Arc::ptr_eq(&new.mesh, &old.mesh) && Arc::ptr_eq(&new.skeleton, &old.skeleton)
            }
            (new, old) => new.is_none() && old.is_none(),
        };
        if style != self.style || !same {
            self.bodies.clear();
            for skin in &mut self.skins {
                skin.mesh = None;
            }
        }
        if !same {
            self.sizes = character.iter().map(|character| (1.0, character.clone())).collect();
        }
        (self.style, self.character) = (style, character);
        self.bodies.retain(|(skeleton, ..)| skeleton.strong_count() > 0);
    }

    /// Returns the body of a motion's skeleton; generates it on first use.
    pub(crate) fn body(&mut self, motion: &Motion) -> Arc<Body> {
        let skeleton = motion.clip().skeleton();
        let known = |(known, roles, _): &&(Weak<Skeleton>, Roles, Arc<Body>)| {
            known.as_ptr() == Arc::as_ptr(skeleton) && roles == motion.roles()
        };
        if let Some((.., body)) = self.bodies.iter().find(known) {
            return Arc::clone(body);
        }
        let body = self.retargeted_character(motion);
        let body = Arc::new(body.unwrap_or_else(|| self.procedural_body(motion)));
        self.bodies.push((Arc::downgrade(skeleton), motion.roles().clone(), Arc::clone(&body)));
        body
    }

    /// Makes a body of the character, if there is one and the motion can move it. The body is
    /// scaled to the size of the motion, so that it coincides with everything else that is drawn of
    /// the motion; the world is shown smaller by the same factor.
    fn retargeted_character(&mut self, motion: &Motion) -> Option<Body> {
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
        Some(Body::retargeted(&sized, drive, skeleton, motion.roles()).of_size(size))
    }

    /// Generates a body around the bones.
    fn procedural_body(&mut self, motion: &Motion) -> Body {
        let BodyStyle { skin, girth } = self.style;
        let skeleton = motion.clip().skeleton();
        if motion.clip().is_of_points() {
            return Body::of_points(skeleton).with_girth(girth);
        }
        let reference = reference_pose(motion.clip(), motion.roles());
        let body = Body::standing(skeleton, Some(motion.roles()), &reference).with_girth(girth);
        match skin.then(|| self.skin(skeleton, motion.roles(), &reference)).flatten() {
            Some(mesh) => body.with_skin(mesh),
            None => body,
        }
    }

    /// Returns the skin of a skeleton; `None` while it is being built. The first call starts that.
    fn skin(
        &mut self,
        skeleton: &Arc<Skeleton>,
        roles: &Roles,
        reference: &WorldPose,
    ) -> Option<Arc<SkinnedMesh>> {
        let girth = self.style.girth;
        let fits = |known: &&mut CachedSkin| {
            known.roles == *roles
                && (Arc::ptr_eq(&known.skeleton, skeleton) || known.skeleton == *skeleton)
        };
        if let Some(known) = self.skins.iter_mut().find(fits) {
            let SkinState::Built(procedural_skin) = &known.state else {
                return None;
            };
            let mesh =
                known.mesh.get_or_insert_with(|| Arc::new(procedural_skin.with_girth(girth)));
            return Some(Arc::clone(mesh));
        }
        if self.skins.len() >= MAX_SKINS {
            self.skins.remove(0);
        }
        self.skins.push(CachedSkin {
            skeleton: Arc::clone(skeleton),
            roles: roles.clone(),
            state: SkinState::Building(Box::new(SkinBuilder::new(skeleton, roles, reference))),
            mesh: None,
        });
        None
    }

    /// Returns whether a skin is being built.
    pub(crate) fn is_at_work(&self) -> bool {
        self.skins.iter().any(|skin| matches!(skin.state, SkinState::Building(_)))
    }

    /// Advances the building of a skin by one step. Returns `false` when there was none to build.
    pub(crate) fn work(&mut self) -> bool {
        let building = self.skins.iter_mut().find_map(|skin| match &mut skin.state {
            SkinState::Building(skin_builder) => Some((skin_builder.advance(), &mut skin.state)),
            SkinState::Built(_) => None,
        });
        let Some((procedural_skin, state)) = building else {
            return false;
        };
        if let Some(procedural_skin) = procedural_skin {
            *state = SkinState::Built(Box::new(procedural_skin));
            // Bodies that consisted of limbs so far are made again, with the skin.
            self.bodies.clear();
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::{Director, StageOptions, Viewport};
    use segue_session::{Command, Key, Session, Value};

    /// Returns half the width of the skin's waist; `None` while the body consists of limbs.
    fn width(director: &mut Director, session: &Session) -> Option<f32> {
        let panes = [(0, Viewport::default())];
        let options = StageOptions { panes: &panes, ..StageOptions::default() };
        let stage = director.stage(session, &options, 0.0);
        let skin = stage.panes[0].figures.first()?.skin.as_ref()?;
        let waist =
            skin.mesh.positions.iter().filter(|p| (0.05..0.2).contains(&p.y) && p.x.abs() < 0.4);
        Some(waist.map(|p| p.x).fold(0.0, f32::max))
    }

    #[test]
    fn body_before_its_skin_is_built_has_limbs_and_then_takes_any_girth_at_once() {
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
