//! Accessors: numbers of any component type, normalised or not, with stride and sparse replacements.

use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, buffer};

use super::document::Document;
use crate::import::error::ImportError;

/// An accessor's elements, packed without gaps.
struct Packed {
    bytes: Vec<u8>,
    component: ComponentType,
    normalised: bool,
    /// Components of an element.
    width: usize,
}

impl Document {
    /// Elements of `N` numbers each (`N` of 1, 2, 3, 4 or 16), normalised integers as 0 to 1 or -1 to 1.
    ///
    /// VEC4 is refused where three numbers are wanted, and so on; use [`Document::colours`] where both will do.
    pub fn floats<const N: usize>(&self, index: Index<Accessor>, user: &str) -> Result<Vec<[f32; N]>, ImportError> {
        let packed = self.packed(index, user)?;
        if packed.width != N {
            let reason = format!("accessor {index} ({user}) has {} numbers an element instead of {N}", packed.width);
            return Err(self.wrong(reason));
        }
        Ok(packed.numbers::<N>(0.0))
    }

    /// Colours with or without alpha.
    pub fn colours(&self, index: Index<Accessor>, user: &str) -> Result<Vec<[f32; 4]>, ImportError> {
        let packed = self.packed(index, user)?;
        match packed.width {
            3 | 4 => Ok(packed.numbers::<4>(1.0)),
            _ => Err(self.wrong(format!("accessor {index} ({user}) is no colour"))),
        }
    }

    /// Elements of `N` whole numbers each.
    pub fn whole_numbers<const N: usize>(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<Vec<[u32; N]>, ImportError> {
        let packed = self.packed(index, user)?;
        let unsigned = matches!(packed.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if packed.width != N || !unsigned {
            return Err(self.wrong(format!("accessor {index} ({user}) does not hold {N} whole numbers an element")));
        }
        let size = packed.component.size();
        let elements = packed.bytes.chunks_exact(size * N);
        Ok(elements
            .map(|element| {
                let mut numbers = [0; N];
                for (slot, bytes) in numbers.iter_mut().zip(element.chunks_exact(size)) {
                    *slot = whole(bytes);
                }
                numbers
            })
            .collect())
    }

    fn packed(&self, index: Index<Accessor>, user: &str) -> Result<Packed, ImportError> {
        let accessor = self.get(index, "accessor", user)?;
        let wrong = |reason: &str| self.wrong(format!("accessor {index} ({user}): {reason}"));
        let Checked::Valid(GenericComponentType(component)) = accessor.component_type else {
            return Err(wrong("unknown component type"));
        };
        let width = match accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            Checked::Valid(Type::Mat4) => 16,
            _ => return Err(wrong("unknown or unused element type")),
        };
        let size = component.size() * width;
        let count = usize::try_from(accessor.count.0).map_err(|_| wrong("too many elements"))?;
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let mut bytes = match accessor.buffer_view {
            Some(view) => self.gather(view, offset, count, size, user)?,
            // Zeros; a count that no buffer could back is a fault.
            None if count <= self.buffer_bytes().max(1 << 16) => vec![0; count * size],
            None => return Err(wrong("more elements than the buffers have bytes")),
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_type) = sparse.indices.component_type else {
                return Err(wrong("unknown type of sparse indices"));
            };
            let replaced = usize::try_from(sparse.count.0).map_err(|_| wrong("too many sparse elements"))?;
            let places = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
            let index_size = index_type.0.size();
            let places = self.gather(places.0, places.1, replaced, index_size, user)?;
            let values = self.gather(sparse.values.buffer_view, sparse.values.byte_offset.0, replaced, size, user)?;
            for (place, value) in places.chunks_exact(index_size).zip(values.chunks_exact(size)) {
                let place = whole(place) as usize;
                let slot = place.checked_mul(size).and_then(|at| bytes.get_mut(at..at + size));
                slot.ok_or_else(|| wrong("a sparse index is out of range"))?.copy_from_slice(value);
            }
        }
        Ok(Packed { bytes, component, normalised: accessor.normalized, width })
    }

    /// `count` elements of `size` bytes of a buffer view, without the gaps of its stride.
    fn gather(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        count: usize,
        size: usize,
        user: &str,
    ) -> Result<Vec<u8>, ImportError> {
        let bytes = self.view(view, user)?;
        let stride = self.get(view, "buffer view", user)?.byte_stride.map_or(size, |stride| stride.0.max(size));
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(start)),
        };
        if needed.is_none_or(|needed| needed > bytes.len()) {
            let reason = format!("{user}: {count} elements do not fit into buffer view {view}");
            return Err(ImportError::Truncated { path: self.path().to_owned(), reason });
        }
        let rest = bytes.get(start..).unwrap_or_default();
        if stride == size {
            return Ok(rest[..count * size].to_vec());
        }
        Ok(rest.chunks(stride).take(count).flat_map(|element| &element[..size]).copied().collect())
    }
}

impl Packed {
    /// Elements of `N` numbers; missing ones are `filling`.
    fn numbers<const N: usize>(&self, filling: f32) -> Vec<[f32; N]> {
        let size = self.component.size();
        let elements = self.bytes.chunks_exact(size * self.width);
        elements
            .map(|element| {
                let mut numbers = [filling; N];
                for (slot, bytes) in numbers.iter_mut().zip(element.chunks_exact(size)) {
                    *slot = self.number(bytes);
                }
                numbers
            })
            .collect()
    }

    /// The formulas of the glTF specification, section 3.6.2.2.
    fn number(&self, bytes: &[u8]) -> f32 {
        let raw = whole(bytes);
        let scaled = |value: f32, largest: f32| if self.normalised { (value / largest).max(-1.0) } else { value };
        match self.component {
            ComponentType::F32 => f32::from_bits(raw),
            ComponentType::U32 => raw as f32,
            ComponentType::U16 => scaled(raw as f32, 65535.0),
            ComponentType::I16 => scaled(f32::from(raw as i16), 32767.0),
            ComponentType::U8 => scaled(raw as f32, 255.0),
            ComponentType::I8 => scaled(f32::from(raw as i8), 127.0),
        }
    }
}

/// Up to four bytes, little endian.
fn whole(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
