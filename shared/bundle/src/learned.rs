//! The section of the learned space: the ways in which the actor was seen to move, as shares of recorded frames. Optional: without it
//! edits go by bones or by the surface alone.

use editing::space::{MOST_FRAMES, MOST_MODES, StoredMode, StoredSpace};

use super::entropy::binary::{Decoder, Encoder};
use super::entropy::numbers::Number;

/// What has been learnt about the numbers.
#[derive(Default)]
struct Models {
    count: Number,
    frame: Number,
    share: Number,
}

/// The section's bytes; `None` for what a reader would refuse.
pub(super) fn encode(space: &StoredSpace, frame_count: u32) -> Option<Vec<u8>> {
    space.check(frame_count).ok()?;
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    models.count.encode(&mut encoder, space.frames.len() as u32);
    models.count.encode(&mut encoder, space.modes.len() as u32);
    space.frames.iter().for_each(|&frame| models.frame.encode(&mut encoder, frame));
    for mode in &space.modes {
        [mode.variance, mode.step].iter().for_each(|number| encoder.raw(number.to_bits(), 32));
        mode.shares.iter().for_each(|&share| models.share.encode_signed(&mut encoder, share.into()));
    }
    Some(encoder.finish())
}

/// Reads the section.
///
/// # Errors
/// The reason where it holds no space over this many frames.
pub fn decode(bytes: &[u8], frame_count: u32) -> Result<StoredSpace, &'static str> {
    let (mut decoder, mut models) = (Decoder::new(bytes), Models::default());
    let [frames, modes] = [(); 2].map(|()| models.count.decode(&mut decoder) as usize);
    if frames > MOST_FRAMES || modes > MOST_MODES {
        return Err("has too many modes");
    }
    let mut space = StoredSpace { frames: Vec::with_capacity(frames), modes: Vec::with_capacity(modes) };
    space.frames.extend((0..frames).map(|_| models.frame.decode(&mut decoder)));
    for _ in 0..modes {
        let [variance, step] = [(); 2].map(|()| f32::from_bits(decoder.raw(32)));
        let share = |_| i16::try_from(models.share.decode_signed(&mut decoder));
        let shares = (1..frames).map(share).collect::<Result<_, _>>().map_err(|_| "has a share beyond all steps")?;
        space.modes.push(StoredMode { variance, step, shares });
    }
    if decoder.exhausted() {
        return Err("ends too early");
    }
    if !decoder.at_end() {
        return Err("has bytes left over, or too few");
    }
    space.check(frame_count).map(|()| space)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> StoredSpace {
        let mode =
            |k: i16| StoredMode { variance: 0.1 / f32::from(k), step: 1e-3, shares: vec![2047, -30 * k, k, -2047] };
        StoredSpace { frames: vec![7, 0, 90, 4, 5], modes: (1..5).map(mode).collect() }
    }

    #[test]
    fn spaces_come_back() {
        let bytes = encode(&space(), 91).unwrap();
        assert_eq!(decode(&bytes, 91).as_ref(), Ok(&space()));
        assert!(decode(&bytes, 90).unwrap_err().contains("frame"));
        assert_eq!(encode(&space(), 90), None);
    }

    #[test]
    fn damage_is_found_or_gives_another_space() {
        let bytes = encode(&space(), 91).unwrap();
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length], 91).is_err(), "{length} bytes");
        }
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                if let Ok(other) = decode(&damaged, 91) {
                    assert_eq!(other.check(91), Ok(()));
                }
            }
        }
        let mut longer = bytes;
        longer.push(0);
        assert!(decode(&longer, 91).is_err());
    }
}
