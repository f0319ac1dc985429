//! Which SIMD instructions this processor has. No result depends on it: kernels use neither fused nor approximate
//! operations.

use fearless_simd::Level;
use std::sync::LazyLock;

static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Asked once, because asking is slow.
pub fn level() -> Level {
    *LEVEL
}
