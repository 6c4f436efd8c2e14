//! The simplest of numpy's files: arrays of little-endian 32-bit floats or integers in C order.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// An array and its shape.
pub struct Array<T> {
    pub shape: Vec<usize>,
    pub values: Vec<T>,
}

/// A kind of number that can be read and written.
pub trait Number: Copy {
    const KIND: &'static str;
    fn from_bytes(bytes: [u8; 4]) -> Self;
    fn bytes(self) -> [u8; 4];
}

impl Number for f32 {
    const KIND: &'static str = "<f4";
    fn from_bytes(bytes: [u8; 4]) -> Self {
        Self::from_le_bytes(bytes)
    }
    fn bytes(self) -> [u8; 4] {
        self.to_le_bytes()
    }
}

impl Number for u32 {
    const KIND: &'static str = "<u4";
    fn from_bytes(bytes: [u8; 4]) -> Self {
        Self::from_le_bytes(bytes)
    }
    fn bytes(self) -> [u8; 4] {
        self.to_le_bytes()
    }
}

/// Reads an array of this kind of number.
pub fn read<T: Number>(path: impl AsRef<Path>) -> Result<Array<T>> {
    let path = path.as_ref();
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let length = bytes.get(8..10).context("not a .npy file")?;
    let header = 10 + usize::from(u16::from_le_bytes([length[0], length[1]]));
    let text = std::str::from_utf8(bytes.get(10..header).context("not a .npy file")?)?;
    if !text.contains(T::KIND) || text.contains("'fortran_order': True") {
        bail!("{} must hold {} in C order, not {text}", path.display(), T::KIND);
    }
    let shape = text.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(')')).context("no shape")?.0;
    let shape = shape.split(',').map(str::trim).filter(|part| !part.is_empty()).map(str::parse);
    let values = bytes[header..].chunks_exact(4).map(|b| T::from_bytes([b[0], b[1], b[2], b[3]])).collect();
    Ok(Array { shape: shape.collect::<Result<_, _>>()?, values })
}

/// Writes an array.
pub fn write<T: Number>(path: impl AsRef<Path>, shape: &[usize], values: impl Iterator<Item = T>) -> Result<()> {
    let shape: String = shape.iter().map(|side| format!("{side},")).collect();
    let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({shape}), }}", T::KIND);
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.flat_map(T::bytes));
    fs::write(path.as_ref(), bytes).with_context(|| format!("cannot write {}", path.as_ref().display()))
}
