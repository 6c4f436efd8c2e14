//! The header of a vologram: which frames follow, and what each holds.
//!
//! | version | after the four letters |
//! |---|---|
//! | all | version x 10, compression; up to 1.2 three names and the topology; number of frames |
//! | 1.1, 1.2 | whether there are normals, textures; width, height and format of textures (16 bits each) |
//! | 1.2 | translation (3 numbers), rotation (4), scale |
//! | 1.3 | whether there are normals, textures; compression and container of textures; width, height; rate; sound, where it lies, where frames begin |

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// The longest header: three names of 255 bytes each, and numbers.
const LONGEST: u64 = 1024;

/// What a header says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    /// Ten times the version: 13 is 1.3.
    pub version: u32,
    pub frame_count: u32,
    /// Whether frames hold normals.
    pub normals: bool,
    /// Whether frames hold textures.
    pub textured: bool,
    pub pictures: Pictures,
    pub fps: Option<f32>,
    pub sound: bool,
    /// Whether it moves, turns or scales the body.
    pub placed: bool,
    /// Where frames begin, in bytes, where they lie in the header's own file.
    pub body: u64,
}

/// How the frames' textures are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pictures {
    /// Not in the frames: as a video beside them, or nowhere.
    None,
    /// Basis Universal: `.basis` or KTX2.
    Basis,
    /// Something else.
    Other(&'static str),
}

/// Reads the header that the file begins with.
pub(super) fn read(path: &Path) -> Result<Header, String> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(LONGEST).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    parse(&bytes)
}

/// Reads a header.
fn parse(bytes: &[u8]) -> Result<Header, String> {
    let mut rest = Rest(bytes);
    // As four letters, or as a text that says its length first.
    let magic = if bytes.first() == Some(&b'V') { rest.bytes(4) } else { rest.text() };
    if magic != Some(b"VOLS") {
        return Err("it does not begin like a vologram".into());
    }
    let mut header = rest.header().ok_or_else(|| "its header is cut short".to_owned())??;
    if header.body == 0 {
        header.body = (bytes.len() - rest.0.len()) as u64;
    }
    Ok(header)
}

/// Bytes that are still to be read.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.0.split_at_checked(count)?;
        self.0 = tail;
        Some(head)
    }

    /// A text of at most 255 bytes.
    fn text(&mut self) -> Option<&'a [u8]> {
        let length = self.byte()?;
        self.bytes(length.into())
    }

    fn byte(&mut self) -> Option<u8> {
        self.bytes(1).map(|bytes| bytes[0])
    }

    fn word(&mut self) -> Option<u32> {
        self.bytes(4)?.try_into().ok().map(u32::from_le_bytes)
    }

    fn number(&mut self) -> Option<f32> {
        self.word().map(f32::from_bits)
    }

    /// What follows the letters; `None` where it is cut short.
    fn header(&mut self) -> Option<Result<Header, String>> {
        let version = self.word()?;
        if !(10..=13).contains(&version) {
            let (major, minor) = (version / 10, version % 10);
            return Some(Err(format!("it is of version {major}.{minor}: 1.0 to 1.3 are read")));
        }
        if self.word()? != 0 {
            return Some(Err("its meshes are compressed, which is not read: write them uncompressed".into()));
        }
        if version < 13 {
            for _name in 0..3 {
                self.text()?;
            }
            let topology = self.word()?;
            if topology != 0 {
                return Some(Err(format!("its faces are of kind {topology}, where triangles (0) are read")));
            }
        }
        let mut header = Header {
            version,
            frame_count: self.word()?,
            normals: false,
            textured: false,
            pictures: Pictures::None,
            fps: None,
            sound: false,
            placed: false,
            body: 0,
        };
        if version >= 11 {
            (header.normals, header.textured) = (self.byte()? != 0, self.byte()? != 0);
        }
        match version {
            10 => {}
            13 => self.newest(&mut header)?,
            _ => self.older(&mut header)?,
        }
        Some(Ok(header))
    }

    /// What versions 1.1 and 1.2 have besides.
    fn older(&mut self, header: &mut Header) -> Option<()> {
        // Width, height and format of textures.
        self.bytes(6)?;
        if header.textured {
            header.pictures = Pictures::Other("plain pixels");
        }
        if header.version == 12 {
            let mut numbers = [0.0; 8];
            for number in &mut numbers {
                *number = self.number()?;
            }
            header.placed = numbers != [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        }
        Some(())
    }

    /// What version 1.3 has besides.
    fn newest(&mut self, header: &mut Header) -> Option<()> {
        let (compression, container) = (self.byte()?, self.byte()?);
        // Width and height of textures.
        self.bytes(8)?;
        let fps = self.number()?;
        header.fps = Some(fps).filter(|fps| fps.is_finite() && *fps > 0.0);
        header.sound = self.word()? != 0;
        self.word()?;
        header.body = self.word()?.into();
        header.pictures = match (header.textured, compression, container) {
            (false, ..) => Pictures::None,
            (true, 1 | 2, 1 | 2) => Pictures::Basis,
            (true, 0, _) => Pictures::Other("a video"),
            _ => Pictures::Other("of a kind that is not known"),
        };
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read_as_they_are_written() {
        let mut bytes = b"VOLS".to_vec();
        for word in [13_u32, 0, 250] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend([1, 1, 2, 2]);
        for word in [512, 256, 29.97_f32.to_bits(), 1, 44, 1000] {
            bytes.extend(word.to_le_bytes());
        }
        assert_eq!(bytes.len(), 44);
        let header = parse(&bytes).unwrap();
        assert_eq!((header.version, header.frame_count, header.body), (13, 250, 1000));
        assert!(header.normals && header.textured && header.sound && !header.placed);
        assert_eq!((header.pictures, header.fps), (Pictures::Basis, Some(29.97)));
        for length in 0..bytes.len() {
            assert!(parse(&bytes[..length]).is_err());
        }
        bytes[4] = 20;
        assert_eq!(parse(&bytes).unwrap_err(), "it is of version 2.0: 1.0 to 1.3 are read");
    }

    #[test]
    fn older_headers_say_less() {
        let mut bytes = b"\x04VOLS".to_vec();
        for word in [10_u32, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(b"\x04body\x00\x05cloth");
        for word in [0_u32, 7] {
            bytes.extend(word.to_le_bytes());
        }
        let header = parse(&bytes).unwrap();
        assert_eq!((header.frame_count, header.normals, header.body), (7, false, bytes.len() as u64));
    }
}
