use super::dress::{Wardrobe, size_beside, worn_character};
use super::drive::add_drive;
use super::path::{PathMarks, add_drawn, add_path};
use super::{
    Body, Camera, CameraRig, Color, Layer, Lens, Look, Pane, Skinning, Stage, Viewport, with_alpha,
};
use glam::{Quat, Vec3};
use segue_motion::clip::{Interpolation, Motion};
use segue_motion::graph::Place;
use segue_motion::matching;
use segue_motion::math::Planar;
use segue_motion::skeleton::{Role, Side, WorldPose, world_pose, world_pose_into};
use segue_session::choices;
use segue_session::{
    self, Built, DistanceMap, Key, Outcome, Params, Session, Slot, Walk, joint_of,
};
use std::sync::Arc;

/// The colours of what is made from A, from B, and from both, in the theme of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colors {
    /// A's ghost and path.
    pub a: Color,
    /// B's ghost and path.
    pub b: Color,
    /// The result's path, and the ring of a planted foot.
    pub result: Color,
    /// The ring of a foot that slides.
    pub bad: Color,
    /// Where a path turns faster than the motion on it can.
    pub warning: Color,
    /// Those who play along, each with its ghost and path.
    pub others: [Color; 4],
    /// How much a ghost covers, 0 to 1.
    pub ghost_alpha: f32,
}

/// Makes the stage from the session, and keeps what goes on from frame to frame: cameras on their
/// way, and the bodies of skeletons.
#[derive(Debug)]
pub struct Director {
    stage: Arc<Stage>,
    rigs: Vec<CameraRig>,
    marks_joint: bool,
    pair: Option<[f64; 2]>,
    marks: PathMarks,
    jump: Option<[Place; 2]>,
    candidate: Option<matching::Place>,
    wardrobe: Wardrobe,
    /// How many times as large as its motion the figure is shown.
    shown_size: f32,
    /// A pose in the making.
    posed: WorldPose,
}

/// A ghost fades in before the transition and out behind it, over this long.
const GHOST_FADE_SECS: f64 = 0.3;
/// How much of a limb's colour is clay where the rest tells A and B apart.
const CLAY_SHARE: f32 = 0.3;
/// A planted foot that moves faster than this slides.
const SLIDE_MPS: f32 = 0.08;
/// The ring about the chosen joint, as a share of the distance that it is seen from: it is of one
/// size wherever the camera stands.
const MARK_RADIUS: f32 = 0.011;
/// The sources of a registered result walk this far to its left and right.
const BESIDE_METRES: f64 = 0.8;
/// The poses of a pair are more than ghosts: they are all there is.
const PAIR_ALPHA: f32 = 1.8;
/// How much of a companion's colour is on its clay.
const COMPANY_SHARE: f32 = 0.55;
/// And how much on that of one in a crowd.
const CROWD_SHARE: f32 = 0.3;
/// How much of a body is seen where its bones shine through.
const GLASS_ALPHA: f32 = 0.5;
/// Points of a path, at most. A path is as long as its clip, and no screen shows more.
const PATH_POINTS: usize = 600;
/// So much of a walk's path is drawn, behind and before it, seconds.
const WALK_PATH_SECS: f64 = 30.0;
/// A camera that nothing is followed with comes to a new view this fast.
const VIEW_HALF_LIFE_SECS: f32 = 0.06;
/// A followed character that jumped farther than this (a loop began again) is not chased but cut
/// to.
const CUT_METRES: f32 = 1.5;

impl Default for Director {
    fn default() -> Self {
        Self {
            shown_size: 1.0,
            stage: Arc::default(),
            rigs: Vec::new(),
            marks_joint: false,
            pair: None,
            marks: PathMarks::default(),
            jump: None,
            candidate: None,
            wardrobe: Wardrobe::default(),
            posed: WorldPose::default(),
        }
    }
}

