//! Aligning all textures to the reference, and the warps back (thesis section 4.4.1, figure 4.3).

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::AppearanceError;
use super::charts::Charts;
use super::flow::{FlowGrid, FlowOptions, Prepared};
use super::gaps::Gaps;
use super::prepare::prepare;
use super::reference;
use super::textures::{Texture, TextureSource};
use super::warp::{TextureWarper, WarpMethod};
use job::Job;
use job::work::{Key, WorkFolder};
use learn::store::Store;

/// Colours of aligned textures may overshoot 0 to 1 a little.
const COLOUR_RANGE: f32 = 2.0;
/// Warps longer than this many texels are cut off.
pub(super) const WARP_RANGE: f32 = 128.0;

/// How textures are aligned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlignOptions {
    /// How flows are found.
    pub flow: FlowOptions,
    /// How textures are moved. [`build`](fn@super::build) moves them directly: what Poisson reconstruction keeps of their detail, the
    /// fit that follows brings back, too (docs/appearance.md), and it took two thirds of the time of aligning.
    pub warping: WarpMethod,
}

/// All frames' textures, aligned, and the warps from them back to the textures as captured.
#[derive(Debug)]
pub struct Aligned {
    /// The atlas.
    pub charts: Charts,
    /// What moves textures over it.
    pub warper: TextureWarper,
    /// The frame that the others are aligned to.
    pub reference: usize,
    /// Aligned textures, a row a frame: three values per active texel.
    pub textures: Store,
    /// Backward warps, a row a frame: two values per active texel.
    pub warps: Store,
    /// The frames that were seen in full.
    pub complete: Vec<usize>,
    /// What the others miss, by frames.
    pub incomplete: Vec<Incomplete>,
    /// What was not seen.
    pub gaps: Gaps,
    /// Where results are kept, and what this was made from.
    pub kept: Option<(WorkFolder, Key)>,
}

/// Changes whenever textures are aligned otherwise.
const VERSION: u32 = 2;

impl Aligned {
    /// Active texels that are unknown in a frame's texture.
    #[must_use]
    pub fn unseen(&self, frame: usize) -> &[u32] {
        match self.incomplete.binary_search_by_key(&frame, |incomplete| incomplete.frame) {
            Ok(index) => &self.incomplete[index].unseen,
            Err(_) => &[],
        }
    }
}

/// A frame with texels that were not seen; active texels are numbered in row-major order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Incomplete {
    /// The frame.
    pub frame: usize,
    /// Active texels that are unknown in its texture.
    pub unseen: Vec<u32>,
    /// Active texels that are unknown in its aligned texture.
    pub unseen_aligned: Vec<u32>,
}

impl Incomplete {
    /// As it is kept, without its frame.
    fn to_bytes(&self) -> Vec<u8> {
        let count = [self.unseen.len() as u32];
        count.iter().chain(&self.unseen).chain(&self.unseen_aligned).flat_map(|number| number.to_le_bytes()).collect()
    }

    fn from_bytes(frame: usize, bytes: &[u8]) -> Option<Self> {
        let mut numbers = bytes.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
        let count = numbers.next()? as usize;
        let unseen: Vec<u32> = numbers.by_ref().take(count).collect();
        (unseen.len() == count).then(|| Self { frame, unseen, unseen_aligned: numbers.collect() })
    }
}

/// The frame that the others are aligned to, as it was found before or is now.
fn chosen_reference(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    complete: &[usize],
    kept: Option<&(WorkFolder, Key)>,
) -> Result<usize, AppearanceError> {
    let Some((work, key)) = kept else { return reference::choose(source, charts, complete) };
    let key = key.part("reference", 0);
    let known = work.get(&key).and_then(|bytes| bytes.try_into().ok()).map(|bytes| u64::from_le_bytes(bytes) as usize);
    if let Some(known) = known.filter(|known| complete.contains(known)) {
        return Ok(known);
    }
    let reference = reference::choose(source, charts, complete)?;
    work.put(&key, &(reference as u64).to_le_bytes()).map_err(|source| AppearanceError::Work { source })?;
    Ok(reference)
}

