//! Transitions against the truth: the built-in performer knows the textures between two of its frames.

use std::collections::BTreeMap;
use std::path::Path;

use actor::blend::Blend;
use actor::timeline::Timeline;
use image::{ImageError, Rgb, RgbImage, imageops};

use crate::document::{Agreement, Cell, Picture, SectionReport, Table, Verdict};
use crate::plot::{Plot, Series, SeriesStyle};
use crate::textures::ghosting::{AgainstTruth, Row, Truth, Way, Worst};
use appearance::Charts;
use appearance::textures::{Texture, TextureSource};
use performer::between::{self, Between};
use performer::perform::takes;

/// A texture that is made again may differ by this, in units of an 8-bit colour, on average: other processors round
/// otherwise.
const ROUNDING: f64 = 0.1;
/// Texels along a side of what the pictures show, at 256 texels.
const CROP: usize = 48;
/// Pixels along a side of a picture.
const PICTURE: usize = 384;

/// The pairs of frames that are blended in the middle of transitions between different sequences.
pub(super) fn pairs(blends: &[Vec<Blend>], timeline: &Timeline) -> Vec<[usize; 2]> {
    let middle = |blends: &Vec<Blend>| {
        let off = |blend: &Blend| (blend.lambda - 0.5).abs();
        let blend = blends.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let [from, to] = blend.frames.map(|frame| timeline.sequence_index(frame));
        (from != to).then(|| blend.frames.map(|frame| frame as usize))
    };
    let mut pairs: Vec<[usize; 2]> = blends.iter().filter_map(middle).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// A performance that was made again.
pub(super) struct Performed {
    between: Between,
    /// Its frames by those of the capture.
    numbers: BTreeMap<usize, usize>,
}

impl Performed {
    /// The performance of the capture whose first texture is `texture`, for the frames of `pairs`.
    ///
    /// # Errors
    /// Why there is none, as a sentence.
    pub(super) fn again(
        texture: &Path,
        source: &impl TextureSource,
        charts: &Charts,
        timeline: &Timeline,
        pairs: &[[usize; 2]],
    ) -> Result<Self, String> {
        let folder =
            texture.parent().and_then(Path::parent).ok_or("there is no folder of truth beside its textures")?;
        let folder = folder.join("truth");
        if !folder.join("capture.json").is_file() {
            return Err("only the built-in performer knows what lies between two frames".into());
        }
        let options = between::options(&folder)?;
        if source.size() != (options.texture_size as u32, options.texture_size as u32) {
            return Err(format!("its textures do not have the {0} x {0} texels of the truth", options.texture_size));
        }
        let takes = takes(options.frames, options.fps, options.seed);
        let mut numbers = BTreeMap::new();
        for sequence in timeline.sequences() {
            let take = takes.iter().find(|take| take.name == sequence.name);
            let take = take.filter(|take| take.frames == sequence.frame_count as usize);
            let take = take.ok_or_else(|| format!("the truth has no sequence like {}", sequence.name))?;
            numbers.extend((0..take.frames).map(|k| (sequence.first_frame as usize + k, take.first_frame + k)));
        }
        let frames: Vec<usize> = pairs.as_flattened().iter().filter_map(|frame| numbers.get(frame)).copied().collect();
        let performed = Self { between: Between::new(&options, &frames), numbers };
        performed.check(source, charts, timeline, pairs)?;
        Ok(performed)
    }

    /// Compares one frame of each sequence with its texture as captured.
    fn check(
        &self,
        source: &impl TextureSource,
        charts: &Charts,
        timeline: &Timeline,
        pairs: &[[usize; 2]],
    ) -> Result<(), String> {
        let by_sequence: BTreeMap<Option<usize>, usize> =
            pairs.as_flattened().iter().map(|&frame| (timeline.sequence_index(frame as u32), frame)).collect();
        for frame in by_sequence.into_values() {
            let captured = source.read(frame).map_err(|error| error.to_string())?.colours;
            let again = self.numbers.get(&frame).and_then(|&number| self.between.recorded(number)).unwrap_or_default();
            let texels = charts.texels();
            let off: f64 = texels
                .iter()
                .flat_map(|&texel| {
                    let (a, b) = (captured.get(texel as usize), again.get(texel as usize));
                    let (a, b) = (a.copied().unwrap_or([0; 3]), b.copied().unwrap_or([255; 3]));
                    [0, 1, 2].map(|channel| f64::from(a[channel].abs_diff(b[channel])))
                })
                .sum();
            let off = off / (3 * texels.len().max(1)) as f64;
            if off > ROUNDING {
                return Err(format!(
                    "frame {frame}, performed again, differs from its texture by {off:.2} of 255 on average: another \
                     version of the performer wrote the capture, or its textures were changed"
                ));
            }
        }
        Ok(())
    }

    fn numbers(&self, frames: [usize; 2]) -> Option<[usize; 2]> {
        Some([*self.numbers.get(&frames[0])?, *self.numbers.get(&frames[1])?])
    }
}

impl Truth for Performed {
    fn between(&self, frames: [usize; 2], lambda: f32) -> Option<Texture> {
        let colours = self.between.texture(self.numbers(frames)?, lambda)?;
        let size = self.between.size() as u32;
        Some(Texture { width: size, height: size, colours, hidden: None })
    }

    fn slides(&self, frames: [usize; 2]) -> Option<Vec<f32>> {
        self.between.slides(self.numbers(frames)?)
    }
}

/// Adds what was found to the section.
pub(super) fn write(found: &AgainstTruth, charts: &Charts, section: &mut SectionReport) -> Result<(), ImageError> {
    if found.pairs == 0 {
        section.text.push(
            "No transition between different sequences blends two frames without gaps: none is compared with the truth."
                .into(),
        );
        return Ok(());
    }
    section.tables.push(table(found));
    section.agreements.extend(agreement(found));
    section.plots.extend(plots(found));
    if let Some(worst) = &found.worst {
        section.pictures.extend(pictures(worst, charts)?);
    }
    Ok(())
}

fn name(way: Way) -> &'static str {
    match way {
        Way::Eigen => "ours",
        Way::Stored => "ours stored",
        Way::FadeCaptured => "cross-fade of captured",
        Way::FadeStored => "cross-fade of ours stored",
    }
}

