//! Whether a wheel moves on after a stop or a hold, by its true motion and the frames that it
//! obeys.

use std::{collections::BTreeMap, time::Duration};

use motorlink_protocol::{Instant, Mode, MotorId};
use motorlink_simulator::{VirtualMotor, World};

use crate::rule::{Outcome, Rule, Violation, broken};

/// A frame from before the stop arrives at most this long after it: its airtime, rounded up. At less than 115200 baud
/// it is the airtime itself.
const ON_ITS_WAY: Duration = Duration::from_millis(1);
/// Most motion of a stopped wheel beyond its momentum: 4 mm at the tyre of 102 mm, and more than a
/// controller that holds zero needs.
const UNASKED_MAX_DEG: f32 = 2.0;
/// The same after a hold, whose controller must still reverse: less than the width of a finger.
const GOES_ON_MAX_DEG: f32 = 10.0;
/// Without a fresh angle for 40 ms, a hold holds the last fresh angle or stops; its frame goes
/// next.
const HOLD_TAKES: Duration = Duration::from_millis(50);
/// Largest acceleration of the position loop, which determines the distance for a reversal.
const TURNS_ROUND_RAD_S2: f32 = 300.0;
/// Delay with which its speed follows.
const FOLLOWS_AFTER_S: f32 = 0.015;
/// Largest age of the held angle.
const HELD_ANGLE_AGE_S: f32 = 0.5;

/// Wheels that must not move.
#[derive(Debug, Default)]
pub(super) struct Motion {
    stops: BTreeMap<MotorId, Rundown>,
    holds: BTreeMap<MotorId, Held>,
}

/// A wheel after a stop, until the next command that moves it.
#[derive(Clone, Copy, Debug)]
struct Rundown {
    began: Instant,
    turns: f32,
    /// Distance since the stop, in either direction.
    travelled_deg: f32,
    /// The least distance by its momentum, from all observations.
    explained_deg: f32,
    /// Whether it still obeyed a frame from before the stop at the last observation.
    was_asked: bool,
}

/// A wheel after a hold.
#[derive(Clone, Copy, Debug)]
struct Held {
    began: Instant,
    from_turns: f32,
    /// 1 or -1: its direction of motion.
    direction: f32,
    speed_deg_s: f32,
    /// Distance in that direction and in the other, by frames from before the hold.
    ahead_deg: f32,
    behind_deg: f32,
    was_asked: bool,
}

impl Motion {
    /// A stop of these began, or their setpoints were withdrawn. Returns the number of wheels to
    /// judge.
    pub(super) fn stop(
        &mut self,
        now: Instant,
        world: &World,
        is_stopped: impl Fn(&MotorId) -> bool,
    ) -> u64 {
        let mut judged = 0;
        for motor in world.motors().filter(|motor| is_stopped(&motor.id())) {
            self.holds.remove(&motor.id());
            self.stops.entry(motor.id()).or_insert_with(|| {
                let moves = motor.speed_rpm() != 0.0 || motor.mode() == Mode::Position;
                judged += u64::from(moves);
                Rundown {
                    began: now,
                    turns: motor.turns(),
                    travelled_deg: 0.0,
                    explained_deg: motor.coasting_deg(),
                    was_asked: true,
                }
            });
        }
        judged
    }

    /// A hold was accepted. Returns whether there is a wheel to judge.
    pub(super) fn hold(&mut self, now: Instant, id: MotorId, world: &World) -> bool {
        let Some(motor) = world.motor(id).filter(|it| it.mode() == Mode::Position) else {
            return false;
        };
        let speed_deg_s = deg_s(motor);
        self.holds.insert(
            id,
            Held {
                began: now,
                from_turns: motor.turns(),
                direction: 1.0_f32.copysign(speed_deg_s),
                speed_deg_s,
                ahead_deg: 0.0,
                behind_deg: 0.0,
                was_asked: true,
            },
        );
        true
    }

    /// A load changed.
    pub(super) fn loaded(&mut self, id: MotorId) {
        self.holds.remove(&id);
    }

    /// An operator asked for motion.
    pub(super) fn asked(&mut self, is_asked: impl Fn(&MotorId) -> bool) {
        self.stops.retain(|id, _| !is_asked(id));
        self.holds.retain(|id, _| !is_asked(id));
    }

