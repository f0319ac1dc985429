//! Which SIMD instructions this processor has. No result depends on it: kernels use neither fused nor approximate
//! operations.

use fearless_simd::Level;
use std::sync::LazyLock;

static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Asked once, because asking is slow.
pub fn level() -> Level {
    *LEVEL
}

/// The name of the instructions chosen on this processor, as the library that dispatches to them calls it.
pub fn chosen() -> String {
    let name = format!("{:?}", level());
    name.split(['(', ' ']).next().unwrap_or_default().to_lowercase()
}
