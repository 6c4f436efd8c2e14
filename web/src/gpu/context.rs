//! The device, whether it is lost, and short forms of what every pass creates.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use wgpu::{BufferUsages, ShaderStages, TextureFormat};

#[cfg(not(target_arch = "wasm32"))]
use super::timing::Stopwatch;

/// Samples per pixel of every picture.
pub const SAMPLES: u32 = 4;
/// Format of the depth buffers.
pub const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// A device with its queue. Clones share it.
#[derive(Clone)]
pub struct Gpu {
    /// Creates.
    pub device: wgpu::Device,
    /// Uploads and runs.
    pub queue: wgpu::Queue,
    /// Format that pictures are drawn in; an sRGB one, so that blending happens in linear light.
    pub format: TextureFormat,
    lost: Arc<AtomicBool>,
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) stopwatch: Option<Arc<Stopwatch>>,
}

impl Gpu {
    /// Watches `device`: after a loss or an error that nobody caught, [`Self::lost`] is true. `report` gets the reason.
    #[must_use]
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, format: TextureFormat, report: fn(&str)) -> Self {
        let lost = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            flag.store(true, Ordering::Relaxed);
            // Given up on purpose: nobody needs to be told.
            if reason != wgpu::DeviceLostReason::Destroyed {
                report(&message);
            }
        });
        let flag = Arc::clone(&lost);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            flag.store(true, Ordering::Relaxed);
            report(&error.to_string());
        }));
        Self {
            device,
            queue,
            format,
            lost,
            #[cfg(not(target_arch = "wasm32"))]
            stopwatch: None,
        }
    }

    /// The same device; its passes write their times to `stopwatch`.
    #[cfg(not(target_arch = "wasm32"))]
    #[must_use]
    pub fn timed_by(self, stopwatch: Arc<Stopwatch>) -> Self {
        Self { stopwatch: Some(stopwatch), ..self }
    }

    /// Whether nothing can be drawn any more.
    #[must_use]
    pub fn lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Gives the device up.
    pub fn lose(&self) {
        self.lost.store(true, Ordering::Relaxed);
        self.device.destroy();
    }

    /// Commands to be submitted.
    #[must_use]
    pub fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: named(label) })
    }

    /// A buffer of `size` bytes, at least 16.
    #[must_use]
    pub fn buffer(&self, label: &'static str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: named(label),
            size: size.max(16).next_multiple_of(4),
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// A buffer that holds `data`, whose size is a multiple of 4 bytes.
    #[must_use]
    pub fn buffer_of(&self, label: &'static str, data: &[u8], usage: BufferUsages) -> wgpu::Buffer {
        let buffer = self.buffer(label, data.len() as u64, usage);
        self.queue.write_buffer(&buffer, 0, data);
        buffer
    }

    /// A layout of what a shader binds, from binding 0 on.
    #[must_use]
    pub fn layout(
        &self,
        label: &'static str,
        stages: ShaderStages,
        bindings: &[wgpu::BindingType],
    ) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = (0..)
            .zip(bindings)
            .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility: stages, ty, count: None })
            .collect();
        self.device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: named(label), entries: &entries })
    }

    /// What a shader binds, from binding 0 on.
    #[must_use]
    pub fn group(
        &self,
        label: &'static str,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: named(label), layout, entries: &entries })
    }

    /// A texture of one level, drawn to and sampled or copied.
    #[must_use]
    pub fn target(
        &self,
        label: &'static str,
        size: [u32; 2],
        format: TextureFormat,
        samples: u32,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: named(label),
            size: extent(size),
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
            view_formats: &[],
        })
    }

    /// A sampler that filters linearly, between levels too.
    #[must_use]
    pub fn sampler(&self, label: &'static str, address: wgpu::AddressMode, anisotropy: u16) -> wgpu::Sampler {
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: named(label),
            address_mode_u: address,
            address_mode_v: address,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: anisotropy,
            ..Default::default()
        })
    }

    /// Creates the pipeline of a compute shader's entry point, whose group 0 has this layout.
    #[must_use]
    pub fn compute(
        &self,
        label: &'static str,
        shader: &'static str,
        entry: &str,
        layout: &wgpu::BindGroupLayout,
    ) -> wgpu::ComputePipeline {
        let source = wgpu::ShaderSource::Wgsl(shader.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: named(label), source });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: named(label),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: named(label),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }

    /// Creates the pipeline that `pass` describes.
    #[must_use]
    pub fn pipeline(&self, pass: &Pass<'_>) -> wgpu::RenderPipeline {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: pass.label,
            source: wgpu::ShaderSource::Wgsl(pass.shader.into()),
        });
        let layouts: Vec<_> = pass.layouts.iter().map(|&layout| Some(layout)).collect();
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: pass.label,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let target = wgpu::ColorTargetState {
            format: pass.format,
            blend: pass.blend,
            write_mask: if pass.colour { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() },
        };
        let vertices: Vec<_> = pass.vertices.iter().cloned().map(Some).collect();
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: pass.label,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &vertices,
            },
            primitive: wgpu::PrimitiveState { topology: pass.topology, cull_mode: pass.cull, ..Default::default() },
            depth_stencil: pass.depth.map(|(compare, write)| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: pass.samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// What tells one pipeline from another.
pub struct Pass<'a> {
    /// Label of the pipeline and of what it is made of, from [`named`].
    pub label: Option<&'static str>,
    /// WGSL with the entry points `vertex` and `fragment`.
    pub shader: &'static str,
    /// Layouts of groups 0, 1, 2.
    pub layouts: &'a [&'a wgpu::BindGroupLayout],
    /// Vertex buffers.
    pub vertices: &'a [wgpu::VertexBufferLayout<'a>],
    /// Triangles or a strip of them.
    pub topology: wgpu::PrimitiveTopology,
    /// Faces left out.
    pub cull: Option<wgpu::Face>,
    /// Depth test and whether depth is written; `None` without a depth buffer.
    pub depth: Option<(wgpu::CompareFunction, bool)>,
    /// Samples per pixel of its target.
    pub samples: u32,
    /// Format of its target.
    pub format: TextureFormat,
    /// How it meets what is there.
    pub blend: Option<wgpu::BlendState>,
    /// Whether colour is written.
    pub colour: bool,
}

