//! The orbit camera.

use crate::Bounds;
use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// The projection of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Lens {
    /// Distant objects appear smaller.
    #[default]
    Perspective,
    /// Apparent size does not depend on depth, so that distances on the ground can be measured in
    /// the picture.
    Orthographic,
}

/// A half-line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Its origin, metres.
    pub origin: Vec3,
    /// Its direction, unit length.
    pub direction: Vec3,
}

impl Ray {
    /// Returns the intersection of the ray with the ground plane `y = 0`; `None` for a ray that is
    /// level, points away from the ground, or meets it more than 10 km away.
    #[must_use]
    pub fn ground_hit(&self) -> Option<Vec3> {
        let t = -self.origin.y / self.direction.y;
        (t.is_finite() && (0.0..10_000.0).contains(&t))
            .then(|| (self.origin + self.direction * t).with_y(0.0))
    }
}

/// An orbit camera, described by its target, direction and distance.
///
/// At yaw 0 it is on the +Z side of its target, in front of a character that faces +Z. Positive yaw
/// moves it to the left of that character, positive pitch upwards; at a pitch of π/2 it looks
/// straight down, with the far side at the top of the picture.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// The point in the centre of the picture, metres.
    pub target: Vec3,
    /// Direction from the target to the camera about +Y, radians.
    pub yaw: f32,
    /// Elevation of the camera above its target, radians in `[-π/2, π/2]`.
    pub pitch: f32,
    /// Distance from the target, metres.
    pub distance: f32,
    /// Vertical field of view, radians. An orthographic picture shows the same height as a
    /// perspective one at the target.
    pub fov_y: f32,
    /// The projection.
    pub lens: Lens,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            target: Vec3::new(0.0, 0.9, 0.0),
            yaw: 0.9,
            pitch: 0.16,
            distance: 4.2,
            fov_y: 0.56,
            lens: Lens::Perspective,
        }
    }
}

/// The range of the distance from the target, metres.
const DISTANCES: std::ops::RangeInclusive<f32> = 0.2..=300.0;
/// The lowest pitch that [`Camera::orbit`] reaches: a little below the horizon, so that soles are
/// visible.
const MIN_PITCH: f32 = -0.12;

