//! Enums of other modules as words in JSON. A word of a later version is read as not known.

use motorlink_controller_messages::{Activity, EndReason, NotArmed};
use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer};

use crate::drive::Why;

const WHYS: [(&str, Why); 26] = [
    ("not_asked", Why::NotAsked),
    ("page_has_control", Why::Refused(NotArmed::PageHasControl)),
    (
        "client_has_control",
        Why::Refused(NotArmed::OtherHasControl),
    ),
    ("late", Why::Refused(NotArmed::Late)),
    ("not_zero", Why::Refused(NotArmed::NotZero)),
    ("still_driven", Why::Refused(NotArmed::StillDriven)),
    ("stopped_by_person", Why::Refused(NotArmed::StoppedByPerson)),
    ("disarmed", Why::Ended(EndReason::Disarmed)),
    ("lease_ended", Why::Ended(EndReason::LeaseEnded)),
    ("page_has_taken_control", Why::Ended(EndReason::Taken)),
    ("person_has_stopped", Why::Ended(EndReason::Stopped)),
    ("server_has_stopped", Why::Ended(EndReason::ServerStopped)),
    ("fault", Why::Ended(EndReason::Fault)),
    ("silent", Why::Ended(EndReason::Silent)),
    ("limit", Why::Ended(EndReason::Limit)),
    ("other_withdrawal", Why::Ended(EndReason::OtherWithdrawal)),
    ("not_started", Why::Ended(EndReason::NotStarted)),
    ("not_finite", Why::Ended(EndReason::NotFinite)),
    ("other_motors", Why::Ended(EndReason::OtherMotors)),
    ("port_lost", Why::Ended(EndReason::PortLost)),
    ("not_in_time", Why::NotInTime),
    ("no_connection", Why::NoConnection),
    ("e_stop", Why::EStop),
    ("no_speed", Why::NoSpeed),
    ("clock_set", Why::ClockSet),
    ("frozen", Why::Frozen),
];

/// Every reason why a robot does not drive.
#[cfg(test)]
pub(super) fn all_whys() -> impl Iterator<Item = &'static str> {
    WHYS.iter().map(|(word, _)| *word)
}

const ACTIVITIES: [(&str, Activity); 5] = [
    ("idle", Activity::Idle),
    ("driven", Activity::Driven),
    ("stopping", Activity::Stopping),
    ("switching", Activity::Switching),
    ("driven_raw", Activity::DrivenRaw),
];

fn word_of<T: Copy + PartialEq>(words: &[(&'static str, T)], value: T) -> Option<&'static str> {
    let mut words = words.iter();
    words.find(|(_, of)| *of == value).map(|(word, _)| *word)
}

fn value_of<T: Copy>(words: &[(&str, T)], word: &str) -> Option<T> {
    let mut words = words.iter();
    words.find(|(of, _)| *of == word).map(|(_, value)| *value)
}

/// The two functions that serde calls.
macro_rules! words {
    ($name:ident, $type:ty, $words:ident) => {
        pub(super) mod $name {
            use super::*;

            #[expect(clippy::ref_option, reason = "as serde calls it")]
            pub(in crate::fleet) fn serialize<S: Serializer>(
                value: &Option<$type>,
                to: S,
            ) -> Result<S::Ok, S::Error> {
                value
                    .and_then(|value| word_of(&$words, value))
                    .serialize(to)
            }

            pub(in crate::fleet) fn deserialize<'de, D: Deserializer<'de>>(
                from: D,
            ) -> Result<Option<$type>, D::Error> {
                let word = Option::<String>::deserialize(from)?;
                Ok(word.and_then(|word| value_of(&$words, &word)))
            }
        }
    };
}

words!(why, Why, WHYS);
words!(activity, Activity, ACTIVITIES);
