//! Begins passes, with their labels; where a stopwatch runs, they write their times.

use super::context::{Gpu, named};
use super::slot::Slot;

impl Gpu {
    /// Begins a pass that draws into `colour` and, where there is one, `depth`.
    #[must_use]
    pub fn render_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &'static str,
        colour: wgpu::RenderPassColorAttachment<'_>,
        depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: named(label),
            color_attachments: &[Some(colour)],
            depth_stencil_attachment: depth,
            timestamp_writes: self.slot(label).map(|slot| wgpu::RenderPassTimestampWrites {
                query_set: slot.queries,
                beginning_of_pass_write_index: Some(slot.begin),
                end_of_pass_write_index: Some(slot.end),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Begins a pass that draws into one view, which it clears to `clear` first.
    #[must_use]
    pub fn pass_into<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &'static str,
        target: &wgpu::TextureView,
        clear: wgpu::Color,
    ) -> wgpu::RenderPass<'e> {
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store };
        let colour = wgpu::RenderPassColorAttachment { view: target, depth_slice: None, resolve_target: None, ops };
        self.render_pass(encoder, label, colour, None)
    }

    /// Begins a pass that computes.
    #[must_use]
    pub fn compute_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &'static str,
    ) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: named(label),
            timestamp_writes: self.slot(label).map(|slot| wgpu::ComputePassTimestampWrites {
                query_set: slot.queries,
                beginning_of_pass_write_index: Some(slot.begin),
                end_of_pass_write_index: Some(slot.end),
            }),
        })
    }

    /// Fills `buffer` with zeros.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, label: &'static str, buffer: &wgpu::Buffer) {
        let slot = self.slot_between(label);
        if let Some(Slot { queries, begin, .. }) = slot {
            encoder.write_timestamp(queries, begin);
        }
        encoder.clear_buffer(buffer, 0, None);
        if let Some(Slot { queries, end, .. }) = slot {
            encoder.write_timestamp(queries, end);
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl Gpu {
    /// Where the pass `label` writes its times, if anybody wants them.
    fn slot(&self, label: &'static str) -> Option<Slot<'_>> {
        self.stopwatch.as_ref()?.slot(label)
    }

    /// The same for what is done between passes.
    fn slot_between(&self, label: &'static str) -> Option<Slot<'_>> {
        self.stopwatch.as_ref()?.slot_between(label)
    }
}

/// Nobody takes times in the page: nothing of this is left in its build.
#[cfg(target_arch = "wasm32")]
impl Gpu {
    const fn slot(&self, _: &'static str) -> Option<Slot<'_>> {
        None
    }

    const fn slot_between(&self, _: &'static str) -> Option<Slot<'_>> {
        None
    }
}