impl Director {
    /// Everything that is to be seen now: the session's panes that are shown, each with its place
    /// (physical pixels). `dt_secs` moves the cameras on.
    pub fn stage(
        &mut self,
        session: &Session,
        shown: &[(usize, Viewport)],
        pixels_per_point: f32,
        look: Look,
        colors: &Colors,
        dt_secs: f32,
    ) -> Arc<Stage> {
        let params = session.params();
        let now = session.now_secs();
        let stage = Arc::make_mut(&mut self.stage);
        stage.look = look;
        stage.pixels_per_point = pixels_per_point;
        stage.panes.resize_with(shown.len(), Pane::default);
        let mut panes = std::mem::take(&mut stage.panes);
        self.rigs.resize_with(session.panes().len(), CameraRig::default);
        self.wardrobe.choose(session);
        let first = shown.iter().find_map(|&(index, _)| session.panes().get(index)?.shown_at(now));
        let size = first.map_or(1.0, |shown| self.body(&shown.outcome.motion).size());
        self.shown_size = size * figure_height(params);
        for (pane, &(index, viewport)) in panes.iter_mut().zip(shown) {
            pane.clear();
            pane.viewport = viewport;
            pane.skinning = skinning_of(session, index);
            if let Some(segue_session::Shown { outcome, secs: now, place }) =
                session.panes().get(index).and_then(|pane| pane.shown_at(now))
            {
                let Some(world) = pose_at(&outcome.motion, now, &place) else {
                    continue;
                };
                let shown = Shown { outcome, now, place, world };
                match (self.pair.zip(session.distance_map()), self.jump.zip(session.graph_built()))
                {
                    (Some((frames, map)), _) => {
                        self.draw_pair(&shown, frames, map, params, colors, pane);
                    }
                    (None, Some((ends, built))) => {
                        self.draw_jump(&shown, ends, built, colors, pane);
                    }
                    (None, None) => self.draw(&shown, params, &look, colors, pane),
                }
                self.draw_company(session, &look, colors, pane);
                add_walk_path(session, colors, pane);
                add_drawn(&self.marks, colors, pane);
                if index == 0 {
                    self.draw_crowd(session, &shown, &look, colors, pane);
                }
                let rest = resting_point(outcome, &shown.place);
                let followed = self.followed_point(&shown, session);
                self.aim(index, followed, rest, params, dt_secs, pane);
                if self.marks_joint
                    && let Some(joint) = joint_of(&outcome.motion, params.text(Key::Joint))
                    && let body = self.body(&outcome.motion)
                    && let Some(&at) =
                        body.seen_pose(&shown.world).positions.get(body.seen_joint(joint))
                {
                    add_mark(at, colors.result, look.edge, pane);
                }
            } else if let Some(refused) = session.panes().get(index) {
                self.draw_stand_ins(refused, now, colors, pane);
                if let Some(first) = refused.sources.first() {
                    let rest = resting_place(&first.motion, &first.world_from_clip);
                    self.aim(index, None, rest, params, dt_secs, pane);
                }
            }
        }
        let stage = Arc::make_mut(&mut self.stage);
        stage.panes = panes;
        stage.grid_metres = self.shown_size.recip();
        Arc::clone(&self.stage)
    }

    /// Works on what takes a while to be made, a millisecond or two: skins of skeletons that were
    /// seen. Until they are there bodies are limbs. `true` while there is more to do.
    pub fn work(&mut self) -> bool {
        self.wardrobe.work()
    }

    /// Whether something is in the making that will be seen.
    #[must_use]
    pub fn is_at_work(&self) -> bool {
        self.wardrobe.is_at_work()
    }

    /// Whether the chosen joint is marked from now on.
    pub fn mark_joint(&mut self, on: bool) {
        self.marks_joint = on;
    }

    /// The pair of frames of A and B (at A's rate) that is shown in place of the result from now
    /// on, aligned; `None` for the result itself.
    pub fn show_pair(&mut self, frames: Option<[f64; 2]>) {
        self.pair = frames;
    }

    /// The frame that is shown as a ghost where the driven character stands, from now on.
    pub fn show_candidate(&mut self, place: Option<matching::Place>) {
        self.candidate = place;
    }

    /// What the hand does with a path, from now on.
    pub fn mark_path(&mut self, marks: PathMarks) {
        self.marks = marks;
    }

    /// The transition whose windows are shown in place of the result from now on, laid on each
    /// other; `None` for the result itself.
    pub fn show_jump(&mut self, ends: Option<[Place; 2]>) {
        self.jump = ends;
    }

