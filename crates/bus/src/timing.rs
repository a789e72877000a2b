//! Every duration of the bus, with its source.

use std::time::Duration;

use motorlink_protocol::family::Model;

/// Older telemetry is unknown, not zero (safety rule 5).
pub const FRESH_FOR: Duration = Duration::from_millis(500);

/// A motor without a reply for this long is reported silent.
pub const SILENT_AFTER: Duration = Duration::from_secs(2);

/// A driven motor without a reply for this long loses its setpoint. A motor that lost power
/// restarts in the velocity loop, where a raw current would be read as a speed. Ten drive frames at
/// 50 Hz: with 15 % of replies lost, chance causes this 6 times in a billion.
pub(crate) const DRIVEN_SILENCE_MAX: Duration = Duration::from_millis(200);

/// Also, this many requests in a row must be unanswered: if a busy machine delayed the bus, the
/// motor had nothing to answer.
pub(crate) const DRIVEN_UNANSWERED_MAX: u32 = 3;

/// A call this much later than the bus asked for means a computer that slept or a delayed worker:
/// no telemetry is fresh any more ([`FRESH_FOR`]), and setpoints are withdrawn.
pub(crate) const LATE_CALL: Duration = FRESH_FOR;
/// From here on the page calls the gap sleep. The value is a choice: the motors are stopped either
/// way.
pub const SLEEP_MIN: Duration = Duration::from_secs(5);

/// A call or a reply that comes later than this counts as late ([`crate::LineStatus::late_hz`]). Timers of a
/// browser that nothing delays are 0.2 ms late at most.
pub(crate) const LATE: Duration = Duration::from_millis(1);

/// The page must answer its ping within this time (safety rule 3).
pub const PAGE_SILENCE_MAX: Duration = Duration::from_secs(1);

/// Period of the pings to the page: four within [`PAGE_SILENCE_MAX`].
pub(crate) const PING_PERIOD: Duration = Duration::from_millis(250);

/// Query period of a motor, driven or not: 10 Hz.
pub(crate) const QUERY_PERIOD: Duration = Duration::from_millis(100);

/// Query period while drive frames need more than [`BUSY_PER_MILLE`] of the line: 5 Hz.
pub(crate) const BUSY_QUERY_PERIOD: Duration = Duration::from_millis(200);
/// Six motors at 50 Hz need 700 to 850 per mille.
pub(crate) const BUSY_PER_MILLE: u32 = 500;

/// Query period of a silent motor.
pub(crate) const SILENT_QUERY_PERIOD: Duration = Duration::from_secs(1);
/// While others are driven, a silent motor is queried after 2, 4 and then every 8 seconds: each
/// reply window delays a drive frame.
pub(crate) const PROBE_DOUBLINGS_MAX: u32 = 3;

/// A delay of drive frames up to this length is caught up.
pub(crate) const CATCH_UP_MAX: Duration = Duration::from_millis(50);

/// A query needs a usual round trip plus half the period of drive frames before the next drive
/// frame, so that a slow reply does not delay that frame; but no more than this margin.
pub(crate) const QUERY_MARGIN_MAX: Duration = Duration::from_millis(10);

/// A query that has waited this long goes even if it delays a drive frame, so that the temperature
/// is known at any load: one drive period at the 50 Hz that a motor needs.
pub(crate) const QUERY_PATIENCE: Duration = Duration::from_millis(20);

/// The temperature of a driven motor is asked for by queries in a row once it is this old: three queries were lost, or
/// had no certain reply. So it is younger than half a second on a line that loses every tenth reply.
pub(crate) const TEMPERATURE_OLD: Duration = Duration::from_millis(300);
/// From this age on even a new setpoint waits for these queries, but no zero.
pub(crate) const TEMPERATURE_URGENT: Duration = Duration::from_secs(1);
/// A driven motor whose temperature is older than this is stopped: its limit cannot be judged. The safety page of the
/// project asks for it.
pub(crate) const TEMPERATURE_UNKNOWN_MAX: Duration = Duration::from_secs(2);
/// Queries in a row end with a drive frame after this time: five periods at 50 Hz, half of the silence that ends a
/// setpoint.
pub(crate) const NO_DRIVE_FRAME_MAX: Duration = Duration::from_millis(100);

/// The winding temperature changes less than this between two readings, in degrees Celsius.
pub(crate) const TEMPERATURE_JUMP: u8 = 20;

/// A line that is free for less than this has just carried a reply: two steps of a browser's clock.
pub(crate) const JUST_FREED: Duration = Duration::from_micros(200);

/// Frames of a mode switch, 20 ms apart, as in the maker's samples.
pub(crate) const SWITCH_FRAMES: u8 = 5;
/// Time between two mode switch frames.
pub(crate) const SWITCH_PERIOD: Duration = Duration::from_millis(20);
/// A reply must report the new loop within this time after the fifth frame: three queries.
pub(crate) const SWITCH_CONFIRM_MAX: Duration = Duration::from_millis(300);

