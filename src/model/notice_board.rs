//! The current notices: one per topic, so that their number is bounded and a repeated fault does not remove
//! the others.

use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{StopOutcome, WithdrawReason},
    protocol::{Mode, MotorId},
};

use crate::model::help_topic::HelpTopic;

/// When a notice is no longer true.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Until {
    /// Never: it reports an event, and the user dismisses it.
    #[default]
    Dismissed,
    /// When any motor answers.
    AnyAnswer,
    /// When each of these motors answers again or is no longer queried.
    Answers(Vec<MotorId>),
    /// When this motor reports this loop.
    Loop(MotorId, Mode),
    /// When none of these motors is driven or being stopped.
    AtRest {
        motors: Vec<MotorId>,
        /// The motor whose setpoint was withdrawn, and why, for the changed text.
        withdrawn: Option<(MotorId, WithdrawReason)>,
    },
    /// When one of these motors is driven again.
    Driven(Vec<MotorId>),
    /// When each of these motors has reported standstill; with the number of such replies in a row. Never without motors.
    Standstill(Vec<(StopOutcome, u8)>),
}

/// What to do with a notice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Review {
    /// Keep it: it is still true.
    Keep,
    /// Withdraw it.
    Withdraw,
    /// Replace it, if it is another one.
    Replace(NoticeText, Until),
}

/// The topic of a notice. A new notice replaces an older one on the same topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    /// Opening and keeping the port.
    Port,
    /// Damaged bytes.
    Line,
    /// Lost and damaged replies.
    Quality,
    /// The result of the ID query.
    Answer,
    /// Motors that do not answer.
    Silence,
    /// A refused command.
    Command,
    /// A withdrawn setpoint.
    Setpoint(MotorId),
    /// A failed mode switch.
    Loop(MotorId),
    /// A stop that was not confirmed.
    Stop,
    /// Another motor was chosen.
    Choice,
    /// How a full scan or an ID change ended.
    Survey,
    /// The worker behind the page.
    Worker,
    /// What is driven cannot be remembered.
    Memory,
    /// The worker that keeps the log.
    Recorder,
    /// An export.
    Export,
    /// A new version of the page.
    NewVersion,
    /// The page as an installed program.
    Installing,
}

/// The severity of a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    /// Information.
    Calm,
    /// A warning: the user has to do something.
    Warning,
    /// An error.
    Error,
}

/// What a notice's button does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Remedy {
    /// Opens the picker without a filter.
    ShowAllPorts,
    /// Starts a full scan.
    FullScan,
    /// Loads the page again.
    Reload,
    /// Loads its new version.
    TakeNewVersion,
    /// Opens the browser's question to install the page.
    Install,
}

impl Remedy {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::ShowAllPorts => tr!("Show all ports"),
            Self::FullScan => tr!("Run full scan"),
            Self::Reload => tr!("Reload the page"),
            Self::TakeNewVersion => tr!("Update"),
            Self::Install => tr!("Install"),
        }
    }
}

/// The texts of a notice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NoticeText {
    pub(crate) topic: Topic,
    pub(crate) tone: Tone,
    /// What happened.
    pub(crate) title: String,
    /// What to do, one line each.
    pub(crate) advice: Vec<String>,
    pub(crate) remedy: Option<Remedy>,
    /// The place in the help.
    pub(crate) help: Option<HelpTopic>,
}

impl NoticeText {
    pub(crate) fn new(topic: Topic, tone: Tone, title: impl Into<String>, advice: &[&str]) -> Self {
        Self {
            topic,
            tone,
            title: title.into(),
            advice: advice.iter().map(|line| (*line).to_owned()).collect(),
            remedy: None,
            help: None,
        }
    }

    /// The same, with a place in the help.
    #[must_use]
    pub(crate) fn explained_at(self, topic: HelpTopic) -> Self {
        Self {
            help: Some(topic),
            ..self
        }
    }
}

/// A shown notice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Posted {
    /// Its unique number.
    pub(crate) number: u32,
    pub(crate) words: NoticeText,
    until: Until,
}

/// The notices. Each keeps its slot while it is shown, so that only new ones change the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct NoticeBoard {
    slots: [Option<Posted>; Self::SLOTS],
    last_number: u32,
}

impl NoticeBoard {
    /// Maximal number; nobody would read more.
    pub(crate) const SLOTS: usize = 5;

    /// Posts a notice that stays until the user dismisses it or another one on its topic replaces it.
    pub(crate) fn post(&mut self, words: NoticeText) {
        self.post_until(words, Until::Dismissed);
    }

