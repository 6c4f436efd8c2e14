//! What stands in for `gltf` where this crate is built without the feature of that name: no such file opens.

use std::path::Path;

use glam::{Mat4, Vec3};

use super::bones::Moved;
use super::error::ImportError;
use super::mesh::FileMesh;
use super::warning::Warning;

/// A glTF file, of which there is none.
pub(super) enum GltfFile {}

impl GltfFile {
    /// # Errors
    /// Always.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let told = "this program was compiled without glTF; cargo build --release -p reprise-builder compiles one that reads it";
        Err(ImportError::UnknownFormat { path: path.to_owned(), told })
    }

    pub fn path(&self) -> &Path {
        match *self {}
    }

    pub fn warnings(&self) -> &[Warning] {
        match *self {}
    }

    pub fn clip_names(&self) -> Vec<String> {
        match *self {}
    }

    pub fn frame_count(&self, _clip: usize, _fps: f32) -> u64 {
        match *self {}
    }

    pub fn mesh(&self) -> &FileMesh {
        match *self {}
    }

    pub fn rate_warning(&self, _clip: usize, _fps: f32) -> Option<Warning> {
        match *self {}
    }

    pub fn moved(&self) -> Moved {
        match *self {}
    }

    pub fn world(&self, _clip: usize, _fps: f64, _frame: usize) -> Vec<Mat4> {
        match *self {}
    }

    pub fn pose(&self, _clip: usize, _fps: f64, _frame: usize) -> Result<Vec<Vec3>, ImportError> {
        match *self {}
    }
}
