//! Opens a device for a canvas.

use js_sys::Promise;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use super::Stage;
use crate::bindings::error::{ErrorKind, error};
use crate::bindings::player::Player;
use crate::camera::Camera;
use crate::gpu::context::Gpu;
use crate::gpu::scene::Scene;
use crate::gpu::target::Target;
use crate::gpu::thumbnail::Thumbnails;
use searcher::page::now;

/// Prepares `canvas` for the actor of `player`, whose first pose has arrived.
///
/// # Errors
/// The promise is rejected where there is no WebGPU, no adapter or no device.
#[wasm_bindgen(unchecked_return_type = "Promise<Stage>")]
pub fn create_stage(canvas: HtmlCanvasElement, player: &Player) -> Result<Promise, JsValue> {
    let missing = || error(ErrorKind::NotLoaded, "the actor has not arrived yet");
    let actor = player.inner.actor().ok_or_else(missing)?;
    let (surface, topology) = (actor.surface.clone(), actor.topology.clone());
    let first = player.inner.picture().ok_or_else(missing)?.pose();
    let reference = player.inner.reference_pose().to_vec();
    Ok(wasm_bindgen_futures::future_to_promise(async move {
        let opened = open(&canvas).await?;
        let scene = Scene::new(opened.gpu, &surface, topology.triangles().to_vec(), &reference);
        let camera = Camera::new(scene.measures.subject(&first));
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
            template: false,
            scan_share: None,
            scan_carried: false,
            rising: false,
            scan_images: Vec::new(),
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
        return Err(error(ErrorKind::NoWebGpu, "this browser has no WebGPU"));
    }
    let no_adapter = |_| error(ErrorKind::NoAdapter, "this browser has WebGPU, but no graphics device for it");
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let canvas_target = wgpu::SurfaceTarget::Canvas(canvas.clone());
    let surface = instance
        .create_surface(canvas_target)
        .map_err(|_| error(ErrorKind::NoWebGpu, "the canvas cannot be drawn with WebGPU"))?;
    let options = wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
    let adapter = instance.request_adapter(&options).await.map_err(no_adapter)?;
    let lost = |_| error(ErrorKind::DeviceLost, "the graphics device could not be opened");
    let (device, queue) = adapter.request_device(&wgpu::DeviceDescriptor::default()).await.map_err(lost)?;
    let size = [canvas.width(), canvas.height()].map(|side| side.clamp(1, 8192));
    let mut configuration = surface
        .get_default_config(&adapter, size[0], size[1])
        .ok_or_else(|| error(ErrorKind::NoAdapter, "the canvas has no format that can be drawn"))?;
    // Blending in linear light: pictures are drawn in the sRGB format beside the canvas's own, and copied.
    let format = configuration.format.add_srgb_suffix();
    configuration.usage |= wgpu::TextureUsages::COPY_DST;
    configuration.alpha_mode = wgpu::CompositeAlphaMode::Opaque;
    surface.configure(&device, &configuration);
    let gpu = Gpu::new(device, queue, format, report);
    Ok(Opened { surface, configuration, adapter: adapter.get_info(), gpu })
}

fn report(reason: &str) {
    web_sys::console::error_1(&reason.into());
}
