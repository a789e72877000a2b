//! Scans, and the way to a new ID: requested, proved, agreed to, done.
//!
//! A new ID is heard by every motor on the line, so it is only set after a full scan has found one
//! motor and nothing else, and a person has agreed. Whatever comes between (Cancel, a stop, another
//! tab, another scan, a lost port) ends the wish: a scan that ends after that opens no dialog.

use motorlink_i18n::tr;
use motorlink_messages::{
    Notice,
    bus::{Command, IdChangeOutcome, JobStatus, ScanReport, SetIdFrames},
    protocol::{AssignableId, MotorId},
};

use crate::model::{
    notice_board::{NoticeText, Remedy, Tone, Topic},
    notice_texts,
    page::IdChange,
    scan_texts,
    snapshot::concerns_all,
};

/// How far an ID change has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// None is requested for.
    #[default]
    None,
    /// A full scan was asked for, to prove that one motor is there.
    Proving {
        to: AssignableId,
        frames: SetIdFrames,
        /// Whether the bus was seen scanning since: a report of before proves nothing.
        scanning: bool,
    },
    /// One motor was found, and a person is asked.
    Asking(IdChange),
    /// A person has agreed, and the bus has been told.
    Setting(IdChange),
}

/// What the tab `ID Manager` shows but the motors' readings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct IdManager {
    stage: Stage,
    /// How the last scan or change ended.
    result: Option<NoticeText>,
    /// What to try next, where a motor has kept its ID.
    more: Option<(AssignableId, SetIdFrames)>,
    /// Who was found by the last full scan.
    found: Vec<MotorId>,
}

impl IdManager {
    /// A person asks who is there, by the ID query or a full scan. What was requested for before is
    /// moot.
    pub(crate) fn scan(&mut self) {
        self.stage = Stage::None;
        self.result = None;
        self.more = None;
    }

    /// A person wants the only motor to have this ID. The full scan has to be asked for now.
    pub(crate) fn request(&mut self, to: AssignableId) {
        self.begin(to, SetIdFrames::default());
    }

    /// The same once more, with more frames. Returns whether there is something to repeat.
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
        self.stage = Stage::Proving {
            to,
            frames,
            scanning: false,
        };
    }

    /// How many frames may be sent, where a motor has kept its ID in spite of fewer.
    pub(crate) fn offers_more(&self) -> Option<SetIdFrames> {
        self.more.map(|(_, frames)| frames)
    }

    /// What is to be asked of a person now.
    pub(crate) const fn question(&self) -> Option<IdChange> {
        match self.stage {
            Stage::Asking(change) => Some(change),
            _ => None,
        }
    }

    /// A person agrees. The command to send, once.
    pub(crate) fn agree(&mut self) -> Option<Command> {
        let change = self.question()?;
        self.stage = Stage::Setting(change);
        let IdChange { from, to, frames } = change;
        Some(Command::SetId { from, to, frames })
    }

    /// A person does not want it any more, or turns to something else. A change that the bus is at
    /// goes on, or is ended by the bus itself; it says so in either case.
    pub(crate) fn give_up(&mut self) {
        if !matches!(self.stage, Stage::Setting(_)) {
            self.stage = Stage::None;
        }
    }

    /// The port was closed or lost, and everything that was known of the line with it.
    pub(crate) fn disconnected(&mut self) {
        *self = Self::default();
    }

    /// Takes in what the worker tells.
    pub(crate) fn on_notice(&mut self, notice: &Notice) {
        match notice {
            Notice::IdQueryEnded(outcome) => {
                self.result = Some(scan_texts::of_id_query(*outcome));
            }
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
                self.result = Some(scan_texts::of_id_change(*from, *to, *outcome));
            }
            Notice::Refused { command, .. } | Notice::TooLate(command)
                if scan_texts::is_survey(*command) =>
            {
                self.stage = Stage::None;
                self.result = notice_texts::of_notice(notice);
            }
            Notice::StopBegan(reason) if concerns_all(*reason) => self.give_up(),
            _ => {}
        }
    }

    fn scan_ended(&mut self, report: &ScanReport) {
        self.found.clone_from(&report.found);
        let result = match self.stage {
            // It was asked for before the wish, and ours is still to come; or the wish is fulfilled.
            Stage::Proving {
                scanning: false, ..
            }
            | Stage::Setting(_) => return,
            Stage::Proving { to, frames, .. } => {
                if let Some(from) = proved(report).filter(|from| *from != to.id()) {
                    self.stage = Stage::Asking(IdChange { from, to, frames });
                    return;
                }
                scan_texts::of_no_proof(report, to)
            }
            // Also another scan than the one that was agreed to be enough.
            Stage::None | Stage::Asking(_) => scan_texts::of_scan(report),
        };
        self.stage = Stage::None;
        self.result = Some(result);
    }

    /// Takes in whether the bus scans, after all notices of the same message. Returns whether that
    /// is news.
    pub(crate) fn update(&mut self, job: Option<&JobStatus>) -> bool {
        let Stage::Proving { scanning, .. } = &mut self.stage else {
            return false;
        };
        match (&scanning, job.is_some()) {
            (false, true) => {
                *scanning = true;
                true
            }
            // It has ended and nobody said how.
            (true, false) => {
                self.stage = Stage::None;
                true
            }
            _ => false,
        }
    }

    /// What the tab says: what goes on, how the last ended, or what can be done here.
    pub(crate) fn message(&self) -> NoticeText {
        match (&self.stage, &self.result) {
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
            (Stage::None, Some(result)) => result.clone(),
            (Stage::None, None) => calm(
                tr!("Find motors").to_owned(),
                tr!(
                    "Scan sends one query to all: enough for a single motor. Full scan queries all \
                     254 addresses. Set ID starts with a full scan."
                ),
            ),
        }
    }

    /// Whether the full scan is what to press next.
    pub(crate) fn offers_full_scan(&self) -> bool {
        let remedy = self.result.as_ref().and_then(|said| said.remedy);
        remedy == Some(Remedy::FullScan)
    }

    /// Who was found by the last full scan.
    pub(crate) fn found(&self) -> &[MotorId] {
        &self.found
    }
}

/// The one motor that is there, if this report proves it.
fn proved(report: &ScanReport) -> Option<MotorId> {
    match (report.found.as_slice(), report.noisy.as_slice()) {
        ([only], []) if report.complete => Some(*only),
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