fn table(found: &AgainstTruth) -> Table {
    let mut columns: Vec<String> =
        ["from first to second", "slide, texels", "share of texels", "mean slide"].map(String::from).into();
    for way in Way::ALL {
        columns.extend(["SSIM", "MSE", "sharpness"].map(|value| format!("{}, {value}", name(way))));
    }
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut table = Table::new(
        "appearance_ghosting_truth",
        format!(
            "Textures in {} transitions between different sequences, drawn from the graph, against the truth: what the \
             performer paints at the interpolated drift in the interpolated light. By how far each texel\u{2019}s surface has \
             slid from one frame to the other. At 0 nothing is blended: that is what the model costs. Ours: 50 components, \
             coefficients interpolated, Poisson reconstruction. Stored: as the player shows it. A cross-fade of captured \
             textures has the captured textures at its ends, that of ours stored is what the page compares with. MSE times \
             10,000; sharpness is the mean gradient over that of the truth, below 1 is blur.",
            found.pairs
        ),
        &columns,
    );
    for row in &found.rows {
        let slides = match row.slides {
            None => "all".to_owned(),
            Some([from, to]) if to.is_finite() => format!("{from} to {to}"),
            Some([from, _]) => format!("{from} or more"),
        };
        let mut line = vec![Cell::Number(f64::from(row.lambda), 2), slides.into()];
        line.extend([Cell::Number(row.share, 3), Cell::Number(row.slide, 2)]);
        for way in &row.ways {
            let (quality, sharpness) = (way.quality, way.sharpness);
            line.extend([
                Cell::Number(quality.ssim, 4),
                Cell::Number(quality.mse * 1e4, 3),
                Cell::Number(sharpness, 3),
            ]);
        }
        table.rows.push(line);
    }
    table
}

