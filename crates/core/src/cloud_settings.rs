//! How to read clouds of reconstructions: the `[reader.cloud]` table.

use serde::{Deserialize, Serialize};

/// What the properties of surfels mean, and which surfels count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CloudSettings {
    /// A surfel is there where its opacity is at least this; one that is nowhere is left out.
    pub min_opacity: f64,
    /// How `opacity` is written.
    pub opacity: OpacityScale,
    /// How `scale_0` and `scale_1` are written.
    pub scale: SizeScale,
}

/// How opacities are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OpacityScale {
    /// As the argument of a logistic function, as Gaussian splatting exports them.
    Logit,
    /// From 0 to 1.
    Linear,
}

/// How sizes are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SizeScale {
    /// As natural logarithms of metres, as Gaussian splatting exports them.
    Log,
    /// In metres.
    Metres,
}

impl Default for CloudSettings {
    fn default() -> Self {
        Self { min_opacity: 0.5, opacity: OpacityScale::Logit, scale: SizeScale::Log }
    }
}
