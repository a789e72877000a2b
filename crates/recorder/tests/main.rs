//! The packet log and the recording: filtered, exported, saved and restored.
#![cfg(test)]

mod csv_files;
mod filters;
mod line;
mod other_readers;
mod packet_log;
mod saved;
mod views_agree;
mod whole;