/// Aligns the textures of `source`, a frame at a time on each thread.
///
/// # Errors
/// Textures that cannot be read, fewer than one complete frame, or no room for a scratch file.
pub fn align(
    source: &(impl TextureSource + ?Sized),
    charts: &Charts,
    options: &AlignOptions,
    job: &Job,
) -> Result<Aligned, AppearanceError> {
    let frames = source.frame_count();
    job.begin("reading textures")?;
    let gaps = Gaps::find(source, charts)?;
    let complete = gaps.complete();
    if complete.is_empty() {
        return Err(AppearanceError::NoCompleteFrames { frames });
    }
    job.begin("reference texture")?;
    let kept = match job.work() {
        Some(work) => {
            let labels = charts.labels.iter().flat_map(|label| label.to_le_bytes()).collect::<Vec<u8>>();
            let key = Key::new("appearance", VERSION).told(options).told(&(charts.width, charts.height)).of(&labels);
            Some((work.clone(), source.named(key)?))
        }
        None => None,
    };
    let reference = chosen_reference(source, charts, &complete, kept.as_ref())?;
    let grid = FlowGrid::new(charts, options.flow);
    let warper = TextureWarper::new(charts);
    let part = |name, number| kept.as_ref().map(|(work, key)| (work, key.part(name, number)));
    let opened = |name, columns, range| {
        let place = part(name, 0);
        Store::kept(place.as_ref().map(|(work, key)| (*work, key)), frames, columns, range)
    };
    let textures = opened("aligned textures", 3 * warper.texel_count(), COLOUR_RANGE)?;
    let warps = opened("backward warps", 2 * warper.texel_count(), WARP_RANGE)?;
    let template = grid.prepare(&prepare(&source.read(reference)?, &charts.labels), None);
    let done = AtomicU64::new(0);
    let one = |frame: usize| -> Result<Option<Incomplete>, AppearanceError> {
        let done = || job.tell("aligning textures", 1 + done.fetch_add(1, Ordering::Relaxed), frames as u64);
        let of_frame = part("incomplete", frame as u64);
        if textures.has(frame) && warps.has(frame) {
            let known = match (gaps.of(frame), &of_frame) {
                (None, _) => Some(None),
                (Some(_), Some((work, key))) => {
                    work.get(key).and_then(|bytes| Incomplete::from_bytes(frame, &bytes)).map(Some)
                }
                (Some(_), None) => None,
            };
            if let Some(known) = known {
                done()?;
                return Ok(known);
            }
        }
        let mut texture = source.read(frame)?;
        texture.hidden = gaps.of(frame).cloned();
        let moved = Moved::new(&texture, charts, &grid, &warper, &template, options.warping);
        textures.write(frame, &moved.aligned)?;
        warps.write(frame, &moved.backward)?;
        if let (Some(incomplete), Some((work, key))) = (&moved.incomplete, &of_frame) {
            work.put(key, &incomplete.to_bytes()).map_err(|source| AppearanceError::Work { source })?;
        }
        done()?;
        Ok(moved.incomplete.map(|incomplete| Incomplete { frame, ..incomplete }))
    };
    let results: Vec<_> = (0..frames).into_par_iter().map(one).collect();
    let mut incomplete = Vec::new();
    for result in results {
        incomplete.extend(result?);
    }
    Ok(Aligned { charts: charts.clone(), warper, reference, textures, warps, complete, incomplete, gaps, kept })
}

/// One texture, aligned.
struct Moved {
    aligned: Vec<f32>,
    backward: Vec<f32>,
    incomplete: Option<Incomplete>,
}

impl Moved {
    fn new(
        texture: &Texture,
        charts: &Charts,
        grid: &FlowGrid,
        warper: &TextureWarper,
        template: &Prepared,
        how: WarpMethod,
    ) -> Self {
        let values = prepare(texture, &charts.labels);
        let seen: Option<Vec<bool>> =
            texture.hidden.as_ref().map(|hidden| hidden.iter().map(|hidden| !hidden).collect());
        let own = grid.prepare(&values, seen.as_deref());
        let forward = warper.compact(&grid.flow(template, &own));
        let mut colours = colours(texture, charts);
        let texels = charts.texels();
        let unseen: Vec<u32> = match &texture.hidden {
            Some(hidden) => (0..texels.len() as u32).filter(|&k| hidden[texels[k as usize] as usize]).collect(),
            None => Vec::new(),
        };
        warper.fill(&mut colours, &unseen);
        let aligned = warper.warp(&colours, 3, &forward, how);
        // The flow back starts from the inverse of the flow there, which is all but right.
        let inverse = warper.inverse(&forward);
        let mut brightness: Vec<f32> = texels.iter().map(|&texel| values[texel as usize]).collect();
        brightness = warper.warp(&brightness, 1, &forward, WarpMethod::Direct);
        let mut whole = vec![0.0; values.len()];
        texels.iter().zip(&brightness).for_each(|(&texel, &value)| whole[texel as usize] = value);
        let there = grid.prepare(&whole, None);
        let backward = warper.compact(&grid.refine(&own, &there, &warper.spread(&inverse)));
        let incomplete = (!unseen.is_empty()).then(|| {
            let mut hidden = vec![0.0; texels.len()];
            unseen.iter().for_each(|&k| hidden[k as usize] = 1.0);
            let moved = warper.warp(&hidden, 1, &forward, WarpMethod::Direct);
            let unseen_aligned = (0..moved.len() as u32).filter(|&k| moved[k as usize] > 1e-3).collect();
            Incomplete { frame: 0, unseen, unseen_aligned }
        });
        Self { aligned, backward, incomplete }
    }
}

/// The colours of active texels, 0 to 1, sRGB-encoded.
#[must_use]
pub fn colours(texture: &Texture, charts: &Charts) -> Vec<f32> {
    let active = texture.colours.iter().zip(&charts.labels).filter(|(_, label)| **label != 0);
    active.flat_map(|(colour, _)| colour.map(|c| f32::from(c) / 255.0)).collect()
}
