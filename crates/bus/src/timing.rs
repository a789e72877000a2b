//! Every duration that the bus lives by, with where it comes from.

use std::time::Duration;

/// Telemetry older than this is unknown, not zero (safety rule 5).
pub const FRESH_FOR: Duration = Duration::from_millis(500);

/// A motor that has not answered for this long is reported silent.
pub const SILENT_AFTER: Duration = Duration::from_secs(2);

/// A driven motor that has not answered for this long loses its setpoint. A motor that lost power
/// comes back in the velocity loop, where a raw current would be read as a speed. Ten drive frames
/// at 50 Hz: with 15 % of replies lost the chance of that by bad luck is 6 in a billion.
pub(crate) const DRIVEN_SILENCE_MAX: Duration = Duration::from_millis(200);

/// And that many requests in a row must have had no answer: when it is we who were held up, by a busy
/// machine, the motor had nothing to answer.
pub(crate) const DRIVEN_UNANSWERED_MAX: u32 = 3;

/// A call that comes so much later than the bus asked for is a machine that slept or a worker that was
/// delayed: nothing that was known is fresh any more ([`FRESH_FOR`]), and no setpoint stands.
pub(crate) const LATE_CALL: Duration = FRESH_FOR;
/// From here on the page calls it sleep. Where the line lies is a choice: the motors are stopped either way.
pub(crate) const SLEPT_AT_LEAST: Duration = Duration::from_secs(5);

/// The page must answer its ping within this (safety rule 3).
pub const PAGE_SILENCE_MAX: Duration = Duration::from_secs(1);

/// How often the page is pinged: four chances within [`PAGE_SILENCE_MAX`].
pub(crate) const PING_PERIOD: Duration = Duration::from_millis(250);

/// Telemetry of a motor is asked for at 10 Hz, whether or not it is driven.
pub(crate) const QUERY_PERIOD: Duration = Duration::from_millis(100);

/// And at 5 Hz where drive frames need more than [`BUSY_PER_MILLE`] of the line.
pub(crate) const BUSY_QUERY_PERIOD: Duration = Duration::from_millis(200);
/// Six motors at 50 Hz need 700 to 850 of it.
pub(crate) const BUSY_PER_MILLE: u32 = 500;

/// A motor that has been silent for [`SILENT_AFTER`] is asked once a second.
pub(crate) const SILENT_QUERY_PERIOD: Duration = Duration::from_secs(1);
/// While others are driven it is asked after 2, 4 and then every 8 seconds: a window each time is a
/// drive frame that comes late.
pub(crate) const PROBE_DOUBLINGS_MAX: u32 = 3;

/// Drive frames that were held up for no longer than this are made up for.
pub(crate) const CATCH_UP_MAX: Duration = Duration::from_millis(50);

/// A query is sent where the next drive frame is a usual round trip and half the usual distance of
/// drive frames away, so that a slow reply does not make that frame late; but no more than this is
/// asked for.
pub(crate) const QUERY_MARGIN_MAX: Duration = Duration::from_millis(10);

/// A query that has waited this long goes even where it makes a drive frame late, so that temperature
/// is known at any load: one drive period at the 50 Hz that a motor wants.
pub(crate) const QUERY_PATIENCE: Duration = Duration::from_millis(20);

/// A line that has been free for less than this has just carried a reply: two steps of a browser's clock.
pub(crate) const JUST_FREED: Duration = Duration::from_micros(200);

/// Five mode switches, 20 ms apart: what the maker's samples send.
pub(crate) const SWITCH_FRAMES: u8 = 5;
/// Distance of two mode switches.
pub(crate) const SWITCH_PERIOD: Duration = Duration::from_millis(20);
/// After the fifth mode switch a reply must report the new loop within this: three queries.
pub(crate) const SWITCH_CONFIRM: Duration = Duration::from_millis(300);

/// The position loop is refused by the motor at this speed and above.
pub const POSITION_SWITCH_RPM: u16 = 10;

/// A round of stop frames starts this long after the last: two exchanges of a fast adapter, 200
/// frames a second, far above the 50 Hz that the brake wants.
pub(crate) const STOP_PERIOD: Duration = Duration::from_millis(5);

/// A motor that does not answer costs the motors that are driven beside it a window each time. It gets
/// the brake at the 50 Hz that it wants, should it hear.
pub(crate) const SILENT_STOP_PERIOD: Duration = Duration::from_millis(20);

/// First frames of a stop to motors that do not answer, between two rounds of those that do: with windows
/// of 6 ms these keep the 50 Hz that the brake wants.
pub(crate) const SILENT_FIRSTS_MAX: u8 = 3;

/// Mode switches to a motor that answers nothing before it gets the brake: it may still be in the position
/// loop, where the brake is a move to 0 degrees. It may need five of them; with 10 % of the requests lost fewer
/// than five of 15 arrive once in 100 million. They take 300 ms.
pub(crate) const SILENT_SWITCHES: u8 = 15;

