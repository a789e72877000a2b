//! `/link`: statistics of the bus per second, derived from `/wire`.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Instant, MotorId, Request};

const SECOND_US: u64 = 1_000_000;

/// Counts the frames of each second in which one passed.
#[derive(Debug, Default)]
pub(crate) struct Meter {
    second: Option<Second>,
    /// The last request that expects a reply, and its time.
    asked: Option<(MotorId, Instant)>,
}

/// The counts of one second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Second {
    /// The number of the second on the monotonic clock.
    number: u64,
    sent: u32,
    replies: u32,
    lost: u32,
    junk: u32,
    not_sent: u32,
    round_trips: u32,
    round_trip_min_us: u64,
    round_trip_sum_us: u64,
    round_trip_max_us: u64,
}

impl Meter {
    /// Counts an event. Returns the previous second when it has ended.
    pub(crate) fn add_event(&mut self, event: &LineEvent) -> Option<Second> {
        let number = event.at.as_micros() / SECOND_US;
        let ended = self.second.take_if(|second| second.number != number);
        let ended = ended.filter(Second::has_requests);
        if !event.kind.is_on_the_wire() {
            return ended;
        }
        let second = self.second.get_or_insert(Second {
            number,
            ..Second::default()
        });
        match event.kind {
            LineEventKind::Sent { frame, .. }
            | LineEventKind::SentByHand { frame, .. }
            | LineEventKind::RepeatedByHand { frame, .. } => {
                second.sent += 1;
                let request = Request::parse(&frame).ok();
                let answers = request.filter(|request| request.reply_layout().is_some());
                let id = answers.and_then(|request| request.addressee());
                self.asked = id.map(|id| (id, event.at));
            }
            LineEventKind::Received { frame, .. } => {
                second.replies += 1;
                let [address, ..] = *frame.bytes();
                let id = MotorId::new(address).ok();
                let asked = self.asked.take_if(|(asked, _)| Some(*asked) == id);
                if let Some((_, at)) = asked {
                    second.round_trip(event.at, at);
                }
            }
            LineEventKind::Junk(_) => second.junk += 1,
            LineEventKind::Silence { .. } => {
                second.lost += 1;
                // A reply after this is late and gives no round trip.
                self.asked = None;
            }
            LineEventKind::NotSent { .. } => second.not_sent += 1,
            LineEventKind::Known { .. } | LineEventKind::ModelSelected(_) => {}
        }
        ended
    }

    /// The current second, which has not ended.
    pub(crate) fn end(&mut self) -> Option<Second> {
        self.second.take().filter(Second::has_requests)
    }
}

impl Second {
    /// Of a time of which only replies are left, what was asked and lost is not known.
    const fn has_requests(&self) -> bool {
        self.sent + self.lost + self.junk + self.not_sent > 0
    }

    fn round_trip(&mut self, at: Instant, asked_at: Instant) {
        let took = at.as_micros().saturating_sub(asked_at.as_micros());
        let least = self.round_trip_min_us.min(took);
        self.round_trip_min_us = if self.round_trips == 0 { took } else { least };
        self.round_trip_max_us = self.round_trip_max_us.max(took);
        self.round_trip_sum_us = self.round_trip_sum_us.saturating_add(took);
        self.round_trips += 1;
    }

    /// Its start.
    pub(crate) const fn began(&self) -> Instant {
        Instant::from_micros(self.number.saturating_mul(SECOND_US))
    }

    /// The message.
    pub(crate) fn json(&self) -> String {
        let json = nojson::object(|f| {
            f.member("mono_us", self.began().as_micros())?;
            f.member("sent", self.sent)?;
            f.member("replies", self.replies)?;
            f.member("lost", self.lost)?;
            f.member("junk", self.junk)?;
            f.member("not_sent", self.not_sent)?;
            if self.round_trips > 0 {
                let mean_us = self.round_trip_sum_us / u64::from(self.round_trips);
                f.member("round_trip_min_us", self.round_trip_min_us)?;
                f.member("round_trip_mean_us", mean_us)?;
                f.member("round_trip_max_us", self.round_trip_max_us)?;
            }
            Ok(())
        });
        json.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_with_replies_only_has_no_counts() {
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let reading = LineEventKind::Received { frame, asked: None };
        let silence = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 9_000,
        };
        let mut meter = Meter::default();
        let mut add = |at_s, kind| {
            let at = Instant::from_micros(at_s * SECOND_US);
            meter.add_event(&LineEvent { at, kind })
        };
        assert_eq!(add(1, reading), None);
        assert_eq!(add(2, reading), None);
        assert_eq!(add(3, silence), None);
        assert_eq!(add(4, reading).map(|second| second.number), Some(3));
        assert_eq!(meter.end(), None);
    }

    #[test]
    fn a_second_is_counted_and_given_when_the_next_begins() {
        let mut meter = Meter::default();
        let query = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
        let reply = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let sent = LineEventKind::Sent {
            frame: query,
            mode: None,
        };
        let received = LineEventKind::Received {
            frame: reply,
            asked: None,
        };
        let silence = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 9_000,
        };
        let passed = [
            (7_000_000, sent),
            (7_002_000, received),
            (7_100_000, sent),
            (7_103_000, received),
            (7_200_000, sent),
            (7_209_000, silence),
            (7_300_000, received),
        ];
        for (at, kind) in passed {
            let at = Instant::from_micros(at);
            assert!(meter.add_event(&LineEvent { at, kind }).is_none());
        }
        let at = Instant::from_micros(9_500_000);
        let second = meter.add_event(&LineEvent { at, kind: sent }).unwrap();
        assert_eq!(
            second.json(),
            r#"{"mono_us":7000000,"sent":3,"replies":3,"lost":1,"junk":0,"not_sent":0,"round_trip_min_us":2000,"round_trip_mean_us":2500,"round_trip_max_us":3000}"#
        );
        assert_eq!(
            meter.end().unwrap().json(),
            r#"{"mono_us":9000000,"sent":1,"replies":0,"lost":0,"junk":0,"not_sent":0}"#
        );
    }
}
