//! The header of a PLY file.

use std::path::Path;

use crate::import::error::ImportError;
use crate::import::text::{shorten, split_line, syntax};

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl NumberType {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A number, or a list of numbers, that every item of an element has.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub name: String,
    /// Type of the number, or of each number of the list.
    pub kind: NumberType,
    /// Type of the list's length; `None` for a single number.
    pub list_count: Option<NumberType>,
}

/// A table of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// Line of the header that announces it.
    pub line: usize,
}

/// How the tables are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What the header says.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Files named by `comment TextureFile`, as MeshLab writes them.
    pub textures: Vec<String>,
    /// Where the tables begin.
    pub body_start: usize,
}

/// No header is longer than this many lines.
const MAX_LINES: usize = 10_000;

impl Header {
    /// Reads the header of `bytes`; `path` is for messages.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, ImportError> {
        let mut header = Self { encoding: Encoding::Ascii, elements: Vec::new(), textures: Vec::new(), body_start: 0 };
        let mut format_given = false;
        // The first line shows how lines end; after end_header, a binary file may begin with any byte.
        let (first, rest) = split_line(bytes);
        if first.trim_ascii() != b"ply" {
            return Err(syntax(path, 1, "a PLY file begins with the line \"ply\""));
        }
        let ending = match bytes.get(first.len()..first.len() + 2) {
            Some(b"\r\n") | None => b'\n',
            Some(pair) if rest.is_some() => pair[0],
            Some(_) => b'\n',
        };
        for line in 1..MAX_LINES {
            let rest = bytes.get(header.body_start..).unwrap_or_default();
            let Some(length) = rest.iter().position(|&b| b == ending) else {
                let reason = "the header does not end with end_header".into();
                return Err(ImportError::Truncated { path: path.to_owned(), reason });
            };
            header.body_start += length + 1;
            let text = String::from_utf8_lossy(&rest[..length]);
            let text = text.trim();
            if line == 1 {
                continue;
            }
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            match words[..] {
                ["end_header"] if format_given => return Ok(header),
                ["end_header"] => return Err(syntax(path, line, "the header names no format")),
                ["format", encoding, _version] => {
                    format_given = true;
                    header.encoding = match encoding {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::LittleEndian,
                        "binary_big_endian" => Encoding::BigEndian,
                        _ => return Err(syntax(path, line, format!("unknown format \"{}\"", shorten(encoding)))),
                    };
                }
                ["comment", "TextureFile", ..] => {
                    let name = text.split_once("TextureFile").map_or("", |(_, name)| name).trim();
                    header.textures.push(name.to_owned());
                }
                ["comment" | "obj_info", ..] | [] => {}
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| syntax(path, line, "an element needs a count"))?;
                    let name = name.to_owned();
                    header.elements.push(Element { name, count, properties: Vec::new(), line });
                }
                ["property", ..] => header.property(&words[1..]).map_err(|reason| syntax(path, line, reason))?,
                _ => return Err(syntax(path, line, format!("\"{}\" is no PLY header line", shorten(text)))),
            }
        }
        Err(syntax(path, MAX_LINES, "the header does not end with end_header"))
    }

    fn property(&mut self, words: &[&str]) -> Result<(), String> {
        let element = self.elements.last_mut().ok_or("a property before any element")?;
        let kind = |name: &str| NumberType::parse(name).ok_or_else(|| format!("unknown type \"{}\"", shorten(name)));
        let property = match *words {
            ["list", count, item, name] => {
                Property { name: name.to_owned(), kind: kind(item)?, list_count: Some(kind(count)?) }
            }
            [item, name] => Property { name: name.to_owned(), kind: kind(item)?, list_count: None },
            _ => return Err("a property is \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"".into()),
        };
        element.properties.push(property);
        Ok(())
    }

    /// Number of vertices that the header announces.
    pub fn vertex_count(&self) -> u64 {
        let vertices = self.elements.iter().filter(|element| element.name == "vertex");
        vertices.map(|element| element.count).fold(0, u64::saturating_add)
    }

    /// Refuses counts that a file of `file_size` bytes cannot hold, before anything is read or reserved.
    pub fn check_size(&self, file_size: usize, path: &Path) -> Result<(), ImportError> {
        let available = (file_size - self.body_start.min(file_size)) as u64;
        let mut needed = 0_u64;
        for element in &self.elements {
            let item: u64 = match self.encoding {
                // A digit and a space; the last number of the file needs no space.
                Encoding::Ascii => 2 * element.properties.len() as u64,
                _ => element.properties.iter().map(|p| p.list_count.unwrap_or(p.kind).size() as u64).sum(),
            };
            needed = needed.saturating_add(item.saturating_mul(element.count));
            if needed > available.saturating_add(1) {
                let reason = format!("the header announces {} of element \"{}\"", element.count, element.name);
                return Err(ImportError::Truncated { path: path.to_owned(), reason });
            }
        }
        Ok(())
    }
}
