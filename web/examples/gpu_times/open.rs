//! Finds a graphics adapter, and opens a device as the page does, with timestamp queries where there are any.

use std::sync::Arc;

use anyhow::{Context, Result, bail};
use pollster::block_on;
use web::gpu::context::Gpu;
use web::gpu::timing::Stopwatch;

/// What to do where there is no adapter.
pub const NO_ADAPTER: &str = "\
error: there is no graphics adapter on this machine.
On Linux install the Vulkan driver of its GPU and the loader (Debian: libvulkan1, and mesa-vulkan-drivers for Intel and
AMD or nvidia-driver for NVIDIA). Without a GPU, mesa-vulkan-drivers brings a software adapter, which runs everything
but says nothing about a GPU:
    apt-get install libvulkan1 mesa-vulkan-drivers
macOS and Windows bring theirs (Metal, DirectX 12); WGPU_BACKEND, if it is set, must not name another one.";

/// The format of pictures; that of canvases on nearly all devices, in sRGB as on the page.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Bgra8UnormSrgb;

/// A device on which times can be taken.
pub struct Opened {
    /// The device.
    pub gpu: Gpu,
    /// Who made it.
    pub adapter: wgpu::AdapterInfo,
    /// The GPU's clock, where passes can be timed with it.
    pub stopwatch: Option<Arc<Stopwatch>>,
}

/// Opens the adapter whose name has `wanted` in it; without, the fastest one. `None` where there is no adapter at all.
///
/// # Errors
/// No adapter of that name, or a device that cannot be opened.
pub fn open(wanted: Option<&str>) -> Result<Option<Opened>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = match wanted {
        Some(name) => named(&instance, name)?,
        None => {
            let power_preference = wgpu::PowerPreference::HighPerformance;
            let options = wgpu::RequestAdapterOptions { power_preference, ..Default::default() };
            block_on(instance.request_adapter(&options)).ok()
        }
    };
    let Some(adapter) = adapter else { return Ok(None) };
    let info = adapter.get_info();
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("reprise.stage.device"),
        required_features: adapter.features() & Stopwatch::FEATURES,
        ..Default::default()
    };
    let device = block_on(adapter.request_device(&descriptor));
    let (device, queue) = device.with_context(|| format!("{} cannot be opened", info.name))?;
    let stopwatch = Stopwatch::new(&device, &queue).map(Arc::new);
    let gpu = Gpu::new(device, queue, PICTURE, |reason| eprintln!("the device was lost: {reason}"));
    let gpu = match &stopwatch {
        Some(stopwatch) => gpu.timed_by(Arc::clone(stopwatch)),
        None => gpu,
    };
    Ok(Some(Opened { gpu, adapter: info, stopwatch }))
}

/// The adapter whose name has `name` in it. `None` where there is no adapter at all.
fn named(instance: &wgpu::Instance, name: &str) -> Result<Option<wgpu::Adapter>> {
    let mut adapters = block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    if names.is_empty() {
        return Ok(None);
    }
    match names.iter().position(|own| own.to_lowercase().contains(&name.to_lowercase())) {
        Some(index) => Ok(Some(adapters.swap_remove(index))),
        None => bail!("no adapter's name has {name:?} in it; there are: {}", names.join(", ")),
    }
}
