//! The part of the command line that is about experiments.

use std::{fmt::Write, path::PathBuf};

use clap::{Args, ValueEnum};
use motorlink_bus::CommandRate;
use motorlink_experiments::study::{Study, StudyKind};
use motorlink_protocol::MotorId;

use crate::parsers::rate;

/// What is measured of a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Property {
    /// The current that a free wheel needs, by speed
    Friction,
    /// Inertia and friction, from pushes and coasting
    CoastDown,
    /// How the winding warms up at a constant current, with the wheel blocked or loaded
    Heating,
    /// Speed by torque, while a person brakes the wheel
    TorqueSpeed,
    /// What the motor does when drive frames cease
    WhenFramesCease,
}

impl Property {
    pub const KINDS: [StudyKind; 5] = [
        StudyKind::Friction,
        StudyKind::CoastDown,
        StudyKind::Heating,
        StudyKind::TorqueSpeed,
        StudyKind::Silence,
    ];

    pub const fn kind(self) -> StudyKind {
        match self {
            Self::Friction => StudyKind::Friction,
            Self::CoastDown => StudyKind::CoastDown,
            Self::Heating => StudyKind::Heating,
            Self::TorqueSpeed => StudyKind::TorqueSpeed,
            Self::WhenFramesCease => StudyKind::Silence,
        }
    }
}

/// How an experiment is run, and what is made of it.
#[derive(Clone, Debug, Args)]
pub struct RunHow {
    /// Do not ask before the wheels turn
    #[arg(long)]
    pub yes: bool,
    /// Setpoints a second to each motor, 1-500
    #[arg(long, default_value = "200", value_parser = rate, value_name = "HZ")]
    pub rate: CommandRate,
    /// Print the figures as JSON
    #[arg(long)]
    pub json: bool,
    /// Write to this folder: the run (JSON), its setpoints and samples (CSV), its figures (CSV), and a report (HTML)
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Record the line to this session file (.mcap)
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
}

/// The parameters of these studies with their defaults and ranges, for the help.
pub fn parameters_of(kinds: &[StudyKind]) -> String {
    let mut text = String::new();
    for kind in kinds {
        let mut study = Study::of(*kind, MotorId::FIRST);
        let parameters = study.parameters();
        if parameters.is_empty() {
            continue;
        }
        let name = kind.field().replace('_', "-");
        let _ = writeln!(
            text,
            "{}Parameters of {name}:",
            if text.is_empty() { "" } else { "\n" }
        );
        for parameter in parameters {
            let (min, max) = parameter.range;
            let _ = writeln!(
                text,
                "  {:16} {} ({min} to {max})",
                parameter.name,
                parameter.value()
            );
        }
    }
    text
}
