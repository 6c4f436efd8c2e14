//! What passes are bound to: textures of whole numbers that are read, and textures that are written.

use wgpu::TextureFormat;

use crate::gpu::context::{Gpu, extent, named};

/// A texture of one level that passes read, and write or fill as `usage` says.
pub(super) fn storage(
    gpu: &Gpu,
    label: &'static str,
    size: [u32; 2],
    format: TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: named(label),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | usage,
        view_formats: &[],
    })
}

/// A texture that is read without filtering.
pub(super) fn unfiltered(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: false }
}

/// Whole numbers, read.
pub(super) fn numbers() -> wgpu::BindingType {
    unfiltered(wgpu::TextureSampleType::Uint)
}

/// A texture that is written.
pub(super) fn written(format: TextureFormat) -> wgpu::BindingType {
    let access = wgpu::StorageTextureAccess::WriteOnly;
    wgpu::BindingType::StorageTexture { access, format, view_dimension: wgpu::TextureViewDimension::D2 }
}