/// Without a reply whose angle is certain for so long after Hold, the angle that was reckoned is held: two
/// drive frames at 50 Hz.
pub(crate) const HOLD_REFINED_WITHIN: Duration = Duration::from_millis(40);

/// How long a stop goes on for a motor that does not report standstill. From 120 rpm unloaded the
/// brake takes 250 ms; a heavy wheel gets twelve times that.
pub const STOP_WINDOW: Duration = Duration::from_secs(3);

/// So many replies in a row, each under 1 rpm, are a standstill: one may have been measured as a
/// reversing wheel passed zero.
pub(crate) const STANDSTILL_REPLIES: u8 = 3;

/// A stop waits for the exchange in flight, but not longer than this after it was sent: four times
/// the round trip of a common adapter.
pub(crate) const STOP_PATIENCE: Duration = Duration::from_millis(10);

/// No reply can be complete sooner after its request: 868 us of request, 868 us of reply, less
/// what clocks with steps of 0.1 ms may be wrong. What comes sooner answers an earlier request.
pub(crate) const EARLIEST_REPLY: Duration = Duration::from_micros(1_500);

/// First guess of a reply window: an FTDI adapter holds received bytes for up to 16 ms.
pub(crate) const FIRST_WINDOW: Duration = Duration::from_millis(25);
/// The shortest reply window: what a busy browser may be late with a reply that came in time.
pub(crate) const MIN_WINDOW: Duration = Duration::from_millis(6);
/// The longest reply window.
pub(crate) const MAX_WINDOW: Duration = Duration::from_millis(40);

/// Every motor answers the ID query at once, and all of it is waited for.
pub(crate) const ID_QUERY_WINDOW: Duration = Duration::from_millis(60);

/// Longer ago than this an ID query is not answered any more, whatever holds its answers.
pub(crate) const CALL_FORGOTTEN: Duration = Duration::from_secs(10);

/// A request without answer keeps the line for its airtime and this, so that its echo is over, which
/// may come in pieces a USB frame of 1 ms apart.
pub(crate) const SETTLE: Duration = Duration::from_millis(4);

/// A port that did not take a frame is offered the next one this much later: a round of a stop. It is soon
/// enough for a stop, and a port that takes nothing for a second adds 200 lines to the log, not 1,000.
pub(crate) const REFUSED_PAUSE: Duration = STOP_PERIOD;
/// A question of a scan that the port did not take is asked again, but no more often than this in a row:
/// a second, behind which the port counts as one on which nobody answers.
pub(crate) const REFUSED_MAX: u32 = 200;

/// A reply that might be the shifted image of another is held back until the line was quiet for
/// this long: more than one byte's time on any adapter that does not hold bytes.
pub(crate) const AMBIGUITY_QUIET: Duration = Duration::from_millis(2);

/// A reply may come this long after its request at the latest; until then a reply in the other
/// layout cannot be told from it.
pub(crate) const LATE_REPLY_MAX: Duration = Duration::from_millis(50);

/// An adapter or a machine that has handed out a reply late may do so again within this: ten queries.
pub(crate) const LATE_FORGOTTEN: Duration = Duration::from_secs(1);

/// A deadline this near is due: one step of a browser's clock. Timers wake up to 0.4 ms early, and are
/// set once more then; what goes out early makes the gap behind it longer.
pub(crate) const EARLY: Duration = Duration::from_micros(100);

/// The longest window of a scan: an FTDI adapter that holds bytes for 16 ms, and 10 ms for all else. 254
/// of them take 6.6 s.
pub(crate) const SCAN_WINDOW_MAX: Duration = Duration::from_millis(26);

/// A scan waits this much longer than the longest reply so far: a busy browser's hiccup.
pub(crate) const SCAN_MARGIN: Duration = Duration::from_millis(3);

/// How long a scan asks the motors that it has found, behind its last address, only to learn whether
/// the line loses replies.
pub(crate) const SCAN_SAMPLING_MAX: Duration = Duration::from_millis(200);

/// A full scan proves for so long who is on the bus. Long enough to read a question and answer it.
pub(crate) const PROOF_LASTS: Duration = Duration::from_secs(60);

/// Distance of two set-ID frames: that of mode switches, for which the maker gives one.
pub(crate) const SET_ID_PERIOD: Duration = SWITCH_PERIOD;

/// After the fifth set-ID frame the motor writes its flash, for which no time is published; a
/// published script waits 500 ms.
pub(crate) const ID_SETTLE: Duration = Duration::from_millis(300);

/// Distance of two looks at the new ID.
pub(crate) const ID_LOOK_PERIOD: Duration = Duration::from_millis(50);
