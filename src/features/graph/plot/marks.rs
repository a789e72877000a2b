//! The marks of commands and events on the time axis.

use motorlink_i18n::tr;
use motorlink_messages::{
    Notice, Update,
    bus::WithdrawReason,
    protocol::{Faults, Instant, MotorId},
};

use crate::{
    features::graph::{
        kept::alignment::{Align, goal_after, moments},
        plot::columns::Grid,
    },
    model::{
        history::{Track, ZERO_US},
        mirror::Mirror,
        notice_texts::why_withdrawn,
        terms,
    },
    ui::format,
};

/// Kept events: as many as one may look for in ten minutes.
const EVENTS_MAX: usize = 200;

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Start,
    NewTarget,
    Stop,
    /// A fault, or what ended a drive without a command.
    Event,
}

impl Kind {
    /// Its sign over the plot.
    pub(crate) const fn sign(self) -> &'static str {
        match self {
            Self::Start => "\u{25B6}",
            Self::NewTarget => "\u{25C6}",
            Self::Stop => "\u{25A0}",
            Self::Event => "!",
        }
    }
}

/// A mark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Mark {
    pub(crate) at: Instant,
    pub(crate) kind: Kind,
    /// `Start: +100 rpm`
    pub(crate) words: String,
}

/// What happened to a motor without a command.
#[derive(Clone, Copy, Debug)]
enum Event {
    Faults(Faults),
    Withdrawn(WithdrawReason),
}

/// What happened to motors without a command, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Events {
    events: Vec<(MotorId, Instant, Event)>,
    faults: Vec<(MotorId, Faults)>,
}

impl Events {
    /// Adds what an update tells: withdrawn setpoints, and faults that begin.
    pub(crate) fn take(&mut self, update: &Update) {
        let clock = |at: Instant| Instant::from_micros(ZERO_US.saturating_add(at.as_micros()));
        for sample in &update.samples {
            let (id, faults) = (sample.reply.id, sample.reply.faults);
            let place = self.faults.iter().position(|(of, _)| *of == id);
            let known = place.and_then(|place| self.faults.get_mut(place));
            let before = known.map(|(_, known)| std::mem::replace(known, faults));
            if before.is_none() {
                self.faults.push((id, faults));
            }
            if !faults.is_none() && before != Some(faults) {
                self.add(id, clock(sample.at), Event::Faults(faults));
            }
        }
        for notice in &update.notices {
            if let Notice::Withdrawn { id, reason } = notice {
                self.add(*id, clock(update.now), Event::Withdrawn(*reason));
            }
        }
    }

    fn add(&mut self, id: MotorId, at: Instant, event: Event) {
        if self.events.len() == EVENTS_MAX {
            self.events.remove(0);
        }
        self.events.push((id, at, event));
    }

    /// Changes whenever there is another one, except after very many.
    pub(crate) fn count(&self) -> usize {
        self.events.len()
    }

    /// The marks of a motor in these columns, in the order of time.
    pub(crate) fn marks(
        &self,
        id: MotorId,
        track: &Track,
        mirror: Mirror,
        grid: Grid,
    ) -> Vec<Mark> {
        let shown = grid.left_us()..=grid.right_us();
        let is_shown = |at: Instant| shown.contains(&at.as_micros());
        let commands = moments(track).filter(|(change, _)| is_shown(change.at));
        let commands = commands.map(|(change, align)| {
            let goal = goal_after(track, change);
            let target = goal.map(|goal| format::goal(mirror.setpoint(goal)));
            let target = target.unwrap_or_default();
            let (kind, words) = match align {
                Align::Start => (Kind::Start, tr!("Start: {target}", target)),
                Align::NewTarget => (Kind::NewTarget, tr!("Target: {target}", target)),
                Align::Stop => (Kind::Stop, tr!("Stop" as "of a run").to_owned()),
            };
            let at = change.at;
            Mark { at, kind, words }
        });
        let events = self.events.iter();
        let events = events.filter(|(of, at, _)| *of == id && is_shown(*at));
        let events = events.map(|&(_, at, event)| Mark {
            at,
            kind: Kind::Event,
            words: format::capitalized(&match event {
                Event::Faults(faults) => terms::faults(faults),
                Event::Withdrawn(reason) => why_withdrawn(reason).0,
            }),
        });
        let mut marks: Vec<Mark> = commands.collect();
        for event in events {
            let place = marks.partition_point(|mark| mark.at <= event.at);
            marks.insert(place, event);
        }
        marks
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{Activity, MotorStatus},
        protocol::Mode,
    };

    use super::*;
    use crate::{
        features::graph::kept::alignment::tests::rpm,
        model::{
            history::{
                History,
                tests::{sample, update},
            },
            snapshot::tests::{ID, status},
        },
    };

    #[test]
    fn commands_and_events_are_marked_in_their_order() {
        let (mut history, mut events) = (History::with_past(), Events::default());
        for (at_ms, activity) in [
            (1_000, Activity::Idle),
            (2_000, rpm(50)),
            (3_000, rpm(100)),
            (4_000, Activity::Idle),
        ] {
            let motor = MotorStatus {
                activity,
                ..status(at_ms, Mode::Velocity, 0)
            };
            let mut update = update(at_ms, vec![sample(ID, at_ms, 0)], vec![motor]);
            if at_ms == 4_000 {
                let reason = WithdrawReason::Silent;
                update.notices.push(Notice::Withdrawn { id: ID, reason });
            }
            if at_ms == 3_000 {
                update.samples[0].reply.faults = Faults::from_byte(8);
            }
            history.take(&update);
            events.take(&update);
        }
        let marks = |right_ms: u64| {
            let grid = Grid::new(10_000_000, ZERO_US + right_ms * 1_000, 100);
            let track = history.track(ID).unwrap();
            let marks = events.marks(ID, track, Mirror::Straight, grid);
            let words = marks.into_iter().map(|mark| mark.words);
            words.collect::<Vec<_>>()
        };
        assert_eq!(
            marks(5_000),
            [
                "Start: +50 rpm",
                "Target: +100 rpm",
                "Stall",
                "Stop",
                "No reply for 200 ms"
            ]
        );
        assert_eq!(marks(13_500), ["Stop", "No reply for 200 ms"], "in view");
        assert_eq!(events.count(), 2);
    }
}
