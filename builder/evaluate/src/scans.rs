//! The page of `builder register`: figures of all frames, the tree, how unlike frames are, and the worst ones as pictures.

use capture_io::import::{ImportError, ImportOptions, ScannedFrame, scans};
use geometry::kd::KdTree;
use glam::Vec3;
use image::{ImageError, Rgba, RgbaImage};
use reprise::scans::{FrameReport, OtherReport, RegisterReport};
use thiserror::Error;

use crate::clay::{Camera, draw, png};
use crate::document::{Cell, Document, Picture, SectionReport, Table};
use crate::plot::{Plot, Series, SeriesStyle};

/// Frames shown as pictures.
const SHOWN: usize = 6;
/// Pixels of a picture.
const SIZE: [u32; 2] = [260, 360];
/// A surface this far off is drawn red, metres.
const RED: f32 = 0.01;
/// The side of a matrix is at least as many pixels.
const MATRIX: usize = 300;

/// Why there is no page.
#[derive(Debug, Error)]
pub enum ScanPageError {
    /// A frame cannot be read again.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// A picture cannot be encoded.
    #[error(transparent)]
    Picture(#[from] ImageError),
}

/// The page about a scan that was registered: `inputs` and `import` are what it was read from.
///
/// # Errors
/// Frames that cannot be read again.
pub fn scan_page(
    report: &RegisterReport,
    inputs: &[String],
    import: &ImportOptions,
) -> Result<Document, ScanPageError> {
    let fact = |name: &str, value: String| (name.to_owned(), value);
    let facts = vec![
        fact("Frames", format!("{} of {}", report.registered.len(), report.frames)),
        fact("Template", format!("frame {}", report.template)),
        fact("Mesh", format!("{} vertices, {} triangles", report.vertices, report.triangles)),
        fact("Textures", report.texture_size.map_or("none".into(), |size| format!("{size} x {size}"))),
    ];
    Ok(Document {
        title: format!("{}, registered", report.name),
        lead: "One mesh was moved through all frames of the scan. No figure here tells a surface that only slid along itself: \
               look at the textures of the capture for that."
            .into(),
        facts,
        sections: vec![frames(report), order(report)?, worst(report, inputs, import)?],
    })
}

fn frames(report: &RegisterReport) -> SectionReport {
    let of = |name: &str, colour, value: fn(&FrameReport) -> f64| {
        let points = report.registered.iter().map(|frame| (frame.frame as f64, value(frame))).collect();
        Series::new(name, SeriesStyle::Line, colour, points)
    };
    let plot = |caption: &str, y: &str, series| Plot {
        caption: caption.into(),
        x: "frame".into(),
        y: y.into(),
        series,
        marks: Vec::new(),
        equal: false,
        from_zero: true,
    };
    let columns = [
        "frame",
        "tracked from",
        "uncovered %",
        "scan off mm",
        "beyond %",
        "template off mm",
        "farthest mm",
        "stretch",
        "tries",
    ];
    let mut table = Table::new("registered", "All frames that were registered", &columns);
    table.rows = report
        .registered
        .iter()
        .map(|frame| {
            vec![
                Cell::Count(frame.frame as u64),
                frame.parent.map_or(Cell::Empty, |parent| Cell::Count(parent as u64)),
                Cell::Number(100.0 * frame.uncovered, 2),
                Cell::Number(1000.0 * frame.rms_backward, 2),
                Cell::Number(100.0 * frame.beyond, 2),
                Cell::Number(1000.0 * frame.rms_forward, 2),
                Cell::Number(1000.0 * frame.hausdorff, 1),
                Cell::Number(frame.stretch, 3),
                Cell::Count(frame.tries as u64),
            ]
        })
        .collect();
    let mut lost = Table::new("lost", "Frames that are not part of the capture", &["frame", "why"]);
    lost.rows = report.lost.iter().map(|lost| vec![lost.place.clone().into(), lost.reason.clone().into()]).collect();
    let mut section = SectionReport::new(1, "Frames");
    section.plots = vec![
        plot(
            "How far scan and template are apart",
            "mm",
            vec![
                of("scan to template", 0, |frame| 1000.0 * frame.rms_backward),
                of("template to scan", 1, |frame| 1000.0 * frame.rms_forward),
            ],
        ),
        plot(
            "Surface more than a centimetre off",
            "%",
            vec![
                of("of the scan", 0, |frame| 100.0 * frame.uncovered),
                of("of the template: webs, for the most part", 1, |frame| 100.0 * frame.beyond),
            ],
        ),
    ];
    section.tables = if report.lost.is_empty() { vec![table] } else { vec![lost, table] };
    section.tables.extend(joined(report));
    section.tables.extend((!report.others.is_empty()).then(|| others(report)));
    section
}

/// Frames that were brought onto the mesh through another template; none where there are none.
fn joined(report: &RegisterReport) -> Option<Table> {
    let caption = "Frames that were brought onto the mesh through another template, which they were tracked with";
    let mut table = Table::new("joined", caption, &["frame", "through the mesh of frame", "carried from frame"]);
    let row = |frame: &FrameReport| {
        let (through, parent) = (frame.through?, frame.parent?);
        Some([frame.frame, through, parent].map(|number| Cell::Count(number as u64)).to_vec())
    };
    table.rows = report.registered.iter().filter_map(row).collect();
    (!table.rows.is_empty()).then_some(table)
}

/// Frames that have a mesh of their own.
fn others(report: &RegisterReport) -> Table {
    let columns = ["template", "vertices", "frames", "first", "last", "most uncovered %", "written as"];
    let mut table =
        Table::new("others", "Frames that have a mesh of their own, and are no part of the capture", &columns);
    let count = |number: usize| Cell::Count(number as u64);
    let row = |other: &OtherReport| {
        let frames = &other.registered;
        let number = |frame: Option<&FrameReport>| frame.map_or(Cell::Empty, |frame| count(frame.frame));
        let most = frames.iter().map(|frame| frame.uncovered).fold(0.0, f64::max);
        let folder = other.manifest.as_ref().and_then(|manifest| manifest.parent());
        vec![
            count(other.template),
            count(other.vertices),
            count(frames.len()),
            number(frames.first()),
            number(frames.last()),
            Cell::Number(100.0 * most, 2),
            folder.map_or(Cell::Empty, |folder| folder.display().to_string().into()),
        ]
    };
    table.rows = report.others.iter().map(row).collect();
    table
}

fn order(report: &RegisterReport) -> Result<SectionReport, ImageError> {
    let mut section = SectionReport::new(2, "Order");
    let edges = report.registered.iter().filter_map(|frame| Some((frame.parent? as f64, frame.frame as f64)));
    section.plots = vec![Plot {
        caption: "Which frame each was tracked from; beside the diagonal lie frames that follow each other".into(),
        x: "frame".into(),
        y: "tracked from".into(),
        series: vec![Series::new(
            "frames",
            SeriesStyle::Dots,
            0,
            edges.map(|(parent, frame)| (frame, parent)).collect(),
        )],
        marks: Vec::new(),
        equal: true,
        from_zero: true,
    }];
    section.pictures = matrix(report)?.into_iter().collect();
    Ok(section)
}

/// The dissimilarities as a picture: dark is alike.
fn matrix(report: &RegisterReport) -> Result<Option<Picture>, ImageError> {
    let count = report.compared.len();
    let (low, high) = report.dissimilarity.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &d| (l.min(d), h.max(d)));
    if count == 0 {
        return Ok(None);
    }
    let cell = MATRIX.div_ceil(count);
    let side = (count * cell) as u32;
    let picture = RgbaImage::from_fn(side, side, |x, y| {
        let at = report.dissimilarity[y as usize / cell * count + x as usize / cell];
        let grey = ((at - low) / (high - low).max(1e-12) * 255.0) as u8;
        Rgba([grey, grey, grey, 255])
    });
    let caption = "How unlike frames are, all pairs: dark is alike".into();
    Ok(Some(Picture { png: png(&picture)?, size: [side, side], caption }))
}