/// The bus listens for this long before it enables a motor without a command: five drive frames of another host at
/// 50 Hz.
pub(crate) const LISTEN_BEFORE_ENABLE: Duration = Duration::from_millis(100);
/// Without a command, the bus enables no motor for this long after a drive frame of another host: 50 of its frames.
/// Some of them are received although frames collide.
pub(crate) const OTHER_HOST_QUIET: Duration = Duration::from_secs(1);

/// Time between two tries to enable a motor without a command.
pub(crate) const ENABLE_PERIOD: Duration = Duration::from_secs(1);
/// Tries to enable a motor without a command, until it has been silent again.
pub(crate) const ENABLE_TRIES: u8 = 3;

/// Outside the velocity loop, a motor with separate frames gets a drive frame only if it has answered within this time.
/// Otherwise it is asked for its loop first: it may have lost power and restarted in the velocity loop. Three periods
/// at 50 Hz, so at usual rates no question is added.
pub(crate) const LOOP_CERTAIN_FOR: Duration = Duration::from_millis(60);
/// Time between two questions for the loop of a motor whose drive frame waits: the line is free for others meanwhile.
pub(crate) const LOOP_QUERY_PERIOD: Duration = Duration::from_millis(20);

/// The motor refuses the position loop at this speed and above.
pub const POSITION_SWITCH_RPM: u16 = 10;

/// A wheel that nothing here drives turns unasked from this speed on. Below, a person turns it by hand.
pub(crate) const UNASKED_RPM: u16 = 10;
/// A motor that nothing here drives and that draws more than this is driven by a command that it kept: 0.25 A, the most
/// that the data sheet of the M0601 gives for a wheel that turns freely at 200 rpm. Standing motors were captured with up to
/// 57 raw (0.014 A), at 100 rpm with up to 1,475 (0.36 A).
pub(crate) const UNASKED_CURRENT_RAW: u16 = 1_024;
/// Calm replies in a row that end it: as many as make a standstill.
pub(crate) const UNASKED_CALM_REPLIES: u8 = STANDSTILL_REPLIES;

/// Time between two rounds of stop frames: two exchanges of a fast adapter, 200 frames per second,
/// far above the 50 Hz that the brake needs.
pub(crate) const STOP_PERIOD: Duration = Duration::from_millis(5);

/// A drive frame that is so late goes before stop frames that may be lost: in this time a stop of three motors repeats
/// each frame, on an adapter that holds bytes for 25 ms.
pub(crate) const DRIVE_WAITS_FOR_STOPS_MAX: Duration = Duration::from_millis(200);

/// Time between two brake frames to one motor if the operator wants them slow.
pub(crate) const SLOW_BRAKE_PERIOD: Duration = Duration::from_millis(300);

/// Time between two stop frames to a silent motor while others are driven, because each reply window
/// delays their frames. The motor gets the brake at the 50 Hz that it needs, in case it receives frames.
pub(crate) const SILENT_STOP_PERIOD: Duration = Duration::from_millis(20);

/// First stop frames to silent motors between two rounds of the answering ones: with windows of 6
/// ms these keep the 50 Hz that the brake needs.
pub(crate) const SILENT_FIRSTS_MAX: u8 = 3;

/// Mode switches to a silent motor whose loop was never known, before it gets the brake: it may be in the position loop,
/// where the brake is a move to 0 degrees. It may need five of them; with 10 % of requests lost,
/// fewer than five of 15 arrive once in 100 million. They take 300 ms.
pub(crate) const SILENT_SWITCHES: u8 = 15;

/// Without a certain angle for this long after Hold, the estimated angle is held: two drive frames
/// at 50 Hz.
pub(crate) const HOLD_REFINED_WITHIN: Duration = Duration::from_millis(40);

/// Motors that [`FIRST_BRAKE_MAX`] holds for.
pub const FIRST_BRAKE_MOTORS_MAX: u8 = 16;
/// Each of up to [`FIRST_BRAKE_MOTORS_MAX`] motors gets its first brake frame in the velocity loop within this time after
/// the stop, from any loop, if the line loses nothing and the motor takes the first mode switch.
///
/// A motor costs a brake or a query, a switch and a brake, each as long as the line is occupied: 16.3 ms for a DDSM115,
/// at any adapter. `cargo xtask bench stops` measures at most 256 ms (16 DDSM115 in the position loop, an
/// adapter that holds bytes for 16 ms).
pub const FIRST_BRAKE_MAX: Duration = Duration::from_millis(300);

/// Longest stop of a motor that does not report standstill. From 120 rpm without load the brake
/// takes 250 ms; a heavy wheel gets twelve times as long.
pub const STOP_WINDOW: Duration = Duration::from_secs(3);