/// Rows half way, by class of slide.
fn classes(found: &AgainstTruth) -> impl Iterator<Item = &Row> {
    found.rows.iter().filter(|row| row.lambda == 0.5 && row.slides.is_some())
}

fn agreement(found: &AgainstTruth) -> Option<Agreement> {
    let all = found.rows.iter().find(|row| row.lambda == 0.5 && row.slides.is_none())?;
    let far = classes(found).last()?;
    let [_, ours, _, fade] = far.ways;
    let [_, ours_all, _, fade_all] = all.ways;
    let better = |a: f64, b: f64| a > b;
    Some(Agreement {
        papers:
            "In transitions interpolated coefficients do not ghost, blended textures do (TVCG figure 21): against the \
                 truth, as the player shows both."
                .into(),
        found: format!(
            "Where textures slid by {:.1} texels: SSIM {:.4} against {:.4}, sharpness {:.3} against {:.3}; everywhere \
             SSIM {:.4} against {:.4}.",
            far.slide,
            ours.quality.ssim,
            fade.quality.ssim,
            ours.sharpness,
            fade.sharpness,
            ours_all.quality.ssim,
            fade_all.quality.ssim
        ),
        verdict: Verdict::of(
            better(ours.quality.ssim, fade.quality.ssim),
            better(ours.quality.ssim, fade.quality.ssim) && better(ours_all.quality.ssim, fade_all.quality.ssim),
        ),
        why: String::new(),
    })
}

fn plots(found: &AgainstTruth) -> Vec<Plot> {
    let series = |value: fn(&Row, usize) -> f64| -> Vec<Series> {
        let points = |way: usize| classes(found).map(|row| (row.slide, value(row, way))).collect();
        (0..).zip(Way::ALL).map(|(at, way)| Series::new(name(way), SeriesStyle::DottedLine, at, points(at))).collect()
    };
    let plot = |y: &str, series| Plot {
        caption: "Half way in transitions, against the truth".into(),
        x: "slide, texels".into(),
        y: y.into(),
        series,
        ..Plot::default()
    };
    vec![
        plot("SSIM", series(|row, way| row.ways[way].quality.ssim)),
        plot("sharpness", series(|row, way| row.ways[way].sharpness)),
    ]
}

/// The part of the textures where ghosts would show most, enlarged: the truth, ours and the cross-fade.
fn pictures(worst: &Worst, charts: &Charts) -> Result<Vec<Picture>, ImageError> {
    let side = (CROP * charts.width.max(charts.height) / 256).clamp(16, charts.width.min(charts.height).max(16));
    let corner = busiest(worst, charts, side);
    let [_, stored, captured, faded] = &worst.ways;
    let [a, b] = worst.frames;
    let place = format!(
        "half way from frame {a} to frame {b}, whose textures slid furthest apart ({:.2} texels on average); {side} x {side} \
         texels from column {}, row {}",
        worst.slide, corner.0, corner.1
    );
    let shown = [
        (&worst.truth, "The truth"),
        (stored, "Ours, as stored"),
        (faded, "Cross-fade of ours, as stored"),
        (captured, "Cross-fade of the captured textures"),
    ];
    let picture = |(colours, what): (&Vec<f32>, &str)| -> Result<Picture, ImageError> {
        let mut image = RgbImage::from_pixel(charts.width as u32, charts.height as u32, Rgb([128; 3]));
        for (&texel, colour) in charts.texels().iter().zip(colours.chunks_exact(3)) {
            let bytes = [0, 1, 2].map(|channel| (colour[channel].clamp(0.0, 1.0) * 255.0).round() as u8);
            image.put_pixel(texel % charts.width as u32, texel / charts.width as u32, Rgb(bytes));
        }
        let crop = imageops::crop_imm(&image, corner.0, corner.1, side as u32, side as u32).to_image();
        let times = PICTURE.div_ceil(side).max(1) as u32;
        let size = [crop.width() * times, crop.height() * times];
        let large = imageops::resize(&crop, size[0], size[1], imageops::FilterType::Nearest);
        let mut png = std::io::Cursor::new(Vec::new());
        large.write_to(&mut png, image::ImageFormat::Png)?;
        Ok(Picture { png: png.into_inner(), size, caption: format!("{what}, {place}.") })
    };
    shown.into_iter().map(picture).collect()
}

