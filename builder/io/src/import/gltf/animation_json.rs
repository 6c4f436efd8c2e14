//! Animations as the file's JSON has them.

use gltf::json::accessor::Accessor;
use gltf::json::{Index, Value};
use serde::Deserialize;

/// An animation as the file's JSON has it.
#[derive(Debug, Default, Deserialize)]
pub(super) struct AnimationJson {
    pub name: Option<String>,
    #[serde(default)]
    pub channels: Vec<ChannelJson>,
    #[serde(default)]
    pub samplers: Vec<SamplerJson>,
}

#[derive(Debug, Deserialize)]
pub(super) struct ChannelJson {
    pub sampler: usize,
    pub target: TargetJson,
}

#[derive(Debug, Deserialize)]
pub(super) struct TargetJson {
    pub node: Option<usize>,
    #[serde(default)]
    pub path: String,
    #[serde(default)]
    pub extensions: Value,
}

#[derive(Debug, Deserialize)]
pub(super) struct SamplerJson {
    pub input: Index<Accessor>,
    pub output: Index<Accessor>,
    pub interpolation: Option<String>,
}
