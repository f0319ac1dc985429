//! Audits of looked-up frames: a few pixels of every frame are traced in full as well and compared
//! with what was shown, to estimate the error and to find references that are wrong.

mod audited;
mod auditor;
mod blame;
mod statistics;

pub use audited::Audited;
pub use auditor::Auditor;
pub use statistics::AuditEstimate;
