//! The class `Stage`: the canvas, the camera, and what the page asks of the picture.
//!
//! No method that returns a promise keeps the object borrowed while it waits: the frame loop goes on meanwhile.

mod open;
mod readback;
mod scans;
mod texture;
mod view;

pub use open::create_stage;

use bundle::Textures;
use searcher::page::{json, now};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use super::error::{ErrorKind, error};
use super::player::Player;
use crate::brought::Brought;
use crate::camera::Camera;
use crate::gpu::pose::Numbered;
use crate::gpu::scans::Wanted;
use crate::gpu::scene::{Moment, Scene};
use crate::gpu::target::Target;
use crate::gpu::thumbnail::Thumbnails;
use crate::player::body_parts::BodyParts;

/// The picture on one canvas, on one device.
#[wasm_bindgen]
pub struct Stage {
    canvas: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    adapter: wgpu::AdapterInfo,
    scene: Scene,
    target: Target,
    thumbnails: Thumbnails,
    camera: Camera,
    drawn: Option<Drawn>,
    due: bool,
    /// Whether the camera moved in the last picture.
    eased: bool,
    time: f64,
    /// Whether textures are cross-faded in transitions, for comparison.
    cross_fade: bool,
    /// Which models the texture should come from, and which it came from last.
    textures: [Textures; 2],
    /// Whether the actor wears a texture as captured instead, for comparison.
    original: bool,
    /// Whether the registered mesh is shown where scanned frames are there, too, for comparison.
    template: bool,
    /// How much of scanned frames is seen, for comparison, in place of what the player says.
    scan_share: Option<f32>,
    /// Whether the registered mesh carries scanned frames also where they stand, for comparison.
    scan_carried: bool,
    /// Whether more of a scan is to be seen as time goes on.
    rising: bool,
    /// Images of a group of scanned frames that is to be taken.
    scan_images: Vec<wgpu::Texture>,
}

/// The adapter as the page reads it.
#[derive(serde::Serialize)]
struct Adapter<'a> {
    name: &'a str,
    fallback: bool,
}

/// What the last picture showed.
#[derive(Clone, Copy, PartialEq)]
struct Drawn {
    numbers: [u64; 2],
    weight: f32,
    /// How much of it was each of two scans.
    share: [f32; 2],
}

/// How fast a scan comes that comes late: how much of it in a second.
const SCAN_RATE: f32 = 5.0;

impl Drop for Stage {
    fn drop(&mut self) {
        // The browser's garbage collector would keep the GPU's memory for a while.
        self.lose();
    }
}