/// The frames that fit worst: scan and template, red where the other one is a centimetre off.
fn worst(report: &RegisterReport, inputs: &[String], import: &ImportOptions) -> Result<SectionReport, ScanPageError> {
    let mut section = SectionReport::new(3, "Worst frames");
    section.text =
        vec!["Left the scan, right the template on it; red is a centimetre or more away from the other.".into()];
    let before = scans(inputs, import)?;
    let after = scans(&[report.manifest.to_string_lossy().into_owned()], &ImportOptions::default())?;
    // Frames of the capture by their files, for some of the scan's may be missing.
    let place = |frame: usize| -> Option<usize> {
        let (sequence, number) = before.place_of(frame)?;
        let wanted = format!("{sequence:03}/frame_{number:05}.ply");
        let files = after.sequences.iter().flat_map(|sequence| &sequence.files);
        files.into_iter().position(|file| file.ends_with(&wanted))
    };
    let mut frames: Vec<&FrameReport> = report.registered.iter().collect();
    frames.sort_by(|a, b| b.uncovered.total_cmp(&a.uncovered).then(a.frame.cmp(&b.frame)));
    for frame in frames.into_iter().take(SHOWN) {
        let Some(written) = place(frame.frame) else { continue };
        let (scan, template) = (before.read(frame.frame)?, after.read(written)?);
        let camera = Camera::framing(&template.positions, SIZE, 0.0);
        let pictures = [clay(&scan, &template, &camera), clay(&template, &scan, &camera)];
        let both = RgbaImage::from_fn(2 * SIZE[0], SIZE[1], |x, y| {
            *pictures[(x / SIZE[0]) as usize].get_pixel(x % SIZE[0], y)
        });
        let caption = format!("frame {}: {:.2} % uncovered", frame.frame, 100.0 * frame.uncovered);
        section.pictures.push(Picture { png: png(&both)?, size: [2 * SIZE[0], SIZE[1]], caption });
    }
    Ok(section)
}

/// `frame` as clay, by its vertices' distances to those of `other`.
fn clay(frame: &ScannedFrame, other: &ScannedFrame, camera: &Camera) -> RgbaImage {
    let tree = KdTree::new(&other.positions.iter().map(Vec3::to_array).collect::<Vec<_>>());
    let colour = |p: &Vec3| {
        let off = tree.nearest(p.to_array(), f32::INFINITY).map_or(f32::INFINITY, |(_, squared)| squared.sqrt());
        // Vertices lie apart on a surface that fits, too.
        let red = ((off / RED - 1.0) / 2.0).clamp(0.0, 1.0);
        Vec3::new(0.8, 0.78, 0.75).lerp(Vec3::new(0.85, 0.15, 0.1), red)
    };
    let colours: Vec<Vec3> = frame.positions.iter().map(colour).collect();
    draw(&frame.positions, &frame.triangles, &colours, camera)
}
