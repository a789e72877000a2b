//! `motorlink record`: records the line until the time is over or Ctrl-C.

use std::{path::Path, time::Duration};

use motorlink_driver::Ender;

use crate::{
    arguments::Global, connection::on_line, failure::Failure, output::say, watching::watch_found,
};

/// Records to this file.
pub fn run(
    global: &Global,
    file: &Path,
    secs: Option<Duration>,
    ender: &Ender,
) -> Result<(), Failure> {
    on_line(
        global,
        ender,
        |options| options.tells_traffic = true,
        |connection| {
            watch_found(connection)?;
            connection.record(Some(file))?;
            say(format_args!(
                "recording to {}; Ctrl-C ends it",
                file.display()
            ));
            let begun = std::time::Instant::now();
            while secs.is_none_or(|secs| begun.elapsed() < secs) {
                match connection.next() {
                    // The usual end of a recording.
                    Err(Failure::Interrupted) => break,
                    happened => happened?,
                };
            }
            Ok(())
        },
    )
}