#[wasm_bindgen]
impl Stage {
    /// The canvas is now so many physical pixels large.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = [width, height].map(|side| side.clamp(1, 8192));
        if self.lost() || size == self.target.size {
            return;
        }
        self.canvas.set_width(size[0]);
        self.canvas.set_height(size[1]);
        (self.configuration.width, self.configuration.height) = (size[0], size[1]);
        self.surface.configure(&self.scene.gpu.device, &self.configuration);
        self.target = Target::new(&self.scene.gpu, size);
        self.due = true;
    }

    /// Uploads what changed and draws; does nothing where nothing changed.
    pub fn draw(&mut self, player: &Player) {
        let now = now();
        // After a rest the first step is a usual one: the camera sets off gently.
        let seconds = if self.eased { (now - self.time) / 1000.0 } else { 1.0 / 60.0 };
        self.time = now;
        if self.lost() || !self.show(player, seconds as f32) {
            return;
        }
        self.camera.set_aspect(self.target.size[0] as f32 / self.target.size[1] as f32);
        let moved = self.camera.step(seconds as f32);
        self.eased = moved;
        if !(moved || std::mem::take(&mut self.due)) {
            return;
        }
        let picture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(picture) | wgpu::CurrentSurfaceTexture::Suboptimal(picture) => picture,
            _ => {
                self.due = true;
                return;
            }
        };
        self.scene.draw(&self.camera.view(), &self.target);
        self.target.copy_to(&self.scene.gpu, &picture.texture);
        self.scene.gpu.queue.present(picture);
    }

    /// Uploads the moment that the player shows, `seconds` after the last one. False before its first pose.
    fn show(&mut self, player: &Player, seconds: f32) -> bool {
        let Some(picture) = player.inner.picture() else { return false };
        let numbers = [picture.before.number, picture.after.number];
        let weight = picture.weight as f32;
        let goes_on = self.drawn.is_some_and(|drawn| drawn.numbers.contains(&numbers[0]));
        // A scan that comes late comes little by little, where nobody jumped to it.
        let step = if goes_on && !self.camera.instant { seconds * SCAN_RATE } else { 1.0 };
        self.rising = false;
        let scans = player.inner.scan().map(|scan| {
            let scan = scan.filter(|scan| !self.template && self.scene.scans.holds(scan.place.0))?;
            let risen = self.scene.scans.rise(scan.place.0, step);
            self.rising |= risen < 1.0;
            let brought = if self.scan_carried { Brought::Blended } else { scan.brought };
            Some(Wanted { place: scan.place, brought, share: self.scan_share.unwrap_or(scan.share * risen) })
        });
        let share = scans.map(|scan| scan.map_or(0.0, |scan| scan.share));
        let drawn = Drawn { numbers, weight, share };
        if self.drawn != Some(drawn) {
            self.drawn = Some(drawn);
            self.due = true;
        }
        if self.due {
            self.camera.follow(picture.ground());
            self.scene.show(&Moment {
                before: Numbered { number: numbers[0], pose: &picture.before.pose },
                after: Numbered { number: numbers[1], pose: &picture.after.pose },
                weight,
                synthetic: picture.synthetic(),
                ground: picture.ground(),
                scans,
            });
            self.scene.show_trail(player.inner.trail(), player.inner.played());
        }
        true
    }

    /// Triangles on the ground, 12 bytes a corner: X and Z as 32-bit floats, red, green, blue and opacity as bytes.
    pub fn set_marks(&mut self, bytes: &[u8]) {
        if !self.lost() {
            self.scene.marks.write(&self.scene.gpu, bytes);
            self.due = true;
        }
    }

    /// Takes the colours of the body's parts, which the option `parts` shows: red, green and blue of each in sRGB.
    pub fn set_parts(&mut self, player: &Player, colours: &[u8]) {
        let (colours, _) = colours.as_chunks::<3>();
        let parts = BodyParts::of(player.inner.loading()).ok().flatten();
        if let (Some(parts), Some(actor), false) = (parts, player.inner.actor(), self.lost()) {
            self.scene.mesh.paint_parts(&self.scene.gpu, &actor.surface, &|vertex| parts.colour(vertex, colours));
            self.due = true;
        }
    }

    /// Sets what `json` names of theme, tint, parts, grid, path, reduced_motion, scan_share (0 to 1, for tests, or null), scan_carried (for tests) and background (sRGB, 0 to 1, or null).
    ///
    /// # Errors
    /// It is no JSON object.
    pub fn set_options(&mut self, json: &str) -> Result<(), JsValue> {
        let options = js_sys::JSON::parse(json).ok().filter(JsValue::is_object);
        let options = options.ok_or_else(|| error(ErrorKind::BadArgument, "the options are not a JSON object"))?;
        // A key that the page leaves out stays as it is.
        let given =
            |name: &str| js_sys::Reflect::get(&options, &name.into()).ok().filter(|value| !value.is_undefined());
        let look = &mut self.scene.look;
        if let Some(theme) = given("theme") {
            look.dark = theme.as_string().as_deref() == Some("dark");
        }
        if let Some(compare) = given("compare") {
            let compare = compare.as_string();
            self.template = compare.as_deref() == Some("template");
            self.cross_fade = compare.as_deref() == Some("cross-fade");
            self.textures[0] = if compare.as_deref() == Some("naive") { Textures::Naive } else { Textures::Aligned };
        }
        if let Some(share) = given("scan_share") {
            self.scan_share = share.as_f64().map(|share| share as f32);
        }
        let switches = [
            ("scan_carried", &mut self.scan_carried),
            ("tint", &mut look.tint),
            ("parts", &mut look.parts),
            ("grid", &mut look.grid),
            ("path", &mut look.path),
        ];
        for (name, switch) in switches.into_iter().chain([("reduced_motion", &mut self.camera.instant)]) {
            if let Some(on) = given(name) {
                *switch = on.is_truthy();
            }
        }
        if let Some(colour) = given("background") {
            let channel = |k: u32| Some(js_sys::Reflect::get_u32(&colour, k).ok()?.as_f64()?.clamp(0.0, 1.0) as f32);
            look.background = (|| Some([channel(0)?, channel(1)?, channel(2)?]))();
        }
        self.due = true;
        Ok(())
    }

    /// Shows the poses of `frames` where the actor would arrive; none clears. Those out of reach are left out.
    pub fn set_ghosts(&mut self, player: &mut Player, frames: &[u32]) {
        if self.lost() {
            return;
        }
        let poses = frames.iter().take(crate::gpu::ghosts::MOST);
        let poses = poses.filter_map(|&frame| Some((frame, player.inner.ghost(frame).ok()?))).collect();
        let scene = &mut self.scene;
        scene.ghosts.set(&scene.gpu, &scene.pose_layout, &scene.triangles, poses);
        self.due = true;
    }

    /// Whether the device is lost: create another stage.
    #[must_use]
    pub fn lost(&self) -> bool {
        self.scene.gpu.lost()
    }

    /// Destroys the device (for tests).
    pub fn lose(&self) {
        self.scene.gpu.lose();
    }

    /// The adapter as JSON: its name, and whether it is a slow fallback.
    ///
    /// # Errors
    /// None in practice.
    pub fn adapter(&self) -> Result<String, JsValue> {
        let fallback = self.adapter.device_type == wgpu::DeviceType::Cpu;
        json(&Adapter { name: &self.adapter.name, fallback })
    }
}
