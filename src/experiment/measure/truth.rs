//! The converged picture of a view. It takes long to trace and is needed by many runs, so it is
//! kept on disk.

use crate::camera::{Camera, View};
use crate::raster::save::{SaveError, write_atomically};
use crate::render::bands::{Background, BandedPicture};
use crate::trace::{RayCounts, TraceSettings, Tracer, parallel::Stop};
use glam::Vec3;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// First bytes of a stored picture.
const MAGIC: &[u8; 8] = b"AITRUTH1";

/// Length of the header in bytes: magic, key, width, height. A digest follows the pixels.
const HEADER: usize = 8 + 32 + 8;

/// Tag of the byte sequence that [`TruthRequest::key`] hashes. A change of the sequence needs a new
/// tag.
const KEY_TAG: &[u8] = b"afterimage truth key 2\n";

/// Number of pixels that are traced again to verify a stored picture without anti-aliasing; of
/// others, one tile is traced again. They reveal a change of the
/// tracer and a machine that rounds differently, and cost a ten-thousandth of a picture.
const PROBES: u32 = 64;

/// The view and settings of a converged picture.
#[derive(Clone, Copy, Debug)]
pub struct TruthRequest<'a> {
    /// Tracer of the scene.
    pub tracer: &'a Tracer,
    /// Camera of the view.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Settings of the converged picture: many samples, and a seed of its own.
    pub settings: TraceSettings,
    /// Passes through different points of each pixel, each with these samples; 1 for the centres
    /// alone.
    pub passes: u32,
}

/// Returns the linear radiance of a converged picture: from `folder` if it is stored there, else
/// traced and stored. A failure to store it is returned with the picture. `None` after a stop.
pub fn truth(
    request: &TruthRequest<'_>,
    folder: Option<&Path>,
    stop: Stop<'_>,
) -> Option<(Vec<Vec3>, Option<SaveError>)> {
    let key = request.key();
    let path = folder.map(|f| f.join(file_name(&key)));
    if let Some(kept) = path.as_deref().and_then(|p| read(p, &key, request.size))
        && request.agrees_with(&kept)
    {
        return Some((kept, None));
    }
    let (band, _) = request.picture().render(0..request.size[1], stop, &|_| ())?;
    let radiance = band.radiance;
    let error = path.and_then(|path| write(path, &key, request.size, &radiance).err());
    Some((radiance, error))
}

fn file_name(key: &[u8; 32]) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect::<String>() + ".truth"
}

impl TruthRequest<'_> {
    /// SHA-256 of everything that decides the picture: a tag, the version and the scene as lines,
    /// then pose, size and settings as little-endian numbers.
    fn key(&self) -> [u8; 32] {
        let c = self.camera;
        let TraceSettings { samples, bounces, seed } = self.settings;
        let mut sha = Sha256::new_with_prefix(KEY_TAG);
        for text in [env!("CARGO_PKG_VERSION"), self.tracer.scene().hash.as_str()] {
            sha.update(text);
            sha.update(b"\n");
        }
        for number in [c.eye.x, c.eye.y, c.eye.z, c.yaw, c.pitch, c.fov_y] {
            sha.update(number.to_le_bytes());
        }
        for number in [self.size[0], self.size[1], samples, bounces] {
            sha.update(number.to_le_bytes());
        }
        sha.update(seed.to_le_bytes());
        if self.passes > 1 {
            sha.update(self.passes.to_le_bytes());
        }
        for plane in self.tracer.section().iter().flat_map(|section| section.planes()) {
            sha.update(plane.to_string());
        }
        sha.finalize().into()
    }

    fn picture(&self) -> BandedPicture<'_> {
        BandedPicture {
            tracer: self.tracer,
            camera: self.camera,
            size: self.size,
            trace: self.settings,
            passes: self.passes,
            background: Background::Shown,
        }
    }

    fn agrees_with(&self, kept: &[Vec3]) -> bool {
        if self.passes > 1 {
            let middle = self.size.map(|side| side / 2);
            return self.picture().tile_at(middle).all(|(pixel, radiance)| radiance == kept[pixel]);
        }
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
    let mut bytes = header(key, size);
    bytes.reserve(size_of_val(radiance) + 32);
    bytes.extend(radiance.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
    let digest = Sha256::digest(&bytes);
    bytes.extend_from_slice(&digest);
    write_atomically(&path, &bytes)
}

fn header(key: &[u8; 32], [width, height]: [u32; 2]) -> Vec<u8> {
    [&MAGIC[..], key, &width.to_le_bytes(), &height.to_le_bytes()].concat()
}

/// Reads the pixels of a stored picture. `None` if there is none, if it is damaged, or if it is of
/// something else.
fn read(path: &Path, key: &[u8; 32], size: [u32; 2]) -> Option<Vec<Vec3>> {
    let bytes = std::fs::read(path).ok()?;
    if bytes.len() != HEADER + size[0] as usize * size[1] as usize * 12 + 32 {
        return None;
    }
    let (content, digest) = bytes.split_at(bytes.len() - 32);
    if !content.starts_with(&header(key, size)) || Sha256::digest(content).as_slice() != digest {
        return None;
    }
    let number = |b: &[u8]| b.try_into().map_or(f32::NAN, f32::from_le_bytes);
    let pixel = |b: &[u8]| Vec3::new(number(&b[..4]), number(&b[4..8]), number(&b[8..]));
    Some(content[HEADER..].chunks_exact(12).map(pixel).collect())
}
