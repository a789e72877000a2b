//! From what happened on the line to the likely cause.
//!
//! | what is seen | what it is likely to be |
//! |---|---|
//! | text | another device on this port |
//! | blocks of 32 bytes, nothing between them | the adapter delivers only full blocks |
//! | 00 or FF without replies | a pair that nothing holds at a level |
//! | 00 or FF beside each reply | a driver that is switched too early or too late |
//! | nothing at all | no power, A and B exchanged, the brown wire |
//! | nothing but what was sent | the adapter echoes, and nobody is there |
//! | garbage from a motor, standing too | two motors with one ID |
//! | damaged replies only while it turns | no termination, no common ground |
//! | damaged replies at rest too | a long or loose line |
//! | lost replies, and hardly any damaged | a contact, a supply that dips, bytes that the adapter drops |
//! | replies of 16 ms, or most replies late | the latency timer of an FTDI adapter |
//! | good frames of a motor that was not asked | a second host |

use motorlink_bus::RoundTripStatus;
use motorlink_protocol::MotorId;

use crate::tally::Tally;

/// So few, and all answered, do not prove a line good: of 40 requests on a line that loses one of five, one
/// at most is lost once in 700 times.
const ASKED_TO_BE_KNOWN: u32 = 40;
/// An idle motor is asked ten times a second. Of 50 requests on a line that loses one of a hundred,
/// five are lost once in 5,000 times.
const ASKED_TO_BE_LOSSY: u32 = 50;
const LOST_MIN: u32 = 5;
/// A line loses one of a hundred now and then; from one of twenty on something is wrong.
const LOSSY_PER_MILLE: u32 = 50;
/// A motor does not answer a damaged request, so that damage causes silences too; but of ten at least one is a damaged
/// reply.
const DAMAGED_OF_LOST: u32 = 10;
/// What is lost in between is said, and no cause is named.
const WELL_PER_MILLE: u32 = 20;
const ASKED_TO_BE_SHARED: u32 = 5;
const ANSWERED_TO_BE_SLOW: u32 = 20;

/// Three seconds of an idle wheel, or half a second of a driven one: with one of ten damaged, 30 good
/// ones in a row are chance once in 24 times.
const STANDING_MIN: u32 = 30;
const TURNING_MIN: u32 = 60;
const NOISY_PER_MILLE: u32 = 30;
/// So many times more errors while it turns are no chance.
const GROWTH: u32 = 3;

/// So few bytes of a pair that nothing drives are chance.
const LEVELS_MIN: u32 = 20;
/// As many as the bus reports.
const TEXT_MIN: u32 = 64;
/// Three replies and a part of one in one chunk are chance, after a stall.
const BLOCKS_MIN: u32 = 4;
/// Where no motor answers, it is asked once a second: ten seconds of replies fill three blocks.
const BLOCKS_WITHOUT_ANSWER_MIN: u32 = 2;

/// Unrequested frames that may come by chance: a reply that is seconds late.
const STRANGERS_MIN: u32 = 3;

/// Round trips of a timer of 16 ms, which may have run for a while when the reply comes.
const LATENCY_TIMER_US: std::ops::Range<u32> = 12_000..25_000;
/// Most of such round trips are longer than 14 ms: these bins of the histogram end at 18 and 25 ms.
pub(crate) const LATENCY_TIMER_ENDS_US: [u32; 2] = [18_000, 25_000];

/// What is likely to be wrong, most likely first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Diagnosis {
    /// Another device than a motor sends text.
    Text,
    /// Blocks of 32 bytes are received, and nothing between them.
    Blocks,
    /// Bytes come without a motor that answers: nothing holds the pair at a level.
    Floating,
    /// A byte comes with every reply: the adapter or the motor takes or releases the pair at the wrong time.
    Turnaround,
    /// Nothing is received.
    Nothing,
    /// Only the echo of what was sent is received.
    EchoOnly,
    /// More than one motor seems to have this ID.
    SharedId(MotorId),
    /// Replies are damaged while a wheel turns, and not while it stands.
    NoiseGrowsWithSpeed,
    /// Bytes of replies are damaged.
    Damaged,
    /// Replies are lost as a whole.
    Lost,
    /// A device replies that was not asked.
    Stranger,
    /// One motor does not answer, and others do.
    Silent(MotorId),
    /// Every reply takes 16 ms longer.
    LatencyTimer,
}

