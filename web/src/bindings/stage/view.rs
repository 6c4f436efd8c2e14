//! The camera, and what is seen where.

use glam::{Vec2, Vec3};
use js_sys::Float32Array;
use wasm_bindgen::prelude::*;

use super::Stage;
use crate::bindings::player::Player;
use crate::gpu::scene::Measures;
use crate::pick::nearest_hit;

/// How far a part of the body that is picked reaches, in heights of the actor.
const PART: f32 = 0.04;

#[wasm_bindgen]
impl Stage {
    /// Turns the camera; CSS pixels.
    pub fn orbit(&mut self, dx: f32, dy: f32) {
        let height = self.css_size().y;
        self.camera.orbit(dx / height, dy / height);
    }

    /// Moves the camera; CSS pixels.
    pub fn pan(&mut self, dx: f32, dy: f32) {
        let height = self.css_size().y;
        self.camera.pan(dx / height, dy / height);
    }

    /// Comes `factor` times closer.
    pub fn zoom(&mut self, factor: f32) {
        self.camera.zoom(factor);
    }

    /// Back to the view that it began with.
    pub fn recentre(&mut self) {
        self.camera.recentre();
    }

    /// Turns the camera to `yaw` and `elevation` (radians) at `distance` (1 shows all of the actor). With `home` it is
    /// where [`Self::recentre`] goes from now on, too.
    pub fn look_from(&mut self, yaw: f32, elevation: f32, distance: f32, home: bool) {
        if home {
            self.camera.set_home(yaw, elevation, distance);
        }
        self.camera.look_from(yaw, elevation, distance);
    }

    /// Yaw, elevation and distance that the camera is at or on its way to.
    #[must_use]
    pub fn camera(&self) -> Float32Array {
        Float32Array::from(self.camera.goal().as_slice())
    }

    /// The ground (X, Z) under the pointer (CSS pixels); empty at the horizon and beyond 200 heights of the actor.
    #[must_use]
    pub fn ground_at(&self, x: f32, y: f32) -> Float32Array {
        let at = Vec2::new(x, y) / self.css_size();
        let Measures { floor, height, .. } = self.scene.measures;
        let found = self.camera.view().ground_at(at, floor, height * 200.0);
        Float32Array::from(found.map_or(vec![], |point| point.to_array().to_vec()).as_slice())
    }

    /// Height of the ground, and of the actor above it, metres.
    #[must_use]
    pub fn measures(&self) -> Float32Array {
        Float32Array::from([self.scene.measures.floor, self.scene.measures.height].as_slice())
    }

    /// Whether the camera still eases, or a scan comes little by little: keep drawing.
    #[must_use]
    pub fn camera_moving(&self) -> bool {
        self.rising || self.camera.moving()
    }

    /// What is under the pointer (CSS pixels): a ghost's frame, -2 for the actor, or -1.
    #[must_use]
    pub fn pick(&self, player: &Player, x: f32, y: f32) -> i32 {
        let seen = self.camera.view();
        let ray = seen.ray(Vec2::new(x, y) / self.css_size());
        let distance = |pose: &[Vec3]| nearest_hit(seen.eye, ray, &self.scene.triangles, pose);
        let actor = player.inner.picture().and_then(|picture| Some((distance(&picture.pose())?, -2)));
        let ghosts =
            self.scene.ghosts.shown().iter().filter_map(|ghost| Some((distance(&ghost.pose)?, ghost.frame as i32)));
        let nearest = actor.into_iter().chain(ghosts).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(-1, |(_, what)| what)
    }

    /// The vertices of the actor around the point of it that is under the pointer (CSS pixels), a hand's size, or none.
    #[must_use]
    pub fn part_at(&self, player: &Player, x: f32, y: f32) -> Vec<u32> {
        let seen = self.camera.view();
        let ray = seen.ray(Vec2::new(x, y) / self.css_size());
        let pose = player.inner.picture().map(|picture| picture.pose()).unwrap_or_default();
        let Some(distance) = nearest_hit(seen.eye, ray, &self.scene.triangles, &pose) else { return Vec::new() };
        let (hit, reach) = (seen.eye + ray * distance, self.scene.measures.height * PART);
        (0..).zip(&pose).filter(|(_, point)| point.distance(hit) < reach).map(|(vertex, _)| vertex).collect()
    }

    /// The vertex of the actor that is nearest to the point of it under the pointer (CSS pixels); -1 beside it.
    #[must_use]
    pub fn vertex_at(&self, player: &Player, x: f32, y: f32) -> i32 {
        let seen = self.camera.view();
        let ray = seen.ray(Vec2::new(x, y) / self.css_size());
        let pose = player.inner.picture().map(|picture| picture.pose()).unwrap_or_default();
        let Some(distance) = nearest_hit(seen.eye, ray, &self.scene.triangles, &pose) else { return -1 };
        let hit = seen.eye + ray * distance;
        let nearest = (0..).zip(&pose).min_by(|a, b| a.1.distance(hit).total_cmp(&b.1.distance(hit)));
        nearest.map_or(-1, |(vertex, _)| vertex)
    }

    /// Where the point of the world is seen: CSS x, CSS y, and 1 where it is in the picture, else 0.
    #[must_use]
    pub fn project(&self, x: f32, y: f32, z: f32) -> Float32Array {
        let size = self.css_size();
        let seen = self.camera.view().project(Vec3::new(x, y, z));
        let inside = seen.is_some_and(|at| at.min_element() >= 0.0 && at.max_element() <= 1.0);
        let at = seen.unwrap_or_default() * size;
        Float32Array::from([at.x, at.y, f32::from(u8::from(inside))].as_slice())
    }

    fn css_size(&self) -> Vec2 {
        let size = Vec2::new(self.canvas.client_width() as f32, self.canvas.client_height() as f32);
        if size.min_element() > 0.0 { size } else { Vec2::new(self.target.size[0] as f32, self.target.size[1] as f32) }
    }
}
