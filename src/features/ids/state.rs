//! Scans, and the stages of an ID change: requested, proved, confirmed, done.
//!
//! Every motor on the line obeys a set-ID frame. So an ID is only set after a full scan has found exactly one
//! motor, and the user has confirmed it. Cancel, a stop, another tab, another scan or a lost port ends the
//! request: a scan that ends later opens no dialog.

use motorlink_i18n::tr;
use motorlink_messages::{
    Notice,
    bus::{
        Command, CommandKind, IdChangeOutcome, IdQueryOutcome, JobStatus, Refusal, ScanReport,
        SetIdFrames,
    },
    protocol::{AssignableId, MotorId},
};

use crate::model::{
    id_progress::{End, IdProgress},
    notice_board::{NoticeText, Remedy, Tone, Topic},
    notice_texts,
    page::IdChange,
    scan_texts,
    snapshot::concerns_all,
};

/// The stage of an ID change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// No ID change.
    #[default]
    None,
    /// A full scan was requested, to prove that there is only one motor.
    Proving {
        to: AssignableId,
        frames: SetIdFrames,
        /// Whether the bus has reported this scan as running: an earlier report proves nothing.
        scanning: bool,
    },
    /// One motor was found; the user is asked to confirm.
    Asking(IdChange),
    /// The user has confirmed, and the command was sent.
    Setting(IdChange),
}

/// How a scan or change ended.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Ended {
    Query(IdQueryOutcome),
    Scan(ScanReport),
    /// The scan does not prove that one motor, with another ID, is on the bus.
    NoProof(ScanReport, AssignableId),
    Change(MotorId, AssignableId, IdChangeOutcome),
    Refused(CommandKind, Refusal),
    TooLate(CommandKind),
}

impl Ended {
    /// In the present language.
    fn words(&self) -> Option<NoticeText> {
        Some(match self {
            Self::Query(outcome) => scan_texts::of_id_query(*outcome),
            Self::Scan(report) => scan_texts::of_scan(report),
            Self::NoProof(report, to) => scan_texts::of_no_proof(report, *to),
            Self::Change(from, to, outcome) => scan_texts::of_id_change(*from, *to, *outcome),
            Self::Refused(command, refusal) => notice_texts::of_notice(&Notice::Refused {
                command: *command,
                refusal: *refusal,
            })?,
            Self::TooLate(command) => notice_texts::of_notice(&Notice::TooLate(*command))?,
        })
    }
}

/// The state of the tab `ID Manager`, without the readings of the motors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct IdManager {
    stage: Stage,
    /// How the last scan or change ended.
    result: Option<Ended>,
    /// The next try, if a motor has kept its ID.
    more: Option<(AssignableId, SetIdFrames)>,
    /// The motors found by the last full scan.
    found: Vec<MotorId>,
    /// How the last scan or change ended, for other features.
    end: Option<End>,
}

impl IdManager {
    /// Begins an ID query or a full scan, which ends an ID change that was requested before.
    pub(crate) fn scan(&mut self) {
        self.stage = Stage::None;
        self.result = None;
        self.more = None;
        self.end = None;
    }

    /// Requests this ID for the only motor. The caller has to start a full scan.
    pub(crate) fn request(&mut self, to: AssignableId) {
        self.begin(to, SetIdFrames::default());
    }

    /// Requests the same again with more frames. Returns whether there is something to repeat.
    pub(crate) fn request_more(&mut self) -> bool {
        let more = self.more;
        if let Some((to, frames)) = more {
            self.begin(to, frames);
        }
        more.is_some()
    }

    fn begin(&mut self, to: AssignableId, frames: SetIdFrames) {
        self.result = None;
        self.more = None;
        self.end = None;
        self.stage = Stage::Proving {
            to,
            frames,
            scanning: false,
        };
    }

    /// Number of frames for the next try, if a motor has kept its ID.
    pub(crate) fn offers_more(&self) -> Option<SetIdFrames> {
        self.more.map(|(_, frames)| frames)
    }

    /// The change that the user has to confirm.
    pub(crate) const fn question(&self) -> Option<IdChange> {
        match self.stage {
            Stage::Asking(change) => Some(change),
            _ => None,
        }
    }

    /// The user confirms. Returns the command to send, once.
    pub(crate) fn agree(&mut self) -> Option<Command> {
        let change = self.question()?;
        self.stage = Stage::Setting(change);
        let IdChange { from, to, frames } = change;
        Some(Command::SetId { from, to, frames })
    }

    /// The user cancels or does something else. A change that the bus carries out continues, or the bus ends
    /// it; the bus reports both.
    pub(crate) fn give_up(&mut self) {
        if !matches!(self.stage, Stage::Setting(_)) {
            self.stage = Stage::None;
        }
    }

    /// The port was closed or lost: clears all that was known of the line.
    pub(crate) fn disconnected(&mut self) {
        *self = Self::default();
    }

