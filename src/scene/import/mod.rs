//! Reading models.
