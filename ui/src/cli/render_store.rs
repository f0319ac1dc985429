//! The store of references of `afterimage render`.

use super::flags::{Flags, StoreChoice};
use super::{failure::Failure, output, scene::Loaded};
use afterimage::experiment::tour::StoreRecord;
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::store::StoreSession;
use afterimage::{Camera, Mode, warp::MAX_REFERENCES};
use std::sync::Arc;

/// Stored references that serve a picture.
pub(super) struct PictureStore {
    session: Option<StoreSession>,
    read: Vec<Arc<ReferenceFrame>>,
    /// What was read and written.
    pub(super) record: StoreRecord,
}

impl PictureStore {
    /// Reads the references that serve a view, if flags name a store.
    pub(super) fn open(flags: &Flags, loaded: &Loaded, camera: &Camera) -> Result<Self, Failure> {
        let settings = flags.store(&StoreChoice::Off).filter(|_| flags.mode != Mode::Full);
        let session = settings.map(|settings| StoreSession::open(&settings, &loaded.tracer, true));
        let mut session = session.transpose()?;
        let mut cache = ReferenceCache::new(loaded.scene(), CACHE_BYTES);
        if let Some(session) = &mut session {
            session.read_for((camera, flags.size()), &flags.trace(), flags.mode.purpose(), &mut cache);
        }
        let read = cache.entries().iter().map(|entry| Arc::clone(&entry.frame)).collect();
        Ok(Self { session, read, record: StoreRecord::default() })
    }

    /// Stores references that were traced, and returns them with those that were read: as many as a
    /// frame of mode `paper` can warp.
    pub(super) fn exchange(
        &mut self,
        traced: Vec<Arc<ReferenceFrame>>,
        flags: &Flags,
    ) -> Vec<Arc<ReferenceFrame>> {
        if let Some(session) = &mut self.session {
            traced.iter().for_each(|reference| session.keep(reference, flags.mode.purpose()));
        }
        let most = if flags.mode == Mode::Paper { MAX_REFERENCES } else { usize::MAX };
        traced.into_iter().chain(self.read.drain(..)).take(most).collect()
    }

    /// Waits until all references are stored, and reports problems.
    pub(super) fn finish(&mut self) {
        let Some(session) = &mut self.session else { return };
        session.finish();
        self.record = StoreRecord::of(session);
        for problem in session.report().problems {
            output::say(&format!("warning: {problem}"));
        }
    }
}

/// Memory for stored references, bytes; half of it is used.
const CACHE_BYTES: usize = 2048 << 20;
