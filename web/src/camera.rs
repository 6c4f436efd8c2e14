//! The camera: orbits the actor, follows it gently, and never fights the hand.

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// Vertical field of view in radians: 35 degrees.
pub const FIELD_OF_VIEW: f32 = 0.610_865;
/// Part of the picture's height that the actor fills.
const FILL: f32 = 0.66;
/// Three-quarter view: radians from the actor's front (+Z) towards its left.
const YAW: f32 = 0.6;
/// The eye's height over the middle of the actor, in actor heights.
const EYE: f32 = 0.40;
/// Natural frequency, per second, with which the camera follows.
const FOLLOW: f32 = 6.0;
/// How fast it eases to where the hand wants it, per second.
const EASE: f32 = 16.0;
/// Lowest and highest elevation in radians.
const ELEVATION: [f32; 2] = [0.02, 1.48];

/// What a picture is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Projection times view.
    pub clip_from_world: Mat4,
    /// The eye, metres.
    pub eye: Vec3,
    /// The point looked at, metres.
    pub target: Vec3,
}

/// What the camera frames: where the actor stands and how large it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// Its centre on the ground (X, Z), metres.
    pub ground: Vec2,
    /// Height of the ground, metres.
    pub floor: f32,
    /// Its height above the ground, metres.
    pub height: f32,
    /// Its width as seen from any side, metres.
    pub width: f32,
}

/// Where the camera is around its subject.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Orbit {
    yaw: f32,
    elevation: f32,
    /// In distances at which the subject fills the picture as it should.
    distance: f32,
    /// Moved away from the subject, metres.
    pan: Vec3,
}

impl Orbit {
    const HOME: Self = Self { yaw: YAW, elevation: 0.16, distance: 1.0, pan: Vec3::ZERO };

    fn eased(self, goal: Self, part: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * part;
        Self {
            yaw: mix(self.yaw, goal.yaw),
            elevation: mix(self.elevation, goal.elevation),
            distance: mix(self.distance, goal.distance),
            pan: self.pan.lerp(goal.pan, part),
        }
    }

    fn near(self, other: Self) -> bool {
        (self.yaw - other.yaw).abs() < 2e-4
            && (self.elevation - other.elevation).abs() < 2e-4
            && (self.distance / other.distance - 1.0).abs() < 2e-4
            && self.pan.distance(other.pan) < 2e-4
    }
}

/// An orbit camera around a subject that moves.
#[derive(Clone, Debug)]
pub struct Camera {
    subject: Subject,
    followed: Vec2,
    velocity: Vec2,
    orbit: Orbit,
    goal: Orbit,
    /// The view that [`Self::recentre`] goes back to.
    home: Orbit,
    /// Without easing: where the reader asked for reduced motion.
    pub instant: bool,
    aspect: f32,
}

impl Camera {
    /// A three-quarter view of `subject` from eye height.
    #[must_use]
    pub fn new(subject: Subject) -> Self {
        let elevation = (EYE * FILL * 2.0 * (FIELD_OF_VIEW / 2.0).tan()).atan();
        let orbit = Orbit { elevation, ..Orbit::HOME };
        Self {
            subject,
            followed: subject.ground,
            velocity: Vec2::ZERO,
            orbit,
            goal: orbit,
            home: orbit,
            instant: false,
            aspect: 1.6,
        }
    }

    /// The picture's width over its height.
    pub fn set_aspect(&mut self, aspect: f32) {
        if aspect.is_finite() && aspect > 0.0 {
            self.aspect = aspect;
        }
    }

    /// The subject now stands at `ground` (X, Z).
    pub fn follow(&mut self, ground: Vec2) {
        if ground.is_finite() {
            self.subject.ground = ground;
        }
    }

    /// Turns by `dx`, `dy` of the picture's height; to the right turns the subject to the right.
    pub fn orbit(&mut self, dx: f32, dy: f32) {
        if (dx + dy).is_finite() {
            self.goal.yaw -= dx * 3.2;
            self.goal.elevation = (self.goal.elevation + dy * 3.2).clamp(ELEVATION[0], ELEVATION[1]);
        }
    }