    /// Whether a camera is still on its way, so that another frame is needed.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.rigs.iter().any(|rig| !rig.is_still())
    }

    /// The camera of a pane, as it was drawn last.
    #[must_use]
    pub fn camera(&self, pane: usize) -> Option<&Camera> {
        self.rigs.get(pane).map(CameraRig::camera)
    }

    fn body(&mut self, motion: &Motion) -> Arc<Body> {
        self.wardrobe.body(motion)
    }

    fn draw(
        &mut self,
        shown: &Shown<'_>,
        params: &Params,
        look: &Look,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        let Shown { outcome, now, place, world } = shown;
        let (motion, now) = (&outcome.motion, *now);
        let body = self.body(motion);
        let twisted = twisted(motion, world, params.number(Key::Twist));
        let world = twisted.as_ref().unwrap_or(world);
        let seen = params.choice::<choices::Look>();
        match (seen, outcome.layer().filter(|_| params.is_on(Key::MaskColors))) {
            (choices::Look::Bones, _) => {}
            (choices::Look::Both, _) => {
                pane.add_glass(&body, world, with_alpha(look.clay, GLASS_ALPHA));
            }
            (_, Some(layer)) => pane.add_colored_body(&body, world, |joint| {
                share_color(layer.shares.get(joint).copied().unwrap_or(0.0), look, colors)
            }),
            (_, None) => pane.add_body(&body, world, look.clay),
        }
        if matches!(seen, choices::Look::Bones | choices::Look::Both) {
            add_bones(&body, motion, world, colors.result, pane);
        }
        if params.is_on(Key::Axes) {
            add_axes(&body.seen_pose(world), colors, pane);
        }
        if params.is_on(Key::Sources) {
            self.draw_sources(shown, colors, pane);
        }
        let onion = params.number(Key::Ghosts) as i32;
        for step in (-onion..=onion).filter(|&step| step != 0) {
            let at = now + f64::from(step) * params.number(Key::GhostStep);
            if (0.0..=outcome.duration_secs()).contains(&at)
                && let Some(world) = pose_at(motion, at, place)
            {
                let fade = 1.0 - (step.abs() - 1) as f32 / onion as f32;
                pane.add_ghost(
                    &body,
                    &world,
                    with_alpha(color_at(outcome, at, colors), colors.ghost_alpha * 0.7 * fade),
                );
            }
        }
        if let Some(path) = outcome.path() {
            add_path(path, &self.marks, look, colors, pane);
        } else if params.is_on(Key::Trail) {
            add_ground_path(outcome, place, now, colors, pane);
        }
        if let Some(driven) = outcome.driven() {
            if params.is_on(Key::Trail) {
                add_drive(driven, now, colors, pane);
            }
            if let (Some(candidate), Some(moment)) = (self.candidate, driven.at(now))
                && let Some(pose) = driven.database.pose(candidate, &moment.root)
            {
                let ghost = world_pose(driven.database.skeleton(), &pose);
                pane.add_ghost(
                    &body,
                    &ghost,
                    with_alpha(colors.b, (PAIR_ALPHA * colors.ghost_alpha).min(0.9)),
                );
            }
        }
        if params.is_on(Key::JointTrail)
            && let Some(joint) = joint_of(motion, params.text(Key::Joint))
        {
            add_joint_trail(shown, &body, joint, colors.result, pane);
        }
        if params.is_on(Key::Contacts) {
            add_contacts(shown, &body, colors, pane);
        }
    }

    /// Those who play along, in the middle between clay and their colour, each on its way.
    fn draw_company(&mut self, session: &Session, look: &Look, colors: &Colors, pane: &mut Pane) {
        let params = session.params();
        for (index, companion) in session.company().iter().enumerate() {
            let Ok(motion) = &companion.motion else {
                continue;
            };
            let color = colors.others[index % colors.others.len()];
            let Some(world) = pose_at(motion, session.now_secs(), &Planar::IDENTITY) else {
                continue;
            };
            let body = self.body(motion);
            if params.choice::<choices::Look>() == choices::Look::Bones {
                add_bones(&body, motion, &world, color, pane);
            } else {
                pane.add_body(&body, &world, mixed(look.clay, color, COMPANY_SHARE));
            }
            if params.is_on(Key::Trail) {
                let ways = motion
                    .ground_frames()
                    .iter()
                    .step_by(motion.ground_frames().len().div_ceil(PATH_POINTS).max(1));
                pane.add_path(
                    ways.map(|place| (place.origin().with_y(0.004), color)),
                    2.0,
                    Layer::Ground,
                );
            }
        }
    }

    /// Those who walk about the one that is driven.
    fn draw_crowd(
        &mut self,
        session: &Session,
        shown: &Shown<'_>,
        look: &Look,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        let Some((database, poses)) = session.crowd() else {
            return;
        };
        let skeleton = database.skeleton();
        if shown.outcome.motion.clip().skeleton() != skeleton {
            return;
        }
        let body = self.body(&shown.outcome.motion);
        let world = &mut self.posed;
        for (index, pose) in poses.into_iter().enumerate() {
            let color = colors.others[index % colors.others.len()];
            let moved = pose.translations.iter().copied();
            world_pose_into(skeleton, pose.root_translation, &pose.rotations, moved, world);
            if session.params().choice::<choices::Look>() == choices::Look::Bones {
                add_bones(&body, &shown.outcome.motion, world, color, pane);
            } else {
                pane.add_body(&body, world, mixed(look.clay, color, CROWD_SHARE));
            }
        }
    }

    /// A frame of A with one of B laid on it, where the result stands.
    fn draw_pair(
        &mut self,
        shown: &Shown<'_>,
        frames: [f64; 2],
        map: &DistanceMap,
        params: &Params,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        let [a, b] = map.motions();
        let secs = frames.map(|frame| frame / map.fps());
        let stands = shown.place.after(&shown.outcome.motion.standing_at(shown.now));
        let world_from_a = stands.after(&a.standing_at(secs[0]).inverse());
        let world_from_b = world_from_a.after(&map.b_on_a(frames).unwrap_or(Planar::IDENTITY));
        for (motion, secs, place, color) in
            [(a, secs[0], world_from_a, colors.a), (b, secs[1], world_from_b, colors.b)]
        {
            if let Some(world) = pose_at(motion, secs, &place) {
                let body = self.body(motion);
                pane.add_ghost(
                    &body,
                    &world,
                    with_alpha(color, (PAIR_ALPHA * colors.ghost_alpha).min(0.9)),
                );
            }
        }
        if params.is_on(Key::Trail) {
            add_ground_path(shown.outcome, &shown.place, shown.now, colors, pane);
        }
    }

    /// Both windows of a transition where the result stands: their first, middle and last frame.
    fn draw_jump(
        &mut self,
        shown: &Shown<'_>,
        [leave, enter]: [Place; 2],
        built: &Built,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        let Some(jump) =
            built.jump_of(leave, enter).and_then(|index| built.whole().jumps().get(index))
        else {
            return;
        };
        let motions = built.cast().motions();
        let (Some(a), Some(b)) = (motions.get(leave.clip), motions.get(enter.clip)) else {
            return;
        };
        let last = jump.window.saturating_sub(1);
        let stands = shown.place.after(&shown.outcome.motion.standing_at(shown.now));
        let fps = a.clip().fps();
        let secs = |frame: usize| frame as f64 / fps;
        let middle = a.standing_at(secs(leave.frame + last / 2));
        let world_from_a = stands.after(&middle.inverse());
        let world_from_b = world_from_a.after(&jump.alignment);
        for (step, clear) in [(0, 0.55), (last, 0.55), (last / 2, 1.0)] {
            for (motion, from, place, color) in [
                (a, leave.frame, &world_from_a, colors.a),
                (b, enter.frame, &world_from_b, colors.b),
            ] {
                if let Some(world) = pose_at(motion, secs(from + step), place) {
                    let body = self.body(motion);
                    pane.add_ghost(
                        &body,
                        &world,
                        with_alpha(color, (PAIR_ALPHA * clear * colors.ghost_alpha).min(0.9)),
                    );
                }
            }
        }
    }

    /// The clips that a walk is made of about a transition.
    fn draw_walk_ghosts(
        &mut self,
        shown: &Shown<'_>,
        walk: &Walk,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        for (ghost, color) in
            walk.ghosts_at(shown.now, GHOST_FADE_SECS).into_iter().zip([colors.a, colors.b])
        {
            let Some(ghost) = ghost else { continue };
            if let Some(world) =
                pose_at(ghost.motion, ghost.secs, &shown.place.after(&ghost.world_from_clip))
            {
                let body = self.body(ghost.motion);
                pane.add_ghost(
                    &body,
                    &world,
                    with_alpha(color, colors.ghost_alpha * ghost.clear as f32),
                );
            }
        }
    }

    /// Both sources beside a registered result, in the frames that it is made of.
    fn draw_beside(&mut self, shown: &Shown<'_>, visible: f32, colors: &Colors, pane: &mut Pane) {
        for source in &shown.outcome.sources {
            let (color, side) = match source.slot {
                Slot::A => (colors.a, BESIDE_METRES),
                Slot::B => (colors.b, -BESIDE_METRES),
            };
            let Some((at, place)) = shown.outcome.source_at(source, shown.now) else {
                continue;
            };
            let aside = Planar::new(0.0, side, 0.0);
            let stands = shown.outcome.motion.standing_at(shown.now);
            let beside =
                shown.place.after(&stands).after(&aside).after(&stands.inverse()).after(&place);
            if let Some(world) = pose_at(&source.motion, at, &beside) {
                let body = self.body(&source.motion);
                pane.add_ghost(&body, &world, with_alpha(color, colors.ghost_alpha * visible));
            }
        }
    }

    /// Both sources about the transition, as far as they differ from the result: A appears as its
    /// weight falls, B vanishes as its weight rises.
    fn draw_sources(&mut self, shown: &Shown<'_>, colors: &Colors, pane: &mut Pane) {
        let (outcome, now) = (shown.outcome, shown.now);
        if let Some(walk) = outcome.walk().filter(|walk| !walk.is_jump) {
            self.draw_walk_ghosts(shown, walk, colors, pane);
            return;
        }
        if outcome.registered().is_some() {
            let away = outcome.transition.map_or(0.0, |transition| {
                (transition.start_secs - now).max(now - transition.end_secs).max(0.0)
                    / GHOST_FADE_SECS
            });
            let visible = (1.0 - away).max(0.0) as f32;
            if visible > 0.02 {
                self.draw_beside(shown, visible, colors, pane);
            }
            return;
        }
        let Some(transition) = outcome.transition else {
            return;
        };
        let length = transition.end_secs - transition.start_secs;
        let inside = ((now - transition.start_secs) / length.max(1e-6)).clamp(0.0, 1.0);
        let before = ((transition.start_secs - now) / GHOST_FADE_SECS).max(0.0);
        let behind = ((now - transition.end_secs) / GHOST_FADE_SECS).max(0.0);
        for source in &outcome.sources {
            let at = now - source.starts_at_secs;
            let (color, share) = match source.slot {
                Slot::A => (colors.a, inside * (1.0 - behind)),
                Slot::B => (colors.b, (1.0 - inside) * (1.0 - before)),
            };
            // Half of the way there a ghost is as clear as it gets: only where it lies on the
            // result it must not be seen.
            let share = (2.0 * share).clamp(0.0, 1.0) as f32;
            if share < 0.02 || !(0.0..=source.motion.clip().duration_secs()).contains(&at) {
                continue;
            }
            if let Some(world) =
                pose_at(&source.motion, at, &shown.place.after(&source.world_from_clip))
            {
                let body = self.body(&source.motion);
                pane.add_ghost(&body, &world, with_alpha(color, colors.ghost_alpha * share));
            }
        }
    }

    /// The point of the figure that the camera stays with; `None` when it follows nothing.
    fn followed_point(&mut self, shown: &Shown<'_>, session: &Session) -> Option<Vec3> {
        let (params, outcome) = (session.params(), shown.outcome);
        let wanted = match params.choice::<choices::Follow>() {
            choices::Follow::Off => return None,
            choices::Follow::A => Some(Slot::A),
            choices::Follow::B => Some(Slot::B),
            choices::Follow::Result | choices::Follow::Other => None,
        };
        let source = outcome.sources.iter().find(|source| Some(source.slot) == wanted);
        let other = (params.choice::<choices::Follow>() == choices::Follow::Other).then(|| {
            let place = (params.number(Key::FollowOther) as usize).saturating_sub(1);
            session.company().get(place)?.motion.as_ref().ok()
        });
        let source_pose;
        let (motion, world) = match source {
            // Whoever is not on the stage is not followed: then it is the result.
            None => match other.flatten() {
                None => (&outcome.motion, &shown.world),
                Some(motion) => {
                    source_pose = pose_at(motion, session.now_secs(), &Planar::IDENTITY)?;
                    (motion, &source_pose)
                }
            },
            Some(source) => {
                let (at, world_from_clip) = (outcome.source_at(source, shown.now))
                    .unwrap_or((shown.now - source.starts_at_secs, source.world_from_clip));
                source_pose = pose_at(&source.motion, at, &shown.place.after(&world_from_clip))?;
                (&source.motion, &source_pose)
            }
        };
        let body = self.body(motion);
        let joint = joint_of(motion, params.text(Key::FollowJoint)).unwrap_or(0);
        let point = *body.seen_pose(world).positions.get(body.seen_joint(joint))?;
        let hips = motion.roles().get(Role::Hips).unwrap_or(0);
        // Bobbing with every step makes an audience seasick: hips are followed over the ground, at
        // the height of a standing body's middle.
        Some(if joint == hips { point.with_y(middle_height(motion)) } else { point })
    }

    /// The clips that a result could not be made of, in its place.
    fn draw_stand_ins(
        &mut self,
        refused: &segue_session::Pane,
        now: f64,
        colors: &Colors,
        pane: &mut Pane,
    ) {
        for source in &refused.sources {
            let color = match source.slot {
                Slot::A => colors.a,
                Slot::B => colors.b,
            };
            let at = now.min(source.motion.clip().duration_secs());
            if let Some(world) = pose_at(&source.motion, at, &source.world_from_clip) {
                let body = self.body(&source.motion);
                pane.add_ghost(&body, &world, with_alpha(color, colors.ghost_alpha));
            }
        }
    }

    /// Brings the pane's camera to where the parameters want it: after the followed point, or to
    /// where it rests.
    fn aim(
        &mut self,
        index: usize,
        followed: Option<Vec3>,
        rest: Vec3,
        params: &Params,
        dt_secs: f32,
        pane: &mut Pane,
    ) {
        let pan = Vec3::new(
            params.number(Key::PanX) as f32,
            params.number(Key::PanY) as f32,
            params.number(Key::PanZ) as f32,
        ) / self.shown_size;
        let goal =
            Camera { target: followed.unwrap_or(rest) + pan, ..camera_of(params, self.shown_size) };
        let Some(rig) = self.rigs.get_mut(index) else {
            return;
        };
        let first = *rig == CameraRig::default();
        if self.marks.is_held && !first {
            // The ground must not move under the hand.
            pane.camera = *rig.camera();
            pane.focus = rig.goal.target.with_y(0.0);
            return;
        }
        let cut = goal.target.distance(rig.goal.target) > CUT_METRES;
        rig.goal = goal;
        if first || cut {
            rig.jump();
        } else {
            let half_life = if followed.is_some() {
                params.number(Key::FollowHalfLife) as f32
            } else {
                VIEW_HALF_LIFE_SECS
            };
            // The hand turns and zooms at once; only what the camera follows is smoothed.
            rig.update(half_life, dt_secs);
            rig.turn_at_once();
        }
        pane.camera = *rig.camera();
        pane.focus = goal.target.with_y(0.0);
    }
}

