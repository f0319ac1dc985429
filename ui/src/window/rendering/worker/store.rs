//! The store of references of the render thread.

use super::super::Message;
use super::state::Worker;
use afterimage::Tracer;
use afterimage::store::StoreSession;
use std::sync::Arc;

impl Worker {
    /// The store for a scene: the open one, or the one of the settings. A store that cannot be read
    /// is reported once and not used.
    pub(super) fn store_of(
        &mut self,
        open: Option<StoreSession>,
        tracer: &Arc<Tracer>,
    ) -> Option<StoreSession> {
        if let Some(mut store) = open {
            store.set_tracer(tracer);
            return Some(store);
        }
        let settings = self.store.take()?;
        match self.pool.install(|| StoreSession::open(&settings, tracer, false)) {
            Ok(store) => {
                self.store = Some(settings);
                Some(store)
            }
            Err(error) => {
                self.send(Message::Failed(error.to_string()));
                None
            }
        }
    }

    /// Sends what is wrong with the store.
    pub(super) fn report_store(&mut self) {
        let store = self.walk.as_mut().and_then(|walk| walk.store_mut());
        for problem in store.map(StoreSession::take_problems).unwrap_or_default() {
            self.send(Message::Failed(problem));
        }
    }
}
