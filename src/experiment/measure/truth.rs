//! The converged picture of a view, kept on disk: it takes long, and the same one is asked for again and again.

use crate::camera::{Camera, View};
use crate::raster::save::{SaveError, write_atomically};
use crate::render::{Mode, RenderSettings, Renderer};
use crate::trace::parallel::Stop;
use crate::trace::{RayCounts, TraceSettings, Tracer};
use glam::Vec3;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// First bytes of a kept truth.
const MAGIC: &[u8; 8] = b"AITRUTH1";

/// Magic, key, width, height; a digest follows the pixels.
const HEADER: usize = 8 + 32 + 8;

/// Pixels traced anew to see that a kept truth is still what this program would trace. A change of the tracer or a
/// machine that rounds otherwise is found out at once; the cost is a ten-thousandth of a picture.
const PROBES: u32 = 64;

/// What a truth is of.
#[derive(Clone, Copy, Debug)]
pub struct TruthRequest<'a> {
    /// The scene.
    pub tracer: &'a Tracer,
    /// The pose.
    pub camera: &'a Camera,
    /// Of the picture.
    pub size: [u32; 2],
    /// Of the truth itself: many samples, a seed of its own.
    pub settings: TraceSettings,
}

/// The linear radiance of a converged picture, from `folder` where it is kept, else traced and kept there. A folder
/// that cannot be written to costs time, not the result: the error comes beside the picture.
///
/// `None` after a stop.
pub fn truth(
    request: &TruthRequest<'_>,
    folder: Option<&Path>,
    stop: Stop<'_>,
) -> Option<(Vec<Vec3>, Option<SaveError>)> {
    let key = request.key();
    let path = folder.map(|f| f.join(format!("{}.truth", hex(&key))));
    if let Some(kept) = path.as_deref().and_then(|p| read(p, &key, request.size))
        && request.agrees_with(&kept)
    {
        return Some((kept, None));
    }
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode: Mode::Full, trace: request.settings };
    let frame = renderer.render(request.tracer, request.camera, request.size, &settings, &[], stop);
    if !frame.stats.is_complete {
        return None;
    }
    let radiance = frame.radiance.clone();
    let error = path.and_then(|path| write(path, &key, request.size, &radiance).err());
    Some((radiance, error))
}

impl TruthRequest<'_> {
    /// SHA-256 of all that decides the picture.
    fn key(&self) -> [u8; 32] {
        let c = self.camera;
        let pose = [c.eye.x, c.eye.y, c.eye.z, c.yaw, c.pitch, c.fov_y].map(f64::to_bits);
        let version = env!("CARGO_PKG_VERSION");
        let (scene, size, settings) = (&self.tracer.scene().hash, self.size, self.settings);
        let mut sha = Sha256::new();
        sha.update(format!("{version} {scene} {pose:?} {size:?} {settings:?}"));
        sha.finalize().into()
    }

    fn agrees_with(&self, kept: &[Vec3]) -> bool {
        let view = View::new(self.camera, &self.tracer.scene().frame, self.size);
        let count = view.pixel_count() as u32;
        (0..PROBES.min(count)).all(|i| {
            let pixel = (u64::from(i) * u64::from(count) / u64::from(PROBES.min(count))) as u32;
            let traced = self.tracer.pixel(&view, pixel, &self.settings, &mut RayCounts::default());
            traced.radiance == kept[pixel as usize]
        })
    }
}

fn write(path: PathBuf, key: &[u8; 32], size: [u32; 2], radiance: &[Vec3]) -> Result<(), SaveError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|cause| SaveError::Write { path: folder.to_owned(), cause })?;
    }
    let mut bytes = Vec::with_capacity(HEADER + size_of_val(radiance) + 32);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(key);
    size.iter().for_each(|s| bytes.extend_from_slice(&s.to_le_bytes()));
    radiance.iter().flat_map(|v| v.to_array()).for_each(|c| bytes.extend_from_slice(&c.to_le_bytes()));
    let digest = Sha256::digest(&bytes);
    bytes.extend_from_slice(&digest);
    write_atomically(&path, &bytes)
}

/// The pixels of a kept truth; `None` where there is none, or a damaged one, or one of something else.
fn read(path: &Path, key: &[u8; 32], size: [u32; 2]) -> Option<Vec<Vec3>> {
    let bytes = std::fs::read(path).ok()?;
    let count = size[0] as usize * size[1] as usize;
    if bytes.len() != HEADER + count * 12 + 32 {
        return None;
    }
    let (content, digest) = bytes.split_at(bytes.len() - 32);
    let sizes: Vec<u8> = size.iter().flat_map(|s| s.to_le_bytes()).collect();
    let is_ours = content.starts_with(MAGIC) && content[8..40] == *key && content[40..HEADER] == sizes[..];
    if !is_ours || Sha256::digest(content).as_slice() != digest {
        return None;
    }
    let number = |b: &[u8]| b.try_into().map_or(f32::NAN, f32::from_le_bytes);
    let pixel = |b: &[u8]| Vec3::new(number(&b[..4]), number(&b[4..8]), number(&b[8..]));
    Some(content[HEADER..].chunks_exact(12).map(pixel).collect())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
