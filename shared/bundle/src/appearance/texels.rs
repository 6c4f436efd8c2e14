//! Coding of the active texels: block by block, none, all or some; those of the last kind texel by texel.

use super::waves::Coder;
use crate::entropy::binary::Bit;
use texture::transform::SIDE;

/// Codes which of `width` × `height` texels are active: writes those `wanted`, or reads them and ignores `wanted`.
pub fn active(coder: &mut impl Coder, (width, height): (usize, usize), wanted: &[bool]) -> Vec<bool> {
    let mut texels = Texels { width, height, active: vec![false; width * height] };
    let wide = width.div_ceil(SIDE);
    let (mut some, mut all, mut shape) = ([Bit::default(); 9], [Bit::default(); 9], vec![Bit::default(); 64]);
    let mut kinds = vec![0; wide * height.div_ceil(SIDE)];
    for block in 0..kinds.len() {
        let (x, y) = (block % wide * SIDE, block / wide * SIDE);
        let (columns, rows) = (x..(x + SIDE).min(width), y..(y + SIDE).min(height));
        let inside = || rows.clone().flat_map(|y| columns.clone().map(move |x| y * width + x));
        let count = inside().filter(|&at| wanted.get(at) == Some(&true)).count();
        let left = if block % wide > 0 { kinds[block - 1] } else { 0 };
        let context = left * 3 + block.checked_sub(wide).map_or(0, |above| kinds[above]);
        kinds[block] = if !coder.bit(&mut all[context], count == inside().count()) {
            usize::from(coder.bit(&mut some[context], count > 0))
        } else {
            2
        };
        for at in inside().filter(|_| kinds[block] > 0) {
            let context = texels.context((at % width) as i32, (at / width) as i32);
            texels.active[at] = kinds[block] == 2 || coder.bit(&mut shape[context], wanted.get(at) == Some(&true));
        }
    }
    texels.active
}

struct Texels {
    width: usize,
    height: usize,
    active: Vec<bool>,
}

impl Texels {
    /// Which of the texels around, as far as they have been coded, are active.
    fn context(&self, x: i32, y: i32) -> usize {
        let at = |dx: i32, dy: i32| {
            let (x, y) = (x + dx, y + dy);
            let inside = (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y);
            inside && self.active[y as usize * self.width + x as usize]
        };
        [at(-1, 0), at(0, -1), at(-1, -1), at(1, -1), at(-2, 0), at(0, -2)]
            .into_iter()
            .fold(0, |context, bit| context << 1 | usize::from(bit))
    }
}
