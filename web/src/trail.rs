//! The path walked so far: a ribbon on the ground, mitred where it bends, fading with age.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// A point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrailPoint {
    /// The centre of mass on the ground (X, Z), metres.
    pub ground: Vec2,
    /// Whether the frame was synthesised.
    pub synthetic: bool,
    /// Begins a new piece: nothing joins it to the point before.
    pub starts: bool,
    /// When it was walked, in the player's seconds.
    pub time: f64,
}

/// Seconds after which the path has faded.
pub const MEMORY: f64 = 12.0;

/// A corner of the ribbon.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RibbonCorner {
    /// Place on the ground (X, Z).
    pub ground: [f32; 2],
    /// -1 at one edge, 1 at the other.
    pub side: f32,
    /// Opacity.
    pub alpha: f32,
    /// 1 where synthetic.
    pub synthetic: f32,
}

/// The ribbon of `points`, which are in order of time, `width` metres wide, as a triangle strip.
///
/// Points closer together than a third of the width are skipped, and so are pieces that stay within four widths of where
/// they begin; pieces are joined by triangles without area.
#[must_use]
pub fn ribbon<'a>(points: impl IntoIterator<Item = &'a TrailPoint>, now: f64, width: f32) -> Vec<RibbonCorner> {
    let mut pieces: Vec<Vec<TrailPoint>> = Vec::new();
    for point in points.into_iter().filter(|point| now - point.time < MEMORY) {
        match pieces.last_mut() {
            Some(piece) if !point.starts => {
                if piece.last().is_none_or(|last| last.ground.distance(point.ground) > width / 3.0) {
                    piece.push(*point);
                }
            }
            _ => pieces.push(vec![*point]),
        }
    }
    let mut strip = Vec::new();
    // A body that sways on the spot leaves no path.
    let leads_away =
        |piece: &&Vec<TrailPoint>| piece.iter().any(|point| piece[0].ground.distance(point.ground) > 4.0 * width);
    for piece in pieces.iter().filter(leads_away) {
        add_piece(&mut strip, piece, now, width);
    }
    strip
}

fn add_piece(strip: &mut Vec<RibbonCorner>, piece: &[TrailPoint], now: f64, width: f32) {
    for (index, point) in piece.iter().enumerate() {
        let before = piece.get(index.wrapping_sub(1)).unwrap_or(point).ground;
        let after = piece.get(index + 1).unwrap_or(point).ground;
        let along = |a: Vec2, b: Vec2| (b - a).normalize_or_zero();
        let (back, forth) = (along(before, point.ground), along(point.ground, after));
        let normal = (back + forth).normalize_or(Vec2::X).perp();
        // A mitre grows with the bend; a hairpin's would be endless.
        let straight = if back == Vec2::ZERO { forth } else { back };
        let stretch = 1.0 / normal.dot(straight.perp()).abs().max(0.5);
        let age = ((now - point.time) / MEMORY).clamp(0.0, 1.0) as f32;
        let corner = |side: f32| RibbonCorner {
            ground: (point.ground + normal * (side * stretch * width / 2.0)).to_array(),
            side,
            alpha: 0.85 * (1.0 - age) * (1.0 - age),
            synthetic: f32::from(u8::from(point.synthetic)),
        };
        if index == 0
            && let Some(&last) = strip.last()
        {
            strip.extend([last, corner(-1.0)]);
        }
        strip.extend([corner(-1.0), corner(1.0)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f32, z: f32, time: f64) -> TrailPoint {
        TrailPoint { ground: Vec2::new(x, z), synthetic: false, starts: false, time }
    }

    #[test]
    fn a_straight_path_is_as_wide_as_asked() {
        let points = [point(0.0, 0.0, 1.0), point(1.0, 0.0, 2.0), point(2.0, 0.0, 3.0)];
        let strip = ribbon(&points, 3.0, 0.1);
        assert_eq!(strip.len(), 6);
        for corners in strip.chunks(2) {
            let [a, b] = [corners[0], corners[1]].map(|corner| Vec2::from(corner.ground));
            assert!((a.distance(b) - 0.1).abs() < 1e-6);
        }
        assert!(strip[0].alpha < strip[4].alpha);
    }

    #[test]
    fn old_points_and_jumps_are_not_drawn() {
        let mut points = vec![point(0.0, 0.0, 0.0), point(1.0, 0.0, 20.0), point(2.0, 0.0, 20.5)];
        assert_eq!(ribbon(&points, 21.0, 0.1).len(), 4);
        points[2].starts = true;
        assert!(ribbon(&points, 21.0, 0.1).is_empty());
    }
}