/// A result as it is shown now.
struct Shown<'a> {
    outcome: &'a Outcome,
    /// The time in its motion, seconds.
    now: f64,
    /// Where the motion lies in the world.
    place: Planar,
    /// The pose.
    world: WorldPose,
}

/// The pose of a motion at a time, in the world that the motion lies in.
#[must_use]
pub fn pose_at(motion: &Motion, secs: f64, world_from_clip: &Planar) -> Option<WorldPose> {
    let pose = motion.clip().sample(secs, Interpolation::Linear)?;
    let mut world = world_pose(motion.clip().skeleton(), &pose);
    if *world_from_clip != Planar::IDENTITY {
        world.apply(world_from_clip);
    }
    Some(world)
}

/// Returns how many times as large as its motion a figure is shown: by the height that the
/// parameters give it, and by its own size where it is a character.
///
/// The figure is drawn in the size and the place of its motion. It is the world about it that is
/// shown smaller: the camera stands nearer and the cells of the grid are narrower. So its steps,
/// its path and all that is drawn along with it grow as it does, and what stands still keeps
/// standing still: foot skate is neither made nor hidden.
#[must_use]
pub fn shown_size(session: &Session, motion: &Motion) -> f32 {
    let character = worn_character(session).and_then(|character| size_beside(&character, motion));
    character.unwrap_or(1.0) * figure_height(session.params())
}