/// Replies in a row under 1 rpm that make a standstill: a single one may come from a reversing
/// wheel as it passes zero.
pub(crate) const STANDSTILL_REPLIES: u8 = 3;

/// A stop waits this long for the exchange in flight, and for each reply while another motor waits for its first
/// brake: until request and reply have passed the line, with [`SETTLE_TIME`] for the turnaround of the motor. A reply that
/// the adapter holds longer counts when it comes.
pub(crate) const fn stop_patience(model: Model) -> Duration {
    let airtime = model.frame_airtime();
    airtime.saturating_add(airtime).saturating_add(SETTLE_TIME)
}

/// Error of a browser's clocks between a request and its reply.
const CLOCK_ERROR: Duration = Duration::from_micros(236);

/// No reply is complete sooner after its request: the airtime of both (868 us each of a DDSM115), less the
/// error of clocks with steps of 0.1 ms. An earlier reply answers an earlier request.
pub(crate) const fn earliest_reply(model: Model) -> Duration {
    let airtime = model.frame_airtime();
    airtime.saturating_add(airtime).saturating_sub(CLOCK_ERROR)
}

/// First reply window: an FTDI adapter holds received bytes for up to 16 ms.
pub(crate) const FIRST_WINDOW: Duration = Duration::from_millis(25);
/// Shortest reply window: the delay with which a busy browser may deliver a reply.
pub(crate) const MIN_WINDOW: Duration = Duration::from_millis(6);
/// Longest reply window.
pub(crate) const MAX_WINDOW: Duration = Duration::from_millis(40);

/// Reply window of the ID query, which all motors answer at once. The bus waits for all of it.
pub(crate) const ID_QUERY_WINDOW: Duration = Duration::from_millis(60);

/// An older ID query is not answered any more, even through an adapter that holds replies.
pub(crate) const ID_QUERY_FORGOTTEN: Duration = Duration::from_secs(10);

/// A request without a reply keeps the line for its airtime plus this, until its echo is over. The
/// echo may come in pieces, a USB frame of 1 ms apart.
pub(crate) const SETTLE_TIME: Duration = Duration::from_millis(4);

/// Pause after a refused frame: one round of a stop. It is short enough for a stop, and a port that
/// refuses everything for a second adds 200 lines to the log, not 1,000.
pub(crate) const REFUSED_PAUSE: Duration = STOP_PERIOD;
/// A refused frame of a scan is sent again at most this often in a row: a second. After that the
/// port counts as one without replies.
pub(crate) const REFUSED_MAX: u32 = 200;

/// An ambiguous window is held back until the line was quiet for this long: more than the time of
/// one byte on any adapter that does not hold bytes.
pub(crate) const AMBIGUITY_QUIET: Duration = Duration::from_millis(2);

/// A reply arrives at most this long after its request. Until then it cannot be told from a reply
/// in the other layout.
pub(crate) const LATE_REPLY_MAX: Duration = Duration::from_millis(50);

/// After a late reply another one is expected within this time: ten queries.
pub(crate) const LATE_FORGOTTEN: Duration = Duration::from_secs(1);

/// A deadline this near is due: one step of a browser's clock. Timers fire up to 0.4 ms early and
/// are then set again; an early frame makes the next gap longer.
pub(crate) const EARLY: Duration = Duration::from_micros(100);

/// Longest reply window of a scan: an FTDI adapter that holds bytes for 16 ms, and 10 ms for the
/// rest. 254 of them take 6.6 s.
pub(crate) const SCAN_WINDOW_MAX: Duration = Duration::from_millis(26);

/// A scan waits this much longer than the longest round trip so far: the scheduling delay of a busy
/// browser.
pub(crate) const SCAN_MARGIN: Duration = Duration::from_millis(3);

/// After its last address a scan probes the found motors for this long, to measure whether the line
/// loses replies.
pub(crate) const SCAN_SAMPLING_MAX: Duration = Duration::from_millis(200);

/// A full scan proves for this long which motors are on the bus: enough to read and answer a
/// question.
pub(crate) const PROOF_LIFETIME: Duration = Duration::from_secs(60);

/// Time between two set-ID frames: as for mode switches. The maker gives none for set ID.
pub(crate) const SET_ID_PERIOD: Duration = SWITCH_PERIOD;

/// After the last set-ID frame the motor writes its flash, for which no time is published; a
/// published script waits 500 ms.
pub(crate) const ID_SETTLE_TIME: Duration = Duration::from_millis(300);

/// Time between two probes of an ID.
pub(crate) const ID_PROBE_PERIOD: Duration = Duration::from_millis(50);

pub(crate) fn micros(duration: Duration) -> u32 {
    u32::try_from(duration.as_micros()).unwrap_or(u32::MAX)
}
