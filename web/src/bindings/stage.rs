//! The class `Stage`: the canvas, the camera, and what the page asks of the picture.
//!
//! No method that returns a promise keeps the object borrowed while it waits: the frame loop goes on meanwhile.

use glam::{Vec2, Vec3};
use js_sys::{Float32Array, Promise, Uint8ClampedArray};
use shared::bundle::Textures;
use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, ImageBitmap};

use super::error::{Kind, error};
use super::player::{Player, now};
use crate::camera::{Camera, Subject};
use crate::gpu::appearance::{Looks, Setting, Wanted};
use crate::gpu::context::{Gpu, extent};
use crate::gpu::mesh::Mesh;
use crate::gpu::pose::Numbered;
use crate::gpu::readback::read;
use crate::gpu::scene::{Measures, Moment, Scene};
use crate::gpu::target::Target;
use crate::gpu::thumbnail::Thumbnails;
use crate::pick::nearest_hit;

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
}

/// How far a part of the body that is picked reaches, in heights of the actor.
const PART: f32 = 0.04;

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
}

fn report(reason: &str) {
    web_sys::console::error_1(&reason.into());
}

/// Prepares `canvas` for the actor of `player`, whose first pose has arrived.
///
/// # Errors
/// The promise is rejected where there is no WebGPU, no adapter or no device.
#[wasm_bindgen(unchecked_return_type = "Promise<Stage>")]
pub fn create_stage(canvas: HtmlCanvasElement, player: &Player) -> Result<Promise, JsValue> {
    let missing = || error(Kind::NotLoaded, "the actor has not arrived yet");
    let actor = player.inner.actor().ok_or_else(missing)?;
    let (surface, topology) = (actor.surface.clone(), actor.topology.clone());
    let first = player.inner.picture().ok_or_else(missing)?.pose();
    let reference = player.inner.reference_pose().to_vec();
    Ok(wasm_bindgen_futures::future_to_promise(async move {
        let opened = open(&canvas).await?;
        let scene = Scene::new(opened.gpu, &surface, topology.triangles().to_vec(), &reference);
        let camera = Camera::new(subject(scene.measures, &first));
        let thumbnails = Thumbnails::new(&scene, first.len());
        let target = Target::new(&scene.gpu, [opened.configuration.width, opened.configuration.height]);
        let stage = Stage {
            canvas,
            surface: opened.surface,
            configuration: opened.configuration,
            adapter: opened.adapter,
            scene,
            target,
            thumbnails,
            camera,
            drawn: None,
            due: true,
            eased: false,
            time: now(),
            cross_fade: false,
            original: false,
            textures: Default::default(),
        };
        Ok(stage.into())
    }))
}

struct Opened {
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    adapter: wgpu::AdapterInfo,
    gpu: Gpu,
}

async fn open(canvas: &HtmlCanvasElement) -> Result<Opened, JsValue> {
    let navigator = js_sys::Reflect::get(&js_sys::global(), &"navigator".into())?;
    if !js_sys::Reflect::get(&navigator, &"gpu".into())?.is_truthy() {
        return Err(error(Kind::NoWebGpu, "this browser has no WebGPU"));
    }
    let no_adapter = |_| error(Kind::NoAdapter, "this browser has WebGPU, but no graphics device for it");
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let canvas_target = wgpu::SurfaceTarget::Canvas(canvas.clone());
    let surface = instance
        .create_surface(canvas_target)
        .map_err(|_| error(Kind::NoWebGpu, "the canvas cannot be drawn with WebGPU"))?;
    let options = wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
    let adapter = instance.request_adapter(&options).await.map_err(no_adapter)?;
    let lost = |_| error(Kind::DeviceLost, "the graphics device could not be opened");
    let (device, queue) = adapter.request_device(&wgpu::DeviceDescriptor::default()).await.map_err(lost)?;
    let size = [canvas.width(), canvas.height()].map(|side| side.clamp(1, 8192));
    let mut configuration = surface
        .get_default_config(&adapter, size[0], size[1])
        .ok_or_else(|| error(Kind::NoAdapter, "the canvas has no format that can be drawn"))?;
    // Blending in linear light: pictures are drawn in the sRGB format beside the canvas's own, and copied.
    let format = configuration.format.add_srgb_suffix();
    configuration.usage |= wgpu::TextureUsages::COPY_DST;
    configuration.alpha_mode = wgpu::CompositeAlphaMode::Opaque;
    surface.configure(&device, &configuration);
    let gpu = Gpu::new(device, queue, format, report);
    Ok(Opened { surface, configuration, adapter: adapter.get_info(), gpu })
}

fn subject(measures: Measures, pose: &[Vec3]) -> Subject {
    let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
    let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
    let middle = (low + high) / 2.0;
    Subject {
        ground: Vec2::new(middle.x, middle.z),
        floor: measures.floor,
        height: measures.height,
        width: measures.width,
    }
}

