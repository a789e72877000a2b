//! Session files: written, read, damaged, of other writers, and replayed.
#![cfg(test)]

mod bad_input;
mod bookmarks;
mod official_readers;
mod other_writers;
mod replay;
mod round_trip;
mod runs;
mod sample;
