//! Groups of frames, each encoded on a thread of its own from a key frame on. A group depends on no
//! other, so that the film has the same bits at any number of threads.

use super::mp4::{Group, sample};
use super::settings::FilmSettings;
use super::yuv::Yuv420;
use afterimage_av1::{Av1Encoder, Av1Settings};
use std::error::Error;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

pub(super) type EncodeError = Box<dyn Error + Send + Sync>;

/// A group that is being encoded.
#[derive(Debug)]
pub(super) struct RunningGroup {
    frames: SyncSender<Yuv420>,
    thread: JoinHandle<Result<Group, EncodeError>>,
    /// Number of frames given to it.
    pub(super) count: u32,
}

impl RunningGroup {
    /// Starts the thread of a group. Up to `queue` frames wait for it.
    pub(super) fn begin(settings: FilmSettings, queue: usize) -> std::io::Result<Self> {
        let (frames, received) = sync_channel(queue);
        let thread = std::thread::Builder::new().name("encode".to_owned());
        let thread = thread.spawn(move || encode(&settings, &received))?;
        Ok(Self { frames, thread, count: 0 })
    }

    /// Adds a frame. Returns false if the encoder has failed; [`Self::finish`] has its error.
    pub(super) fn write(&mut self, frame: Yuv420) -> bool {
        self.count += 1;
        self.frames.send(frame).is_ok()
    }

    /// Waits until the group is encoded.
    pub(super) fn finish(self) -> Result<Group, EncodeError> {
        drop(self.frames);
        self.thread.join().unwrap_or_else(|_| Err("the encoder panicked".into()))
    }
}

fn encode(settings: &FilmSettings, frames: &Receiver<Yuv420>) -> Result<Group, EncodeError> {
    let mut encoder = Av1Encoder::new(&Av1Settings {
        size: settings.size,
        rate: settings.rate,
        quantizer: settings.quality.quantizer(),
        level: settings.level(),
        frames: settings.key_interval(),
    })?;
    let mut coded = Vec::new();
    for frame in frames {
        coded.extend(encoder.encode([&frame.luma, &frame.blue, &frame.red])?);
    }
    coded.extend(encoder.finish()?);
    Ok(Group { samples: coded.iter().map(|unit| sample(unit)).collect() })
}