/// How many times as high as by itself the parameters show a figure.
fn figure_height(params: &Params) -> f32 {
    (params.number(Key::FigureHeight) as f32).max(0.1)
}

/// The pane's own way of skinning where it is compared, else that of all.
fn skinning_of(session: &Session, pane: usize) -> Skinning {
    let compared = session.panes().get(pane).and_then(|pane| match &pane.variant {
        Some((Key::Skinning, value)) => value.choice(),
        _ => None,
    });
    match compared.unwrap_or(session.params().choice()) {
        choices::Skinning::Linear => Skinning::Linear,
        choices::Skinning::Dual => Skinning::Dual,
    }
}

/// The pose with both hands turned about their forearms, by degrees; `None` where they are not to
/// be.
fn twisted(motion: &Motion, world: &WorldPose, degrees: f64) -> Option<WorldPose> {
    let (skeleton, mut world) =
        (motion.clip().skeleton(), (degrees != 0.0).then(|| world.clone())?);
    for side in Side::BOTH {
        let (Some(elbow), Some(hand)) =
            (motion.roles().get(Role::forearm(side)), motion.roles().get(Role::hand(side)))
        else {
            continue;
        };
        let (Some(&from), Some(&wrist)) = (world.positions.get(elbow), world.positions.get(hand))
        else {
            continue;
        };
        let Some(axis) = (wrist - from).try_normalize() else {
            continue;
        };
        let turn = Quat::from_axis_angle(axis, degrees.to_radians() as f32);
        // The hand and all that hangs on it: parents come first.
        let mut moved = vec![false; skeleton.len()];
        for joint in hand..skeleton.len() {
            moved[joint] =
                joint == hand || skeleton.parent(joint).is_some_and(|parent| moved[parent]);
            if moved[joint]
                && let (Some(position), Some(rotation)) =
                    (world.positions.get_mut(joint), world.rotations.get_mut(joint))
            {
                *position = wrist + turn * (*position - wrist);
                *rotation = turn * *rotation;
            }
        }
    }
    Some(world)
}