    /// Posts a notice that is true until then.
    pub(crate) fn post_until(&mut self, words: NoticeText, until: Until) {
        // A repeated notice keeps its number, so that a screen reader does not announce it again.
        let mut posted = self.slots.iter_mut().flatten();
        if let Some(same) = posted.find(|posted| posted.words == words) {
            same.until = until;
            return;
        }
        self.withdraw(words.topic);
        self.last_number += 1;
        let number = self.last_number;
        // A free one, else the oldest.
        let slot = self
            .slots
            .iter_mut()
            .min_by_key(|slot| slot.as_ref().map_or(0, |posted| posted.number));
        if let Some(slot) = slot {
            *slot = Some(Posted {
                number,
                words,
                until,
            });
        }
    }

    pub(crate) fn withdraw(&mut self, topic: Topic) {
        self.withdraw_all(|other| other == topic);
    }

    /// Withdraws the notices on all of these topics.
    pub(crate) fn withdraw_all(&mut self, topics: impl Fn(Topic) -> bool) {
        self.take_down(|posted| topics(posted.words.topic));
    }

    /// Withdraws the notice of a command that was refused for this reason.
    pub(crate) fn withdraw_refusal(&mut self, reason: &str) {
        self.take_down(|posted| {
            posted.words.topic == Topic::Command
                && posted.words.advice.iter().any(|line| line == reason)
        });
    }

    /// Withdraws the notices about a closed line.
    pub(crate) fn close_line(&mut self) {
        self.withdraw_all(|topic| {
            matches!(
                topic,
                Topic::Answer | Topic::Silence | Topic::Line | Topic::Quality | Topic::Loop(_)
            )
        });
    }

    /// Reviews every notice. Returns whether any changed.
    pub(crate) fn review(&mut self, mut review: impl FnMut(&mut Until) -> Review) -> bool {
        let mut changed = false;
        for slot in &mut self.slots {
            let Some(posted) = slot else { continue };
            match review(&mut posted.until) {
                Review::Keep => continue,
                Review::Withdraw => *slot = None,
                Review::Replace(words, until) => {
                    posted.until = until;
                    if posted.words == words {
                        continue;
                    }
                    posted.words = words;
                }
            }
            changed = true;
        }
        changed
    }

    pub(crate) fn dismiss(&mut self, number: u32) {
        self.take_down(|posted| posted.number == number);
    }

    fn take_down(&mut self, which: impl Fn(&Posted) -> bool) {
        for slot in &mut self.slots {
            if slot.as_ref().is_some_and(&which) {
                *slot = None;
            }
        }
    }

    pub(crate) fn slot(&self, place: usize) -> Option<&Posted> {
        self.slots.get(place)?.as_ref()
    }

    pub(crate) fn posted(&self) -> impl Iterator<Item = &Posted> {
        self.slots.iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(topic: Topic, title: &str) -> NoticeText {
        NoticeText {
            topic,
            tone: Tone::Warning,
            title: title.to_owned(),
            advice: vec![],
            remedy: None,
            help: None,
        }
    }

    /// Newest first.
    fn titles(board: &NoticeBoard) -> Vec<&str> {
        let mut posted: Vec<&Posted> = board.posted().collect();
        posted.sort_by_key(|posted| std::cmp::Reverse(posted.number));
        let titles = posted.into_iter();
        titles.map(|posted| posted.words.title.as_str()).collect()
    }

    #[test]
    fn a_topic_has_one_notice() {
        let mut board = NoticeBoard::default();
        board.post(words(Topic::Port, "busy"));
        board.post(words(Topic::Answer, "silent"));
        board.post(words(Topic::Port, "gone"));
        assert_eq!(titles(&board), ["gone", "silent"]);
        let before = board.clone();
        board.post(words(Topic::Port, "gone"));
        assert_eq!(board, before, "the same is no news");
        board.withdraw(Topic::Answer);
        assert_eq!(titles(&board), ["gone"]);
        let number = board.posted().next().unwrap().number;
        board.dismiss(number);
        assert_eq!(titles(&board), [""; 0]);
    }

    #[test]
    fn a_notice_keeps_its_slot() {
        let mut board = NoticeBoard::default();
        board.post(words(Topic::Port, "busy"));
        board.post(words(Topic::Answer, "silent"));
        board.withdraw(Topic::Port);
        assert_eq!(board.slot(1).unwrap().words.title, "silent");
        board.post(words(Topic::Stop, "not confirmed"));
        assert_eq!(board.slot(0).unwrap().words.title, "not confirmed");
    }

    #[test]
    fn the_board_is_bounded_and_the_oldest_goes_first() {
        let mut board = NoticeBoard::default();
        for id in MotorId::all() {
            board.post(words(Topic::Loop(id), &id.to_string()));
        }
        assert_eq!(titles(&board), ["0xFE", "0xFD", "0xFC", "0xFB", "0xFA"]);
    }
}