impl<'a> Pass<'a> {
    /// A pass of the picture: multisampled, with depth.
    #[must_use]
    pub fn of_picture(
        gpu: &Gpu,
        label: &'static str,
        shader: &'static str,
        layouts: &'a [&'a wgpu::BindGroupLayout],
    ) -> Self {
        Self {
            depth: Some((wgpu::CompareFunction::Less, true)),
            samples: SAMPLES,
            ..Self::of_texture(label, shader, layouts, gpu.format)
        }
    }

    /// A pass into a texture of `format`: one sample, no depth.
    #[must_use]
    pub fn of_texture(
        label: &'static str,
        shader: &'static str,
        layouts: &'a [&'a wgpu::BindGroupLayout],
        format: TextureFormat,
    ) -> Self {
        Self {
            label: named(label),
            shader,
            layouts,
            vertices: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            depth: None,
            samples: 1,
            format,
            blend: None,
            colour: true,
        }
    }
}

/// A uniform buffer.
pub const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};
/// A storage buffer that is only read.
pub const STORAGE: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};
/// A texture that can be filtered.
pub const TEXTURE: wgpu::BindingType = wgpu::BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Float { filterable: true },
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};
/// A sampler that filters.
pub const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// `size` as wgpu wants it.
#[must_use]
pub fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}

/// A view of a whole texture.
#[must_use]
pub fn view(label: &'static str, texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor { label: named(label), ..Default::default() })
}

/// A label, `reprise.pass.thing`: error messages and graphics debuggers say it. The page goes without, unless it is built
/// for debugging: all labels together weigh 1.2 KB there, packed.
#[must_use]
pub const fn named(label: &'static str) -> Option<&'static str> {
    if cfg!(any(debug_assertions, not(target_arch = "wasm32"))) { Some(label) } else { None }
}