/// The camera that the parameters describe, wherever what it follows may be, about a figure that is
/// shown so many times as large as its motion (see [`shown_size`]).
#[must_use]
pub fn camera_of(params: &Params, shown_size: f32) -> Camera {
    let from_above = params.choice::<choices::Camera>() == choices::Camera::Top;
    Camera {
        yaw: params.number(Key::CameraYaw).to_radians() as f32,
        pitch: if from_above {
            std::f32::consts::FRAC_PI_2
        } else {
            params.number(Key::CameraPitch).to_radians() as f32
        },
        distance: params.number(Key::CameraDistance) as f32 / shown_size,
        lens: if from_above { Lens::Orthographic } else { Lens::Perspective },
        ..Camera::default()
    }
}

/// What an unbound camera looks at: where the motion begins, which lies at `place`. Of a motion on
/// an edited path it is where that began before: the ground must not move when the path does.
#[must_use]
pub fn resting_point(outcome: &Outcome, place: &Planar) -> Vec3 {
    let motion = outcome.path().map_or(&outcome.motion, |path| path.fitted.motion());
    resting_place(motion, place).with_y(middle_height(&outcome.motion))
}

/// Where a motion begins, at the height of the middle of the body.
fn resting_place(motion: &Motion, place: &Planar) -> Vec3 {
    let start = motion.ground_frames().first().map_or(Vec3::ZERO, Planar::origin);
    place.apply(start).with_y(middle_height(motion))
}

