//! The replay of a session: against the live line, at any place, at any speed, and of damaged files.

mod damage;
mod driver;
mod live;
mod of_frames;
mod packet_log;
mod playing;
mod random;
mod rover;
mod seeking;
mod states;
mod steps;
mod values;
