//! A texture on one level of the pyramid.

#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub value: Vec<f32>,
    /// Derivative to the right, within charts.
    pub across: Vec<f32>,
    /// Derivative downwards.
    pub along: Vec<f32>,
    /// 1 where the texel was seen; everything where nothing is given.
    pub seen: Option<Vec<f32>>,
}
