//! Frames on the wire, and their entries in the log.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::{Event, LineEventKind};
use motorlink_protocol::{Frame, Instant, Reply, family::Model};

use super::said::tells;
use crate::rule::{Outcome, Rule, broken};

/// On a good line a reply is in the log within this: the longest window, and the frames before it.
const LOGGED_WITHIN: Duration = Duration::from_millis(250);
/// After a faulty line becomes healthy, held bytes have arrived within this time.
const LINE_CLEARS: Duration = Duration::from_millis(250);

/// A reply that a motor sent.
#[derive(Clone, Copy, Debug)]
struct Sent {
    at: Instant,
    frame: Frame,
    /// The line was healthy and no other sender was active.
    undisturbed: bool,
}

/// The wire and its log.
#[derive(Debug, Default)]
pub(super) struct Wire {
    model: Model,
    /// When the last sent byte has passed.
    busy_until: Option<Instant>,
    last_was_for_all: bool,
    last_sent: Option<Frame>,
    /// Frames that must appear in the log, and whether the bus knows that they were not sent.
    unlogged: VecDeque<(Frame, bool)>,
    replies: VecDeque<Sent>,
    line_is_good_since: Option<Instant>,
    /// Readings of this moment, which must be in the log too.
    read: Vec<Reply>,
    received: Vec<Frame>,
}

impl Wire {
    pub(super) fn of(model: Model) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    /// The line was set healthy or faulty.
    pub(super) fn line(&mut self, now: Instant, is_good: bool) {
        self.line_is_good_since = is_good.then(|| self.line_is_good_since.unwrap_or(now));
        if !is_good {
            // Bytes on their way may still be corrupted.
            for sent in &mut self.replies {
                sent.undisturbed = false;
            }
        }
    }

    /// A frame goes out.
    pub(super) fn sent(&mut self, now: Instant, frame: Frame) -> Outcome {
        if self.busy_until.is_some_and(|until| now < until) {
            return broken(Rule::OneFrameAtATime, now, format!("{frame}"));
        }
        self.busy_until = Some(now + self.model.frame_airtime());
        let [first, command, ..] = *frame.bytes();
        self.last_was_for_all = first == 0xC8 && command == 0x64;
        self.last_sent = Some(frame);
        self.unlogged.push_back((frame, false));
        Ok(())
    }

    /// Only this many bytes of a frame go out.
    pub(super) fn refused(&mut self, now: Instant, frame: Frame, bytes: usize, reported: bool) {
        let tenths = u32::try_from(bytes).unwrap_or(u32::MAX);
        self.busy_until = self
            .busy_until
            .max(Some(now + self.model.frame_airtime() / 10 * tenths));
        self.unlogged.push_back((frame, reported));
    }

    /// Bytes on their way arrive late or never.
    pub(super) fn disturbed(&mut self, now: Instant) {
        let was_good = self.line_is_good_since.is_some();
        self.line(now, false);
        if was_good {
            self.line(now, true);
        }
    }

    /// A motor replies.
    pub(super) fn replied(&mut self, at: Instant, frame: Frame) {
        let good = self
            .line_is_good_since
            .is_some_and(|since| at.since(since) > LINE_CLEARS);
        self.replies.push_back(Sent {
            at,
            frame,
            // All motors answer the ID query at once, and a reply that is its request may be an echo.
            undisturbed: good && !self.last_was_for_all && self.last_sent != Some(frame),
        });
    }

    /// The port is closed: bytes on their way are lost.
    pub(super) fn port_lost(&mut self) {
        let good = self.line_is_good_since;
        *self = Self::of(self.model);
        self.line_is_good_since = good;
    }

    /// The bus reports an event.
    pub(super) fn on_event(&mut self, now: Instant, event: &Event) -> Outcome {
        match event {
            Event::Line(traffic) => match traffic.kind {
                LineEventKind::Sent { frame, .. }
                | LineEventKind::SentByHand { frame, .. }
                | LineEventKind::RepeatedByHand { frame, .. } => {
                    return self.logged_as(now, frame, false);
                }
                LineEventKind::NotSent { frame } => return self.logged_as(now, frame, true),
                LineEventKind::Received { frame, .. } => {
                    self.received.push(frame);
                    return self.logged(now, frame);
                }
                LineEventKind::Junk(_)
                | LineEventKind::ModelSelected(_)
                | LineEventKind::Silence { .. }
                | LineEventKind::Known { .. } => {}
            },
            Event::Telemetry(sample) => self.read.push(sample.reply),
            _ => {}
        }
        Ok(())
    }

    /// Every frame appears in the log in its order, sent or not.
    fn logged_as(&mut self, now: Instant, frame: Frame, unsent: bool) -> Outcome {
        if self.unlogged.pop_front() == Some((frame, unsent)) {
            return Ok(());
        }
        let what = if unsent { "as not sent" } else { "as sent" };
        let what = format!("{frame} {what}, out of turn");
        broken(Rule::LogIsComplete, now, what)
    }

    /// The log has the replies in the order in which they were sent, and no good reply before is
    /// missing.
    fn logged(&mut self, now: Instant, frame: Frame) -> Outcome {
        // A corrupt reply may have had the same bytes.
        let is_it = |sent: &Sent| sent.undisturbed && sent.frame == frame;
        let same = |sent: &Sent| sent.frame == frame;
        let place = self.replies.iter().position(is_it);
        let Some(place) = place.or_else(|| self.replies.iter().position(same)) else {
            // A motor of another host, or bytes with a good CRC by chance.
            return Ok(());
        };
        let missing = self.replies.drain(..=place).take(place);
        match missing.into_iter().find(|sent| sent.undisturbed) {
            Some(Sent { at, frame, .. }) => {
                broken(Rule::GoodRepliesAreHeard, now, format!("{frame} of {at:?}"))
            }
            None => Ok(()),
        }
    }

    /// All events of this moment are out.
    pub(super) fn settled(&mut self, now: Instant) -> Outcome {
        let received = std::mem::take(&mut self.received);
        let unlogged = std::mem::take(&mut self.read)
            .into_iter()
            .find(|reply| !received.iter().any(|frame| tells(self.model, frame, reply)));
        match unlogged {
            Some(reply) => broken(
                Rule::LogIsComplete,
                now,
                format!("{reply:?} was read, not logged"),
            ),
            None => Ok(()),
        }
    }

    /// Time has passed.
    pub(super) fn passed(&mut self, now: Instant) -> Outcome {
        while let Some(Sent {
            at,
            frame,
            undisturbed,
        }) = self.replies.front().copied()
            && now.since(at) > LOGGED_WITHIN
        {
            self.replies.pop_front();
            if undisturbed {
                return broken(Rule::GoodRepliesAreHeard, now, format!("{frame} of {at:?}"));
            }
        }
        Ok(())
    }
}
