//! The command `motorlink`: the same bus as on the page, in a terminal. See `motorlink --help`.
//!
//! It is a library for the Python package, which brings the command too and records as it does.

mod answering;
mod arguments;
mod asked_line;
mod confirm;
mod connection;
mod control;
mod doctor;
mod drive;
mod experiment;
mod failure;
mod fleet;
mod group_switch;
mod info;
mod key_input;
mod log;
mod manual;
mod monitor;
mod output;
mod parsers;
mod ports;
mod raw;
mod record;
mod recording;
mod replay;
mod scan;
mod screen;
mod serve;
mod session;
mod set_id;
#[cfg(unix)]
mod signals;
mod signed_id;
mod starting;
mod stop;
mod stop_report;
mod values;
#[cfg(unix)]
mod virtual_motors;
mod watching;
mod wizard;

use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches, error::ErrorKind};
use motorlink_driver::{Ender, words};
use motorlink_experiments::study::StudyKind;

/// What the Python package uses.
pub mod library {
    pub use crate::{
        arguments::Global,
        connection::{Connection, Happened, Heard},
        drive::{amps_setpoint, degrees_setpoint, ends_drive, rpm_setpoint},
        experiment::{assign, file_study},
        failure::Failure,
        group_switch::GroupSwitch,
        recording::unix_ms,
        scan::scan,
        set_id::{change as change_id, only_motor},
        signed_id::SignedId,
        starting::{adjust, start},
        words::of_entry as words_of,
    };
}

use arguments::{Action, Arguments};
use failure::{DONE, Failure, NOT_DONE, USAGE};
use output::{print, say};

/// Runs the command with these arguments, the first of which is the name of the program. Returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match parse(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let arguments = match arguments.action {
        Action::Session { action } => return session::run(action),
        Action::Fleet { arguments } => return exit(fleet::run(&arguments)),
        Action::Completions { shell } => return exit(manual::completions(shell)),
        Action::Man { folder } => return exit(manual::pages(&folder)),
        _ => arguments,
    };
    #[cfg(unix)]
    let arguments = match arguments.action {
        // It handles signals itself.
        Action::Virtual(flags) => {
            let model = arguments.global.model.unwrap_or_default();
            return exit(virtual_motors::run(flags, model));
        }
        _ => arguments,
    };
    let ender = Ender::default();
    let of_signal = ender.clone();
    // Ctrl-C, SIGTERM, SIGHUP and the console events of Windows end the driver, which stops the motors.
    let handled = ctrlc::set_handler(move || of_signal.end());
    #[cfg(unix)]
    let handled = handled
        .map_err(std::io::Error::other)
        .and_then(|()| signals::end_instead(&ender));
    if let Err(error) = handled {
        say(format_args!(
            "motorlink: signals cannot be handled, so nothing is driven: {error}"
        ));
        return NOT_DONE;
    }
    exit(dispatch(arguments, &ender))
}

fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    let command = with_negative_values(Arguments::command());
    Arguments::from_arg_matches(&command.try_get_matches_from(arguments)?)
}

/// `--secs -1` is a value that is out of range, and no unknown flag.
fn with_negative_values(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| {
            let takes_values = arg.get_action().takes_values();
            arg.allow_negative_numbers(takes_values)
        })
        .mut_subcommands(with_negative_values)
}

fn exit(done: Result<(), Failure>) -> u8 {
    match done {
        Ok(()) => DONE,
        Err(failure) => {
            say(format_args!("motorlink: {failure}"));
            failure.exit_code()
        }
    }
}

fn dispatch(Arguments { global, action }: Arguments, ender: &Ender) -> Result<(), Failure> {
    match action {
        Action::Ports { json } => ports::run(global.port.as_deref(), json),
        Action::Scan { json, full: _ } => scan::run(&global, json, ender),
        Action::Info { json } => info::run(&global, json, ender),
        Action::Monitor(how) => monitor::run(&global, &how, ender),
        Action::Drive { drive } => drive::run(&global, drive, ender),
        Action::Control(how) => control::run(&global, &how, ender),
        Action::Stop { forget: false } => stop::run(&global, ender),
        Action::Stop { forget: true } => stop::forget(&global),
        Action::Doctor(how) => doctor::run(&global, &how, ender),
        Action::SetId { new, yes } => set_id::run(&global, new, yes, ender),
        Action::Wizard(how) => wizard::run(&global, &how, ender),
        Action::Raw { frame, yes } => raw::run(&global, frame, yes, ender),
        Action::Run { file, how } => {
            experiment::run(&global, experiment::Asked::File(&file), &how, ender)
        }
        Action::Step { set, how } => {
            let asked = experiment::Asked::Study(StudyKind::Step, &set);
            experiment::run(&global, asked, &how, ender)
        }
        Action::Sweep { set, how } => {
            let asked = experiment::Asked::Study(StudyKind::Frequency, &set);
            experiment::run(&global, asked, &how, ender)
        }
        Action::Characterise { what, set, how } => {
            let asked = experiment::Asked::Study(what.kind(), &set);
            experiment::run(&global, asked, &how, ender)
        }
        Action::Replay(how) => replay::run(&global, &how, ender),
        Action::Serve(how) => serve::run(&global, how, ender),
        Action::Record { file, secs } => record::run(&global, &file, secs, ender),
        // They need no line.
        Action::Session { .. }
        | Action::Fleet { .. }
        | Action::Completions { .. }
        | Action::Man { .. } => Ok(()),
        #[cfg(unix)]
        Action::Virtual(_) => Ok(()),
    }
}

/// Prints a help text, or what is wrong with the command line in one line.
fn usage(error: &clap::Error) -> u8 {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // It ends in a line break.
            exit(print(error.to_string().trim_end()))
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            say(error.to_string().trim_end());
            USAGE
        }
        _ => {
            let text = error.to_string();
            // Behind the first paragraph are a usage text and tips.
            let first = text.split("\n\n").next().unwrap_or_default();
            let words = first.split_whitespace().collect::<Vec<_>>().join(" ");
            let said = words.strip_prefix("error: ").unwrap_or(&words);
            // So the standard library names a number that it cannot read.
            let said = said
                .replace("invalid digit found in string", "expected a whole number")
                .replace("invalid float literal", "expected a number");
            say(format_args!("motorlink: {said}; see --help"));
            USAGE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_line_is_consistent() {
        with_negative_values(Arguments::command()).debug_assert();
    }
}
