//! `motorlink replay`: plays a session file on the screen of `control`, or writes its telemetry. It opens no port.

pub mod arguments;
mod keys;
mod playback;
mod rows;
mod view;

use std::{
    io::{IsTerminal, stdout},
    time::Duration,
};

use motorlink_driver::Ender;
use motorlink_session::{Overview, Problems, for_each_record};

use crate::{
    arguments::Global,
    failure::{DONE, Failure},
    output::say,
    session::{self, exit_code, file::Opened},
    signed_id::SignedId,
};
use arguments::Replay;

/// A session that was read once, so that its length and its damage are known.
struct Recorded {
    opened: Opened,
    overview: Overview,
    /// The motors that are shown.
    motors: Vec<SignedId>,
    /// The part that is shown, after the first record.
    from: Duration,
    to: Duration,
}

/// Plays the file in a terminal, or writes what was recorded at once. Says what is missing.
pub fn run(global: &Global, how: &Replay, ender: &Ender) -> Result<(), Failure> {
    let (recorded, problems) = read(global, how)?;
    let shown = if how.json || how.csv.is_some() {
        rows::write(recorded, how, ender)
    } else if stdout().is_terminal() {
        view::show(recorded, global.model, how.speed, ender)
    } else {
        rows::write_lines(recorded, global.model, ender)
    };
    shown?;
    if exit_code(&problems) == DONE {
        return Ok(());
    }
    say(problems.to_string().trim_end());
    let text = "the file is damaged: only what can be read was shown";
    Err(Failure::NotDone(text.to_owned()))
}

fn read(global: &Global, how: &Replay) -> Result<(Recorded, Problems), Failure> {
    let mut opened = Opened::open(&how.file)?;
    let mut overview = Overview::default();
    let read = for_each_record(&mut opened.bytes, &opened.session, |record| {
        overview.add(&record);
    });
    let read = read.map_err(Failure::file(&how.file))?;
    let problems = opened.problems().and(&read);
    let length = overview.duration();
    let (from, to) = (how.from, how.to.unwrap_or(length).min(length));
    // One without length has a single moment.
    if from > to || (from == to && !length.is_zero()) {
        return Err(Failure::Usage(format!(
            "nothing is between {:.3} and {:.3} s: the session lasts {:.3} s",
            from.as_secs_f64(),
            to.as_secs_f64(),
            length.as_secs_f64()
        )));
    }
    let mut motors = global.id.clone();
    if motors.is_empty() {
        motors.extend(overview.motors().map(|(id, _)| SignedId::straight(id)));
    }
    let recorded = Recorded {
        opened,
        overview,
        motors,
        from,
        to,
    };
    Ok((recorded, problems))
}

/// Microseconds, as a player counts them.
fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}

impl From<session::file::Failure> for Failure {
    fn from(failure: session::file::Failure) -> Self {
        Self::Usage(failure.to_string())
    }
}
