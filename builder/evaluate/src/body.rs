//! The parts of the body in a report: a picture in which each has its colour, and what they are.

use actor::capture::Capture;
use actor::motion::Motion;
use glam::Vec3;
use image::{ImageError, RgbaImage, imageops};
use kernels::topology::barycentric_areas;
use parts::{Limb, Parts, Shape};

use super::clay::{self, Camera};
use super::document::{Cell, Picture, SectionReport, Table};

/// Frames from which the one that is shown is chosen.
const LOOKED_AT: usize = 40;
/// Width and height of one view in pixels.
const VIEW: [u32; 2] = [260, 380];
/// From where the body is looked at, beside its front, in radians: from the front, and from behind.
const VIEWS: [f32; 2] = [0.35, 0.35 + std::f32::consts::PI];
/// Colours of parts, the torso's first; where there are more parts they come again.
const COLOURS: [(&str, [f32; 3]); 9] = [
    ("grey", [0.62, 0.60, 0.57]),
    ("red", [0.78, 0.08, 0.06]),
    ("blue", [0.05, 0.22, 0.70]),
    ("yellow", [0.86, 0.60, 0.03]),
    ("green", [0.06, 0.44, 0.14]),
    ("violet", [0.36, 0.10, 0.58]),
    ("orange", [0.85, 0.28, 0.02]),
    ("turquoise", [0.02, 0.50, 0.52]),
    ("pink", [0.85, 0.25, 0.45]),
];

/// The section; `painted` has the number of each vertex's part, where parts were painted.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn section(capture: &Capture, painted: Option<&[u8]>) -> Result<SectionReport, ImageError> {
    let parts = match painted {
        Some(numbers) => Parts::of_painted(&capture.topology, &capture.poses, numbers),
        None => Parts::find(&capture.topology, &capture.poses),
    };
    let mut section = SectionReport::new(0, "Parts of the body");
    section.text.push(told(&parts));
    section.tables.push(table(capture, &parts));
    section.pictures.push(picture(capture, &parts)?);
    Ok(section)
}

fn told(parts: &Parts) -> String {
    let how = if parts.painted.is_empty() { "found from the shape and how it moves" } else { "painted" };
    let broken = parts.limbs.iter().filter(|limb| !limb.is_disc).count();
    let limbs = match (parts.limbs.len(), broken) {
        (0, _) => return format!("One part, {how}: builder transfer learns this body as a whole."),
        (_, 0) => "all limbs are discs, all bands cylinders".into(),
        (_, broken) => format!("{broken} are not a disc with one band, as limbs are"),
    };
    format!(
        "A torso{} and {} limbs, {how}; {limbs}. builder transfer learns each by itself; in bands they overlap. Other parts can be painted: \
         the key parts of the manifest (docs/capture-manifest.md).",
        if parts.head.is_some() { " with the head" } else { "" },
        parts.limbs.len()
    )
}

fn table(capture: &Capture, parts: &Parts) -> Table {
    let caption = "Each part's colour, its share of the surface, how far its end is from the middle of its band along the surface, the \
                   band's width, and whether the limb is a disc and its band a cylinder.";
    let columns = ["part", "colour", "surface %", "length m", "band cm", "limb", "band"];
    let mut table = Table::new("body_parts", caption, &columns);
    let triangles = capture.topology.triangles();
    let areas = barycentric_areas(triangles, capture.poses.frame(0));
    let total: f32 = areas.iter().sum::<f32>().max(f32::MIN_POSITIVE);
    for part in 0..parts.count() {
        let own: f32 = parts.weights(part).iter().zip(&areas).map(|(weight, area)| weight * area).sum();
        let name = match (part.checked_sub(1), parts.painted.get(part)) {
            (_, Some(number)) => format!("painted {number}"),
            (None, None) => "torso".into(),
            (Some(limb), None) => format!("limb {}", limb + 1),
        };
        let mut row: Vec<Cell> =
            vec![name.into(), COLOURS[part % COLOURS.len()].0.into(), Cell::Number(f64::from(100.0 * own / total), 1)];
        row.extend(match part.checked_sub(1) {
            Some(limb) => measures(&parts.limbs[limb], triangles),
            None => std::array::from_fn(|_| Cell::Empty),
        });
        table.rows.push(row);
    }
    table
}

fn measures(limb: &Limb, triangles: &[[u32; 3]]) -> [Cell; 4] {
    let [whole, band] = limb.shapes(triangles);
    let name = |shape: Shape| match shape {
        Shape::DISC => "disc".to_owned(),
        Shape::CYLINDER => "cylinder".to_owned(),
        Shape { pieces: 0, .. } => "none".to_owned(),
        Shape { characteristic, loops, pieces } => format!("{pieces} pieces, {loops} loops, \u{3c7} {characteristic}"),
    };
    [
        Cell::Number(f64::from(limb.hinge), 3),
        Cell::Number(f64::from(200.0 * limb.half_band), 1),
        name(whole).into(),
        name(band).into(),
    ]
}

/// The body from the front and from behind, each part in its colour, mixed in bands.
fn picture(capture: &Capture, parts: &Parts) -> Result<Picture, ImageError> {
    let colour = |part: usize| Vec3::from_array(COLOURS[part % COLOURS.len()].1);
    let mixed = |vertex: usize| (0..parts.count()).map(|part| colour(part) * parts.weights(part)[vertex]).sum::<Vec3>();
    let colours: Vec<Vec3> = (0..capture.topology.vertex_count()).map(mixed).collect();
    let frame = spread(capture, parts);
    let pose = capture.poses.frame(frame);
    let motion = Motion::measure(&capture.timeline, capture.topology.weights(), &mut capture.poses.clone());
    let facing = motion.map_or(0.0, |motion| motion.facings[frame as usize]);
    let size = [VIEW[0] * VIEWS.len() as u32, VIEW[1]];
    let mut both = RgbaImage::new(size[0], size[1]);
    for (k, view) in (0..).zip(VIEWS) {
        let camera = Camera::framing(pose, VIEW, facing + view);
        let drawn = clay::draw(pose, capture.topology.triangles(), &colours, &camera);
        imageops::replace(&mut both, &drawn, i64::from(k * VIEW[0]), 0);
    }
    let caption = "The parts, from the front and from behind; bands mix their colours.".into();
    Ok(Picture { png: clay::png(&both)?, size, caption })
}

/// The frame in which the ends of limbs are farthest apart.
fn spread(capture: &Capture, parts: &Parts) -> u32 {
    let frames = capture.poses.len();
    let apart = |frame: u32| {
        let pose = capture.poses.frame(frame);
        let tips: Vec<Vec3> = parts.limbs.iter().map(|limb| pose[limb.tip as usize]).collect();
        tips.iter().flat_map(|a| tips.iter().map(|b| a.distance(*b))).sum::<f32>()
    };
    let chosen = (0..LOOKED_AT.min(frames)).map(|k| (k * frames / LOOKED_AT.min(frames)) as u32);
    chosen.map(|frame| (apart(frame), frame)).max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, frame)| frame)
}
