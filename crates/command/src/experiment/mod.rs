//! `motorlink run`, `step`, `sweep` and `characterise`: experiments, with a person's consent before the wheels turn.
//!
//! | file | what it is |
//! |---|---|
//! | `arguments` | their part of the command line |
//! | `asked` | what is asked, from a file or from parameters |
//! | `figures` | the figures as text |
//! | `files` | the files that are written |

pub mod arguments;
mod asked;
mod figures;
mod files;

use std::{
    io::{IsTerminal, Write, stderr},
    time::{Duration, Instant},
};

use motorlink_driver::{Ender, Experiment, Progress};
use motorlink_experiments::{kept::figures_to_json, plan::Fleet, runner::End};
use motorlink_protocol::MotorId;
use motorlink_runs::RecordedRun;

use arguments::RunHow;
pub use asked::{Asked, assign, file_study};
pub use figures::to_text;

use crate::{
    arguments::Global,
    confirm::confirm_on,
    connection::{Connection, Happened},
    failure::Failure,
    output::{print, say},
    recording::unix_ms,
    signed_id::SignedId,
    stop_report::most_serious,
};

/// How often the line of a terminal is drawn.
const DRAW: Duration = Duration::from_millis(200);

/// Runs an experiment, prints its figures, and writes its files.
pub fn run(global: &Global, asked: Asked<'_>, how: &RunHow, ender: &Ender) -> Result<(), Failure> {
    // A folder that cannot be made is known before a wheel turns.
    if let Some(folder) = &how.out {
        std::fs::create_dir_all(folder).map_err(Failure::file(folder))?;
    }
    let study = asked.read()?;
    let mut connection = Connection::open_with(global, ender, |options| {
        options.tells_traffic = how.record.is_some();
    })?;
    let mut experiment = None;
    let ran = connection.wait_for_motors().and_then(|()| {
        if let Some(file) = &how.record {
            connection.record(Some(file))?;
        }
        let run = checked(&connection, &study, how)?;
        if !how.yes {
            let question = format!("{}. Keep clear of the wheels. Start?", run.plan());
            confirm_on(&connection, &question)?;
        }
        let driver = &connection.driver;
        let experiment = experiment.insert(Experiment::arm(driver, run));
        experiment.start(driver, &connection.status()?);
        follow(&connection, experiment)
    });
    let stopped = connection.end_with(|entry| {
        if let Some(experiment) = &mut experiment {
            experiment.record(entry);
        }
    });
    let shown = match experiment {
        Some(experiment) => show(experiment.run(), how),
        None => Ok(()),
    };
    most_serious(ran.and(shown), stopped)
}

/// Checks what is asked against the motors of the line.
fn checked(
    connection: &Connection,
    study: &asked::StudyOf,
    how: &RunHow,
) -> Result<RecordedRun, Failure> {
    let model = connection.driver.model();
    let ids = connection.motors.iter().map(|motor| motor.id);
    let mut fleet = Fleet::of(ids);
    fleet.rpm_max = model.spec().speed_rpm_max.into();
    let mirrored = connection
        .motors
        .iter()
        .filter(|motor| motor.mirror.is_mirrored());
    fleet.mirrored = mirrored.map(|motor: &SignedId| motor.id).collect();
    let first = connection.motors.first();
    let study = study.on(first.map_or(MotorId::FIRST, |motor| motor.id))?;
    RecordedRun::new(study, fleet, model, how.rate.hertz(), unix_ms())
        .map_err(|error| Failure::Usage(error.to_string()))
}

/// Follows the run to its end.
fn follow(connection: &Connection, experiment: &mut Experiment) -> Result<(), Failure> {
    let shows = stderr().is_terminal();
    let mut draw_at = Instant::now();
    loop {
        let happened = connection.next()?;
        let entry = match &happened {
            Happened::Entry(_, entry) => Some(entry),
            Happened::Nothing => None,
        };
        let progress = experiment.take(&connection.driver, entry);
        match progress.map_err(|refusal| Failure::NotDone(refusal.to_string()))? {
            Progress::Ended(End::Finished { .. }) => return Ok(()),
            Progress::Ended(End::Aborted { cause, .. }) => {
                return Err(Failure::NotDone(format!("the run was aborted: {cause}")));
            }
            Progress::Running(state) if shows && Instant::now() >= draw_at => {
                draw_at = Instant::now() + DRAW;
                let place = experiment.run().plan().place(state.step);
                let (passed, most) = (
                    state.passed.as_secs_f64(),
                    experiment.run().plan().longest_s(),
                );
                let mut terminal = stderr().lock();
                // A terminal that is gone must not end the run in a panic.
                let _ = write!(
                    terminal,
                    "\r\x1b[K{passed:.1} of at most {most:.1} s, {place}  Ctrl-C stops"
                );
                let _ = terminal.flush();
            }
            Progress::Running(_) | Progress::Waiting => {}
        }
    }
}

/// Prints the figures, and writes the files. A run that was cut short has those of what was measured.
fn show(run: &RecordedRun, how: &RunHow) -> Result<(), Failure> {
    if run.record().samples().is_empty() {
        return Ok(());
    }
    if stderr().is_terminal() {
        say("");
    }
    let findings = run.findings();
    if let Some(folder) = &how.out {
        files::write(folder, run, &findings)?;
    }
    if how.json {
        return print(figures_to_json(run.header(), run.study(), &findings).trim_end());
    }
    print(to_text(&findings))
}