impl Camera {
    /// Returns the camera's axes: right, up, and back (from the target to the camera). They are
    /// orthonormal, also when it looks straight down.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        let right = Vec3::new(cos_yaw, 0.0, -sin_yaw);
        let back = Vec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
        [right, back.cross(right), back]
    }

    /// Returns the position of the camera.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.target + self.axes()[2] * self.distance
    }

    /// Returns `view_from_world`: right-handed, Y up, with the camera looking along -Z.
    #[must_use]
    pub fn view(&self) -> Mat4 {
        let [_, up, back] = self.axes();
        look_to_mat4(self.eye(), -back, up)
    }

    /// Returns half the height of the picture at the target's depth, metres.
    #[must_use]
    pub fn half_height(&self) -> f32 {
        self.distance * (self.fov_y * 0.5).tan()
    }

    /// Returns the nearest and farthest depth that is drawn, metres.
    #[must_use]
    pub fn depth_range(&self) -> [f32; 2] {
        match self.lens {
            Lens::Perspective => [(self.distance * 0.02).clamp(0.01, 0.4), self.distance + 400.0],
            Lens::Orthographic => [self.distance - 400.0, self.distance + 400.0],
        }
    }

    /// Returns `clip_from_view` for a picture with the aspect ratio `aspect` (width over height);
    /// depths are from 0 to 1.
    #[must_use]
    pub fn projection(&self, aspect: f32) -> Mat4 {
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let [near, far] = self.depth_range();
        match self.lens {
            Lens::Perspective => directx::perspective(self.fov_y, aspect, near, far),
            Lens::Orthographic => {
                let half = self.half_height();
                directx::orthographic(-half * aspect, half * aspect, -half, half, near, far)
            }
        }
    }

    /// Orbits around the target. The pitch stays between a little below the horizon and straight
    /// down.
    pub fn orbit(&mut self, yaw_radians: f32, pitch_radians: f32) {
        self.yaw = (self.yaw + yaw_radians + PI).rem_euclid(2.0 * PI) - PI;
        self.pitch = (self.pitch + pitch_radians).clamp(MIN_PITCH.min(self.pitch), FRAC_PI_2);
    }

    /// Moves the camera for a drag by `delta` pixels (right, down) in a viewport `height` pixels
    /// high: points at the target's depth stay under the pointer.
    pub fn pan(&mut self, delta: Vec2, height: f32) {
        let [right, up, _] = self.axes();
        let metres_per_pixel = 2.0 * self.half_height() / height.max(1.0);
        self.target += (up * delta.y - right * delta.x) * metres_per_pixel;
    }

    /// Divides the distance by `factor`; a factor above 1 moves the camera closer.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            self.distance = (self.distance / factor).clamp(*DISTANCES.start(), *DISTANCES.end());
        }
    }

    /// Changes to an orthographic view from above of the same place at the same scale.
    pub fn look_from_top(&mut self) {
        self.pitch = FRAC_PI_2;
        self.lens = Lens::Orthographic;
    }

    /// Moves the camera without turning it so that the whole box is visible, with a margin of 6 %.
    /// Does nothing for an empty box.
    pub fn frame(&mut self, bounds: &Bounds, aspect: f32) {
        if bounds.is_empty() {
            return;
        }
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let tangent = (self.fov_y * 0.5).tan() / 1.06;
        let center = bounds.center();
        let [right, up, back] = self.axes();
        let distance = bounds.corners().map(|corner| {
            let offset = corner - center;
            let across = (offset.dot(right).abs() / aspect).max(offset.dot(up).abs());
            let in_front = if self.lens == Lens::Perspective { offset.dot(back) } else { 0.0 };
            in_front + across / tangent
        });
        self.target = center;
        self.distance =
            distance.into_iter().fold(0.0, f32::max).clamp(*DISTANCES.start(), *DISTANCES.end());
    }

    /// Returns the ray through a pixel (from the top left corner) of a viewport of the given size.
    #[must_use]
    pub fn ray(&self, pixel: Vec2, viewport: Vec2) -> Ray {
        let [right, up, back] = self.axes();
        let viewport = viewport.max(Vec2::ONE);
        let ndc = pixel / viewport * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        let aspect = viewport.x / viewport.y;
        match self.lens {
            Lens::Perspective => {
                let tangent = (self.fov_y * 0.5).tan();
                let direction = right * (ndc.x * tangent * aspect) + up * (ndc.y * tangent) - back;
                Ray { origin: self.eye(), direction: direction.normalize_or(-back) }
            }
            Lens::Orthographic => {
                let half = self.half_height();
                Ray {
                    origin: self.eye() + right * (ndc.x * half * aspect) + up * (ndc.y * half),
                    direction: -back,
                }
            }
        }
    }

    /// Returns the pixel (from the top left corner) at which a point is drawn; `None` for a point
    /// behind the camera.
    #[must_use]
    pub fn project(&self, point: Vec3, viewport: Vec2) -> Option<Vec2> {
        let clip =
            self.projection(viewport.x / viewport.y.max(1.0)) * (self.view() * point.extend(1.0));
        let ndc = Vec2::new(clip.x, clip.y) / clip.w;
        (clip.w > 0.0 && ndc.is_finite()).then(|| (ndc * Vec2::new(0.5, -0.5) + 0.5) * viewport)
    }

    /// Returns the number of pixels per metre at `point` in a viewport `height` pixels high; 0
    /// behind the camera.
    #[must_use]
    pub fn pixels_per_metre(&self, point: Vec3, height: f32) -> f32 {
        let depth = match self.lens {
            Lens::Orthographic => self.distance,
            Lens::Perspective => (self.eye() - point).dot(self.axes()[2]),
        };
        if depth > 1e-3 { height * 0.5 / (depth * (self.fov_y * 0.5).tan()) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const VIEWPORT: Vec2 = Vec2::new(640.0, 480.0);

    fn camera() -> impl Strategy<Value = Camera> {
        (-3.0f32..3.0, -0.1f32..1.57, 0.5f32..20.0, any::<bool>()).prop_map(
            |(yaw, pitch, distance, perspective)| Camera {
                target: Vec3::new(1.0, 0.8, -2.0),
                yaw,
                pitch,
                distance,
                fov_y: 0.6,
                lens: if perspective { Lens::Perspective } else { Lens::Orthographic },
            },
        )
    }

    proptest! {
        #[test]
        fn ray_through_a_pixel_projects_back_to_it(
            camera in camera(),
            x in 5.0f32..635.0,
            y in 5.0f32..475.0,
            depth in 0.7f32..9.0,
        ) {
            let pixel = Vec2::new(x, y);
            let ray = camera.ray(pixel, VIEWPORT);
            let back = camera.project(ray.origin + ray.direction * depth, VIEWPORT).unwrap();
            prop_assert!((back - pixel).length() < 0.1, "{back} is not {pixel}");
        }

        #[test]
        fn framing_of_a_box_shows_all_corners_with_a_small_margin(
            camera in camera(),
            w in 0.1f32..6.0,
            h in 0.1f32..3.0,
        ) {
            let mut camera = camera;
            let bounds = Bounds { min: Vec3::new(-w, 0.0, -1.0), max: Vec3::new(w, h, 1.0) };
            camera.frame(&bounds, VIEWPORT.x / VIEWPORT.y);
            let ndc = bounds.corners().map(|c| {
                (camera.project(c, VIEWPORT).unwrap() / VIEWPORT * 2.0 - 1.0).abs().max_element()
            });
            let largest = ndc.into_iter().fold(0.0, f32::max);
            prop_assert!((0.9..=0.95).contains(&largest), "{largest}");
        }

        #[test]
        fn panning_keeps_the_point_under_the_pointer(
            camera in camera(),
            x in 5.0f32..635.0,
            y in 5.0f32..475.0,
        ) {
            let at = Vec2::new(x, y);
            let on_target_plane = |camera: &Camera| {
                let ray = camera.ray(at, VIEWPORT);
                let back = camera.axes()[2];
                ray.origin
                    + ray.direction
                        * ((camera.target - ray.origin).dot(back) / ray.direction.dot(back))
            };
            let held = on_target_plane(&camera);
            let mut panned = camera;
            panned.pan(Vec2::new(30.0, -20.0), VIEWPORT.y);
            prop_assert!(
                (panned.project(held, VIEWPORT).unwrap() - at - Vec2::new(30.0, -20.0)).length()
                    < 0.2
            );
        }
    }

    #[test]
    fn camera_at_yaw_zero_shows_the_face_with_its_left_on_the_right() {
        let camera = Camera { target: Vec3::Y, yaw: 0.0, pitch: 0.0, ..Camera::default() };
        assert!(camera.eye().z > 1.0);
        let left_hand = camera.project(Vec3::new(0.5, 1.0, 0.0), VIEWPORT).unwrap();
        assert!(left_hand.x > 321.0 && (left_hand.y - 240.0).abs() < 0.01, "{left_hand}");
        let head = camera.project(Vec3::new(0.0, 1.7, 0.0), VIEWPORT).unwrap();
        assert!(head.y < 200.0);
    }

    #[test]
    fn ray_of_the_top_view_hits_the_ground_below_the_pixel() {
        let mut camera = Camera { yaw: 0.0, ..Camera::default() };
        camera.look_from_top();
        let hit = camera.ray(Vec2::new(480.0, 240.0), VIEWPORT).ground_hit().unwrap();
        let metres_per_pixel = 2.0 * camera.half_height() / VIEWPORT.y;
        assert!((hit - Vec3::new(160.0 * metres_per_pixel, 0.0, 0.0)).length() < 1e-3, "{hit}");
        assert!((camera.pixels_per_metre(hit, VIEWPORT.y) * metres_per_pixel - 1.0).abs() < 1e-5);
    }

    #[test]
    fn ray_that_rises_misses_the_ground() {
        assert_eq!(Ray { origin: Vec3::Y, direction: Vec3::Y }.ground_hit(), None);
        assert_eq!(Ray { origin: Vec3::Y, direction: Vec3::X }.ground_hit(), None);
    }
}
