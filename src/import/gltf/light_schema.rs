//! The parts of the JSON of glTF 2.0 that are lights.
//!
//! Source: KHR_lights_punctual and EXT_lights_ies.

use serde::Deserialize;
use serde_json::value::RawValue;

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Lights<'t> {
    #[serde(borrow)]
    pub(super) lights: Vec<&'t RawValue>,
}

#[derive(Deserialize)]
pub(super) struct NodeProfile {
    pub(super) light: usize,
    pub(super) multiplier: Option<f64>,
    pub(super) color: Option<[f64; 3]>,
}

/// A light profile in a file of its own, or in a view of a buffer.
#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Profile {
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct NodeLight {
    pub(super) light: usize,
}

#[derive(Deserialize)]
pub(super) struct Light {
    pub(super) name: Option<String>,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) color: Option<[f64; 3]>,
    pub(super) intensity: Option<f64>,
    pub(super) spot: Option<Spot>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Spot {
    pub(super) inner_cone_angle: Option<f64>,
    pub(super) outer_cone_angle: Option<f64>,
}