/// The corner of the square of `side` texels with the most slide times gradient of the truth, whoever comes closer there.
fn busiest(worst: &Worst, charts: &Charts, side: usize) -> (u32, u32) {
    let (width, height) = (charts.width, charts.height);
    let mut plane = vec![0.0; width * height];
    let texels = charts.texels();
    for (k, pair) in texels.windows(2).enumerate().filter(|(_, pair)| pair[1] == pair[0] + 1) {
        let steep: f32 = (3 * k..3 * k + 3).map(|i| (worst.truth[i + 3] - worst.truth[i]).abs()).sum();
        let slide = worst.slides[k];
        plane[pair[0] as usize] = if slide.is_finite() { f64::from(steep * slide) } else { 0.0 };
    }
    let step = (side / 4).max(1);
    let mut best = ((0, 0), f64::NEG_INFINITY);
    for y in (0..=height.saturating_sub(side)).step_by(step) {
        for x in (0..=width.saturating_sub(side)).step_by(step) {
            let rows = y..(y + side).min(height);
            let sum: f64 =
                rows.map(|y| plane[y * width + x..y * width + (x + side).min(width)].iter().sum::<f64>()).sum();
            if sum > best.1 {
                best = ((x as u32, y as u32), sum);
            }
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use actor::timeline::Sequence;

    use super::*;
    use appearance::textures::TextureFiles;
    use performer::{Artefacts, PerformerOptions, write_performer};

    #[test]
    fn no_truth_is_better_than_a_wrong_one() {
        let folder = tempfile::tempdir().unwrap();
        let size = 128;
        let options = PerformerOptions {
            frames: 20,
            vertices: 1500,
            texture_size: size,
            artefacts: Artefacts::ALL,
            ..PerformerOptions::default()
        };
        let summary = write_performer(&options, folder.path(), &|_| {}).unwrap();
        let (mut sequences, mut paths) = (Vec::new(), Vec::new());
        for (name, count) in &summary.sequences {
            let first_frame = paths.len() as u32;
            paths.extend((0..*count).map(|k| folder.path().join(format!("{name}/texture_{k:05}.png"))));
            let (name, frame_count) = (name.clone(), *count as u32);
            sequences.push(Sequence { name, labels: Vec::new(), first_frame, frame_count, cyclic: false });
        }
        let first = paths[0].clone();
        let files = TextureFiles::new(paths, Vec::new()).unwrap();
        let charts = Charts::whole(size, size);
        let timeline = Timeline::new(options.fps, sequences.clone()).unwrap();
        let pairs = [[0, 19], [5, 12]];
        let again = |timeline: &Timeline| Performed::again(&first, &files, &charts, timeline, &pairs);
        let performed = again(&timeline).unwrap();
        assert_eq!(performed.between([5, 12], 0.5).unwrap().colours.len(), size * size);
        assert!(performed.between([5, 11], 0.5).is_none(), "frame 11 is in no pair");

        sequences[1].name = "another".into();
        let other = Timeline::new(options.fps, sequences).unwrap();
        assert!(again(&other).err().unwrap().contains("no sequence like another"));
        let path = folder.path().join("truth/capture.json");
        let text = std::fs::read_to_string(&path).unwrap();
        let wrong = text.replace("\"seed\":1", "\"seed\":2");
        assert_ne!(wrong, text);
        std::fs::write(&path, wrong).unwrap();
        assert!(again(&timeline).err().unwrap().contains("differs from its texture"));
        std::fs::write(&path, text.replace("\"texture_size\":128", "\"texture_size\":256")).unwrap();
        assert!(again(&timeline).err().unwrap().contains("do not have the 256 x 256 texels"));
        std::fs::remove_file(&path).unwrap();
        assert!(again(&timeline).err().unwrap().contains("only the built-in performer"));
    }
}
