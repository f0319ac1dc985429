//! SIMD instructions of this processor. No result depends on them: kernels use neither fused nor
//! approximate operations.

use fearless_simd::Level;
use std::sync::LazyLock;

static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Returns the best SIMD level of this processor. Detected once, because detection is slow.
pub fn level() -> Level {
    *LEVEL
}

/// Returns the name of the SIMD level, as `fearless_simd` calls it.
pub fn chosen() -> String {
    let name = format!("{:?}", level());
    name.split(['(', ' ']).next().unwrap_or_default().to_lowercase()
}
