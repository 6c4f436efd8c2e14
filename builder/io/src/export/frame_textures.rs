//! The textures of frames as files beside them.

use rayon::prelude::*;
use synthesis::FrameKind;

use super::Actor;
use super::error::ExportError;
use super::materials::png;
use super::output::{FramePattern, write_whole};
use job::Job;

/// Textures that are rebuilt at once: each takes some 150 bytes a texel meanwhile.
pub(super) const AT_ONCE: usize = 8;

/// Writes the texture of each of the frames `kinds` beside it; none where textures do not change.
pub(super) fn write_frame_textures(
    actor: &Actor,
    pattern: &FramePattern,
    kinds: &[FrameKind],
    job: &Job,
) -> Result<(), ExportError> {
    let Some(textures) = &actor.textures else { return Ok(()) };
    let total = kinds.len() as u64;
    for (batch, kinds) in kinds.chunks(AT_ONCE).enumerate() {
        let first = batch * AT_ONCE;
        job.tell("textures", first as u64, total)?;
        let write = |(k, &kind): (usize, &FrameKind)| {
            let file = pattern.folder.join(pattern.companion((first + k) as u32, "_texture.png"));
            write_whole(&file, &png(&textures.of_frame(kind), &file)?)
        };
        kinds.par_iter().enumerate().map(write).collect::<Result<(), _>>()?;
    }
    Ok(())
}
