//! The notice of a line that loses or damages many replies.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{bus::Counters, protocol::MotorId};

use crate::{
    model::{
        help_topic::HelpTopic,
        notice_board::{NoticeText, Tone, Topic},
        page::use_page,
        snapshot::Session,
        terms,
    },
    ui::reactive::effect,
};

/// Requests of one judgement: a second of a driven motor. Of 50 requests on a line that loses 5 %, chance loses 15 %
/// once in 250 times.
const JUDGED: u64 = 50;
/// From this share on, in percent, a line is poor.
const POOR_PERCENT: u64 = 15;
/// Below this share it is good again.
const GOOD_PERCENT: u64 = 8;

/// Posts the notice while requests to a motor get no valid reply too often, and withdraws it after that.
pub(crate) fn watch_quality() {
    let page = use_page();
    let watch = StoredValue::new(Watch::default());
    effect(move || {
        let changed = page.shown.with(|session| {
            watch
                .try_update_value(|watch| watch.look(session))
                .unwrap_or_default()
        });
        match changed {
            Some(poor) if poor.is_empty() => {
                page.notices.update(|board| board.withdraw(Topic::Quality));
            }
            Some(poor) => page.notify(&|| of_poor_line(&poor)),
            None => {}
        }
    });
}

/// A motor and its counters at the beginning of a judgement.
#[derive(Clone, Copy, Debug)]
struct Judged {
    id: MotorId,
    from: Counters,
    is_poor: bool,
}

#[derive(Clone, Debug, Default)]
struct Watch(Vec<Judged>);

impl Watch {
    /// The motors with a poor line, if they have changed.
    fn look(&mut self, session: &Session) -> Option<Vec<MotorId>> {
        let before = self.poor();
        let live = !session.is_recording();
        // Most addresses of a scan have no motor.
        let motors = session
            .motors
            .iter()
            .filter(|motor| live && session.job.is_none() && motor.last.is_some());
        let judged = motors.map(|motor| {
            let begin = Judged {
                id: motor.id,
                from: motor.counters,
                is_poor: false,
            };
            // A silent motor has a notice of its own.
            let known = self.0.iter().find(|known| known.id == motor.id);
            known.filter(|_| !motor.is_silent()).map_or(begin, |known| {
                // Another connection counts from 0.
                let requests = motor.counters.requests.checked_sub(known.from.requests);
                let lost = motor.counters.lost().saturating_sub(known.from.lost());
                match requests {
                    Some(requests) if requests < JUDGED => *known,
                    Some(requests) => Judged {
                        is_poor: lost * 100
                            >= requests
                                * if known.is_poor {
                                    GOOD_PERCENT
                                } else {
                                    POOR_PERCENT
                                },
                        ..begin
                    },
                    None => begin,
                }
            })
        });
        self.0 = judged.collect();
        let after = self.poor();
        (after != before).then_some(after)
    }

    fn poor(&self) -> Vec<MotorId> {
        let poor = self.0.iter().filter(|judged| judged.is_poor);
        poor.map(|judged| judged.id).collect()
    }
}

fn of_poor_line(ids: &[MotorId]) -> NoticeText {
    let title = match ids {
        [id] => tr!("Replies of motor {id} are lost or damaged", id),
        ids => tr!(
            "Replies of motors {ids} are lost or damaged",
            ids = terms::ids(ids)
        ),
    };
    // It stays until the line is good again, so it names no share: Link health tells the present one.
    let advice =
        tr!("Many requests get no valid reply. Link health in Diagnose names the likely cause.");
    NoticeText::new(Topic::Quality, Tone::Warning, title, &[advice])
        .explained_at(HelpTopic::DamagedBytes)
}

#[cfg(test)]
mod tests {
    use motorlink_messages::bus::Answer;
    use motorlink_messages::protocol::Mode;

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    /// A line that loses this share in each judgement, one after the other.
    fn noted(percents: &[u64], damaged: bool) -> Vec<Option<Vec<MotorId>>> {
        let mut watch = Watch::default();
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        watch.look(&session);
        let looks = percents.iter().map(|percent| {
            let counters = &mut session.motors[0].counters;
            counters.requests += 100;
            if damaged {
                counters.bad_crcs += percent;
            } else {
                counters.silences += percent;
            }
            watch.look(&session)
        });
        looks.collect()
    }

    #[test]
    fn a_line_that_loses_31_or_damages_23_percent_is_noted_once() {
        for (percent, damaged) in [(31, false), (23, true)] {
            let noted = noted(&[percent; 3], damaged);
            assert_eq!(noted, [Some(vec![ID]), None, None], "{percent} %");
        }
    }

    #[test]
    fn a_share_between_the_bounds_changes_nothing() {
        assert_eq!(noted(&[10, 10], false), [None, None]);
        let noted = noted(&[20, 10, 10, 5, 10], false);
        assert_eq!(noted, [Some(vec![ID]), None, None, Some(vec![]), None]);
    }

    #[test]
    fn late_replies_are_not_lost_and_silence_is_no_quality() {
        let mut watch = Watch::default();
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        watch.look(&session);
        let counters = &mut session.motors[0].counters;
        (counters.requests, counters.silences, counters.late) = (100, 40, 40);
        assert_eq!(watch.look(&session), None);
        session.motors[0].answer = Answer::Missing;
        session.motors[0].counters.requests = 200;
        session.motors[0].counters.silences = 140;
        assert_eq!(watch.look(&session), None);
        // What was lost meanwhile is not held against it.
        session.motors[0].answer = Answer::Comes;
        session.motors[0].counters.requests = 300;
        assert_eq!(watch.look(&session), None);
    }
}
