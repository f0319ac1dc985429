//! A hash table that only grows. Threads fill it without locks.
//!
//! A value is a function of its key, so whichever thread computes it, it is the same. A thread that
//! finds a key whose value is still being computed computes it as well: that costs a little time,
//! and no thread waits.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Slots that are searched for a key before the table counts as full.
const PROBES: usize = 16;

/// Memory of a table, bytes.
pub(super) const MAX_BYTES: usize = 32 << 20;

/// A key with its value. Zero is no key, and no value yet.
#[derive(Debug, Default)]
struct Slot {
    key: AtomicU64,
    value: AtomicU64,
}

/// Values by 64-bit hash.
#[derive(Debug)]
pub(super) struct Table {
    slots: Vec<Slot>,
    filled: AtomicUsize,
}

impl Table {
    /// An empty table of at most this many bytes.
    pub(super) fn new(bytes: usize) -> Self {
        let count = bytes / size_of::<Slot>();
        Self {
            slots: std::iter::repeat_with(Slot::default).take(count).collect(),
            filled: AtomicUsize::new(0),
        }
    }

    /// Number of keys.
    pub(super) fn len(&self) -> usize {
        self.filled.load(Ordering::Relaxed)
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.slots.len() * size_of::<Slot>()
    }

    /// The value of a key, neither of which is zero. Where the table is full, the value is computed
    /// and not stored.
    pub(super) fn get_or_insert(&self, key: u64, compute: impl FnOnce() -> u64) -> u64 {
        let Some(slot) = self.slot_of(key) else { return compute() };
        match slot.value.load(Ordering::Acquire) {
            0 => {
                let value = compute();
                slot.value.store(value, Ordering::Release);
                value
            }
            value => value,
        }
    }

    /// The slot of a key, taken for it where it had none; `None` where none is free.
    fn slot_of(&self, key: u64) -> Option<&Slot> {
        let count = self.slots.len();
        (0..PROBES.min(count)).find_map(|probe| {
            let slot = &self.slots[((key >> 16) as usize + probe) % count];
            let held = slot.key.load(Ordering::Relaxed);
            if held == key {
                return Some(slot);
            }
            if held != 0 {
                return None;
            }
            match slot.key.compare_exchange(0, key, Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => {
                    self.filled.fetch_add(1, Ordering::Relaxed);
                    Some(slot)
                }
                Err(other) => (other == key).then_some(slot),
            }
        })
    }
}
