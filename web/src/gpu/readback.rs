//! Pixels back from the GPU.

use kernels::srgb::{linear_from_srgb, srgb_from_linear};
use wgpu::{BufferUsages, TextureFormat};

use super::context::{Gpu, extent, named};

/// Copies `texture`, of `size` pixels in the picture's format, and hands its RGBA bytes to `then`; `None` on a loss.
///
/// With `straight`, the premultiplied picture becomes straight alpha, as canvases' image data are.
pub fn read(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    size: [u32; 2],
    straight: bool,
    then: impl FnOnce(Option<Vec<u8>>) + wgpu::WasmNotSend + 'static,
) {
    let row = (size[0] * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: named("reprise.readback.pixels"),
        size: u64::from(row) * u64::from(size[1]),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder("reprise.readback.commands");
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        extent(size),
    );
    gpu.queue.submit([encoder.finish()]);
    let swap = matches!(texture.format(), TextureFormat::Bgra8Unorm | TextureFormat::Bgra8UnormSrgb);
    let mapped = buffer.clone();
    buffer.map_async(wgpu::MapMode::Read, .., move |outcome| {
        let bytes = outcome.ok().and_then(|()| mapped.get_mapped_range(..).ok()).map(|range| {
            let rows = range.chunks_exact(row as usize);
            let mut pixels: Vec<u8> = rows.flat_map(|row| &row[..size[0] as usize * 4]).copied().collect();
            tidy(&mut pixels, swap, straight);
            pixels
        });
        mapped.unmap();
        then(bytes);
    });
}

fn tidy(pixels: &mut [u8], swap: bool, straight: bool) {
    for pixel in pixels.chunks_exact_mut(4) {
        if swap {
            pixel.swap(0, 2);
        }
        let alpha = f32::from(pixel[3]) / 255.0;
        if straight && pixel[3] > 0 && pixel[3] < 255 {
            for channel in &mut pixel[..3] {
                // Premultiplied in linear light, then encoded.
                let light = linear_from_srgb(f32::from(*channel) / 255.0) / alpha;
                *channel = (srgb_from_linear(light.min(1.0)) * 255.0 + 0.5) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_alpha_gives_the_colour_back() {
        let alpha = 128.0 / 255.0;
        let colour = [200u8, 90, 30];
        let premultiplied =
            colour.map(|c| (srgb_from_linear(linear_from_srgb(f32::from(c) / 255.0) * alpha) * 255.0 + 0.5) as u8);
        let mut pixel = [premultiplied[2], premultiplied[1], premultiplied[0], 128];
        tidy(&mut pixel, true, true);
        for (got, wanted) in pixel.iter().zip(colour) {
            assert!(got.abs_diff(wanted) <= 2, "{got} against {wanted}");
        }
    }
}