    /// Time has passed.
    pub(super) fn moved(&mut self, now: Instant, world: &World) -> Outcome {
        // A motor with a new ID counts as another motor.
        self.stops.retain(|id, _| world.motor(*id).is_some());
        for (id, rundown) in &mut self.stops {
            if let Some(motor) = world.motor(*id) {
                rundown.moved(now, motor)?;
            }
        }
        let mut outcome = Ok(());
        self.holds.retain(|id, held| {
            let motor = world.motor(*id);
            let motor = motor.filter(|motor| motor.mode() == Mode::Position);
            motor.is_some_and(|motor| {
                let goes_on = held.moved(now, motor);
                goes_on.unwrap_or_else(|violation| {
                    outcome = Err(violation);
                    false
                })
            })
        });
        outcome
    }
}

impl Rundown {
    fn moved(&mut self, now: Instant, motor: &VirtualMotor) -> Outcome {
        self.travelled_deg += (motor.turns() - self.turns).abs() * 360.0;
        self.turns = motor.turns();
        let latest = self.began + ON_ITS_WAY.max(motor.model().frame_airtime());
        // Until then the motor may still receive one.
        let is_asked = now <= latest
            || motor
                .obeyed()
                .is_some_and(|(received, _)| received <= latest);
        let explained_deg = self.travelled_deg + motor.coasting_deg();
        self.explained_deg = if is_asked || self.was_asked {
            explained_deg
        } else {
            self.explained_deg.min(explained_deg)
        };
        self.was_asked = is_asked;
        let unasked_deg = self.travelled_deg - self.explained_deg;
        if unasked_deg <= UNASKED_MAX_DEG {
            return Ok(());
        }
        let what = format!(
            "{} has turned by {unasked_deg:.1} degrees that nothing explains, stopped at {:?}, in the {} by {:?}",
            motor.id(),
            self.began,
            motor.mode(),
            motor.obeyed()
        );
        broken(Rule::StopMovesNothing, now, what)
    }
}

impl Held {
    /// Whether the wheel is still observed.
    fn moved(&mut self, now: Instant, motor: &VirtualMotor) -> Result<bool, Violation> {
        let latest = self.began + HOLD_TAKES;
        let gone_deg = (motor.turns() - self.from_turns) * 360.0 * self.direction;
        let obeyed = motor.obeyed();
        if obeyed.is_none() && now > latest {
            // Its firmware obeys a frame only for a time, which has passed: the wheel is free, and its direction after a
            // return is random.
            return Ok(false);
        }
        // A firmware that obeys no old frame: its last one came before the hold.
        let is_asked = obeyed.is_none_or(|(received, _)| received <= latest);
        if is_asked || self.was_asked {
            let speed_deg_s = deg_s(motor) * self.direction;
            let on_deg = turns_round_deg(speed_deg_s);
            self.ahead_deg = self.ahead_deg.max(gone_deg + on_deg.max(0.0));
            self.behind_deg = self.behind_deg.min(gone_deg + on_deg.min(0.0));
        }
        self.was_asked = is_asked;
        let back_deg = self.behind_deg - self.speed_deg_s.abs() * HELD_ANGLE_AGE_S;
        let unasked_deg = (gone_deg - self.ahead_deg).max(back_deg - gone_deg);
        if unasked_deg <= GOES_ON_MAX_DEG {
            return Ok(true);
        }
        let what = format!(
            "{} has turned by {unasked_deg:.1} degrees that nothing explains, held since {:?} at {:.0} degrees a second, by {:?}",
            motor.id(),
            self.began,
            self.speed_deg_s,
            motor.obeyed()
        );
        broken(Rule::HoldHolds, now, what)
    }
}

fn deg_s(motor: &VirtualMotor) -> f32 {
    motor.speed_rpm() * 6.0
}

/// Distance that the position loop needs to reverse, with the sign of the speed.
fn turns_round_deg(speed_deg_s: f32) -> f32 {
    let follows_deg = speed_deg_s * FOLLOWS_AFTER_S;
    let turns_round_deg_s2 = TURNS_ROUND_RAD_S2.to_degrees();
    follows_deg + speed_deg_s * speed_deg_s.abs() / (2.0 * turns_round_deg_s2)
}