/// The height in the middle of the picture: a little below the body's own, because the panes'
/// numbers lie over the lower edge.
fn middle_height(motion: &Motion) -> f32 {
    motion.roles().body_height(motion.clip().skeleton()) * 0.4
}

/// A's colour where nothing of B is, B's where all is, softened by the clay of the body.
fn share_color(share: f32, look: &Look, colors: &Colors) -> Color {
    mixed(mixed(colors.a, colors.b, share), look.clay, CLAY_SHARE)
}

/// An opaque colour between two.
fn mixed(from: Color, to: Color, share: f32) -> Color {
    let between = |channel: usize| from[channel] + (to[channel] - from[channel]) * share;
    [between(0), between(1), between(2), 1.0]
}

/// Warm where A plays, cool where B does, the accent between them and where there is no transition.
fn color_at(outcome: &Outcome, secs: f64, colors: &Colors) -> Color {
    match outcome.transition {
        Some(transition) if secs < transition.start_secs => colors.a,
        Some(transition) if secs > transition.end_secs => colors.b,
        _ => colors.result,
    }
}

fn add_ground_path(outcome: &Outcome, at: &Planar, now: f64, colors: &Colors, pane: &mut Pane) {
    let frames = outcome.motion.ground_frames();
    let fps = outcome.motion.clip().fps();
    // Of a long walk what lies about the present.
    let near = match outcome.walk() {
        Some(walk) if !walk.is_jump && walk.followed.is_none() => {
            let frame = |secs: f64| ((secs.max(0.0) * fps) as usize).min(frames.len());
            frame(now - WALK_PATH_SECS)..frame(now + WALK_PATH_SECS)
        }
        _ => 0..frames.len(),
    };
    let stride = near.len().div_ceil(PATH_POINTS).max(1);
    let points = near.step_by(stride).filter_map(|frame| {
        let secs = frame as f64 / fps;
        let mut color = color_at(outcome, secs, colors);
        // What is to come is fainter than what was walked.
        color[3] *= if outcome.walk().is_some() && secs > now { 0.45 } else { 1.0 };
        Some((at.apply(frames.get(frame)?.origin()).with_y(0.004), color))
    });
    pane.add_path(points, 2.0, Layer::Ground);
}

/// The line that a walk follows.
fn add_walk_path(session: &Session, colors: &Colors, pane: &mut Pane) {
    let points = session.graph_path().into_iter();
    let points = points.map(|point| Vec3::new(point.x as f32, 0.006, point.y as f32));
    pane.add_dashed_path(points, colors.b, 0.12, 2.5, Layer::Ground);
}