    /// Moves by `dx`, `dy` of the picture's height; what is under the pointer stays under it.
    pub fn pan(&mut self, dx: f32, dy: f32) {
        if !(dx + dy).is_finite() {
            return;
        }
        let back = direction(self.goal);
        let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
        let up = back.cross(right);
        let metres = self.distance(self.goal) * 2.0 * (FIELD_OF_VIEW / 2.0).tan();
        let pan = self.goal.pan + (up * dy - right * dx) * metres;
        let middle = self.subject.height / 2.0;
        let far = self.subject.height * 6.0;
        // The point looked at stays above the ground and the actor within reach.
        self.goal.pan = pan.clamp(Vec3::new(-far, -middle, -far), Vec3::new(far, far, far));
    }

    /// Comes `factor` times closer.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            self.goal.distance = (self.goal.distance / factor).clamp(0.2, 6.0);
        }
    }

    /// Goes back to the view that it began with.
    pub fn recentre(&mut self) {
        self.look_from(self.home.yaw, self.home.elevation, self.home.distance);
    }

    /// Turns to `yaw` and `elevation`, radians, at `distance` times the one from which all of the actor is seen; the
    /// shorter way round, and unpanned.
    pub fn look_from(&mut self, yaw: f32, elevation: f32, distance: f32) {
        if !(yaw + elevation + distance).is_finite() || distance <= 0.0 {
            return;
        }
        let turns = ((self.goal.yaw - yaw) / std::f32::consts::TAU).round() * std::f32::consts::TAU;
        self.goal = Orbit {
            yaw: yaw + turns,
            elevation: elevation.clamp(ELEVATION[0], ELEVATION[1]),
            distance: distance.clamp(0.2, 6.0),
            pan: Vec3::ZERO,
        };
    }

    /// Makes this the view that [`Self::recentre`] goes back to; measures as of [`Self::look_from`].
    pub fn set_home(&mut self, yaw: f32, elevation: f32, distance: f32) {
        if (yaw + elevation + distance).is_finite() && distance > 0.0 {
            self.home = Orbit { yaw, elevation, distance, pan: Vec3::ZERO };
        }
    }

    /// Yaw, elevation and distance that it is at or on its way to.
    #[must_use]
    pub fn goal(&self) -> [f32; 3] {
        [self.goal.yaw, self.goal.elevation, self.goal.distance]
    }

    /// Eases by `seconds`. True while it still moves.
    pub fn step(&mut self, seconds: f32) -> bool {
        let seconds = seconds.clamp(0.0, 0.5);
        let orbit_moves = self.orbit != self.goal;
        if orbit_moves {
            let part = if self.instant { 1.0 } else { 1.0 - (-EASE * seconds).exp() };
            self.orbit = self.orbit.eased(self.goal, part);
            if self.orbit.near(self.goal) {
                self.orbit = self.goal;
            }
        }
        orbit_moves | self.step_follow(seconds)
    }

    /// A critically damped spring from where the camera is to where the subject is, stepped exactly.
    fn step_follow(&mut self, seconds: f32) -> bool {
        let gap = self.followed - self.subject.ground;
        if gap.length() < 1e-3 && self.velocity.length() < 1e-3 {
            return false;
        }
        let decay = (-FOLLOW * seconds).exp();
        let pull = self.velocity + gap * FOLLOW;
        self.followed = self.subject.ground + (gap + pull * seconds) * decay;
        self.velocity = (self.velocity - pull * (FOLLOW * seconds)) * decay;
        true
    }

    /// Whether [`Self::step`] would move it.
    #[must_use]
    pub fn moving(&self) -> bool {
        self.orbit != self.goal
            || (self.followed - self.subject.ground).length() >= 1e-3
            || self.velocity.length() >= 1e-3
    }

    /// What it sees.
    #[must_use]
    pub fn view(&self) -> View {
        let middle = self.subject.floor + self.subject.height / 2.0;
        let target = Vec3::new(self.followed.x, middle, self.followed.y) + self.orbit.pan;
        let distance = self.distance(self.orbit);
        let mut eye = target + direction(self.orbit) * distance;
        eye.y = eye.y.max(self.subject.floor + self.subject.height * 0.05);
        let view = look_at_mat4(eye, target, Vec3::Y);
        let (near, far) = (distance * 0.02, distance * 4.0 + self.subject.height * 40.0);
        View { clip_from_world: perspective(FIELD_OF_VIEW, self.aspect, near, far) * view, eye, target }
    }

    fn distance(&self, orbit: Orbit) -> f32 {
        let half = (FIELD_OF_VIEW / 2.0).tan();
        let high = self.subject.height / FILL / 2.0 / half;
        // Upright phones: the width decides.
        let wide = self.subject.width / 0.9 / 2.0 / (half * self.aspect);
        high.max(wide) * orbit.distance
    }
}