/// The result of a diagnosis.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// No port is open.
    #[default]
    NotConnected,
    /// Too few exchanges for a verdict.
    TooLittle,
    /// The bus is healthy.
    Healthy,
    /// More is lost than on a healthy bus, but too little to name a cause.
    SomeLoss,
    /// Nothing was lost in the last ten seconds, but at least 5 % of the last hundred exchanges of a motor.
    LossEnded,
    /// The likely causes, never empty.
    Faulty(Vec<Diagnosis>),
}

/// What happened on the line to one motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorFindings {
    /// Which one.
    pub id: MotorId,
    /// In the last ten seconds.
    pub recent: Tally,
    /// Of those, the seconds in which it answered: a motor that falls silent loses nothing.
    pub heard: Tally,
    /// Since it answered last, where that is whole seconds ago.
    pub quiet: Tally,
    /// Whether the bus calls it silent, as the alerts do.
    pub silent: bool,
    /// What the header says is lost, in per mille.
    pub loss_per_mille: Option<u16>,
    /// In the last minute, while the wheel stood.
    pub standing: Tally,
    /// In the last minute, while it turned.
    pub turning: Tally,
}

/// What the doctor goes by.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Every motor that is asked.
    pub motors: Vec<MotorFindings>,
    /// Good frames of one that was not asked, in the last ten seconds.
    pub foreign: u32,
    /// Bytes of a pair that nothing drives, in the last ten seconds while no single motor was asked.
    pub levels: u32,
    /// Bytes of text in the same time.
    pub text: u32,
    /// Chunks of 32 bytes in the last ten seconds.
    pub blocks: u32,
    /// Whether the computer is late: then no wire is named for a lost reply.
    pub computer_is_late: bool,
    /// Of the last 256 replies.
    pub round_trip: RoundTripStatus,
    /// Replies in the last four seconds, and how many more of the last 256 took 14 to 25 ms than before. The median of an
    /// idle motor follows after 13 s.
    pub newly_answered: u32,
    /// See `newly_answered`.
    pub newly_delayed: u32,
}

/// What is likely to be wrong with a line on which this happened.
pub fn diagnose(findings: &Findings) -> Verdict {
    let mut found = Found::default();
    let strangers = findings.foreign >= STRANGERS_MIN;
    if strangers {
        found.add(Diagnosis::Stranger);
    }
    let motors = &findings.motors;
    let mut all = Tally::default();
    for motor in motors {
        all += motor.recent;
    }
    let levels = all.levels.saturating_add(findings.levels);
    let blocks_min = if all.answered > 0 {
        BLOCKS_MIN
    } else {
        BLOCKS_WITHOUT_ANSWER_MIN
    };
    if all.text.saturating_add(findings.text) >= TEXT_MIN {
        found.add(Diagnosis::Text);
    } else if findings.blocks >= blocks_min {
        found.add(Diagnosis::Blocks);
    } else if levels >= LEVELS_MIN && levels > all.answered.saturating_mul(2) {
        found.add(Diagnosis::Floating);
    } else if levels >= LEVELS_MIN && levels.saturating_mul(2) > all.answered {
        found.add(Diagnosis::Turnaround);
    } else if !motors.is_empty() && motors.iter().all(is_deaf) && !strangers {
        let mut quiet = Tally::default();
        for motor in motors {
            quiet += motor.quiet;
        }
        let echo = quiet.asked > 0 && quiet.echoed.saturating_mul(2) >= quiet.asked;
        found.add(if echo {
            Diagnosis::EchoOnly
        } else {
            Diagnosis::Nothing
        });
    } else {
        let grows = motors.iter().any(grows_with_speed);
        for motor in motors {
            // A motor that never stood cannot be told from one whose noise grows with speed. Where another motor shows
            // that, Damaged adds nothing.
            let is_told = grows && motor.standing.asked < STANDING_MIN;
            match of_motor(motor, findings.computer_is_late) {
                Some(Diagnosis::Damaged) if is_told => {}
                Some(diagnosis) => found.add(diagnosis),
                None => {}
            }
        }
    }
    let answered: u32 = motors.iter().map(|motor| motor.recent.answered).sum();
    let median = findings.round_trip.median_us;
    let slow = median.is_some_and(|median_us| LATENCY_TIMER_US.contains(&median_us))
        || findings.newly_delayed.saturating_mul(2) > findings.newly_answered;
    // Of several motors most replies may come while the next one is asked. Another cause may make them late, too.
    let mostly_late = found.0.is_empty()
        && all.asked >= ASKED_TO_BE_KNOWN
        && all.late.saturating_mul(2) > all.asked;
    if (slow && answered >= ANSWERED_TO_BE_SLOW) || mostly_late {
        found.add(Diagnosis::LatencyTimer);
    }
    if !found.0.is_empty() {
        Verdict::Faulty(found.0)
    } else if motors.is_empty() || motors.iter().any(is_unknown) {
        Verdict::TooLittle
    } else if motors.iter().all(is_well) {
        Verdict::Healthy
    } else if motors.iter().all(|motor| motor.recent.lost() == 0) {
        Verdict::LossEnded
    } else {
        Verdict::SomeLoss
    }
}

