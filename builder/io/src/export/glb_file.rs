//! GLB: the binary chunk with the views and accessors into it, and the file around them.

use glam::Vec3;
use serde_json::{Value, json};

use super::bounds;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// The binary chunk with the views and accessors into it.
#[derive(Default)]
pub(super) struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Appends bytes as a view of their own; its index.
    pub fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset}));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    pub fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of positions or directions, with the bounds that glTF demands.
    pub fn positions(&mut self, positions: &[Vec3]) -> usize {
        let view = self.view(positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
        let (low, high) = bounds(positions);
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": positions.len(), "type": "VEC3",
            "min": low.to_array(), "max": high.to_array(),
        }))
    }

    /// An accessor of floats.
    pub fn floats(&mut self, values: &[f32], kind: &str, bounds: bool) -> usize {
        let view = self.view(values.iter().copied().flat_map(f32::to_le_bytes));
        let parts = match kind {
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 1,
        };
        let mut accessor =
            json!({"bufferView": view, "componentType": FLOAT, "count": values.len() / parts, "type": kind});
        if let (true, Some(first), Some(last)) = (bounds, values.first(), values.last()) {
            (accessor["min"], accessor["max"]) = (json!([first]), json!([last]));
        }
        self.accessor(accessor)
    }

    pub fn indices(&mut self, indices: impl IntoIterator<Item = u32>) -> usize {
        let indices: Vec<u32> = indices.into_iter().collect();
        let view = self.view(indices.iter().flat_map(|index| index.to_le_bytes()));
        let count = indices.len();
        self.accessor(json!({"bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"}))
    }

    /// Weights of `targets` at one keyframe more: all 0, but for target k - 1 at keyframe k.
    pub fn weights(&mut self, targets: usize) -> usize {
        let ones = (0..targets as u32).flat_map(|k| ((k + 1) * targets as u32 + k).to_le_bytes());
        let indices = self.view(ones);
        let values = self.view((0..targets).flat_map(|_| 1.0_f32.to_le_bytes()));
        self.accessor(json!({
            "componentType": FLOAT, "count": (targets + 1) * targets, "type": "SCALAR",
            "sparse": {
                "count": targets,
                "indices": {"bufferView": indices, "componentType": UNSIGNED_INT},
                "values": {"bufferView": values},
            },
        }))
    }

    /// The GLB: header, JSON, binary chunk.
    pub fn assemble(mut self, json: &Value) -> Vec<u8> {
        let mut document = json.clone();
        document["bufferViews"] = Value::Array(std::mem::take(&mut self.views));
        document["accessors"] = Value::Array(std::mem::take(&mut self.accessors));
        document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut glb = Vec::with_capacity(total);
        glb.extend(*b"glTF");
        for number in [2, total as u32, text.len() as u32] {
            glb.extend(number.to_le_bytes());
        }
        glb.extend(*b"JSON");
        glb.extend(text);
        glb.extend((self.bytes.len() as u32).to_le_bytes());
        glb.extend(*b"BIN\0");
        glb.extend(self.bytes);
        glb
    }
}