/// From the target to the eye, of length 1.
fn direction(orbit: Orbit) -> Vec3 {
    let (sin_yaw, cos_yaw) = orbit.yaw.sin_cos();
    let (sin, cos) = orbit.elevation.sin_cos();
    Vec3::new(sin_yaw * cos, sin, cos_yaw * cos)
}

impl View {
    /// Where `point` is in the picture: x and y from 0 to 1, from the top left corner; `None` behind the eye.
    #[must_use]
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let clip = self.clip_from_world * point.extend(1.0);
        (clip.w > 1e-6).then(|| Vec2::new(clip.x / clip.w * 0.5 + 0.5, 0.5 - clip.y / clip.w * 0.5))
    }

    /// Where the ground at `height` is seen at the point `at` of the picture (X, Z); `None` at and above the horizon,
    /// and farther away than `reach` metres.
    #[must_use]
    pub fn ground_at(&self, at: Vec2, height: f32, reach: f32) -> Option<Vec2> {
        let ray = self.ray(at);
        let distance = (height - self.eye.y) / ray.y;
        let point = self.eye + ray * distance;
        (ray.y < 0.0 && distance > 0.0 && distance < reach).then_some(Vec2::new(point.x, point.z))
    }

    /// The direction, of length 1, in which the point `at` of the picture (0 to 1, from the top left) is seen.
    #[must_use]
    pub fn ray(&self, at: Vec2) -> Vec3 {
        let clip = Vec4::new(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.5, 1.0);
        let world = self.clip_from_world.inverse() * clip;
        (world.truncate() / world.w - self.eye).normalize_or(Vec3::NEG_Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBJECT: Subject = Subject { ground: Vec2::new(1.0, -2.0), floor: 0.1, height: 1.8, width: 1.0 };

    fn settle(camera: &mut Camera) {
        for _ in 0..2000 {
            camera.step(1.0 / 60.0);
        }
        assert!(!camera.moving());
    }

    #[test]
    fn the_actor_fills_two_thirds_of_the_height() {
        let view = Camera::new(SUBJECT).view();
        let y = |height: f32| view.project(Vec3::new(1.0, 0.1 + height, -2.0)).unwrap().y;
        let filled = y(0.0) - y(1.8);
        assert!((0.62..0.68).contains(&filled), "{filled}");
        let middle = (y(0.0) + y(1.8)) / 2.0;
        assert!((middle - 0.5).abs() < 0.03, "{middle}");
    }

    #[test]
    fn a_narrow_picture_still_holds_the_width() {
        let mut camera = Camera::new(SUBJECT);
        camera.set_aspect(0.3);
        let view = camera.view();
        let right = Vec3::Y.cross(view.eye - view.target).normalize();
        let at = view.project(view.target + right * 0.5).unwrap();
        assert!(at.x > 0.9 && at.x < 1.0, "{at}");
    }

    #[test]
    fn rays_go_back_where_points_came_from() {
        let view = Camera::new(SUBJECT).view();
        for point in [Vec3::new(1.3, 0.4, -2.2), Vec3::new(0.2, 1.9, -1.0)] {
            let at = view.project(point).unwrap();
            assert!(view.ray(at).distance((point - view.eye).normalize()) < 1e-4);
        }
        assert_eq!(view.project(view.eye + (view.eye - view.target)), None);
    }

    #[test]
    fn the_ground_is_found_where_it_is_seen() {
        let view = Camera::new(SUBJECT).view();
        for point in [Vec2::new(1.3, -2.2), Vec2::new(0.2, -1.0), Vec2::new(-1.0, -4.0)] {
            let at = view.project(Vec3::new(point.x, 0.1, point.y)).unwrap();
            assert!(view.ground_at(at, 0.1, 100.0).unwrap().distance(point) < 1e-3);
        }
        assert_eq!(view.ground_at(Vec2::new(0.5, 0.01), 0.1, 100.0), None);
    }

    #[test]
    fn looks_from_where_it_is_told_by_the_shorter_way() {
        let mut camera = Camera::new(SUBJECT);
        camera.orbit(4.0, 0.0);
        camera.look_from(0.2, 0.5, 1.5);
        let [yaw, elevation, distance] = camera.goal();
        assert!(((yaw - 0.2) / std::f32::consts::TAU).fract().abs() < 1e-5 && (elevation, distance) == (0.5, 1.5));
        camera.set_home(0.1, 0.3, 2.0);
        camera.look_from(f32::NAN, 0.0, 1.0);
        assert_eq!(camera.goal()[1], 0.5);
        camera.recentre();
        assert_eq!(camera.goal()[1..], [0.3, 2.0]);
    }

    #[test]
    fn never_looks_from_below_the_ground() {
        let mut camera = Camera::new(SUBJECT);
        for (dx, dy) in [(0.3, -9.0), (-2.0, 9.0), (1.0, -20.0)] {
            camera.orbit(dx, dy);
            camera.pan(0.0, -3.0);
            camera.zoom(0.3);
            settle(&mut camera);
            assert!(camera.view().eye.y > SUBJECT.floor);
            assert!(camera.view().clip_from_world.is_finite());
        }
    }

    #[test]
    fn follows_without_overshoot_and_comes_to_rest() {
        let mut camera = Camera::new(SUBJECT);
        assert!(!camera.step(0.1));
        camera.follow(Vec2::new(3.0, -2.0));
        let mut before = camera.view().target.x;
        for _ in 0..300 {
            camera.step(1.0 / 60.0);
            let now = camera.view().target.x;
            assert!(now >= before - 1e-5 && now <= 3.001);
            before = now;
        }
        assert!((before - 3.0).abs() < 2e-3 && !camera.moving());
    }

    #[test]
    fn the_hand_decides_until_recentred() {
        let mut camera = Camera::new(SUBJECT);
        let home = camera.view();
        camera.orbit(0.7, 0.1);
        camera.pan(0.1, 0.05);
        camera.zoom(2.0);
        settle(&mut camera);
        let chosen = camera.view();
        assert!((chosen.eye - chosen.target).length() < 0.6 * (home.eye - home.target).length());
        settle(&mut camera);
        assert_eq!(camera.view(), chosen);
        camera.recentre();
        settle(&mut camera);
        assert!(camera.view().eye.distance(home.eye) < 1e-3);
    }

    #[test]
    fn panning_keeps_the_point_under_the_pointer() {
        let mut camera = Camera::new(SUBJECT);
        camera.instant = true;
        let before = camera.view();
        camera.pan(0.1, -0.2);
        camera.step(0.0);
        // Half a picture wide is `aspect / 2` heights.
        let at = camera.view().project(before.target).unwrap();
        assert!((at.x - 0.5 - 0.1 / 1.6).abs() < 1e-3 && (at.y - 0.5 + 0.2).abs() < 1e-3, "{at}");
    }
}