    /// Handles a notice of the worker.
    pub(crate) fn on_notice(&mut self, notice: &Notice) {
        match notice {
            Notice::IdQueryEnded(outcome) => self.result = Some(Ended::Query(*outcome)),
            Notice::ScanEnded(report) => self.scan_ended(report),
            Notice::IdChangeEnded { from, to, outcome } => {
                self.stage = Stage::None;
                if *outcome == IdChangeOutcome::Changed {
                    self.found = vec![to.id()];
                }
                self.more = match outcome {
                    IdChangeOutcome::Kept { frames } => frames.more().map(|more| (*to, more)),
                    _ => None,
                };
                self.end = Some(match outcome {
                    IdChangeOutcome::Changed => End::Scanned {
                        motors: self.found.clone(),
                    },
                    IdChangeOutcome::Kept { .. } => End::Kept,
                    _ => End::Failed,
                });
                self.result = Some(Ended::Change(*from, *to, *outcome));
            }
            Notice::Refused { command, refusal } if scan_texts::is_survey(*command) => {
                self.failed(Ended::Refused(*command, *refusal));
            }
            Notice::TooLate(command) if scan_texts::is_survey(*command) => {
                self.failed(Ended::TooLate(*command));
            }
            Notice::StopBegan(reason) if concerns_all(*reason) => self.give_up(),
            _ => {}
        }
    }

    fn failed(&mut self, how: Ended) {
        self.stage = Stage::None;
        self.end = Some(End::Failed);
        self.result = Some(how);
    }

    fn scan_ended(&mut self, report: &ScanReport) {
        self.found.clone_from(&report.found);
        let result = match self.stage {
            // An earlier scan ended and ours has not begun, or the change is in progress.
            Stage::Proving {
                scanning: false, ..
            }
            | Stage::Setting(_) => return,
            Stage::Proving { to, frames, .. } => {
                if let Some(from) = proved(report).filter(|from| *from != to.id()) {
                    self.stage = Stage::Asking(IdChange { from, to, frames });
                    return;
                }
                Ended::NoProof(report.clone(), to)
            }
            // Also a scan other than the one that the user confirms.
            Stage::None | Stage::Asking(_) => Ended::Scan(report.clone()),
        };
        self.stage = Stage::None;
        self.result = Some(result);
        self.end = Some(
            if report.complete && report.noisy.is_empty() && report.fault.is_none() {
                End::Scanned {
                    motors: report.found.clone(),
                }
            } else {
                End::Failed
            },
        );
    }

    /// Updates the job of the bus, after all notices of the same message. Returns whether that changed
    /// anything.
    pub(crate) fn update(&mut self, job: Option<&JobStatus>) -> bool {
        let Stage::Proving { scanning, .. } = &mut self.stage else {
            return false;
        };
        match (&scanning, job.is_some()) {
            (false, true) => {
                *scanning = true;
                true
            }
            // It has ended without a notice.
            (true, false) => {
                self.stage = Stage::None;
                true
            }
            _ => false,
        }
    }

    /// The message of the tab: the current job, the last result, or what to do here.
    pub(crate) fn message(&self) -> NoticeText {
        let result = self.result.as_ref().and_then(Ended::words);
        match (&self.stage, result) {
            (Stage::Proving { to, .. } | Stage::Asking(IdChange { to, .. }), _) => calm(
                tr!(
                    "Before setting ID {id}: full scan to confirm a single motor",
                    id = to.id()
                ),
                tr!("Running motors are stopped first. You confirm before the ID changes."),
            ),
            (Stage::Setting(IdChange { from, to, frames }), _) => calm(
                tr!("Changing motor {from} to ID {to}", from, to = to.id()),
                &tr!(
                    "Keep the power on: {count} frames are sent, then both IDs are queried.",
                    count = frames.count()
                ),
            ),
            (Stage::None, Some(result)) => result,
            (Stage::None, None) => calm(
                tr!("Find motors").to_owned(),
                tr!(
                    "Scan sends one query to all: enough for a single motor. Full scan queries all \
                     254 addresses. Set ID starts with a full scan."
                ),
            ),
        }
    }

    /// Whether a full scan is the next step.
    pub(crate) fn offers_full_scan(&self) -> bool {
        let words = self.result.as_ref().and_then(Ended::words);
        words.and_then(|words| words.remedy) == Some(Remedy::FullScan)
    }

    /// What another feature sees of the last scan or change.
    pub(crate) fn progress(&self) -> IdProgress {
        IdProgress {
            is_changing: self.stage != Stage::None,
            end: self.end.clone(),
            message: self.message(),
            more: self.offers_more(),
        }
    }

    /// The motors found by the last full scan.
    pub(crate) fn found(&self) -> &[MotorId] {
        &self.found
    }
}

/// The only motor on the bus, if this report proves it.
fn proved(report: &ScanReport) -> Option<MotorId> {
    match (report.found.as_slice(), report.noisy.as_slice()) {
        ([only], []) if report.complete && report.fault.is_none() => Some(*only),
        _ => None,
    }
}

fn calm(title: String, advice: &str) -> NoticeText {
    NoticeText {
        topic: Topic::Survey,
        tone: Tone::Calm,
        title,
        advice: vec![advice.to_owned()],
        remedy: None,
        help: None,
    }
}

#[cfg(test)]
#[path = "state_tests.rs"]
mod tests;