/// RGBA bytes as the page gets them.
fn pixels_promise(start: impl FnOnce(Box<dyn FnOnce(Option<Vec<u8>>)>)) -> Promise {
    let mut start = Some(start);
    Promise::new(&mut |resolve, reject| {
        let then = Box::new(move |bytes: Option<Vec<u8>>| {
            let settled = match bytes {
                Some(bytes) => resolve.call1(&JsValue::NULL, &Uint8ClampedArray::from(bytes.as_slice())),
                None => reject.call1(&JsValue::NULL, &error(Kind::DeviceLost, "the graphics device was lost")),
            };
            // Settling a promise does not throw.
            drop(settled);
        });
        if let Some(start) = start.take() {
            start(then);
        }
    })
}

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
        if self.lost() || !self.show(player) {
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

    /// Uploads the moment that the player shows. False before its first pose.
    fn show(&mut self, player: &Player) -> bool {
        let Some(picture) = player.inner.picture() else { return false };
        let numbers = [picture.before.number, picture.after.number];
        let weight = picture.weight as f32;
        let drawn = Drawn { numbers, weight };
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
            });
            self.scene.show_trail(player.inner.trail(), player.inner.played());
        }
        true
    }

    /// Brings the actor's texture up to what the player shows; true where it may have to be asked again.
    pub fn dress(&mut self, player: &Player) -> bool {
        // What has not arrived is not worn: the aligned ones come first.
        let of = self.textures[0];
        let of = if player.inner.modes(of)[0].is_empty() { Textures::Aligned } else { of };
        let (Some(appearance), Some(picture)) = (player.inner.appearance(of), player.inner.picture()) else {
            return false;
        };
        if self.lost() || self.original {
            return false;
        }
        let (scene, slow) = (&mut self.scene, self.adapter.device_type == wgpu::DeviceType::Cpu);
        let looks = scene.looks[of as usize]
            .get_or_insert_with(|| Looks::new(&scene.gpu, appearance, scene.mesh.textures(), slow, now));
        if std::mem::replace(&mut self.textures[1], of) != of {
            looks.take_off();
        }
        looks.take(&scene.gpu, player.inner.modes(of));
        let layers = &appearance.layers;
        let wanted = if self.cross_fade {
            let [(colours, lambda), (warps, _)] = [0, 1].map(|layer| picture.ends(&layers[layer]));
            let [[a, b], [c, d]] = [colours, warps];
            Wanted::CrossFaded([a, c], [b, d], lambda)
        } else {
            Wanted::Interpolated([0, 1].map(|layer| picture.weights(&layers[layer])))
        };
        self.due |= looks.show(&scene.gpu, &mut scene.mesh, wanted);
        looks.busy()
    }

    /// How the texture is rebuilt: `half`, `direct` or `poisson`; nothing where it is not. Given a word, it stays so;
    /// with any other the device's speed decides.
    pub fn texture_setting(&mut self, wanted: Option<String>) -> Option<String> {
        let words = [(Setting::Half, "half"), (Setting::Direct, "direct"), (Setting::Poisson, "poisson")];
        let looks = self.scene.looks[self.textures[1] as usize].as_mut()?;
        if let Some(wanted) = wanted {
            looks.keep(words.iter().find(|(_, word)| *word == wanted).map(|(setting, _)| *setting));
        }
        words.iter().find(|(setting, _)| *setting == looks.setting()).map(|(_, word)| (*word).into())
    }

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

    /// Triangles on the ground, 12 bytes a corner: X and Z as 32-bit floats, red, green, blue and opacity as bytes.
    pub fn set_marks(&mut self, bytes: &[u8]) {
        if !self.lost() {
            self.scene.marks.write(&self.scene.gpu, bytes);
            self.due = true;
        }
    }

    /// Whether the camera still eases: keep drawing.
    #[must_use]
    pub fn camera_moving(&self) -> bool {
        self.camera.moving()
    }

    /// Sets what `json` names of theme, tint, grid, path, reduced_motion and background (sRGB, 0 to 1, or null).
    ///
    /// # Errors
    /// It is no JSON object.
    pub fn set_options(&mut self, json: &str) -> Result<(), JsValue> {
        let options = js_sys::JSON::parse(json).ok().filter(JsValue::is_object);
        let options = options.ok_or_else(|| error(Kind::BadArgument, "the options are not a JSON object"))?;
        // A key that the page leaves out stays as it is.
        let given =
            |name: &str| js_sys::Reflect::get(&options, &name.into()).ok().filter(|value| !value.is_undefined());
        let look = &mut self.scene.look;
        if let Some(theme) = given("theme") {
            look.dark = theme.as_string().as_deref() == Some("dark");
        }
        if let Some(compare) = given("compare") {
            let compare = compare.as_string();
            self.cross_fade = compare.as_deref() == Some("cross-fade");
            self.textures[0] = if compare.as_deref() == Some("naive") { Textures::Naive } else { Textures::Aligned };
        }
        let switches = [("tint", &mut look.tint), ("grid", &mut look.grid), ("path", &mut look.path)];
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

    /// Takes texture `index`, decoded by the browser.
    pub fn set_image(&mut self, index: usize, bitmap: ImageBitmap) {
        self.take_image(&bitmap, |mesh, gpu, texture| mesh.set_image(gpu, index, texture));
    }

    /// Shows a texture as captured in place of what is rebuilt from modes; without one, what is rebuilt again.
    pub fn set_original(&mut self, player: &Player, bitmap: Option<ImageBitmap>) {
        self.original = false;
        if let (Some(bitmap), Some(appearance)) = (&bitmap, player.inner.appearance(Textures::Aligned)) {
            let material = appearance.material as usize;
            self.original = self.take_image(bitmap, |mesh, gpu, texture| mesh.paint(gpu, material, texture));
        }
        self.scene.looks.iter_mut().flatten().for_each(Looks::take_off);
    }

    /// Makes a texture of `bitmap` for the mesh; whether that could be done.
    fn take_image(&mut self, bitmap: &ImageBitmap, put: impl FnOnce(&mut Mesh, &Gpu, &wgpu::Texture)) -> bool {
        let size = [bitmap.width(), bitmap.height()];
        if self.lost() || size.contains(&0) || size.iter().any(|&side| side > 8192) {
            return false;
        }
        let gpu = self.scene.gpu.clone();
        let texture = self.scene.mesh.textures().create(&gpu, size);
        let source = wgpu::CopyExternalImageSourceInfo {
            source: wgpu::ExternalImageSource::ImageBitmap(bitmap.clone()),
            origin: wgpu::Origin2d::ZERO,
            flip_y: false,
        };
        let destination = wgpu::CopyExternalImageDestInfo {
            texture: &texture,
            mip_level: 0,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
            color_space: wgpu::PredefinedColorSpace::Srgb,
            premultiplied_alpha: false,
        };
        gpu.queue.copy_external_image_to_texture(&source, destination, extent(size));
        self.scene.mesh.textures().fill_levels(&gpu, &texture);
        put(&mut self.scene.mesh, &gpu, &texture);
        self.due = true;
        true
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

    /// Where the point of the world is seen: CSS x, CSS y, and 1 where it is in the picture, else 0.
    #[must_use]
    pub fn project(&self, x: f32, y: f32, z: f32) -> Float32Array {
        let size = self.css_size();
        let seen = self.camera.view().project(Vec3::new(x, y, z));
        let inside = seen.is_some_and(|at| at.min_element() >= 0.0 && at.max_element() <= 1.0);
        let at = seen.unwrap_or_default() * size;
        Float32Array::from([at.x, at.y, f32::from(u8::from(inside))].as_slice())
    }

    /// A picture of recorded frame `frame` alone, RGBA with straight alpha on a transparent background.
    ///
    /// # Errors
    /// It has not arrived, or the device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn thumbnail(&mut self, player: &mut Player, frame: u32, width: u32, height: u32) -> Result<Promise, JsValue> {
        self.alive()?;
        let pose = player.inner.recorded_pose(frame)?;
        Ok(pixels_promise(|then| self.thumbnails.draw(&self.scene, &pose, [width, height], then)))
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
        super::error::json(&Adapter { name: &self.adapter.name, fallback })
    }

    /// RGBA of the texture that was rebuilt last.
    ///
    /// # Errors
    /// There is none, or the device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn read_texture(&self) -> Result<Promise, JsValue> {
        self.alive()?;
        let missing = || error(Kind::NotLoaded, "the actor's texture has no modes");
        let texture = self.scene.looks[self.textures[1] as usize].as_ref().ok_or_else(missing)?.texture();
        let size = [texture.width(), texture.height()];
        Ok(pixels_promise(|then| read(&self.scene.gpu, texture, size, false, then)))
    }

    /// RGBA of the last picture.
    ///
    /// # Errors
    /// The device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn read_pixels(&self) -> Result<Promise, JsValue> {
        self.alive()?;
        let target = &self.target;
        Ok(pixels_promise(|then| read(&self.scene.gpu, &target.picture, target.size, false, then)))
    }

    fn alive(&self) -> Result<(), JsValue> {
        if self.lost() { Err(error(Kind::DeviceLost, "the graphics device was lost")) } else { Ok(()) }
    }

    fn css_size(&self) -> Vec2 {
        let size = Vec2::new(self.canvas.client_width() as f32, self.canvas.client_height() as f32);
        if size.min_element() > 0.0 { size } else { Vec2::new(self.target.size[0] as f32, self.target.size[1] as f32) }
    }
}