fn add_joint_trail(shown: &Shown<'_>, body: &Body, joint: usize, color: Color, pane: &mut Pane) {
    /// How much of the way is shown, before and after the present.
    const REACH_SECS: f64 = 1.0;
    const STEPS: i32 = 60;
    let motion = &shown.outcome.motion;
    let joint = body.seen_joint(joint);
    let points = (-STEPS..=STEPS).filter_map(|step| {
        let part = f64::from(step) / f64::from(STEPS);
        let at = shown.now + part * REACH_SECS;
        let inside = (0.0..=motion.clip().duration_secs()).contains(&at);
        let world = inside.then(|| pose_at(motion, at, &shown.place)).flatten()?;
        let position = *body.seen_pose(&world).positions.get(joint)?;
        Some((position, with_alpha(color, 1.0 - 0.85 * part.abs() as f32)))
    });
    pane.add_path(points, 1.75, Layer::Space);
}

/// A dot in a ring over everything, turned to the camera, both with an edge that sets them off from
/// the body.
fn add_mark(at: Vec3, color: Color, edge: Color, pane: &mut Pane) {
    const CORNERS: u16 = 28;
    let [right, up, _] = pane.camera.axes();
    let seen_from = match pane.camera.lens {
        Lens::Perspective => (at - pane.camera.eye()).length(),
        Lens::Orthographic => pane.camera.distance,
    };
    let radius = MARK_RADIUS * seen_from;
    let corner = |index: u16| {
        let angle = std::f32::consts::TAU * f32::from(index) / f32::from(CORNERS);
        at + (right * angle.cos() + up * angle.sin()) * radius
    };
    for (color, wider) in [(edge, 1.5), (color, 0.0)] {
        // The dot is a line so short that only its round ends are seen.
        pane.add_line(at, at + right * (radius * 1e-3), color, 4.5 + wider, Layer::Over);
        pane.add_path((0..=CORNERS).map(|index| (corner(index), color)), 2.0 + wider, Layer::Over);
    }
}

/// The bones of the figure that a pose of `motion` moves.
fn add_bones(body: &Body, motion: &Motion, world: &WorldPose, color: Color, pane: &mut Pane) {
    let (skeleton, _) = body.seen((motion.clip().skeleton(), motion.roles()));
    let world = body.seen_pose(world);
    for (index, joint) in skeleton.joints().iter().enumerate() {
        if let Some(parent) = joint.parent {
            pane.add_line(world.positions[parent], world.positions[index], color, 2.0, Layer::Over);
        }
        if let Some(end) = joint.end_site {
            pane.add_line(
                world.positions[index],
                world.point(index, end),
                with_alpha(color, 0.6),
                2.0,
                Layer::Over,
            );
        }
    }
}

fn add_axes(world: &WorldPose, colors: &Colors, pane: &mut Pane) {
    const LENGTH_M: f32 = 0.07;
    for (&position, &rotation) in world.positions.iter().zip(&world.rotations) {
        for (axis, color) in [(Vec3::X, colors.bad), (Vec3::Y, colors.result), (Vec3::Z, colors.b)]
        {
            pane.add_line(position, position + rotation * axis * LENGTH_M, color, 1.5, Layer::Over);
        }
    }
}

/// A ring under each planted foot of the figure, red where it slides.
fn add_contacts(shown: &Shown<'_>, body: &Body, colors: &Colors, pane: &mut Pane) {
    let (motion, now) = (&shown.outcome.motion, shown.now);
    let frame = segue_session::frame_at(motion, now);
    let dt = motion.clip().dt_secs();
    if !Side::BOTH.iter().any(|&side| motion.contacts().planted(side, frame)) {
        return;
    }
    let (_, roles) = body.seen((motion.clip().skeleton(), motion.roles()));
    let world = body.seen_pose(&shown.world);
    let earlier = pose_at(motion, now - f64::from(dt), &shown.place);
    let earlier = earlier.as_ref().map(|earlier| body.seen_pose(earlier));
    for side in Side::BOTH {
        if !motion.contacts().planted(side, frame) {
            continue;
        }
        let Some(foot) = roles.get(Role::foot(side)) else {
            continue;
        };
        let joint = roles.get(Role::toe(side)).unwrap_or(foot);
        let (Some(&toe), Some(&ankle)) = (world.positions.get(joint), world.positions.get(foot))
        else {
            continue;
        };
        let before =
            earlier.as_ref().and_then(|world| world.positions.get(joint).copied()).unwrap_or(toe);
        let slides = (toe - before).with_y(0.0).length() / dt > SLIDE_MPS;
        let middle = toe.lerp(ankle, 0.35).with_y(0.0);
        pane.add_contact(middle, if slides { colors.bad } else { colors.result }, slides);
    }
}