/// Each diagnosis once, in their order. A handful: to sort them would weigh more than all the rest.
#[derive(Default)]
struct Found(Vec<Diagnosis>);

impl Found {
    fn add(&mut self, diagnosis: Diagnosis) {
        let place = self.0.iter().position(|other| *other >= diagnosis);
        let place = place.unwrap_or(self.0.len());
        if self.0.get(place) != Some(&diagnosis) {
            self.0.insert(place, diagnosis);
        }
    }
}

/// Whether it does not answer. A loose wire picks up a byte now and then.
const fn is_deaf(motor: &MotorFindings) -> bool {
    motor.silent && motor.quiet.garbled.saturating_mul(10) <= motor.quiet.asked
}

/// Whether too little was heard of it, or nothing since a moment ago.
const fn is_unknown(motor: &MotorFindings) -> bool {
    motor.recent.asked < ASKED_TO_BE_KNOWN || motor.quiet.asked > 0
}

/// Whether next to nothing is lost, as the header says too.
fn is_well(motor: &MotorFindings) -> bool {
    !header_says_lossy(motor.loss_per_mille) && motor.recent.lost_per_mille() < WELL_PER_MILLE
}

/// Whether the header's figure, of the last hundred exchanges, is no better than that of a lossy line.
pub fn header_says_lossy(loss_per_mille: Option<u16>) -> bool {
    loss_per_mille.is_some_and(|loss| u32::from(loss) >= LOSSY_PER_MILLE)
}

fn is_lossy(motor: &MotorFindings) -> bool {
    motor.heard.asked >= ASKED_TO_BE_LOSSY && loses_much(&motor.heard)
}

pub(crate) fn loses_much(tally: &Tally) -> bool {
    tally.lost() >= LOST_MIN && tally.lost_per_mille() >= LOSSY_PER_MILLE
}

fn of_motor(motor: &MotorFindings, computer_is_late: bool) -> Option<Diagnosis> {
    let recent = motor.recent;
    if is_deaf(motor) {
        Some(Diagnosis::Silent(motor.id))
    } else if grows_with_speed(motor) {
        Some(Diagnosis::NoiseGrowsWithSpeed)
    } else if recent.asked >= ASKED_TO_BE_SHARED && recent.garbled_per_mille() >= 500 {
        Some(Diagnosis::SharedId(motor.id))
    } else {
        let heard = motor.heard;
        // A late computer loses replies. It damages none.
        let is_damaged = heard.garbled >= LOST_MIN && heard.garbled_per_mille() >= LOSSY_PER_MILLE;
        (is_lossy(motor) && (is_damaged || !computer_is_late)).then(|| {
            if heard.garbled.saturating_mul(DAMAGED_OF_LOST) >= heard.lost() {
                Diagnosis::Damaged
            } else {
                Diagnosis::Lost
            }
        })
    }
}

fn grows_with_speed(motor: &MotorFindings) -> bool {
    let (standing, turning) = (motor.standing, motor.turning);
    standing.asked >= STANDING_MIN
        && turning.asked >= TURNING_MIN
        && turning.garbled >= LOST_MIN
        && turning.garbled_per_mille() >= NOISY_PER_MILLE
        && turning.garbled_per_mille() >= GROWTH * standing.garbled_per_mille()
}

#[cfg(test)]
#[path = "doctor_tests.rs"]
mod tests;
