//! Filters over decoded attributes (appendix B).

use super::Filter;

/// Applies `filter` to elements of `stride` bytes, in place.
pub(super) fn apply(bytes: &mut [u8], filter: Filter, stride: usize) {
    match (filter, stride) {
        (Filter::None, _) => {}
        (Filter::Octahedral, 4) => each_of_bytes(bytes, |v| octahedral(v.map(|x| i32::from(x as i8)), 127.0)),
        (Filter::Octahedral, _) => each_of_words(bytes, |v| octahedral(v.map(|x| i32::from(x as i16)), 32767.0)),
        (Filter::Quaternion, _) => each_of_words(bytes, |v| quaternion(v.map(|x| i32::from(x as i16)))),
        (Filter::Exponential, _) => bytes.chunks_exact_mut(4).for_each(|float| {
            let packed = i32::from_le_bytes([float[0], float[1], float[2], float[3]]);
            // Out of -100..=100 the text leaves the result open; what is too large for a float becomes infinite, and
            // the reader of the numbers refuses it.
            let value = f64::from(packed << 8 >> 8) * f64::from(packed >> 24).exp2();
            float.copy_from_slice(&(value as f32).to_le_bytes());
        }),
        (Filter::Colour, 4) => each_of_bytes(bytes, |[y, co, cg, a]| {
            colour([i32::from(y), i32::from(co as i8), i32::from(cg as i8), i32::from(a)], 255.0)
        }),
        (Filter::Colour, _) => each_of_words(bytes, |[y, co, cg, a]| {
            colour([i32::from(y), i32::from(co as i16), i32::from(cg as i16), i32::from(a)], 65535.0)
        }),
    }
}

fn each_of_bytes(bytes: &mut [u8], filter: impl Fn([u8; 4]) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(4) {
        let filtered = filter([element[0], element[1], element[2], element[3]]);
        element.copy_from_slice(&filtered.map(|x| x as u8));
    }
}

fn each_of_words(bytes: &mut [u8], filter: impl Fn([u16; 4]) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(8) {
        let word = |k: usize| u16::from_le_bytes([element[2 * k], element[2 * k + 1]]);
        let filtered = filter([word(0), word(1), word(2), word(3)]);
        for (slot, value) in element.chunks_exact_mut(2).zip(filtered) {
            slot.copy_from_slice(&(value as u16).to_le_bytes());
        }
    }
}

/// Filter 1: x and y on an octahedron, what stands for 1, and a number that passes through.
fn octahedral([x, y, one, last]: [i32; 4], largest: f32) -> [i32; 4] {
    let (mut x, mut y) = (x as f32 / one as f32, y as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    let below = z.min(0.0);
    x -= below.copysign(x);
    y -= below.copysign(y);
    let length = (x * x + y * y + z * z).sqrt();
    let scaled = |c: f32| (c / length * largest).round() as i32;
    [scaled(x), scaled(y), scaled(z), last]
}

/// Filter 2: three components of a unit quaternion, times the square root of 2; what stands for 1, and in its two
/// lowest bits which component is left out.
fn quaternion([x, y, z, one_and_largest]: [i32; 4]) -> [i32; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / (one_and_largest | 3) as f32;
    let [x, y, z] = [x, y, z].map(|c| c as f32 * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let left_out = (one_and_largest & 3) as usize;
    let mut out = [0; 4];
    for (k, c) in [w, x, y, z].into_iter().enumerate() {
        out[(left_out + k) % 4] = (c * 32767.0).round() as i32;
    }
    out
}

/// Filter 4: luma, two chromas, and an alpha whose highest set bit says how many bits all have.
fn colour([y, co, cg, alpha]: [i32; 4], largest: f32) -> [i32; 4] {
    let most = if alpha == 0 { 1 } else { (1 << (alpha.ilog2() + 1)) - 1 };
    let a = alpha & (most >> 1);
    let scale = largest / most as f32;
    [y + co - cg, y + cg, y - co - cg, a << 1 | a & 1].map(|c| (c as f32 * scale).round().clamp(0.0, largest) as i32)
}
