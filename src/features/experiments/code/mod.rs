//! The tab `Code`.
